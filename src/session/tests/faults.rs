//! Slow, broken and absent: models and recordings that do not behave.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex};

use super::*;
use crate::episode::{Episode, EpisodeMeta, Frame, Layout, SourceError};
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace, GaussianTrace, Rolled};
use crate::session::predict::PredictError;
use crate::session::snapshot::Estimate;

/// A door that the filter waits at, once closed.
#[derive(Default)]
struct Door {
    closed: Mutex<bool>,
    opened: Condvar,
    waiting: AtomicUsize,
}

impl Door {
    fn pass(&self) {
        let mut closed = self.closed.lock().unwrap();
        self.waiting.fetch_add(1, Ordering::SeqCst);
        while *closed {
            closed = self.opened.wait(closed).unwrap();
        }
    }

    fn set_closed(&self, closed: bool) {
        *self.closed.lock().unwrap() = closed;
        self.opened.notify_all();
    }
}

/// The fake model with a door before its filter, which panics where haptic is off, and a sense it may lack.
struct Awkward {
    inner: FakePredictor,
    door: Arc<Door>,
    missing: Vec<String>,
    /// How many latents each call decoded.
    decoded: Arc<Mutex<Vec<usize>>>,
    /// Whether it decodes nothing.
    blind: bool,
}

impl Predictor for Awkward {
    fn info(&self) -> &ModelInfo {
        self.inner.info()
    }
    fn layout(&self) -> Layout {
        self.inner.layout()
    }
    fn missing(&self, _: &Episode) -> Vec<String> {
        self.missing.clone()
    }
    fn encode(&self, episode: &Episode) -> Result<ExpertTrace, PredictError> {
        self.inner.encode(episode)
    }
    fn filter(&self, trace: &ExpertTrace, alphas: &Alphas) -> Result<BeliefTrace, PredictError> {
        self.door.pass();
        assert!(alphas.row(0)[1] > 0.0, "haptic is off");
        self.inner.filter(trace, alphas)
    }
    fn encode_expert(&self, e: &Episode, expert: usize) -> Result<GaussianTrace, PredictError> {
        self.inner.encode_expert(e, expert)
    }
    fn transitions(&self, b: &BeliefTrace) -> Result<Vec<f32>, PredictError> {
        self.inner.transitions(b)
    }
    fn rollout(
        &self,
        b: &BeliefTrace,
        from: usize,
        controls: &[[f32; 2]],
    ) -> Result<Rolled, PredictError> {
        self.inner.rollout(b, from, controls)
    }
    fn sample(
        &self,
        b: &BeliefTrace,
        from: usize,
        controls: &[[f32; 2]],
        noise: &[f32],
    ) -> Result<Vec<f32>, PredictError> {
        self.inner.sample(b, from, controls, noise)
    }
    fn decode(&self, latents: &[f32]) -> Result<Vec<Frame>, PredictError> {
        self.decoded.lock().unwrap().push(latents.len() / 4);
        if self.blind {
            return Err(PredictError("it sees nothing".to_owned()));
        }
        self.inner.decode(latents)
    }
    fn position(&self, _: &[f32], _: &[f32]) -> Option<Estimate> {
        None
    }
    fn position_weights(&self) -> Option<&[f32]> {
        None
    }
    fn position_bias(&self) -> Option<[f32; 2]> {
        None
    }
    fn position_residual(&self) -> Option<[f32; 3]> {
        None
    }
}

fn awkward(missing: &[&str]) -> (Session, Arc<Door>) {
    let (session, door, _) = logged(missing);
    (session, door)
}

fn logged(missing: &[&str]) -> (Session, Arc<Door>, Arc<Mutex<Vec<usize>>>) {
    let decoded = Arc::default();
    let door = Arc::new(Door::default());
    let model = Awkward {
        inner: FakePredictor::three(),
        door: Arc::clone(&door),
        missing: missing.iter().map(|&role| role.to_owned()).collect(),
        decoded: Arc::clone(&decoded),
        blind: false,
    };
    (session_of(vec![Arc::new(model)]), door, decoded)
}

#[test]
fn a_panic_is_told_and_the_session_lives_on() {
    let (mut session, _) = awkward(&[]);
    let broken = run(&mut session, [SeekTo(4), ToggleExpert(1)]);
    assert!(!broken.busy && broken.frames.truth.is_some());
    assert_eq!(broken.experts[1].alpha, 0.0);
    assert_eq!(text(&broken), "the model broke down: haptic is off");
    // It stands: what else is told does not tell it again.
    let spoken = run(&mut session, [SetSpeed(2.0)]);
    assert_eq!((&spoken.message, spoken.told), (&broken.message, 0));
    let mended = run(&mut session, [ToggleExpert(1)]);
    assert!(mended.told > 0 && mended.frames.belief.is_some());
}

#[test]
fn a_model_beside_that_cannot_decode_leaves_the_first_one_alone() {
    let beside = Awkward {
        inner: FakePredictor::three(),
        door: Arc::default(),
        missing: Vec::new(),
        decoded: Arc::default(),
        blind: true,
    };
    let mut session = session_of(vec![Arc::new(FakePredictor::three()), Arc::new(beside)]);
    let shown = run(&mut session, [SeekTo(4)]);
    assert!(
        shown.message.is_none() && shown.strip.iter().skip(1).all(|cell| cell.belief.is_some())
    );
    let fault = shown.other.as_ref().and_then(|other| other.fault.clone());
    assert_eq!(fault.as_deref(), Some("it sees nothing"));
}

#[test]
fn only_the_newest_request_is_answered() {
    let (mut session, door) = awkward(&[]);
    run(&mut session, [SeekTo(5)]);
    let before = door.waiting.load(Ordering::SeqCst);
    door.set_closed(true);
    session.apply(SetAlpha {
        expert: 0,
        alpha: 0.9,
    });
    while door.waiting.load(Ordering::SeqCst) == before {
        std::thread::yield_now();
    }
    // The worker stands at the door with the first of these; the others replace each other.
    let held = session.snapshot();
    assert!(
        held.busy && held.frames.belief.is_some(),
        "the last picture stays"
    );
    for tenth in 1..9 {
        session.apply(SetAlpha {
            expert: 0,
            alpha: tenth as f32 / 10.0,
        });
        session.update(Duration::from_millis(1));
    }
    door.set_closed(false);
    let last = run(
        &mut session,
        [SetAlpha {
            expert: 0,
            alpha: 0.05,
        }],
    );
    assert_eq!(last.experts[0].alpha, 0.05);
    assert_eq!(
        session
            .answer
            .as_ref()
            .unwrap()
            .inferred
            .as_ref()
            .unwrap()
            .alphas
            .row(0)[0],
        0.05
    );
    assert!(
        door.waiting.load(Ordering::SeqCst) <= before + 3,
        "held keys leave no backlog"
    );
}

#[test]
fn what_is_under_the_cursor_is_decoded_first() {
    let (mut session, _, decoded) = logged(&[]);
    run(&mut session, [SeekTo(8)]);
    decoded.lock().unwrap().clear();
    run(&mut session, [ToggleExpert(0)]);
    let sizes = decoded.lock().unwrap().clone();
    assert_eq!(
        sizes[..2],
        [1, 1],
        "the belief and the prediction at the cursor"
    );
    assert_eq!(
        sizes.iter().sum::<usize>(),
        15 + 11,
        "then each other step once"
    );
    assert!(sizes.iter().all(|&size| size <= 4));
}

#[test]
fn an_answer_to_an_earlier_question_is_dropped() {
    let mut session = session();
    let stale = session.answer.clone().unwrap();
    session.apply(ToggleExpert(0));
    assert!(!session.take_in(stale));
}

#[test]
fn a_recording_that_lacks_a_sense_can_be_watched() {
    let (mut session, _) = awkward(&["haptic"]);
    let snapshot = session.snapshot();
    assert!(is_refusal(&snapshot) && text(&snapshot).contains("needs haptic"));
    let snapshot = run(&mut session, [SeekTo(3), ToggleExpert(0)]);
    assert!(
        snapshot.frames.truth.is_some() && snapshot.belief.is_none() && snapshot.position.is_none()
    );
    assert_eq!(snapshot.episode.unwrap().missing, ["haptic"]);
}

/// Its second episode cannot be read.
struct Torn(FakeSource);

impl EpisodeSource for Torn {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn data_hash(&self) -> &str {
        self.0.data_hash()
    }
    fn metas(&self) -> &[EpisodeMeta] {
        self.0.metas()
    }
    fn load(&self, index: usize, layout: Layout) -> Result<Episode, SourceError> {
        if index == 1 {
            return Err(SourceError(
                "squares.mcap: cut off at byte 77; copy it again".to_owned(),
            ));
        }
        self.0.load(index, layout)
    }
}

#[test]
fn an_episode_that_cannot_be_read_is_told_and_left_again() {
    let mut session = Session::new(
        Arc::new(Torn(FakeSource::new(3))),
        vec![Arc::new(FakePredictor::three())],
    );
    let torn = run(&mut session, [Last, Episode(1), Step(-1)]);
    assert!(torn.episode.is_none());
    assert_eq!(
        text(&torn),
        "squares.mcap: cut off at byte 77; copy it again"
    );
    assert_eq!(text(&run(&mut session, [Step(1)])), "no episode is open");
    assert!(run(&mut session, [Episode(1)]).frames.truth.is_some());
}

#[test]
fn what_a_state_says_of_every_episode_waits_for_one_that_can_be_read() {
    let mut session = Session::new(
        Arc::new(Torn(FakeSource::new(3))),
        vec![Arc::new(FakePredictor::three())],
    );
    let state = "v=1;episode=square_01;step=5;alpha=vision:0;horizion=7";
    let torn = run(&mut session, [Restore(state.to_owned())]);
    assert!(torn.episode.is_none() && text(&torn).contains("cut off"));
    let next = run(&mut session, [Episode(1)]);
    assert_eq!((next.cursor, next.experts[0].alpha), (0, 0.0));
    assert!(text(&next).contains("horizion"), "{}", text(&next));
}

#[test]
fn steps_of_an_episode_that_is_left_unseen_are_forgotten() {
    let mut session = Session::new(
        Arc::new(FakeSource::new(3)),
        vec![Arc::new(FakePredictor::three())],
    );
    // Nothing has been read yet.
    let next = run(
        &mut session,
        [SeekTo(9), PredictHere, ToggleExpert(0), Episode(1)],
    );
    assert_eq!((next.cursor, next.context), (0, 4));
    assert_eq!(next.experts[0].alpha, 0.0, "the whole episode's is of any");
}
