//! What one expert adds to a product, seen by leaving it out (D5, D6).
//!
//! This is scope "frame": in a filter the experts of later frames would also meet another prior.

use serde::Serialize;

use super::gaussian::{self, Factor};
use super::position;

/// The product without one expert, and how far the full one is from it. "−i" means without expert i.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Without {
    /// `μ_{−i}`, Z.
    pub mean: Vec<f32>,
    /// Logarithm of the variance `Σ_{−i}`, Z.
    pub log_var: Vec<f32>,
    /// `ΔHᵢ = ½ Σ_d ln(T*_d / T_{−i,d})` in nats: the entropy that adding the expert last removes (D5).
    pub information_nats: f32,
    /// `M = sqrt((μ* − μ_{−i})ᵀ Σ_{−i}⁻¹ (μ* − μ_{−i}))` (D6), in standard deviations of the belief without it.
    pub mahalanobis: f32,
    /// `W₂ = sqrt(‖μ* − μ_{−i}‖² + ‖σ* − σ_{−i}‖²)` (D6), in units of the latent.
    pub wasserstein: f32,
    /// `W (μ* − μ_{−i})` in metres (D6): from the position without the expert to the one with it. None without a
    /// probe.
    pub shift_m: Option<[f32; 2]>,
}

/// The product of `factors` without expert `leave_out`; `weights` is the probe's W, `(2, Z)` row major.
///
/// The rest is multiplied anew: to subtract `αᵢTᵢ` from T* would lose what a vague rest says beside a sharp expert.
/// None where the expert is off or the only one on, or the product has none.
pub fn without(factors: &[Factor], leave_out: usize, weights: Option<&[f32]>) -> Option<Without> {
    if !factors.get(leave_out)?.is_on() {
        return None;
    }
    let full = gaussian::moments(factors)?;
    let mut others = factors.to_vec();
    others.remove(leave_out);
    let rest = gaussian::moments(&others)?;

    let shift: Vec<f64> = full
        .mean
        .iter()
        .zip(&rest.mean)
        .map(|(a, b)| a - b)
        .collect();
    let (mut information, mut mahalanobis, mut wasserstein) = (0.0, 0.0, 0.0);
    for ((full, rest), shift) in full.precision.iter().zip(&rest.precision).zip(&shift) {
        information += 0.5 * (full / rest).ln();
        mahalanobis += shift * shift * rest;
        let narrowed = full.sqrt().recip() - rest.sqrt().recip();
        wasserstein += shift * shift + narrowed * narrowed;
    }
    Some(Without {
        mean: rest.mean.iter().map(|&m| m as f32).collect(),
        log_var: rest.precision.iter().map(|t| -t.ln() as f32).collect(),
        information_nats: information as f32,
        mahalanobis: mahalanobis.sqrt() as f32,
        wasserstein: wasserstein.sqrt() as f32,
        shift_m: weights
            .and_then(|weights| position::moved(weights, &shift))
            .map(|[x, y]| [x as f32, y as f32]),
    })
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use proptest::prelude::*;

    use super::super::gaussian::{Gaussian, made_up, product};
    use super::*;

    fn unit(mean: &[f32], alpha: f32) -> Factor<'_> {
        let gaussian = Gaussian {
            mean,
            log_var: &[0.0],
        };
        Factor { gaussian, alpha }
    }

    #[test]
    fn two_equal_experts_apart() {
        let factors = [unit(&[0.0], 1.0), unit(&[4.0], 1.0)];
        let left = without(&factors, 1, Some(&[0.5, -1.0])).unwrap();
        assert_eq!((left.mean[0], left.log_var[0]), (0.0, 0.0));
        assert!((left.information_nats - 0.5 * 2.0_f32.ln()).abs() < 1e-6);
        assert!((left.mahalanobis - 2.0).abs() < 1e-6);
        // σ falls from 1 to √½.
        let narrowed = 1.0 - 0.5_f32.sqrt();
        assert!((left.wasserstein - (4.0 + narrowed * narrowed).sqrt()).abs() < 1e-6);
        assert_eq!(left.shift_m, Some([1.0, -2.0]));
        assert_eq!(without(&factors, 1, None).unwrap().shift_m, None);
        assert_eq!(without(&factors, 1, Some(&[1.0])).unwrap().shift_m, None);
    }

    #[test]
    fn nothing_is_left_without_the_only_one() {
        let factors = [unit(&[0.0], 1.0), unit(&[4.0], 0.0)];
        assert_eq!(without(&factors, 0, None), None);
        assert_eq!(without(&factors, 1, None), None);
        assert_eq!(without(&factors, 2, None), None);
        assert_eq!(without(&[], 0, None), None);
    }

    proptest! {
        #[test]
        fn it_is_the_product_with_that_expert_off(experts in made_up::experts(4, 3)) {
            let mut factors = made_up::factors(&experts);
            let entropy = |log_var: &[f32]| 0.5 * log_var.iter().copied().map(f64::from).sum::<f64>();
            let full = product(&factors).unwrap();
            for i in 0..factors.len() {
                let left = without(&factors, i, None);
                let alpha = std::mem::replace(&mut factors[i].alpha, 0.0);
                let rest = product(&factors);
                factors[i].alpha = alpha;
                if alpha == 0.0 {
                    prop_assert_eq!(left, None);
                    continue;
                }
                prop_assert_eq!(left.is_some(), rest.is_some());
                let (Some(left), Some(rest)) = (left, rest) else { continue };
                prop_assert_eq!((&left.mean, &left.log_var), (&rest.mean, &rest.log_var));
                let removed = entropy(&rest.log_var) - entropy(&full.log_var);
                prop_assert!((f64::from(left.information_nats) - removed).abs() < 1e-4);
                prop_assert!(left.information_nats >= 0.0);
            }
        }
    }
}
