//! The gradients of the cell's step: back through one step, then the weights' over all steps at once.

use std::ops::Range;

use super::forward::TapeRows;
use super::{Sizes, Weights};
use crate::model::kernel::matmul::{Mat, Write, matmul};
use crate::model::kernel::pointwise::sum_rows;
use crate::model::kernel::rows::{accumulate, transposed};
use crate::model::kernel::vectorised;

/// Transposes of the weights that gradients are multiplied by.
pub struct Transposes {
    input: Vec<f32>,
    recurrent: Vec<f32>,
    head: Vec<f32>,
}

impl Transposes {
    /// Those of `w`.
    pub fn of(sizes: Sizes, w: &Weights) -> Self {
        Self {
            input: transposed(w.input, 3 * sizes.hidden),
            recurrent: transposed(w.recurrent, 3 * sizes.hidden),
            head: transposed(w.head, sizes.head()),
        }
    }
}

/// Gradients of what the products of each step put out, a row for each step: as many as the tape has values.
pub use super::forward::{Tape as Pull, TapeRows as PullRows};

/// Gradients of the new state, the mean and the log-variance.
pub struct Upstream<'a> {
    /// `(B, hidden)`; the head's share is added to it.
    pub state: &'a mut [f32],
    /// `(B, Z)`.
    pub mean: &'a [f32],
    /// `(B, Z)`.
    pub log_var: &'a [f32],
}

/// Back through one step from states `h (B, hidden)`: fills `pull`, and the gradients `dh (B, hidden)` and
/// `dx (B, inputs)`.
pub fn step(
    sizes: Sizes,
    (w, across): (&Weights, &Transposes),
    h: &[f32],
    tape: &TapeRows,
    up: &mut Upstream,
    pull: &mut PullRows,
    (dh, dx): (&mut [f32], &mut [f32]),
) {
    let gates = 3 * sizes.hidden;
    through_mixture(sizes, up, tape, pull);
    accumulate(pull.head, sizes.head(), &across.head, up.state);
    through_gates(sizes.hidden, h, up.state, tape, pull, dh);
    accumulate(pull.recurrent, gates, &across.recurrent, dh);
    dx.fill(0.0);
    accumulate(pull.gates, gates, &across.input, dx);
    accumulate(pull.mapped, sizes.maps(), w.bases, dx);
}

/// Gradients of the head (logits and log-variance side by side) and of each `M_k x`.
fn through_mixture(sizes: Sizes, up: &Upstream, tape: &TapeRows, pull: &mut PullRows) {
    let Sizes {
        latent, mixtures, ..
    } = sizes;
    let (head, maps) = (sizes.head(), sizes.maps());
    let kept = tape.head.chunks_exact(head);
    let kept = kept.zip(tape.mapped.chunks_exact(maps));
    let ups = up.mean.chunks_exact(latent);
    let ups = ups.zip(up.log_var.chunks_exact(latent));
    let pulls = pull.head.chunks_exact_mut(head);
    let pulls = pulls.zip(pull.mapped.chunks_exact_mut(maps));
    for (((weights, mapped), (dmean, dlog_var)), (dhead, dmapped)) in kept.zip(ups).zip(pulls) {
        let weights = &weights[..mixtures];
        let (dlogits, dhead_log_var) = dhead.split_at_mut(mixtures);
        let each = dlogits.iter_mut().zip(weights);
        let each = each.zip(mapped.chunks_exact(latent));
        for (((dlogit, weight), mapped), dmapped) in each.zip(dmapped.chunks_exact_mut(latent)) {
            *dlogit = mapped.iter().zip(dmean).map(|(p, d)| p * d).sum();
            for (to, d) in dmapped.iter_mut().zip(dmean) {
                *to = weight * d;
            }
        }
        // Softmax: dlogit_k = α_k (dα_k − Σ_j α_j dα_j).
        let mean: f32 = dlogits.iter().zip(weights).map(|(d, a)| d * a).sum();
        for (d, a) in dlogits.iter_mut().zip(weights) {
            *d = a * (*d - mean);
        }
        dhead_log_var.copy_from_slice(dlog_var);
    }
}

/// Gradients before the gates' nonlinearities, on the input's and on the state's side, and the state's own part.
fn through_gates(
    hidden: usize,
    h: &[f32],
    dstate: &[f32],
    tape: &TapeRows,
    pull: &mut PullRows,
    dh: &mut [f32],
) {
    vectorised(
        #[inline(always)]
        || {
            let kept = tape.gates.chunks_exact(3 * hidden);
            let kept = kept.zip(tape.recurrent.chunks_exact(3 * hidden));
            let states = h.chunks_exact(hidden).zip(dstate.chunks_exact(hidden));
            let pulls = pull.gates.chunks_exact_mut(3 * hidden);
            let pulls = pulls.zip(pull.recurrent.chunks_exact_mut(3 * hidden));
            let pulls = pulls.zip(dh.chunks_exact_mut(hidden));
            for (((gates, recurrent), (h, dstate)), ((dgates, drecurrent), dh)) in
                kept.zip(states).zip(pulls)
            {
                let [r, z, n] = thirds(gates, hidden);
                let [_, _, recurrent_n] = thirds(recurrent, hidden);
                let (dr, rest) = dgates.split_at_mut(hidden);
                let (dz, dn) = rest.split_at_mut(hidden);
                let (dn, h, dstate, dh) = (
                    &mut dn[..hidden],
                    &h[..hidden],
                    &dstate[..hidden],
                    &mut dh[..hidden],
                );
                for i in 0..hidden {
                    let d = dstate[i];
                    dn[i] = d * (1.0 - z[i]) * (1.0 - n[i] * n[i]);
                    dz[i] = d * (h[i] - n[i]) * z[i] * (1.0 - z[i]);
                    dr[i] = dn[i] * recurrent_n[i] * r[i] * (1.0 - r[i]);
                    dh[i] = d * z[i];
                }
                let (same, last) = drecurrent.split_at_mut(2 * hidden);
                same[..hidden].copy_from_slice(dr);
                same[hidden..].copy_from_slice(dz);
                for ((last, dn), r) in last.iter_mut().zip(dn).zip(r) {
                    *last = *dn * r;
                }
            }
        },
    );
}

/// The parts of r, z and n.
#[inline(always)]
fn thirds(row: &[f32], hidden: usize) -> [&[f32]; 3] {
    [
        &row[..hidden],
        &row[hidden..2 * hidden],
        &row[2 * hidden..3 * hidden],
    ]
}

/// Rows of some steps: what went in, what came out, and the gradients of the products.
pub struct Rows<'a> {
    /// States before, `(rows, hidden)`.
    pub h: &'a [f32],
    /// Inputs, `(rows, inputs)`.
    pub x: &'a [f32],
    /// States after, `(rows, hidden)`.
    pub state: &'a [f32],
    /// What [`step`] filled.
    pub pull: &'a Pull,
}

/// Gradient of the flat weights: one product a weight over all rows of `each`, the largest shared by two tasks.
pub fn weights(sizes: Sizes, each: &[Rows]) -> Vec<f32> {
    let Sizes { inputs, hidden, .. } = sizes;
    let (gates, head, maps) = (3 * hidden, sizes.head(), sizes.maps());
    let mut flat = vec![0.0; sizes.parameters()];
    let mut rest = &mut flat[..];
    let [
        input,
        recurrent,
        input_bias,
        recurrent_bias,
        head_weight,
        head_bias,
        bases,
    ] = sizes.parts().map(|len| {
        let (part, tail) = std::mem::take(&mut rest).split_at_mut(len);
        rest = tail;
        part
    });
    // a (rows, m), of it `take` columns from `from`; b (rows, n).
    let outer = |(a, m): (&[f32], usize), columns: Range<usize>, (b, n), dw: &mut [f32]| {
        let shape = (columns.len(), n, a.len() / m);
        let left = Mat::transposed(&a[columns.start..], m);
        matmul(shape, left, Mat::rows(b, n), dw, Write::Add);
    };
    let half = hidden / 2;
    let (upper, lower) = recurrent.split_at_mut(half * gates);
    rayon::join(
        || {
            for Rows { h, pull, .. } in each {
                outer((h, hidden), 0..half, (&pull.recurrent, gates), upper);
            }
        },
        || {
            for Rows { h, x, state, pull } in each {
                outer((h, hidden), half..hidden, (&pull.recurrent, gates), lower);
                outer((x, inputs), 0..inputs, (&pull.gates, gates), input);
                outer((state, hidden), 0..hidden, (&pull.head, head), head_weight);
                outer((&pull.mapped, maps), 0..maps, (x, inputs), bases);
                sum_rows(&pull.gates, input_bias);
                sum_rows(&pull.recurrent, recurrent_bias);
                sum_rows(&pull.head, head_bias);
            }
        },
    );
    flat
}
