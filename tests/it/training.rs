//! What a run makes of episodes that it cannot learn from, and of a command that would change it on the way.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::fs;

use poescope::episode::Track;
use serde_json::Value;

use crate::common::{answer, poescope, simulated};
use crate::data::{recordings, write};

#[test]
fn an_episode_without_a_sensor_is_left_out_and_a_resumed_run_keeps_its_config() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--steps", "6", "--split", "train"];
    let data = simulated(folder.path().join("all.mcap"), 6, &options);
    let mut recordings = recordings(&data);
    recordings[2].wrench = Track::default();
    let data = folder.path().join("some.mcap");
    write(&data, &recordings);
    let out = folder.path().join("run");
    let train = |options: &[&str]| {
        let mut train = poescope();
        train.args(["train", "--model", "vh", "--threads", "2"]);
        train.args(["--updates", "1", "--set", "training.batch=2"]);
        train.args(options).arg("--data").arg(&data);
        train.arg("--out").arg(&out);
        train
    };
    answer(&mut train(&[]));
    let report = fs::read_to_string(out.join("report.json")).unwrap();
    let report: Value = serde_json::from_str(&report).unwrap();
    let left_out = report["left_out"].to_string();
    assert!(
        left_out.contains("lacks haptic, which model `vh` sees"),
        "{report}"
    );
    let trained = report["train_episodes"].as_u64().unwrap();
    assert_eq!(trained + report["val_episodes"].as_u64().unwrap(), 5);

    // The same command again is no other run.
    answer(&mut train(&["--resume"]));
    let rate = "training.learning_rate=0.0001";
    let output = train(&["--resume", "--set", rate]).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        !output.status.success() && said.contains("is not what this run was started with"),
        "{said}"
    );
}
