//! A gated recurrent unit whose state mixes linear maps: one step of locally linear dynamics as one op.
//!
//! `h' = GRU([x], h)`, `α = softmax(W_α h' + b_α)`, `mean = Σ_k α_k M_k x`, `log_var = W_σ h' + b_σ`, where x is the
//! latent and the control side by side and `M_k = [A_k | B_k]`. Gates as in PyTorch: r, z, n, both biases.

pub(super) mod backward;
pub(super) mod forward;
pub(super) mod mixed;

use std::sync::Mutex;

use candle_core::{CpuStorage, CustomOp3, Layout, Result, Shape, Tensor, bail};
use rayon::prelude::*;

use self::backward::{Pull, Rows, Transposes, Upstream};
use self::forward::Tape;
use super::chain::{cpu, part_size};
use super::rows::transposed;
use super::values;
use crate::lock::lock;

/// Fewer rows than this are not worth a second thread.
const ROWS_APART: usize = 64;

/// Sizes of the cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Z, numbers of the mean and the log-variance.
    pub latent: usize,
    /// Numbers of x: Z and the control's.
    pub inputs: usize,
    /// Numbers of the hidden state.
    pub hidden: usize,
    /// K, base matrices.
    pub mixtures: usize,
}

/// Where the parts of the cell's weights lie, in order.
pub(super) struct Weights<'a> {
    /// `(inputs, 3 hidden)`.
    input: &'a [f32],
    /// `(hidden, 3 hidden)`.
    recurrent: &'a [f32],
    input_bias: &'a [f32],
    recurrent_bias: &'a [f32],
    /// `(hidden, mixtures + latent)`.
    head: &'a [f32],
    head_bias: &'a [f32],
    /// `(mixtures · latent, inputs)`.
    bases: &'a [f32],
    /// Their transpose.
    across_bases: Vec<f32>,
}

impl Sizes {
    /// Lengths of the parts of the weights, in order: input, recurrent, their biases, head, its bias, bases.
    pub fn parts(&self) -> [usize; 7] {
        let gates = 3 * self.hidden;
        let head = self.mixtures + self.latent;
        [
            self.inputs * gates,
            self.hidden * gates,
            gates,
            gates,
            self.hidden * head,
            head,
            self.mixtures * self.latent * self.inputs,
        ]
    }

    /// Numbers of all weights.
    pub fn parameters(&self) -> usize {
        self.parts().iter().sum()
    }

    /// Numbers of the output: the hidden state, the mean and the log-variance.
    pub fn outputs(&self) -> usize {
        self.hidden + 2 * self.latent
    }

    /// Where the parts of `flat` are.
    pub(super) fn weights<'a>(&self, mut flat: &'a [f32]) -> Weights<'a> {
        let [
            input,
            recurrent,
            input_bias,
            recurrent_bias,
            head,
            head_bias,
            bases,
        ] = self.parts().map(|len| {
            let (part, rest) = flat.split_at(len);
            flat = rest;
            part
        });
        Weights {
            input,
            recurrent,
            input_bias,
            recurrent_bias,
            head,
            head_bias,
            bases,
            across_bases: transposed(bases, self.inputs),
        }
    }

    /// Mixtures' logits and the log-variance, side by side.
    fn head(&self) -> usize {
        self.mixtures + self.latent
    }

    /// Numbers of every `M_k x`.
    fn maps(&self) -> usize {
        self.mixtures * self.latent
    }
}

/// `(B, hidden)`, `(B, inputs)` and the flat weights to `(B, hidden + 2 Z)`: new state, mean, log-variance.
pub struct Cell {
    sizes: Sizes,
    /// One tape for the rows of each task.
    tapes: Mutex<Vec<Tape>>,
}

/// Rows of each parallel task.
fn rows_apart(rows: usize) -> usize {
    if rows < ROWS_APART {
        rows.max(1)
    } else {
        part_size(rows)
    }
}

impl Cell {
    /// One step.
    pub fn new(sizes: Sizes) -> Self {
        Self {
            sizes,
            tapes: Mutex::default(),
        }
    }

    /// New state, mean and log-variance of some rows, and what they leave for the backward pass.
    fn forward(&self, h: &[f32], x: &[f32], w: &Weights, out: &mut [f32]) -> Tape {
        let Sizes { latent, hidden, .. } = self.sizes;
        let rows = x.len() / self.sizes.inputs;
        let mut tape = Tape::new(self.sizes, rows);
        let (mut state, mut mean) = (vec![0.0; h.len()], vec![0.0; rows * latent]);
        let mut slices = tape.rows(self.sizes, 0..rows);
        forward::step(self.sizes, w, h, x, &mut slices, &mut state, &mut mean);
        let lines = state.chunks_exact(hidden).zip(mean.chunks_exact(latent));
        let lines = lines.zip(slices.head.chunks_exact(self.sizes.head()));
        for (out, ((state, mean), head)) in out.chunks_exact_mut(self.sizes.outputs()).zip(lines) {
            out[..hidden].copy_from_slice(state);
            out[hidden..hidden + latent].copy_from_slice(mean);
            out[hidden + latent..].copy_from_slice(&head[self.sizes.mixtures..]);
        }
        tape
    }
}

impl CustomOp3 for Cell {
    fn name(&self) -> &'static str {
        "mixture-cell"
    }

    fn cpu_fwd(
        &self,
        h: &CpuStorage,
        h_layout: &Layout,
        x: &CpuStorage,
        x_layout: &Layout,
        w: &CpuStorage,
        w_layout: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let (h, x, w) = (
            values(h, h_layout)?,
            values(x, x_layout)?,
            values(w, w_layout)?,
        );
        let batch = x.len() / self.sizes.inputs;
        if h.len() != batch * self.sizes.hidden || w.len() != self.sizes.parameters() {
            bail!(
                "a cell of {:?} got a state of {} and {} weights",
                self.sizes,
                h.len(),
                w.len()
            );
        }
        let w = self.sizes.weights(w);
        let rows = rows_apart(batch);
        let mut out = vec![0.0; batch * self.sizes.outputs()];
        let tapes = h
            .par_chunks(rows * self.sizes.hidden)
            .zip(x.par_chunks(rows * self.sizes.inputs))
            .zip(out.par_chunks_mut(rows * self.sizes.outputs()))
            .map(|((h, x), out)| self.forward(h, x, &w, out))
            .collect();
        *lock(&self.tapes) = tapes;
        Ok((
            CpuStorage::F32(out),
            Shape::from((batch, self.sizes.outputs())),
        ))
    }

    fn bwd(
        &self,
        h: &Tensor,
        x: &Tensor,
        w: &Tensor,
        out: &Tensor,
        dout: &Tensor,
    ) -> Result<(Option<Tensor>, Option<Tensor>, Option<Tensor>)> {
        let dout = dout.contiguous()?;
        let guards = [h, x, w, out, &dout].map(|tensor| tensor.storage_and_layout());
        let [h_values, x_values, w_values, out_values, dout_values] =
            guards.each_ref().map(|(guard, layout)| cpu(guard, layout));
        let (h_values, x_values, out_values, dout_values) =
            (h_values?, x_values?, out_values?, dout_values?);
        let sizes = self.sizes;
        let mut tapes = lock(&self.tapes);
        let w_parts = sizes.weights(w_values?);
        let transposes = Transposes::of(sizes, &w_parts);
        let (mut dh, mut dx) = (vec![0.0; h_values.len()], vec![0.0; x_values.len()]);
        let rows = rows_apart(x_values.len() / sizes.inputs);
        let pulled: Vec<(Pull, Vec<f32>)> = tapes
            .par_iter_mut()
            .zip(h_values.par_chunks(rows * sizes.hidden))
            .zip(out_values.par_chunks(rows * sizes.outputs()))
            .zip(dout_values.par_chunks(rows * sizes.outputs()))
            .zip(dh.par_chunks_mut(rows * sizes.hidden))
            .zip(dx.par_chunks_mut(rows * sizes.inputs))
            .map(|(((((tape, h), out), dout), dh), dx)| {
                let rows = h.len() / sizes.hidden;
                let part = |lines: &[f32], from: usize, len: usize| -> Vec<f32> {
                    lines
                        .chunks_exact(sizes.outputs())
                        .flat_map(|line| line[from..from + len].iter().copied())
                        .collect()
                };
                let state = part(out, 0, sizes.hidden);
                let mut dstate = part(dout, 0, sizes.hidden);
                let dmean = part(dout, sizes.hidden, sizes.latent);
                let dlog_var = part(dout, sizes.hidden + sizes.latent, sizes.latent);
                let mut pull = Pull::new(sizes, rows);
                let mut up = Upstream {
                    state: &mut dstate,
                    mean: &dmean,
                    log_var: &dlog_var,
                };
                backward::step(
                    sizes,
                    (&w_parts, &transposes),
                    h,
                    &tape.rows(sizes, 0..rows),
                    &mut up,
                    &mut pull.rows(sizes, 0..rows),
                    (dh, dx),
                );
                (pull, state)
            })
            .collect();
        let each: Vec<Rows> = pulled
            .iter()
            .zip(h_values.chunks(rows * sizes.hidden))
            .zip(x_values.chunks(rows * sizes.inputs))
            .map(|(((pull, state), h), x)| Rows { h, x, state, pull })
            .collect();
        let dflat = backward::weights(sizes, &each);
        Ok((
            Some(Tensor::from_vec(dh, h.shape(), h.device())?),
            Some(Tensor::from_vec(dx, x.shape(), x.device())?),
            Some(Tensor::from_vec(dflat, w.shape(), w.device())?),
        ))
    }
}
