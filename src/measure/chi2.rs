//! The chi-squared law that the diagnostics D8 to D12 are read against.

use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// The value below which a share `p` of the law with `dof` degrees of freedom lies.
///
/// Zero at `p = 0`, infinite at `p = 1`; NaN where `p` is no probability or `dof` is not positive and finite.
pub fn quantile(dof: f64, p: f64) -> f64 {
    match law(dof) {
        Some(law) if (0.0..=1.0).contains(&p) => law.inverse_cdf(p),
        _ => f64::NAN,
    }
}

/// The probability of a value of at most `x` with `dof` degrees of freedom; NaN where `x` is NaN or `dof` is not
/// positive and finite.
pub fn cdf(dof: f64, x: f64) -> f64 {
    match law(dof) {
        Some(law) if x.is_finite() => law.cdf(x),
        Some(_) if x == f64::INFINITY => 1.0,
        Some(_) if x == f64::NEG_INFINITY => 0.0,
        _ => f64::NAN,
    }
}

/// Between which values a chi-squared statistic of a well-stated model stays.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bounds {
    /// Below it the model claims to know less than it does.
    pub low: f32,
    /// Above it the model claims to know more than it does.
    pub high: f32,
}

impl Bounds {
    /// Whether `value` lies within, ends included.
    pub fn hold(self, value: f32) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// The two-sided 95 % bounds, 2.5 % on either side. NaN where `dof` is not positive and finite.
pub fn bounds_95(dof: f64) -> Bounds {
    Bounds {
        low: quantile(dof, 0.025) as f32,
        high: quantile(dof, 0.975) as f32,
    }
}

fn law(dof: f64) -> Option<ChiSquared> {
    // An infinite shape is a point mass for the library, not an error.
    ChiSquared::new(dof).ok().filter(|_| dof.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_printed_tables() {
        // NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.4, three decimals.
        for (dof, p, value) in [
            (1.0, 0.95, 3.841),
            (1.0, 0.975, 5.024),
            (2.0, 0.025, 0.051),
            (2.0, 0.95, 5.991),
            (2.0, 0.975, 7.378),
            (10.0, 0.025, 3.247),
            (10.0, 0.975, 20.483),
            (16.0, 0.025, 6.908),
            (16.0, 0.95, 26.296),
            (16.0, 0.975, 28.845),
            (100.0, 0.025, 74.222),
            (100.0, 0.975, 129.561),
        ] {
            let ours = quantile(dof, p);
            assert!((ours - value).abs() < 5.1e-4, "{dof} {p}: {ours}");
            assert!((cdf(dof, ours) - p).abs() < 1e-9);
        }
        let bounds = bounds_95(16.0);
        assert!((bounds.low - 6.908).abs() < 1e-3 && (bounds.high - 28.845).abs() < 1e-3);
        assert!(bounds.hold(16.0) && !bounds.hold(30.0) && !bounds.hold(f32::NAN));
    }

    #[test]
    fn two_degrees_are_an_exponential_law() {
        for p in [1e-6, 0.1, 0.5, 0.9, 0.999] {
            assert!((quantile(2.0, p) + 2.0 * (1.0 - p).ln()).abs() < 1e-9);
        }
    }

    #[test]
    fn what_is_no_probability_has_no_quantile() {
        for (dof, p) in [
            (2.0, -0.1),
            (2.0, 1.1),
            (2.0, f64::NAN),
            (0.0, 0.5),
            (-1.0, 0.5),
            (f64::NAN, 0.5),
            (f64::INFINITY, 0.5),
        ] {
            assert!(quantile(dof, p).is_nan(), "{dof} {p}");
        }
        assert!(cdf(2.0, f64::NAN).is_nan() && cdf(0.0, 1.0).is_nan());
        assert!(bounds_95(0.0).low.is_nan());
        assert!(quantile(2.0, 0.0).abs() < 1e-300 && quantile(2.0, 1.0).is_infinite());
        assert!(cdf(2.0, f64::INFINITY) > 1.0 - 1e-15 && cdf(2.0, -1.0).abs() < 1e-300);
    }
}
