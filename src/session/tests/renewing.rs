//! A model that is replaced by a newer one while it is looked at.

use super::*;

fn shown_update(snapshot: &Snapshot) -> Option<u64> {
    snapshot.models[snapshot.model].update
}

#[test]
fn a_newer_model_takes_over_and_everything_else_stays() {
    let mut session = session();
    let before = run(
        &mut session,
        [SelectEpisode(2), SeekTo(7), ToggleExpert(1), CycleScope],
    );
    let newer = FakePredictor::three().at_update(1200);
    let calls = newer.calls();
    session.renewal().offer(0, Ok(Arc::new(newer)));
    // Nothing happens by itself: the face is woken, and looks.
    assert_eq!(shown_update(&session.snapshot()), None);
    assert!(session.update(Duration::ZERO));
    assert!(session.snapshot().busy);
    while session.snapshot().busy {
        // Never without a picture on the way.
        let snapshot = session.snapshot();
        assert!(snapshot.frames.belief.is_some() && snapshot.belief.is_some());
        session.update(Duration::ZERO);
    }
    let after = session.snapshot();
    assert_eq!((shown_update(&after), calls.encoded()), (Some(1200), 1));
    assert_eq!((after.episode_index, after.cursor), (2, 6));
    assert_eq!(after.state, before.state);
    assert!(after.experts[1].alpha == 0.0 && after.experts[1].share_mean == 0.0);
    assert_eq!(after.message, before.message);
    // With nothing newer there is nothing to draw.
    assert!(!session.update(Duration::from_secs(1)));
    assert_eq!(session.next_wake(), None);
}

#[test]
fn a_model_that_is_not_shown_is_newer_when_it_is() {
    let models: [Arc<dyn Predictor>; 2] = [
        Arc::new(FakePredictor::three()),
        Arc::new(FakePredictor::joint()),
    ];
    let mut session = session_of(models.into());
    run(&mut session, [SelectModel(1), SelectModel(0)]);
    let [first, second] = [7, 8].map(|update| FakePredictor::joint().at_update(update));
    let calls = [first.calls(), second.calls()];
    for newer in [first, second] {
        session.renewal().offer(1, Ok(Arc::new(newer)));
    }
    session.update(Duration::ZERO);
    assert_eq!(shown_update(&run(&mut session, [])), None);
    assert_eq!(shown_update(&run(&mut session, [SelectModel(1)])), Some(8));
    assert_eq!(calls.map(|calls| calls.encoded()), [0, 1]);
}

#[test]
fn one_that_cannot_be_had_is_told_and_the_picture_stays() {
    let mut session = session();
    run(&mut session, [SeekTo(7)]);
    let why = "runs/a/weights.safetensors: damaged";
    session.renewal().offer(0, Err(why.to_owned()));
    assert!(session.update(Duration::ZERO));
    let snapshot = session.snapshot();
    assert!(is_refusal(&snapshot) && text(&snapshot) == why);
    assert!(snapshot.frames.belief.is_some() && !snapshot.busy);
}
