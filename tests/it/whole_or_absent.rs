//! An export that ends early leaves no half file under the final name.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::poescope;

/// Names in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect()
}

/// The export of a split, once something of it is on the disk; it goes on. None if it was over before that was seen.
fn started(folder: &Path, name: &str) -> Option<Child> {
    let mut command = poescope();
    let mut child = command
        .args(["export", "--split", "test", "--out"])
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

/// Ends an export in the middle; on a machine that is busy elsewhere it may be over first, so once more then.
fn ended_early(name: &str, end: impl Fn(&mut Child)) -> Vec<String> {
    for _ in 0..5 {
        let folder = tempfile::tempdir().unwrap();
        let Some(mut child) = started(folder.path(), name) else {
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
        let left = ended_early(name, |child| child.kill().unwrap());
        assert_eq!(left.len(), 1, "{left:?}");
        let is_partial = left[0].starts_with(&format!(".{name}.")) && left[0].ends_with(".partial");
        assert!(is_partial, "{left:?}");
    }
}

#[test]
fn after_an_interrupt_there_is_nothing() {
    let left = ended_early("a.jsonl", |child| {
        let mut kill = Command::new("kill");
        kill.args(["-INT", &child.id().to_string()]);
        assert!(kill.status().unwrap().success());
    });
    assert_eq!(left, [""; 0]);
}
