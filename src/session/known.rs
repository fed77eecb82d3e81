//! What is known of a model's latent over a dataset, once its episodes have been scored.

use serde::{Deserialize, Serialize};

use crate::measure::active::LatentStats;

/// Over all beliefs of the scored episodes, every expert as trained.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Known {
    /// Mean and variance of each latent dimension's mean (D18, D19).
    pub stats: LatentStats,
    /// Rise of the position error in metres when a dimension is shuffled (D18); empty without a probe.
    pub importance_m: Vec<f64>,
    /// How many episodes it is from.
    pub episodes: usize,
}
