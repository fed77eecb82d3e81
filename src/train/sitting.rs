//! One sitting of a run: from where it begins, or is resumed, to where it ends or is stopped, an update a turn.

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::batch::{Batch, Draws};
use super::loader::{AHEAD, Loader};
use super::metrics::{self, Meter};
use super::schedule::Phase;
use super::state::State;
use super::step::{self, Gradients};
use super::tensorboard::EventWriter;
use super::validate::{self, AFTER_EPOCH, Validation};
use super::{Outcome, Progress, Run, TrainError};
use crate::model::Model;

/// A batch, and the names of its episodes.
pub type Loaded = Result<(Batch, Vec<String>), TrainError>;

/// What a sitting keeps between two updates, beside what a checkpoint holds.
pub struct Sitting<'a> {
    model: &'a Model,
    run: Run<'a>,
    loader: &'a Loader<Draws, Loaded>,
    epoch_updates: u64,
    /// The next update whose batch is to be ordered.
    ordered: u64,
    /// Since the last line of the log.
    meter: Meter,
    /// When it last left a checkpoint; it leaves one with its first update.
    saved: Option<Instant>,
    events: EventWriter,
}

impl<'a> Sitting<'a> {
    /// Goes on from `state`.
    pub fn new(
        model: &'a Model,
        state: &State,
        run: Run<'a>,
        epoch_updates: u64,
        loader: &'a Loader<Draws, Loaded>,
    ) -> Result<Self, TrainError> {
        Ok(Self {
            model,
            run,
            loader,
            epoch_updates,
            ordered: state.update,
            meter: Meter::default(),
            saved: None,
            events: EventWriter::append(run.folder, state.update + 1)?,
        })
    }

    /// Trains until the budget is used up or it is stopped; leaves a checkpoint either way.
    pub fn train(
        mut self,
        state: &mut State,
        mut report: impl FnMut(&Progress),
    ) -> Result<Outcome, TrainError> {
        loop {
            let outcome = if self.used(state, state.update) >= 1.0 {
                Outcome::Finished
            } else if self.run.stop.load(Ordering::Relaxed) {
                Outcome::Stopped
            } else {
                report(&self.update(state)?);
                continue;
            };
            self.end(state, outcome)?;
            return Ok(outcome);
        }
    }

    /// Part of the budget that is used by now before an update, 0 to 1.
    fn used(&self, state: &State, update: u64) -> f64 {
        let budget = state.origin.budget;
        budget.fraction(update, self.epoch_updates, state.elapsed)
    }

    /// Where an update stands in the schedule.
    fn phase(&self, update: u64, used: f64) -> Phase {
        let training = &self.model.config.training;
        Phase::of(training, update, self.epoch_updates, used)
    }

    fn update(&mut self, state: &mut State) -> Result<Progress, TrainError> {
        let started = Instant::now();
        let used = self.used(state, state.update);
        let phase = self.phase(state.update, used);
        if let Some(before) = state.update.checked_sub(1)
            && self.phase(before, used).stage != phase.stage
        {
            // Each stage has an optimiser of its own.
            state.moments.clear();
        }
        self.order(state);
        let loaded = self.loader.next();
        let (loaded, waited) =
            loaded.ok_or_else(|| TrainError::Loader("the thread has ended".to_owned()))?;
        let (batch, episodes) = loaded?;
        let gradients = self.step(state, &batch, &phase, &episodes, waited)?;
        let losses = state.losses.map_or(gradients.losses, |running| {
            running.towards(gradients.losses, 0.05)
        });
        state.losses = Some(losses);
        let epoch_ended = state.update.is_multiple_of(self.epoch_updates);
        let validation = if epoch_ended {
            self.look(state, episodes)?
        } else {
            None
        };
        state.elapsed += started.elapsed();
        if epoch_ended {
            self.log(state, phase.rate, validation.clone())?;
        }
        Ok(Progress {
            update: state.update,
            epoch_updates: self.epoch_updates,
            fraction: self.used(state, state.update),
            elapsed: state.elapsed,
            losses,
            epoch_ended,
            validation,
        })
    }

    /// Keeps batches on order.
    fn order(&mut self, state: &State) {
        while self.ordered <= state.update + AHEAD as u64 {
            let used = self.used(state, self.ordered);
            self.loader.order(Draws {
                seed: state.origin.seed,
                update: self.ordered,
                segment: self.phase(self.ordered, used).segment,
            });
            self.ordered += 1;
        }
    }

    /// From the gradients of a batch to new weights.
    fn step(
        &mut self,
        state: &mut State,
        batch: &Batch,
        phase: &Phase,
        episodes: &[String],
        waited: Duration,
    ) -> Result<Gradients, TrainError> {
        let differentiating = Instant::now();
        let gradients = step::gradients(self.model, batch, phase)?;
        let mut stepping = differentiating.elapsed();
        if let Some(what) = gradients.not_finite() {
            return Err(TrainError::NotFinite {
                update: state.update,
                what,
                episodes: episodes.to_vec(),
                kept: state.update > 0,
            });
        }
        // The weights have just shown that they are good, which nobody knows of those after the update. The first
        // checkpoint is there at once, to be looked at and to resume from.
        let every = self.run.checkpoint_every;
        if self.saved.is_none_or(|at| at.elapsed() >= every) {
            state.save(self.model, self.run.folder)?;
            self.saved = Some(Instant::now());
        }
        let applying = Instant::now();
        gradients.apply(self.model, &mut state.moments, phase)?;
        stepping += applying.elapsed();
        self.meter.add(&gradients, stepping, waited);
        state.update += 1;
        state.average(self.model)?;
        Ok(gradients)
    }

    /// What the weights that are kept come to on `val`; an error if that is no number, after an update on `episodes`.
    fn look(&self, state: &State, episodes: Vec<String>) -> Result<Option<Validation>, TrainError> {
        let scores = validate::validate(state.kept(self.model), self.run.val, AFTER_EPOCH)?;
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

    fn log(
        &mut self,
        state: &State,
        rate: f64,
        validation: Option<Validation>,
    ) -> Result<(), TrainError> {
        let summary = self.meter.take();
        let line = metrics::Line::of(state, self.epoch_updates, rate, summary, validation);
        metrics::log(self.run.folder, &mut self.events, &line)
    }

    fn end(&mut self, state: &State, outcome: Outcome) -> Result<(), TrainError> {
        if self.saved.is_some() && !state.update.is_multiple_of(self.epoch_updates) {
            // Nobody has seen yet what the last update has made of the weights.
            let validation = self.look(state, Vec::new())?;
            if outcome == Outcome::Finished {
                // The epoch that the budget has cut short.
                let last = state.update - 1;
                let rate = self.phase(last, self.used(state, last)).rate;
                self.log(state, rate, validation)?;
            }
        }
        state.save(self.model, self.run.folder)
    }
}
