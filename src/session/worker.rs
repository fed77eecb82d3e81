//! The thread that computes: it owns the models, serves the newest request and publishes as it goes.
//!
//! Requests and answers each lie in a mailbox of one: a newer one replaces an older one, so held keys leave no
//! backlog and a face never waits. Between any two steps of work the thread looks for a newer request. An answer is
//! cumulative, so one that was never collected is no loss.

mod lru;
mod mailbox;
mod memo;
mod opened;
mod pictured;

use std::any::Any;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

pub use mailbox::Mailbox;
use memo::{BeliefKey, Memo};
pub use memo::{Inferred, Target};
pub use opened::Opened;

use super::predict::{PredictError, Predictor};
use super::settings::{Rollout, Settings};
use super::snapshot::{Estimate, StepPsnr, StripCell};
use crate::episode::{EpisodeSource, Layout, SourceError};

/// Name of the thread, for those who look at threads; a panic on it is caught and told as a message.
pub const THREAD: &str = "poescope-session";
/// Frames decoded between two looks for a newer request.
const DECODED_AT_ONCE: usize = 4;

/// What a session wants computed.
#[derive(Clone, Debug)]
pub struct Request {
    /// Rises with each change of what is wanted; stays when only the cursor moves.
    pub generation: u64,
    /// Which model on which episode.
    pub target: Target,
    /// With which switches, context and horizon.
    pub settings: Settings,
    /// The step whose frames come first.
    pub cursor: usize,
}

/// What has been computed of a request so far.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Of which request.
    pub generation: u64,
    /// Which model on which episode.
    pub target: Target,
    /// The episode, once read.
    pub opened: Option<Arc<Opened>>,
    /// The beliefs, once filtered.
    pub inferred: Option<Arc<Inferred>>,
    /// Positions at each step from the beliefs; none without a probe.
    pub belief_positions: Option<Arc<Vec<Option<Estimate>>>>,
    /// Positions at each step from the rollout; none without a probe.
    pub rollout_positions: Option<Arc<Vec<Option<Estimate>>>>,
    /// The frames of each step.
    pub strip: Arc<Vec<StripCell>>,
    /// PSNR of each step.
    pub psnr_db: Arc<Vec<StepPsnr>>,
    /// What went wrong.
    pub fault: Option<String>,
    /// Whether nothing more will come.
    pub done: bool,
}

impl Answer {
    fn new(request: &Request) -> Self {
        Self {
            generation: request.generation,
            target: request.target,
            opened: None,
            inferred: None,
            belief_positions: None,
            rollout_positions: None,
            strip: Arc::default(),
            psnr_db: Arc::default(),
            fault: None,
            done: false,
        }
    }
}

/// Called on the worker's thread after each publication.
pub type Waker = Box<dyn Fn() + Send>;

/// A newer model, or why it cannot be had.
pub type Found = Result<Arc<dyn Predictor>, String>;

/// What both threads hold.
#[derive(Default)]
pub struct Shared {
    /// To the worker.
    pub requests: Mailbox<Request>,
    /// From the worker.
    pub answers: Mailbox<Answer>,
    /// Wakes the face.
    pub waker: Mutex<Option<Waker>>,
    /// To the worker, before its next request: models that take the place of others.
    pub successors: Mutex<BTreeMap<usize, Arc<dyn Predictor>>>,
    /// To the session, from whoever watches its models.
    pub renewed: Mutex<BTreeMap<usize, Found>>,
}

impl Shared {
    /// Has the face look at what is new.
    pub fn wake(&self) {
        let waker = self.waker.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(wake) = waker.as_ref() {
            wake();
        }
    }
}

/// Starts the thread; it ends when the mailbox of requests is closed.
pub fn spawn(
    shared: Arc<Shared>,
    source: Arc<dyn EpisodeSource>,
    predictors: Vec<Arc<dyn Predictor>>,
) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new()
        .name(THREAD.to_owned())
        .spawn(move || {
            let mut worker = Worker {
                source,
                predictors,
                memo: Memo::default(),
                shown: Cell::default(),
                shared: Arc::clone(&shared),
            };
            while let Some(request) = shared.requests.wait() {
                worker.serve(&request);
            }
        })
}

/// Why work on a request ended early.
enum Stop {
    /// A newer request is there.
    Interrupted,
    /// It cannot be done.
    Fault(String),
}

impl From<SourceError> for Stop {
    fn from(error: SourceError) -> Self {
        Self::Fault(error.to_string())
    }
}

impl From<PredictError> for Stop {
    fn from(error: PredictError) -> Self {
        Self::Fault(error.to_string())
    }
}

struct Worker {
    source: Arc<dyn EpisodeSource>,
    predictors: Vec<Arc<dyn Predictor>>,
    memo: Memo,
    /// What was last published.
    shown: Cell<Option<Target>>,
    shared: Arc<Shared>,
}

impl Worker {
    fn serve(&mut self, request: &Request) {
        self.take_successors();
        let mut answer = Answer::new(request);
        let work = AssertUnwindSafe(|| self.compute(request, &mut answer));
        let fault = match catch_unwind(work) {
            Ok(Ok(())) => None,
            Ok(Err(Stop::Interrupted)) => return,
            Ok(Err(Stop::Fault(why))) => Some(why),
            Err(panic) => {
                // What a panicking model left half done is not to be trusted.
                self.memo = Memo::default();
                Some(format!(
                    "the model broke down: {}",
                    panic_text(panic.as_ref())
                ))
            }
        };
        answer.fault = fault;
        answer.done = true;
        self.publish(&answer);
    }

    /// Nothing that a model has said holds for the one that takes its place.
    fn take_successors(&mut self) {
        let mut successors = self
            .shared
            .successors
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        for (model, predictor) in std::mem::take(&mut *successors) {
            if let Some(slot) = self.predictors.get_mut(model) {
                *slot = predictor;
                self.memo.forget(model);
            }
        }
    }

    fn compute(&mut self, request: &Request, answer: &mut Answer) -> Result<(), Stop> {
        let target = request.target;
        let predictor = self.predictors.get(target.model).map(AsRef::as_ref);
        let layout = predictor.map_or_else(Layout::default, Predictor::layout);
        let episode = self
            .memo
            .episode(self.source.as_ref(), target.episode, layout)?;
        let opened = self.memo.opened(target, &episode, predictor);
        answer.strip = Arc::new(strip(&opened));
        answer.opened = Some(Arc::clone(&opened));
        let steps = opened.steps();
        let Some(predictor) = predictor else {
            return Ok(());
        };
        let info = predictor.info();
        let missing = &opened.view.missing;
        if !missing.is_empty() {
            return Err(Stop::Fault(format!(
                "{} needs {}, which this recording lacks; pick another model with ( or )",
                info.name,
                missing.join(", ")
            )));
        }
        if steps <= info.frame_stack {
            let needed = info.frame_stack + 1;
            return Err(Stop::Fault(format!(
                "{} needs {needed} frames, this episode has {steps}",
                info.name
            )));
        }
        // After a switch or a newer model the face keeps what it shows until there are new beliefs; an episode that is
        // yet to be encoded shows its recording first.
        if self.shown.get() != Some(target) && !self.memo.is_encoded(target) {
            self.publish(answer);
        }
        self.check()?;
        let trace = self.memo.trace(target, &episode, predictor)?;
        self.check()?;
        let alphas = info.alphas(&request.settings.switches, steps - info.frame_stack);
        let key = self
            .memo
            .believe(target, &trace, alphas, steps, predictor)?;
        let rollout = request.settings.rollout(steps, info.frame_stack);
        self.memo.roll_out(&key, rollout, steps, predictor)?;
        self.decode(request, &key, rollout, &opened, answer)
    }

    /// Decodes what is under the cursor and publishes it, then the other steps from near to far.
    fn decode(
        &mut self,
        request: &Request,
        key: &BeliefKey,
        rollout: Rollout,
        opened: &Opened,
        answer: &mut Answer,
    ) -> Result<(), Stop> {
        let Some(predictor) = self.predictors.get(request.target.model).map(AsRef::as_ref) else {
            return Ok(());
        };
        let mut steps = vec![request.cursor];
        loop {
            let mut cells = strip(opened);
            let mut psnr_db = vec![StepPsnr::default(); opened.steps()];
            let mut left = Vec::new();
            if let Some(believed) = self.memo.believed(key) {
                let pictured = &mut believed.pictured;
                pictured.decode(predictor, &steps, &opened.truth)?;
                for step in pictured.range() {
                    cells[step].belief = pictured.frame(step);
                    psnr_db[step].belief = pictured.psnr_db(step);
                }
                left.extend(pictured.undecoded());
                answer.inferred = Some(Arc::clone(&believed.inferred));
                answer.belief_positions.clone_from(&pictured.positions);
            }
            if let Some(pictured) = self.memo.rolled_out(key, rollout) {
                pictured.decode(predictor, &steps, &opened.truth)?;
                for step in pictured.range() {
                    cells[step].prediction = pictured.frame(step);
                    psnr_db[step].prediction = pictured.psnr_db(step);
                }
                left.extend(pictured.undecoded());
                answer.rollout_positions.clone_from(&pictured.positions);
            }
            answer.strip = Arc::new(cells);
            answer.psnr_db = Arc::new(psnr_db);
            if left.is_empty() {
                return Ok(());
            }
            self.publish(answer);
            self.check()?;
            left.sort_by_key(|step| (step.abs_diff(request.cursor), *step));
            left.dedup();
            left.truncate(DECODED_AT_ONCE);
            steps = left;
        }
    }

    fn check(&self) -> Result<(), Stop> {
        if self.shared.requests.calls() {
            return Err(Stop::Interrupted);
        }
        Ok(())
    }

    fn publish(&self, answer: &Answer) {
        self.shown.set(Some(answer.target));
        self.shared.answers.put(answer.clone());
        self.shared.wake();
    }
}

/// A row with nothing decoded yet.
fn strip(opened: &Opened) -> Vec<StripCell> {
    let truth = opened.truth.iter().map(Arc::clone).enumerate();
    truth
        .map(|(step, truth)| StripCell {
            step,
            truth,
            belief: None,
            prediction: None,
        })
        .collect()
}

fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no reason given")
        .to_owned()
}
