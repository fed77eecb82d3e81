//! Stub.
use serde::{Deserialize, Serialize};
/// D17.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Damage {
    /// Zero.
    Zero,
    /// Hold.
    Hold,
    /// Noise.
    Noise,
    /// Occlude.
    Occlude,
    /// Bias.
    Bias,
    /// Delay.
    Delay,
}
impl Damage {
    /// All.
    pub const ALL: [Self; 6] = [
        Self::Zero,
        Self::Hold,
        Self::Noise,
        Self::Occlude,
        Self::Bias,
        Self::Delay,
    ];
    /// Name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Hold => "hold",
            Self::Noise => "noise",
            Self::Occlude => "occlude",
            Self::Bias => "bias",
            Self::Delay => "delay",
        }
    }
}
/// D17.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Corruption {
    /// How.
    pub damage: Damage,
    /// 0 to 1.
    pub severity: f32,
    /// First step.
    pub from: usize,
    /// First step not any more.
    pub until: Option<usize>,
    /// Centre of the patch.
    pub patch: [f32; 2],
    /// Seed.
    pub seed: u64,
}
