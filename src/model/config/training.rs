//! How a model is trained: every hyperparameter of the paper and of the authors' script, and of our own recipe.

use serde::{Deserialize, Serialize};

use super::{ConfigError, refuse};

/// How a model is trained. `docs/training.md` has the table of keys with the value of each preset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Training {
    /// Epochs when a run is given no budget.
    pub epochs: u64,
    /// Episodes of a batch.
    pub batch: usize,
    /// Peak learning rate of Adam.
    pub learning_rate: f64,
    /// Updates over which the rate rises to its peak; 0 starts there.
    pub warm_up: usize,
    /// The rate falls along a cosine to this part of its peak; 1 keeps it.
    pub final_rate: f64,
    /// Largest gradient norm of each network.
    pub clip: f32,
    /// Which networks' gradients are clipped.
    pub clipped: Clipped,
    /// How parameters are drawn at first.
    pub init: Init,
    /// How window channels are scaled, and what the error terms weigh.
    pub scaling: Scaling,
    /// With `scaling = "released"`, force and torque are divided by this.
    pub force_scale: f32,
    /// Whether a sample of each belief is decoded and fed on (the paper's), or its mean.
    pub sampled: bool,
    /// Overshooting: the prior is held to the posterior one step further after each of these epochs. `[]` is the plain
    /// KL, `[0]` two steps from the first epoch on, `[0, 3072]` three from epoch 3,073 on.
    pub n_step_after: Vec<u64>,
    /// Weight of the KL.
    pub kl_weight: f64,
    /// The KL's weight rises along a line over these epochs; 0 starts at its full weight.
    pub kl_annealing: u64,
    /// Part of the KL's gradient that moves the prior, the rest moves the posterior; ½ is the plain KL.
    pub kl_balance: f64,
    /// Weight of all squared errors.
    pub error_weight: f64,
    /// Weight of each decoded stream's squared error, times `error_weight`; 0 leaves it out. Empty until a training set
    /// has been seen.
    #[serde(default)]
    pub error_weights: Vec<f32>,
    /// Before this epoch only encoders and decoders are trained (first stage of the released script's warm-up).
    pub autoencoder_epochs: u64,
    /// Before this epoch the dynamics train their base matrices alone (its second stage).
    pub bases_epochs: u64,
    /// Whether experts are left out at random while training, so that switches are in the distribution.
    pub masks: bool,
    /// Part of the episodes of a batch that go on without any sensor from a random step on, so that what is decoded
    /// there is a rollout. With `masks` the paths of masks hold rollouts already, and this adds more.
    pub rollouts: f64,
    /// Beliefs decoded an episode and update, drawn at random and weighted so that the expected loss stays the same;
    /// 0 decodes all.
    pub decoded: usize,
    /// Beliefs of an episode that are trained on at first, from a random one on; 0 takes whole episodes.
    pub segment: usize,
    /// Whole episodes are taken after this part of the budget.
    pub segment_until: f64,
    /// What is kept is a running mean of the weights that goes 1 − this towards the newest at every update; 0 keeps the
    /// newest.
    pub average: f64,
}

/// Which networks' gradients are clipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Clipped {
    /// Each network by its own norm, as released.
    All,
    /// The recurrent dynamics alone, as the paper says.
    Dynamics,
}

/// How parameters are drawn at first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Init {
    /// As PyTorch's layers are by default: uniform in ± 1/√inputs. A is the identity, B uniform in [0, 1).
    Torch,
    /// Uniform with He's variance, so that activations neither vanish nor grow; A near the identity, B near zero.
    Scaled,
}

/// How window channels are scaled, and what the error terms weigh (`DATASET.md` of the format).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scaling {
    /// Force and torque divided by a constant, the rest in SI units; every term weighs 1.
    Released,
    /// Each channel to mean 0 and deviation 1; all windows together weigh as much as the frame at the mean predictor.
    Standard,
}

impl Training {
    /// Steps ahead that the prior is held to the posterior in this epoch, counted from 0.
    pub fn n_step(&self, epoch: u64) -> usize {
        1 + self
            .n_step_after
            .iter()
            .filter(|&&after| after <= epoch)
            .count()
    }

    /// Weight of the KL in this epoch, counted from 0.
    pub fn kl_weight(&self, epoch: u64) -> f64 {
        if self.kl_annealing == 0 {
            return self.kl_weight;
        }
        self.kl_weight * ((epoch + 1) as f64 / self.kl_annealing as f64).min(1.0)
    }

    /// Checks every number; `streams` are decoded.
    pub(super) fn validate(&self, streams: usize) -> Result<(), ConfigError> {
        let positive = [
            ("training.learning_rate", self.learning_rate),
            ("training.clip", f64::from(self.clip)),
            ("training.final_rate", self.final_rate),
            ("training.force_scale", f64::from(self.force_scale)),
        ];
        if let Some((key, value)) = positive
            .into_iter()
            .find(|(_, value)| !(value.is_finite() && *value > 0.0))
        {
            return refuse(key, format!("must be a positive number, is {value}"));
        }
        let not_negative = [
            ("training.kl_weight", self.kl_weight),
            ("training.error_weight", self.error_weight),
        ];
        if let Some((key, value)) = not_negative
            .into_iter()
            .find(|(_, value)| !(value.is_finite() && *value >= 0.0))
        {
            return refuse(key, format!("must be 0 or a positive number, is {value}"));
        }
        let parts = [
            ("training.kl_balance", self.kl_balance, 1.0),
            ("training.rollouts", self.rollouts, 1.0),
            ("training.segment_until", self.segment_until, 1.0),
            ("training.average", self.average, 0.999_999),
        ];
        if let Some((key, value, most)) = parts
            .into_iter()
            .find(|(_, value, most)| !(0.0..=*most).contains(value))
        {
            return refuse(key, format!("must lie between 0 and {most}, is {value}"));
        }
        if self.epochs == 0 {
            return refuse("training.epochs", "must be 1 or more");
        }
        if self.segment == 1 {
            return refuse("training.segment", "a segment has 2 beliefs or more");
        }
        let weights = &self.error_weights;
        if !weights.is_empty()
            && (weights.len() != streams || weights.iter().any(|w| !w.is_finite() || *w < 0.0))
        {
            return refuse(
                "training.error_weights",
                format!("one number, 0 or positive, for each of {streams} decoded streams"),
            );
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::model::config::{Config, Preset};

    #[test]
    fn schedules_count_epochs_as_the_released_script_does() {
        let mut training = Config::preset("vhp", Preset::Released)
            .expect("a known name")
            .training;
        assert_eq!(
            [0, 3071, 3072].map(|epoch| training.n_step(epoch)),
            [2, 2, 3]
        );
        assert!((training.kl_weight(0) - 1.0).abs() < 1e-12);
        training.kl_annealing = 4;
        for (epoch, weight) in [(0, 0.25), (1, 0.5), (3, 1.0), (9, 1.0)] {
            assert!((training.kl_weight(epoch) - weight).abs() < 1e-12);
        }
    }
}
