//! Sequences back through time.

use super::forward::Run;
use super::{EPSILON, Inputs, Row};
use crate::model::kernel::cell::backward::{Pull, Transposes, Upstream, step};
use crate::model::kernel::cell::{Sizes, Weights};
use crate::model::kernel::pointwise::exp;
use crate::model::kernel::vectorised;

/// Gradients of one step that go on to the step before, a row a sequence.
struct Carried {
    /// Of the hidden state, `(B, hidden)`.
    state: Vec<f32>,
    /// Of what went into the cell, `(B, inputs)`.
    x: Vec<f32>,
    /// Of the prior, `(B, Z)` each.
    prior_mean: Vec<f32>,
    prior_log_var: Vec<f32>,
}

/// Gradients of each expert's means and log-variances in turn, `(B, T, Z)` each, and of the cell's products, for the
/// gradient `dout (B, T, row)` of `out`.
pub fn through(
    sizes: Sizes,
    w: (&Weights, &Transposes),
    inputs: &Inputs,
    run: &mut Run,
    out: &[f32],
    dout: &[f32],
) -> (Vec<Vec<f32>>, Pull) {
    let Sizes { latent, hidden, .. } = sizes;
    let (batch, steps) = (inputs.sequences(), inputs.steps);
    let mut pull = Pull::new(sizes, (steps - 1) * batch);
    let mut carried = Carried {
        state: vec![0.0; batch * hidden],
        x: vec![0.0; batch * sizes.inputs],
        prior_mean: vec![0.0; batch * latent],
        prior_log_var: vec![0.0; batch * latent],
    };
    let mut dstate = vec![0.0; batch * hidden];
    let mut devidence = (
        vec![0.0; batch * steps * latent],
        vec![0.0; batch * steps * latent],
    );
    for t in (0..steps).rev() {
        unfuse(
            sizes,
            inputs,
            run,
            t,
            (out, dout),
            &mut carried,
            &mut devidence,
        );
        if t == 0 {
            break;
        }
        let douts = dout
            .chunks_exact(Row::of(sizes).width())
            .skip(t)
            .step_by(steps);
        let states = carried.state.chunks_exact(hidden).zip(douts);
        for (to, (carried, row)) in dstate.chunks_exact_mut(hidden).zip(states) {
            for ((to, carried), own) in to.iter_mut().zip(carried).zip(&row[5 * latent..]) {
                *to = carried + own;
            }
        }
        let rows = (t - 1) * batch..t * batch;
        let mut up = Upstream {
            state: &mut dstate,
            mean: &carried.prior_mean,
            log_var: &carried.prior_log_var,
        };
        let h = &run.states[(t - 1) * batch * hidden..t * batch * hidden];
        step(
            sizes,
            w,
            h,
            &run.tape.rows(sizes, rows.clone()),
            &mut up,
            &mut pull.rows(sizes, rows),
            (&mut carried.state, &mut carried.x),
        );
    }
    (experts(latent, inputs, &devidence), pull)
}

/// Back through the product of step `t`: from the gradients of its output and of what went into the next transition to
/// those of the prior and of Σ α / σ² and Σ α μ / σ².
fn unfuse(
    sizes: Sizes,
    inputs: &Inputs,
    run: &Run,
    t: usize,
    (out, dout): (&[f32], &[f32]),
    carried: &mut Carried,
    (dprecision, dweighted): &mut (Vec<f32>, Vec<f32>),
) {
    let latent = sizes.latent;
    let (steps, switches) = (inputs.steps, inputs.experts.len() + 1);
    let row = Row::of(sizes);
    vectorised(
        #[inline(always)]
        || {
            for b in 0..inputs.sequences() {
                let at = b * steps + t;
                let alpha = inputs.alphas[(at + 1) * switches - 1];
                let place = at * latent..(at + 1) * latent;
                let here = at * row.width()..(at + 1) * row.width();
                let [prior_mean, prior_log_var, _, log_var, _, _] = row.split(&out[here.clone()]);
                let [own_mean, own_log_var, dmean, dlog_var, dz, _] = row.split(&dout[here]);
                let precision = &run.evidence.precision[place.clone()];
                let weighted = &run.evidence.weighted_mean[place.clone()];
                let fed = &carried.x[b * sizes.inputs..][..latent];
                let dprecision = &mut dprecision[place.clone()];
                let dweighted = &mut dweighted[place.clone()];
                let dprior_mean = &mut carried.prior_mean[b * latent..][..latent];
                let dprior_log_var = &mut carried.prior_log_var[b * latent..][..latent];
                for i in 0..latent {
                    let own = alpha * exp(-prior_log_var[i]);
                    let variance = 1.0 / (precision[i] + own);
                    let dz = dz[i] + fed[i];
                    let spread = inputs.noise.map_or(0.0, |noise| {
                        0.5 * exp(log_var[i] * 0.5) * noise[place.start + i]
                    });
                    let dmean = dmean[i] + dz;
                    let dlog_var = dlog_var[i] + dz * spread;
                    let dvariance = dmean * (weighted[i] + own * prior_mean[i])
                        + dlog_var / (variance + EPSILON);
                    dprecision[i] = -dvariance * variance * variance;
                    dweighted[i] = dmean * variance;
                    dprior_mean[i] = own_mean[i] + dweighted[i] * own;
                    dprior_log_var[i] =
                        own_log_var[i] - (dprecision[i] + dweighted[i] * prior_mean[i]) * own;
                }
            }
        },
    );
}

/// Gradients of each expert's means and log-variances in turn, from those of what they say together.
fn experts(
    latent: usize,
    inputs: &Inputs,
    (dprecision, dweighted): &(Vec<f32>, Vec<f32>),
) -> Vec<Vec<f32>> {
    let switches = inputs.experts.len() + 1;
    let mut all = Vec::with_capacity(2 * inputs.experts.len());
    for (expert, (means, log_vars)) in inputs.experts.iter().enumerate() {
        let mut dmeans = vec![0.0; means.len()];
        let mut dlog_vars = vec![0.0; means.len()];
        vectorised(
            #[inline(always)]
            || {
                for i in 0..means.len() {
                    let alpha = inputs.alphas[i / latent * switches + expert];
                    let own = alpha * exp(-log_vars[i]);
                    dmeans[i] = dweighted[i] * own;
                    dlog_vars[i] = -(dprecision[i] + dweighted[i] * means[i]) * own;
                }
            },
        );
        all.extend([dmeans, dlog_vars]);
    }
    all
}
