//! Least squares: `y = W x + b`.

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::Pairs;

/// An affine map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Linear {
    /// W, `(outputs, inputs)` row major.
    pub weight: Vec<f32>,
    /// b, one an output.
    pub bias: Vec<f32>,
}

impl Linear {
    /// The map of least squared error. None with fewer pairs than inputs, or where the numbers admit none.
    pub fn fit(pairs: &Pairs) -> Option<Self> {
        let Pairs {
            inputs, outputs, ..
        } = *pairs;
        let rows = pairs.len();
        if rows <= inputs {
            return None;
        }
        let mut normal = DMatrix::<f64>::zeros(inputs + 1, inputs + 1);
        let mut right = DMatrix::<f64>::zeros(inputs + 1, outputs);
        for (x, y) in pairs.iter() {
            let features = || x.iter().map(|&m| f64::from(m)).chain([1.0]);
            for (r, a) in features().enumerate() {
                for (c, b) in features().enumerate() {
                    normal[(r, c)] += a * b;
                }
                for (k, &y) in y.iter().enumerate() {
                    right[(r, k)] += a * f64::from(y);
                }
            }
        }
        // Inputs that never move leave the normal equations singular; a ridge far below any signal settles them.
        for i in 0..=inputs {
            normal[(i, i)] += 1e-6 * rows as f64;
        }
        let solution = normal.cholesky()?.solve(&right);
        let weight = (0..outputs)
            .flat_map(|k| (0..inputs).map(move |d| (d, k)))
            .map(|at| solution[at] as f32)
            .collect();
        let bias = (0..outputs).map(|k| solution[(inputs, k)] as f32).collect();
        Some(Self { weight, bias })
    }

    /// `W x + b`.
    pub fn read(&self, x: &[f32]) -> Vec<f32> {
        self.weight
            .chunks_exact(x.len().max(1))
            .zip(&self.bias)
            .map(|(row, b)| row.iter().zip(x).map(|(w, x)| w * x).sum::<f32>() + b)
            .collect()
    }
}
