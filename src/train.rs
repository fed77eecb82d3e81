//! The training loop. What a user sees of it is the command's business: every update is reported to a callback.
//!
//! Nothing depends on what went before but the weights, the moments and the counters: order, noise and masks of an
//! update are drawn from the seed and its number. So a run that was stopped goes on exactly where it was.

pub mod batch;
pub mod loader;
pub mod masks;
pub mod metrics;
pub mod schedule;
pub mod state;
pub mod statistics;
pub mod step;
pub mod tensorboard;
pub mod totals;
pub mod validate;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use thiserror::Error;

use self::batch::{Batch, Draws};
use self::loader::{AHEAD, Loader};
use self::metrics::Meter;
use self::schedule::Phase;
use self::state::State;
use self::step::Losses;
use self::tensorboard::EventWriter;
use self::validate::{AFTER_EPOCH, Validation};
use crate::data::{DataError, Episodes};
use crate::episode::Episode;
use crate::model::Model;
use crate::model::checkpoint::{CheckpointError, first_line};
use crate::model::observation::ObserveError;

/// Why training stopped early.
#[derive(Debug, Error)]
pub enum TrainError {
    /// An episode does not fit the model.
    #[error(transparent)]
    Observe(#[from] ObserveError),
    /// A checkpoint could not be written or read.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A tensor operation failed.
    #[error("computing: {0}")]
    Tensor(String),
    /// An episode could not be had again.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A loss, a gradient or a weight was no number. The run folder keeps the last checkpoint from before it, if any.
    #[error("update {update}: {what} is not finite{}; {}", among(episodes), remedy(*kept))]
    NotFinite {
        /// Which update.
        update: u64,
        /// The loss, or of which network the gradient or a weight.
        what: String,
        /// The episodes of its batch.
        episodes: Vec<String>,
        /// Whether there is a checkpoint from before it.
        kept: bool,
    },
    /// The thread that prepares batches could not be started, or has died.
    #[error("preparing batches: {0}")]
    Loader(String),
}

fn among(episodes: &[String]) -> String {
    if episodes.is_empty() {
        return String::new();
    }
    format!(" (episodes {})", episodes.join(", "))
}

fn remedy(kept: bool) -> &'static str {
    if kept {
        "a checkpoint in the run folder is from before it: leave out the odd episode, or lower `training.learning_rate` in \
         its config.toml, and go on with --resume"
    } else {
        "nothing is saved yet: leave out the odd episode, or lower `training.learning_rate` or the weights of the loss"
    }
}

impl From<candle_core::Error> for TrainError {
    fn from(error: candle_core::Error) -> Self {
        Self::Tensor(first_line(&error))
    }
}

/// What a run works on.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    /// Fitted on.
    pub train: Episodes<'a>,
    /// Scored after each epoch.
    pub val: Episodes<'a>,
    /// Where checkpoints and metrics go.
    pub folder: &'a Path,
    /// Time between two checkpoints.
    pub checkpoint_every: Duration,
    /// Set from outside to stop after the current update.
    pub stop: &'a AtomicBool,
}

/// What is reported after each update, and after each epoch with a validation.
#[derive(Clone, Debug)]
pub struct Progress {
    /// Updates so far.
    pub update: u64,
    /// Updates of an epoch.
    pub epoch_updates: u64,
    /// Part of the budget that is used, 0 to 1.
    pub fraction: f64,
    /// Time trained, over all sittings.
    pub elapsed: Duration,
    /// Running means of the losses.
    pub losses: Losses,
    /// Whether an epoch has just ended.
    pub epoch_ended: bool,
    /// Of that epoch; none where there is nothing to validate on.
    pub validation: Option<Validation>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The budget is used up.
    Finished,
    /// It was stopped, and can be resumed.
    Stopped,
}

/// A batch, and the names of its episodes.
type Loaded = Result<(Batch, Vec<String>), TrainError>;

/// Trains `model` from `state` until the budget is used up or it is stopped; leaves a checkpoint either way.
pub fn run(
    model: &Model,
    state: &mut State,
    run: Run,
    report: impl FnMut(&Progress),
) -> Result<Outcome, TrainError> {
    let config = &model.config;
    let epoch_updates = epoch_updates(model, run);
    let prepare = move |draws: Draws| -> Loaded {
        let chosen = batch::choose(
            run.train.len(),
            config.training.batch,
            epoch_updates,
            draws.seed,
            draws.update,
        );
        let episodes = chosen
            .iter()
            .map(|&i| run.train.get(i))
            .collect::<Result<Vec<Arc<Episode>>, _>>()?;
        let episodes: Vec<&Episode> = episodes.iter().map(AsRef::as_ref).collect();
        let names = chosen.iter().map(|&i| run.train.id(i).to_owned());
        let batch = Batch::new(config, &episodes, Some(draws))?;
        Ok((batch, names.collect()))
    };
    thread::scope(|scope| {
        let loader =
            Loader::start(scope, prepare).map_err(|error| TrainError::Loader(error.to_string()))?;
        drive(model, state, run, &loader, report)
    })
}

fn epoch_updates(model: &Model, run: Run) -> u64 {
    (run.train.len() / model.config.training.batch).max(1) as u64
}

/// The loop: one update a turn.
fn drive(
    model: &Model,
    state: &mut State,
    run: Run,
    loader: &Loader<Draws, Loaded>,
    mut report: impl FnMut(&Progress),
) -> Result<Outcome, TrainError> {
    let training = &model.config.training;
    let budget = state.origin.budget;
    let epoch_updates = epoch_updates(model, run);
    let mut ordered = state.update;
    let mut meter = Meter::default();
    let mut saved: Option<Instant> = None;
    let mut events = EventWriter::append(run.folder, state.update + 1)?;
    loop {
        let fraction = budget.fraction(state.update, epoch_updates, state.elapsed);
        if fraction >= 1.0 || run.stop.load(Ordering::Relaxed) {
            if saved.is_some() && !state.update.is_multiple_of(epoch_updates) {
                // Nobody has seen yet what the last update has made of the weights.
                let val = looked_at(model, state, run, Vec::new())?;
                if fraction >= 1.0 {
                    // The epoch that the budget has cut short.
                    let last = state.update.saturating_sub(1);
                    let at = budget.fraction(last, epoch_updates, state.elapsed);
                    let rate = Phase::of(training, last, epoch_updates, at).rate;
                    let line = metrics::Line::of(state, epoch_updates, rate, meter.take(), val);
                    metrics::log(run.folder, &mut events, &line)?;
                }
            }
            state.save(model, run.folder)?;
            return Ok(if fraction >= 1.0 {
                Outcome::Finished
            } else {
                Outcome::Stopped
            });
        }
        let started = Instant::now();
        while ordered <= state.update + AHEAD as u64 {
            let ahead = budget.fraction(ordered, epoch_updates, state.elapsed);
            loader.order(Draws {
                seed: state.origin.seed,
                update: ordered,
                segment: Phase::of(training, ordered, epoch_updates, ahead).segment,
            });
            ordered += 1;
        }
        let (loaded, waited) = loader
            .next()
            .ok_or_else(|| TrainError::Loader("the thread has ended".to_owned()))?;
        let (batch, episodes) = loaded?;
        let phase = Phase::of(training, state.update, epoch_updates, fraction);
        if let Some(before) = state.update.checked_sub(1) {
            let before = Phase::of(training, before, epoch_updates, fraction);
            if before.stage != phase.stage {
                // Each stage has an optimiser of its own.
                state.moments.clear();
            }
        }
        let differentiating = Instant::now();
        let gradients = step::gradients(model, &batch, &phase)?;
        let mut stepping = differentiating.elapsed();
        if let Some(what) = gradients.not_finite() {
            return Err(TrainError::NotFinite {
                update: state.update,
                what,
                episodes,
                kept: state.update > 0,
            });
        }
        // These weights have just shown that they are good, which nobody knows of those after the update. The first
        // checkpoint is there at once, to be looked at and to resume from.
        if saved.is_none_or(|at| at.elapsed() >= run.checkpoint_every) {
            state.save(model, run.folder)?;
            saved = Some(Instant::now());
        }
        let applying = Instant::now();
        gradients.apply(model, &mut state.moments, &phase)?;
        stepping += applying.elapsed();
        meter.add(&gradients, stepping, waited);
        state.update += 1;
        state.average(model)?;
        let losses = state.losses.map_or(gradients.losses, |running| {
            running.towards(gradients.losses, 0.05)
        });
        state.losses = Some(losses);
        let epoch_ended = state.update.is_multiple_of(epoch_updates);
        let validation = if epoch_ended {
            looked_at(model, state, run, episodes)?
        } else {
            None
        };
        state.elapsed += started.elapsed();
        if epoch_ended {
            let val = validation.clone();
            let line = metrics::Line::of(state, epoch_updates, phase.rate, meter.take(), val);
            metrics::log(run.folder, &mut events, &line)?;
        }
        report(&Progress {
            update: state.update,
            epoch_updates,
            fraction: budget.fraction(state.update, epoch_updates, state.elapsed),
            elapsed: state.elapsed,
            losses,
            epoch_ended,
            validation,
        });
    }
}

/// What the weights that are kept come to on `val`; an error if that is no number, after an update on `episodes`.
fn looked_at(
    model: &Model,
    state: &State,
    run: Run,
    episodes: Vec<String>,
) -> Result<Option<Validation>, TrainError> {
    let scores = validate::validate(state.kept(model), run.val, AFTER_EPOCH)?;
    if scores.as_ref().is_some_and(|s| !s.losses.is_finite()) {
        return Err(TrainError::NotFinite {
            update: state.update - 1,
            what: "the validation loss after it".to_owned(),
            episodes,
            kept: true,
        });
    }
    Ok(scores)
}
