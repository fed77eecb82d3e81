//! The paper's other regressor: a network with one hidden layer of 50.

use candle_core::{DType, Device, Result, Tensor, Var};
use candle_nn::{AdamW, Optimizer, ParamsAdamW};
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use super::{Linear, Pairs};

/// Units of the hidden layer (the paper's).
pub const UNITS: usize = 50;
/// Pairs of an update.
const BATCH: usize = 256;
/// So often each pair is seen, within the bounds below.
const EPOCHS: usize = 200;
/// Updates at least and at most; the rate falls along a cosine to nothing over them.
const UPDATES: [usize; 2] = [1500, 4000];
/// Adam's rate at the beginning.
const RATE: f64 = 3e-3;

/// `W₂ relu(W₁ x + b₁) + b₂`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hidden {
    /// W₁ and b₁.
    pub first: Linear,
    /// W₂ and b₂.
    pub second: Linear,
}

/// Mean and deviation of each column of `(rows, columns)`, for scaling; a column that does not move has deviation 1.
fn moments(numbers: &[f32], columns: usize) -> Vec<(f32, f32)> {
    let rows = (numbers.len() / columns.max(1)) as f64;
    (0..columns)
        .map(|k| {
            let column = || {
                numbers
                    .iter()
                    .skip(k)
                    .step_by(columns)
                    .map(|&x| f64::from(x))
            };
            let mean = column().sum::<f64>() / rows;
            let variance = column().map(|x| (x - mean).powi(2)).sum::<f64>() / rows;
            let deviation = variance.sqrt();
            (
                mean as f32,
                if deviation > 1e-9 {
                    deviation as f32
                } else {
                    1.0
                },
            )
        })
        .collect()
}

/// Columns at mean 0 and deviation 1.
fn scaled(numbers: &[f32], moments: &[(f32, f32)]) -> Vec<f32> {
    let scales = moments.iter().cycle();
    numbers
        .iter()
        .zip(scales)
        .map(|(x, (m, s))| (x - m) / s)
        .collect()
}

impl Hidden {
    /// Fits it by Adam to the mean squared error of scaled outputs; a seed gives the same network. None with fewer pairs
    /// than inputs.
    pub fn fit(pairs: &Pairs, seed: u64) -> Result<Option<Self>> {
        let Pairs {
            inputs, outputs, ..
        } = *pairs;
        if pairs.len() <= inputs {
            return Ok(None);
        }
        let (from, to) = (moments(&pairs.x, inputs), moments(&pairs.y, outputs));
        let shape = |columns| (pairs.len(), columns);
        let x = Tensor::from_vec(scaled(&pairs.x, &from), shape(inputs), &Device::Cpu)?;
        let y = Tensor::from_vec(scaled(&pairs.y, &to), shape(outputs), &Device::Cpu)?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut drawn = |rows: usize, columns: usize| {
            let most = 1.0 / (columns as f32).sqrt();
            let draw = (0..rows * columns)
                .map(|_| rng.random_range(-most..most))
                .collect();
            Var::from_tensor(&Tensor::from_vec(draw, (rows, columns), &Device::Cpu)?)
        };
        let (w1, w2) = (drawn(UNITS, inputs)?, drawn(outputs, UNITS)?);
        let zeros = |n| Var::zeros((1, n), DType::F32, &Device::Cpu);
        let (b1, b2) = (zeros(UNITS)?, zeros(outputs)?);
        let params = ParamsAdamW {
            lr: RATE,
            weight_decay: 0.0,
            ..ParamsAdamW::default()
        };
        let vars = [&w1, &b1, &w2, &b2].map(Clone::clone).to_vec();
        let mut adam = AdamW::new(vars, params)?;
        let mut order: Vec<u32> = (0..pairs.len() as u32).collect();
        let mut next = order.len();
        let [least, most] = UPDATES;
        let updates = (EPOCHS * pairs.len() / BATCH).clamp(least, most);
        for update in 0..updates {
            if next + BATCH > order.len() {
                order.shuffle(&mut rng);
                next = 0;
            }
            let batch = &order[next..order.len().min(next + BATCH)];
            next += BATCH;
            let rows = Tensor::new(batch, &Device::Cpu)?;
            let (x, y) = (x.index_select(&rows, 0)?, y.index_select(&rows, 0)?);
            let hidden = x.matmul(&w1.t()?)?.broadcast_add(&b1)?.relu()?;
            let read = hidden.matmul(&w2.t()?)?.broadcast_add(&b2)?;
            let part = update as f64 / updates as f64;
            adam.set_learning_rate(RATE * 0.5 * (1.0 + (std::f64::consts::PI * part).cos()));
            adam.backward_step(&(read - y)?.sqr()?.mean_all()?)?;
        }
        let numbers = |var: &Var| var.flatten_all()?.to_vec1::<f32>();
        // The scales go into the layers: the network reads plain latents and says plain metres.
        let mut first = Linear {
            weight: numbers(&w1)?,
            bias: numbers(&b1)?,
        };
        for (row, bias) in first.weight.chunks_exact_mut(inputs).zip(&mut first.bias) {
            for (w, (mean, deviation)) in row.iter_mut().zip(&from) {
                *w /= deviation;
                *bias -= *w * mean;
            }
        }
        let mut second = Linear {
            weight: numbers(&w2)?,
            bias: numbers(&b2)?,
        };
        let rows = second.weight.chunks_exact_mut(UNITS).zip(&mut second.bias);
        for ((row, bias), (mean, deviation)) in rows.zip(&to) {
            for w in row {
                *w *= deviation;
            }
            *bias = *bias * deviation + mean;
        }
        Ok(Some(Self { first, second }))
    }

    /// What it says of `x`.
    pub fn read(&self, x: &[f32]) -> Vec<f32> {
        let mut hidden = self.first.read(x);
        for h in &mut hidden {
            *h = h.max(0.0);
        }
        self.second.read(&hidden)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_line_fits_the_network_does() -> Result<()> {
        let x: Vec<f32> = (0..1200)
            .map(|i| (i as f32 * 0.61).sin() * 2.0 + 5.0)
            .collect();
        // A fold, in centimetres: a line cannot follow it.
        let y = x
            .chunks_exact(2)
            .map(|p| 0.03 * (p[0] - 5.0).abs() - 0.01 * p[1])
            .collect();
        let pairs = Pairs {
            inputs: 2,
            outputs: 1,
            x,
            y,
        };
        let rms = |read: &dyn Fn(&[f32]) -> f32| -> f32 {
            let squares = pairs.iter().map(|(x, y)| (read(x) - y[0]).powi(2));
            (squares.sum::<f32>() / pairs.len() as f32).sqrt()
        };
        let network = Hidden::fit(&pairs, 1)?.expect("enough pairs");
        let line = Linear::fit(&pairs).expect("enough pairs");
        assert!(
            rms(&|x| network.read(x)[0]) < 1e-3,
            "{}",
            rms(&|x| network.read(x)[0])
        );
        assert!(rms(&|x| line.read(x)[0]) > 1e-2);
        assert_eq!(Hidden::fit(&pairs, 1)?.as_ref(), Some(&network), "a seed");
        assert_eq!(
            Hidden::fit(
                &Pairs {
                    x: vec![0.0; 4],
                    y: vec![0.0; 2],
                    ..pairs
                },
                1
            )?,
            None
        );
        Ok(())
    }
}
