//! Stub.
use serde::{Deserialize, Serialize};
/// D23.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// Error.
    #[default]
    Error,
    /// Distance.
    Distance,
    /// NEES.
    Nees,
    /// Conflict.
    Conflict,
    /// Gain.
    Gain,
    /// Escape.
    Escape,
}
impl Order {
    /// Name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Distance => "distance",
            Self::Nees => "nees",
            Self::Conflict => "conflict",
            Self::Gain => "gain",
            Self::Escape => "escape",
        }
    }
}
/// Scores.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// Root of the summed squared error of the frame.
    pub error: Option<f32>,
    /// Metres.
    pub distance_m: Option<f32>,
    /// NEES.
    pub nees: Option<f32>,
    /// Q.
    pub conflict: Option<f32>,
    /// Over v.
    pub gain: Option<f32>,
    /// First step outside its ellipse.
    pub escape: Option<usize>,
}
