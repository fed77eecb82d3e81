//! What a sensor contributes is what leaving it out costs.

use std::fs;

use poescope::model::checkpoint::PROBE;
use poescope::model::probe::Probe;
use serde_json::Value;

use super::{Bench, csv, score_file};
use crate::common::answer;

const SENSORS: [&str; 3] = ["vision", "haptic", "proprio"];

#[test]
fn shapley_values_are_those_of_the_sets_scored_one_by_one() {
    let mut bench = Bench::new();
    bench.models.drain(..2);
    let probe = Probe {
        weights: (0..32).map(|i| 0.01 * (i as f32).sin()).collect(),
        bias: [0.5, 0.1],
        residual: [1e-4, 0.0, 1e-4],
    };
    probe.write(&bench.models[0].join(PROBE), None).unwrap();
    let off = |set: usize| -> String {
        let off = (0..3).filter(|i| set >> i & 1 == 0);
        let off: Vec<String> = off.map(|i| format!("{}:0", SENSORS[i])).collect();
        format!("alpha={}", off.join(","))
    };
    let out = bench.out("out");
    let mut eval = bench.eval(&["--json"]);
    for set in 0..7 {
        eval.args(["--state", &off(set)]);
    }
    let report: Value = serde_json::from_str(&answer(eval.arg("--out").arg(&out))).unwrap();
    // Minus the mean squared error of a frame, under every set of sensors.
    let saved = |set: usize| {
        let subject = match set {
            7 => "v-h-p".to_owned(),
            _ => format!("v-h-p ({})", off(set)),
        };
        let mut rows = report["quality"].as_array().unwrap().iter();
        let row = rows.find(|row| row["subject"] == *subject).unwrap();
        -row["rmse"].as_f64().unwrap().powi(2)
    };
    let rows = csv(&out, "shapley");
    assert_eq!(
        rows[0],
        [
            "index",
            "episode",
            "model",
            "expert",
            "squared_error",
            "nll"
        ]
    );
    for (i, sensor) in SENSORS.into_iter().enumerate() {
        let own = rows.iter().filter(|row| row[3] == sensor);
        let own: Vec<f64> = own.map(|row| row[4].parse().unwrap()).collect();
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        let [own, j, k] = [0, 1, 2].map(|o| 1 << ((i + o) % 3));
        let gain = |others: usize| saved(others | own) - saved(others);
        let expected = (gain(0) + gain(j | k)) / 3.0 + (gain(j) + gain(k)) / 6.0;
        assert!(
            (mean - expected).abs() < 1e-4 * expected.abs().max(1e-2),
            "{sensor}: {mean} {expected}"
        );
    }
    // Those of the position's likelihood add up to what all sensors gain over none, episode by episode.
    let scores = fs::read_to_string(score_file(&out, "v-h-p")).unwrap();
    for (place, line) in scores.lines().skip(1).enumerate() {
        let line: Value = serde_json::from_str(line).unwrap();
        let gain = line["outcome"]["scores"]["subjects"][0]["credit"]["nll_gain"].as_f64();
        let own = rows.iter().filter(|row| row[0] == place.to_string());
        let sum: f64 = own.map(|row| row[5].parse::<f64>().unwrap()).sum();
        assert!((sum - gain.unwrap()).abs() < 1e-9);
    }
}
