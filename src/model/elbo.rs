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
    towards_posterior.affine(2.0 * balance, 0.0)?
        + towards_prior.affine(2.0 - 2.0 * balance, 0.0)?
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
