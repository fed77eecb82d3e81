//! A cell run over whole sequences as one op: at each step what the cell states is multiplied with the Gaussians of
//! other experts, and the product, or a sample of it, goes in at the next.
//!
//! With experts `(μᵢ, σᵢ²)` and factors αᵢ: precision `τ = Σ αᵢ / σᵢ²`, mean `Σ αᵢ μᵢ / σᵢ² / τ`, log-variance
//! `log(1 / τ + 10⁻⁸)`. Sequences are independent, and have the same bits alone and in a batch.

pub mod alone;
mod backward;
mod forward;

use std::ops::Range;
use std::sync::Mutex;

use candle_core::{CpuStorage, CustomOp2, Layout, Result, Shape, Tensor, bail};
use rayon::prelude::*;

use self::forward::Run;
use super::cell::backward::{Transposes, weights};
use super::cell::{Sizes, mixed};
use super::chain::{cpu, part_size};
use super::values;
use crate::lock::lock;

/// Fewer sequences than this are not worth a second thread.
const SEQUENCES_APART: usize = 8;
/// What the logarithm of a variance is taken of has this much more.
const EPSILON: f32 = 1e-8;

/// What B sequences of T steps run on.
#[derive(Clone, Debug)]
pub struct Inputs<'a> {
    /// T.
    pub steps: usize,
    /// Means and log-variances of each of M experts, `(B, T, Z)`; or `(T, Z)`, the same for every sequence.
    pub experts: Vec<(&'a [f32], &'a [f32])>,
    /// The factor of each expert, the cell's own last, `(B, T, M + 1)`.
    pub alphas: &'a [f32],
    /// What goes in beside the latent, `(B, T - 1, U)`; or `(T - 1, U)`, the same for every sequence.
    pub controls: &'a [f32],
    /// N(0, I) noise `(B, T, Z)` for samples; without it means go in.
    pub noise: Option<&'a [f32]>,
    /// Log-variance of the first prior; its mean is zero.
    pub first_log_var: f32,
}

/// Where the parts of a step's output row lie.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    latent: usize,
    hidden: usize,
}

impl Row {
    /// Of a cell.
    pub fn of(sizes: Sizes) -> Self {
        Self {
            latent: sizes.latent,
            hidden: sizes.hidden,
        }
    }

    /// Starts and lengths: prior mean and log-variance, posterior mean and log-variance, what went on, hidden state.
    pub fn parts(self) -> [(usize, usize); 6] {
        let z = self.latent;
        [
            (0, z),
            (z, z),
            (2 * z, z),
            (3 * z, z),
            (4 * z, z),
            (5 * z, self.hidden),
        ]
    }

    /// Numbers of a row.
    pub fn width(self) -> usize {
        5 * self.latent + self.hidden
    }

    /// The parts of all `rows`, each on its own.
    pub fn columns(self, rows: &[f32]) -> [Vec<f32>; 6] {
        self.parts().map(|(start, len)| {
            rows.chunks_exact(self.width())
                .flat_map(|row| row[start..start + len].iter().copied())
                .collect()
        })
    }

    /// The parts of one row.
    fn split(self, row: &[f32]) -> [&[f32]; 6] {
        self.parts().map(|(start, len)| &row[start..start + len])
    }
}

impl<'a> Inputs<'a> {
    /// B.
    fn sequences(&self) -> usize {
        self.alphas.len() / (self.steps * (self.experts.len() + 1))
    }

    fn check(&self, sizes: Sizes, weights: &[f32]) -> Result<()> {
        if self.steps == 0 {
            bail!("a recurrence of no steps");
        }
        let (batch, steps) = (self.sequences(), self.steps);
        let control = sizes.inputs - sizes.latent;
        let fits = |len: usize, each: usize| len == each || len == batch * each;
        let each = steps * sizes.latent;
        let good = self
            .experts
            .iter()
            .all(|(mean, log_var)| fits(mean.len(), each) && fits(log_var.len(), each))
            && self.alphas.len() == batch * steps * (self.experts.len() + 1)
            && fits(self.controls.len(), (steps - 1) * control)
            && self.noise.is_none_or(|noise| noise.len() == batch * each)
            && weights.len() == sizes.parameters();
        if !good {
            bail!("a recurrence of {sizes:?} over {steps} steps got inputs of other sizes");
        }
        Ok(())
    }

    /// The same of some sequences.
    fn part(&self, sizes: Sizes, range: &Range<usize>) -> Self {
        let of = |whole: &'a [f32], each: usize| {
            if whole.len() == each {
                whole
            } else {
                &whole[range.start * each..range.end * each]
            }
        };
        let latents = self.steps * sizes.latent;
        let switches = self.steps * (self.experts.len() + 1);
        Self {
            experts: self
                .experts
                .iter()
                .map(|(mean, log_var)| (of(mean, latents), of(log_var, latents)))
                .collect(),
            alphas: &self.alphas[range.start * switches..range.end * switches],
            controls: of(
                self.controls,
                (self.steps - 1) * (sizes.inputs - sizes.latent),
            ),
            noise: self.noise.map(|noise| of(noise, latents)),
            ..*self
        }
    }
}

/// The sequences of each parallel task.
fn apart(sequences: usize) -> impl IndexedParallelIterator<Item = Range<usize>> {
    let size = if sequences < SEQUENCES_APART {
        sequences.max(1)
    } else {
        part_size(sequences)
    };
    (0..sequences.div_ceil(size))
        .into_par_iter()
        .map(move |i| i * size..((i + 1) * size).min(sequences))
}

/// Runs sequences without a gradient: a [`Row`] a step, `(B, T, row)`.
pub fn run(sizes: Sizes, weights: &[f32], inputs: &Inputs) -> Result<Vec<f32>> {
    inputs.check(sizes, weights)?;
    Ok(run_parts(sizes, weights, inputs, false).0)
}

/// A of the steps that led to `states (n, hidden)`, their gates frozen: `(n, Z, Z)` row major.
pub fn transitions(sizes: Sizes, weights: &[f32], states: &[f32]) -> Result<Vec<f32>> {
    if weights.len() != sizes.parameters() || !states.len().is_multiple_of(sizes.hidden) {
        bail!("transitions of {sizes:?} got states or weights of another size");
    }
    Ok(mixed::matrices_of(sizes, &sizes.weights(weights), states))
}

fn run_parts(sizes: Sizes, weights: &[f32], inputs: &Inputs, keep: bool) -> (Vec<f32>, Vec<Run>) {
    let w = sizes.weights(weights);
    let width = inputs.steps * Row::of(sizes).width();
    let mut out = vec![0.0; inputs.sequences() * width];
    let each = apart(inputs.sequences());
    let size = inputs.sequences().div_ceil(each.len().max(1)).max(1);
    let runs = each
        .zip(out.par_chunks_mut(size * width))
        .map(|(range, out)| Run::of(sizes, &w, &inputs.part(sizes, &range), keep, out))
        .collect();
    (out, runs)
}

/// Experts' means and log-variances in turn `(2 M, B, T, Z)` and flat weights to a [`Row`] a step, `(B, T, row)`.
pub struct Recurrence {
    /// Of the cell.
    pub sizes: Sizes,
    /// As in [`Inputs`].
    pub alphas: Vec<f32>,
    /// As in [`Inputs`].
    pub controls: Vec<f32>,
    /// As in [`Inputs`].
    pub noise: Option<Vec<f32>>,
    /// As in [`Inputs`].
    pub first_log_var: f32,
    /// What the backward pass needs.
    pub kept: Kept,
}

/// What a forward pass leaves for the backward one.
#[derive(Default)]
pub struct Kept(Mutex<Vec<Run>>);

impl Recurrence {
    /// The inputs with `experts` as the op gets them.
    fn inputs<'a>(&'a self, experts: &'a [f32], steps: usize, count: usize) -> Inputs<'a> {
        let each = experts.len() / (2 * count).max(1);
        Inputs {
            steps,
            experts: experts
                .chunks_exact(2 * each)
                .map(|pair| pair.split_at(each))
                .collect(),
            alphas: &self.alphas,
            controls: &self.controls,
            noise: self.noise.as_deref(),
            first_log_var: self.first_log_var,
        }
    }
}

impl CustomOp2 for Recurrence {
    fn name(&self) -> &'static str {
        "recurrence"
    }

    fn cpu_fwd(
        &self,
        experts: &CpuStorage,
        layout: &Layout,
        w: &CpuStorage,
        w_layout: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let (twice, batch, steps, _) = layout.shape().dims4()?;
        let inputs = self.inputs(values(experts, layout)?, steps, twice / 2);
        let w = values(w, w_layout)?;
        inputs.check(self.sizes, w)?;
        let (out, runs) = run_parts(self.sizes, w, &inputs, true);
        *lock(&self.kept.0) = runs;
        let shape = Shape::from((batch, steps, Row::of(self.sizes).width()));
        Ok((CpuStorage::F32(out), shape))
    }

    fn bwd(
        &self,
        experts: &Tensor,
        w: &Tensor,
        out: &Tensor,
        dout: &Tensor,
    ) -> Result<(Option<Tensor>, Option<Tensor>)> {
        let sizes = self.sizes;
        let (twice, _, steps, _) = experts.dims4()?;
        let dout = dout.contiguous()?;
        let guards = [experts, w, out, &dout].map(|tensor| tensor.storage_and_layout());
        let [experts_values, w_values, out_values, dout_values] =
            guards.each_ref().map(|(guard, layout)| cpu(guard, layout));
        let inputs = self.inputs(experts_values?, steps, twice / 2);
        let (out_values, dout_values, w_parts) =
            (out_values?, dout_values?, sizes.weights(w_values?));
        let across = Transposes::of(sizes, &w_parts);
        let mut runs = lock(&self.kept.0);
        let each = apart(inputs.sequences());
        let width = inputs.sequences().div_ceil(each.len().max(1)) * steps * Row::of(sizes).width();
        let back: Vec<_> = each
            .zip(runs.par_iter_mut())
            .zip(out_values.par_chunks(width))
            .zip(dout_values.par_chunks(width))
            .map(|(((range, run), out), dout)| {
                let inputs = inputs.part(sizes, &range);
                backward::through(sizes, (&w_parts, &across), &inputs, run, out, dout)
            })
            .collect();
        let (mut dexperts, mut pulls) = (vec![Vec::new(); twice], Vec::new());
        for (part, pull) in back {
            for (whole, part) in dexperts.iter_mut().zip(part) {
                whole.extend(part);
            }
            pulls.push(pull);
        }
        let rows: Vec<_> = runs
            .iter()
            .zip(&pulls)
            .map(|(run, pull)| run.rows(sizes, pull))
            .collect();
        let dw = weights(sizes, &rows);
        Ok((
            Some(Tensor::from_vec(
                dexperts.concat(),
                experts.shape(),
                experts.device(),
            )?),
            Some(Tensor::from_vec(dw, w.shape(), w.device())?),
        ))
    }
}
