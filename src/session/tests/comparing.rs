//! Two models under one cursor, and what the fusion at the cursor is made of.

use super::*;

fn pair() -> Session {
    session_of(vec![
        Arc::new(FakePredictor::three()),
        Arc::new(FakePredictor::joint()),
        Arc::new(FakePredictor::vision()),
    ])
}

#[test]
fn the_next_model_stands_beside_the_first_with_the_same_cursor_and_switches() {
    let mut session = pair();
    let both = run(&mut session, [SeekTo(8), ToggleExpert(0)]);
    let other = both.other.unwrap();
    assert_eq!(other.model, 1);
    let alone = run(&mut session, [SelectModel(1)]);
    assert_eq!(alone.cursor, 7);
    assert_eq!(alone.frames.belief, other.frames.belief);
    assert_eq!(alone.frames.prediction, other.frames.prediction);
    assert_eq!(alone.position, other.position);
    assert_eq!(alone.experts[0].alpha, 0.0, "vision stays off");
    let chosen = run(&mut session, [SelectModel(0), CompareWith(2)]);
    assert_eq!(chosen.other.unwrap().model, 2);
    assert!(
        session_of(vec![Arc::new(FakePredictor::joint())])
            .snapshot()
            .other
            .is_none()
    );
}

#[test]
fn the_model_beside_says_what_it_was_not_trained_on_and_when_it_is_silent() {
    let mut session = pair();
    let badge = |snapshot: Snapshot| snapshot.other.unwrap().badge.clone();
    assert_eq!(badge(run(&mut session, [])), Badge::Trained);
    let off = run(&mut session, [ToggleExpert(0)]);
    assert_eq!(off.badge, Badge::Trained, "any sensors will do");
    let why = "J never trained; trained: V+J".to_owned();
    assert_eq!(badge(off), Badge::Untrained(why));
    // Only the other model has a joint expert; here touch and joints are on.
    let silent = [
        SelectModel(1),
        ToggleExpert(1),
        SelectModel(0),
        CompareWith(1),
        ToggleExpert(3),
    ];
    let shown = silent.map(|command| run(&mut session, [command]));
    let fault = shown[4].other.as_ref().unwrap().fault.clone();
    let fault = fault.unwrap_or_else(|| panic!("{}: {}", text(&shown[4]), shown[4].state));
    assert!(fault.contains("without an active expert"), "{fault}");
    // What it is repaired by, once it is looked at, does not stand in the way of all that was done before.
    run(&mut session, [SelectModel(1)]);
    let undone = run(&mut session, std::iter::repeat_n(Undo, 8));
    assert!(undone.experts.iter().all(|view| view.alpha == 1.0));
    assert_eq!(run(&mut session, [SelectModel(0)]).badge, Badge::Trained);
}

#[test]
fn the_difference_is_of_what_is_shown() {
    let mut session = pair();
    let snapshot = run(&mut session, [SeekTo(8), ToggleExpert(0)]);
    let other = snapshot.other.unwrap();
    let own = snapshot.frames.prediction.unwrap();
    let beside = other.frames.prediction.clone().unwrap();
    let difference = other.difference.clone().unwrap();
    let expected: Vec<i16> = std::iter::zip(&own.pixels, &beside.pixels)
        .map(|(&a, &b)| i16::from(a) - i16::from(b))
        .collect();
    assert_eq!(difference.values, expected);
}

#[test]
fn the_pulls_add_up_to_the_correction() {
    let mut session = session();
    for switch in [
        SeekTo(7),
        ToggleExpert(1),
        ToggleExpert(3),
        Temper {
            expert: 0,
            tenths: -6,
        },
    ] {
        let fusion = run(&mut session, [switch]).fusion.unwrap();
        let correction = fusion.correction_m.unwrap();
        for axis in 0..2 {
            let pulls = fusion.experts.iter().filter_map(|e| e.pull_m);
            let sum: f32 = pulls.map(|pull| pull[axis]).sum();
            assert!((sum - correction[axis]).abs() < 1e-5);
        }
    }
}

#[test]
fn leaving_an_expert_out_here_is_switching_it_off_here() {
    let mut session = session();
    let fusion = run(&mut session, [SeekTo(7), CycleScope, CycleScope])
        .fusion
        .unwrap();
    let ghost = fusion.experts[0].without.unwrap();
    let without = run(&mut session, [ToggleExpert(0)]).position.unwrap();
    let there = without.belief[6].unwrap();
    assert!((ghost.x - there.x).abs() < 1e-6 && (ghost.y - there.y).abs() < 1e-6);
    assert!((ghost.covariance[0] / there.covariance[0] - 1.0).abs() < 1e-4);
}

#[test]
fn readings_of_an_expert_that_is_off_are_none() {
    let mut session = session();
    let fusion = run(&mut session, [SeekTo(7), ToggleExpert(0)])
        .fusion
        .unwrap();
    assert!(fusion.experts[0].nis.is_none() && fusion.experts[0].without.is_none());
    assert!(fusion.experts[1].nis.is_some() && fusion.experts[3].nis.is_none());
    assert_eq!(fusion.disagreements.len(), 3);
    assert!(fusion.conflict.is_some());
    let alone = run(&mut session, [ToggleExpert(1), ToggleExpert(2)])
        .fusion
        .unwrap();
    assert!(alone.conflict.is_none() && alone.disagreements.is_empty());
}
