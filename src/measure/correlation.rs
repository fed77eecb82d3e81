//! Experts that err together (D14), and what that does to the confidence of their product.
//!
//! A product adds precisions as if its experts erred independently. With n experts of one precision Tₑ whose errors
//! correlate by ρ it claims the variance `1 / (n Tₑ)` and has `1 + (n − 1) ρ` times that; an honest prior of precision
//! T₀ beside them dilutes this to `(T₀ + n Tₑ (1 + (n − 1) ρ)) / (T₀ + n Tₑ)`, which for ρ = 1 is
//! `(T₀ + n² Tₑ) / (T₀ + n Tₑ)`.
//!
//! These hold for one product with a prior whose error variance V₀ is the `1 / T₀` it states. A filter with a fixed
//! head does not keep it so: it carries the excess error of each step into the next prior, and the ratio becomes
//! `(T₀² V₀ + n Tₑ (1 + (n − 1) ρ)) / (T₀ + n Tₑ)`. In the tests three copies come out at 1.98 after thirty steps where
//! the formula says 1.75. With the prior off nothing is carried.
//!
//! The ratio is that of the latent part `W Σ Wᵀ`: a probe residual in the covariance dilutes it in the NEES.

use serde::Serialize;

/// Fewer episodes than this have no correlation worth a number.
const FEWEST: usize = 3;
/// Fewer episodes than this are named as few in the sentence.
const FEW: usize = 20;
/// An inflation that rounding took to zero or below would make infinitely many effective experts.
const LEAST_INFLATION: f64 = 1e-6;

/// So far beyond ±1 a correlation may come by rounding.
const ROUNDING: f64 = 1e-6;

/// How two experts' position errors go together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Correlation {
    /// Index of one expert.
    pub a: usize,
    /// Index of the other, larger than `a`.
    pub b: usize,
    /// ρ, the mean over both axes of the correlation of their errors, −1 to 1.
    pub rho: f64,
}

/// How far a set of experts is from independent (D14).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dependence {
    /// All pairs, in order.
    pub pairs: Vec<Correlation>,
    /// Mean of the pairs' ρ.
    pub mean_rho: f64,
    /// n, the experts.
    pub experts: usize,
    /// Episodes counted: those where every error is finite.
    pub episodes: usize,
    /// `n_eff = n / (1 + (n − 1) ρ)`, the independent experts they are worth.
    pub effective: f64,
    /// `1 + (n − 1) ρ`: how many times too small the product's claimed variance is, with the prior off.
    pub inflation: f64,
    /// The same beside an honest prior; none until [`Dependence::beside_prior`] is told the precisions.
    pub with_prior: Option<f64>,
    /// In words.
    pub sentence: String,
}

impl Dependence {
    /// Adds what the same experts do to a product with an honest prior; precisions in any one unit. Left out where
    /// they are negative, not finite or both zero.
    #[must_use]
    pub fn beside_prior(self, prior_precision: f64, expert_precision: f64) -> Self {
        let inflation = inflation(
            prior_precision,
            expert_precision,
            self.experts,
            self.mean_rho,
        );
        Self {
            with_prior: inflation.is_finite().then_some(inflation),
            ..self
        }
    }
}

/// Correlation of single-expert position errors: `errors[i]` holds expert i's, metres, one an episode, the same
/// episodes in the same order for all.
///
/// None for fewer than two experts, lists of different length, fewer than three episodes with finite errors, or an
/// expert that always errs alike. All experts are read through one probe, whose own residual they share: where R_p is
/// not small beside their spread, take [`dependence_beyond`].
pub fn dependence(errors: &[Vec<[f32; 2]>]) -> Option<Dependence> {
    dependence_beyond(errors, [0.0; 3])
}

/// [`dependence`] of what the errors have beyond the probe's `residual` R_p (xx, xy, yy in square metres), which is
/// taken off every variance and covariance. None also where an expert's variance along an axis is not above R_p's, or
/// where R_p takes off so much that what is left is no correlation: a ρ beyond ±1, or so negative that n experts cannot
/// have it among them.
pub fn dependence_beyond(errors: &[Vec<[f32; 2]>], residual: [f32; 3]) -> Option<Dependence> {
    let experts = errors.len();
    let length = errors.first()?.len();
    if experts < 2 || errors.iter().any(|list| list.len() != length) {
        return None;
    }
    let whole: Vec<usize> = (0..length)
        .filter(|&i| errors.iter().all(|e| e[i].iter().all(|x| x.is_finite())))
        .collect();
    let episodes = whole.len();
    if episodes < FEWEST {
        return None;
    }
    let mut pairs = Vec::new();
    for a in 0..experts {
        for b in a + 1..experts {
            let mut rho = 0.0;
            for (axis, shared) in [residual[0], residual[2]].into_iter().enumerate() {
                let of = |expert: usize| -> Vec<f64> {
                    let list = &errors[expert];
                    whole.iter().map(|&i| f64::from(list[i][axis])).collect()
                };
                rho += 0.5 * correlation(&of(a), &of(b), f64::from(shared))?;
            }
            pairs.push(Correlation { a, b, rho });
        }
    }
    let mean_rho = pairs.iter().map(|pair| pair.rho).sum::<f64>() / pairs.len() as f64;
    let inflation = inflation(0.0, 1.0, experts, mean_rho);
    if residual.iter().any(|&r| r > 0.0) && inflation <= LEAST_INFLATION {
        return None;
    }
    let effective = experts as f64 / inflation;
    Some(Dependence {
        pairs,
        mean_rho,
        experts,
        episodes,
        effective,
        inflation,
        with_prior: None,
        sentence: sentence(experts, episodes, mean_rho, inflation),
    })
}

/// `(T₀ + n Tₑ (1 + (n − 1) ρ)) / (T₀ + n Tₑ)`: true over claimed variance of one product of an honest prior and n
/// experts of one precision whose errors correlate by ρ: the NEES of the product; copies of one expert have ρ = 1 (D14).
/// NaN where a precision is negative, not finite, or the sum is zero.
pub fn inflation(prior_precision: f64, expert_precision: f64, n: usize, rho: f64) -> f64 {
    let sound = |x: f64| x >= 0.0 && x.is_finite();
    if !sound(prior_precision) || !sound(expert_precision) {
        return f64::NAN;
    }
    let count = n as f64;
    let together = (1.0 + (count - 1.0) * rho).max(LEAST_INFLATION);
    let claimed = prior_precision + count * expert_precision;
    (prior_precision + count * expert_precision * together) / claimed
}

/// Pearson's, after `shared` is taken off both variances and the covariance.
fn correlation(a: &[f64], b: &[f64], shared: f64) -> Option<f64> {
    let count = a.len() as f64;
    let mean = |x: &[f64]| x.iter().sum::<f64>() / count;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let moment = |x: &[f64], x0: f64, y: &[f64], y0: f64| {
        let sum: f64 = x.iter().zip(y).map(|(x, y)| (x - x0) * (y - y0)).sum();
        sum / count - shared
    };
    let variances = [moment(a, mean_a, a, mean_a), moment(b, mean_b, b, mean_b)];
    let rho = moment(a, mean_a, b, mean_b) / (variances[0] * variances[1]).sqrt();
    let sound = variances.iter().all(|v| *v > 0.0) && rho.abs() <= 1.0 + ROUNDING;
    sound.then_some(rho.clamp(-1.0, 1.0))
}

/// "3 experts whose errors correlate by 0.90 count as 1.1: without the prior their product claims a variance 2.8
/// times too small".
fn sentence(experts: usize, episodes: usize, rho: f64, inflation: f64) -> String {
    let effective = experts as f64 / inflation;
    let few = if episodes < FEW {
        format!(" (of {episodes} episodes only)")
    } else {
        String::new()
    };
    let claim = if inflation >= 1.05 {
        format!("claims a variance {inflation:.1} times too small")
    } else if inflation > 0.95 {
        "claims the right variance".to_owned()
    } else {
        format!("claims a variance {:.1} times too large", 1.0 / inflation)
    };
    format!(
        "{experts} experts whose errors correlate by {rho:.2}{few} count as {effective:.1}: without the prior their product {claim}"
    )
}

#[cfg(test)]
mod tests;
