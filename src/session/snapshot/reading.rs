//! What a fusion is made of: at the cursor, and over the episode.

use std::sync::Arc;

use serde::Serialize;

use super::Estimate;
use crate::measure::attribution::Attribution;
use crate::measure::chi2::Bounds;
use crate::measure::divergence::KlParts;
use crate::measure::innovation::{Conflict, Disagreement, Nis};

/// The readings at the cursor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FusionView {
    /// One an expert, in the order of `Snapshot::experts`; the prior last.
    pub experts: Vec<ExpertReading>,
    /// KL(belief ‖ prior): how much the sensors changed what was predicted (D2).
    pub surprise: Option<KlParts>,
    /// Every pair of experts that are on (D9).
    pub disagreements: Vec<Disagreement>,
    /// How much agreement the product forces (D10); none with fewer than two experts on.
    pub conflict: Option<Conflict>,
    /// Where the prior alone puts the object, in metres; the arrows begin here. None without a probe.
    pub prior_m: Option<[f32; 2]>,
    /// What the belief moves from there, in metres: the sum of the pulls (D7).
    pub correction_m: Option<[f32; 2]>,
    /// Which latent dimensions carry the position, and how surely (D18); none without a probe.
    pub attribution: Option<Arc<Attribution>>,
    /// Dimensions whose mean moves over the data (D19); the others are greyed.
    pub active: Arc<Vec<bool>>,
    /// What `active` was measured on: `32 episodes`, `this episode`.
    pub active_from: String,
    /// Rise of the position error in metres when a dimension is shuffled over the data; empty until measured (D18).
    pub importance_m: Arc<Vec<f64>>,
}

/// What is read of one expert at the cursor.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ExpertReading {
    /// Against the prediction (D8); none for the prior, and for an expert that is off.
    pub nis: Option<Nis>,
    /// KL(belief ‖ expert): overruled, or merely vague (D3).
    pub fused: Option<KlParts>,
    /// KL(expert ‖ prior): what it alone would claim to know (D4); none for the prior.
    pub claim: Option<KlParts>,
    /// Entropy in nats that it removes when it comes last (D5); none where it is off or the only one.
    pub information_nats: Option<f32>,
    /// How far the belief without it is from the belief, in standard deviations of the former (D6).
    pub mahalanobis: Option<f32>,
    /// The belief's position without it (D6).
    pub without: Option<Estimate>,
    /// What it pulls the position by, in metres (D7); none for the prior.
    pub pull_m: Option<[f32; 2]>,
}

impl ExpertReading {
    /// How far the belief's position moves without it, in metres.
    pub fn shift_m(&self, belief: Estimate) -> Option<f32> {
        Some(self.without?.distance_m([belief.x, belief.y]))
    }
}

/// The readings over the episode, one value a step; NaN before the first belief and where there is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SeriesView {
    /// Each expert's share weighted by what moves the position, mean of both axes (D1); the prior last.
    pub share_position: Vec<Vec<f32>>,
    /// NIS of each sensor expert against the prior's own spread (D8).
    pub nis_head: Vec<Vec<f32>>,
    /// NIS of each sensor expert against A P Aᵀ + Q (D8).
    pub nis_propagated: Vec<Vec<f32>>,
    /// Where NIS of a well-specified expert lies in 95 % of the steps.
    pub nis_bounds: Option<Bounds>,
    /// Conflict energy (D10).
    pub conflict: Vec<f32>,
    /// Where the conflict energy of well-specified experts lies in 95 % of the steps, at each step.
    pub conflict_bounds: Vec<Option<Bounds>>,
    /// KL(belief ‖ prior) in nats (D2).
    pub surprise: Vec<f32>,
    /// NEES of the position (D11); NaN without a probe or a recorded pose.
    pub nees: Vec<f32>,
    /// The same without R_p.
    pub nees_bare: Vec<f32>,
}
