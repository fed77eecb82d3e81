//! Frames that the reference server sent, to hold our messages against. `tests/data/viser/README.md` says how they
//! were made.
#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use serde_json::Value;

use super::frame::{Frame, read};
use super::{batch, write};

/// The messages of a captured frame; array contents included.
pub fn captured(name: &str) -> Vec<Value> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/viser");
    read(&std::fs::read(folder.join(name)).unwrap())
        .unwrap()
        .messages
}

/// A message as a client reads it from a frame of ours.
pub fn sent(message: &impl serde::Serialize) -> Value {
    let written = write(message);
    let frame = batch::encode([&written[..]].into_iter(), 0.0).unwrap();
    let Frame { mut messages, .. } = read(&frame).unwrap();
    messages.remove(0)
}

/// Fails unless our message is the captured one, field for field; 1 and 1.0 are the same to the client.
pub fn holds(message: &impl serde::Serialize, name: &str, place: usize) {
    let (ours, theirs) = (sent(message), captured(name).remove(place));
    assert_eq!(floats(ours), floats(theirs), "{name}");
}

fn floats(value: Value) -> Value {
    match value {
        // What is an f32 here was written as an f64 there.
        Value::Number(number) => Value::from(number.as_f64().unwrap() as f32),
        Value::Array(values) => values.into_iter().map(floats).collect(),
        Value::Object(map) => map
            .into_iter()
            .map(|(key, value)| (key, floats(value)))
            .collect(),
        other => other,
    }
}

/// The uuid of a captured message.
pub fn uuid(name: &str) -> String {
    captured(name)[0]["uuid"].as_str().unwrap().to_owned()
}

/// The container of a captured message.
pub fn container(name: &str) -> String {
    captured(name)[0]["container_uuid"]
        .as_str()
        .unwrap()
        .to_owned()
}

#[test]
fn another_value_or_a_missing_field_would_be_seen() {
    let one = serde_json::json!({"a": 1, "b": [2.5]});
    assert_eq!(
        floats(one.clone()),
        floats(serde_json::json!({"a": 1.0, "b": [2.5]}))
    );
    assert_ne!(
        floats(one.clone()),
        floats(serde_json::json!({"a": 2, "b": [2.5]}))
    );
    assert_ne!(floats(one), floats(serde_json::json!({"a": 1})));
}
