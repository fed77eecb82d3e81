//! Stub.
use serde::Serialize;
/// D15.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedAlpha {
    /// The fitted.
    pub alpha: f64,
    /// NLL there.
    pub nll: f64,
    /// NLL at 1.
    pub nll_as_trained: f64,
    /// Words.
    pub sentence: String,
}
