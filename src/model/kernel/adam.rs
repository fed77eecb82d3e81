//! Adam with the gradient clipped by its norm, over one flat parameter tensor, in one pass and in place.

use candle_core::{CpuStorage, InplaceOp2, Layout, Result, Tensor, bail};
use rayon::prelude::*;

use super::chain::cpu;
use super::pointwise::sum_of_squares;
use super::{values, vectorised};
use crate::lock::lock;

/// First and second moments of one flat parameter tensor, and how often it was updated.
#[derive(Clone, Debug, Default)]
pub struct Moments {
    /// Running mean of the gradient.
    pub first: Vec<f32>,
    /// Running mean of its square.
    pub second: Vec<f32>,
    /// Updates so far.
    pub updates: u32,
}

/// β₁, β₂ and ε of Kingma & Ba 2015 as PyTorch has them.
const BETA: (f32, f32) = (0.9, 0.999);
const EPSILON: f32 = 1e-8;

/// ‖gradient‖.
pub fn norm(gradient: &Tensor) -> Result<f32> {
    let (guard, layout) = gradient.storage_and_layout();
    let sum: f64 = cpu(&guard, layout)?
        .par_chunks(1 << 16)
        .map(|chunk| f64::from(sum_of_squares(chunk)))
        .collect::<Vec<_>>()
        .into_iter()
        .sum();
    Ok(sum.sqrt() as f32)
}

/// One update of `theta` against `gradient`, both flat, with learning rate `rate` and the gradient, whose norm is
/// `norm`, scaled so that it is at most `clip`.
pub fn update(
    theta: &Tensor,
    gradient: &Tensor,
    norm: f32,
    moments: &mut Moments,
    rate: f64,
    clip: f32,
) -> Result<()> {
    // PyTorch's clip_grad_norm_ divides by norm + 1e-6.
    let scale = (clip / (norm + 1e-6)).min(1.0);
    moments.first.resize(theta.elem_count(), 0.0);
    moments.second.resize(theta.elem_count(), 0.0);
    moments.updates += 1;
    let correction = |beta: f32| 1.0 - f64::from(beta).powi(moments.updates as i32);
    let pass = Pass {
        scale,
        rate: (rate / correction(BETA.0)) as f32,
        root: correction(BETA.1).sqrt() as f32,
        moments: std::sync::Mutex::new(std::mem::take(moments)),
    };
    let result = theta.inplace_op2(gradient, &pass);
    *moments = pass
        .moments
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    result
}

struct Pass {
    scale: f32,
    rate: f32,
    root: f32,
    moments: std::sync::Mutex<Moments>,
}

impl InplaceOp2 for Pass {
    fn name(&self) -> &'static str {
        "adam"
    }

    fn cpu_fwd(
        &self,
        theta: &mut CpuStorage,
        layout: &Layout,
        gradient: &CpuStorage,
        gradient_layout: &Layout,
    ) -> Result<()> {
        let gradient = values(gradient, gradient_layout)?;
        let (CpuStorage::F32(theta), Some((start, end))) = (theta, layout.contiguous_offsets())
        else {
            bail!("adam wants contiguous f32 parameters");
        };
        let mut moments = lock(&self.moments);
        let Moments { first, second, .. } = &mut *moments;
        let chunk = 1 << 16;
        theta[start..end]
            .par_chunks_mut(chunk)
            .zip(gradient.par_chunks(chunk))
            .zip(first.par_chunks_mut(chunk))
            .zip(second.par_chunks_mut(chunk))
            .for_each(|(((theta, gradient), first), second)| {
                vectorised(
                    #[inline(always)]
                    || {
                        let lines = theta
                            .iter_mut()
                            .zip(gradient)
                            .zip(first.iter_mut())
                            .zip(second.iter_mut());
                        for (((theta, &g), m), v) in lines {
                            let g = g * self.scale;
                            *m = BETA.0 * *m + (1.0 - BETA.0) * g;
                            *v = BETA.1 * *v + (1.0 - BETA.1) * g * g;
                            *theta -= self.rate * *m / (v.sqrt() / self.root + EPSILON);
                        }
                    },
                );
            });
        Ok(())
    }
}
