//! The thread that computes: it owns the models, serves the newest request and publishes as it goes.
//!
//! Requests and answers each lie in a mailbox of one: a newer one replaces an older one, so held keys leave no
//! backlog and a face never waits. Between any two steps of work the thread looks for a newer request. An answer is
//! cumulative, so one that was never collected is no loss.

mod answer;
mod compute;
mod inferred;
mod lattice;
mod lru;
mod mailbox;
mod memo;
mod noise;
mod opened;
mod pictured;
mod readings;
mod response;
mod spread;

use std::any::Any;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

pub use answer::{Answer, Pictures, Request};
pub use inferred::{Inferred, infer};
pub use mailbox::Mailbox;
use memo::Memo;
pub use memo::Target;
pub use opened::Opened;

use super::predict::{PredictError, Predictor};
use crate::episode::{EpisodeSource, SourceError};
use crate::lock::lock;

/// Name of the thread, for those who look at threads; a panic on it is caught and told as a message.
pub const THREAD: &str = "poescope-session";

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
    /// Whether the worker works at the moment.
    working: AtomicBool,
    /// Wakes the face.
    pub waker: Mutex<Option<Waker>>,
    /// To the worker, before its next request: models that take the place of others.
    pub successors: Mutex<BTreeMap<usize, Arc<dyn Predictor>>>,
    /// The session's, for the threads that compute and whoever else goes on with them.
    models: Mutex<Vec<Arc<dyn Predictor>>>,
    /// To the session, from whoever watches its models.
    pub renewed: Mutex<BTreeMap<usize, Found>>,
}

impl Shared {
    /// For a session of these models.
    pub fn of(models: Vec<Arc<dyn Predictor>>) -> Self {
        Self {
            models: Mutex::new(models),
            ..Self::default()
        }
    }

    /// The models as they are now.
    pub fn models(&self) -> Vec<Arc<dyn Predictor>> {
        lock(&self.models).clone()
    }

    /// Puts another one in the place of model `index`, if there is one.
    pub fn replace_model(&self, index: usize, model: Arc<dyn Predictor>) {
        if let Some(place) = lock(&self.models).get_mut(index) {
            *place = model;
        }
    }

    /// Whether the worker has something to do.
    pub fn is_working(&self) -> bool {
        self.working.load(Ordering::Acquire) || self.requests.calls()
    }

    /// Whether a face is woken when something has been computed.
    pub fn wakes(&self) -> bool {
        lock(&self.waker).is_some()
    }

    /// Has the face look at what is new.
    pub fn wake(&self) {
        if let Some(wake) = lock(&self.waker).as_ref() {
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
                shared.working.store(true, Ordering::Release);
                worker.serve(&request);
                shared.working.store(false, Ordering::Release);
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
        let successors = std::mem::take(&mut *lock(&self.shared.successors));
        for (model, predictor) in successors {
            if let Some(slot) = self.predictors.get_mut(model) {
                *slot = predictor;
                self.memo.forget(model);
            }
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

fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no reason given")
        .to_owned()
}
