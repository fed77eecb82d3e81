//! Element-wise functions and their derivatives, vectorised without fused multiply-add so that every instruction set
//! gives the same bits.

use serde::{Deserialize, Serialize};

use super::vectorised;

/// A nonlinearity after a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Activation {
    /// None.
    Linear,
    /// `x` above zero, `exp(x) - 1` below (the released script).
    Elu,
    /// `max(x, 0)` (the paper).
    Relu,
    /// `1 / (1 + exp(-x))`.
    Sigmoid,
}

/// `exp(x)` by a polynomial; relative error below 2e-7 over [-87, 88], clamped outside.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    // Adding this rounds to the nearest integer in the low bits of the mantissa.
    const ROUND: f32 = 12_582_912.0;
    // ln 2 in two parts, the first exact in few bits.
    const LN2_HIGH: f32 = 0.693_359_4;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    let x = x.clamp(-87.0, 88.0);
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = x - n * LN2_HIGH - n * LN2_LOW;
    // Cephes' coefficients of (exp(r) - 1 - r) / r² on [-ln 2 / 2, ln 2 / 2].
    let p = 1.987_569_1e-4;
    let p = p * r + 1.398_2e-3;
    let p = p * r + 8.333_452e-3;
    let p = p * r + 4.166_579_6e-2;
    let p = p * r + 1.666_666_6e-1;
    let p = p * r + 0.5;
    let y = p * r * r + r + 1.0;
    // The low bits of `shifted` are n, which saves a conversion and its checks.
    y * f32::from_bits(shifted.to_bits().wrapping_add(127) << 23)
}

/// `1 / (1 + exp(-x))`.
#[inline(always)]
pub fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + exp(-x))
}

/// The hyperbolic tangent.
#[inline(always)]
pub fn tanh(x: f32) -> f32 {
    2.0 * sigmoid(2.0 * x) - 1.0
}

impl Activation {
    /// Applies it in place.
    pub fn apply(self, x: &mut [f32]) {
        match self {
            Self::Linear => {}
            Self::Relu => vectorised(
                #[inline(always)]
                || x.iter_mut().for_each(|v| *v = v.max(0.0)),
            ),
            Self::Elu => vectorised(
                #[inline(always)]
                || {
                    for v in x.iter_mut() {
                        let below = exp(*v) - 1.0;
                        *v = if *v > 0.0 { *v } else { below };
                    }
                },
            ),
            Self::Sigmoid => vectorised(
                #[inline(always)]
                || x.iter_mut().for_each(|v| *v = sigmoid(*v)),
            ),
        }
    }

    /// Multiplies a gradient with respect to the output `y` by the derivative there, in place.
    pub fn backward(self, y: &[f32], gradient: &mut [f32]) {
        match self {
            Self::Linear => {}
            Self::Relu => vectorised(
                #[inline(always)]
                || {
                    for (g, &y) in gradient.iter_mut().zip(y) {
                        *g = if y > 0.0 { *g } else { 0.0 };
                    }
                },
            ),
            Self::Elu => vectorised(
                #[inline(always)]
                || {
                    for (g, &y) in gradient.iter_mut().zip(y) {
                        *g *= if y > 0.0 { 1.0 } else { y + 1.0 };
                    }
                },
            ),
            Self::Sigmoid => vectorised(
                #[inline(always)]
                || {
                    for (g, &y) in gradient.iter_mut().zip(y) {
                        *g *= y * (1.0 - y);
                    }
                },
            ),
        }
    }
}

/// `y += row` for every row of `y`.
pub fn add_row(y: &mut [f32], row: &[f32]) {
    vectorised(
        #[inline(always)]
        || {
            for line in y.chunks_exact_mut(row.len()) {
                for (v, &b) in line.iter_mut().zip(row) {
                    *v += b;
                }
            }
        },
    );
}

/// `row += ` the sum of the rows of `y`.
pub fn sum_rows(y: &[f32], row: &mut [f32]) {
    vectorised(
        #[inline(always)]
        || {
            for line in y.chunks_exact(row.len()) {
                for (b, &v) in row.iter_mut().zip(line) {
                    *b += v;
                }
            }
        },
    );
}

/// Σ x² in sixty-four running sums, so that the order, and the bits, are the same everywhere.
pub fn sum_of_squares(x: &[f32]) -> f32 {
    vectorised(
        #[inline(always)]
        || {
            let mut lanes = [0.0_f32; 64];
            let (chunks, rest) = x.as_chunks::<64>();
            for chunk in chunks {
                for (lane, &v) in lanes.iter_mut().zip(chunk) {
                    *lane += v * v;
                }
            }
            lanes.iter().sum::<f32>() + rest.iter().map(|v| v * v).sum::<f32>()
        },
    )
}

#[cfg(test)]
mod tests {
    use pulp::Arch;

    use super::*;

    #[test]
    fn exp_is_close_to_the_exact_one() {
        for i in -8000..8000 {
            let x = i as f32 * 0.01;
            let (ours, exact) = (f64::from(exp(x)), f64::from(x).exp());
            assert!(
                (ours / exact - 1.0).abs() < 3e-7,
                "exp({x}) = {ours}, exactly {exact}"
            );
        }
        assert!(exp(-1e9) < 1e-37 && exp(1e9).is_finite());
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let x: Vec<f32> = (0..1003).map(|i| (i as f32 - 500.0) * 0.037).collect();
        let run = |arch: Arch| {
            let mut y = x.clone();
            arch.dispatch(
                #[inline(always)]
                || y.iter_mut().for_each(|v| *v = sigmoid(*v) + exp(*v * 0.1)),
            );
            y.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(run(Arch::Scalar), run(Arch::new()));
    }
}
