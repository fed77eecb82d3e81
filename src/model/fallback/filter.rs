//! The filter, step by step.

use candle_core::{Result, Tensor};

use crate::model::dynamics::{Dynamics, Transition};
use crate::model::experts::Evidence;
use crate::model::filter::{Filtered, Inputs};
use crate::model::gaussian::DiagGaussian;

/// Beliefs for every step; `alphas (B, T, M)` are those that are multiplied in.
pub fn filter(
    dynamics: &Dynamics,
    weights: &Tensor,
    inputs: Inputs,
    alphas: &Tensor,
) -> Result<Filtered> {
    let (batch, steps, switches) = alphas.dims3()?;
    let alphas = (0..switches)
        .map(|i| alphas.narrow(2, i, 1))
        .collect::<Result<Vec<_>>>()?;
    let sensors = Evidence::of(inputs.experts, &alphas)?;
    let mut transition = dynamics.zero_state(batch, weights.device())?;
    let mut rows: [Vec<Tensor>; 6] = Default::default();
    for t in 0..steps {
        let Transition { hidden, prior } = &transition;
        let prior_alpha = alphas[switches - 1].narrow(1, t, 1)?.squeeze(1)?;
        let believed = Evidence::of(std::slice::from_ref(prior), &[prior_alpha])?;
        let sensed = sensors.as_ref().map(|sensors| sensors.at(t)).transpose()?;
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
