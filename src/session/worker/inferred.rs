//! The filter's answer to one setting of the switches, and what is predicted from it.

use std::sync::Arc;

use super::memo::RolloutKey;
use super::noise;
use crate::measure::fusion::{mean_share, position_shares, precision_shares};
use crate::measure::gaussian::{Factor, Gaussian};
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace, GaussianTrace};
use crate::session::predict::{PredictError, Predictor};
use crate::session::settings::{ControlEdit, Rollout};

/// The filter's answer to one setting of the switches.
#[derive(Debug)]
pub struct Inferred {
    /// The switches it was made with.
    pub alphas: Alphas,
    /// What the experts said.
    pub trace: Arc<ExpertTrace>,
    /// What came out.
    pub beliefs: BeliefTrace,
    /// For each expert its mean precision share at every step; NaN before the first belief.
    pub share_over_time: Vec<Arc<Vec<f32>>>,
    /// Whether the prior is one of the experts that are multiplied.
    prior_expert: bool,
    /// Frames under the first belief.
    frame_stack: usize,
}

/// Filters.
pub fn infer(
    trace: Arc<ExpertTrace>,
    alphas: Alphas,
    steps: usize,
    predictor: &dyn Predictor,
) -> Result<Inferred, PredictError> {
    let beliefs = predictor.filter(&trace, &alphas)?;
    complete(trace, alphas, beliefs, steps, predictor)
}

fn complete(
    trace: Arc<ExpertTrace>,
    alphas: Alphas,
    beliefs: BeliefTrace,
    steps: usize,
    predictor: &dyn Predictor,
) -> Result<Inferred, PredictError> {
    let (info, count) = (predictor.info(), beliefs.posterior.len());
    if count + info.frame_stack != steps || beliefs.prior.len() != count {
        return Err(PredictError(format!(
            "{} made {count} beliefs for {steps} steps",
            info.name
        )));
    }
    let mut inferred = Inferred {
        share_over_time: Vec::new(),
        alphas,
        trace,
        beliefs,
        prior_expert: info.prior_expert,
        frame_stack: info.frame_stack,
    };
    let mut over_time = vec![vec![f32::NAN; steps]; inferred.alphas.experts];
    for belief in 0..count {
        for (row, share) in over_time.iter_mut().zip(inferred.shares(belief)) {
            row[belief + info.frame_stack] = mean_share(&share);
        }
    }
    inferred.share_over_time = over_time.into_iter().map(Arc::new).collect();
    Ok(inferred)
}

/// Filters several settings of the switches as one batch.
pub fn infer_all(
    trace: &Arc<ExpertTrace>,
    settings: Vec<Alphas>,
    steps: usize,
    predictor: &dyn Predictor,
) -> Result<Vec<Inferred>, PredictError> {
    let beliefs = predictor.filter_all(trace, &settings)?;
    settings
        .into_iter()
        .zip(beliefs)
        .map(|(alphas, beliefs)| complete(Arc::clone(trace), alphas, beliefs, steps, predictor))
        .collect()
}

impl Inferred {
    /// Number of beliefs.
    pub fn len(&self) -> usize {
        self.beliefs.posterior.len()
    }

    /// The belief of a step; none before the first.
    pub fn belief_at(&self, step: usize) -> Option<usize> {
        let belief = step.checked_sub(self.frame_stack)?;
        (belief < self.len()).then_some(belief)
    }

    /// What is multiplied at a belief: the sensor experts and the prior last, each with the α it counts with.
    pub fn factors(&self, belief: usize) -> Vec<Factor<'_>> {
        let (trace, prior_expert) = (&self.trace, self.prior_expert);
        self.beliefs
            .factors(trace, &self.alphas, prior_expert, belief)
    }

    /// Each expert's share of a belief's precision per latent dimension, the prior last (D1).
    pub fn shares(&self, belief: usize) -> Vec<Vec<f32>> {
        precision_shares(&self.factors(belief))
    }

    /// The same of the position that a probe's `weights` read, made of the belief's `shares` (D1); none where they read nothing.
    pub fn position_shares(
        &self,
        belief: usize,
        shares: &[Vec<f32>],
        weights: &[f32],
    ) -> Option<Vec<f32>> {
        let log_var = self.posterior(belief).log_var;
        let variance: Vec<f32> = log_var.iter().map(|v| v.exp()).collect();
        position_shares(shares, weights, &variance)
    }

    /// The prediction before a belief's observations.
    pub fn prior(&self, belief: usize) -> Gaussian<'_> {
        self.beliefs.prior.gaussian(belief)
    }

    /// The belief.
    pub fn posterior(&self, belief: usize) -> Gaussian<'_> {
        self.beliefs.posterior.gaussian(belief)
    }

    /// Index of the belief that a rollout starts from.
    pub fn start(&self, rollout: Rollout) -> usize {
        rollout.start.saturating_sub(self.frame_stack)
    }

    /// The controls of a rollout, edited or as recorded.
    pub fn controls(
        &self,
        rollout: Rollout,
        edit: Option<ControlEdit>,
    ) -> Result<Vec<[f32; 2]>, PredictError> {
        let from = self.start(rollout);
        let recorded = self.trace.controls.get(from..from + rollout.horizon);
        let recorded = recorded.ok_or_else(|| {
            PredictError(format!(
                "a rollout of {} steps from step {} needs controls that were not recorded",
                rollout.horizon,
                rollout.start + 1
            ))
        })?;
        Ok(match edit {
            Some(edit) => edit.apply(rollout.start, recorded),
            None => recorded.to_vec(),
        })
    }

    /// The mean path, or the first sample with the head's spread around it.
    pub fn roll_out(
        &self,
        which: RolloutKey,
        predictor: &dyn Predictor,
    ) -> Result<GaussianTrace, PredictError> {
        let controls = self.controls(which.rollout, which.controls)?;
        let from = self.start(which.rollout);
        let mut trace = predictor.rollout(&self.beliefs, from, &controls)?.gaussians;
        if let Some(seed) = which.sample {
            let noise = noise::normal(seed, 1, controls.len() + 1, trace.latent);
            trace.mean = predictor.sample(&self.beliefs, from, &controls, &noise)?;
        }
        Ok(trace)
    }
}
