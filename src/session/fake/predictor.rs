//! A linear-Gaussian model of the moving square.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::dataset::{TABLE_M, centre_of, square_at};
use super::dynamics::{self, LATENT, STEP_VARIANCE};
use crate::episode::{Episode, Frame, Layout};
use crate::modality::{Expert, ExpertSet};
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace, GaussianTrace, Rolled, count_prior};
use crate::session::predict::{PredictError, Predictor};
use crate::session::snapshot::{Estimate, ModelInfo};

/// Variance before anything was seen.
const FIRST_VARIANCE: f32 = 20.0;
/// W of the position probe: metres along x and y of the first two dimensions.
const WEIGHTS: [f32; 2 * LATENT] = [TABLE_M, 0.0, 0.0, 0.0, 0.0, TABLE_M, 0.0, 0.0];

/// How often a predictor was asked; shared, so that it can be read while the predictor works elsewhere.
#[derive(Debug, Default)]
pub struct Calls {
    encode: AtomicUsize,
    encode_one: AtomicUsize,
    filter: AtomicUsize,
}

impl Calls {
    /// Episodes encoded.
    pub fn encoded(&self) -> usize {
        self.encode.load(Ordering::Relaxed)
    }

    /// Experts encoded again on their own.
    pub fn encoded_one(&self) -> usize {
        self.encode_one.load(Ordering::Relaxed)
    }

    /// Settings of the switches filtered.
    pub fn filtered(&self) -> usize {
        self.filter.load(Ordering::Relaxed)
    }
}

/// The model.
#[derive(Debug)]
pub struct FakePredictor {
    info: ModelInfo,
    calls: Arc<Calls>,
}

impl FakePredictor {
    /// Vision, haptic and proprio apart, trained on every set: like `v-h-p`.
    pub fn three() -> Self {
        let sets = (0..8).map(ExpertSet).collect();
        Self::new(
            "v-h-p",
            &[Expert::Vision, Expert::Haptic, Expert::Proprio],
            true,
            sets,
        )
    }

    /// Vision and one joint expert, trained with both on: like `vhp`.
    pub fn joint() -> Self {
        Self::new(
            "vhp",
            &[Expert::Vision, Expert::Joint],
            true,
            vec![ExpertSet::full(2)],
        )
    }

    /// Vision alone, without a product: like `v`.
    pub fn vision() -> Self {
        Self::new("v", &[Expert::Vision], false, vec![ExpertSet::full(1)])
    }

    fn new(
        name: &str,
        experts: &[Expert],
        prior_expert: bool,
        trained_sets: Vec<ExpertSet>,
    ) -> Self {
        let info = ModelInfo {
            name: name.to_owned(),
            source: "made up".to_owned(),
            experts: experts.to_vec(),
            latent: LATENT,
            frame_stack: 1,
            prior_expert,
            trained_sets,
            ..ModelInfo::default()
        };
        Self {
            info,
            calls: Arc::default(),
        }
    }

    /// The same, as of an update of its training.
    #[must_use]
    pub fn at_update(mut self, update: u64) -> Self {
        self.info.update = Some(update);
        self
    }

    /// The same, with a hash to be kept by.
    #[must_use]
    pub fn with_hash(mut self, hash: &str) -> Self {
        hash.clone_into(&mut self.info.hash);
        self
    }

    /// Its counters.
    pub fn calls(&self) -> Arc<Calls> {
        Arc::clone(&self.calls)
    }

    fn expert_says(&self, index: usize, episode: &Episode) -> Result<GaussianTrace, PredictError> {
        let Some(&expert) = self.info.experts.get(index) else {
            return Err(PredictError(format!("there is no sensor expert {index}")));
        };
        let missing = || PredictError(format!("no {}", expert.name()));
        self.says(expert, episode).ok_or_else(missing)
    }

    fn says(&self, expert: Expert, episode: &Episode) -> Option<GaussianTrace> {
        let (stack, window) = (self.info.frame_stack, episode.layout.window);
        let log_var: [f32; LATENT] = match expert {
            Expert::Vision => [-7.0, -6.0, -1.0, 0.5],
            Expert::Haptic => [-5.0, -6.5, 0.0, 0.0],
            Expert::Proprio => [-6.0, -5.0, 0.5, -0.5],
            Expert::Joint | Expert::Concat | Expert::Prior => [-6.0, -6.0, 0.0, 0.0],
        };
        let mut trace = GaussianTrace {
            latent: LATENT,
            ..GaussianTrace::default()
        };
        for t in stack..episode.steps() {
            let [x, y] = match expert {
                Expert::Vision => centre_of(episode.frames.get(t)?),
                Expert::Proprio => first_sample(episode.proprio.as_ref()?, t, window)?,
                _ => first_sample(episode.haptic.as_ref()?, t, window)?,
            };
            trace.mean.extend([x, y, 0.3, -0.2]);
            trace.log_var.extend(log_var);
        }
        Some(trace)
    }
}

fn first_sample(windows: &[f32], step: usize, window: usize) -> Option<[f32; 2]> {
    let at = step * window * 6;
    Some([*windows.get(at)?, *windows.get(at + 1)?])
}

impl Predictor for FakePredictor {
    fn info(&self) -> &ModelInfo {
        &self.info
    }

    fn layout(&self) -> Layout {
        Layout::default()
    }

    fn missing(&self, episode: &Episode) -> Vec<String> {
        let lacks = |expert: &&Expert| self.says(**expert, episode).is_none();
        self.info
            .experts
            .iter()
            .filter(lacks)
            .map(|expert| expert.name().to_owned())
            .collect()
    }

    fn encode(&self, episode: &Episode) -> Result<ExpertTrace, PredictError> {
        self.calls.encode.fetch_add(1, Ordering::Relaxed);
        let experts = 0..self.info.experts.len();
        let experts = experts
            .map(|expert| self.expert_says(expert, episode))
            .collect::<Result<_, _>>()?;
        let controls = episode
            .controls
            .iter()
            .flatten()
            .skip(self.info.frame_stack);
        Ok(ExpertTrace {
            experts,
            controls: controls.copied().collect(),
        })
    }

    fn encode_expert(
        &self,
        episode: &Episode,
        expert: usize,
    ) -> Result<GaussianTrace, PredictError> {
        self.calls.encode_one.fetch_add(1, Ordering::Relaxed);
        self.expert_says(expert, episode)
    }

    fn filter(&self, trace: &ExpertTrace, alphas: &Alphas) -> Result<BeliefTrace, PredictError> {
        self.calls.filter.fetch_add(1, Ordering::Relaxed);
        let count = trace.experts.first().map_or(0, GaussianTrace::len);
        let empty = || GaussianTrace {
            latent: LATENT,
            ..GaussianTrace::default()
        };
        let (mut prior, mut posterior) = (empty(), empty());
        let (mut mean, mut variance) = ([0.0_f32; LATENT], [FIRST_VARIANCE; LATENT]);
        for i in 0..count {
            prior.mean.extend(mean);
            prior.log_var.extend(variance.map(f32::ln));
            let mut alpha = alphas.row(i).to_vec();
            let switches = alpha.len();
            count_prior(&mut alpha, switches, self.info.prior_expert);
            let prior_alpha = alpha.last().copied().unwrap_or(1.0);
            for d in 0..LATENT {
                let (mut precision, mut weighted) = (
                    prior_alpha / variance[d],
                    prior_alpha * mean[d] / variance[d],
                );
                for (expert, alpha) in trace.experts.iter().zip(&alpha) {
                    let (means, log_vars) = expert.row(i);
                    let share = alpha * (-log_vars[d]).exp();
                    precision += share;
                    weighted += share * means[d];
                }
                (mean[d], variance[d]) = (weighted / precision, 1.0 / precision);
            }
            posterior.mean.extend(mean);
            posterior.log_var.extend(variance.map(f32::ln));
            dynamics::push(&mut mean, trace.controls.get(i));
            variance = [STEP_VARIANCE; LATENT];
        }
        Ok(BeliefTrace {
            prior,
            posterior,
            hidden: Vec::new(),
        })
    }

    fn transitions(&self, beliefs: &BeliefTrace) -> Result<Vec<f32>, PredictError> {
        Ok(dynamics::identities(beliefs.posterior.len()))
    }

    fn rollout(
        &self,
        beliefs: &BeliefTrace,
        from: usize,
        controls: &[[f32; 2]],
    ) -> Result<Rolled, PredictError> {
        Ok(dynamics::rollout(row(beliefs, from)?.0, controls))
    }

    fn sample(
        &self,
        beliefs: &BeliefTrace,
        from: usize,
        controls: &[[f32; 2]],
        noise: &[f32],
    ) -> Result<Vec<f32>, PredictError> {
        let each = (controls.len() + 1) * LATENT;
        if !noise.len().is_multiple_of(each) {
            let (len, steps) = (noise.len(), controls.len());
            return Err(PredictError(format!(
                "{len} numbers of noise are not of whole samples over {steps} steps"
            )));
        }
        let (mean, log_var) = row(beliefs, from)?;
        Ok(dynamics::samples(mean, log_var, controls, noise))
    }

    fn decode(&self, latents: &[f32]) -> Result<Vec<Frame>, PredictError> {
        let size = self.layout().frame_size;
        let frames = latents
            .chunks_exact(LATENT)
            .map(|z| square_at([z[0], z[1]], size));
        Ok(frames.collect())
    }

    fn position(&self, mean: &[f32], log_var: &[f32]) -> Option<Estimate> {
        let [x, y, ..] = mean else { return None };
        let [vx, vy, ..] = log_var else { return None };
        let scale = TABLE_M * TABLE_M;
        Some(Estimate {
            x: x * TABLE_M,
            y: y * TABLE_M,
            covariance: [vx.exp() * scale, 0.0, vy.exp() * scale],
        })
    }

    fn position_weights(&self) -> Option<&[f32]> {
        Some(&WEIGHTS)
    }

    fn position_bias(&self) -> Option<[f32; 2]> {
        Some([0.0; 2])
    }

    fn position_residual(&self) -> Option<[f32; 3]> {
        Some([0.0; 3])
    }
}

/// Mean and log-variances of a belief.
fn row(beliefs: &BeliefTrace, from: usize) -> Result<(&[f32], &[f32]), PredictError> {
    let count = beliefs.posterior.len();
    if from >= count {
        return Err(PredictError(format!(
            "there is no belief {from} of {count}"
        )));
    }
    Ok(beliefs.posterior.row(from))
}
