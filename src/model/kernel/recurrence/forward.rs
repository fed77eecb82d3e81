//! Sequences step by step.

use super::{EPSILON, Inputs, Row};
use crate::model::kernel::cell::backward::{Pull, Rows};
use crate::model::kernel::cell::forward::{Tape, step};
use crate::model::kernel::cell::{Sizes, Weights};
use crate::model::kernel::pointwise::exp;
use crate::model::kernel::vectorised;

/// What some sequences leave for the backward pass. Rows go step by step, and sequence by sequence within a step.
pub struct Run {
    /// Of each transition, `(T - 1, B)` rows; of the last one only where nothing is kept.
    pub tape: Tape,
    /// What went into each transition, `(T - 1, B, inputs)`.
    x: Vec<f32>,
    /// Hidden states, `(T, B, hidden)`.
    pub states: Vec<f32>,
    /// What the experts say together.
    pub evidence: Evidence,
}

/// Σ α / σ² and Σ α μ / σ² over the experts, `(B, T, Z)`.
pub struct Evidence {
    /// Σ α / σ².
    pub precision: Vec<f32>,
    /// Σ α μ / σ².
    pub weighted_mean: Vec<f32>,
}

impl Evidence {
    fn of(latent: usize, inputs: &Inputs) -> Self {
        let switches = inputs.experts.len() + 1;
        let rows = inputs.alphas.len() / switches;
        let (mut precision, mut weighted_mean) =
            (vec![0.0; rows * latent], vec![0.0; rows * latent]);
        let mut add = |expert: usize, means: &[f32], log_vars: &[f32]| {
            let alphas = inputs.alphas.iter().skip(expert).step_by(switches);
            let sums = precision.chunks_exact_mut(latent);
            let sums = sums.zip(weighted_mean.chunks_exact_mut(latent));
            let stated = means
                .chunks_exact(latent)
                .zip(log_vars.chunks_exact(latent));
            // What is said of one sequence is said of all.
            for (((precision, weighted), (means, log_vars)), &alpha) in
                sums.zip(stated.cycle()).zip(alphas)
            {
                let sums = precision.iter_mut().zip(weighted);
                for (((p, w), mean), log_var) in sums.zip(means).zip(log_vars) {
                    let own = alpha * exp(-log_var);
                    *p += own;
                    *w += own * mean;
                }
            }
        };
        vectorised(
            #[inline(always)]
            || {
                for (i, (means, log_vars)) in inputs.experts.iter().enumerate() {
                    add(i, means, log_vars);
                }
            },
        );
        Self {
            precision,
            weighted_mean,
        }
    }
}

impl Run {
    /// Runs the sequences of `inputs` into `out (B, T, row)`.
    pub fn of(sizes: Sizes, w: &Weights, inputs: &Inputs, keep: bool, out: &mut [f32]) -> Self {
        let Sizes { latent, hidden, .. } = sizes;
        let (batch, steps) = (inputs.sequences(), inputs.steps);
        let transitions = steps - 1;
        let taped = if keep {
            transitions
        } else {
            transitions.min(1)
        };
        let mut run = Self {
            tape: Tape::new(sizes, taped * batch),
            x: vec![0.0; transitions * batch * sizes.inputs],
            states: vec![0.0; steps * batch * hidden],
            evidence: Evidence::of(latent, inputs),
        };
        let mut mean = vec![0.0; batch * latent];
        let mut log_var = vec![inputs.first_log_var; batch * latent];
        for t in 0..steps {
            run.fuse(sizes, inputs, t, (&mean, &log_var), out);
            if t < transitions {
                run.feed(sizes, inputs, t, out);
                let (before, after) = run.states.split_at_mut((t + 1) * batch * hidden);
                let x = &run.x[t * batch * sizes.inputs..(t + 1) * batch * sizes.inputs];
                let row = if keep { t * batch } else { 0 };
                let mut tape = run.tape.rows(sizes, row..row + batch);
                step(
                    sizes,
                    w,
                    &before[t * batch * hidden..],
                    x,
                    &mut tape,
                    &mut after[..batch * hidden],
                    &mut mean,
                );
                stated(sizes, tape.head, &mut log_var);
            }
        }
        run
    }

    /// The beliefs of step `t` for a prior.
    fn fuse(
        &self,
        sizes: Sizes,
        inputs: &Inputs,
        t: usize,
        prior: (&[f32], &[f32]),
        out: &mut [f32],
    ) {
        let Sizes { latent, hidden, .. } = sizes;
        let (steps, switches) = (inputs.steps, inputs.experts.len() + 1);
        let batch = inputs.sequences();
        let states = &self.states[t * batch * hidden..(t + 1) * batch * hidden];
        let rows = out
            .chunks_exact_mut(Row::of(sizes).width())
            .skip(t)
            .step_by(steps);
        let given = prior
            .0
            .chunks_exact(latent)
            .zip(prior.1.chunks_exact(latent));
        let mut rows: Vec<_> = rows.zip(given).zip(states.chunks_exact(hidden)).collect();
        vectorised(
            #[inline(always)]
            || {
                for (b, ((row, (prior_mean, prior_log_var)), state)) in rows.iter_mut().enumerate()
                {
                    let at = b * steps + t;
                    let alpha = inputs.alphas[(at + 1) * switches - 1];
                    let place = at * latent..(at + 1) * latent;
                    let precision = &self.evidence.precision[place.clone()];
                    let weighted = &self.evidence.weighted_mean[place.clone()];
                    let (gaussians, rest) = row.split_at_mut(4 * latent);
                    let (z, hidden) = rest.split_at_mut(latent);
                    let (stated, believed) = gaussians.split_at_mut(2 * latent);
                    let (mean, log_var) = believed.split_at_mut(latent);
                    stated[..latent].copy_from_slice(prior_mean);
                    stated[latent..].copy_from_slice(prior_log_var);
                    hidden.copy_from_slice(state);
                    for i in 0..latent {
                        let own = alpha * exp(-prior_log_var[i]);
                        let variance = 1.0 / (precision[i] + own);
                        mean[i] = variance * (weighted[i] + own * prior_mean[i]);
                        log_var[i] = (variance + EPSILON).ln();
                    }
                    z.copy_from_slice(mean);
                    if let Some(noise) = inputs.noise {
                        for ((z, log_var), noise) in z.iter_mut().zip(log_var).zip(&noise[place]) {
                            *z += exp(*log_var * 0.5) * noise;
                        }
                    }
                }
            },
        );
    }

    /// What goes into the transition from step `t`.
    fn feed(&mut self, sizes: Sizes, inputs: &Inputs, t: usize, out: &[f32]) {
        let (latent, control) = (sizes.latent, sizes.inputs - sizes.latent);
        let batch = inputs.sequences();
        let rows = out
            .chunks_exact(Row::of(sizes).width())
            .skip(t)
            .step_by(inputs.steps);
        let each = (inputs.steps - 1) * control;
        let controls = inputs.controls.chunks_exact(each).cycle();
        let x = &mut self.x[t * batch * sizes.inputs..(t + 1) * batch * sizes.inputs];
        for ((x, row), controls) in x.chunks_exact_mut(sizes.inputs).zip(rows).zip(controls) {
            x[..latent].copy_from_slice(&row[4 * latent..5 * latent]);
            x[latent..].copy_from_slice(&controls[t * control..(t + 1) * control]);
        }
    }

    /// Every transition, for the gradient of the weights.
    pub fn rows<'a>(&'a self, sizes: Sizes, pull: &'a Pull) -> Rows<'a> {
        let transitions = self.x.len() / sizes.inputs * sizes.hidden;
        Rows {
            h: &self.states[..transitions],
            x: &self.x,
            state: &self.states[self.states.len() - transitions..],
            pull,
        }
    }
}

/// The log-variance that a cell's head stated.
pub(super) fn stated(sizes: Sizes, head: &[f32], log_var: &mut [f32]) {
    let heads = head.chunks_exact(sizes.mixtures + sizes.latent);
    for (log_var, head) in log_var.chunks_exact_mut(sizes.latent).zip(heads) {
        log_var.copy_from_slice(&head[sizes.mixtures..]);
    }
}
