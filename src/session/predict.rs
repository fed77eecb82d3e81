//! What a session needs of a model; the tests have a second implementation.

use thiserror::Error;

use super::snapshot::{Estimate, ModelInfo};
use crate::episode::{Episode, Frame, Layout};
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace, GaussianTrace};

/// Why a model could not answer.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct PredictError(pub String);

/// A trained model under the session's cursor. Beliefs are counted from the first one: belief i is at step
/// `i + frame_stack`. Everything is on the mean path and deterministic.
pub trait Predictor: Send {
    /// What faces say of it.
    fn info(&self) -> &ModelInfo;

    /// The sizes it wants an episode in.
    fn layout(&self) -> Layout;

    /// Roles that it needs and the episode lacks.
    fn missing(&self, episode: &Episode) -> Vec<String>;

    /// Each sensor expert's Gaussian at each belief. Does not depend on the switches.
    fn encode(&self, episode: &Episode) -> Result<ExpertTrace, PredictError>;

    /// The belief at each step for one setting of the switches.
    fn filter(&self, trace: &ExpertTrace, alphas: &Alphas) -> Result<BeliefTrace, PredictError>;

    /// The prior alone from belief `from`, for `horizon` further beliefs.
    fn rollout(
        &self,
        trace: &ExpertTrace,
        beliefs: &BeliefTrace,
        from: usize,
        horizon: usize,
    ) -> Result<GaussianTrace, PredictError>;

    /// The newest frame of each of the latents, `(n, Z)` row major.
    fn decode(&self, latents: &[f32]) -> Result<Vec<Frame>, PredictError>;

    /// The object's position for one belief; none without a probe.
    fn position(&self, mean: &[f32], log_var: &[f32]) -> Option<Estimate>;

    /// The position probe's weights W, `(2, Z)` row major; none without a probe.
    fn position_weights(&self) -> Option<&[f32]>;
}
