//! Nothing is scored on what it was fitted on, unless it is said.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::common::{answer, poescope, simulated, three_experts, untrained};
use crate::data::{recordings, write};

#[test]
fn regressors_are_fitted_on_training_episodes_alone() {
    let folder = tempfile::tempdir().unwrap();
    let [train, all] = ["train", "all"].map(|name| folder.path().join(name));
    fs::create_dir(&train).unwrap();
    fs::create_dir(&all).unwrap();
    let simulated = |split, seed, episodes| {
        let options = ["--steps", "9", "--split", split, "--seed", seed];
        simulated(all.join(format!("{split}.mcap")), episodes, &options)
    };
    for (split, seed, episodes) in [("train", "1", 12), ("val", "2", 2)] {
        let path = simulated(split, seed, episodes);
        fs::copy(&path, train.join(path.file_name().unwrap())).unwrap();
    }
    let test = simulated("test", "3", 4);
    let model = untrained(folder.path().join("model"), three_experts());
    let eval = |options: &[&str]| {
        let mut eval = poescope();
        eval.args(["eval", "--horizon", "5"]).args(options);
        eval.arg("--model").arg(&model);
        eval
    };
    let poses = |fit: &Path| {
        let mut eval = eval(&["--json"]);
        let said = answer(eval.arg("--data").arg(&test).arg("--fit").arg(fit));
        serde_json::from_str::<Value>(&said).unwrap()["regression"].clone()
    };
    // The scored episodes beside them change nothing.
    assert!(poses(&train) == poses(&all));
    let said = answer(eval(&[]).arg("--data").arg(&test).arg("--fit").arg(&all));
    for title in [
        "## Pose from beliefs, fitted on the training split",
        "## Pose from beliefs, the released notebook's way",
        "of one training a model: another seed may say otherwise",
    ] {
        assert!(said.contains(title), "{said}");
    }
    // Nor may they be among the training episodes of a larger dataset.
    let mut scored = eval(&["--split", "train"]);
    let alone = train.join("train.mcap");
    let output = scored.arg("--data").arg(&alone).arg("--fit").arg(&all);
    let output = output.output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        !output.status.success() && said.contains("of its split `train` is one that is scored"),
        "{said}"
    );
}

/// A report of a training by a seed on some data.
fn trained(model: &Path, seed: &str, data_hash: Option<&str>) {
    let seed: u64 = seed.parse().unwrap();
    let report = json!({ "seed": seed, "data_hash": data_hash });
    fs::write(model.join("report.json"), report.to_string()).unwrap();
}

#[test]
fn models_that_cut_their_own_validation_split_are_not_scored_together_on_it() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--steps", "9", "--split", "train"];
    let data = simulated(folder.path().join("all.mcap"), 20, &options);
    let models = ["1", "2"].map(|seed| {
        let model = untrained(folder.path().join(seed), three_experts());
        trained(&model, seed, None);
        model
    });
    let mut eval = poescope();
    eval.args(["eval", "--horizon", "5"])
        .arg("--data")
        .arg(&data);
    assert!(answer(eval.arg("--model").arg(&models[0])).starts_with("2 episodes of split `val`"));
    let output = eval.arg("--model").arg(&models[1]).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        !output.status.success() && said.contains("have each cut their own from `train`"),
        "{said}"
    );
    // Those of other data have cut nothing of this.
    trained(&models[1], "2", Some("other"));
    answer(&mut eval);
}

#[test]
fn odd_recordings_are_left_out_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--steps", "9", "--split", "test"];
    let data = simulated(folder.path().join("test.mcap"), 3, &options);
    let mut recordings = recordings(&data);
    recordings[1].control.values[3][0] = f64::NAN;
    let damaged = folder.path().join("damaged.mcap");
    write(&damaged, &recordings);
    let model = untrained(folder.path().join("model"), three_experts());
    let mut eval = poescope();
    eval.args(["eval", "--horizon", "3"])
        .arg("--data")
        .arg(&damaged);
    let output = eval.arg("--model").arg(&model).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|said| String::from_utf8(said).unwrap());
    assert!(
        out.starts_with("2 episodes of split `test` (1 left out)"),
        "{out}{err}"
    );
    assert!(
        err.contains("left out: episode `") && err.contains("not a finite number"),
        "{err}"
    );
}
