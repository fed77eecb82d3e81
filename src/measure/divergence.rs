//! How far two Gaussians are apart, in two parts that mean different things (D2, D3, D4).
//!
//! Surprise is `kl_parts(q*, p₀)`, fused against expert `kl_parts(q*, q̃ᵢ)`, expert against prior `kl_parts(q̃ᵢ, p₀)`.

use serde::Serialize;

use super::gaussian::Gaussian;

/// The KL divergence KL(q ‖ p) in nats, summed over the latent. A large mean term says that p was overruled, a
/// large spread term that one of the two is merely vaguer; the sum alone tells neither.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct KlParts {
    /// `½ Σ_d (μ_q − μ_p)² / v_p`.
    pub mean: f32,
    /// `½ Σ_d [v_q/v_p − 1 + ln(v_p/v_q)]`.
    pub spread: f32,
}

impl KlParts {
    /// KL(q ‖ p), the sum of both parts.
    pub fn total(self) -> f32 {
        self.mean + self.spread
    }
}

/// KL(q ‖ p) of two diagonal Gaussians of Z dimensions, by part. Both parts are NaN where the sizes differ or a
/// number is not finite; zero for an empty latent.
pub fn kl_parts(q: Gaussian, p: Gaussian) -> KlParts {
    let latent = q.mean.len();
    if latent > 0 && !(q.fits(latent) && p.fits(latent)) || p.mean.len() != latent {
        return KlParts {
            mean: f32::NAN,
            spread: f32::NAN,
        };
    }
    let (mut mean, mut spread) = (0.0, 0.0);
    for d in 0..latent {
        let apart = f64::from(q.mean[d]) - f64::from(p.mean[d]);
        let log_ratio = f64::from(q.log_var[d]) - f64::from(p.log_var[d]);
        mean += 0.5 * apart * apart * (-f64::from(p.log_var[d])).exp();
        // exp(x) − 1 − x is at least 0; rounding near x = 0 is not.
        spread += 0.5 * (log_ratio.exp_m1() - log_ratio).max(0.0);
    }
    KlParts {
        mean: mean as f32,
        spread: spread as f32,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::gaussian::made_up;
    use super::*;

    #[test]
    fn a_known_divergence() {
        // KL(N(1, 1) ‖ N(0, 4)) = ½ (¼ + ¼ − 1 + ln 4).
        let parts = kl_parts(
            Gaussian {
                mean: &[1.0],
                log_var: &[0.0],
            },
            Gaussian {
                mean: &[0.0],
                log_var: &[4.0_f32.ln()],
            },
        );
        assert!((parts.mean - 0.125).abs() < 1e-6);
        assert!((parts.spread - 0.318_147).abs() < 1e-6);
        assert!((parts.total() - 0.443_147).abs() < 1e-6);
    }

    #[test]
    fn what_does_not_fit_has_no_divergence() {
        let one = Gaussian {
            mean: &[1.0],
            log_var: &[0.0],
        };
        let none = Gaussian {
            mean: &[],
            log_var: &[],
        };
        let ragged = Gaussian {
            mean: &[1.0],
            log_var: &[],
        };
        let sick = Gaussian {
            mean: &[f32::NAN],
            log_var: &[0.0],
        };
        for (q, p) in [(one, none), (none, one), (one, ragged), (sick, one)] {
            assert!(kl_parts(q, p).total().is_nan());
        }
        assert_eq!(kl_parts(none, none), KlParts::default());
    }

    proptest! {
        #[test]
        fn parts_add_up_to_the_closed_form(q in made_up::gaussian(4), p in made_up::gaussian(4)) {
            let parts = kl_parts(q.gaussian(), p.gaussian());
            // ½ [tr(Σp⁻¹Σq) + Δᵀ Σp⁻¹ Δ − Z + ln det Σp − ln det Σq]
            let mut closed = -4.0;
            for d in 0..4 {
                let (vq, vp) = (f64::from(q.log_var[d]).exp(), f64::from(p.log_var[d]).exp());
                let apart = f64::from(q.mean[d] - p.mean[d]);
                closed += vq / vp + apart * apart / vp + vp.ln() - vq.ln();
            }
            let total = f64::from(parts.total());
            prop_assert!((total - 0.5 * closed).abs() < 1e-4 * (1.0 + total), "{total} {closed}");
            prop_assert!(parts.mean >= 0.0 && parts.spread >= 0.0);
            prop_assert_eq!(kl_parts(q.gaussian(), q.gaussian()), KlParts::default());
        }
    }
}
