//! Stub.
use serde::Serialize;
/// D18.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Attribution {
    /// Metres along x and y.
    pub contribution_m: [Vec<f32>; 2],
    /// Parts of the variance along x and y.
    pub variance_part: [Vec<f32>; 2],
}
