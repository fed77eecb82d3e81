//! Normalised estimation error squared (D11): a position error in units of the spread that was claimed for it.

use serde::Serialize;

use super::{FEW, Verdict};
use crate::measure::chi2::bounds_95;

/// Degrees of freedom of a position in the plane, and so the NEES of a calibrated belief.
const PLANE: f64 = 2.0;

/// A position error and what was claimed about it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Error2 {
    /// e, truth less estimate, in metres.
    pub error_m: [f32; 2],
    /// P as xx, xy, yy, in square metres.
    pub covariance: [f32; 3],
}

impl Error2 {
    /// The same error under a covariance that is larger by `residual` (xx, xy, yy in square metres), such as R_p.
    #[must_use]
    pub fn beside(self, residual: [f32; 3]) -> Self {
        Self {
            covariance: std::array::from_fn(|i| self.covariance[i] + residual[i]),
            ..self
        }
    }

    /// det P; none where the error or P is not finite or P is not positive definite.
    pub(super) fn determinant(&self) -> Option<f64> {
        let [xx, xy, yy] = self.covariance.map(f64::from);
        let determinant = xx * yy - xy * xy;
        let sound = self.error_m.iter().all(|e| e.is_finite())
            && determinant.is_finite()
            && xx > 0.0
            && determinant > 0.0;
        sound.then_some(determinant)
    }
}

/// `ε = eᵀ P⁻¹ e`, χ²₂ for a calibrated belief. None where the error or P is not finite or P is not positive definite.
pub fn nees(error: &Error2) -> Option<f64> {
    let determinant = error.determinant()?;
    let [x, y] = error.error_m.map(f64::from);
    let [xx, xy, yy] = error.covariance.map(f64::from);
    let nees = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant;
    // Rounding may take the form just below zero.
    nees.is_finite().then_some(nees.max(0.0))
}

/// The mean NEES of many episodes at one distance from the last observation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HorizonNees {
    /// Steps of prediction; 0 is the filtered belief.
    pub horizon: usize,
    /// M, the episodes that were counted.
    pub episodes: usize,
    /// ε̄, 2 for a calibrated belief.
    pub mean: f64,
    /// Lower end of `χ²_{2M} / M` at 95 %, two-sided.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Overconfident above the bounds, underconfident below.
    pub verdict: Verdict,
}

/// The mean NEES at a horizon with the bounds that hold for as many independent `errors`, one an episode. What has no
/// NEES is not counted. None where nothing is left.
pub fn horizon_nees(horizon: usize, errors: &[Error2]) -> Option<HorizonNees> {
    let values: Vec<f64> = errors.iter().filter_map(nees).collect();
    if values.is_empty() {
        return None;
    }
    let episodes = values.len();
    let count = episodes as f64;
    let mean = values.iter().sum::<f64>() / count;
    let bounds = bounds_95(PLANE * count);
    let (low, high) = (
        f64::from(bounds.low) / count,
        f64::from(bounds.high) / count,
    );
    let verdict = if episodes < FEW {
        Verdict::TooFew
    } else if mean > high {
        Verdict::Overconfident
    } else if mean < low {
        Verdict::Underconfident
    } else {
        Verdict::Calibrated
    };
    Some(HorizonNees {
        horizon,
        episodes,
        mean,
        low,
        high,
        verdict,
    })
}
