//! Scripts of commands, then a look at the snapshot.
#![expect(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a test may stop here; α is compared as it was set"
)]

mod comparing;
mod damaging;
mod faults;
mod finding;
mod lattice;
mod random;
mod renewing;
mod restoring;
mod switching;

use super::fake::{FakePredictor, FakeSource};
use super::*;
use crate::session::command::{Command::*, Looping};
use crate::session::snapshot::{Badge, ErrorOf};

const LONG: Duration = Duration::from_secs(20);

fn session_of(models: Vec<Arc<dyn Predictor>>) -> Session {
    let mut session = Session::new(Arc::new(FakeSource::new(4)), models);
    assert!(session.wait_idle(LONG));
    session
}

fn session() -> Session {
    session_of(vec![Arc::new(FakePredictor::three())])
}

/// Applies the commands and waits for what they asked for.
fn run(session: &mut Session, commands: impl IntoIterator<Item = Command>) -> Snapshot {
    for command in commands {
        session.apply(command);
    }
    assert!(session.wait_idle(LONG));
    session.snapshot()
}

fn text(snapshot: &Snapshot) -> &str {
    snapshot
        .message
        .as_ref()
        .map_or("", |message| &message.text)
}

fn is_refusal(snapshot: &Snapshot) -> bool {
    snapshot
        .message
        .as_ref()
        .is_some_and(|message| message.error)
}

#[test]
fn shows_the_first_episode_whole() {
    let snapshot = session().snapshot();
    let episode = snapshot.episode.unwrap();
    assert_eq!((episode.id.as_str(), episode.secs.len()), ("square_00", 16));
    assert_eq!(
        (snapshot.context, snapshot.horizon, snapshot.start),
        (4, 11, 3)
    );
    assert_eq!(snapshot.strip.len(), 16);
    for cell in snapshot.strip.iter() {
        assert_eq!(cell.belief.is_some(), cell.step >= 1);
        assert_eq!(cell.prediction.is_some(), (4..15).contains(&cell.step));
    }
    assert!(snapshot.psnr_db[9].belief.unwrap() > 15.0);
    assert!(!snapshot.busy && snapshot.belief.is_none());
    assert_eq!(snapshot.message, None);
}

#[test]
fn the_step_under_the_cursor_has_everything() {
    let snapshot = run(&mut session(), [SeekTo(7)]);
    assert_eq!(snapshot.cursor, 6);
    assert_eq!(snapshot.frames.error_of, ErrorOf::Prediction);
    assert!(snapshot.frames.error.is_some() && snapshot.frames.belief.is_some());
    let shares: f32 = snapshot
        .experts
        .iter()
        .map(|expert| expert.share_mean)
        .sum();
    let position: f32 = snapshot
        .experts
        .iter()
        .filter_map(|expert| expert.share_position)
        .sum();
    assert!((shares - 1.0).abs() < 1e-5 && (position - 1.0).abs() < 1e-5);
    assert_eq!(snapshot.belief.unwrap().mean.len(), 4);
    assert!(snapshot.position.unwrap().belief_error_m.unwrap() < 0.03);
    assert_eq!(snapshot.badge, Badge::Trained);
}

#[test]
fn the_cursor_moves_within_the_episode() {
    let mut session = session();
    assert_eq!(run(&mut session, [Step(-3)]).cursor, 0);
    assert_eq!(run(&mut session, [Last, Step(1)]).cursor, 15);
    let refused = run(&mut session, [SeekTo(17)]);
    assert_eq!(
        (refused.cursor, text(&refused)),
        (15, "step 17 is outside 1 to 16")
    );
    assert_eq!(run(&mut session, [SeekClamped(99)]).cursor, 15);
    assert_eq!(run(&mut session, [First]).cursor, 0);
}

#[test]
fn another_episode_keeps_cursor_switches_and_playing() {
    let mut session = session();
    let snapshot = run(
        &mut session,
        [Last, ToggleExpert(1), TogglePlay, SelectEpisode(3)],
    );
    assert_eq!(
        (snapshot.episode_index, snapshot.cursor, snapshot.playing),
        (3, 12, true)
    );
    assert!(snapshot.experts[1].alpha == 0.0 && snapshot.strip.len() == 13);
    assert_eq!((snapshot.start, snapshot.horizon), (3, 9));
    let snapshot = run(&mut session, [Episode(9)]);
    assert_eq!(text(&snapshot), "this is the last episode");
    assert!(is_refusal(&run(&mut session, [SelectEpisode(4)])));
}

#[test]
fn commands_wait_for_the_episode_they_are_about() {
    let source = Arc::new(FakeSource::new(2));
    let mut session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
    let snapshot = run(&mut session, [Last, Step(-2), ToggleExpert(0), CycleScope]);
    assert_eq!(
        (snapshot.cursor, snapshot.scope),
        (13, command::Scope::Onward)
    );
    assert_eq!(snapshot.experts[0].alpha, 0.0);
}

#[test]
fn playing_follows_the_clock_and_ends_or_loops() {
    let mut session = session();
    session.apply(TogglePlay);
    assert!(session.next_wake().is_some());
    for _ in 0..3 {
        session.update(Duration::from_millis(100));
    }
    assert_eq!(session.snapshot().cursor, 1);
    for _ in 0..15 * 3 {
        session.update(Duration::from_millis(100));
    }
    assert!(session.snapshot().playing && session.snapshot().cursor < 4);
    assert_eq!(run(&mut session, [CycleLoop]).looping, Looping::Off);
    for _ in 0..17 * 3 {
        session.update(Duration::from_millis(100));
    }
    let snapshot = session.snapshot();
    assert_eq!((snapshot.cursor, snapshot.playing), (15, false));
}

#[test]
fn idle_means_nothing_to_do() {
    let mut session = session();
    session.update(Duration::ZERO);
    assert_eq!(session.next_wake(), None);
    assert!(!session.update(Duration::from_secs(5)));
}

#[test]
fn context_and_horizon_move_the_rollout() {
    let mut session = session();
    let snapshot = run(&mut session, [SeekTo(9), PredictHere]);
    assert_eq!(
        (snapshot.start, snapshot.context, snapshot.horizon),
        (8, 9, 7)
    );
    assert!(snapshot.strip[8].prediction.is_none() && snapshot.strip[9].prediction.is_some());
    for refused in [[First, PredictHere], [Last, PredictHere]] {
        let snapshot = run(&mut session, refused);
        assert!(is_refusal(&snapshot));
        assert_eq!(snapshot.start, 8);
    }
    let snapshot = run(&mut session, [SetContext(4), SetHorizon(2), Context(1)]);
    assert_eq!((snapshot.start, snapshot.horizon), (4, 2));
    let predicted = snapshot
        .strip
        .iter()
        .filter(|cell| cell.prediction.is_some())
        .map(|cell| cell.step);
    assert_eq!(predicted.collect::<Vec<_>>(), [5, 6]);
    let snapshot = run(&mut session, [Context(-99), Horizon(99)]);
    assert_eq!((snapshot.context, snapshot.horizon), (2, 14));
}

#[test]
fn the_state_string_brings_everything_back() {
    let mut first = session_of(vec![
        Arc::new(FakePredictor::joint()),
        Arc::new(FakePredictor::three()),
    ]);
    let script = [
        SelectModel(1),
        SelectEpisode(2),
        SeekTo(6),
        CycleScope,
        ToggleExpert(1),
        CycleScope,
        ToggleExpert(0),
    ];
    let there = run(
        &mut first,
        script.into_iter().chain([SetHorizon(3), Speed(-1)]),
    );
    assert!(
        there.state.contains("alpha=vision:0@6,haptic:0@6-"),
        "{}",
        there.state
    );

    let mut second = session_of(vec![
        Arc::new(FakePredictor::joint()),
        Arc::new(FakePredictor::three()),
    ]);
    let back = run(&mut second, [Restore(format!("{};lens=3", there.state))]);
    assert_eq!(text(&back), "kept without a meaning here: lens");
    assert!(!is_refusal(&back), "a later version may have written it");
    assert_eq!(back.state, format!("{};lens=3", there.state));
    assert_eq!(
        (back.belief, back.frames.belief),
        (there.belief, there.frames.belief)
    );
    // As text, for shares over time begin with NaN, which is not equal to itself.
    assert_eq!(
        format!("{:?}", back.experts),
        format!("{:?}", there.experts)
    );
}

#[test]
fn a_bad_state_string_is_told_and_the_rest_counts() {
    let mut session = session();
    let snapshot = run(
        &mut session,
        [Restore(
            "v=1;episode=none;step=99;horizon=2;alpha=vision:0,haptic:0,proprio:0,prior:0"
                .to_owned(),
        )],
    );
    for key in ["episode:", "step:", "alpha:"] {
        assert!(
            text(&snapshot).contains(key),
            "{key} in {}",
            text(&snapshot)
        );
    }
    assert_eq!((snapshot.horizon, snapshot.cursor), (2, 0));
    assert_eq!(snapshot.badge, Badge::Trained);
}

#[test]
fn the_waker_is_called_when_something_is_ready() {
    let mut session = session();
    let (sender, receiver) = std::sync::mpsc::sync_channel(64);
    session.set_waker(Box::new(move || {
        let _ = sender.try_send(());
    }));
    session.apply(ToggleExpert(0));
    // It sleeps until then.
    assert_eq!(session.next_wake(), None);
    receiver.recv_timeout(LONG).unwrap();
}

#[test]
fn a_session_without_models_still_shows_the_recording() {
    let snapshot = run(&mut session_of(Vec::new()), [SeekTo(3), ToggleExpert(0)]);
    assert!(snapshot.frames.truth.is_some() && is_refusal(&snapshot));
    let mut empty = Session::new(Arc::new(FakeSource::new(0)), Vec::new());
    let snapshot = run(
        &mut empty,
        [Step(1), Last, TogglePlay, Episode(1), ToggleExpert(0)],
    );
    assert!(snapshot.episode.is_none() && is_refusal(&snapshot));
}

#[test]
fn an_episode_can_be_too_short_to_predict_anything() {
    let source = Arc::new(FakeSource::with_steps(1, 2));
    let mut session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
    let snapshot = run(&mut session, [Last]);
    assert_eq!((snapshot.start, snapshot.horizon), (1, 0));
    assert!(snapshot.frames.belief.is_some() && snapshot.frames.prediction.is_none());
    assert!(is_refusal(&run(&mut session, [PredictHere])));
    assert_eq!(run(&mut session, [Context(5), Horizon(-2)]).horizon, 0);
}
