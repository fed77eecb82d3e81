//! The portable code path computes what the machine's own does.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use poescope::eval::Report;
use poescope::model::kernel::PORTABLE_ENV;

use crate::common::{answer, poescope, simulated, three_experts, untrained};

#[test]
fn a_models_scores_do_not_depend_on_the_instruction_set() {
    let folder = tempfile::tempdir().unwrap();
    let sizes = ["--steps", "6", "--split", "test"];
    let data = simulated(folder.path().join("pushes.mcap"), 2, &sizes);
    let model = untrained(folder.path().join("model"), three_experts());
    let score = |portable: &str| -> Report {
        let mut eval = poescope();
        eval.args(["eval", "--json", "--context", "4", "--horizon", "2"]);
        eval.arg("--data").arg(&data).arg("--model").arg(&model);
        let report = answer(eval.env(PORTABLE_ENV, portable));
        serde_json::from_str(&report).unwrap()
    };
    let (own, portable) = (score("0"), score("1"));
    assert_eq!((own.episodes, own.rows.len()), (2, 2));
    let numbers = |report: &Report| -> Vec<f64> {
        let of = |interval: poescope::measure::bootstrap::Interval| {
            [interval.mean, interval.low, interval.high]
        };
        report
            .rows
            .iter()
            .flat_map(|row| {
                let mut all = vec![row.model_db, row.held_db, row.mean_frame_db];
                all.extend(of(row.over_held));
                all.extend(of(row.over_mean_frame));
                all
            })
            .collect()
    };
    for (a, b) in numbers(&own).into_iter().zip(numbers(&portable)) {
        assert!((a - b).abs() < 1e-3, "{a} dB and {b} dB");
    }
}
