//! How sure a rollout is, in three ways (D20), with its samples (D22).

use std::sync::Arc;

use super::inferred::Inferred;
use super::memo::{BeliefKey, RolloutKey};
use super::noise;
use super::opened::Opened;
use crate::episode::Frame;
use crate::measure::samples::{blur_index, mean_frame, spread_frame};
use crate::measure::spread::{diagonal, plane, sample_covariance};
use crate::session::predict::{PredictError, Predictor};
use crate::session::snapshot::spread::{SampleFrames, SpreadView};

/// Samples whose frames are decoded; the others count for positions and the latent only.
const DECODED: usize = 16;
/// Paths that are handed out to be drawn.
const FAN: usize = 24;

/// What a spread depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct SpreadKey {
    /// The beliefs it starts from.
    pub belief: BeliefKey,
    /// Its steps and controls; the sample in it does not count.
    pub rollout: RolloutKey,
    /// Samples.
    pub samples: usize,
    /// Seed of their noise.
    pub seed: u64,
}

/// A rollout's spread, with the latents of its samples.
#[derive(Debug)]
pub struct Spread {
    view: SpreadView,
    /// `(S, h, Z)`.
    latents: Vec<f32>,
    latent: usize,
    horizon: usize,
    frames: Option<Arc<SampleFrames>>,
}

impl Spread {
    /// Rolls out and samples.
    pub fn of(
        key: &SpreadKey,
        inferred: &Inferred,
        predictor: &dyn Predictor,
    ) -> Result<Self, PredictError> {
        let rollout = key.rollout.rollout;
        let latent = predictor.info().latent;
        let controls = inferred.controls(rollout, key.rollout.controls)?;
        let from = inferred.start(rollout);
        let rolled = predictor.rollout(&inferred.beliefs, from, &controls)?;
        let noise = noise::normal(key.seed, key.samples, controls.len() + 1, latent);
        let latents = predictor.sample(&inferred.beliefs, from, &controls, &noise)?;
        let mut view = SpreadView {
            first_step: rollout.start + 1,
            samples: key.samples,
            seed: key.seed,
            ..SpreadView::default()
        };
        let weights = predictor.position_weights();
        let start = inferred.posterior(from).log_var;
        for (step, covariance) in rolled.covariances(start).enumerate() {
            let log_var = rolled.gaussians.row(step).1;
            let samples = Samples {
                latents: &latents,
                latent,
                horizon: controls.len(),
                step,
            };
            let trace: f64 = covariance.iter().step_by(latent + 1).sum();
            let head: f32 = log_var.iter().map(|v| v.exp()).sum();
            view.latent_sigma
                .push([head.sqrt(), trace.sqrt() as f32, samples.sigma()]);
            let Some(weights) = weights else { continue };
            let positions: Vec<[f32; 2]> = samples
                .each()
                .filter_map(|z| predictor.position(z, log_var))
                .map(|at| [at.x, at.y])
                .collect();
            view.head.extend(plane(weights, &diagonal(log_var)));
            view.propagated.extend(plane(weights, &covariance));
            view.sampled.extend(sample_covariance(&positions));
            view.fan.resize_with(positions.len().min(FAN), Vec::new);
            for (path, at) in view.fan.iter_mut().zip(positions) {
                path.push(at);
            }
        }
        Ok(Self {
            view,
            latents,
            latent,
            horizon: controls.len(),
            frames: None,
        })
    }

    /// The spread with the samples' pictures at a step.
    pub fn at(
        &mut self,
        step: usize,
        opened: &Opened,
        mean_path: Option<&Frame>,
        predictor: &dyn Predictor,
    ) -> Result<SpreadView, PredictError> {
        let ahead = step.checked_sub(self.view.first_step);
        let ahead = ahead.filter(|&ahead| ahead < self.horizon);
        if let Some(ahead) = ahead
            && self.frames.as_ref().is_none_or(|f| f.step != step)
        {
            self.frames = self.pictures(step, ahead, opened, mean_path, predictor)?;
        }
        Ok(SpreadView {
            frames: ahead.and_then(|_| self.frames.clone()),
            ..self.view.clone()
        })
    }

    fn pictures(
        &self,
        step: usize,
        ahead: usize,
        opened: &Opened,
        mean_path: Option<&Frame>,
        predictor: &dyn Predictor,
    ) -> Result<Option<Arc<SampleFrames>>, PredictError> {
        let samples = Samples {
            latents: &self.latents,
            latent: self.latent,
            horizon: self.horizon,
            step: ahead,
        };
        let latents: Vec<f32> = samples.each().take(DECODED).flatten().copied().collect();
        let frames = predictor.decode(&latents)?;
        let shown: Vec<&Frame> = frames.iter().collect();
        let (Some(sample), Some(mean), Some(deviation)) =
            (frames.first(), mean_frame(&shown), spread_frame(&shown))
        else {
            return Ok(None);
        };
        let truth = opened.truth.get(step);
        let blur = |frame: &Frame| truth.and_then(|truth| blur_index(frame, truth));
        Ok(Some(Arc::new(SampleFrames {
            step,
            sample: Arc::new(sample.clone()),
            deviation: Arc::new(deviation),
            decoded: frames.len(),
            blur_of_mean_path: mean_path.and_then(blur),
            blur_of_samples: blur(&mean),
            mean: Arc::new(mean),
        })))
    }
}

/// All samples at one step of the horizon.
struct Samples<'a> {
    latents: &'a [f32],
    latent: usize,
    horizon: usize,
    step: usize,
}

impl<'a> Samples<'a> {
    fn each(&self) -> impl Iterator<Item = &'a [f32]> {
        let (latent, step) = (self.latent, self.step);
        self.latents
            .chunks_exact((self.horizon * latent).max(1))
            .map(move |sample| &sample[step * latent..(step + 1) * latent])
    }

    /// Root of the trace of the samples' covariance.
    fn sigma(&self) -> f32 {
        let count = self.each().count() as f64;
        let variance = |d: usize| {
            let values = || self.each().map(|z| f64::from(z[d]));
            let mean = values().sum::<f64>() / count;
            values().map(|z| (z - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0)
        };
        (0..self.latent).map(variance).sum::<f64>().sqrt() as f32
    }
}
