//! Nothing is scored on what it was fitted on, unless it is said.

use std::fs;
use std::path::Path;
use std::process::Command;

use poescope::episode::Track;
use poescope::model::config::Config;
use serde_json::{Value, json};

use super::complaint;
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
        "## Pose from beliefs, fitted anew on the training split of all",
        "| what regressors were fitted on |",
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
    let data = simulated(folder.path().join("test.mcap"), 4, &options);
    let mut recordings = recordings(&data);
    recordings[1].control.values[3][0] = f64::NAN;
    // Without touch, and with a hit that no training has seen.
    recordings[2].wrench = Track::default();
    recordings[3].wrench.values[40][2] = 1e6;
    let damaged = folder.path().join("damaged.mcap");
    write(&damaged, &recordings);
    let v = untrained(folder.path().join("v"), Config::named("v").unwrap());
    let mut v_h_p = three_experts();
    let channels = &mut v_h_p.haptic;
    (channels.mean, channels.scale) = (vec![0.0; 6], vec![1.0; 6]);
    let v_h_p = untrained(folder.path().join("v-h-p"), v_h_p);
    let eval = |models: &[&Path]| {
        let mut eval = poescope();
        eval.args(["eval", "--horizon", "3"])
            .arg("--data")
            .arg(&damaged);
        eval.args(
            models
                .iter()
                .flat_map(|model| [Path::new("--model"), model]),
        );
        let output = eval.output().unwrap();
        [output.stdout, output.stderr].map(|said| String::from_utf8(said).unwrap())
    };
    let [out, err] = eval(&[&v, &v_h_p]);
    assert!(
        out.starts_with("1 episodes of split `test` (3 left out)"),
        "{out}{err}"
    );
    for why in [
        "left out: episode `ep00001`: /control at 0.53 s: a value that is not a finite number",
        "left out: model `v-h-p`: episode `ep00002` lacks haptic",
        "left out: model `v-h-p`: channel `fz` of episode `ep00003`",
    ] {
        assert!(err.contains(why), "{why}: {err}");
    }
    // What sees no force loses nothing by it.
    let [out, _] = eval(&[&v]);
    assert!(
        out.starts_with("3 episodes of split `test` (1 left out)"),
        "{out}"
    );
}

#[test]
fn whose_seed_is_not_known_is_no_guess() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--steps", "9", "--split", "train"];
    let data = simulated(folder.path().join("all.mcap"), 20, &options);
    let model = untrained(folder.path().join("model"), three_experts());
    let mut eval = poescope();
    eval.args(["eval", "--horizon", "5"])
        .arg("--data")
        .arg(&data)
        .arg("--model")
        .arg(&model);
    let said = |eval: &mut Command| String::from_utf8(eval.output().unwrap().stderr).unwrap();
    let note = said(&mut eval);
    assert!(note.contains("does not say by which seed"), "{note}");
    trained(&model, "1", None);
    assert_eq!(said(&mut eval), "");
    // Half a report is none to go by.
    fs::write(model.join("report.json"), "{\"seed\": 1").unwrap();
    let refusal = complaint(&mut eval);
    assert!(
        refusal.contains("report.json: not the report of a training"),
        "{refusal}"
    );
}
