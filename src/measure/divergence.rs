//! Stub.
use serde::Serialize;
/// Nats (D2 to D4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct KlParts {
    /// Of the means.
    pub mean: f32,
    /// Of the spreads.
    pub spread: f32,
}
