//! The training loop. What a user sees of it is the command's business: every update is reported to a callback.
//!
//! Nothing depends on what went before but the weights, the moments and the counters: order, noise and masks of an
//! update are drawn from the seed and its number. So a run that was stopped goes on exactly where it was.

pub mod batch;
pub mod loader;
pub mod masks;
pub mod metrics;
pub mod schedule;
mod sitting;
pub mod state;
pub mod statistics;
pub mod step;
pub mod tensorboard;
pub mod totals;
pub mod validate;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Duration;

use thiserror::Error;

use self::batch::{Batch, Draws};
use self::loader::Loader;
use self::sitting::{Loaded, Sitting};
use self::state::State;
use self::step::Losses;
use self::validate::Validation;
use crate::data::{DataError, Episodes};
use crate::episode::Episode;
use crate::model::Model;
use crate::model::checkpoint::{CheckpointError, first_line};
use crate::model::config::Config;
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

/// Updates of an epoch over `train`.
pub fn epoch_updates(train: Episodes, config: &Config) -> u64 {
    (train.len() / config.training.batch).max(1) as u64
}

/// Trains `model` from `state` until the budget is used up or it is stopped; leaves a checkpoint either way.
pub fn run(
    model: &Model,
    state: &mut State,
    run: Run,
    report: impl FnMut(&Progress),
) -> Result<Outcome, TrainError> {
    let config = &model.config;
    let epoch_updates = epoch_updates(run.train, config);
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
        Sitting::new(model, state, run, epoch_updates, &loader)?.train(state, report)
    })
}
