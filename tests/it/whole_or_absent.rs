//! What ends early leaves no half file under the final name, and what is there is not lost by mistake.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::poescope;

const EXPORT: &[&str] = &["export", "--split", "test"];
const SIMULATE: &[&str] = &["simulate", "--episodes", "100000", "--threads", "2"];

/// Names in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect()
}

/// What writes a file, once something of it is on the disk; it goes on. None if it was over before that was seen.
fn started(arguments: &[&str], folder: &Path, name: &str) -> Option<Child> {
    let mut command = poescope();
    let mut child = command
        .args(arguments)
        .arg("--out")
        .arg(folder.join(name))
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let patience = Instant::now() + Duration::from_mins(2);
    loop {
        let is_begun = |entry: std::io::Result<std::fs::DirEntry>| {
            entry.is_ok_and(|entry| entry.metadata().is_ok_and(|file| file.len() > 0))
        };
        if std::fs::read_dir(folder).unwrap().any(is_begun) {
            return Some(child);
        }
        if child.try_wait().unwrap().is_some() {
            return None;
        }
        assert!(Instant::now() < patience, "nothing was written");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Ends it in the middle; on a machine that is busy elsewhere it may be over first, so once more then.
fn ended_early(arguments: &[&str], name: &str, end: impl Fn(&mut Child)) -> Vec<String> {
    for _ in 0..5 {
        let folder = tempfile::tempdir().unwrap();
        let Some(mut child) = started(arguments, folder.path(), name) else {
            continue;
        };
        end(&mut child);
        if !child.wait().unwrap().success() {
            return names(folder.path());
        }
    }
    panic!("it was over before it could be ended, five times");
}

#[test]
fn after_a_kill_there_is_no_file_of_that_name_and_what_is_left_is_recognisable() {
    let names = ["a.jsonl", "a.mcap", "a.rrd"];
    let has_rerun = |name: &&str| cfg!(feature = "rerun") || *name != "a.rrd";
    for name in names.into_iter().filter(has_rerun) {
        let left = ended_early(EXPORT, name, |child| child.kill().unwrap());
        assert_eq!(left.len(), 1, "{left:?}");
        let is_partial = left[0].starts_with(&format!(".{name}.")) && left[0].ends_with(".partial");
        assert!(is_partial, "{left:?}");
    }
}

#[test]
fn after_an_interrupt_there_is_nothing() {
    for (arguments, name) in [(EXPORT, "a.jsonl"), (SIMULATE, "a.mcap")] {
        let left = ended_early(arguments, name, |child| {
            let mut kill = Command::new("kill");
            kill.args(["-INT", &child.id().to_string()]);
            assert!(kill.status().unwrap().success());
        });
        assert_eq!(left, [""; 0], "{name}");
    }
}

#[test]
fn a_simulation_replaces_only_what_it_may_and_says_so_before_it_begins() {
    let folder = tempfile::tempdir().unwrap();
    let simulate = |out: &str, options: &[&str]| {
        let mut command = poescope();
        command.args(["simulate", "--episodes", "1", "--steps", "4", "--out", out]);
        command.args(options).current_dir(folder.path());
        let output = command.output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        (output.status.success(), said)
    };
    let read = || ["a.mcap", "a.png"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
    let (done, said) = simulate("a.mcap", &["--sheet", "a.png"]);
    assert!(done, "{said}");
    let before = read();
    let refused: [(&str, &[&str], &str); 5] = [
        ("a.mcap", &["--seed", "1"], "--force"),
        ("b.mcap", &["--sheet", "a.png"], "--force"),
        ("b.mcap", &["--sheet", "no/b.png"], "make it first"),
        ("b.mcap", &["--sheet", "b.mcap"], "another file"),
        (".", &[], "folder"),
    ];
    for (out, options, word) in refused {
        let (done, said) = simulate(out, options);
        assert!(!done && said.contains(word), "{out} {options:?}: {said}");
        assert_eq!(names(folder.path()).len(), 2, "{out} {options:?}");
        assert!(read() == before, "{out} {options:?}");
    }
    let (done, said) = simulate("a.mcap", &["--seed", "1", "--force"]);
    assert!(done, "{said}");
    assert!(read()[0] != before[0]);
}
