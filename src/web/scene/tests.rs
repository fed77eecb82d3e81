#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::sync::Arc;
use std::time::Duration;

use serde_json::Value;

use super::*;
use crate::session::Session;
use crate::session::command::Command;
use crate::session::fake::{FakePredictor, FakeSource};
use crate::web::outbox::frames;
use crate::web::protocol::frame;
use crate::web::stage::Stage;

fn session() -> Session {
    let source = Arc::new(FakeSource::new(3));
    let mut session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
    assert!(session.wait_idle(Duration::from_secs(20)));
    session
}

fn shown(session: &mut Session, composer: &mut Composer, stage: &mut Stage) -> Vec<Value> {
    assert!(session.wait_idle(Duration::from_secs(20)));
    let moment = stage.show(composer.compose(&session.snapshot(), Shown::default()));
    let frames = frames(moment.changes.iter().map(AsRef::as_ref), 0.0);
    frames
        .iter()
        .flat_map(|frame| frame::read(frame).unwrap().messages)
        .collect()
}

#[test]
fn every_element_and_node_is_made_once_and_stands_in_a_container_that_there_is() {
    let mut session = session();
    session.apply(Command::SeekTo(7));
    let made = shown(
        &mut session,
        &mut Composer::default(),
        &mut Stage::default(),
    );
    let uuids: Vec<&str> = made
        .iter()
        .filter_map(|message| message["uuid"].as_str())
        .collect();
    let mut once = uuids.clone();
    once.sort_unstable();
    once.dedup();
    assert_eq!(
        (once.len(), uuids.len() > 45),
        (uuids.len(), true),
        "{uuids:?}"
    );
    for message in &made {
        if let Some(container) = message["container_uuid"].as_str() {
            assert!(
                container == "root" || uuids.contains(&container),
                "{message}"
            );
        }
        let own_kind = message["type"].as_str().unwrap();
        assert!(own_kind.ends_with("Message"), "{own_kind}");
    }
    let named = |name: &str| made.iter().find(|message| message["name"] == name);
    for name in [
        "/plate",
        "/tip",
        "/believed",
        "/predicted",
        "/path/points",
        "/ellipse/sigma",
        "/force",
    ] {
        assert!(named(name).is_some(), "{name}");
    }
}

#[test]
fn a_step_sends_what_changed_and_a_switch_what_it_changes() {
    let (mut composer, mut stage) = (Composer::default(), Stage::default());
    let mut session = session();
    shown(&mut session, &mut composer, &mut stage);
    assert_eq!(
        shown(&mut session, &mut composer, &mut stage),
        [] as [Value; 0]
    );

    session.apply(Command::SeekTo(7));
    let step = shown(&mut session, &mut composer, &mut stage);
    let updated =
        |messages: &[Value], uuid: &str| messages.iter().any(|message| message["uuid"] == uuid);
    for uuid in [
        "poescope-step",
        "poescope-frame-truth",
        "poescope-frame-belief",
        "poescope-chart-latents",
        "poescope-meta",
        "poescope-state",
    ] {
        assert!(updated(&step, uuid), "{uuid}");
    }
    for uuid in [
        "poescope-episode",
        "poescope-switch-vision",
        "poescope-keys",
        "poescope-context",
    ] {
        assert!(!updated(&step, uuid), "{uuid}");
    }
    // For other series viser's client would make a chart anew.
    let other = |message: &&Value| !message["updates"]["series"].is_null();
    assert_eq!(step.iter().find(other), None);
    assert!(
        step.iter()
            .any(|message| message["type"] == "SetPositionMessage" && message["name"] == "/plate")
    );

    session.apply(Command::ToggleExpert(0));
    let switch = shown(&mut session, &mut composer, &mut stage);
    let vision = switch
        .iter()
        .find(|message| message["uuid"] == "poescope-switch-vision")
        .unwrap();
    assert_eq!(vision["updates"]["value"], Value::Bool(false));
    assert!(updated(&switch, "poescope-frame-belief") && updated(&switch, "poescope-chart-shares"));
    assert_eq!(switch.iter().find(other), None);
    assert!(!updated(&switch, "poescope-frame-truth"));
}

#[test]
fn the_hidden_elements_hold_what_can_be_read() {
    let mut session = session();
    session.apply(Command::SeekTo(7));
    let made = shown(
        &mut session,
        &mut Composer::default(),
        &mut Stage::default(),
    );
    let value = |uuid: &str| {
        let message = made.iter().find(|message| message["uuid"] == uuid).unwrap();
        assert_eq!(message["props"]["visible"], Value::Bool(false), "{uuid}");
        message["value"].as_str().unwrap().to_owned()
    };
    let meta: Value = serde_json::from_str(&value("poescope-meta")).unwrap();
    assert_eq!(
        (&meta["step"], &meta["steps"]),
        (&Value::from(6), &Value::from(16))
    );
    assert_eq!(meta["experts"].as_array().unwrap().len(), 4);
    assert_eq!(meta["experts"][3]["key"], "9");
    let fusion = session.snapshot().fusion.unwrap();
    let [said, prior] = [&meta["experts"][0]["nis"], &meta["experts"][3]["nis"]];
    assert_eq!(said["dof"], fusion.experts[0].nis.unwrap().dof);
    assert!(said["head"].is_number() && said["propagated"].is_number());
    assert!(said["bounds"]["low"].is_number() && said["bounds"]["high"].is_number());
    assert!(prior.is_null(), "the prior is no sensor");
    let keys: Value = serde_json::from_str(&value("poescope-keys")).unwrap();
    assert!(keys.as_array().unwrap().len() > 30);
    assert_eq!(value("poescope-state"), session.snapshot().state);
}

#[test]
fn nobody_can_touch_what_is_only_to_be_read() {
    let snapshot = session().snapshot();
    let read_only = Shown {
        read_only: true,
        ..Shown::default()
    };
    let pieces = Composer::default().compose(&snapshot, read_only);
    let disabled = pieces
        .iter()
        .filter(|piece| piece.part("disabled") == Some(&[0xc3]));
    assert!(disabled.count() > 20);
}
