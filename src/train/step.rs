//! One update: forward, the terms of the bound, backward, clip, Adam.

use std::collections::BTreeMap;

use candle_core::Tensor;
use candle_core::backprop::GradStore;
use serde::{Deserialize, Serialize};

use super::TrainError;
use super::batch::Batch;
use super::schedule::{Phase, Stage};
use crate::lock::lock;
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
    /// Each with its name in logs.
    pub fn named(self) -> [(&'static str, f32); 5] {
        [
            ("loss", self.loss),
            ("vision", self.vision),
            ("windows", self.windows),
            ("kl", self.kl),
            ("negative_elbo", self.negative_elbo),
        ]
    }

    /// Whether every term is a number.
    pub fn is_finite(&self) -> bool {
        self.named().iter().all(|(_, term)| term.is_finite())
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

/// The loss of a batch, and what it is made of.
#[derive(Debug)]
pub struct Terms {
    /// The loss, a scalar to differentiate.
    pub total: Tensor,
    /// It and its terms as numbers.
    pub losses: Losses,
    /// What each latent adds to `losses.kl`, in nats: a latent near 0 carries nothing.
    pub kl_per_latent: Vec<f32>,
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
pub fn loss(model: &Model, batch: &Batch, phase: &Phase, train: bool) -> Result<Terms, TrainError> {
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
    let kl_per_latent = elbo::kl_per_latent(&filtered)?.mean((0, 1))?.to_vec1()?;
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
        let per_belief = lock(&per_belief);
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
    Ok(Terms {
        total,
        losses,
        kl_per_latent,
    })
}

/// What a batch says of the weights, before anything is changed by it.
#[derive(Debug)]
pub struct Gradients {
    /// Of these weights on this batch.
    pub losses: Losses,
    /// What each latent adds to `losses.kl`, in nats.
    pub kl_per_latent: Vec<f32>,
    /// Norm of each network's gradient before clipping, in the model's order; none where the loss is no number.
    pub norms: Vec<(String, f32)>,
    of_theta: Option<GradStore>,
}

/// Differentiates the loss of a batch.
pub fn gradients(model: &Model, batch: &Batch, phase: &Phase) -> Result<Gradients, TrainError> {
    let terms = loss(model, batch, phase, true)?;
    let mut gradients = Gradients {
        losses: terms.losses,
        kl_per_latent: terms.kl_per_latent,
        norms: Vec::new(),
        of_theta: None,
    };
    if gradients.losses.is_finite() {
        let of_theta = terms.total.backward()?;
        for network in model.networks() {
            if let Some(gradient) = of_theta.get(network.theta()) {
                let norm = adam::norm(gradient)?;
                gradients.norms.push((network.name.clone(), norm));
            }
        }
        gradients.of_theta = Some(of_theta);
    }
    Ok(gradients)
}

impl Gradients {
    /// What is not a number: the loss, or the gradient of a network. An update by it would spoil the weights and
    /// Adam's moments for good.
    pub fn not_finite(&self) -> Option<String> {
        if !self.losses.is_finite() {
            return Some(format!("the loss ({:?})", self.losses));
        }
        let (network, norm) = self.norms.iter().find(|(_, norm)| !norm.is_finite())?;
        Some(format!("the gradient of `{network}` (norm {norm})"))
    }

    /// One update of every network that this phase trains: clip, Adam.
    pub fn apply(
        &self,
        model: &Model,
        moments: &mut BTreeMap<String, Moments>,
        phase: &Phase,
    ) -> Result<(), TrainError> {
        let Some(of_theta) = &self.of_theta else {
            return Ok(());
        };
        let training = &model.config.training;
        let differentiated = model
            .networks()
            .filter_map(|network| Some((network, of_theta.get(network.theta())?)));
        for ((network, gradient), (_, norm)) in differentiated.zip(&self.norms) {
            let dynamics = network.name == model.dynamics.network.name;
            let gradient = match phase.stage {
                Stage::Autoencoder if dynamics => continue,
                // Where the gradient and its moments are zero, Adam leaves a number where it is.
                Stage::Bases if dynamics => &(gradient * model.dynamics.bases_mask()?)?,
                _ => gradient,
            };
            let clip = if dynamics || training.clipped == Clipped::All {
                training.clip
            } else {
                f32::INFINITY
            };
            adam::update(
                network.theta(),
                gradient,
                *norm,
                moments.entry(network.name.clone()).or_default(),
                phase.rate,
                clip,
            )?;
        }
        Ok(())
    }
}
