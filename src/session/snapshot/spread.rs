//! How sure a rollout is, told in three ways (D20), and what its samples look like (D22).

use std::sync::Arc;

use serde::Serialize;

use crate::episode::Frame;

/// The spread of the rollout over its horizon. Covariances are of the position, W P Wᵀ as xx, xy, yy in square metres,
/// without the probe's own residual.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SpreadView {
    /// The step of the first prediction, from 0.
    pub first_step: usize,
    /// What the transition's head states, one step ahead; does not accumulate. Empty without a probe.
    pub head: Vec<[f32; 3]>,
    /// A P Aᵀ + Q carried along, the mixture's gates frozen along the mean path. Empty without a probe.
    pub propagated: Vec<[f32; 3]>,
    /// Of the samples. Empty without a probe.
    pub sampled: Vec<[f32; 3]>,
    /// Root of the trace of the latent's covariance in the same three ways: head, propagated, sampled.
    pub latent_sigma: Vec<[f32; 3]>,
    /// A path of positions for each of some samples, in metres: the fan. Empty without a probe.
    pub fan: Vec<Vec<[f32; 2]>>,
    /// Samples it was made of.
    pub samples: usize,
    /// Seed of their noise; the same for both sides of every comparison.
    pub seed: u64,
    /// The samples' pictures at the cursor; none outside the horizon.
    pub frames: Option<Arc<SampleFrames>>,
}

/// Decoded samples of one step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampleFrames {
    /// The step, from 0.
    pub step: usize,
    /// The first sample, decoded.
    pub sample: Arc<Frame>,
    /// Mean of the decoded samples.
    pub mean: Arc<Frame>,
    /// Standard deviation of the decoded samples at each pixel, in parts of the grey range, row major.
    pub deviation: Arc<Vec<f32>>,
    /// Samples decoded.
    pub decoded: usize,
    /// Blur index of the frame decoded from the mean path: its gradient energy over the truth's; 1 is as sharp as the truth.
    pub blur_of_mean_path: Option<f32>,
    /// Blur index of the mean of the decoded samples.
    pub blur_of_samples: Option<f32>,
}
