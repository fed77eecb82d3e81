//! Stub.
use serde::Serialize;
/// D14.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Correlation {
    /// One.
    pub a: usize,
    /// Other.
    pub b: usize,
    /// Rho.
    pub rho: f64,
}
/// D14.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dependence {
    /// Pairs.
    pub pairs: Vec<Correlation>,
    /// Mean.
    pub mean_rho: f64,
    /// n.
    pub experts: usize,
    /// n eff.
    pub effective: f64,
    /// 1 + (n-1) rho.
    pub inflation: f64,
    /// With prior.
    pub with_prior: Option<f64>,
    /// Words.
    pub sentence: String,
}
