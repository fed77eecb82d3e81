//! How much each expert supplies of a belief's precision (D1).
//!
//! With precisions `T_i = 1 / variance_i` and tempering `α_i`, the product has `T* = Σ α_i T_i`, and expert i's
//! share in dimension d is `s_{i,d} = α_i T_{i,d} / T*_d`. The shares of a dimension add up to one.

use super::gaussian::Factor;

/// The precision share of each expert in each latent dimension: one row of Z an expert, each value in [0, 1].
///
/// A dimension in which no expert is active has shares of zero.
pub fn precision_shares(factors: &[Factor]) -> Vec<Vec<f32>> {
    let sizes = factors.iter().map(|factor| factor.gaussian.log_var.len());
    let latent = sizes.min().unwrap_or(0);
    let mut shares: Vec<Vec<f32>> = factors.iter().map(|_| vec![0.0; latent]).collect();
    for d in 0..latent {
        let precision = |factor: &Factor| {
            let log_var = f64::from(factor.gaussian.log_var[d]);
            f64::from(factor.alpha) * (-log_var).exp()
        };
        let precisions: Vec<f64> = factors.iter().map(precision).collect();
        let total: f64 = precisions.iter().sum();
        if total > 0.0 {
            for (share, precision) in shares.iter_mut().zip(precisions) {
                share[d] = (precision / total) as f32;
            }
        }
    }
    shares
}

/// The plain mean over dimensions; zero for an empty latent.
pub fn mean_share(shares: &[f32]) -> f32 {
    shares.iter().sum::<f32>() / shares.len().max(1) as f32
}

/// Each expert's share weighted by what moves the position estimate, the mean of both axes:
/// `S^(k) = Σ_d W_kd² Σ*_d s_d / Σ_d W_kd² Σ*_d`.
///
/// `weights` is the probe's W, `(2, Z)` row major; `variance` the belief's Σ*. None where the probe reads nothing
/// along an axis or the sizes do not fit.
pub fn position_shares(shares: &[Vec<f32>], weights: &[f32], variance: &[f32]) -> Option<Vec<f32>> {
    let latent = variance.len();
    if latent == 0 || weights.len() != 2 * latent || shares.iter().any(|s| s.len() != latent) {
        return None;
    }
    let mut means = vec![0.0; shares.len()];
    for axis in weights.chunks_exact(latent) {
        let spread: Vec<f32> = axis.iter().zip(variance).map(|(w, v)| w * w * v).collect();
        let total: f32 = spread.iter().sum();
        if !total.is_normal() {
            return None;
        }
        for (mean, share) in means.iter_mut().zip(shares) {
            let weighted: f32 = spread.iter().zip(share).map(|(w, s)| w * s).sum();
            *mean += 0.5 * weighted / total;
        }
    }
    Some(means)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use proptest::prelude::*;

    use super::super::gaussian::Gaussian;
    use super::*;

    fn factor(log_var: &[f32], alpha: f32) -> Factor<'_> {
        let mean = log_var;
        Factor {
            gaussian: Gaussian { mean, log_var },
            alpha,
        }
    }

    #[test]
    fn a_twice_as_precise_expert_supplies_two_thirds() {
        let shares = precision_shares(&[factor(&[0.0], 1.0), factor(&[-(2.0_f32.ln())], 1.0)]);
        assert!((shares[0][0] - 1.0 / 3.0).abs() < 1e-6);
        assert!((shares[1][0] - 2.0 / 3.0).abs() < 1e-6);
    }

    #[test]
    fn no_active_expert_supplies_nothing() {
        assert_eq!(
            precision_shares(&[factor(&[1.0, 2.0], 0.0)]),
            [vec![0.0, 0.0]]
        );
    }

    #[test]
    fn the_position_share_looks_only_where_the_probe_does() {
        let shares = [vec![0.9, 0.2, 0.0], vec![0.1, 0.8, 1.0]];
        let weights = [1.0, 0.0, 0.0, 0.0, 3.0, 0.0];
        let means = position_shares(&shares, &weights, &[0.5, 0.1, 7.0]).unwrap();
        assert!((means[0] - 0.55).abs() < 1e-6);
        assert!((means[1] - 0.45).abs() < 1e-6);
        assert_eq!(position_shares(&shares, &[0.0; 6], &[0.5, 0.1, 7.0]), None);
    }

    proptest! {
        #[test]
        fn shares_add_up_to_one(
            alphas in prop::collection::vec(prop_oneof![Just(0.0_f32), 0.01_f32..3.0], 3)
                .prop_filter("one is on", |alphas| alphas.iter().any(|&a| a > 0.0)),
            log_vars in prop::collection::vec(prop::collection::vec(-8.0_f32..8.0, 4), 3),
        ) {
            let factors: Vec<Factor> = log_vars
                .iter()
                .zip(alphas)
                .map(|(log_var, alpha)| factor(log_var, alpha))
                .collect();
            let shares = precision_shares(&factors);
            for d in 0..4 {
                let sum: f32 = shares.iter().map(|s| s[d]).sum();
                prop_assert!((sum - 1.0).abs() < 1e-5);
            }
        }
    }
}
