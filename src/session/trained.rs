//! A trained model under the session's cursor: the model's tensors behind the session's plain numbers.

use std::fmt::Display;

use super::predict::{PredictError, Predictor};
use super::snapshot::{Estimate, ModelInfo};
use crate::episode::{Episode, Frame, Layout};
use crate::model::Model;
use crate::model::inspect::Inspector;
use crate::model::observation::{self, observe};
use crate::model::probe::Probe;
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace, GaussianTrace};

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
    /// Takes over `model`; `source` says in the status line where it came from, `update` of which update of its
    /// training it is.
    pub fn new(
        model: Model,
        probe: Option<Probe>,
        source: String,
        update: Option<u64>,
    ) -> Result<Self, PredictError> {
        let config = &model.config;
        let info = ModelInfo {
            name: config.name.clone(),
            source,
            update,
            experts: config.experts.clone(),
            latent: config.latent,
            frame_stack: config.frame_stack,
            prior_expert: config.prior_expert,
            trained_sets: config.trained_sets(),
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

    fn filter(&self, trace: &ExpertTrace, alphas: &Alphas) -> Result<BeliefTrace, PredictError> {
        self.inspector.filter(trace, alphas).map_err(refused)
    }

    fn rollout(
        &self,
        trace: &ExpertTrace,
        beliefs: &BeliefTrace,
        from: usize,
        horizon: usize,
    ) -> Result<GaussianTrace, PredictError> {
        self.inspector
            .rollout(trace, beliefs, from, horizon)
            .map_err(refused)
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
}
