//! The filter: step by step, the prior expert and what the sensors say, multiplied; and the rollout, the prior alone.

use candle_core::{Result, Tensor};

use super::dynamics::{Dynamics, Transition};
use super::experts::Evidence;
use super::gaussian::DiagGaussian;

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

/// Beliefs for every step. Where `prior_expert` is off the prior is stated but not multiplied in.
pub fn filter(
    dynamics: &Dynamics,
    weights: &Tensor,
    inputs: Inputs,
    prior_expert: bool,
) -> Result<Filtered> {
    let (batch, steps, switches) = inputs.alphas.dims3()?;
    let alphas = (0..switches)
        .map(|i| inputs.alphas.narrow(2, i, 1))
        .collect::<Result<Vec<_>>>()?;
    let sensors = Evidence::of(inputs.experts, &alphas)?;
    let mut transition = dynamics.zero_state(batch, inputs.alphas.device())?;
    let mut rows: [Vec<Tensor>; 6] = Default::default();
    for t in 0..steps {
        let Transition { hidden, prior } = &transition;
        let sensed = sensors.as_ref().map(|sensors| sensors.at(t)).transpose()?;
        let prior_alpha = alphas[switches - 1].narrow(1, t, 1)?.squeeze(1)?;
        let believed = if prior_expert {
            Evidence::of(std::slice::from_ref(prior), &[prior_alpha])?
        } else {
            None
        };
        let posterior = match (sensed, believed) {
            (Some(sensed), Some(believed)) => sensed.and(&believed)?.belief()?,
            (Some(only), None) | (None, Some(only)) => only.belief()?,
            (None, None) => candle_core::bail!("a model without experts has no belief"),
        };
        let noise = inputs
            .noise
            .map(|noise| noise.narrow(1, t, 1)?.squeeze(1))
            .transpose()?;
        let z = posterior.draw(noise.as_ref())?;
        let step = [
            &prior.mean,
            &prior.log_var,
            &posterior.mean,
            &posterior.log_var,
            &z,
            hidden,
        ];
        for (row, value) in rows.iter_mut().zip(step) {
            row.push(value.clone());
        }
        if t + 1 < steps {
            let u = inputs.controls.narrow(1, t, 1)?.squeeze(1)?;
            transition = dynamics.step(hidden, &z, &u, weights)?;
        }
    }
    let [prior_mean, prior_log_var, mean, log_var, z, hidden] =
        rows.map(|row| Tensor::stack(&row, 1));
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
