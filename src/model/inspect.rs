//! A trained model as plain numbers in and out, on the mean path: what the session and the evaluation ask of it.

use std::borrow::Borrow;

use candle_core::{Device, Result, Tensor};

use super::filter::{self, Inputs};
use super::gaussian::DiagGaussian;
use super::observation::Observations;
use super::trace::{Alphas, BeliefTrace, ExpertTrace, GaussianTrace};
use super::{Model, Weights};
use crate::episode::Frame;

/// A model, owned or borrowed, with its weights folded once.
#[derive(Debug)]
pub struct Inspector<M = Model> {
    model: M,
    weights: Weights,
}

/// `(1, n, Z)` or `(n, Z)` Gaussians as numbers.
fn trace(gaussian: &DiagGaussian, latent: usize) -> Result<GaussianTrace> {
    Ok(GaussianTrace {
        latent,
        mean: gaussian.mean.flatten_all()?.to_vec1()?,
        log_var: gaussian.log_var.flatten_all()?.to_vec1()?,
    })
}

impl<M: Borrow<Model>> Inspector<M> {
    /// Folds the weights of `model`.
    pub fn new(model: M) -> Result<Self> {
        let weights = model.borrow().weights()?.detach();
        Ok(Self { model, weights })
    }

    /// The model.
    pub fn model(&self) -> &Model {
        self.model.borrow()
    }

    /// Each expert's Gaussian at each belief of `observations`.
    pub fn encode(&self, observations: &Observations) -> Result<ExpertTrace> {
        let mut experts = Vec::new();
        let mut streams = observations.streams.iter();
        for (encoder, weights) in self.model().encoders.iter().zip(&self.weights.encoders) {
            let seen = streams
                .by_ref()
                .take(encoder.streams())
                .enumerate()
                .map(|(i, seen)| {
                    let shape = (observations.beliefs, encoder.inputs(i));
                    Tensor::from_slice(seen, shape, &Device::Cpu)
                })
                .collect::<Result<Vec<_>>>()?;
            let expert = encoder.encode(&seen, weights, false)?;
            experts.push(trace(&expert, self.model().config.latent)?);
        }
        Ok(ExpertTrace {
            experts,
            controls: observations.controls.clone(),
        })
    }

    /// The beliefs for one setting of the switches.
    pub fn filter(&self, experts: &ExpertTrace, alphas: &Alphas) -> Result<BeliefTrace> {
        let latent = self.model().config.latent;
        let beliefs = alphas.values.len() / alphas.experts;
        let shape = (1, beliefs, latent);
        let gaussians = experts
            .experts
            .iter()
            .map(|expert| {
                Ok(DiagGaussian {
                    mean: Tensor::from_slice(&expert.mean, shape, &Device::Cpu)?,
                    log_var: Tensor::from_slice(&expert.log_var, shape, &Device::Cpu)?,
                })
            })
            .collect::<Result<Vec<_>>>()?;
        let alphas =
            Tensor::from_slice(&alphas.values, (1, beliefs, alphas.experts), &Device::Cpu)?;
        let controls = controls(&experts.controls)?;
        let inputs = Inputs {
            experts: &gaussians,
            alphas: &alphas,
            controls: &controls,
            noise: None,
        };
        let filtered = filter::filter(
            &self.model().dynamics,
            &self.weights.dynamics,
            inputs,
            self.model().config.prior_expert,
        )?;
        Ok(BeliefTrace {
            prior: trace(&filtered.prior, latent)?,
            posterior: trace(&filtered.posterior, latent)?,
            hidden: filtered.hidden.flatten_all()?.to_vec1()?,
        })
    }

    /// The prior alone from belief `from`, for `horizon` beliefs.
    pub fn rollout(
        &self,
        experts: &ExpertTrace,
        beliefs: &BeliefTrace,
        from: usize,
        horizon: usize,
    ) -> Result<GaussianTrace> {
        let config = &self.model().config;
        if horizon == 0 {
            return Ok(GaussianTrace {
                latent: config.latent,
                ..GaussianTrace::default()
            });
        }
        let Some(known) = experts.controls.get(from..from + horizon) else {
            candle_core::bail!(
                "a rollout of {horizon} steps from belief {from} needs controls that were not recorded"
            );
        };
        let hidden = &beliefs.hidden[from * config.hidden..(from + 1) * config.hidden];
        let hidden = Tensor::from_slice(hidden, (1, config.hidden), &Device::Cpu)?;
        let z = Tensor::from_slice(
            beliefs.posterior.row(from).0,
            (1, config.latent),
            &Device::Cpu,
        )?;
        let rolled = filter::rollout(
            &self.model().dynamics,
            &self.weights.dynamics,
            &hidden,
            &z,
            &controls(known)?,
        )?;
        trace(&rolled, config.latent)
    }

    /// What expert `index` would see for each latent, `(n, Z)` row major: `(n, outputs)` numbers.
    pub fn decode(&self, index: usize, latents: &[f32]) -> Result<Vec<f32>> {
        if latents.is_empty() {
            return Ok(Vec::new());
        }
        let latent = self.model().config.latent;
        let latents = Tensor::from_slice(latents, (latents.len() / latent, latent), &Device::Cpu)?;
        self.model().decoders[index]
            .decode(&latents, &self.weights.decoders[index])?
            .flatten_all()?
            .to_vec1()
    }

    /// The newest frame for each latent, `(n, Z)` row major, in [0, 1]: `(n, height * width)` numbers.
    pub fn decode_pixels(&self, latents: &[f32]) -> Result<Vec<f32>> {
        let decoded = self.decode(0, latents)?;
        Ok(decoded
            .into_iter()
            .step_by(self.model().config.frame_stack + 1)
            .collect())
    }

    /// The newest frame for each latent, as grey levels.
    pub fn decode_frames(&self, latents: &[f32]) -> Result<Vec<Frame>> {
        let side = self.model().config.frame_size;
        let pixels = self.decode_pixels(latents)?;
        let frame = |pixels: &[f32]| Frame {
            width: side,
            height: side,
            pixels: pixels.iter().map(|&p| (p * 255.0).round() as u8).collect(),
        };
        Ok(pixels.chunks_exact(side * side).map(frame).collect())
    }
}

/// `(1, n, U)`.
fn controls(rows: &[[f32; 2]]) -> Result<Tensor> {
    Tensor::from_slice(rows.as_flattened(), (1, rows.len(), 2), &Device::Cpu)
}
