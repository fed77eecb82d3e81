//! The main job from nothing to the screen, through the program alone.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::fs;
use std::path::Path;

use crate::common::{answer, poescope, simulated};

#[test]
fn simulate_info_train_view_eval() {
    let folder = tempfile::tempdir().unwrap();
    let data = simulated(folder.path().join("pushes.mcap"), 64, &["--seed", "3"]);

    let listed = answer(poescope().args(["info", "--json"]).arg(&data));
    let listed: serde_json::Value = serde_json::from_str(&listed).unwrap();
    let episodes = listed["episodes"].as_array().unwrap();
    assert_eq!(episodes.len(), 64);
    assert!(episodes.iter().all(|episode| episode["images"] == 16));
    assert_eq!(listed["left_out"].as_array().unwrap().len(), 0);

    let run = folder.path().join("run");
    let mut train = poescope();
    train.args([
        "train",
        "--model",
        "v-h-p",
        "--epochs",
        "2",
        "--threads",
        "2",
    ]);
    answer(train.arg("--data").arg(&data).arg("--out").arg(&run));
    let metrics = fs::read_to_string(run.join("metrics.jsonl")).unwrap();
    let losses: Vec<f64> = metrics
        .lines()
        .map(|line| {
            let line: serde_json::Value = serde_json::from_str(line).unwrap();
            line["val"]["losses"]["loss"].as_f64().unwrap()
        })
        .collect();
    assert_eq!(losses.len(), 2);
    assert!(losses.iter().all(|loss| loss.is_finite()), "{losses:?}");
    let last: serde_json::Value = serde_json::from_str(metrics.lines().last().unwrap()).unwrap();
    let norms = last["gradient_norm"].as_object().unwrap();
    assert_eq!(
        norms.len(),
        7,
        "an encoder and a decoder an expert, and the dynamics"
    );
    for norm in norms.values() {
        let [mean, max] = ["mean", "max"].map(|key| norm[key].as_f64().unwrap());
        assert!(0.0 < mean && mean <= max, "{norms:?}");
    }
    for (kl, per_latent) in [
        (None, &last["kl_per_latent"]),
        (
            Some(&last["val"]["losses"]["kl"]),
            &last["val"]["kl_per_latent"],
        ),
    ] {
        let per_latent = per_latent.as_array().unwrap().iter();
        let per_latent: Vec<f64> = per_latent.map(|kl| kl.as_f64().unwrap()).collect();
        assert_eq!(per_latent.len(), 16);
        assert!(per_latent.iter().all(|&kl| kl > -1e-3), "{per_latent:?}");
        if let Some(kl) = kl {
            let sum = per_latent.iter().sum::<f64>();
            assert!((sum / kl.as_f64().unwrap() - 1.0).abs() < 1e-4);
        }
    }
    // Batches of the second epoch were ready when they were wanted.
    let [updates, each, waited] =
        ["updates", "secs_per_update", "waited_secs"].map(|key| last[key].as_f64().unwrap());
    assert!(
        waited < 0.25 * updates * each,
        "waited {waited} s of {}",
        updates * each
    );

    let print = |keys: &str| {
        let mut view = poescope();
        view.args(["view", "--print", "--size", "120x40", "--keys", keys]);
        view.arg("--data").arg(&data).arg("--model").arg(&run);
        answer(view.env("NO_COLOR", "1"))
    };
    let [on, off, on_again] = ["lllll", "lllll 1", "lllll 1 1"].map(print);
    // The line that says what the last key did differs.
    let screen = |text: &str| text.lines().take(39).collect::<Vec<_>>().join("\n");
    assert!(screen(&on) == screen(&on_again), "{on}\n{on_again}");
    // Two epochs are too few for a prediction that is visibly another one.
    for what in ["2 H haptic", "9 D prior", "position cm"] {
        let said = |text: &str| {
            let line = text.lines().find(|line| line.contains(what)).unwrap();
            line[line.find(what).unwrap()..].to_owned()
        };
        assert_ne!(said(&on), said(&off), "{on}\n{off}");
    }

    evaluated(&data, &run);
}

/// The tables of what was trained.
fn evaluated(data: &Path, run: &Path) {
    let mut eval = poescope();
    eval.args(["eval", "--json", "--split", "val"]);
    let report = answer(eval.arg("--data").arg(data).arg("--model").arg(run));
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["episodes"], 6);
    let quality = report["quality"].as_array().unwrap();
    let names: Vec<&str> = quality
        .iter()
        .map(|row| row["subject"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        [
            "v-h-p",
            "v-h-p (prior off)",
            "last frame held",
            "mean frame"
        ]
    );
    for row in quality {
        assert_eq!(row["horizons"].as_array().unwrap().len(), 11);
        assert!(row["psnr_db"]["mean"].as_f64().unwrap() > 0.0);
    }
    // Training has left regressors beside the probe: poses of new episodes are read by what was fitted on others.
    let regression = report["regression"].as_array().unwrap().iter();
    let held_out =
        regression.filter(|row| row["subject"] == "v-h-p" && row["fitted_on"] == "train");
    assert_eq!(held_out.count(), 4);
}
