//! A chain and its squared error in one pass: what is decoded is compared and differentiated while it is in the cache.
//!
//! The result is one number, Σ wₙ ‖chain(zₙ) − targetₙ‖², so its gradient with respect to inputs and parameters is
//! known up to a factor when it is computed; the backward pass only scales it.

use std::ops::Range;
use std::sync::{Arc, Mutex};

use candle_core::{CpuStorage, CustomOp3, Layout, Result, Shape, Tensor, bail};
use rayon::prelude::*;

use super::chain::{Chain, part_size};
use super::{values, vectorised};
use crate::lock::lock;

/// Squared error of each sample, once the operation has run.
pub type PerSample = Arc<Mutex<Vec<f32>>>;

/// `(samples, inputs)`, `(parameters)` and targets `(samples, outputs)` to the weighted sum of squared errors.
pub struct SquaredError {
    chain: Arc<Chain>,
    weights: Vec<f32>,
    train: bool,
    per_sample: PerSample,
    gradients: Mutex<Option<(Vec<f32>, Vec<f32>)>>,
}

impl SquaredError {
    /// One evaluation; `weights` has a factor for each sample.
    pub fn new(chain: Arc<Chain>, weights: Vec<f32>, train: bool) -> Self {
        Self {
            chain,
            weights,
            train,
            per_sample: Arc::default(),
            gradients: Mutex::default(),
        }
    }

    /// Where the unweighted squared error of each sample will be.
    pub fn per_sample(&self) -> PerSample {
        Arc::clone(&self.per_sample)
    }

    /// Errors, gradient of the parameters and gradient of the inputs for one part.
    fn part(
        &self,
        z: &[f32],
        w: &[f32],
        target: &[f32],
        weights: &[f32],
    ) -> (Vec<f32>, Vec<f32>, Vec<f32>) {
        let (width, mut errors) = (self.chain.outputs(), Vec::with_capacity(weights.len()));
        let error = |samples: Range<usize>, y: &[f32], dy: &mut [f32]| {
            let target = &target[samples.start * width..samples.end * width];
            let lines = y.chunks_exact(width).zip(target.chunks_exact(width));
            let lines = lines.zip(dy.chunks_exact_mut(width));
            for (((y, t), dy), &weight) in lines.zip(&weights[samples]) {
                errors.push(difference(y, t, weight, dy));
            }
        };
        let (mut dw, mut dz) = (Vec::new(), Vec::new());
        if self.train {
            dw = self.chain.take(self.chain.parameters());
            dz = vec![0.0; z.len()];
        }
        let gradients = self.train.then_some((&mut dw[..], &mut dz[..]));
        self.chain.fused_part(z, w, error, gradients);
        (errors, dw, dz)
    }
}

/// ‖y − t‖², leaving its gradient times `weight` in `dy`. Summed in sixteen lanes, so that the bits are the same
/// everywhere.
fn difference(y: &[f32], t: &[f32], weight: f32, dy: &mut [f32]) -> f32 {
    vectorised(
        #[inline(always)]
        || {
            let mut lanes = [0.0_f32; 16];
            let (y, y_rest) = y.as_chunks::<16>();
            let (t, t_rest) = t.as_chunks::<16>();
            let (dy, dy_rest) = dy.as_chunks_mut::<16>();
            for ((y, t), dy) in y.iter().zip(t).zip(dy) {
                for i in 0..16 {
                    let e = y[i] - t[i];
                    lanes[i] += e * e;
                    dy[i] = 2.0 * weight * e;
                }
            }
            for (i, (y, t)) in y_rest.iter().zip(t_rest).enumerate() {
                let e = y - t;
                lanes[i] += e * e;
                dy_rest[i] = 2.0 * weight * e;
            }
            lanes.iter().sum()
        },
    )
}

impl CustomOp3 for SquaredError {
    fn name(&self) -> &'static str {
        "chain-squared-error"
    }

    fn cpu_fwd(
        &self,
        z: &CpuStorage,
        z_layout: &Layout,
        w: &CpuStorage,
        w_layout: &Layout,
        target: &CpuStorage,
        target_layout: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let (z, w, target) = (
            values(z, z_layout)?,
            values(w, w_layout)?,
            values(target, target_layout)?,
        );
        let samples = self.chain.check(z, w)?;
        if target.len() != samples * self.chain.outputs() || self.weights.len() != samples {
            bail!(
                "{samples} samples, {} target numbers, {} weights",
                target.len(),
                self.weights.len()
            );
        }
        let part = part_size(samples);
        let parts: Vec<_> = z
            .par_chunks(part * self.chain.inputs())
            .zip(target.par_chunks(part * self.chain.outputs()))
            .zip(self.weights.par_chunks(part))
            .map(|((z, target), weights)| self.part(z, w, target, weights))
            .collect();
        let (mut errors, mut dws, mut dz) = (Vec::with_capacity(samples), Vec::new(), Vec::new());
        for (part_errors, dw, part_dz) in parts {
            errors.extend(part_errors);
            dws.push(dw);
            dz.extend(part_dz);
        }
        let total = errors
            .iter()
            .zip(&self.weights)
            .map(|(&e, &w)| f64::from(e) * f64::from(w))
            .sum::<f64>();
        *lock(&self.per_sample) = errors;
        if self.train {
            *lock(&self.gradients) = Some((dz, self.chain.sum_parts(dws)));
        }
        Ok((CpuStorage::F32(vec![total as f32]), Shape::from(())))
    }

    fn bwd(
        &self,
        z: &Tensor,
        w: &Tensor,
        _target: &Tensor,
        _res: &Tensor,
        upstream: &Tensor,
    ) -> Result<(Option<Tensor>, Option<Tensor>, Option<Tensor>)> {
        let gradients = lock(&self.gradients).take();
        let Some((dz, dw)) = gradients else {
            bail!("a squared error that was not run for training has no gradient");
        };
        let factor = f64::from(upstream.to_scalar::<f32>()?);
        let scaled = |gradient: Vec<f32>, like: &Tensor| -> Result<Tensor> {
            let gradient = Tensor::from_vec(gradient, like.shape(), like.device())?;
            if (factor - 1.0).abs() < f64::EPSILON {
                Ok(gradient)
            } else {
                gradient.affine(factor, 0.0)
            }
        };
        Ok((Some(scaled(dz, z)?), Some(scaled(dw, w)?), None))
    }
}
