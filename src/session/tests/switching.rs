//! Switches: what they change, what they leave alone, what is refused.

use super::*;
use crate::session::fake::Calls;
use crate::session::snapshot::LatentView;

fn counted() -> (Session, Arc<Calls>) {
    let model = FakePredictor::three();
    let calls = model.calls();
    (session_of(vec![Arc::new(model)]), calls)
}

fn belief(snapshot: &Snapshot) -> LatentView {
    snapshot.belief.clone().unwrap()
}

#[test]
fn a_switch_changes_the_belief_and_never_encodes() {
    let (mut session, calls) = counted();
    let before = run(&mut session, [SeekTo(6)]);
    let after = run(&mut session, [ToggleExpert(0)]);
    assert_ne!(belief(&before), belief(&after));
    assert_ne!(before.frames.prediction, after.frames.prediction);
    assert_ne!(before.position, after.position);
    assert_eq!(
        (after.experts[0].alpha, after.experts[0].share_mean),
        (0.0, 0.0)
    );
    assert_eq!(text(&after), "vision off in the whole episode");
    run(
        &mut session,
        [
            ToggleExpert(1),
            CycleScope,
            ToggleExpert(2),
            AllOn,
            Undo,
            SetContext(7),
        ],
    );
    assert_eq!(calls.encoded(), 1);
}

#[test]
fn off_and_on_again_restores_every_bit() {
    let (mut session, calls) = counted();
    let before = run(&mut session, [SeekTo(6)]);
    let after = run(&mut session, [ToggleExpert(0), ToggleExpert(0)]);
    assert_eq!(
        (&before.belief, &before.position),
        (&after.belief, &after.position)
    );
    assert_eq!(before.frames.belief, after.frames.belief);
    assert_eq!(before.state, after.state);
    let filtered = calls.filtered();
    run(&mut session, [ToggleExpert(0), AllOn]);
    assert!(
        calls.filtered() <= filtered + 1,
        "what was there is shown again, not computed again"
    );
}

#[test]
fn the_scope_decides_which_steps_change() {
    let changed = |scopes: usize| {
        let (mut session, _) = counted();
        let before = run(&mut session, [SeekTo(6)]);
        let script = std::iter::repeat_n(CycleScope, scopes).chain([ToggleExpert(0)]);
        let after = run(&mut session, script);
        let alphas: Vec<usize> = (0..16)
            .filter(|&t| run(&mut session, [SeekClamped(t)]).experts[0].alpha == 0.0)
            .collect();
        let (before, after) = (
            before.position.unwrap().belief,
            after.position.unwrap().belief,
        );
        let first = (0..16).find(|&t| before[t] != after[t]).unwrap();
        (alphas, first)
    };
    assert_eq!(changed(0), ((0..16).collect(), 1));
    assert_eq!(changed(1), ((5..16).collect(), 5));
    assert_eq!(changed(2), (vec![5], 5));
}

#[test]
fn before_the_first_belief_a_switch_is_about_the_first_belief() {
    let snapshot = run(
        &mut session(),
        [First, CycleScope, CycleScope, ToggleExpert(0)],
    );
    assert_eq!((snapshot.cursor, snapshot.experts[0].alpha), (0, 0.0));
    assert!(snapshot.state.contains("alpha=vision:0@2"));
}

#[test]
fn a_refusal_changes_nothing_but_the_message() {
    let mut session = session();
    let before = run(
        &mut session,
        [SeekTo(5), ToggleExpert(0), ToggleExpert(1), ToggleExpert(2)],
    );
    assert!(
        before.experts[3].share_mean > 0.999,
        "all sensors off leaves the prior"
    );
    let generation = session.generation;
    for refused in [
        ToggleExpert(3),
        ToggleExpert(8),
        Solo(3),
        SetAlpha {
            expert: 3,
            alpha: 0.0,
        },
    ] {
        let mut after = run(&mut session, [refused]);
        assert!(is_refusal(&after));
        after.message.clone_from(&before.message);
        after.told = before.told;
        assert_eq!(
            serde_json::to_string(&after).unwrap(),
            serde_json::to_string(&before).unwrap()
        );
    }
    assert_eq!(session.generation, generation);
    let snapshot = run(&mut session, [ToggleExpert(3)]);
    assert_eq!(
        text(&snapshot),
        "prior stays on: it is the last active expert at step 2, and a belief needs one"
    );
}

#[test]
fn solo_leaves_the_prior_and_undo_brings_the_others_back() {
    let mut session = session();
    let alphas = |snapshot: &Snapshot| snapshot.experts.iter().map(|e| e.alpha).collect::<Vec<_>>();
    let solo = run(&mut session, [SeekTo(4), ToggleExpert(1), Solo(1)]);
    assert_eq!(alphas(&solo), [0.0, 1.0, 0.0, 1.0]);
    let tempered = run(
        &mut session,
        [SetAlpha {
            expert: 3,
            alpha: 0.5,
        }],
    );
    assert_eq!(tempered.badge, Badge::Untrained("prior α 0.5".to_owned()));
    assert_eq!(
        alphas(&run(&mut session, [Undo, Undo])),
        [1.0, 0.0, 1.0, 1.0]
    );
    assert_eq!(
        alphas(&run(&mut session, [Redo, Redo])),
        [0.0, 1.0, 0.0, 0.5]
    );
    assert_eq!(alphas(&run(&mut session, [AllOn])), [1.0; 4]);
}

#[test]
fn switches_follow_their_expert_to_another_model() {
    let models = || -> Vec<Arc<dyn Predictor>> {
        vec![
            Arc::new(FakePredictor::three()),
            Arc::new(FakePredictor::joint()),
            Arc::new(FakePredictor::vision()),
        ]
    };
    let mut session = session_of(models());
    let snapshot = run(
        &mut session,
        [SeekTo(5), ToggleExpert(0), ToggleExpert(2), SelectModel(1)],
    );
    assert_eq!(
        snapshot.badge,
        Badge::Untrained("J never trained; trained: V+J".to_owned())
    );
    assert_eq!(snapshot.cursor, 4);

    let alone = run(&mut session, [SelectModel(2)]);
    assert_eq!(alone.badge, Badge::NoProduct);
    assert!(alone.frames.belief.is_some());
    for refused in [ToggleExpert(0), ToggleExpert(1), Solo(0)] {
        assert!(text(&run(&mut session, [refused])).contains("no product"));
    }
    let back = run(&mut session, [SelectModel(0)]);
    assert_eq!(
        back.experts.iter().map(|e| e.alpha).collect::<Vec<_>>(),
        [0.0, 1.0, 0.0, 1.0]
    );

    let repaired = run(
        &mut session,
        [
            AllOn,
            ToggleExpert(0),
            ToggleExpert(3),
            SelectModel(1),
            ToggleExpert(1),
        ],
    );
    assert!(is_refusal(&repaired));
    let repaired = run(
        &mut session,
        [
            SelectModel(0),
            AllOn,
            SelectModel(1),
            ToggleExpert(1),
            SelectModel(0),
        ],
    );
    assert!(!is_refusal(&repaired));
    let repaired = run(
        &mut session,
        [ToggleExpert(0), ToggleExpert(3), SelectModel(1), Undo],
    );
    assert!(repaired.experts.iter().any(|e| e.alpha > 0.0));
}
