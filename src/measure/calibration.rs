//! Stub.
use serde::Serialize;
/// Verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Verdict {
    /// Within.
    Calibrated,
    /// Over.
    Overconfident,
    /// Under.
    Underconfident,
    /// Few.
    TooFew,
}
/// D11.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HorizonNees {
    /// 0 filtered.
    pub horizon: usize,
    /// M.
    pub episodes: usize,
    /// Mean.
    pub mean: f64,
    /// Low.
    pub low: f64,
    /// High.
    pub high: f64,
    /// Verdict.
    pub verdict: Verdict,
}
/// D12.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CoveragePoint {
    /// Claimed.
    pub claimed: f64,
    /// Held.
    pub held: f64,
    /// Low.
    pub low: f64,
    /// High.
    pub high: f64,
}
/// D12, D13.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// n.
    pub n: usize,
    /// Curve.
    pub coverage: Vec<CoveragePoint>,
    /// Area.
    pub area: f64,
    /// Ten bins.
    pub pit: Vec<f64>,
    /// Mean tr P in square centimetres.
    pub sharpness_cm2: f64,
    /// NLL.
    pub nll: f64,
    /// CRPS x, y in cm.
    pub crps_cm: [f64; 2],
    /// Verdict.
    pub verdict: Verdict,
    /// Words.
    pub sentence: String,
}
