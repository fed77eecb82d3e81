//! Stub.
use serde::Serialize;
/// Two-sided 95 % bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Bounds {
    /// 2.5 %.
    pub low: f32,
    /// 97.5 %.
    pub high: f32,
}
