//! Which latents carry the position, and how surely (D18).
//!
//! Latents are correlated over data, so the linear split is shown beside a permutation check.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::active::LatentStats;
use super::gaussian::Gaussian;

/// A position estimate split over the latents, for x and for y.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Attribution {
    /// `c_{kd} = W_{kd} (μ*_d − μ̄_d)` in metres, Z each; an axis adds up to how far its estimate is from that of
    /// the mean latent.
    pub contribution_m: [Vec<f32>; 2],
    /// `W_{kd}² Σ*_d / (W Σ* Wᵀ)_{kk}`, Z each; an axis adds up to one.
    pub variance_part: [Vec<f32>; 2],
}

/// Splits the position of the belief `N(mean, exp(log_var))`; `weights` is the probe's W, `(2, Z)` row major, and
/// `stats` the mean latent over data.
///
/// None where the sizes do not fit, a number is not finite, no data was seen, or the probe reads nothing along an
/// axis.
pub fn attribution(
    weights: &[f32],
    mean: &[f32],
    log_var: &[f32],
    stats: &LatentStats,
) -> Option<Attribution> {
    let latent = mean.len();
    let seen = stats.count > 0 && stats.mean.len() == latent;
    let finite = weights.iter().chain(&stats.mean).all(|x| x.is_finite());
    if !(Gaussian { mean, log_var }.fits(latent) && weights.len() == 2 * latent && seen && finite) {
        return None;
    }
    let (x, y) = weights.split_at(latent);
    let contribution = |axis: &[f32]| -> Vec<f32> {
        let terms = axis.iter().zip(mean).zip(&stats.mean);
        terms
            .map(|((&w, &m), &typical)| (f64::from(w) * (f64::from(m) - f64::from(typical))) as f32)
            .collect()
    };
    Some(Attribution {
        contribution_m: [contribution(x), contribution(y)],
        variance_part: [variance_part(x, log_var)?, variance_part(y, log_var)?],
    })
}

fn variance_part(axis: &[f32], log_var: &[f32]) -> Option<Vec<f32>> {
    let spread: Vec<f64> = axis
        .iter()
        .zip(log_var)
        .map(|(&w, &log_var)| f64::from(w).powi(2) * f64::from(log_var).exp())
        .collect();
    let total: f64 = spread.iter().sum();
    total
        .is_normal()
        .then(|| spread.iter().map(|s| (s / total) as f32).collect())
}

/// Permutations that an importance is the mean of.
const PERMUTATIONS: usize = 8;

/// By how much the position's root-mean-square error rises, in metres, when latent d is permuted over the data:
/// one number a latent, near zero where the estimate does not need it.
///
/// `weights` is the probe's W, `(2, Z)` row major, and `bias` its b; a belief is its mean `μ*` (Z) and the true
/// position in metres. All latents see the same permutations, and the same seed gives the same numbers. Empty
/// where there is no belief, the sizes do not fit or a number is not finite.
pub fn permutation_importance(
    weights: &[f32],
    bias: [f32; 2],
    beliefs: &[(Vec<f32>, [f32; 2])],
    seed: u64,
) -> Vec<f64> {
    let latent = weights.len() / 2;
    let finite = |values: &[f32]| values.iter().all(|x| x.is_finite());
    let fits = beliefs
        .iter()
        .all(|(mean, truth)| mean.len() == latent && finite(mean) && finite(truth));
    if beliefs.is_empty()
        || weights.len() != 2 * latent
        || !fits
        || !finite(weights)
        || !finite(&bias)
    {
        return Vec::new();
    }
    let (x, y) = weights.split_at(latent);
    let errors: Vec<[f64; 2]> = beliefs
        .iter()
        .map(|(mean, truth)| {
            [(x, 0), (y, 1)].map(|(axis, k)| {
                let read: f64 = axis
                    .iter()
                    .zip(mean)
                    .map(|(&w, &m)| f64::from(w) * f64::from(m))
                    .sum();
                f64::from(truth[k]) - f64::from(bias[k]) - read
            })
        })
        .collect();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let orders: Vec<Vec<usize>> = (0..PERMUTATIONS)
        .map(|_| {
            let mut order: Vec<usize> = (0..beliefs.len()).collect();
            order.shuffle(&mut rng);
            order
        })
        .collect();
    let intact = rms(errors.iter().copied());
    (0..latent)
        .map(|d| {
            // The estimate is linear, so a permuted latent only moves each error by its own change.
            let permuted = orders.iter().map(|order| {
                rms(errors
                    .iter()
                    .zip(order)
                    .enumerate()
                    .map(|(n, (error, &other))| {
                        let change = f64::from(beliefs[other].0[d]) - f64::from(beliefs[n].0[d]);
                        [
                            error[0] - f64::from(x[d]) * change,
                            error[1] - f64::from(y[d]) * change,
                        ]
                    }))
            });
            permuted.sum::<f64>() / PERMUTATIONS as f64 - intact
        })
        .collect()
}

/// Root of the mean squared length; zero for none.
fn rms(errors: impl ExactSizeIterator<Item = [f64; 2]>) -> f64 {
    let count = errors.len().max(1) as f64;
    (errors.map(|[x, y]| x * x + y * y).sum::<f64>() / count).sqrt()
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use rand::Rng;

    use super::*;

    fn stats(mean: &[f32]) -> LatentStats {
        let mut stats = LatentStats::default();
        assert!(stats.push(mean));
        stats
    }

    #[test]
    fn contributions_and_parts_add_up() {
        let (weights, mean) = ([0.5, -1.0, 0.0, 0.25, 0.0, 2.0], [1.0, 2.0, 3.0]);
        let log_var = [0.0, 2.0_f32.ln(), -1.0];
        let split = attribution(&weights, &mean, &log_var, &stats(&[0.0, 1.0, 3.5])).unwrap();
        assert_eq!(
            split.contribution_m,
            [vec![0.5, -1.0, 0.0], vec![0.25, 0.0, -1.0]]
        );
        // x reads variances ¼ · 1 and 1 · 2.
        assert!((split.variance_part[0][0] - 0.25 / 2.25).abs() < 1e-6);
        for part in split.variance_part {
            assert!((part.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn what_does_not_fit_is_not_split() {
        let known = stats(&[0.0]);
        assert!(attribution(&[1.0, 1.0], &[1.0], &[0.0], &known).is_some());
        assert_eq!(attribution(&[1.0], &[1.0], &[0.0], &known), None);
        assert_eq!(attribution(&[], &[], &[], &LatentStats::default()), None);
        assert_eq!(
            attribution(&[1.0, 1.0], &[1.0], &[0.0], &LatentStats::default()),
            None
        );
        assert_eq!(attribution(&[1.0, 0.0], &[1.0], &[0.0], &known), None);
        assert_eq!(attribution(&[1.0, 1.0], &[f32::NAN], &[0.0], &known), None);
        assert_eq!(attribution(&[1.0, f32::NAN], &[1.0], &[0.0], &known), None);
    }

    #[test]
    fn only_what_the_probe_reads_is_important() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let beliefs: Vec<(Vec<f32>, [f32; 2])> = (0..4000)
            .map(|_| {
                let mean: Vec<f32> = (0..2).map(|_| rng.random_range(-1.0..1.0)).collect();
                let truth = [0.1 + 0.3 * mean[0], -0.2 + 0.4 * mean[0]];
                (mean, truth)
            })
            .collect();
        let weights = [0.3, 0.0, 0.4, 0.0];
        let rise = permutation_importance(&weights, [0.1, -0.2], &beliefs, 7);
        // A perfect probe: the error of a permuted latent is 0.5 (z − z'), whose variance is twice that of z, 1/3.
        assert!(
            (rise[0] - 0.5 * (2.0_f64 / 3.0).sqrt()).abs() < 0.01,
            "{rise:?}"
        );
        assert!(rise[1].abs() < 1e-12);
        assert_eq!(
            rise,
            permutation_importance(&weights, [0.1, -0.2], &beliefs, 7)
        );
        assert_ne!(
            rise,
            permutation_importance(&weights, [0.1, -0.2], &beliefs, 8)
        );
    }

    #[test]
    fn without_fitting_data_nothing_is_important() {
        let belief = [(vec![1.0], [0.0, 0.0])];
        let rise =
            |weights: &[f32], bias, beliefs| permutation_importance(weights, bias, beliefs, 0);
        assert_eq!(rise(&[1.0, 1.0], [0.0; 2], &belief).len(), 1);
        assert_eq!(rise(&[1.0, 1.0], [0.0; 2], &[]), [0.0; 0]);
        assert_eq!(rise(&[1.0; 3], [0.0; 2], &belief), [0.0; 0]);
        assert_eq!(rise(&[1.0; 4], [0.0; 2], &belief), [0.0; 0]);
        assert_eq!(rise(&[1.0, 1.0], [f32::NAN, 0.0], &belief), [0.0; 0]);
    }
}
