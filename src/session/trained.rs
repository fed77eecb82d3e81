//! A trained model under the session's cursor: the model's tensors behind the session's plain numbers.

use std::fmt::Display;

use super::predict::{PredictError, Predictor};
use super::snapshot::{Estimate, ModelInfo};
use crate::episode::{Episode, Frame, Layout};
use crate::model::Model;
use crate::model::inspect::Inspector;
use crate::model::observation::{self, observe, observe_expert};
use crate::model::probe::Probe;
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace, GaussianTrace, Rolled};

/// Where a model came from.
#[derive(Clone, Debug, Default)]
pub struct Origin {
    /// For the status line.
    pub source: String,
    /// The update of its training run that it is of, where that is known.
    pub update: Option<u64>,
    /// [`hash`](crate::model::checkpoint::hash) of its files; empty for one that has none.
    pub hash: String,
    /// The force that counts as contact in its training set, in newtons; none where its report does not say.
    pub contact_newtons: Option<f32>,
}

/// A model with its weights folded, and its position probe.
#[derive(Debug)]
pub struct Trained {
    inspector: Inspector,
    probe: Option<Probe>,
    info: ModelInfo,
}

fn refused(error: impl Display) -> PredictError {
    PredictError(error.to_string())
}

impl Trained {
    /// Takes over `model`.
    pub fn new(model: Model, probe: Option<Probe>, origin: Origin) -> Result<Self, PredictError> {
        let config = &model.config;
        let info = ModelInfo {
            name: config.name.clone(),
            source: origin.source,
            update: origin.update,
            hash: origin.hash,
            experts: config.experts.clone(),
            latent: config.latent,
            frame_stack: config.frame_stack,
            prior_expert: config.prior_expert,
            trained_sets: config.trained_sets(),
            config: toml::to_string(config).map_err(refused)?,
            contact_newtons: origin.contact_newtons,
        };
        let inspector = Inspector::new(model).map_err(refused)?;
        Ok(Self {
            inspector,
            probe,
            info,
        })
    }
}

impl Predictor for Trained {
    fn info(&self) -> &ModelInfo {
        &self.info
    }

    fn layout(&self) -> Layout {
        self.inspector.model().config.layout()
    }

    fn missing(&self, episode: &Episode) -> Vec<String> {
        observation::missing(&self.inspector.model().config, episode)
    }

    fn encode(&self, episode: &Episode) -> Result<ExpertTrace, PredictError> {
        let config = &self.inspector.model().config;
        observation::suits(config, episode).map_err(refused)?;
        let seen = observe(config, episode).map_err(refused)?;
        self.inspector.encode(&seen).map_err(refused)
    }

    fn encode_expert(
        &self,
        episode: &Episode,
        expert: usize,
    ) -> Result<GaussianTrace, PredictError> {
        let config = &self.inspector.model().config;
        let seen = observe_expert(config, episode, expert).map_err(refused)?;
        self.inspector.encode_expert(&seen, expert).map_err(refused)
    }

    fn filter(&self, trace: &ExpertTrace, alphas: &Alphas) -> Result<BeliefTrace, PredictError> {
        self.inspector.filter(trace, alphas).map_err(refused)
    }

    fn filter_all(
        &self,
        trace: &ExpertTrace,
        settings: &[Alphas],
    ) -> Result<Vec<BeliefTrace>, PredictError> {
        self.inspector.filter_all(trace, settings).map_err(refused)
    }

    fn transitions(&self, beliefs: &BeliefTrace) -> Result<Vec<f32>, PredictError> {
        self.inspector.transitions(beliefs).map_err(refused)
    }

    fn rollout(
        &self,
        beliefs: &BeliefTrace,
        from: usize,
        controls: &[[f32; 2]],
    ) -> Result<Rolled, PredictError> {
        let rolled = self.inspector.rollout(beliefs, from, controls);
        rolled.map_err(refused)
    }

    fn sample(
        &self,
        beliefs: &BeliefTrace,
        from: usize,
        controls: &[[f32; 2]],
        noise: &[f32],
    ) -> Result<Vec<f32>, PredictError> {
        let sampled = self.inspector.sample(beliefs, from, controls, noise);
        sampled.map_err(refused)
    }

    fn decode(&self, latents: &[f32]) -> Result<Vec<Frame>, PredictError> {
        self.inspector.decode_frames(latents).map_err(refused)
    }

    fn position(&self, mean: &[f32], log_var: &[f32]) -> Option<Estimate> {
        let probe = self.probe.as_ref()?;
        let [x, y] = probe.position(mean);
        Some(Estimate {
            x,
            y,
            covariance: probe.covariance(log_var),
        })
    }

    fn position_weights(&self) -> Option<&[f32]> {
        self.probe.as_ref().map(|probe| probe.weights.as_slice())
    }

    fn position_bias(&self) -> Option<[f32; 2]> {
        self.probe.as_ref().map(|probe| probe.bias)
    }

    fn position_residual(&self) -> Option<[f32; 3]> {
        self.probe.as_ref().map(|probe| probe.residual)
    }
}
