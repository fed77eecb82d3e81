//! A trained model as plain numbers in and out, on the mean path: what the session and the evaluation ask of it.

mod rollout;

use std::borrow::Borrow;

use candle_core::{Device, Result, Tensor};

use super::dynamics::FIRST_VARIANCE;
use super::gaussian::DiagGaussian;
use super::kernel::read;
use super::kernel::recurrence::{self, Row};
use super::observation::Observations;
use super::trace::{Alphas, BeliefTrace, ExpertTrace, GaussianTrace, count_prior};
use super::{Model, Weights};
use crate::episode::Frame;

/// A model, owned or borrowed, with its weights folded once.
#[derive(Debug)]
pub struct Inspector<M = Model> {
    model: M,
    weights: Weights,
}

/// Samples that go through a network at once: its layers hold no more than these, however long an episode is.
const BLOCK: usize = 64;

/// Gaussians `(n, Z)` as numbers.
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
        let mut streams = observations.streams.as_slice();
        let mut experts = Vec::new();
        for (index, encoder) in self.model().encoders.iter().enumerate() {
            let own = streams.split_off(..encoder.streams()).unwrap_or_default();
            experts.push(self.say(index, own, observations.beliefs)?);
        }
        Ok(ExpertTrace {
            experts,
            controls: observations.controls.clone(),
        })
    }

    /// The Gaussians of expert `index` alone, from what it alone sees
    /// ([`observe_expert`](super::observation::observe_expert)): the same bits as in [`Self::encode`].
    pub fn encode_expert(
        &self,
        observations: &Observations,
        index: usize,
    ) -> Result<GaussianTrace> {
        self.say(index, &observations.streams, observations.beliefs)
    }

    /// What expert `index` says of its streams.
    fn say(&self, index: usize, streams: &[Vec<f32>], beliefs: usize) -> Result<GaussianTrace> {
        let networks = self.model().encoders.get(index);
        let (Some(encoder), Some(weights)) = (networks, self.weights.encoders.get(index)) else {
            candle_core::bail!("there is no sensor expert {index}");
        };
        if streams.len() != encoder.streams() {
            candle_core::bail!("expert {index} got {} streams", streams.len());
        }
        let mut said = GaussianTrace {
            latent: self.model().config.latent,
            ..GaussianTrace::default()
        };
        for from in (0..beliefs).step_by(BLOCK) {
            let until = beliefs.min(from + BLOCK);
            let block = |(i, seen): (usize, &Vec<f32>)| {
                let inputs = encoder.inputs(i);
                let Some(rows) = seen.get(from * inputs..until * inputs) else {
                    candle_core::bail!(
                        "stream {i} of expert {index} is shorter than {beliefs} beliefs"
                    );
                };
                Tensor::from_slice(rows, (until - from, inputs), &Device::Cpu)
            };
            let seen: Vec<Tensor> = streams
                .iter()
                .enumerate()
                .map(block)
                .collect::<Result<_>>()?;
            let block = trace(&encoder.encode(&seen, weights, false)?, said.latent)?;
            said.mean.extend(block.mean);
            said.log_var.extend(block.log_var);
        }
        Ok(said)
    }

    /// The beliefs for one setting of the switches.
    pub fn filter(&self, experts: &ExpertTrace, alphas: &Alphas) -> Result<BeliefTrace> {
        let mut all = self.filter_all(experts, std::slice::from_ref(alphas))?;
        Ok(all.remove(0))
    }

    /// The beliefs for several settings of the switches over the same steps, in their order: each with the same bits
    /// as alone, in less time.
    pub fn filter_all(
        &self,
        experts: &ExpertTrace,
        settings: &[Alphas],
    ) -> Result<Vec<BeliefTrace>> {
        let config = &self.model().config;
        let Some(first) = settings.first() else {
            return Ok(Vec::new());
        };
        let (switches, beliefs) = (first.experts, first.values.len() / first.experts);
        if switches != experts.experts.len() + 1
            || settings
                .iter()
                .any(|alphas| alphas.values.len() != first.values.len())
        {
            candle_core::bail!("switches of {switches} experts over {beliefs} beliefs do not fit");
        }
        let mut alphas = Vec::with_capacity(settings.len() * first.values.len());
        for setting in settings {
            alphas.extend_from_slice(&setting.values);
        }
        count_prior(&mut alphas, switches, config.prior_expert);
        let inputs = recurrence::Inputs {
            steps: beliefs,
            experts: experts
                .experts
                .iter()
                .map(|expert| (expert.mean.as_slice(), expert.log_var.as_slice()))
                .collect(),
            alphas: &alphas,
            controls: experts.controls.as_flattened(),
            noise: None,
            first_log_var: FIRST_VARIANCE.ln() as f32,
        };
        let sizes = self.model().dynamics.sizes();
        let rows = read(&self.weights.dynamics, |w| {
            recurrence::run(sizes, w, &inputs)
        })?;
        let row = Row::of(sizes);
        Ok(rows
            .chunks_exact(beliefs * row.width())
            .map(|rows| {
                let [prior_mean, prior_log_var, mean, log_var, _, hidden] = row.columns(rows);
                let trace = |mean, log_var| GaussianTrace {
                    latent: config.latent,
                    mean,
                    log_var,
                };
                BeliefTrace {
                    prior: trace(prior_mean, prior_log_var),
                    posterior: trace(mean, log_var),
                    hidden,
                }
            })
            .collect())
    }

    /// What expert `index` would see for each latent, `(n, Z)` row major: `(n, outputs)` numbers.
    pub fn decode(&self, index: usize, latents: &[f32]) -> Result<Vec<f32>> {
        let latent = self.model().config.latent;
        let (decoder, weights) = (&self.model().decoders[index], &self.weights.decoders[index]);
        let mut decoded = Vec::new();
        for block in latents.chunks(BLOCK * latent) {
            let block = Tensor::from_slice(block, (block.len() / latent, latent), &Device::Cpu)?;
            let block = decoder.decode(&block, weights)?.flatten_all()?;
            decoded.extend(block.to_vec1::<f32>()?);
        }
        Ok(decoded)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::config::Config;

    #[test]
    fn settings_have_the_same_bits_alone_and_together_and_a_switch_leaves_no_trace() -> Result<()> {
        let config = Config::named("v-h-p").expect("a model");
        let inspector = Inspector::new(Model::new(config, 3, &Device::Cpu)?)?;
        let beliefs = 7;
        let numbers = |n: usize, seed: f32| -> Vec<f32> {
            (0..n)
                .map(|i| ((i as f32 + seed) * 12.9898).sin())
                .collect()
        };
        let expert = |seed: f32| GaussianTrace {
            latent: 16,
            mean: numbers(beliefs * 16, seed),
            log_var: numbers(beliefs * 16, seed + 0.5),
        };
        let experts = ExpertTrace {
            experts: [1.0, 2.0, 3.0].map(expert).to_vec(),
            controls: numbers(2 * (beliefs - 1), 4.0).as_chunks().0.to_vec(),
        };
        let settings: Vec<Alphas> = (1..16_u32)
            .map(|set| Alphas {
                experts: 4,
                values: (0..4)
                    .map(|i| (set >> i & 1) as f32)
                    .collect::<Vec<_>>()
                    .repeat(beliefs),
            })
            .collect();
        let together = inspector.filter_all(&experts, &settings)?;
        assert_eq!(together.len(), 15);
        for (setting, trace) in settings.iter().zip(&together) {
            assert_eq!(&inspector.filter(&experts, setting)?, trace);
        }
        assert_ne!(together[0], together[14]);
        Ok(())
    }
}
