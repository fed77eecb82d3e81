//! The training loop. What a user sees of it is the command's business: every update is reported to a callback.
//!
//! Nothing depends on what went before but the weights, the moments and the counters: order, noise and masks of an
//! update are drawn from the seed and its number. So a run that was stopped goes on exactly where it was.

pub mod batch;
pub mod masks;
pub mod schedule;
pub mod state;
pub mod statistics;
pub mod step;
pub mod tensorboard;
pub mod validate;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use thiserror::Error;

use self::batch::{Batch, Draws};
use self::schedule::Phase;
use self::state::State;
use self::step::Losses;
use self::validate::Validation;
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
    /// A loss or a gradient was no number.
    #[error(
        "{what} of update {update} is not finite; its episodes: {}; leave out the odd one among them, or lower \
         `training.learning_rate` in a --config",
        episodes.join(", ")
    )]
    NotFinite {
        /// Which update.
        update: u64,
        /// The loss, or which network's gradient.
        what: String,
        /// The episodes of its batch.
        episodes: Vec<String>,
    },
    /// The run folder cannot be used.
    #[error("{0}")]
    Run(String),
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
    pub train: &'a [Episode],
    /// Scored after each epoch.
    pub val: &'a [Episode],
    /// Where checkpoints and metrics go.
    pub folder: &'a Path,
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
    /// Of the epoch that just ended.
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

/// Time between two checkpoints.
const CHECKPOINT_EVERY: Duration = Duration::from_mins(3);

/// Trains `model` from `state` until the budget is used up or it is stopped; leaves a checkpoint either way.
pub fn run(
    model: &Model,
    state: &mut State,
    run: Run,
    mut report: impl FnMut(&Progress),
) -> Result<Outcome, TrainError> {
    let training = &model.config.training;
    let (seed, budget) = (state.origin.seed, state.origin.budget);
    let epoch_updates = (run.train.len() / training.batch).max(1) as u64;
    let mut running: Option<Losses> = None;
    let mut last_save = Instant::now();
    loop {
        let fraction = budget.fraction(state.update, epoch_updates, state.elapsed);
        if fraction >= 1.0 || run.stop.load(Ordering::Relaxed) {
            state.save(model, run.folder)?;
            return Ok(if fraction >= 1.0 {
                Outcome::Finished
            } else {
                Outcome::Stopped
            });
        }
        let started = Instant::now();
        let chosen = batch::choose(
            run.train.len(),
            training.batch,
            epoch_updates,
            seed,
            state.update,
        );
        let episodes: Vec<&Episode> = chosen.into_iter().map(|i| &run.train[i]).collect();
        let phase = Phase::of(training, state.update, epoch_updates, fraction);
        let draws = Draws {
            seed,
            update: state.update,
            segment: phase.segment,
        };
        let batch = Batch::new(&model.config, &episodes, Some(draws))?;
        if state.update > 0 {
            let before = Phase::of(training, state.update - 1, epoch_updates, fraction);
            if before.stage != phase.stage {
                // Each stage has an optimiser of its own.
                state.moments.clear();
            }
        }
        let gradients = step::gradients(model, &batch, &phase)?;
        if let Some(what) = gradients.not_finite() {
            let episodes = episodes
                .iter()
                .map(|episode| episode.meta.id.clone())
                .collect();
            return Err(TrainError::NotFinite {
                update: state.update,
                what,
                episodes,
            });
        }
        gradients.apply(model, &mut state.moments, &phase)?;
        let losses = gradients.losses;
        state.update += 1;
        let mean = running.map_or(losses, |running| running.towards(losses, 0.05));
        running = Some(mean);
        let validation = if state.update.is_multiple_of(epoch_updates) {
            Some(validate::validate(model, run.val)?)
        } else {
            None
        };
        state.elapsed += started.elapsed();
        let progress = Progress {
            update: state.update,
            epoch_updates,
            fraction: budget.fraction(state.update, epoch_updates, state.elapsed),
            elapsed: state.elapsed,
            losses: mean,
            validation,
        };
        if progress.validation.is_some() {
            state::append_metrics(run.folder, &progress, phase.rate)?;
        }
        if last_save.elapsed() > CHECKPOINT_EVERY {
            state.save(model, run.folder)?;
            last_save = Instant::now();
        }
        report(&progress);
    }
}
