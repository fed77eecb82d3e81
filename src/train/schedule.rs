//! When a run ends, and the learning rate on the way there.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::model::config::Training;

/// When a run ends: whichever comes first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Budget {
    /// Epochs over the training set.
    pub epochs: Option<u64>,
    /// Updates.
    #[serde(default)]
    pub updates: Option<u64>,
    /// Minutes of training over all sittings; with this a run depends on the machine's speed.
    pub minutes: Option<f64>,
}

impl Budget {
    /// The part that is used, 0 to 1; 0 without any limit.
    pub fn fraction(&self, updates: u64, epoch_updates: u64, elapsed: Duration) -> f64 {
        let by_epochs = self
            .epochs
            .map(|epochs| updates as f64 / (epochs as f64 * epoch_updates as f64));
        let by_minutes = self
            .minutes
            .map(|minutes| elapsed.as_secs_f64() / (minutes * 60.0));
        let by_updates = self.updates.map(|most| updates as f64 / most as f64);
        let all = [by_epochs, by_updates, by_minutes];
        all.into_iter().flatten().fold(0.0, f64::max).min(1.0)
    }
}

/// Which parameters an epoch trains: the two-stage warm-up of the released script.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Encoders and decoders.
    Autoencoder,
    /// Those, and the dynamics' base matrices.
    Bases,
    /// Everything.
    All,
}

/// What the schedules say of one update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// Learning rate.
    pub rate: f64,
    /// Steps ahead that the prior is held to the posterior.
    pub n_step: usize,
    /// Weight of the KL.
    pub kl_weight: f64,
    /// Which parameters are trained.
    pub stage: Stage,
    /// Beliefs of each episode that are trained on; none for all.
    pub segment: Option<usize>,
}

impl Phase {
    /// Of `update`, when `fraction` of the budget is used.
    pub fn of(training: &Training, update: u64, epoch_updates: u64, fraction: f64) -> Self {
        let epoch = update / epoch_updates;
        // The released script counts epochs from 1.
        let stage = if epoch + 1 < training.autoencoder_epochs {
            Stage::Autoencoder
        } else if epoch + 1 < training.bases_epochs {
            Stage::Bases
        } else {
            Stage::All
        };
        let short = training.segment > 0 && fraction < training.segment_until;
        Self {
            rate: learning_rate(training, update, fraction),
            n_step: training.n_step(epoch),
            kl_weight: training.kl_weight(epoch),
            stage,
            segment: short.then_some(training.segment),
        }
    }
}

/// The rate rises along a line over the warm-up and falls along a cosine over the budget.
fn learning_rate(training: &Training, update: u64, fraction: f64) -> f64 {
    let rise = ((update + 1) as f64 / training.warm_up.max(1) as f64).min(1.0);
    let cosine = 0.5 * (1.0 + (std::f64::consts::PI * fraction).cos());
    training.learning_rate * rise * (training.final_rate + (1.0 - training.final_rate) * cosine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::config::Config;

    #[test]
    fn the_rate_rises_then_falls_to_its_part() {
        let training = Config::named("v-h-p").expect("a known name").training;
        let peak = learning_rate(&training, training.warm_up as u64, 0.0);
        assert!((peak - training.learning_rate).abs() < 1e-12);
        assert!(learning_rate(&training, 0, 0.0) < 0.01 * peak);
        let end = learning_rate(&training, 1_000_000, 1.0);
        assert!((end - training.learning_rate * training.final_rate).abs() < 1e-12);
    }

    #[test]
    fn stages_change_where_the_released_script_changes_its_optimiser() {
        let mut training = Config::named("vhp").expect("a known name").training;
        (training.autoencoder_epochs, training.bases_epochs) = (2, 4);
        let stage = |epoch: u64| Phase::of(&training, epoch * 10 + 9, 10, 0.5).stage;
        let stages = [0, 1, 2, 3].map(stage);
        assert_eq!(
            stages,
            [Stage::Autoencoder, Stage::Bases, Stage::Bases, Stage::All]
        );
    }

    #[test]
    fn the_first_limit_reached_counts() {
        let budget = Budget {
            epochs: Some(10),
            updates: Some(400),
            minutes: Some(1.0),
        };
        assert!((budget.fraction(300, 100, Duration::ZERO) - 0.75).abs() < 1e-12);
        assert!((budget.fraction(50, 10, Duration::from_secs(6)) - 0.5).abs() < 1e-12);
        assert!((budget.fraction(10, 10, Duration::from_secs(30)) - 0.5).abs() < 1e-12);
        // A validation may last longer than the minutes that were left, and nobody waits for so many epochs.
        assert!((budget.fraction(10, 10, Duration::from_hours(1)) - 1.0).abs() < 1e-12);
        let endless = Budget {
            epochs: Some(u64::MAX),
            ..Budget::default()
        };
        assert!(endless.fraction(1, 2, Duration::ZERO) < 1e-12);
    }
}
