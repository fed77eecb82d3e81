//! What has been computed, kept as long as it is likely to be asked for again.
//!
//! An episode is read once for a layout and encoded once for a model; the filter runs once for a setting of the
//! switches. So a switch never encodes, and switching back shows what was there without computing it again.

use std::sync::Arc;

use super::lru::Lru;
use super::opened::Opened;
use super::pictured::Pictured;
use crate::episode::{Episode, EpisodeSource, Layout, SourceError};
use crate::measure::fusion::{mean_share, precision_shares};
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace};
use crate::session::predict::{PredictError, Predictor};
use crate::session::settings::Rollout;

/// Episodes and encodings kept.
const EPISODES: usize = 8;
/// Settings of the switches kept, with their decoded frames.
const BELIEFS: usize = 16;

/// One model on one episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// Index of the model.
    pub model: usize,
    /// Index of the episode.
    pub episode: usize,
}

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
}

impl Inferred {
    /// Log-variances of every expert at a belief, the prior last.
    pub fn log_vars(&self, belief: usize) -> Vec<&[f32]> {
        let sensors = self.trace.experts.iter();
        let all = sensors.chain([&self.beliefs.prior]);
        all.map(|gaussians| gaussians.row(belief).1).collect()
    }

    /// α of the experts that are multiplied; 0 for a prior that is none of them.
    pub fn factor_alphas(&self, belief: usize, prior_expert: bool) -> Vec<f32> {
        let mut alphas = self.alphas.row(belief).to_vec();
        if let (false, Some(prior)) = (prior_expert, alphas.last_mut()) {
            *prior = 0.0;
        }
        alphas
    }
}

/// A setting of the switches, compared bit for bit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BeliefKey {
    target: Target,
    alpha_bits: Vec<u32>,
}

/// Beliefs and their pictures.
#[derive(Debug)]
pub struct Believed {
    /// The numbers.
    pub inferred: Arc<Inferred>,
    /// The pictures.
    pub pictured: Pictured,
}

/// Everything kept.
#[derive(Debug)]
pub struct Memo {
    episodes: Lru<(usize, Layout), Arc<Episode>>,
    opened: Lru<Target, Arc<Opened>>,
    traces: Lru<Target, Arc<ExpertTrace>>,
    beliefs: Lru<BeliefKey, Believed>,
    rollouts: Lru<(BeliefKey, Rollout), Pictured>,
}

impl Default for Memo {
    fn default() -> Self {
        Self {
            episodes: Lru::new(EPISODES),
            opened: Lru::new(EPISODES),
            traces: Lru::new(EPISODES),
            beliefs: Lru::new(BELIEFS),
            rollouts: Lru::new(BELIEFS),
        }
    }
}

impl Memo {
    /// The aligned episode in a layout.
    pub fn episode(
        &mut self,
        source: &dyn EpisodeSource,
        index: usize,
        layout: Layout,
    ) -> Result<Arc<Episode>, SourceError> {
        let key = (index, layout);
        let load = || source.load(index, layout).map(Arc::new);
        self.episodes
            .get_or_try_insert(key, load)
            .map(|episode| Arc::clone(episode))
    }

    /// What can be shown of it before any model has run.
    pub fn opened(
        &mut self,
        target: Target,
        episode: &Episode,
        predictor: Option<&dyn Predictor>,
    ) -> Arc<Opened> {
        let missing = || predictor.map(|p| p.missing(episode)).unwrap_or_default();
        let open = || Ok::<_, std::convert::Infallible>(Arc::new(Opened::new(episode, missing())));
        match self.opened.get_or_try_insert(target, open) {
            Ok(opened) => Arc::clone(opened),
            Err(never) => match never {},
        }
    }

    /// Drops what came from a model.
    pub fn forget(&mut self, model: usize) {
        self.opened.forget(|target| target.model == model);
        self.traces.forget(|target| target.model == model);
        self.beliefs.forget(|key| key.target.model == model);
        self.rollouts.forget(|(key, _)| key.target.model == model);
    }

    /// What the experts say of the episode.
    pub fn trace(
        &mut self,
        target: Target,
        episode: &Episode,
        predictor: &dyn Predictor,
    ) -> Result<Arc<ExpertTrace>, PredictError> {
        let encode = || predictor.encode(episode).map(Arc::new);
        self.traces
            .get_or_try_insert(target, encode)
            .map(|trace| Arc::clone(trace))
    }

    /// Whether it is known what the experts say.
    pub fn is_encoded(&mut self, target: Target) -> bool {
        self.traces.get(&target).is_some()
    }

    /// Filters for one setting of the switches.
    pub fn believe(
        &mut self,
        target: Target,
        trace: &Arc<ExpertTrace>,
        alphas: Alphas,
        steps: usize,
        predictor: &dyn Predictor,
    ) -> Result<BeliefKey, PredictError> {
        let key = BeliefKey {
            target,
            alpha_bits: alphas.values.iter().map(|alpha| alpha.to_bits()).collect(),
        };
        let filter = || infer(Arc::clone(trace), alphas, steps, predictor);
        self.beliefs.get_or_try_insert(key.clone(), filter)?;
        Ok(key)
    }

    /// Beliefs that were filtered just before.
    pub fn believed(&mut self, key: &BeliefKey) -> Option<&mut Believed> {
        self.beliefs.get(key)
    }

    /// Rolls out from these beliefs, where there is a step to predict.
    pub fn roll_out(
        &mut self,
        key: &BeliefKey,
        rollout: Rollout,
        steps: usize,
        predictor: &dyn Predictor,
    ) -> Result<(), PredictError> {
        if rollout.horizon == 0 {
            return Ok(());
        }
        let Some(inferred) = self
            .beliefs
            .get(key)
            .map(|believed| Arc::clone(&believed.inferred))
        else {
            return Ok(());
        };
        let from = rollout.start.saturating_sub(predictor.info().frame_stack);
        let roll = || {
            let controls = inferred.trace.controls.get(from..from + rollout.horizon);
            let controls = controls.ok_or_else(|| {
                PredictError(format!(
                    "a rollout of {} steps from belief {from} needs controls that were not recorded",
                    rollout.horizon
                ))
            })?;
            let rolled = predictor.rollout(&inferred.beliefs, from, controls)?;
            let (first, gaussians) = (rollout.start + 1, rolled.gaussians);
            Ok::<_, PredictError>(Pictured::new(predictor, gaussians, first, steps))
        };
        self.rollouts
            .get_or_try_insert((key.clone(), rollout), roll)?;
        Ok(())
    }

    /// A rollout that was made just before.
    pub fn rolled_out(&mut self, key: &BeliefKey, rollout: Rollout) -> Option<&mut Pictured> {
        self.rollouts.get(&(key.clone(), rollout))
    }
}

fn infer(
    trace: Arc<ExpertTrace>,
    alphas: Alphas,
    steps: usize,
    predictor: &dyn Predictor,
) -> Result<Believed, PredictError> {
    let beliefs = predictor.filter(&trace, &alphas)?;
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
    };
    let mut over_time = vec![vec![f32::NAN; steps]; inferred.alphas.experts];
    for belief in 0..count {
        let alphas = inferred.factor_alphas(belief, info.prior_expert);
        let shares = precision_shares(&alphas, &inferred.log_vars(belief));
        for (row, share) in over_time.iter_mut().zip(shares) {
            row[belief + info.frame_stack] = mean_share(&share);
        }
    }
    inferred.share_over_time = over_time.into_iter().map(Arc::new).collect();
    let posterior = inferred.beliefs.posterior.clone();
    Ok(Believed {
        pictured: Pictured::new(predictor, posterior, info.frame_stack, steps),
        inferred: Arc::new(inferred),
    })
}
