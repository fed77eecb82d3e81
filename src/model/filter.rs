//! The filter: step by step, the prior expert and what the sensors say, multiplied; and the rollout, the prior alone.

use candle_core::{Result, Tensor};

use super::dynamics::{Dynamics, FIRST_VARIANCE};
use super::fallback;
use super::gaussian::DiagGaussian;
use super::kernel::recurrence::{Kept, Recurrence, Row};
use super::trace::count_prior;

/// Beliefs over an episode. Every tensor is `(B, T, …)`.
#[derive(Clone, Debug)]
pub struct Filtered {
    /// `p(z_t | z_{t-1}, u_{t-1})`; the first is N(0, 20 I).
    pub prior: DiagGaussian,
    /// The product of the active experts.
    pub posterior: DiagGaussian,
    /// What was fed on: the posterior's mean, or a sample of it.
    pub z: Tensor,
    /// The recurrent state that stated each prior, `(B, T, hidden)`.
    pub hidden: Tensor,
}

/// What a filter runs on.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// The sensor experts, `(B, T, Z)` each.
    pub experts: &'a [DiagGaussian],
    /// α of every expert, the prior last, `(B, T, M)`.
    pub alphas: &'a Tensor,
    /// `(B, T - 1, U)`: row t acts from step t to t + 1.
    pub controls: &'a Tensor,
    /// N(0, I) noise `(B, T, Z)` for the sampled path; none for the mean path.
    pub noise: Option<&'a Tensor>,
}

/// Beliefs for every step. Where `prior_expert` is off the prior is multiplied in only where no sensor is.
pub fn filter(
    dynamics: &Dynamics,
    weights: &Tensor,
    inputs: Inputs,
    prior_expert: bool,
) -> Result<Filtered> {
    let (batch, steps, switches) = inputs.alphas.dims3()?;
    let mut alphas = inputs.alphas.flatten_all()?.to_vec1()?;
    count_prior(&mut alphas, switches, prior_expert);
    if weights.device().is_cpu() {
        return on_cpu(dynamics, weights, inputs, alphas);
    }
    let alphas = Tensor::from_vec(alphas, (batch, steps, switches), weights.device())?;
    fallback::filter(dynamics, weights, inputs, &alphas)
}

fn on_cpu(
    dynamics: &Dynamics,
    weights: &Tensor,
    inputs: Inputs,
    alphas: Vec<f32>,
) -> Result<Filtered> {
    let stated: Vec<_> = inputs
        .experts
        .iter()
        .flat_map(|expert| [&expert.mean, &expert.log_var])
        .collect();
    let op = Recurrence {
        sizes: dynamics.sizes(),
        alphas,
        controls: inputs.controls.flatten_all()?.to_vec1()?,
        noise: inputs
            .noise
            .map(|noise| noise.flatten_all()?.to_vec1())
            .transpose()?,
        first_log_var: FIRST_VARIANCE.ln() as f32,
        kept: Kept::default(),
    };
    let rows = Tensor::stack(&stated, 0)?.apply_op2(weights, op)?;
    let [prior_mean, prior_log_var, mean, log_var, z, hidden] = Row::of(dynamics.sizes())
        .parts()
        .map(|(start, len)| rows.narrow(2, start, len)?.contiguous());
    Ok(Filtered {
        prior: DiagGaussian {
            mean: prior_mean?,
            log_var: prior_log_var?,
        },
        posterior: DiagGaussian {
            mean: mean?,
            log_var: log_var?,
        },
        z: z?,
        hidden: hidden?,
    })
}

/// The prior alone: from state `hidden (B, hidden)` and latent `z (B, Z)`, one step for each row of
/// `controls (B, h, U)`, means fed back. The log-variances are the head's one-step ones; nothing accumulates.
pub fn rollout(
    dynamics: &Dynamics,
    weights: &Tensor,
    hidden: &Tensor,
    z: &Tensor,
    controls: &Tensor,
) -> Result<DiagGaussian> {
    let (mut means, mut log_vars) = (Vec::new(), Vec::new());
    let (mut hidden, mut z) = (hidden.clone(), z.clone());
    for t in 0..controls.dim(1)? {
        let next = dynamics.step(&hidden, &z, &controls.narrow(1, t, 1)?.squeeze(1)?, weights)?;
        (hidden, z) = (next.hidden, next.prior.mean.clone());
        means.push(next.prior.mean);
        log_vars.push(next.prior.log_var);
    }
    Ok(DiagGaussian {
        mean: Tensor::stack(&means, 1)?,
        log_var: Tensor::stack(&log_vars, 1)?,
    })
}
