//! The cell's step: gates, new state, mixture, mean, log-variance.

use super::{Kept, Sizes, Weights};
use crate::model::kernel::arch;
use crate::model::kernel::matmul::{Mat, Write, matmul};
use crate::model::kernel::pointwise::{add_row, exp, sigmoid, tanh};

/// The output `(B, hidden + 2 Z)`, and what the backward pass needs.
pub(super) fn step(sizes: Sizes, h: &[f32], x: &[f32], flat: &[f32]) -> (Vec<f32>, Kept) {
    let w = sizes.weights(flat);
    let (gates, recurrent_n, state) = gates(sizes, h, x, &w);
    let Sizes {
        latent,
        inputs,
        hidden,
        mixtures,
    } = sizes;
    let batch = x.len() / inputs;
    let head = product(&state, w.head, hidden, w.head_bias);
    let maps = mixtures * latent;
    let mut mapped = vec![0.0; batch * maps];
    matmul(
        (batch, maps, inputs),
        Mat::rows(x, inputs),
        Mat::transposed(w.bases, inputs),
        &mut mapped,
        Write::Replace,
    );
    let mut mixture = Vec::with_capacity(batch * mixtures);
    let mut out = vec![0.0; batch * sizes.outputs()];
    let lines = out
        .chunks_exact_mut(sizes.outputs())
        .zip(state.chunks_exact(hidden));
    let lines = lines
        .zip(head.chunks_exact(mixtures + latent))
        .zip(mapped.chunks_exact(maps));
    for (((out, state), head), mapped) in lines {
        out[..hidden].copy_from_slice(state);
        let (logits, log_var) = head.split_at(mixtures);
        let weights = softmax(logits);
        let mean = &mut out[hidden..hidden + latent];
        for (weight, mapped) in weights.iter().zip(mapped.chunks_exact(latent)) {
            for (m, v) in mean.iter_mut().zip(mapped) {
                *m += weight * v;
            }
        }
        mixture.extend(weights);
        out[hidden + latent..].copy_from_slice(log_var);
    }
    (
        out,
        Kept {
            gates,
            recurrent_n,
            mixture,
            mapped,
        },
    )
}

/// `x (B, inputs) · w (inputs, n) + bias (n)`.
fn product(x: &[f32], w: &[f32], inputs: usize, bias: &[f32]) -> Vec<f32> {
    let (batch, n) = (x.len() / inputs, bias.len());
    let mut out = vec![0.0; batch * n];
    matmul(
        (batch, n, inputs),
        Mat::rows(x, inputs),
        Mat::rows(w, n),
        &mut out,
        Write::Replace,
    );
    add_row(&mut out, bias);
    out
}

/// r, z, n side by side; `W_hn h + b_hn`; and the new state.
fn gates(sizes: Sizes, h: &[f32], x: &[f32], w: &Weights) -> (Vec<f32>, Vec<f32>, Vec<f32>) {
    let hidden = sizes.hidden;
    let mut gates = product(x, w.input, sizes.inputs, w.input_bias);
    let recurrent = product(h, w.recurrent, hidden, w.recurrent_bias);
    let mut state = vec![0.0; h.len()];
    arch().dispatch(
        #[inline(always)]
        || {
            let lines = gates
                .chunks_exact_mut(3 * hidden)
                .zip(recurrent.chunks_exact(3 * hidden));
            let lines = lines
                .zip(h.chunks_exact(hidden))
                .zip(state.chunks_exact_mut(hidden));
            for (((gates, recurrent), h), state) in lines {
                let (r, rest) = gates.split_at_mut(hidden);
                let (z, n) = rest.split_at_mut(hidden);
                for i in 0..hidden {
                    r[i] = sigmoid(r[i] + recurrent[i]);
                    z[i] = sigmoid(z[i] + recurrent[hidden + i]);
                    n[i] = tanh(n[i] + r[i] * recurrent[2 * hidden + i]);
                    state[i] = (1.0 - z[i]) * n[i] + z[i] * h[i];
                }
            }
        },
    );
    let recurrent_n = recurrent
        .chunks_exact(3 * hidden)
        .flat_map(|line| line[2 * hidden..].iter().copied())
        .collect();
    (gates, recurrent_n, state)
}

/// exp(xᵢ) / Σ exp(xⱼ).
fn softmax(logits: &[f32]) -> Vec<f32> {
    let top = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let mut weights: Vec<f32> = logits.iter().map(|v| exp(v - top)).collect();
    let sum: f32 = weights.iter().sum();
    for weight in &mut weights {
        *weight /= sum;
    }
    weights
}
