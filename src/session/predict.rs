//! What a session needs of a model; the tests have a second implementation.

use thiserror::Error;

use super::snapshot::{Estimate, ModelInfo};
use crate::episode::{Episode, Frame, Layout};
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace, GaussianTrace, Rolled};

/// Why a model could not answer.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct PredictError(pub String);

/// A trained model under the session's cursor. Beliefs are counted from the first one: belief i is at step
/// `i + frame_stack`. Everything but samples is on the mean path, and everything deterministic; threads may share it.
pub trait Predictor: Send + Sync {
    /// What faces say of it.
    fn info(&self) -> &ModelInfo;

    /// The sizes it wants an episode in.
    fn layout(&self) -> Layout;

    /// Roles that it needs and the episode lacks.
    fn missing(&self, episode: &Episode) -> Vec<String>;

    /// Each sensor expert's Gaussian at each belief. Does not depend on the switches. Refuses an episode of another
    /// kind than the model was trained on.
    fn encode(&self, episode: &Episode) -> Result<ExpertTrace, PredictError>;

    /// What sensor expert `expert` alone says, with the same bits as in [`Self::encode`]. For an episode whose input
    /// was damaged on purpose: values that the model was never trained on are not refused.
    fn encode_expert(
        &self,
        episode: &Episode,
        expert: usize,
    ) -> Result<GaussianTrace, PredictError>;

    /// The belief at each step for one setting of the switches.
    fn filter(&self, trace: &ExpertTrace, alphas: &Alphas) -> Result<BeliefTrace, PredictError>;

    /// The same for several settings over the same steps, in their order: each with the same bits as alone.
    fn filter_all(
        &self,
        trace: &ExpertTrace,
        settings: &[Alphas],
    ) -> Result<Vec<BeliefTrace>, PredictError> {
        settings
            .iter()
            .map(|alphas| self.filter(trace, alphas))
            .collect()
    }

    /// A of the transition that led to each belief, its gates frozen along the mean path, `(beliefs, Z, Z)` row major;
    /// the identity for the first belief, to which nothing led (D8, D20).
    fn transitions(&self, beliefs: &BeliefTrace) -> Result<Vec<f32>, PredictError>;

    /// The prior alone from belief `from`, one further belief a control, whatever the switches (D20).
    fn rollout(
        &self,
        beliefs: &BeliefTrace,
        from: usize,
        controls: &[[f32; 2]],
    ) -> Result<Rolled, PredictError>;

    /// Ancestral samples of the same, `(S, h, Z)`: `z ~ q` at belief `from`, then `z' ~ N(A z + B u, Q)` (D20).
    /// `noise`, from N(0, I), is `(S, h + 1, Z)`, its first row for the draw from q; the same noise on both sides of a
    /// comparison tells them apart by what differs alone.
    fn sample(
        &self,
        beliefs: &BeliefTrace,
        from: usize,
        controls: &[[f32; 2]],
        noise: &[f32],
    ) -> Result<Vec<f32>, PredictError>;

    /// The newest frame of each of the latents, `(n, Z)` row major.
    fn decode(&self, latents: &[f32]) -> Result<Vec<Frame>, PredictError>;

    /// The object's position for one belief; none without a probe.
    fn position(&self, mean: &[f32], log_var: &[f32]) -> Option<Estimate>;

    /// The position probe's weights W, `(2, Z)` row major, in metres; none without a probe.
    fn position_weights(&self) -> Option<&[f32]>;

    /// The position probe's b, in metres; none without a probe.
    fn position_bias(&self) -> Option<[f32; 2]>;

    /// The position probe's R_p as xx, xy, yy in square metres (D11); none without a probe.
    fn position_residual(&self) -> Option<[f32; 3]>;
}
