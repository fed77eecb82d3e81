//! Every set of experts at once.

use std::sync::Arc;

use serde::Serialize;

use super::Estimate;
use crate::episode::Frame;

/// What each non-empty set of experts, in the whole episode, believes at the cursor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LatticeView {
    /// The step of the frames and numbers, from 0.
    pub step: usize,
    /// One a set: the largest sets first, the prior's among those of one size last.
    pub cells: Vec<LatticeCell>,
}

/// One set of experts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LatticeCell {
    /// Which experts are on, in the order of `Snapshot::experts`; the prior last.
    pub active: Vec<bool>,
    /// Their letters: `VHD`.
    pub name: String,
    /// Whether the model was trained on it.
    pub trained: bool,
    /// Whether the switches are just this set, at every step.
    pub current: bool,
    /// The decoded belief, once decoded.
    pub frame: Option<Arc<Frame>>,
    /// Sum of the frame's squared errors; none before it is decoded.
    pub squared_error: Option<f32>,
    /// PSNR of the frame in dB; none before it is decoded.
    pub psnr_db: Option<f32>,
    /// Position; none without a probe.
    pub position: Option<Estimate>,
    /// Its distance from the truth in metres.
    pub position_error_m: Option<f32>,
    /// Root mean squared distance from the truth over the episode, in metres.
    pub episode_rmse_m: Option<f32>,
    /// Area of the ellipse of one σ, in square metres.
    pub ellipse_m2: Option<f32>,
}
