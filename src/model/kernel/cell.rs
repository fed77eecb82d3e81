//! A gated recurrent unit whose state mixes linear maps: one step of locally linear dynamics as one op.
//!
//! `h' = GRU([x], h)`, `α = softmax(W_α h' + b_α)`, `mean = Σ_k α_k M_k x`, `log_var = W_σ h' + b_σ`, where x is the
//! latent and the control side by side and `M_k = [A_k | B_k]`. Gates as in PyTorch: r, z, n, both biases.

use std::sync::{Mutex, PoisonError};

use candle_core::{CpuStorage, CustomOp3, Layout, Result, Shape, Tensor, bail};

use super::chain::cpu;
use super::matmul::{Mat, Write, matmul};
use super::pointwise::{add_row, exp, sigmoid, sum_rows, tanh};
use super::{arch, values};

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

    fn forward(&self, h: &[f32], x: &[f32], flat: &[f32]) -> (Vec<f32>, Kept) {
        let Sizes {
            latent,
            inputs,
            hidden,
            mixtures,
        } = self.sizes;
        let w = self.sizes.weights(flat);
        let batch = x.len() / inputs;
        let gates_len = 3 * hidden;
        let mut gates = vec![0.0; batch * gates_len];
        let mut recurrent = vec![0.0; batch * gates_len];
        matmul(
            (batch, gates_len, inputs),
            Mat::rows(x, inputs),
            Mat::rows(w.input, gates_len),
            &mut gates,
            Write::Replace,
        );
        matmul(
            (batch, gates_len, hidden),
            Mat::rows(h, hidden),
            Mat::rows(w.recurrent, gates_len),
            &mut recurrent,
            Write::Replace,
        );
        add_row(&mut gates, w.input_bias);
        add_row(&mut recurrent, w.recurrent_bias);
        let mut out = vec![0.0; batch * self.sizes.outputs()];
        let mut state = vec![0.0; batch * hidden];
        arch().dispatch(
            #[inline(always)]
            || {
                let lines = gates
                    .chunks_exact_mut(gates_len)
                    .zip(recurrent.chunks_exact(gates_len));
                for (((gates, recurrent), h), state) in lines
                    .zip(h.chunks_exact(hidden))
                    .zip(state.chunks_exact_mut(hidden))
                {
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
        let head_len = mixtures + latent;
        let mut head = vec![0.0; batch * head_len];
        matmul(
            (batch, head_len, hidden),
            Mat::rows(&state, hidden),
            Mat::rows(w.head, head_len),
            &mut head,
            Write::Replace,
        );
        add_row(&mut head, w.head_bias);
        let mut mapped = vec![0.0; batch * mixtures * latent];
        matmul(
            (batch, mixtures * latent, inputs),
            Mat::rows(x, inputs),
            Mat::transposed(w.bases, inputs),
            &mut mapped,
            Write::Replace,
        );
        let mut mixture = Vec::with_capacity(batch * mixtures);
        let lines = out
            .chunks_exact_mut(self.sizes.outputs())
            .zip(state.chunks_exact(hidden));
        for (((out, state), head), mapped) in lines
            .zip(head.chunks_exact(head_len))
            .zip(mapped.chunks_exact(mixtures * latent))
        {
            out[..hidden].copy_from_slice(state);
            let (logits, log_var) = head.split_at(mixtures);
            let start = mixture.len();
            mixture.extend(softmax(logits));
            let mean = &mut out[hidden..hidden + latent];
            for (alpha, mapped) in mixture[start..].iter().zip(mapped.chunks_exact(latent)) {
                for (m, v) in mean.iter_mut().zip(mapped) {
                    *m += alpha * v;
                }
            }
            out[hidden + latent..].copy_from_slice(log_var);
        }
        let recurrent_n = recurrent
            .chunks_exact(gates_len)
            .flat_map(|line| line[2 * hidden..].iter().copied())
            .collect();
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

    /// Gradients of h, x and the weights for the gradient `dout` of the output.
    fn backward(
        &self,
        h: &[f32],
        x: &[f32],
        flat: &[f32],
        out: &[f32],
        dout: &[f32],
        kept: &Kept,
    ) -> [Vec<f32>; 3] {
        let Sizes {
            latent,
            inputs,
            hidden,
            mixtures,
        } = self.sizes;
        let w = self.sizes.weights(flat);
        let batch = x.len() / inputs;
        let (gates_len, head_len, outputs) = (3 * hidden, mixtures + latent, self.sizes.outputs());
        let mut dhead = vec![0.0; batch * head_len];
        let mut dmapped = vec![0.0; batch * mixtures * latent];
        for b in 0..batch {
            let dmean = &dout[b * outputs + hidden..b * outputs + hidden + latent];
            let mixture = &kept.mixture[b * mixtures..(b + 1) * mixtures];
            let mapped = &kept.mapped[b * mixtures * latent..(b + 1) * mixtures * latent];
            let dmapped = &mut dmapped[b * mixtures * latent..(b + 1) * mixtures * latent];
            let (dlogits, dlog_var) =
                dhead[b * head_len..(b + 1) * head_len].split_at_mut(mixtures);
            for k in 0..mixtures {
                let along: f32 = mapped[k * latent..(k + 1) * latent]
                    .iter()
                    .zip(dmean)
                    .map(|(p, d)| p * d)
                    .sum();
                dlogits[k] = along;
                for (to, d) in dmapped[k * latent..(k + 1) * latent].iter_mut().zip(dmean) {
                    *to = mixture[k] * d;
                }
            }
            let mean: f32 = dlogits.iter().zip(mixture).map(|(d, a)| d * a).sum();
            for (d, a) in dlogits.iter_mut().zip(mixture) {
                *d = a * (*d - mean);
            }
            dlog_var.copy_from_slice(&dout[b * outputs + hidden + latent..(b + 1) * outputs]);
        }
        let mut state = Vec::with_capacity(batch * hidden);
        let mut dstate = vec![0.0; batch * hidden];
        matmul(
            (batch, hidden, head_len),
            Mat::rows(&dhead, head_len),
            Mat::transposed(w.head, head_len),
            &mut dstate,
            Write::Replace,
        );
        for b in 0..batch {
            state.extend_from_slice(&out[b * outputs..b * outputs + hidden]);
            for (d, o) in dstate[b * hidden..(b + 1) * hidden]
                .iter_mut()
                .zip(&dout[b * outputs..])
            {
                *d += o;
            }
        }
        let mut dh = vec![0.0; batch * hidden];
        let mut dgates = vec![0.0; batch * gates_len];
        let mut drecurrent = vec![0.0; batch * gates_len];
        for b in 0..batch {
            let gates = &kept.gates[b * gates_len..(b + 1) * gates_len];
            let dgates = &mut dgates[b * gates_len..(b + 1) * gates_len];
            let drecurrent = &mut drecurrent[b * gates_len..(b + 1) * gates_len];
            for i in 0..hidden {
                let (r, z, n) = (gates[i], gates[hidden + i], gates[2 * hidden + i]);
                let d = dstate[b * hidden + i];
                let dn = d * (1.0 - z) * (1.0 - n * n);
                let dz = d * (h[b * hidden + i] - n) * z * (1.0 - z);
                let dr = dn * kept.recurrent_n[b * hidden + i] * r * (1.0 - r);
                dh[b * hidden + i] = d * z;
                (dgates[i], dgates[hidden + i], dgates[2 * hidden + i]) = (dr, dz, dn);
                (
                    drecurrent[i],
                    drecurrent[hidden + i],
                    drecurrent[2 * hidden + i],
                ) = (dr, dz, dn * r);
            }
        }
        let mut dflat = vec![0.0; self.sizes.parameters()];
        let mut rest = &mut dflat[..];
        let mut parts = self.sizes.parts().map(|len| {
            let (part, tail) = std::mem::take(&mut rest).split_at_mut(len);
            rest = tail;
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
        matmul(
            (inputs, gates_len, batch),
            Mat::transposed(x, inputs),
            Mat::rows(&dgates, gates_len),
            input,
            Write::Replace,
        );
        matmul(
            (hidden, gates_len, batch),
            Mat::transposed(h, hidden),
            Mat::rows(&drecurrent, gates_len),
            recurrent,
            Write::Replace,
        );
        sum_rows(&dgates, input_bias);
        sum_rows(&drecurrent, recurrent_bias);
        matmul(
            (hidden, head_len, batch),
            Mat::transposed(&state, hidden),
            Mat::rows(&dhead, head_len),
            head,
            Write::Replace,
        );
        sum_rows(&dhead, head_bias);
        let maps = mixtures * latent;
        matmul(
            (maps, inputs, batch),
            Mat::transposed(&dmapped, maps),
            Mat::rows(x, inputs),
            bases,
            Write::Replace,
        );
        matmul(
            (batch, hidden, gates_len),
            Mat::rows(&drecurrent, gates_len),
            Mat::transposed(w.recurrent, gates_len),
            &mut dh,
            Write::Add,
        );
        let mut dx = vec![0.0; batch * inputs];
        matmul(
            (batch, inputs, gates_len),
            Mat::rows(&dgates, gates_len),
            Mat::transposed(w.input, gates_len),
            &mut dx,
            Write::Replace,
        );
        matmul(
            (batch, inputs, maps),
            Mat::rows(&dmapped, maps),
            Mat::rows(w.bases, inputs),
            &mut dx,
            Write::Add,
        );
        [dh, dx, dflat]
    }
}

/// exp(xᵢ) / Σ exp(xⱼ).
pub fn softmax(logits: &[f32]) -> Vec<f32> {
    let top = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let mut weights: Vec<f32> = logits.iter().map(|v| exp(v - top)).collect();
    let sum: f32 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    weights
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
        let (out, kept) = self.forward(h, x, w);
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
        let [dh, dx, dw] = self.backward(
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
