//! Stub.
use super::chi2::Bounds;
use serde::Serialize;
/// D8.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Nis {
    /// Against the head's own spread.
    pub head: f32,
    /// Against A P A + Q.
    pub propagated: Option<f32>,
    /// Degrees.
    pub dof: usize,
    /// None where an alpha is neither 0 nor 1.
    pub bounds: Option<Bounds>,
}
/// D9.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Disagreement {
    /// Position of one.
    pub a: usize,
    /// Position of the other.
    pub b: usize,
    /// d squared.
    pub distance: f32,
    /// Degrees.
    pub dof: usize,
    /// Bounds.
    pub bounds: Option<Bounds>,
}
/// D10.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Conflict {
    /// Q.
    pub energy: f32,
    /// Degrees.
    pub dof: usize,
    /// ln C.
    pub log_normaliser: f32,
    /// Bounds.
    pub bounds: Option<Bounds>,
}
