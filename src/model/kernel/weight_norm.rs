//! Weight norm, trainable: `w = g v / ‖v‖`, as one op over the flat parameters of a network.

use candle_core::{CpuStorage, CustomOp1, Layout, Result, Shape, Tensor, bail};
use rayon::prelude::*;

use super::chain::cpu;
use super::values;

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

/// Σ over outer and inner of `a * b`, for each norm.
fn dots(a: &[f32], b: &[f32], norms: usize, inner: usize) -> Vec<f32> {
    let mut sums = vec![0.0_f64; norms];
    for (a, b) in a
        .chunks_exact(norms * inner)
        .zip(b.chunks_exact(norms * inner))
    {
        for ((a, b), sum) in a
            .chunks_exact(inner)
            .zip(b.chunks_exact(inner))
            .zip(&mut sums)
        {
            if inner == 1 {
                *sum += f64::from(a[0] * b[0]);
            } else {
                *sum += f64::from(dot(a, b));
            }
        }
    }
    sums.into_iter().map(|sum| sum as f32).collect()
}

/// A dot product in sixteen lanes.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    super::arch().dispatch(
        #[inline(always)]
        || {
            let mut lanes = [0.0_f32; 16];
            for (a, b) in a.chunks(16).zip(b.chunks(16)) {
                for ((lane, &a), &b) in lanes.iter_mut().zip(a).zip(b) {
                    *lane += a * b;
                }
            }
            lanes.iter().sum()
        },
    )
}

/// Calls `row(norm index, v, out)` for each run of `inner` numbers.
fn rows(
    v: &[f32],
    out: &mut [f32],
    norms: usize,
    inner: usize,
    row: impl Fn(usize, &[f32], &mut [f32]) + Sync,
) {
    let runs_per_task = (1 << 14) / inner + 1;
    out.par_chunks_mut(runs_per_task * inner)
        .zip(v.par_chunks(runs_per_task * inner))
        .enumerate()
        .for_each(|(task, (out, v))| {
            for (run, (out, v)) in out
                .chunks_exact_mut(inner)
                .zip(v.chunks_exact(inner))
                .enumerate()
            {
                row((task * runs_per_task + run) % norms, v, out);
            }
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
                    rows(v, target, norms, inner, |norm, v, out| {
                        for (o, v) in out.iter_mut().zip(v) {
                            *o = v * scale[norm];
                        }
                    });
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
                    rows(v, dv, norms, inner, |norm, v, dv| {
                        for (d, v) in dv.iter_mut().zip(v) {
                            *d = scale[norm] * (*d - v * part[norm]);
                        }
                    });
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
