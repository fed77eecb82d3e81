//! One update: forward, the terms of the bound, backward, clip, Adam.

use std::collections::BTreeMap;

use candle_core::Tensor;
use candle_core::backprop::GradStore;
use serde::{Deserialize, Serialize};

use super::TrainError;
use super::batch::Batch;
use crate::model::filter::{self, Inputs};
use crate::model::gaussian::DiagGaussian;
use crate::model::kernel::adam::{self, Moments};
use crate::model::{Model, elbo};

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

/// The loss of a batch, with gradients where `train`.
pub fn loss(model: &Model, batch: &Batch, train: bool) -> Result<Terms, TrainError> {
    let config = &model.config;
    let weights = model.weights()?;
    let (b, t) = (batch.episodes, batch.beliefs);
    let mut experts = Vec::new();
    for ((encoder, weights), seen) in model
        .encoders
        .iter()
        .zip(&weights.encoders)
        .zip(&batch.seen)
    {
        let g = encoder.encode(seen, weights, train)?;
        let shape = |x: &Tensor| x.reshape((b, t, config.latent));
        experts.push(DiagGaussian {
            mean: shape(&g.mean)?,
            log_var: shape(&g.log_var)?,
        });
    }
    let inputs = Inputs {
        experts: &experts,
        alphas: &batch.alphas,
        controls: &batch.controls,
        noise: train.then_some(&batch.noise),
    };
    let filtered = filter::filter(
        &model.dynamics,
        &weights.dynamics,
        inputs,
        config.prior_expert,
    )?;
    let plain_kl = elbo::kl(&filtered)?.mean_all()?;
    let kl_per_latent = elbo::kl_per_latent(&filtered)?.mean((0, 1))?.to_vec1()?;
    let mut kl = plain_kl.clone();
    let steps = config.training.n_step;
    for term in elbo::overshooting(
        &model.dynamics,
        &weights.dynamics,
        &filtered,
        &batch.controls,
        steps,
    )? {
        kl = (kl + term.mean_all()?)?;
    }
    let mut total = kl.affine(config.training.kl_weight, 0.0)?;
    let latents = filtered.z.flatten(0, 1)?;
    let mut losses = Losses {
        kl: plain_kl.to_scalar()?,
        ..Losses::default()
    };
    losses.negative_elbo = losses.kl;
    for (i, decoder) in model.decoders.iter().enumerate() {
        let weight = config.training.error_weights.get(i).copied().unwrap_or(1.0);
        let each = vec![weight / (b * t) as f32; b * t];
        let (error, per_belief) =
            decoder.squared_error(&latents, &weights.decoders[i], &batch.seen[i], each, train)?;
        total = (total + error)?;
        let per_belief = per_belief
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let mean = per_belief.iter().sum::<f32>() / per_belief.len() as f32;
        *(if i == 0 {
            &mut losses.vision
        } else {
            &mut losses.windows
        }) += mean;
        // −ln N(x; x̂, ½ I) = ‖x − x̂‖² + D/2 ln π.
        losses.negative_elbo +=
            mean + batch.seen[i].dim(1)? as f32 * 0.5 * std::f32::consts::PI.ln();
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
pub fn gradients(model: &Model, batch: &Batch) -> Result<Gradients, TrainError> {
    let terms = loss(model, batch, true)?;
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

    /// One update of every network: clip, Adam.
    pub fn apply(
        &self,
        model: &Model,
        moments: &mut BTreeMap<String, Moments>,
        rate: f64,
    ) -> Result<(), TrainError> {
        let Some(of_theta) = &self.of_theta else {
            return Ok(());
        };
        let trained = model
            .networks()
            .filter_map(|network| Some((network, of_theta.get(network.theta())?)));
        for ((network, gradient), (_, norm)) in trained.zip(&self.norms) {
            adam::update(
                network.theta(),
                gradient,
                *norm,
                moments.entry(network.name.clone()).or_default(),
                rate,
                model.config.training.clip,
            )?;
        }
        Ok(())
    }
}
