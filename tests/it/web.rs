//! The web face through its port: raw websocket clients, well-behaved and otherwise, at a session of made-up episodes.

mod client;
mod doors;
mod hostile;
mod page;
mod program;
mod terminal;

use std::time::{Duration, Instant};

use client::{Running, View, run};
use serde_json::{Value, json};

#[test]
fn who_comes_is_told_all_there_is() {
    let server = Running::start(false);
    run(async {
        let (mut view, answer) = View::connect(&server, &[]).await;
        assert_eq!(answer.headers()["sec-websocket-protocol"], "viser-v1.1.1");
        view.replay().await;
        assert_eq!(view.value("poescope-step"), json!(1.0));
        assert_eq!(view.value("poescope-switch-haptic"), json!(true));
        assert_eq!(view.prop("poescope-step", "max"), json!(16.0));
        let truth = view.prop("poescope-frame-truth", "_data");
        let png: Vec<u8> = serde_json::from_value(truth["bin"].clone()).unwrap();
        let side = image::load_from_memory(&png).unwrap().width();
        assert_eq!(side, 4 * 64);
        let chart = view.prop("poescope-chart-shares", "data");
        assert_eq!(chart.as_array().unwrap()[0]["dtype"], "<f8");
    });
}

#[test]
fn what_one_viewer_does_all_see_and_it_does_not_come_back() {
    let server = Running::start(false);
    run(async {
        let mut driver = View::come(&server).await;
        let mut watcher = View::come(&server).await;
        let frame = watcher.prop("poescope-frame-truth", "_data");
        driver.set("poescope-step", &json!(8)).await;
        watcher
            .until("the step", |view| view.value("poescope-step") == json!(8.0))
            .await;
        watcher
            .until("its frame", |view| {
                view.prop("poescope-frame-truth", "_data") != frame
            })
            .await;
        watcher
            .until("its plate", |view| {
                view.meta()["step"] == 7 && view.meta()["current"] == true
            })
            .await;
        assert!(watcher.scene_moved("/plate"));

        let shares = watcher.prop("poescope-chart-shares", "data");
        driver.set("poescope-switch-vision", &json!(false)).await;
        let asked = Instant::now();
        watcher
            .until("the switch", |view| {
                view.value("poescope-switch-vision") == json!(false)
            })
            .await;
        assert!(asked.elapsed() < Duration::from_secs(2));
        watcher
            .until("its shares", |view| {
                view.prop("poescope-chart-shares", "data") != shares
            })
            .await;
        watcher
            .until("its badge", |view| {
                view.meta()["experts"][0]["alpha"] == 0.0
            })
            .await;

        driver.wait(Duration::from_millis(500)).await;
        let echoes =
            driver.updates_of("poescope-step") + driver.updates_of("poescope-switch-vision");
        assert_eq!(echoes, 0, "the driver knows what it set");
        assert_eq!(driver.meta()["step"], 7);

        // One who comes later finds it so.
        let late = View::come(&server).await;
        assert_eq!(late.value("poescope-switch-vision"), json!(false));
        assert_eq!(late.value("poescope-step"), json!(8.0));
        assert_eq!(
            late.value("poescope-state"),
            watcher.value("poescope-state")
        );
    });
}

#[test]
fn a_state_string_brings_everything_back() {
    let server = Running::start(false);
    run(async {
        let mut view = View::come(&server).await;
        view.set("poescope-step", &json!(5)).await;
        view.set("poescope-alpha-haptic", &json!(0.4)).await;
        view.until("both", |view| {
            view.meta()["step"] == 4 && view.meta()["experts"][1]["alpha"] != 1.0
        })
        .await;
        let state = view.value("poescope-state");
        view.set("poescope-all-on", &json!(true)).await;
        view.set("poescope-step", &json!(1)).await;
        view.until("neither", |view| {
            view.meta()["step"] == 0 && view.meta()["experts"][1]["alpha"] == 1.0
        })
        .await;
        view.set("poescope-state", &state).await;
        view.until("both again", |view| {
            view.value("poescope-state") == state && view.meta()["step"] == 4
        })
        .await;
    });
}

#[test]
fn what_the_session_refuses_is_put_right_and_said() {
    let server = Running::start(false);
    run(async {
        let mut view = View::come(&server).await;
        view.set("poescope-horizon", &json!(500)).await;
        view.until("a notification", |view| view.notes() > 0).await;
        view.until("the old value", |view| {
            view.updates_of("poescope-horizon") > 0
        })
        .await;
        assert_eq!(
            view.value("poescope-horizon"),
            view.meta()["horizon"]
                .as_f64()
                .map_or(Value::Null, |h| json!(h))
        );
        // The same words again are said again.
        view.set("poescope-horizon", &json!(500)).await;
        view.until("another notification", |view| view.notes() > 1)
            .await;
    });
}

#[test]
fn keys_are_each_viewers_own_and_a_click_on_the_path_goes_there() {
    let server = Running::start(false);
    run(async {
        let mut one = View::come(&server).await;
        let mut other = View::come(&server).await;
        one.set("poescope-key", &json!("a#1")).await;
        one.until("a hint", |view| {
            view.face()["n"] == 1 && view.face()["hint"].is_string()
        })
        .await;
        other.set("poescope-key", &json!("l#1")).await;
        other.until("a step", |view| view.meta()["step"] == 1).await;
        assert_eq!(
            (&other.face()["mode"], &other.face()["hint"]),
            (&json!(false), &Value::Null)
        );
        one.set("poescope-key", &json!("-#2")).await;
        one.until("a smaller α", |view| {
            view.meta()["experts"][0]["alpha"] != 1.0
        })
        .await;
        one.set("poescope-line", &json!("12#3")).await;
        one.until("the step of the line", |view| view.meta()["step"] == 11)
            .await;
        other.set("poescope-key", &json!("q#2")).await;
        other
            .until("its own end", |view| view.face()["face"] == "quit")
            .await;

        let click = json!({
            "type": "SceneNodeClickMessage", "name": "/path/points", "instance_index": 3,
            "ray_origin": [0, 0, 1], "ray_direction": [0, 0, -1], "screen_pos": [0.5, 0.5],
            "modifier": null, "owner": ""
        });
        other.send(&click).await;
        one.until("the clicked step", |view| view.meta()["step"] == 3)
            .await;
    });
}

#[test]
fn who_may_only_look_changes_nothing() {
    let server = Running::start(true);
    run(async {
        let mut view = View::come(&server).await;
        assert_eq!(view.prop("poescope-step", "disabled"), json!(true));
        view.set("poescope-switch-vision", &json!(false)).await;
        view.set("poescope-key", &json!("l#1")).await;
        view.until("a refusal", |view| view.face()["explain"]["error"] == true)
            .await;
        view.until("the old value", |view| {
            view.updates_of("poescope-switch-vision") > 0
        })
        .await;
        assert_eq!(view.value("poescope-switch-vision"), json!(true));
        assert_eq!(
            (&view.meta()["step"], &view.meta()["read_only"]),
            (&json!(0), &json!(true))
        );
    });
}

#[test]
fn a_viewer_that_takes_nothing_costs_the_others_nothing() {
    let server = Running::start(false);
    run(async {
        let (_stalled, _) = View::connect(&server, &[]).await;
        let mut view = View::come(&server).await;
        let start = Instant::now();
        for round in 0..60 {
            let step = 1 + round % 16;
            view.set("poescope-step", &json!(step)).await;
            view.until("the step", |view| view.meta()["step"] == step - 1)
                .await;
        }
        assert!(
            start.elapsed() < Duration::from_secs(20),
            "{:?}",
            start.elapsed()
        );
    });
}

#[test]
fn a_server_that_ends_says_so() {
    let server = Running::start(false);
    run(async {
        let mut view = View::come(&server).await;
        server.stop();
        assert_eq!(view.end().await.map(|(code, _)| code), Some(1001));
    });
}
