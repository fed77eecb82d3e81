//! A gated recurrent unit whose state mixes linear maps: one step of locally linear dynamics as one op.
//!
//! `h' = GRU([x], h)`, `α = softmax(W_α h' + b_α)`, `mean = Σ_k α_k M_k x`, `log_var = W_σ h' + b_σ`, where x is the
//! latent and the control side by side and `M_k = [A_k | B_k]`. Gates as in PyTorch: r, z, n, both biases.

mod backward;
mod forward;

use std::sync::{Mutex, PoisonError};

use candle_core::{CpuStorage, CustomOp3, Layout, Result, Shape, Tensor, bail};

use super::chain::cpu;
use super::values;

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
struct Weights<'a> {
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

    fn weights<'a>(&self, mut flat: &'a [f32]) -> Weights<'a> {
        let mut parts = self.parts().map(|len| {
            let (part, rest) = flat.split_at(len);
            flat = rest;
            part
        });
        let [
            input,
            recurrent,
            input_bias,
            recurrent_bias,
            head,
            head_bias,
            bases,
        ] = &mut parts;
        Weights {
            input,
            recurrent,
            input_bias,
            recurrent_bias,
            head,
            head_bias,
            bases,
        }
    }
}

/// What the backward pass needs of the forward one.
#[derive(Default)]
struct Kept {
    /// r, z, n side by side, `(B, 3 hidden)`.
    gates: Vec<f32>,
    /// `W_hn h + b_hn`, `(B, hidden)`.
    recurrent_n: Vec<f32>,
    /// α, `(B, K)`.
    mixture: Vec<f32>,
    /// `M_k x`, `(B, K Z)`.
    mapped: Vec<f32>,
}

/// `(B, hidden)`, `(B, inputs)` and the flat weights to `(B, hidden + 2 Z)`: new state, mean, log-variance.
pub struct Cell {
    sizes: Sizes,
    kept: Mutex<Kept>,
}

impl Cell {
    /// One step.
    pub fn new(sizes: Sizes) -> Self {
        Self {
            sizes,
            kept: Mutex::default(),
        }
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
        let (out, kept) = forward::step(self.sizes, h, x, w);
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = kept;
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
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let (h_guard, h_layout) = h.storage_and_layout();
        let (x_guard, x_layout) = x.storage_and_layout();
        let (w_guard, w_layout) = w.storage_and_layout();
        let (out_guard, out_layout) = out.storage_and_layout();
        let (dout_guard, dout_layout) = dout.storage_and_layout();
        let [dh, dx, dw] = backward::step(
            self.sizes,
            cpu(&h_guard, h_layout)?,
            cpu(&x_guard, x_layout)?,
            cpu(&w_guard, w_layout)?,
            cpu(&out_guard, out_layout)?,
            cpu(&dout_guard, dout_layout)?,
            &kept,
        );
        Ok((
            Some(Tensor::from_vec(dh, h.shape(), h.device())?),
            Some(Tensor::from_vec(dx, x.shape(), x.device())?),
            Some(Tensor::from_vec(dw, w.shape(), w.device())?),
        ))
    }
}
