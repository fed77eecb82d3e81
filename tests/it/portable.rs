//! The portable code path computes what the machine's own does.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::process::Command;

use candle_core::Device;
use poescope::model::Model;
use poescope::model::config::Config;
use poescope::model::inspect::Inspector;
use poescope::model::kernel::PORTABLE_ENV;
use poescope::model::observation::Observations;
use poescope::model::trace::Alphas;

use crate::common::{answer, poescope, simulated, three_experts, untrained};

#[test]
fn a_models_scores_do_not_depend_on_the_instruction_set() {
    let folder = tempfile::tempdir().unwrap();
    let sizes = ["--steps", "6", "--split", "test"];
    let data = simulated(folder.path().join("pushes.mcap"), 2, &sizes);
    let model = untrained(folder.path().join("model"), three_experts());
    let score = |portable: &str| -> Vec<f64> {
        let mut eval = poescope();
        eval.args(["eval", "--json", "--context", "4", "--horizon", "2"]);
        eval.arg("--data").arg(&data).arg("--model").arg(&model);
        let report = answer(eval.env(PORTABLE_ENV, portable));
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["episodes"], 2);
        let horizons = report["quality"][0]["horizons"].as_array().unwrap().iter();
        horizons
            .flat_map(|scores| scores.as_array().unwrap())
            .map(|spread| spread["mean"].as_f64().unwrap())
            .collect()
    };
    let (own, portable) = (score("0"), score("1"));
    assert_eq!((own.len(), portable.len()), (6, 6));
    for (a, b) in own.into_iter().zip(portable) {
        assert!((a - b).abs() < 1e-3, "{a} and {b}");
    }
}

/// Where the forward pass below leaves its numbers.
const OUT_ENV: &str = "POESCOPE_TEST_OUT";

/// Encoders, filter, rollout and decoders of `vhp`, as numbers; run by the test below in a process of its own, since a
/// process computes on one instruction set.
#[test]
fn forward_pass() {
    let Some(out) = std::env::var_os(OUT_ENV) else {
        return;
    };
    let model = Model::new(Config::named("vhp").unwrap(), 5, &Device::Cpu).unwrap();
    let inspector = Inspector::new(model).unwrap();
    let numbers = |n: usize, rate: f32| -> Vec<f32> {
        (0..n)
            .map(|i| 0.5 + 0.5 * (i as f32 * rate).sin())
            .collect()
    };
    let beliefs = 3;
    let encoders = &inspector.model().encoders;
    let seen = Observations {
        beliefs,
        streams: vec![
            numbers(beliefs * encoders[0].inputs(0), 0.37),
            numbers(beliefs * encoders[1].inputs(0), 0.11),
        ],
        controls: vec![[0.3, -0.2], [0.1, 0.4]],
    };
    let experts = inspector.encode(&seen).unwrap();
    let trace = inspector
        .filter(&experts, &Alphas::trained(beliefs, 3))
        .unwrap();
    let rolled = inspector.rollout(&trace, 0, &experts.controls).unwrap();
    let mut all = [
        trace.posterior.mean.clone(),
        trace.posterior.log_var,
        trace.hidden,
    ]
    .concat();
    all.extend(rolled.gaussians.mean.iter());
    all.extend(rolled.gaussians.log_var.iter().chain(&rolled.transitions));
    all.extend(inspector.decode(0, &trace.posterior.mean).unwrap());
    all.extend(inspector.decode(1, &trace.posterior.mean).unwrap());
    let bytes: Vec<u8> = all.iter().flat_map(|number| number.to_le_bytes()).collect();
    std::fs::write(out, bytes).unwrap();
}

#[test]
fn a_forward_pass_agrees_to_a_millionth_and_has_its_own_bits_again() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str, portable: &str| -> Vec<f32> {
        let path = folder.path().join(name);
        let done = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "portable::forward_pass"])
            .env(OUT_ENV, &path)
            .env(PORTABLE_ENV, portable)
            .output()
            .unwrap();
        assert!(done.status.success());
        let bytes = std::fs::read(path).unwrap();
        bytes
            .as_chunks()
            .0
            .iter()
            .map(|&b| f32::from_le_bytes(b))
            .collect()
    };
    let (own, portable) = (run("own", "0"), run("portable", "1"));
    assert!(own.len() > 20_000 && own.len() == portable.len());
    let sum = |numbers: &mut dyn Iterator<Item = f64>| numbers.sum::<f64>().sqrt();
    let apart = sum(&mut own
        .iter()
        .zip(&portable)
        .map(|(a, b)| f64::from(a - b).powi(2)));
    let size = sum(&mut own.iter().map(|a| f64::from(*a).powi(2)));
    assert!(
        apart < 1e-6 * size,
        "apart by {} of their size",
        apart / size
    );
    assert_eq!(own, run("again", "0"));
    assert_eq!(portable, run("again", "1"));
}
