//! Scripts of keys, then a look at what they ask for.
#![expect(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a test may stop here; numbers are compared as they were set"
)]

mod bench;
mod prompt;

use std::sync::Arc;
use std::time::Duration;

use super::*;
use crate::session::Session;
use crate::session::fake::{FakePredictor, FakeSource};
use crate::session::keys::parse_script;

/// Presses the keys of a script; returns the session's snapshot and what it was not for the session to do.
fn press(script: &str) -> (Snapshot, Vec<Action>, Input) {
    let mut session = Session::new(
        Arc::new(FakeSource::new(3)),
        vec![Arc::new(FakePredictor::three())],
    );
    let (mut input, mut others) = (Input::default(), Vec::new());
    for key in parse_script(script).unwrap() {
        assert!(session.wait_idle(Duration::from_secs(20)));
        match input.press(&key, &session.snapshot()) {
            Some(Action::Session(command)) => session.apply(command),
            other => others.extend(other),
        }
    }
    assert!(session.wait_idle(Duration::from_secs(20)));
    (session.snapshot(), others, input)
}

/// The session's snapshot after a script.
fn snapshot(script: &str) -> Snapshot {
    press(script).0
}

/// What the keys of a script ask for, in the face of a snapshot that stays as it is.
fn asked(input: &mut Input, script: &str, snapshot: &Snapshot) -> Vec<Action> {
    let keys = parse_script(script).unwrap();
    keys.iter()
        .filter_map(|key| input.press(key, snapshot))
        .collect()
}

/// The same from the start, of the session only.
fn commands(script: &str, snapshot: &Snapshot) -> Vec<Command> {
    let asked = asked(&mut Input::default(), script, snapshot).into_iter();
    asked
        .map(|action| match action {
            Action::Session(command) => command,
            other => panic!("{other:?}"),
        })
        .collect()
}

fn alphas(script: &str) -> Vec<f32> {
    press(script)
        .0
        .experts
        .iter()
        .map(|view| view.alpha)
        .collect()
}

#[test]
fn plain_keys_follow_the_table() {
    let (snapshot, others, _) = press("lll<right>h 2 ] ?");
    assert_eq!((snapshot.cursor, snapshot.episode_index), (3, 1));
    assert_eq!(snapshot.experts[1].alpha, 0.0);
    assert_eq!(others, [Action::Face(FaceCommand::Help)]);
}

#[test]
fn digits_switch_and_nine_is_the_prior() {
    assert_eq!(alphas("l9"), [1.0, 1.0, 1.0, 0.0]);
    assert_eq!(alphas("S3"), [0.0, 0.0, 1.0, 1.0]);
    assert_eq!(alphas("12 0"), [1.0; 4]);
    let alone = snapshot("S9");
    let why = alone
        .message
        .as_ref()
        .map(|message| (message.error, &*message.text));
    assert_eq!(
        why,
        Some((true, "solo is for sensors; the prior stays as it is"))
    );
    assert!(alone.experts.iter().all(|expert| expert.alpha == 1.0));
    let (snapshot, others, _) = press("4");
    assert_eq!(snapshot.message, None);
    let text = "there are 3 sensor experts; 9 is the prior".to_owned();
    assert_eq!(others, [Action::Explain { error: true, text }]);
}

#[test]
fn tempering_counts_in_tenths_and_comes_back_to_one() {
    assert_eq!(alphas("a2---"), [1.0, 0.7, 1.0, 1.0]);
    assert_eq!(alphas("a2---==="), [1.0; 4]);
    let (_, _, input) = press("a2-<esc>");
    assert_eq!((input.mode(), input.focused_expert()), (None, 1));
}

#[test]
fn another_key_ends_a_mode_and_does_what_it_always_does() {
    let (snapshot, _, input) = press("c=== l C--- l");
    assert_eq!(
        (snapshot.context, snapshot.horizon, snapshot.cursor),
        (7, 6, 2)
    );
    assert_eq!(input.mode(), None);
}
