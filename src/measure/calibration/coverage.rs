//! Coverage (D12): of what an ellipse claims to hold, how much it holds.
//!
//! A claim π is an ellipse with the radius of χ²₂'s quantile; an error lies inside where its PIT `u = χ²₂(ε)` is at
//! most π. So the curve is the empirical distribution of u, and a calibrated model's is the diagonal.

use serde::Serialize;

use super::CLAIM;

/// Two-sided 95 % of the normal law, for the intervals.
const Z: f64 = 1.959_963_984_540_054;
/// Bins of the PIT histogram.
const BINS: usize = 10;

/// One point of the coverage curve; all parts of one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CoveragePoint {
    /// π, the mass that the ellipse claims.
    pub claimed: f64,
    /// ĉ(π), the share of errors inside it.
    pub held: f64,
    /// Lower end of Wilson's 95 % interval of what is held.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl CoveragePoint {
    /// What is held at a claim, by the sorted PIT values of one error or more.
    pub(super) fn at(claimed: f64, pit: &[f64]) -> Self {
        let inside = pit.partition_point(|&u| u <= claimed);
        let (low, high) = wilson(inside, pit.len());
        Self {
            claimed,
            held: inside as f64 / pit.len() as f64,
            low,
            high,
        }
    }
}

/// The curve at 5, 10, … 95 and 99 %.
pub(super) fn coverage(pit: &[f64]) -> Vec<CoveragePoint> {
    let claims = (1..19).map(|i| 0.05 * f64::from(i)).chain([CLAIM, 0.99]);
    claims.map(|claim| CoveragePoint::at(claim, pit)).collect()
}

/// `∫ |ĉ(π) − π| dπ` over 0..1, exactly: between two sorted values ĉ stays.
pub(super) fn area(pit: &[f64]) -> f64 {
    let n = pit.len() as f64;
    let ends = pit.iter().copied().chain([1.0]);
    let starts = [0.0].into_iter().chain(pit.iter().copied());
    starts
        .zip(ends)
        .enumerate()
        .map(|(i, (start, end))| {
            let held = i as f64 / n;
            // ∫ |c − π| dπ has the antiderivative −½ (c − π) |c − π|.
            let at = |claim: f64| -0.5 * (held - claim) * (held - claim).abs();
            at(end) - at(start)
        })
        .sum()
}

/// Shares of the PIT values in ten bins of equal width.
pub(super) fn histogram(pit: &[f64]) -> Vec<f64> {
    let mut shares = vec![0.0; BINS];
    for u in pit {
        let bin = ((u * BINS as f64) as usize).min(BINS - 1);
        shares[bin] += 1.0 / pit.len() as f64;
    }
    shares
}

/// Wilson's 95 % score interval of a share, `inside` of `n` (Wilson 1927): closed, never empty at 0 or 1, and right
/// on average where the exact one of Clopper and Pearson is too wide.
fn wilson(inside: usize, n: usize) -> (f64, f64) {
    let (share, n) = (inside as f64 / n as f64, n as f64);
    let widen = 1.0 + Z * Z / n;
    let centre = (share + 0.5 * Z * Z / n) / widen;
    let half = Z / widen * (share * (1.0 - share) / n + 0.25 * (Z / n).powi(2)).sqrt();
    ((centre - half).max(0.0), (centre + half).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_is_wilson() {
        // Newcombe 1998 (Statistics in Medicine 17, 857), Table I, method 3, four decimals.
        for (inside, n, low, high) in [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0, 0.1611),
            (1, 29, 0.0061, 0.1718),
        ] {
            let found = wilson(inside, n);
            assert!((found.0 - low).abs() < 6e-5 && (found.1 - high).abs() < 6e-5);
        }
        assert!(wilson(72, 72).0 < CLAIM && wilson(73, 73).0 > CLAIM);
        assert!((wilson(5, 5).1 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_area_is_the_integral() {
        let pit = [0.02, 0.3, 0.31, 0.9, 0.97];
        let count = 100_000;
        let sum: f64 = (0..count)
            .map(|i| {
                let claim = (f64::from(i) + 0.5) / f64::from(count);
                (CoveragePoint::at(claim, &pit).held - claim).abs()
            })
            .sum();
        assert!((area(&pit) - sum / f64::from(count)).abs() < 1e-5);
        // Never right, and always sure of it.
        assert!((area(&[1.0; 9]) - 0.5).abs() < 1e-12);
        assert!((area(&[0.0; 9]) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn every_value_falls_into_a_bin() {
        let shares = histogram(&[0.0, 0.05, 0.1, 0.999, 1.0]);
        assert!((shares[0] - 0.4).abs() < 1e-12 && (shares[9] - 0.4).abs() < 1e-12);
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
