//! The ellipse of a 2 × 2 covariance, with the mass it holds.

use std::f32::consts::TAU;

/// Probability inside the 1σ ellipse of a Gaussian in the plane: `1 − exp(−1/2)`, not the 68 % of a line.
pub const ONE_SIGMA_MASS: f32 = 0.393_469_34;
/// Radius in σ of the ellipse that holds 95 % of a Gaussian in the plane: `sqrt(−2 ln 0.05)`.
pub const SIGMAS_OF_95_PERCENT: f32 = 2.447_746_8;

/// The 1σ ellipse: semi-axes in the unit of the standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ellipse {
    /// Longer semi-axis.
    pub major: f32,
    /// Shorter semi-axis.
    pub minor: f32,
    /// Direction of the longer axis, in radians from x towards y.
    pub angle: f32,
}

impl Ellipse {
    /// Principal axes of the covariance `[xx, xy, yy]`. Rounding that makes a variance slightly negative counts
    /// as zero.
    pub fn of_covariance([xx, xy, yy]: [f32; 3]) -> Self {
        let (xx, xy, yy) = (f64::from(xx), f64::from(xy), f64::from(yy));
        let mean = 0.5 * (xx + yy);
        let spread = (0.25 * (xx - yy).powi(2) + xy * xy).sqrt();
        Self {
            major: (mean + spread).max(0.0).sqrt() as f32,
            minor: (mean - spread).max(0.0).sqrt() as f32,
            angle: (0.5 * (2.0 * xy).atan2(xx - yy)) as f32,
        }
    }

    /// `count` points, at least one, of the ellipse of `sigmas` σ around `centre`, in order, and the first once more: a
    /// closed line.
    pub fn outline(self, centre: [f32; 2], sigmas: f32, count: usize) -> Vec<[f32; 2]> {
        let (sin, cos) = self.angle.sin_cos();
        (0..=count)
            .map(|i| {
                let turn = TAU * (i % count) as f32 / count as f32;
                let (a, b) = (
                    sigmas * self.major * turn.cos(),
                    sigmas * self.minor * turn.sin(),
                );
                [centre[0] + cos * a - sin * b, centre[1] + sin * a + cos * b]
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_4;

    use super::*;

    #[test]
    fn axes_of_a_turned_covariance() {
        // Variances 4 and 1 along the diagonals.
        let ellipse = Ellipse::of_covariance([2.5, 1.5, 2.5]);
        assert!((ellipse.major - 2.0).abs() < 1e-6);
        assert!((ellipse.minor - 1.0).abs() < 1e-6);
        assert!((ellipse.angle - FRAC_PI_4).abs() < 1e-6);
    }

    #[test]
    fn a_degenerate_covariance_has_no_width() {
        let ellipse = Ellipse::of_covariance([1.0, 1.0, 1.0]);
        assert!(ellipse.minor < 1e-3);
        assert_eq!(Ellipse::of_covariance([0.0; 3]), Ellipse::default());
    }

    #[test]
    fn every_point_of_the_outline_is_at_its_distance() {
        let covariance = [2.0, 0.6, 1.0];
        let [xx, xy, yy] = covariance;
        let determinant = xx * yy - xy * xy;
        let outline =
            Ellipse::of_covariance(covariance).outline([3.0, -1.0], SIGMAS_OF_95_PERCENT, 17);
        assert_eq!((outline.len(), outline[0]), (18, outline[17]));
        for [x, y] in outline {
            let (dx, dy) = (x - 3.0, y + 1.0);
            let squared = (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / determinant;
            assert!((squared.sqrt() - SIGMAS_OF_95_PERCENT).abs() < 1e-4);
        }
    }

    #[test]
    fn masses_are_those_of_the_chi_squared_law() {
        assert!((1.0 - (-0.5_f32).exp() - ONE_SIGMA_MASS).abs() < 1e-6);
        assert!(((-0.5 * SIGMAS_OF_95_PERCENT.powi(2)).exp() - 0.05).abs() < 1e-6);
    }
}
