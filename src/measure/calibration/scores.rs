//! Sharpness and proper scores of one position Gaussian (D13), good only together with the coverage.

use std::f64::consts::{PI, SQRT_2, TAU};

use statrs::function::erf::erf;

use super::Error2;

/// `tr P` in square metres.
pub(super) fn sharpness(error: &Error2) -> f64 {
    f64::from(error.covariance[0]) + f64::from(error.covariance[2])
}

/// `½ (ε + ln det 2πP)` in nats for an error whose NEES is ε; NaN where there is none.
pub(super) fn nll(error: &Error2, nees: f64) -> f64 {
    let determinant = error.determinant().unwrap_or(f64::NAN);
    0.5 * (nees + determinant.ln()) + TAU.ln()
}

/// The continuous ranked probability score along one axis, in metres: `σ [ω (2Φ(ω) − 1) + 2φ(ω) − 1/√π]` with
/// `ω = e/σ` (Gneiting & Raftery 2007, Eq. 21).
pub(super) fn crps(error: &Error2, axis: usize) -> f64 {
    let variance = f64::from(error.covariance[2 * axis]);
    let sigma = variance.sqrt();
    let omega = f64::from(error.error_m[axis]) / sigma;
    let density = (-0.5 * omega * omega).exp() / TAU.sqrt();
    sigma * (omega * erf(omega / SQRT_2) + 2.0 * density - 1.0 / PI.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::calibration::nees;

    #[test]
    fn the_crps_is_the_integral_it_stands_for() {
        // ∫ (Φ(t/σ) − 1[t ≥ e])² dt, by the midpoint rule.
        for (e, variance) in [(0.0_f32, 1.0_f32), (0.4, 0.25), (-2.5, 0.5)] {
            let (low, high, count) = (-12.0, 12.0, 48_000);
            let width = (high - low) / f64::from(count);
            let sigma = f64::from(variance).sqrt();
            let integral: f64 = (0..count)
                .map(|i| {
                    let t = low + (f64::from(i) + 0.5) * width;
                    let below = 0.5 * (1.0 + erf(t / sigma / SQRT_2));
                    let step = f64::from(u8::from(t >= f64::from(e)));
                    (below - step).powi(2) * width
                })
                .sum();
            let error = Error2 {
                error_m: [9.0, e],
                covariance: [1.0, 0.0, variance],
            };
            assert!((crps(&error, 1) - integral).abs() < 5e-4);
        }
    }

    #[test]
    fn the_nll_is_minus_the_log_density() {
        // Two independent axes: the densities of N(0, 4) at 1 and of N(0, 0.25) at -0.5.
        let error = Error2 {
            error_m: [1.0, -0.5],
            covariance: [4.0, 0.0, 0.25],
        };
        let line = |e: f64, v: f64| 0.5 * (e * e / v + (TAU * v).ln());
        let expected = line(1.0, 4.0) + line(-0.5, 0.25);
        let found = nll(&error, nees(&error).expect("positive definite"));
        assert!((found - expected).abs() < 1e-12);
    }
}
