//! Consistency over a split: whether what is claimed is held.

use serde::Serialize;

use crate::measure::calibration::{Calibration, HorizonNees};
use crate::measure::correlation::Dependence;
use crate::measure::tempering::FittedAlpha;
use crate::modality::Expert;

/// The board of the current switches. What was measured stays while another is computed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BoardView {
    /// Which episodes: `test`.
    pub split: String,
    /// Episodes taken in.
    pub episodes: usize,
    /// Of so many.
    pub total: usize,
    /// Whether the numbers are of before the last change, while those of now are being measured.
    pub stale: bool,
    /// Why there is nothing to read, where there is nothing.
    pub why_not: Option<String>,
    /// The filtered belief at the last step of the context: one error an episode, R_p included.
    pub filtered: Option<Calibration>,
    /// Mean NEES of the same without R_p.
    pub filtered_bare_nees: Option<f64>,
    /// The prediction at the last horizon that all episodes have, with the head's one-step spread.
    pub predicted: Option<Calibration>,
    /// NEES at each horizon with the head's one-step spread; the first is the filtered belief.
    pub by_head: Vec<HorizonNees>,
    /// NEES at each horizon with A P Aᵀ + Q carried along.
    pub by_propagation: Vec<HorizonNees>,
    /// NEES of the filtered belief at the images that the horizons are of: what it would be, had it gone on seeing.
    pub by_filter: Vec<HorizonNees>,
    /// Correlation between the experts' errors, and what it does to confidence; `a` and `b` are of `experts`.
    pub dependence: Option<Dependence>,
    /// The sensor experts that `dependence` counts.
    pub experts: Vec<Expert>,
    /// The α that makes the positions likeliest, expert by expert, all others as they are.
    pub alphas: Vec<(Expert, FittedAlpha)>,
    /// What `alphas` were fitted on: `val, 34 episodes`.
    pub alphas_from: String,
    /// The same in plain words, the most important first.
    pub sentences: Vec<String>,
}
