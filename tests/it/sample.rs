//! What ships: it opens without a word, and it is recognisably right.

use std::path::Path;

use serde_json::Value;

use crate::common::{answer, poescope};

/// One frame of the sample data after some keys, without colour.
fn printed(keys: &str) -> String {
    let mut command = poescope();
    command
        .env("NO_COLOR", "1")
        .args(["--print", "--size", "120x40", "--keys", keys]);
    answer(&mut command)
}

#[test]
fn what_one_sees_first_is_a_prediction_and_keys_count_from_the_first_step() {
    let mut command = poescope();
    command.env("NO_COLOR", "1").arg("--print");
    assert!(answer(&mut command).contains("step  5/16"));
    assert!(printed("l").contains("step  2/16"));
}

/// The line that begins with `label`, of a printed frame.
fn line<'a>(frame: &'a str, label: &str) -> &'a str {
    frame
        .lines()
        .find(|line| line.trim_start().starts_with(label))
        .unwrap()
}

#[test]
fn the_plate_is_drawn_as_large_as_it_is_simulated() {
    let scene = poescope::sim::Scene::default();
    let simulated = [scene.plate_side_m, scene.plate_side_m, scene.plate_height_m];
    let drawn = poescope::episode::PLATE_M.map(f64::from);
    assert!(
        simulated
            .iter()
            .zip(drawn)
            .all(|(a, b)| (a - b).abs() < 1e-6)
    );
}

#[test]
fn an_expert_switched_off_changes_shares_position_and_prediction() {
    let (with, without) = (printed("llllllllpll"), printed("llllllllpll1"));
    for label in ["2 H haptic", "9 D prior"] {
        assert_ne!(line(&with, label), line(&without, label));
    }
    let off = |frame: &str| {
        frame
            .lines()
            .find_map(|line| line.split_once("position cm").map(|p| p.1.to_owned()))
    };
    assert_ne!(off(&with).unwrap(), off(&without).unwrap());
    let prediction = |frame: &str| line(frame, "pred ").to_owned();
    assert_ne!(prediction(&with), prediction(&without));
    let again = printed("llllllllpll11");
    for label in ["1 V vision", "2 H haptic", "9 D prior", "pred "] {
        assert_eq!(line(&with, label), line(&again, label));
    }
}

#[test]
fn the_models_are_ahead_of_both_trivial_predictors_at_every_horizon_from_two_on() {
    for options in [
        &["eval", "--json"][..],
        &["eval", "--json", "--data", "pybullet"],
    ] {
        let report: Value = serde_json::from_str(&answer(poescope().args(options))).unwrap();
        ahead(&report);
    }
}

fn ahead(report: &Value) {
    let row = &report["quality"][0];
    let ahead = row["ahead"].as_array().unwrap();
    assert_eq!(ahead.len(), 11);
    for over in ahead[1..].iter().flat_map(|both| both.as_array().unwrap()) {
        assert!(over["low"].as_f64().unwrap() > 0.0, "{row}");
    }
}

#[test]
fn the_second_sample_opens_by_its_name_with_its_own_model() {
    let mut command = poescope();
    command.env("NO_COLOR", "1");
    command.args([
        "--data", "pybullet", "--print", "--size", "120x40", "--keys", "lllll",
    ]);
    let frame = answer(&mut command);
    assert!(
        frame.contains("pybullet-val-0000") && frame.contains("v-h-p"),
        "{frame}"
    );
    assert!(line(&frame, "1 V vision").contains('%'), "{frame}");
}

#[test]
fn what_ships_is_small() {
    fn bytes(path: &Path) -> u64 {
        if path.is_dir() {
            std::fs::read_dir(path)
                .unwrap()
                .map(|entry| bytes(&entry.unwrap().path()))
                .sum()
        } else {
            path.metadata().unwrap().len()
        }
    }
    assert!(bytes(&Path::new(env!("CARGO_MANIFEST_DIR")).join("sample_data")) < 60_000_000);
}
