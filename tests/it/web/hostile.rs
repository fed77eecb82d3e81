//! What nobody should say closes the connection that said it, with a reason, and touches nobody else.

use std::time::Duration;

use serde_json::json;
use tokio_tungstenite::tungstenite::Message;

use super::client::{Running, View, run};

fn binary(bytes: Vec<u8>) -> Message {
    Message::Binary(bytes.into())
}

/// A message that nests without end.
fn deep() -> Vec<u8> {
    let mut bytes = vec![0x82, 0xa4];
    bytes.extend(b"type");
    bytes.push(0xb0);
    bytes.extend(b"GuiUpdateMessage");
    bytes.extend(b"\xa1x");
    bytes.extend(vec![0x91; 60_000]);
    bytes
}

#[test]
fn each_is_shown_the_door_and_the_others_stay() {
    let server = Running::start(false);
    run(async {
        let mut good = View::come(&server).await;
        let long = json!({"type": "GuiUpdateMessage", "uuid": "poescope-state", "updates": {"value": "x".repeat(9000)}});
        let hostile = [
            (binary(b"hello".to_vec()), 1008, "not a message"),
            (
                binary(vec![0xdd, 0xff, 0xff, 0xff, 0xff]),
                1008,
                "not a message",
            ),
            (binary(deep()), 1008, "not a message"),
            (binary(Vec::new()), 1008, "not a message"),
            (
                binary(rmp_serde::to_vec_named(&long).unwrap()),
                1008,
                "text too long",
            ),
            (binary(vec![0xc0; 100_000]), 1009, "at most 65536 bytes"),
            (Message::Text("{}".into()), 1003, "text"),
        ];
        for (step, (message, code, reason)) in hostile.into_iter().enumerate() {
            let mut bad = View::come(&server).await;
            bad.raw(message).await;
            let (told, why) = bad.end().await.expect(reason);
            assert_eq!((told, why.contains(reason)), (code, true), "{why}");
            good.set("poescope-step", &json!(step + 2)).await;
            good.until("the step", |view| view.meta()["step"] == step + 1)
                .await;
        }
    });
}

#[test]
fn a_flood_ends_at_its_source() {
    let server = Running::start(false);
    run(async {
        let mut good = View::come(&server).await;
        let mut bad = View::come(&server).await;
        for round in 0..1000 {
            bad.set("poescope-step", &json!(1 + round % 16)).await;
        }
        assert_eq!(bad.end().await.map(|(code, _)| code), Some(1008));
        // What the flood had asked for before it was stopped may still be done after the first of these.
        let mut heard = false;
        for _ in 0..20 {
            good.set("poescope-step", &json!(9)).await;
            good.wait(Duration::from_millis(500)).await;
            heard = good.value("poescope-step") == json!(9.0) || good.meta()["step"] == 8;
            if heard {
                break;
            }
        }
        assert!(heard, "the others are served on");
    });
}

#[test]
fn values_that_mean_nothing_are_passed_over() {
    let server = Running::start(false);
    run(async {
        let mut view = View::come(&server).await;
        for (uuid, value) in [
            ("poescope-step", json!(-1e300)),
            ("poescope-step", json!(1e300)),
            ("poescope-step", json!("three")),
            ("poescope-alpha-vision", json!(1e300)),
            ("poescope-episode", json!("99999999999999999999 x")),
            ("poescope-episode", json!("9 x")),
            ("poescope-model", json!("7 x")),
            ("poescope-context", json!(1e18)),
            ("poescope-state", json!("\u{0}<script>&&&==")),
            ("poescope-key", json!("<script>#1")),
            ("poescope-line", json!(":::#2")),
            ("poescope-damage-vision", json!(["zero"])),
            ("nobody", json!({"a": [1, 2, {"b": null}]})),
        ] {
            view.set(uuid, &value).await;
        }
        view.send(&json!({"type": "SceneNodeClickMessage", "name": "/path/points", "instance_index": 4_000_000_000_u32})).await;
        view.send(&json!({"type": "FromTheFuture", "a": [1, 2, 3]}))
            .await;
        view.set("poescope-key", &json!("g#3")).await;
        view.until("an answer", |view| {
            view.face()["n"] == 3 && view.meta()["step"] == 0
        })
        .await;
    });
}
