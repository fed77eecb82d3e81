//! What is measured on `val` after each epoch: the loss on the mean path, and open-loop prediction.

use serde::{Deserialize, Serialize};

use super::TrainError;
use super::batch::Batch;
use super::schedule::Phase;
use super::step::{self, Losses};
use crate::data::Episodes;
use crate::episode::Episode;
use crate::eval::{self, Protocol};
use crate::measure::frame::psnr_db_from_mse;
use crate::model::Model;
use crate::model::inspect::Inspector;

/// Scores on `val`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Validation {
    /// Episodes that were looked at.
    pub episodes: usize,
    /// Means over all beliefs, on the mean path with every expert.
    pub losses: Losses,
    /// What each latent adds to the KL of the posterior against the prior, in nats.
    pub kl_per_latent: Vec<f64>,
    /// Open-loop PSNR in dB at each horizon, averaged over episodes.
    pub psnr_db: Vec<f64>,
}

/// Episodes that are looked at after an epoch, at most: it should cost little beside it.
pub const AFTER_EPOCH: usize = 64;

impl Validation {
    /// Open-loop PSNR in dB, mean over horizons; none where nothing was predicted.
    pub fn mean_psnr_db(&self) -> Option<f64> {
        let horizons = self.psnr_db.len();
        (horizons > 0).then(|| self.psnr_db.iter().sum::<f64>() / horizons as f64)
    }
}

/// Scores `model` on `most` episodes of `val` at most, evenly spread: those of one object may lie together. None where
/// there is none.
pub fn validate(
    model: &Model,
    val: Episodes,
    most: usize,
) -> Result<Option<Validation>, TrainError> {
    let count = val.len().min(most);
    if count == 0 {
        return Ok(None);
    }
    let inspector = Inspector::new(model)?;
    // As the schedules end, so that one epoch's loss compares with another's.
    let phase = Phase::of(&model.config.training, u64::MAX - 1, 1, 1.0);
    let mut validation = Validation {
        episodes: count,
        ..Validation::default()
    };
    let mut seen = 0;
    // In batches, so that memory does not grow with the number of episodes.
    while seen < count {
        let end = count.min(seen + model.config.training.batch);
        let part = (seen..end)
            .map(|i| val.get(i * val.len() / count))
            .collect::<Result<Vec<_>, _>>()?;
        let part: Vec<&Episode> = part.iter().map(AsRef::as_ref).collect();
        let terms = step::loss(
            model,
            &Batch::new(&model.config, &part, None)?,
            &phase,
            false,
        )?;
        let losses = validation.losses;
        validation.losses = losses.towards(terms.losses, part.len() as f32 / end as f32);
        let share = part.len() as f64 / count as f64;
        let kl = terms.kl_per_latent.iter().map(|&kl| f64::from(kl) * share);
        add(&mut validation.kl_per_latent, kl);
        for episode in part {
            let protocol = Protocol::SYNTHETIC.within(episode.steps());
            if protocol.horizon == 0 || protocol.context <= model.config.frame_stack {
                // Too short to see anything and still predict.
                continue;
            }
            let errors = eval::open_loop_mse(&inspector, episode, protocol)?;
            let psnr_db = errors
                .into_iter()
                .map(|mse| psnr_db_from_mse(mse) / count as f64);
            add(&mut validation.psnr_db, psnr_db);
        }
        seen = end;
    }
    Ok(Some(validation))
}

/// Adds number by number.
fn add(sums: &mut Vec<f64>, numbers: impl ExactSizeIterator<Item = f64>) {
    sums.resize(numbers.len(), 0.0);
    for (sum, number) in sums.iter_mut().zip(numbers) {
        *sum += number;
    }
}
