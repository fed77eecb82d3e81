//! One update: forward, the terms of the bound, backward, clip, Adam.

use std::collections::BTreeMap;

use candle_core::Tensor;
use serde::{Deserialize, Serialize};

use super::TrainError;
use super::batch::Batch;
use super::schedule::{Phase, Stage};
use crate::model::config::Clipped;
use crate::model::encoder::Encoder;
use crate::model::filter::{self, Inputs};
use crate::model::gaussian::DiagGaussian;
use crate::model::kernel::adam::{self, Moments};
use crate::model::{Model, Weights, elbo};

/// What an update minimised, each a mean over beliefs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Losses {
    /// The weighted sum that is minimised.
    pub loss: f32,
    /// Squared error of a frame (and those stacked under it), summed over pixels.
    pub vision: f32,
    /// Squared error of the windows, scaled, summed over samples and channels.
    pub windows: f32,
    /// KL(posterior ‖ prior) in nats.
    pub kl: f32,
    /// The plain negative ELBO in nats: one-step KL, unit weights, Gaussian constants at σ² = ½. Never to be compared
    /// across models that decode different modalities.
    pub negative_elbo: f32,
}

impl Losses {
    /// Whether every term is a number.
    pub fn is_finite(&self) -> bool {
        [self.loss, self.vision, self.windows, self.kl]
            .iter()
            .all(|term| term.is_finite())
    }

    /// A running mean that goes `part` of the way to `newest`.
    #[must_use]
    pub fn towards(self, newest: Self, part: f32) -> Self {
        let mix = |old: f32, new: f32| old + part * (new - old);
        Self {
            loss: mix(self.loss, newest.loss),
            vision: mix(self.vision, newest.vision),
            windows: mix(self.windows, newest.windows),
            kl: mix(self.kl, newest.kl),
            negative_elbo: mix(self.negative_elbo, newest.negative_elbo),
        }
    }
}

/// Every expert at every belief, `(B, T, Z)` each. Beliefs at which an expert is off are not encoded.
fn encode(
    model: &Model,
    weights: &Weights,
    batch: &Batch,
    train: bool,
) -> Result<Vec<DiagGaussian>, TrainError> {
    let (b, t) = (batch.episodes, batch.beliefs);
    let mut streams = batch.seen.as_slice();
    let mut experts = Vec::new();
    for (i, encoder) in model.encoders.iter().enumerate() {
        let (seen, rest) = streams.split_at(encoder.streams());
        streams = rest;
        let weights = &weights.encoders[i];
        let said = match &batch.sensed[i] {
            None => encoder.encode(seen, weights, train)?,
            Some(rows) => encode_some(encoder, seen, weights, rows, train)?,
        };
        experts.push(said.reshape((b, t, model.config.latent))?);
    }
    Ok(experts)
}

/// `encoder` at some rows; elsewhere, where its α is 0, what it says of the first of them.
fn encode_some(
    encoder: &Encoder,
    seen: &[Tensor],
    weights: &[Tensor],
    rows: &[u32],
    train: bool,
) -> Result<DiagGaussian, TrainError> {
    let device = seen[0].device();
    let rows = if rows.is_empty() { &[0] } else { rows };
    let mut places = vec![0_u32; seen[0].dim(0)?];
    for (place, &row) in (0..).zip(rows) {
        places[row as usize] = place;
    }
    let places = Tensor::new(places, device)?;
    let rows = Tensor::new(rows, device)?;
    let seen = seen
        .iter()
        .map(|seen| seen.index_select(&rows, 0))
        .collect::<candle_core::Result<Vec<_>>>()?;
    let said = encoder.encode(&seen, weights, train)?;
    Ok(DiagGaussian {
        mean: said.mean.index_select(&places, 0)?,
        log_var: said.log_var.index_select(&places, 0)?,
    })
}

/// The loss of a batch, with gradients where `train`, and its terms.
pub fn loss(
    model: &Model,
    batch: &Batch,
    phase: &Phase,
    train: bool,
) -> Result<(Tensor, Losses), TrainError> {
    let (config, training) = (&model.config, &model.config.training);
    let weights = model.weights()?;
    let experts = encode(model, &weights, batch, train)?;
    let inputs = Inputs {
        experts: &experts,
        alphas: &batch.alphas,
        controls: &batch.controls,
        noise: (train && training.sampled).then_some(&batch.noise),
    };
    let filtered = filter::filter(
        &model.dynamics,
        &weights.dynamics,
        inputs,
        config.prior_expert,
    )?;
    let plain_kl = filtered.posterior.kl(&filtered.prior)?.mean_all()?;
    let mut kl = elbo::kl(&filtered, training.kl_balance)?.mean_all()?;
    for term in elbo::overshooting(
        &model.dynamics,
        &weights.dynamics,
        &filtered,
        &batch.controls,
        phase.n_step,
        training.kl_balance,
    )? {
        kl = (kl + term.mean_all()?)?;
    }
    let mut total = kl.affine(phase.kl_weight, 0.0)?;
    let latents = filtered.z.flatten(0, 1)?;
    let rows = batch
        .decoded
        .as_deref()
        .map(|rows| Tensor::new(rows, latents.device()))
        .transpose()?;
    let decoded = |all: &Tensor| match &rows {
        Some(rows) => all.index_select(rows, 0),
        None => Ok(all.clone()),
    };
    let latents = decoded(&latents)?;
    let count = latents.dim(0)?;
    let mut losses = Losses {
        kl: plain_kl.to_scalar()?,
        ..Losses::default()
    };
    losses.negative_elbo = losses.kl;
    for (i, decoder) in model.decoders.iter().enumerate() {
        let weight = training.error_weights.get(i).copied().unwrap_or(1.0);
        let weight = weight * training.error_weight as f32;
        if weight == 0.0 {
            continue;
        }
        let seen = decoded(&batch.seen[i])?;
        let each = vec![weight / count as f32; count];
        let (error, per_belief) =
            decoder.squared_error(&latents, &weights.decoders[i], &seen, each, train)?;
        total = (total + error)?;
        let per_belief = per_belief
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let mean = per_belief.iter().sum::<f32>() / count as f32;
        *(if i == 0 {
            &mut losses.vision
        } else {
            &mut losses.windows
        }) += mean;
        // −ln N(x; x̂, ½ I) = ‖x − x̂‖² + D/2 ln π.
        losses.negative_elbo += mean + seen.dim(1)? as f32 * 0.5 * std::f32::consts::PI.ln();
    }
    losses.loss = total.to_scalar()?;
    Ok((total, losses))
}

/// One update of every network.
pub fn update(
    model: &Model,
    batch: &Batch,
    moments: &mut BTreeMap<String, Moments>,
    phase: &Phase,
) -> Result<Losses, TrainError> {
    let (total, losses) = loss(model, batch, phase, true)?;
    if !losses.is_finite() {
        return Ok(losses);
    }
    let gradients = total.backward()?;
    let training = &model.config.training;
    for network in model.networks() {
        let Some(gradient) = gradients.get(network.theta()) else {
            continue;
        };
        let dynamics = network.name == model.dynamics.network.name;
        let clip = if dynamics || training.clipped == Clipped::All {
            training.clip
        } else {
            f32::INFINITY
        };
        let moments = moments.entry(network.name.clone()).or_default();
        match phase.stage {
            Stage::Autoencoder if dynamics => {}
            Stage::Bases if dynamics => {
                // A gradient of zero leaves what is not trained yet where it is: its moments are zero too.
                let scale = (clip / (adam::norm(gradient)? + 1e-6)).min(1.0);
                let bases = (gradient * model.dynamics.bases_mask()?)?.affine(scale.into(), 0.0)?;
                adam::update(network.theta(), &bases, moments, phase.rate, f32::INFINITY)?;
            }
            _ => {
                adam::update(network.theta(), gradient, moments, phase.rate, clip)?;
            }
        }
    }
    Ok(losses)
}
