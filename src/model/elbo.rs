//! The terms of the evidence lower bound, each by name and never summed here.

use candle_core::{Result, Tensor};

use super::dynamics::Dynamics;
use super::filter::Filtered;
use super::gaussian::DiagGaussian;

/// KL(q_t ‖ p_t) in nats: `(B, T)`, its gradient balanced.
pub fn kl(filtered: &Filtered, balance: f64) -> Result<Tensor> {
    balanced(&filtered.posterior, &filtered.prior, balance)
}

/// KL(q ‖ p), of whose gradient `balance` moves p and the rest moves q, twice as much as alone (Hafner et al. 2021);
/// ½ is the plain KL.
fn balanced(posterior: &DiagGaussian, prior: &DiagGaussian, balance: f64) -> Result<Tensor> {
    if (balance - 0.5).abs() < f64::EPSILON {
        return posterior.kl(prior);
    }
    let towards_posterior = posterior.detach().kl(prior)?;
    let towards_prior = posterior.kl(&prior.detach())?;
    // Both are the KL itself, whose value counts once.
    let value = posterior.detach().kl(&prior.detach())?;
    let both = (towards_posterior.affine(2.0 * balance, 0.0)?
        + towards_prior.affine(2.0 - 2.0 * balance, 0.0)?)?;
    both - value
}

/// What each latent adds to it: `(B, T, Z)`.
pub fn kl_per_latent(filtered: &Filtered) -> Result<Tensor> {
    filtered.posterior.kl_per_latent(&filtered.prior)
}

/// KL of each posterior against the prior stated `n` steps before it, for n = 2 … `n_step` (overshooting): one tensor
/// `(B, T - n)` for each n. The priors of the step before are pushed through the dynamics once more, their means fed
/// on, from the states that stated them.
pub fn overshooting(
    dynamics: &Dynamics,
    weights: &Tensor,
    filtered: &Filtered,
    controls: &Tensor,
    n_step: usize,
    balance: f64,
) -> Result<Vec<Tensor>> {
    let (batch, steps, latent) = filtered.z.dims3()?;
    let mut terms = Vec::new();
    // The first prior is not the dynamics' own: pushing starts from the second.
    let mut mean = filtered.prior.mean.narrow(1, 1, steps - 1)?;
    let mut hidden = filtered.hidden.narrow(1, 1, steps - 1)?;
    for n in 2..=n_step.min(steps - 1) {
        let len = steps - n;
        let flat = |x: &Tensor, from: usize| x.narrow(1, from, len)?.contiguous()?.flatten(0, 1);
        let next = dynamics.step(
            &flat(&hidden, 0)?,
            &flat(&mean, 0)?,
            &flat(controls, n - 1)?,
            weights,
        )?;
        let shape = |x: &Tensor| x.contiguous()?.reshape((batch, len, x.dim(1)?));
        let prior = DiagGaussian {
            mean: shape(&next.prior.mean)?,
            log_var: shape(&next.prior.log_var)?,
        };
        let posterior = filtered.posterior.narrow(1, n, len)?;
        terms.push(balanced(&posterior, &prior, balance)?);
        debug_assert_eq!(prior.mean.dim(2)?, latent);
        (mean, hidden) = (prior.mean, shape(&next.hidden)?);
    }
    Ok(terms)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use candle_core::{Device, Var};

    use super::*;

    #[test]
    fn balance_moves_gradients_between_the_two_and_leaves_the_value() {
        let var = |numbers: [f32; 2]| Var::new(&[[numbers]], &Device::Cpu).unwrap();
        let (q, p) = (var([0.3, -0.7]), var([-0.2, 0.4]));
        let gaussian = |mean: &Var| DiagGaussian {
            mean: mean.as_tensor().clone(),
            log_var: mean.affine(0.5, 0.1).unwrap(),
        };
        let of = |balance: f64| {
            let kl = balanced(&gaussian(&q), &gaussian(&p), balance).unwrap();
            let kl = kl.sum_all().unwrap();
            let gradients = kl.backward().unwrap();
            let gradient = |var: &Var| -> Vec<f32> {
                let own = gradients.get(var).unwrap();
                own.flatten_all().unwrap().to_vec1().unwrap()
            };
            (kl.to_scalar::<f32>().unwrap(), gradient(&q), gradient(&p))
        };
        let (plain, balanced) = (of(0.5), of(0.8));
        assert!(
            (plain.0 - balanced.0).abs() < 1e-5,
            "{plain:?} {balanced:?}"
        );
        for i in 0..2 {
            assert!((0.4 * plain.1[i] - balanced.1[i]).abs() < 1e-5);
            assert!((1.6 * plain.2[i] - balanced.2[i]).abs() < 1e-5);
        }
    }
}
