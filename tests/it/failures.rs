//! `view --failures`: the ranking for scripts, and the scores that are kept for it.

use std::path::Path;

use crate::common::{answer, poescope};

fn ranked(cache: &Path, options: &[&str]) -> String {
    answer(
        poescope()
            .env("XDG_CACHE_HOME", cache)
            .args(["view", "--failures"])
            .args(options),
    )
}

#[test]
fn the_worst_come_first_each_with_the_state_that_opens_it() {
    let cache = tempfile::tempdir().unwrap();
    let text = ranked(cache.path(), &[]);
    let mut lines = text.lines();
    assert_eq!(
        lines.next().unwrap(),
        "rank\tepisode\tstep\tsplit\tsquared_error\tstate"
    );
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split('\t').collect()).collect();
    assert_eq!(rows.len(), 32);
    let values: Vec<f32> = rows.iter().map(|row| row[4].parse().unwrap()).collect();
    assert!(values.is_sorted_by(|a, b| a >= b), "{values:?}");
    // The state opens the tool at that step of that episode, where the frame is as bad as was said.
    let report = answer(poescope().args(["view", "--plain", "--state", rows[0][5]]));
    assert!(report.contains(&format!("episode: {}\n", rows[0][1])));
    assert!(
        report.contains(&format!("step: {} of 16\n", rows[0][2])),
        "{report}"
    );
}

#[test]
fn scores_are_kept_and_made_again_where_they_cannot_be_read() {
    let cache = tempfile::tempdir().unwrap();
    let first = ranked(cache.path(), &["--rank", "nees"]);
    let kept = cache.path().join("poescope");
    let files: Vec<_> = std::fs::read_dir(&kept).unwrap().flatten().collect();
    assert_eq!(files.len(), 1);
    assert_eq!(ranked(cache.path(), &["--rank", "nees"]), first);
    std::fs::write(files[0].path(), "{").unwrap();
    assert_eq!(ranked(cache.path(), &["--rank", "nees"]), first);
}

#[test]
fn what_cannot_be_ranked_is_said() {
    let cache = tempfile::tempdir().unwrap();
    let told = |rank: &str| {
        let output = poescope()
            .env("XDG_CACHE_HOME", cache.path())
            .args(["view", "--failures", "--rank", rank])
            .output()
            .unwrap();
        assert!(!output.status.success());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    assert!(told("gain").contains("--failures: gain is over a model that sees frames alone"));
    assert!(told("beauty").contains("error, distance, nees, conflict, gain, escape"));
}
