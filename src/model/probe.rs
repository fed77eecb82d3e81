//! The position probe: the object's place on the table, read linearly from a belief's mean.
//!
//! `p̂ = W μ + b` by least squares; covariance `P = W Σ Wᵀ + R_p`, with R_p the positive semidefinite part of the
//! residuals' second moment less the mean of `W Σ Wᵀ` (D11): the residuals already contain the belief's own spread.

mod hidden;
mod linear;
mod regressors;

pub use self::hidden::Hidden;
pub use self::linear::Linear;
pub use self::regressors::{Readers, Regressors};

use std::collections::HashMap;
use std::path::Path;

use candle_core::{DType, Device, Tensor};
use nalgebra::{Matrix2, SymmetricEigen};

use super::checkpoint::{CheckpointError, first_line, parse_tensors, write_tensors};
use super::trace::GaussianTrace;

/// A linear probe from the latent to x and y.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// W, `(2, Z)` row major, in metres.
    pub weights: Vec<f32>,
    /// b, in metres.
    pub bias: [f32; 2],
    /// R_p as xx, xy, yy, in square metres.
    pub residual: [f32; 3],
}

/// Beliefs of some episodes and the recorded positions they should give, in metres.
#[derive(Clone, Debug, Default)]
pub struct Positions {
    /// Beliefs, one after another.
    pub beliefs: GaussianTrace,
    /// As many positions.
    pub truth: Vec<[f32; 2]>,
}

/// What is read from what: rows of inputs and of the outputs they should give.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pairs {
    /// Numbers of an input.
    pub inputs: usize,
    /// Numbers of an output.
    pub outputs: usize,
    /// `(rows, inputs)` row major.
    pub x: Vec<f32>,
    /// `(rows, outputs)` row major.
    pub y: Vec<f32>,
}

impl Pairs {
    /// Rows.
    pub fn len(&self) -> usize {
        self.x.len() / self.inputs.max(1)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Row by row.
    pub fn iter(&self) -> impl Iterator<Item = (&[f32], &[f32])> {
        let outputs = self.y.chunks_exact(self.outputs.max(1));
        self.x.chunks_exact(self.inputs.max(1)).zip(outputs)
    }
}

impl Probe {
    /// W and b by least squares on `fit`, R_p on `held_out`. None with fewer beliefs than latents.
    pub fn fit(fit: &Positions, held_out: &Positions) -> Option<Self> {
        let pairs = Pairs {
            inputs: fit.beliefs.latent,
            outputs: 2,
            x: fit.beliefs.mean.clone(),
            y: fit.truth.as_flattened().to_vec(),
        };
        let Linear { weight, bias } = Linear::fit(&pairs)?;
        let mut probe = Self {
            weights: weight,
            bias: [bias[0], bias[1]],
            residual: [0.0; 3],
        };
        probe.residual = probe.unexplained(held_out);
        Some(probe)
    }

    /// R_p on `held_out`.
    fn unexplained(&self, held_out: &Positions) -> [f32; 3] {
        let mut sum = Matrix2::<f64>::zeros();
        for (i, truth) in held_out.truth.iter().enumerate() {
            let (mean, log_var) = held_out.beliefs.row(i);
            let p = self.position(mean);
            let e = [f64::from(truth[0] - p[0]), f64::from(truth[1] - p[1])];
            let spread = self.spread(log_var).map(f64::from);
            sum += Matrix2::new(e[0] * e[0], e[0] * e[1], e[0] * e[1], e[1] * e[1]);
            sum -= Matrix2::new(spread[0], spread[1], spread[1], spread[2]);
        }
        let eigen = SymmetricEigen::new(sum / held_out.truth.len().max(1) as f64);
        let values = eigen.eigenvalues.map(|value| value.max(0.0));
        let r =
            eigen.eigenvectors * Matrix2::from_diagonal(&values) * eigen.eigenvectors.transpose();
        [r[(0, 0)] as f32, r[(0, 1)] as f32, r[(1, 1)] as f32]
    }

    /// p̂ in metres for a belief's mean.
    pub fn position(&self, mean: &[f32]) -> [f32; 2] {
        let latent = mean.len();
        let axis = |k: usize| {
            self.weights[k * latent..(k + 1) * latent]
                .iter()
                .zip(mean)
                .map(|(w, m)| w * m)
                .sum::<f32>()
                + self.bias[k]
        };
        [axis(0), axis(1)]
    }

    /// P as xx, xy, yy in square metres for a belief's log-variances.
    pub fn covariance(&self, log_var: &[f32]) -> [f32; 3] {
        let spread = self.spread(log_var);
        std::array::from_fn(|i| spread[i] + self.residual[i])
    }

    /// `W Σ Wᵀ`.
    fn spread(&self, log_var: &[f32]) -> [f32; 3] {
        let (x, y) = self.weights.split_at(log_var.len());
        let mut out = [0.0; 3];
        for ((x, y), log_var) in x.iter().zip(y).zip(log_var) {
            let variance = log_var.exp();
            out[0] += x * x * variance;
            out[1] += x * y * variance;
            out[2] += y * y * variance;
        }
        out
    }

    /// Writes it as safetensors, and regressors beside it where there are any.
    pub fn write(
        &self,
        path: &Path,
        regressors: Option<&Regressors>,
    ) -> Result<(), CheckpointError> {
        let refuse = |error: candle_core::Error| CheckpointError::weights(path)(error.to_string());
        let tensor = |numbers: &[f32], shape: &[usize]| {
            Tensor::from_slice(numbers, shape, &Device::Cpu).map_err(refuse)
        };
        let latent = self.weights.len() / 2;
        let mut tensors = vec![
            (
                "linear.weight".to_owned(),
                tensor(&self.weights, &[2, latent])?,
            ),
            ("linear.bias".to_owned(), tensor(&self.bias, &[2])?),
            (
                "residual_covariance".to_owned(),
                tensor(&self.residual, &[3])?,
            ),
        ];
        if let Some(regressors) = regressors {
            tensors.extend(regressors.tensors().map_err(refuse)?);
        }
        write_tensors(path, tensors, None)
    }

    /// Takes what [`Self::write`] wrote to `path`, for a model of `latent` dimensions.
    pub fn parse(path: &Path, bytes: &[u8], latent: usize) -> Result<Self, CheckpointError> {
        let tensors = parse_tensors(path, bytes)?;
        let numbers = |name: &str, len: usize| numbers(&tensors, path, name, len);
        let weights = numbers("linear.weight", 2 * latent)?;
        let bias = numbers("linear.bias", 2)?;
        let residual = numbers("residual_covariance", 3)?;
        Ok(Self {
            weights,
            bias: [bias[0], bias[1]],
            residual: [residual[0], residual[1], residual[2]],
        })
    }
}

/// The numbers of the tensor of that name, `len` of them and all finite.
fn numbers(
    tensors: &HashMap<String, Tensor>,
    path: &Path,
    name: &str,
    len: usize,
) -> Result<Vec<f32>, CheckpointError> {
    let refuse = CheckpointError::weights(path);
    let tensor = tensors
        .get(name)
        .ok_or_else(|| refuse(format!("tensor `{name}` is missing")))?;
    let flat = tensor
        .to_dtype(DType::F32)
        .and_then(|t| t.flatten_all())
        .and_then(|t| t.to_vec1::<f32>());
    let flat = flat.map_err(|error| refuse(first_line(&error)))?;
    if flat.len() == len && flat.iter().all(|v| v.is_finite()) {
        Ok(flat)
    } else {
        Err(refuse(format!(
            "tensor `{name}` must have {len} finite numbers, has {}",
            flat.len()
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_world_is_found_again() {
        let latent = 4;
        let mut positions = Positions {
            beliefs: GaussianTrace {
                latent,
                ..Default::default()
            },
            truth: Vec::new(),
        };
        for i in 0..200 {
            let z: Vec<f32> = (0..latent)
                .map(|d| ((i * (d + 3)) as f32 * 0.37).sin())
                .collect();
            positions
                .truth
                .push([0.3 * z[0] - 0.1 * z[2] + 0.5, 0.2 * z[1] + 0.05 * z[3]]);
            positions.beliefs.log_var.extend(vec![-20.0; latent]);
            positions.beliefs.mean.extend(z);
        }
        let probe = Probe::fit(&positions, &positions).expect("enough beliefs");
        let p = probe.position(&[1.0, 1.0, 0.0, 1.0]);
        assert!(
            (p[0] - 0.8).abs() < 1e-3 && (p[1] - 0.25).abs() < 1e-3,
            "{p:?}"
        );
        assert!(probe.residual.iter().all(|r| r.abs() < 1e-6));
    }
}
