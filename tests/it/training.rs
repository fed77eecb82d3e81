//! What a run makes of episodes that it cannot learn from, and of a command that would change it on the way.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};

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
    answer(&mut train(&["--resume", "--preset", "fast"]));
    let config = out.join("config.toml").display().to_string();
    answer(&mut train(&["--resume", "--config", &config]));
    let rate = "training.learning_rate=0.0001";
    for other in [["--set", rate], ["--preset", "released"]] {
        let output = train(&["--resume"]).args(other).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(
            !output.status.success() && said.contains("is not what this run was started with"),
            "{said}"
        );
    }
}

/// Episodes of six images, and a training of one update on them.
struct Small {
    folder: tempfile::TempDir,
    data: PathBuf,
}

impl Small {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let data = folder.path().join("data");
        fs::create_dir(&data).unwrap();
        simulated(
            data.join("train.mcap"),
            4,
            &["--steps", "6", "--split", "train"],
        );
        Self { folder, data }
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("run")
    }

    fn train(&self, options: &[&str]) -> Command {
        let mut train = poescope();
        train.args(["train", "--updates", "1", "--set", "training.batch=2"]);
        train.args(options).arg("--data").arg(&self.data);
        train.arg("--out").arg(self.out());
        train
    }

    fn refused(&self, options: &[&str], why: &str) {
        let output = self.train(options).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && said.contains(why), "{said}");
    }

    fn report(&self) -> Value {
        let report = fs::read_to_string(self.out().join("report.json")).unwrap();
        serde_json::from_str(&report).unwrap()
    }
}

#[test]
fn a_run_folder_belongs_to_one_run() {
    let small = Small::new();
    // Whoever listened is gone, as where Ctrl-C has ended `| tee log`: nothing is lost by it.
    let scale = "haptic.scale=[10, 10, 10, 1, 1, 1]";
    let mut child = small.train(&["--model", "v", "--set", scale]);
    let mut child = child.stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stderr.take());
    assert!(child.wait().unwrap().success());
    assert_eq!(small.report()["updates"], 1);
    // What is said of the channels stays, what is not is measured.
    let config = fs::read_to_string(small.out().join("config.toml")).unwrap();
    let config: toml::Table = toml::from_str(&config).unwrap();
    let haptic = &config["haptic"];
    assert_eq!(haptic["scale"][0].as_float(), Some(10.0));
    assert_ne!(haptic["mean"][2].as_float(), Some(0.0));

    small.refused(&[], "holds a run already; add --resume");
    small.refused(
        &["--resume", "--model", "vhp"],
        "--model vhp is not this run's, which is v",
    );
    let lock = fs::File::create(small.out().join(".lock")).unwrap();
    lock.lock().unwrap();
    small.refused(&["--resume"], "a run goes on here");
    drop(lock);
    // What is done with and has been copied has no state, and is no less to be kept.
    let weights = || fs::read(small.out().join("weights.safetensors")).unwrap();
    let before = weights();
    fs::remove_file(small.out().join("state.safetensors")).unwrap();
    small.refused(
        &["--model", "v"],
        "holds a checkpoint; choose another --out",
    );
    assert!(before == weights() && small.report()["updates"] == 1);
}

#[test]
fn what_was_not_measured_is_no_zero() {
    let small = Small::new();
    let mut recordings = recordings(&small.data.join("train.mcap"));
    for recording in &mut recordings {
        recording.wrench = Track::default();
    }
    write(&small.data.join("train.mcap"), &recordings);
    // Of another length than those that are trained on, so that none is left.
    let options = ["--steps", "8", "--split", "val"];
    simulated(small.data.join("val.mcap"), 2, &options);
    let output = small
        .train(&["--model", "v", "--epochs", "1"])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    let report = small.report();
    assert_eq!(
        [&report["val"], &report["contact_newtons"]],
        [&Value::Null, &Value::Null]
    );
    assert_eq!(report["val_episodes"], 0);
    assert!(
        said.contains("4 episodes to train on, 0 for validation"),
        "{said}"
    );
    // Why nothing is left is said.
    fs::remove_dir_all(small.out()).unwrap();
    small.refused(&["--model", "vh"], "lacks haptic, which model `vh` sees");
}
