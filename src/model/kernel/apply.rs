//! A chain as an operation of candle, for encoders in training and for everything without a gradient.

use std::sync::{Arc, Mutex, PoisonError};

use candle_core::{CpuStorage, CustomOp2, Layout, Result, Shape, Tensor, bail};
use rayon::prelude::*;

use super::chain::{Chain, cpu, part_size};
use super::values;
use crate::lock::lock;

/// `(samples, inputs)` and `(parameters)` to `(samples, outputs)`.
pub struct Apply {
    /// The layers.
    chain: Arc<Chain>,
    /// Whether the gradient of the input is wanted: data needs none.
    input_gradient: bool,
    /// Whether the activations are kept for a backward pass.
    train: bool,
    kept: Mutex<Vec<f32>>,
}

impl Apply {
    /// One application of `chain`.
    pub fn new(chain: Arc<Chain>, train: bool, input_gradient: bool) -> Self {
        Self {
            chain,
            input_gradient,
            train,
            kept: Mutex::default(),
        }
    }
}

impl Drop for Apply {
    fn drop(&mut self) {
        let kept = std::mem::take(self.kept.get_mut().unwrap_or_else(PoisonError::into_inner));
        if !kept.is_empty() {
            self.chain.give(kept);
        }
    }
}

impl CustomOp2 for Apply {
    fn name(&self) -> &'static str {
        "chain"
    }

    fn cpu_fwd(
        &self,
        x: &CpuStorage,
        x_layout: &Layout,
        w: &CpuStorage,
        w_layout: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let (x, w) = (values(x, x_layout)?, values(w, w_layout)?);
        let samples = self.chain.check(x, w)?;
        let mut activations = self.chain.take(self.chain.activations_len(samples));
        self.chain.forward_all(x, w, &mut activations);
        let part = part_size(samples);
        let mut out = Vec::with_capacity(samples * self.chain.outputs());
        for part in activations.chunks(self.chain.activations_len(part).max(1)) {
            out.extend_from_slice(
                &part[self
                    .chain
                    .last_output(part.len() / self.chain.activations_len(1))],
            );
        }
        if self.train {
            *lock(&self.kept) = activations;
        } else {
            self.chain.give(activations);
        }
        Ok((
            CpuStorage::F32(out),
            Shape::from((samples, self.chain.outputs())),
        ))
    }

    fn bwd(
        &self,
        x: &Tensor,
        w: &Tensor,
        _y: &Tensor,
        dy: &Tensor,
    ) -> Result<(Option<Tensor>, Option<Tensor>)> {
        let mut kept = lock(&self.kept);
        if kept.is_empty() {
            bail!("a chain that was not run for training has no gradient");
        }
        let chain = &self.chain;
        let dy = dy.contiguous()?;
        let (x_guard, x_layout) = x.storage_and_layout();
        let (w_guard, w_layout) = w.storage_and_layout();
        let (dy_guard, dy_layout) = dy.storage_and_layout();
        let (x_values, w_values, dy_values) = (
            cpu(&x_guard, x_layout)?,
            cpu(&w_guard, w_layout)?,
            cpu(&dy_guard, dy_layout)?,
        );
        let samples = x_values.len() / chain.inputs();
        let part = part_size(samples);
        let mut dx = if self.input_gradient {
            vec![0.0; x_values.len()]
        } else {
            Vec::new()
        };
        let dx_parts: Vec<Option<&mut [f32]>> = if self.input_gradient {
            dx.chunks_mut(part * chain.inputs()).map(Some).collect()
        } else {
            (0..samples.div_ceil(part)).map(|_| None).collect()
        };
        let gradients: Vec<Vec<f32>> = x_values
            .par_chunks(part * chain.inputs())
            .zip(kept.par_chunks_mut(chain.activations_len(part)))
            .zip(dy_values.par_chunks(part * chain.outputs()))
            .zip(dx_parts)
            .map(|(((x, activations), dy), dx)| {
                let mut dw = chain.take(chain.parameters());
                chain.backward_part(x, w_values, activations, dy, &mut dw, dx);
                dw
            })
            .collect();
        let dw = Tensor::from_vec(chain.sum_parts(gradients), w.shape(), w.device())?;
        let dx = self
            .input_gradient
            .then(|| Tensor::from_vec(dx, x.shape(), x.device()))
            .transpose()?;
        Ok((dx, Some(dw)))
    }
}
