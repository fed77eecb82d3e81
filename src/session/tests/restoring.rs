//! The state string of the bench.

use super::*;

const BENCH: &str = "v=1;episode=square_01;step=6;model=joint;compare=three;context=4;horizon=9;scope=frame;speed=1;\
    loop=selection;corrupt=vision:occlude:0.5@3-7:0.25x0.75;controls=from:6,rotate:30,mirror;samples=64;sample=on;\
    seed=7;marks=3,7;select=4-9;rank=nees";

fn two() -> Session {
    session_of(vec![
        Arc::new(FakePredictor::joint()),
        Arc::new(FakePredictor::three()),
    ])
}

/// The same with the names of the models at hand.
fn bench(session: &Session) -> String {
    let snapshot = session.snapshot();
    BENCH
        .replace("joint", &snapshot.models[0].name)
        .replace("three", &snapshot.models[1].name)
}

#[test]
fn all_of_it_comes_back() {
    let mut session = two();
    let state = bench(&session);
    let back = run(&mut session, [Restore(state.clone())]);
    assert_eq!(text(&back), "state restored");
    assert_eq!(back.state, state);
}

#[test]
fn what_is_not_mentioned_is_as_at_the_start_but_marks_and_the_second_model_stay() {
    let mut session = two();
    let state = bench(&session);
    run(&mut session, [Restore(state)]);
    let back = run(&mut session, [Restore("v=1;step=2".to_owned())]);
    for gone in [
        "corrupt=",
        "controls=",
        "sample",
        "seed=",
        "select=",
        "rank=",
    ] {
        assert!(!back.state.contains(gone), "{gone} in {}", back.state);
    }
    assert!(back.state.contains(";marks=3,7") && back.state.contains(";compare="));
    let elsewhere = run(&mut session, [Episode(-1)]);
    assert!(
        !elsewhere.state.contains("marks"),
        "they are of their episode"
    );
}

#[test]
fn damage_controls_and_samples_are_undone_and_redone() {
    let mut session = two();
    let state = bench(&session);
    run(&mut session, [Restore(state)]);
    let undone = run(&mut session, [Undo]).state;
    let redone = run(&mut session, [Redo]).state;
    for key in ["corrupt=", "controls=", "samples=64", "sample=on", "seed=7"] {
        assert!(
            !undone.contains(key) && redone.contains(key),
            "{key}: {undone} {redone}"
        );
    }
}

#[test]
fn what_does_not_fit_the_episode_is_named() {
    let mut session = two();
    let name = session.snapshot().models[0].name.clone();
    let text_of = |session: &mut Session, state: &str| {
        let snapshot = run(session, [Restore(format!("v=1;{state}"))]);
        assert!(is_refusal(&snapshot), "{state}");
        text(&snapshot).to_owned()
    };
    assert!(text_of(&mut session, "marks=2,99").contains("marks: 99 is outside"));
    assert!(session.snapshot().state.contains(";marks=2"));
    assert!(text_of(&mut session, "select=3-99").contains("select: "));
    assert!(text_of(&mut session, "compare=nobody").contains("compare: none named"));
    assert!(text_of(&mut session, &format!("compare={name}")).contains("is the model itself"));
}

#[test]
fn a_string_without_a_version_is_of_this_one() {
    let back = run(&mut two(), [Restore("step=3".to_owned())]);
    assert_eq!((text(&back), back.cursor), ("state restored", 2));
}

#[test]
fn an_expert_that_no_model_has_is_told() {
    let mut session = session_of(vec![Arc::new(FakePredictor::three())]);
    let told = run(&mut session, [Restore("alpha=joint:0".to_owned())]);
    assert!(is_refusal(&told), "{}", text(&told));
    assert_eq!(text(&told), "alpha: no model here has the expert joint");
    let of_one = run(&mut two(), [Restore("alpha=joint:0.5".to_owned())]);
    assert!(!is_refusal(&of_one), "{}", text(&of_one));
}

#[test]
fn marks_never_reach_an_episode_that_was_gone_to_meanwhile() {
    let mut session = two();
    let state = "episode=square_02;step=6;marks=3,7".to_owned();
    let there = run(&mut session, [Restore(state), Episode(-1)]);
    assert!(there.state.contains("episode=square_01"), "{}", there.state);
    assert!(!there.state.contains("marks"), "{}", there.state);
}
