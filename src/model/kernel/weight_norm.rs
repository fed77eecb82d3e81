//! Weight norm, trainable: `w = g v / ‖v‖`, as one op over the flat parameters of a network.

use candle_core::{CpuStorage, CustomOp1, Layout, Result, Shape, Tensor, bail};
use rayon::prelude::*;

use super::chain::cpu;
use super::{values, vectorised};

/// One stretch of a network's flat parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stretch {
    /// `g` (norms) then `v` (outer, norms, inner): the norm is over outer and inner. Becomes `w`, shaped as `v`.
    Normed {
        /// Axes of `v` before the normed one.
        outer: usize,
        /// How many norms.
        norms: usize,
        /// Axes of `v` after it.
        inner: usize,
    },
    /// Taken as it is: a bias, a recurrent weight.
    Plain(usize),
}

impl Stretch {
    /// Numbers that are trained.
    pub fn trained(self) -> usize {
        match self {
            Self::Normed {
                outer,
                norms,
                inner,
            } => norms + outer * norms * inner,
            Self::Plain(len) => len,
        }
    }

    /// Numbers that the layers see.
    pub fn folded(self) -> usize {
        match self {
            Self::Normed {
                outer,
                norms,
                inner,
            } => outer * norms * inner,
            Self::Plain(len) => len,
        }
    }
}

/// Trained parameters (g, v, biases) to the weights that layers compute with.
#[derive(Clone, Debug)]
pub struct WeightNorm {
    /// The stretches in order; trained and folded parameters have the same order.
    pub stretches: Vec<Stretch>,
}

/// Numbers of a parallel task.
const TASK: usize = 1 << 15;

/// Σ over outer and inner of `a * b`, for each norm.
fn dots(a: &[f32], b: &[f32], norms: usize, inner: usize) -> Vec<f32> {
    if inner == 1 {
        return columns(a, b, norms);
    }
    // A run of `inner` numbers belongs to one norm; runs are summed in parallel, then over outer in order.
    let runs: Vec<f32> = a
        .par_chunks(inner)
        .zip(b.par_chunks(inner))
        .with_min_len(TASK / inner + 1)
        .map(|(a, b)| dot(a, b))
        .collect();
    let mut sums = vec![0.0_f64; norms];
    for run in runs.chunks_exact(norms) {
        for (sum, &run) in sums.iter_mut().zip(run) {
            *sum += f64::from(run);
        }
    }
    sums.into_iter().map(|sum| sum as f32).collect()
}

/// Sums of the columns of `a * b`, rows of `norms`: in parallel tasks of rows, added in order.
fn columns(a: &[f32], b: &[f32], norms: usize) -> Vec<f32> {
    let task = (TASK / norms + 1) * norms;
    let parts: Vec<Vec<f64>> = a
        .par_chunks(task)
        .zip(b.par_chunks(task))
        .map(|(a, b)| {
            let mut sums = vec![0.0_f64; norms];
            vectorised(
                #[inline(always)]
                || {
                    for (a, b) in a.chunks_exact(norms).zip(b.chunks_exact(norms)) {
                        for ((sum, &a), &b) in sums.iter_mut().zip(a).zip(b) {
                            *sum += f64::from(a * b);
                        }
                    }
                },
            );
            sums
        })
        .collect();
    (0..norms)
        .map(|norm| parts.iter().map(|part| part[norm]).sum::<f64>() as f32)
        .collect()
}

/// A dot product in sixty-four lanes.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    vectorised(
        #[inline(always)]
        || {
            let mut lanes = [0.0_f32; 64];
            let (a, a_rest) = a.as_chunks::<64>();
            let (b, b_rest) = b.as_chunks::<64>();
            for (a, b) in a.iter().zip(b) {
                for i in 0..64 {
                    lanes[i] += a[i] * b[i];
                }
            }
            for (lane, (a, b)) in lanes.iter_mut().zip(a_rest.iter().zip(b_rest)) {
                *lane += a * b;
            }
            lanes.iter().sum()
        },
    )
}

/// Calls `place(v, out, norm)` for every number, vectorised, in parallel. `per_norm` has two numbers a norm.
fn scaled(
    v: &[f32],
    out: &mut [f32],
    (norms, inner): (usize, usize),
    per_norm: (&[f32], &[f32]),
    place: impl Fn(f32, &mut f32, f32, f32) + Sync,
) {
    // Whole rows of norms where a number each, else whole runs of a norm.
    let unit = if inner == 1 { norms } else { inner };
    let units = TASK / unit + 1;
    out.par_chunks_mut(units * unit)
        .zip(v.par_chunks(units * unit))
        .enumerate()
        .for_each(|(task, (out, v))| {
            vectorised(
                #[inline(always)]
                || {
                    let lines = out.chunks_exact_mut(unit).zip(v.chunks_exact(unit));
                    for (i, (out, v)) in lines.enumerate() {
                        if inner == 1 {
                            let factors = per_norm.0.iter().zip(per_norm.1);
                            for ((out, &v), (&a, &b)) in out.iter_mut().zip(v).zip(factors) {
                                place(v, out, a, b);
                            }
                        } else {
                            let norm = (task * units + i) % norms;
                            let (a, b) = (per_norm.0[norm], per_norm.1[norm]);
                            for (out, &v) in out.iter_mut().zip(v) {
                                place(v, out, a, b);
                            }
                        }
                    }
                },
            );
        });
}

impl WeightNorm {
    /// Numbers that are trained.
    pub fn trained(&self) -> usize {
        self.stretches.iter().map(|stretch| stretch.trained()).sum()
    }

    /// Numbers that the layers see.
    pub fn folded(&self) -> usize {
        self.stretches.iter().map(|stretch| stretch.folded()).sum()
    }

    fn fold(&self, mut theta: &[f32]) -> Vec<f32> {
        let mut weights = vec![0.0; self.folded()];
        let mut out = &mut weights[..];
        for stretch in &self.stretches {
            let (here, rest) = theta.split_at(stretch.trained());
            let (target, after) = std::mem::take(&mut out).split_at_mut(stretch.folded());
            match *stretch {
                Stretch::Plain(_) => target.copy_from_slice(here),
                Stretch::Normed { norms, inner, .. } => {
                    let (g, v) = here.split_at(norms);
                    let scale: Vec<f32> = dots(v, v, norms, inner)
                        .iter()
                        .zip(g)
                        .map(|(s, g)| g / s.sqrt())
                        .collect();
                    scaled(
                        v,
                        target,
                        (norms, inner),
                        (&scale, &scale),
                        #[inline(always)]
                        |v, out, scale, _| *out = v * scale,
                    );
                }
            }
            (theta, out) = (rest, after);
        }
        weights
    }

    /// `dg = (dw · v) / ‖v‖`, `dv = g / ‖v‖ (dw − v (dw · v) / ‖v‖²)`.
    fn unfold(&self, mut theta: &[f32], mut dw: &[f32]) -> Vec<f32> {
        let mut gradient = vec![0.0; self.trained()];
        let mut out = &mut gradient[..];
        for stretch in &self.stretches {
            let (here, rest) = theta.split_at(stretch.trained());
            let (dw_here, dw_rest) = dw.split_at(stretch.folded());
            let (target, after) = std::mem::take(&mut out).split_at_mut(stretch.trained());
            match *stretch {
                Stretch::Plain(_) => target.copy_from_slice(dw_here),
                Stretch::Normed { norms, inner, .. } => {
                    let (g, v) = here.split_at(norms);
                    let (dg, dv) = target.split_at_mut(norms);
                    let squares = dots(v, v, norms, inner);
                    let along = dots(dw_here, v, norms, inner);
                    let scale: Vec<f32> =
                        g.iter().zip(&squares).map(|(g, s)| g / s.sqrt()).collect();
                    let part: Vec<f32> = along.iter().zip(&squares).map(|(a, s)| a / s).collect();
                    for ((dg, a), s) in dg.iter_mut().zip(&along).zip(&squares) {
                        *dg = a / s.sqrt();
                    }
                    dv.copy_from_slice(dw_here);
                    scaled(
                        v,
                        dv,
                        (norms, inner),
                        (&scale, &part),
                        #[inline(always)]
                        |v, d, scale, part| *d = scale * (*d - v * part),
                    );
                }
            }
            (theta, dw, out) = (rest, dw_rest, after);
        }
        gradient
    }
}

impl CustomOp1 for WeightNorm {
    fn name(&self) -> &'static str {
        "weight-norm"
    }

    fn cpu_fwd(&self, theta: &CpuStorage, layout: &Layout) -> Result<(CpuStorage, Shape)> {
        let theta = values(theta, layout)?;
        if theta.len() != self.trained() {
            bail!(
                "weight norm of {} parameters got {}",
                self.trained(),
                theta.len()
            );
        }
        Ok((
            CpuStorage::F32(self.fold(theta)),
            Shape::from(self.folded()),
        ))
    }

    fn bwd(&self, theta: &Tensor, _weights: &Tensor, dw: &Tensor) -> Result<Option<Tensor>> {
        let dw = dw.contiguous()?;
        let (theta_guard, theta_layout) = theta.storage_and_layout();
        let (dw_guard, dw_layout) = dw.storage_and_layout();
        let gradient = self.unfold(cpu(&theta_guard, theta_layout)?, cpu(&dw_guard, dw_layout)?);
        Ok(Some(Tensor::from_vec(
            gradient,
            theta.shape(),
            theta.device(),
        )?))
    }
}
