//! What is measured on `val` after each epoch: the loss on the mean path, and open-loop prediction.

use serde::{Deserialize, Serialize};

use super::TrainError;
use super::batch::Batch;
use super::schedule::Phase;
use super::step::{self, Losses};
use crate::episode::Episode;
use crate::eval::{self, Protocol};
use crate::model::Model;
use crate::model::inspect::Inspector;

/// Scores on `val`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Validation {
    /// Means over all beliefs, on the mean path with every expert.
    pub losses: Losses,
    /// Open-loop PSNR in dB at each horizon, averaged over episodes.
    pub psnr_db: Vec<f64>,
}

/// Episodes that a validation looks at, at most: it should cost little beside an epoch.
const EPISODES: usize = 64;

/// Scores `model` on the first episodes of `val`.
pub fn validate(model: &Model, val: &[Episode]) -> Result<Validation, TrainError> {
    let val: Vec<&Episode> = val.iter().take(EPISODES).collect();
    if val.is_empty() {
        return Ok(Validation {
            losses: Losses::default(),
            psnr_db: Vec::new(),
        });
    }
    // In batches, so that memory does not grow with the length of episodes.
    let phase = Phase::of(&model.config.training, 0, 1, 1.0);
    let mut losses = Losses::default();
    for (i, part) in val.chunks(model.config.training.batch).enumerate() {
        let of_part = step::loss(
            model,
            &Batch::new(&model.config, part, None)?,
            &phase,
            false,
        )?;
        let seen = i * model.config.training.batch;
        losses = losses.towards(
            of_part.losses,
            part.len() as f32 / (seen + part.len()) as f32,
        );
    }
    let inspector = Inspector::new(model)?;
    let protocol = Protocol::for_episode(val[0].steps());
    let mut sums = vec![0.0; protocol.horizon];
    for episode in &val {
        for (sum, mse) in sums
            .iter_mut()
            .zip(eval::open_loop_mse(&inspector, episode, protocol)?)
        {
            *sum += f64::from(crate::measure::frame::psnr_db_from_mse(mse));
        }
    }
    Ok(Validation {
        losses,
        psnr_db: sums.into_iter().map(|sum| sum / val.len() as f64).collect(),
    })
}
