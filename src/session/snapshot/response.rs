//! How a fusion answers to damage of rising severity (D17).

use serde::Serialize;

use crate::measure::corruption::Damage;
use crate::modality::{Expert, Modality};

/// One modality's damage, from none to all of it, over the steps that it reaches in this episode.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResponseView {
    /// Whose input.
    pub modality: Modality,
    /// How it is damaged.
    pub damage: Damage,
    /// The expert that looks at it.
    pub expert: Expert,
    /// From 0 to 1; the lists below have one value for each.
    pub severity: Vec<f32>,
    /// Root mean squared distance of the position from the truth, in metres; NaN without a probe or poses.
    pub rmse_m: Vec<f32>,
    /// Mean NEES of the position; NaN likewise.
    pub nees: Vec<f32>,
    /// The expert's mean share of the belief's precision.
    pub share: Vec<f32>,
    /// Slope of the share over severity; below 0 the expert doubts itself when its input is damaged.
    pub slope: f32,
    /// The same in plain words.
    pub sentence: String,
}
