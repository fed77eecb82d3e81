//! `poescope info` at the process boundary.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::path::Path;
use std::process::{Command, Output};

use crate::data::{BASE, sample, small, write};

fn info(arguments: &[&str], path: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_poescope"))
        .arg("info")
        .args(arguments)
        .arg(path)
        .output()
        .unwrap()
}

#[test]
fn the_table_lists_what_the_facts_of_the_sample_list() {
    let output = info(&[], &sample());
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    let expected = "\
python_written.mcap  2 episodes, 79.4 kB, 4.50 s of episodes, data c673fcdc284ad301

Splits
  train          1 episode      2.00 s        8 images
  test           1 episode      2.50 s       10 images

Episodes
  ep0000    train      2.00 s      8 images
  ep0001    test       2.50 s     10 images

Files
  python_written.mcap  79.4 kB, 2196 messages, 10 chunks (zstd), profile \"ros2\", by mcap-python/1.6.0 mcap-ros2-support/0.6.0

Topics
  /camera/image_raw  sensor_msgs/msg/Image            vision           18     4.00 Hz
  /control           geometry_msgs/msg/TwistStamped   control          18     4.00 Hz
  /ee/pose           geometry_msgs/msg/PoseStamped    ee_pose         540   120.00 Hz
  /ee/twist          geometry_msgs/msg/TwistStamped   ee_twist        540   120.00 Hz
  /object/pose       geometry_msgs/msg/PoseStamped    object          540   120.00 Hz
  /wrench            geometry_msgs/msg/WrenchStamped  haptic          540   120.00 Hz
";
    assert_eq!(text, expected);
}

#[test]
fn json_has_every_episode_and_the_table_only_the_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("many.mcap");
    let many: Vec<_> = (0..30)
        .map(|i| small(&format!("push-{i:02}"), BASE + i * 1_000_000_000, i as u64))
        .collect();
    write(&path, &many);
    let output = info(&["--json"], &path);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let episodes = json["episodes"].as_array().unwrap();
    assert_eq!(episodes.len(), 30);
    assert_eq!(episodes[7]["id"], "push-07");
    assert_eq!(episodes[7]["split"], "train");
    assert_eq!(episodes[7]["images"], 6);
    assert_eq!(json["files"][0]["topics"].as_array().unwrap().len(), 6);
    let text = String::from_utf8(info(&[], &path).stdout).unwrap();
    assert!(
        text.contains("push-02") && text.contains("push-29"),
        "{text}"
    );
    assert!(
        !text.contains("push-03") && text.contains("26 more"),
        "{text}"
    );
}

#[test]
fn a_name_cannot_command_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("evil.mcap");
    write(&path, &[small("red\u{1b}[31m\u{9b}7m\nline", BASE, 1)]);
    let text = String::from_utf8(info(&[], &path).stdout).unwrap();
    assert!(text.contains("red [31m 7m line"), "{text}");
    assert!(!text.chars().any(|c| c.is_control() && c != '\n'));
}

#[test]
fn what_cannot_be_opened_is_one_line_and_an_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing.mcap");
    let output = info(&[], &path);
    assert!(!output.status.success());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("missing.mcap") && said.trim_end().lines().count() == 1,
        "{said}"
    );
}
