//! The cell's step: gates, new state, mixture, mean, log-variance.

use std::ops::Range;

use super::{Sizes, Weights};
use crate::model::kernel::pointwise::{exp, sigmoid, tanh};
use crate::model::kernel::rows::{accumulate, affine};
use crate::model::kernel::vectorised;

/// What steps leave for the backward pass, a row for each.
#[derive(Debug)]
pub struct Tape {
    pub(super) gates: Vec<f32>,
    pub(super) recurrent: Vec<f32>,
    pub(super) head: Vec<f32>,
    pub(super) mapped: Vec<f32>,
}

/// Some rows of a [`Tape`].
pub struct TapeRows<'a> {
    /// r, z, n side by side, `(B, 3 hidden)`.
    pub gates: &'a mut [f32],
    /// `W_h h + b_h`, `(B, 3 hidden)`.
    pub recurrent: &'a mut [f32],
    /// α and the log-variance side by side, `(B, K + Z)`.
    pub head: &'a mut [f32],
    /// `M_k x`, `(B, K Z)`.
    pub mapped: &'a mut [f32],
}

impl Tape {
    /// Room for `rows`.
    pub fn new(sizes: Sizes, rows: usize) -> Self {
        Self {
            gates: vec![0.0; rows * 3 * sizes.hidden],
            recurrent: vec![0.0; rows * 3 * sizes.hidden],
            head: vec![0.0; rows * sizes.head()],
            mapped: vec![0.0; rows * sizes.maps()],
        }
    }

    /// These rows.
    pub fn rows(&mut self, sizes: Sizes, rows: Range<usize>) -> TapeRows<'_> {
        let part = |width: usize| rows.start * width..rows.end * width;
        TapeRows {
            gates: &mut self.gates[part(3 * sizes.hidden)],
            recurrent: &mut self.recurrent[part(3 * sizes.hidden)],
            head: &mut self.head[part(sizes.head())],
            mapped: &mut self.mapped[part(sizes.maps())],
        }
    }
}

/// From states `h (B, hidden)` and inputs `x (B, inputs)` to the new `state (B, hidden)` and the `mean (B, Z)`; the
/// log-variance is left in the tape's head.
pub fn step(
    sizes: Sizes,
    w: &Weights,
    h: &[f32],
    x: &[f32],
    tape: &mut TapeRows,
    state: &mut [f32],
    mean: &mut [f32],
) {
    let Sizes {
        latent,
        inputs,
        hidden,
        mixtures,
    } = sizes;
    affine(x, inputs, w.input, w.input_bias, tape.gates);
    affine(h, hidden, w.recurrent, w.recurrent_bias, tape.recurrent);
    through_gates(hidden, h, tape, state);
    affine(state, hidden, w.head, w.head_bias, tape.head);
    tape.mapped.fill(0.0);
    accumulate(x, inputs, &w.across_bases, tape.mapped);
    let lines = tape.head.chunks_exact_mut(mixtures + latent);
    let lines = lines.zip(tape.mapped.chunks_exact(mixtures * latent));
    for (mean, (head, mapped)) in mean.chunks_exact_mut(latent).zip(lines) {
        softmax(&mut head[..mixtures]);
        mean.fill(0.0);
        for (weight, mapped) in head.iter().zip(mapped.chunks_exact(latent)) {
            for (m, v) in mean.iter_mut().zip(mapped) {
                *m += weight * v;
            }
        }
    }
}

/// r, z, n in place of what the input says of them, and the new state.
fn through_gates(hidden: usize, h: &[f32], tape: &mut TapeRows, state: &mut [f32]) {
    vectorised(
        #[inline(always)]
        || {
            let lines = tape.gates.chunks_exact_mut(3 * hidden);
            let lines = lines.zip(tape.recurrent.chunks_exact(3 * hidden));
            let states = h.chunks_exact(hidden).zip(state.chunks_exact_mut(hidden));
            for ((gates, recurrent), (h, state)) in lines.zip(states) {
                let (r, rest) = gates.split_at_mut(hidden);
                let (z, n) = rest.split_at_mut(hidden);
                let (recurrent_r, rest) = recurrent.split_at(hidden);
                let (recurrent_z, recurrent_n) = rest.split_at(hidden);
                for i in 0..hidden {
                    r[i] = sigmoid(r[i] + recurrent_r[i]);
                    z[i] = sigmoid(z[i] + recurrent_z[i]);
                    n[i] = tanh(n[i] + r[i] * recurrent_n[i]);
                    state[i] = (1.0 - z[i]) * n[i] + z[i] * h[i];
                }
            }
        },
    );
}

/// exp(xᵢ) / Σ exp(xⱼ), in place.
pub(super) fn softmax(logits: &mut [f32]) {
    let top = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let mut sum = 0.0;
    for logit in &mut *logits {
        *logit = exp(*logit - top);
        sum += *logit;
    }
    for logit in logits {
        *logit /= sum;
    }
}
