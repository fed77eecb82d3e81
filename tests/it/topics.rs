//! Topics named on the command line.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::poescope;
use crate::data::sample;

/// The sample in a folder of its own, with a `dataset.toml` that says something else.
fn mapped(folder: &Path, toml: &str) -> PathBuf {
    let path = folder.join("a.mcap");
    fs::copy(sample(), &path).unwrap();
    fs::write(folder.join("dataset.toml"), toml).unwrap();
    path
}

/// Whether it went well, and what it said.
fn info(path: &Path, topics: &[&str]) -> (bool, String) {
    let mut command = poescope();
    command.arg("info").arg(path);
    for topic in topics {
        command.args(["--topic", topic]);
    }
    let output = command.output().unwrap();
    let said = [output.stdout, output.stderr].concat();
    (output.status.success(), String::from_utf8(said).unwrap())
}

/// The role that the table gives `topic`.
fn role<'a>(table: &'a str, topic: &str) -> Option<&'a str> {
    let line = table.lines().find(|line| line.trim().starts_with(topic))?;
    line.split_whitespace().nth(2)
}

#[test]
fn a_topic_of_the_command_line_wins() {
    let folder = tempfile::tempdir().unwrap();
    let path = mapped(
        folder.path(),
        "[topics]\nvision = \"/elsewhere\"\nobject = \"/tag\"\n",
    );
    let (_, said) = info(&path, &[]);
    assert!(said.contains("--topic vision=TOPIC"), "{said}");
    let (fine, said) = info(&path, &["vision=/camera/image_raw"]);
    assert!(fine, "{said}");
    assert!(said.contains("2 episodes"), "{said}");
    assert_eq!(role(&said, "/camera/image_raw"), Some("vision"));
    // What it does not name stays as the file has it.
    assert_ne!(role(&said, "/object/pose"), Some("object"));
    let both = ["vision=/camera/image_raw", "object=/object/pose"];
    assert_eq!(role(&info(&path, &both).1, "/object/pose"), Some("object"));
}

#[test]
fn what_cannot_be_mapped_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = mapped(folder.path(), "");
    for (topics, words) in [
        (
            &["camera=/a"][..],
            "there is no role \"camera\", only control, haptic",
        ),
        (&["vision"], "is not ROLE=TOPIC, for example"),
        (&["vision="], "is not ROLE=TOPIC, for example"),
        (
            &["vision=/wrench"],
            "--topic: topic /wrench is both haptic and vision; give",
        ),
        (
            &["vision=/a", "vision=/b"],
            "--topic: role vision has more than one topic; give",
        ),
    ] {
        let (fine, said) = info(&path, topics);
        assert!(!fine && said.contains(words), "{topics:?}: {said}");
    }
    let swapped = ["haptic=/a", "vision=/wrench"];
    let (_, said) = info(&path, &swapped);
    assert!(!said.contains("is both"), "{said}");
}

#[test]
fn every_command_that_opens_a_dataset_takes_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = mapped(folder.path(), "");
    let doubled = ["--topic", "vision=/wrench"];
    let model =
        crate::common::untrained(folder.path().join("model"), crate::common::three_experts());
    let run = |command: &str, options: &[&Path]| {
        let mut poescope = poescope();
        poescope.arg(command).args(doubled).arg("--data").arg(&path);
        let output = poescope.args(options).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(
            said.contains("is both haptic and vision"),
            "{command}: {said}"
        );
    };
    run("train", &["--out".as_ref(), &folder.path().join("run")]);
    run("eval", &["--model".as_ref(), &model]);
    run("view", &["--print".as_ref(), "--model".as_ref(), &model]);
}

#[test]
fn a_topic_that_is_not_there_is_named_with_those_that_would_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = mapped(folder.path(), "");
    for (topic, words) in [
        (
            "haptic=/ft",
            "haptic=/ft: is no topic here; of its type: /wrench",
        ),
        ("haptic=/joint", "haptic=/joint: is no topic here"),
        ("object=/ft", "of its type: /ee/pose, /object/pose"),
    ] {
        let (fine, said) = info(&path, &[topic]);
        assert!(fine && said.contains(words), "{topic}: {said}");
        let mut view = poescope();
        view.args(["view", "--print", "--topic", topic]).arg(&path);
        let output = view.output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success(), "{topic}");
        assert!(
            said.contains("a.mcap: --topic") && said.contains(words),
            "{said}"
        );
    }
}

#[test]
fn an_export_in_which_no_model_believes_anything_has_failed() {
    let folder = tempfile::tempdir().unwrap();
    let path = mapped(folder.path(), "[topics]\nhaptic = \"/ft\"\n");
    let model =
        crate::common::untrained(folder.path().join("model"), crate::common::three_experts());
    let out = folder.path().join("out.csv");
    let mut export = poescope();
    export.arg("export").arg("--data").arg(&path);
    export.arg("--model").arg(&model).arg("--out").arg(&out);
    let output = export.output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success(), "{said}");
    assert!(
        said.contains("out.csv: written, but without any belief"),
        "{said}"
    );
    assert!(said.contains("needs haptic"), "{said}");
    assert!(out.exists());
}
