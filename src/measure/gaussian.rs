//! Diagonal Gaussians over the latent as borrowed slices, and their product: what the diagnostics of a fusion take.
//!
//! An expert with tempering α counts as the Gaussian `N(μ, Σ/α)`: α = 0 is off, α = 1 as trained.

use serde::Serialize;

/// A diagonal Gaussian over the latent, Z numbers each.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gaussian<'a> {
    /// Mean.
    pub mean: &'a [f32],
    /// Logarithm of the variance.
    pub log_var: &'a [f32],
}

impl Gaussian<'_> {
    /// Whether it has `latent` dimensions, at least one, all of them finite.
    pub fn fits(&self, latent: usize) -> bool {
        latent > 0
            && self.mean.len() == latent
            && self.log_var.len() == latent
            && self.mean.iter().chain(self.log_var).all(|x| x.is_finite())
    }
}

/// One expert of a product.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Factor<'a> {
    /// What it says.
    pub gaussian: Gaussian<'a>,
    /// α, at least 0; 0 is off and what it says is not looked at.
    pub alpha: f32,
}

impl Factor<'_> {
    /// Whether it takes part.
    pub fn is_on(&self) -> bool {
        self.alpha > 0.0
    }

    /// Whether the χ² laws hold for it: tempering changes what it claims, so there α is 0 or 1.
    pub fn is_as_trained(&self) -> bool {
        [0.0, 1.0].contains(&self.alpha)
    }

    /// `α T_d`, the precision it brings into dimension d.
    pub(super) fn precision(&self, d: usize) -> f64 {
        f64::from(self.alpha) * (-f64::from(self.gaussian.log_var[d])).exp()
    }

    /// Σ_d/α, the variance it counts with in dimension d.
    pub(super) fn variance(&self, d: usize) -> f64 {
        f64::from(self.gaussian.log_var[d]).exp() / f64::from(self.alpha)
    }
}

/// A product of experts, Z numbers each.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Product {
    /// Mean.
    pub mean: Vec<f32>,
    /// Logarithm of the variance.
    pub log_var: Vec<f32>,
}

impl Product {
    /// The same, borrowed.
    pub fn gaussian(&self) -> Gaussian<'_> {
        Gaussian {
            mean: &self.mean,
            log_var: &self.log_var,
        }
    }
}

/// The product of the active factors: `T* = Σ αᵢTᵢ`, `μ* = Σ* Σ αᵢTᵢμᵢ`.
///
/// None where no factor is on, an α is negative or not a number, or those that are on differ in size or are not
/// finite.
pub fn product(factors: &[Factor]) -> Option<Product> {
    let moments = moments(factors)?;
    Some(Product {
        mean: moments.mean.iter().map(|&m| m as f32).collect(),
        log_var: moments.precision.iter().map(|t| -t.ln() as f32).collect(),
    })
}

/// The same in double precision, for what is computed from it.
pub(super) struct Moments {
    /// μ*.
    pub mean: Vec<f64>,
    /// T*, positive and finite.
    pub precision: Vec<f64>,
}

/// [`product`] before rounding; none for the same inputs.
pub(super) fn moments(factors: &[Factor]) -> Option<Moments> {
    let latent = latent(factors)?;
    let mut product = Moments {
        mean: Vec::with_capacity(latent),
        precision: Vec::with_capacity(latent),
    };
    for d in 0..latent {
        let (mut total, mut weighted) = (0.0, 0.0);
        for factor in factors.iter().filter(|factor| factor.is_on()) {
            let precision = factor.precision(d);
            total += precision;
            weighted += precision * f64::from(factor.gaussian.mean[d]);
        }
        let mean = weighted / total;
        if !(total > 0.0 && total.is_finite() && mean.is_finite()) {
            return None;
        }
        product.precision.push(total);
        product.mean.push(mean);
    }
    Some(product)
}

/// Z of the factors that are on; none where [`product`] is none for their shape or values.
pub(super) fn latent(factors: &[Factor]) -> Option<usize> {
    let sound = |f: &Factor| f.alpha >= 0.0 && f.alpha.is_finite();
    let first = factors.iter().find(|factor| factor.is_on())?;
    let latent = first.gaussian.mean.len();
    let fit = |f: &Factor| !f.is_on() || f.gaussian.fits(latent);
    factors
        .iter()
        .all(|factor| sound(factor) && fit(factor))
        .then_some(latent)
}

/// Made-up experts for the property tests of this folder.
#[cfg(test)]
pub(super) mod made_up {
    use proptest::prelude::*;

    use super::*;

    /// An expert and its α.
    pub type Expert = (Product, f32);

    /// `count` experts over `latent` dimensions: off, as trained or tempered, at least one of them on.
    pub fn experts(count: usize, latent: usize) -> impl Strategy<Value = Vec<Expert>> {
        let alpha = prop_oneof![Just(0.0_f32), Just(1.0), 0.05_f32..3.0];
        prop::collection::vec((gaussian(latent), alpha), count)
            .prop_filter("one is on", |experts| experts.iter().any(|e| e.1 > 0.0))
    }

    /// One Gaussian.
    pub fn gaussian(latent: usize) -> impl Strategy<Value = Product> {
        let mean = prop::collection::vec(-3.0_f32..3.0, latent);
        let log_var = prop::collection::vec(-4.0_f32..3.0, latent);
        (mean, log_var).prop_map(|(mean, log_var)| Product { mean, log_var })
    }

    /// The same as factors.
    pub fn factors(experts: &[Expert]) -> Vec<Factor<'_>> {
        experts
            .iter()
            .map(|(gaussian, alpha)| Factor {
                gaussian: gaussian.gaussian(),
                alpha: *alpha,
            })
            .collect()
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn factor<'a>(mean: &'a [f32], log_var: &'a [f32], alpha: f32) -> Factor<'a> {
        Factor {
            gaussian: Gaussian { mean, log_var },
            alpha,
        }
    }

    #[test]
    fn precisions_add_and_means_are_weighted_by_them() {
        // Precisions 1 and 3 (tempered to 1.5): 2.5 in all, mean (0 + 1.5 · 5) / 2.5.
        let three = [-(3.0_f32.ln())];
        let both = product(&[factor(&[0.0], &[0.0], 1.0), factor(&[5.0], &three, 0.5)]).unwrap();
        assert!((both.mean[0] - 3.0).abs() < 1e-6);
        assert!((both.log_var[0] + 2.5_f32.ln()).abs() < 1e-6);
    }

    #[test]
    fn what_cannot_be_multiplied_has_no_product() {
        let one = factor(&[0.0], &[0.0], 1.0);
        assert_eq!(product(&[]), None);
        assert_eq!(product(&[factor(&[0.0], &[0.0], 0.0)]), None);
        assert_eq!(product(&[one, factor(&[0.0, 1.0], &[0.0, 1.0], 1.0)]), None);
        assert_eq!(product(&[one, factor(&[0.0], &[], 1.0)]), None);
        assert_eq!(product(&[one, factor(&[f32::NAN], &[0.0], 1.0)]), None);
        assert_eq!(product(&[one, factor(&[0.0], &[0.0], f32::NAN)]), None);
        assert_eq!(product(&[one, factor(&[0.0], &[0.0], -1.0)]), None);
        assert_eq!(product(&[factor(&[], &[], 1.0)]), None);
        assert_eq!(product(&[factor(&[0.0], &[f32::MAX], 1.0)]), None);
        assert_eq!(product(&[factor(&[0.0], &[f32::MIN], 1.0)]), None);
    }

    #[test]
    fn an_expert_that_is_off_is_not_looked_at() {
        let one = factor(&[2.0], &[1.0], 1.0);
        let alone = product(&[one]).unwrap();
        assert_eq!(product(&[one, factor(&[f32::NAN], &[], 0.0)]), Some(alone));
    }

    proptest! {
        #[test]
        fn order_does_not_matter(experts in made_up::experts(3, 4)) {
            let mut factors = made_up::factors(&experts);
            let forth = product(&factors).unwrap();
            factors.reverse();
            let back = product(&factors).unwrap();
            for d in 0..4 {
                prop_assert!((forth.mean[d] - back.mean[d]).abs() < 1e-5);
                prop_assert!((forth.log_var[d] - back.log_var[d]).abs() < 1e-5);
            }
        }
    }
}
