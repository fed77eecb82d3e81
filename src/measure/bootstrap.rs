//! Percentile bootstrap of a mean: how sure a difference over episodes is.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// A mean with a two-sided interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The mean.
    pub mean: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Resamples that an interval is read from.
const RESAMPLES: usize = 2000;

/// The mean of `values` with its 95 % percentile bootstrap interval; the same seed gives the same interval.
/// None for no values.
pub fn mean_95(values: &[f64], seed: u64) -> Option<Interval> {
    if values.is_empty() {
        return None;
    }
    let mean_of = |sum: f64| sum / values.len() as f64;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut means: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            mean_of(
                (0..values.len())
                    .map(|_| values[rng.random_range(0..values.len())])
                    .sum(),
            )
        })
        .collect();
    means.sort_by(f64::total_cmp);
    let at = |part: f64| means[(part * (RESAMPLES - 1) as f64).round() as usize];
    Some(Interval {
        mean: mean_of(values.iter().sum()),
        low: at(0.025),
        high: at(0.975),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_covers_the_mean_as_the_normal_law_says() {
        let values: Vec<f64> = (0..400).map(|i| f64::from(i % 20)).collect();
        let interval = mean_95(&values, 1).expect("values");
        let half = 1.96 * (133.0_f64 / 4.0).sqrt() / 20.0;
        assert!((interval.mean - 9.5).abs() < 1e-12);
        assert!((interval.high - interval.mean - half).abs() < 0.1 * half);
        assert!((interval.mean - interval.low - half).abs() < 0.1 * half);
        assert_eq!(mean_95(&values, 1), mean_95(&values, 1));
        assert_eq!(mean_95(&[], 1), None);
    }
}
