//! The cell alone, on from one Gaussian: what it states goes in at the next step, or a sample of it.
//!
//! All sequences start in the same state with the same inputs beside the latent; noise alone tells them apart.

use candle_core::{Result, bail};
use rayon::prelude::*;

use super::apart;
use super::forward::stated;
use crate::model::kernel::cell::forward::{Tape, step};
use crate::model::kernel::cell::{Sizes, Weights, mixed};
use crate::model::kernel::pointwise::exp;

/// What B sequences of T steps go on from.
#[derive(Clone, Copy, Debug)]
pub struct Start<'a> {
    /// The state, `(hidden)`.
    pub hidden: &'a [f32],
    /// Mean of the first latent, `(Z)`.
    pub mean: &'a [f32],
    /// Its log-variances, `(Z)`.
    pub log_var: &'a [f32],
    /// What goes in beside the latent, `(T, U)`.
    pub controls: &'a [f32],
    /// N(0, I) noise `(B, T + 1, Z)` for samples, the first of them of the first latent; without it one sequence,
    /// means going in.
    pub noise: Option<&'a [f32]>,
}

/// Where the parts of a step's row lie: weights of the base matrices, log-variance, mean, what went on.
#[derive(Clone, Copy)]
struct Row {
    latent: usize,
    mixtures: usize,
}

impl Row {
    fn of(sizes: Sizes) -> Self {
        Self {
            latent: sizes.latent,
            mixtures: sizes.mixtures,
        }
    }

    fn width(self) -> usize {
        self.mixtures + 3 * self.latent
    }

    /// The parts of all `rows`, each on its own.
    fn columns(self, rows: &[f32]) -> [Vec<f32>; 4] {
        let (z, k) = (self.latent, self.mixtures);
        [(0, k), (k, z), (k + z, z), (k + 2 * z, z)].map(|(start, len)| {
            rows.chunks_exact(self.width())
                .flat_map(|row| row[start..start + len].iter().copied())
                .collect()
        })
    }
}

/// The mean path's means and log-variances, `(T, Z)`, and A of each step, `(T, Z, Z)`.
pub type Path = (Vec<f32>, Vec<f32>, Vec<f32>);

/// The mean path: without noise, whatever `start` has.
pub fn path(sizes: Sizes, weights: &[f32], start: &Start) -> Result<Path> {
    let start = Start {
        noise: None,
        ..*start
    };
    let rows = run(sizes, weights, &start)?;
    let [mixture, log_var, mean, _] = Row::of(sizes).columns(&rows);
    let transitions = mixed::matrices(sizes, &sizes.weights(weights), &mixture);
    Ok((mean, log_var, transitions))
}

/// Ancestral samples, one for each `(T + 1, Z)` of the noise: what went on after each step, `(B, T, Z)`.
pub fn samples(sizes: Sizes, weights: &[f32], start: &Start) -> Result<Vec<f32>> {
    let rows = run(sizes, weights, start)?;
    let [.., z] = Row::of(sizes).columns(&rows);
    Ok(z)
}

/// Every sequence's rows, `(B, T, row)`.
fn run(sizes: Sizes, weights: &[f32], start: &Start) -> Result<Vec<f32>> {
    let (latent, control) = (sizes.latent, sizes.inputs - sizes.latent);
    let steps = start.controls.len() / control;
    let each = (steps + 1) * latent;
    let noise = start.noise.map_or(0, <[f32]>::len);
    if weights.len() != sizes.parameters()
        || start.hidden.len() != sizes.hidden
        || start.mean.len() != latent
        || start.log_var.len() != latent
        || start.controls.len() != steps * control
        || !noise.is_multiple_of(each)
    {
        bail!("a cell of {sizes:?} got a start, noise or weights of other sizes");
    }
    let sequences = start.noise.map_or(1, |noise| noise.len() / each);
    if steps == 0 || sequences == 0 {
        return Ok(Vec::new());
    }
    let w = sizes.weights(weights);
    let width = steps * Row::of(sizes).width();
    let mut out = vec![0.0; sequences * width];
    let parts = apart(sequences);
    let size = sequences.div_ceil(parts.len());
    parts
        .zip(out.par_chunks_mut(size * width))
        .for_each(|(range, out)| {
            let noise = start.noise;
            let own = noise.map(|noise| &noise[range.start * each..range.end * each]);
            go(sizes, &w, start, own, out);
        });
    Ok(out)
}

/// Some sequences, with their own noise, into `out (B, T, row)`.
fn go(sizes: Sizes, w: &Weights, start: &Start, noise: Option<&[f32]>, out: &mut [f32]) {
    let (latent, control) = (sizes.latent, sizes.inputs - sizes.latent);
    let row = Row::of(sizes);
    let steps = start.controls.len() / control;
    let batch = out.len() / (steps * row.width());
    let mut z = start.mean.repeat(batch);
    let mut log_var = start.log_var.repeat(batch);
    // Without noise no latent strays.
    let noise_at = |t: usize| {
        let rows = noise.unwrap_or_default().chunks_exact(latent);
        rows.skip(t).step_by(steps + 1)
    };
    stray(latent, &mut z, &log_var, noise_at(0));
    let mut hidden = start.hidden.repeat(batch);
    let mut state = hidden.clone();
    let mut mean = z.clone();
    let mut x = vec![0.0; batch * sizes.inputs];
    let mut tape = Tape::new(sizes, batch);
    for (t, control) in start.controls.chunks_exact(control).enumerate() {
        for (x, z) in x.chunks_exact_mut(sizes.inputs).zip(z.chunks_exact(latent)) {
            x[..latent].copy_from_slice(z);
            x[latent..].copy_from_slice(control);
        }
        let mut rows = tape.rows(sizes, 0..batch);
        step(sizes, w, &hidden, &x, &mut rows, &mut state, &mut mean);
        std::mem::swap(&mut hidden, &mut state);
        stated(sizes, rows.head, &mut log_var);
        z.copy_from_slice(&mean);
        stray(latent, &mut z, &log_var, noise_at(t + 1));
        let lines = out.chunks_exact_mut(row.width()).skip(t).step_by(steps);
        let heads = rows.head.chunks_exact(sizes.mixtures + latent);
        let latents = mean.chunks_exact(latent).zip(z.chunks_exact(latent));
        for ((line, head), (mean, z)) in lines.zip(heads).zip(latents) {
            let (stated, rest) = line.split_at_mut(head.len());
            let (line_mean, line_z) = rest.split_at_mut(latent);
            stated.copy_from_slice(head);
            line_mean.copy_from_slice(mean);
            line_z.copy_from_slice(z);
        }
    }
}

/// Moves latents `z (B, Z)` off their means by the `noise` of each, `(B, Z)`.
fn stray<'a>(
    latent: usize,
    z: &mut [f32],
    log_var: &[f32],
    noise: impl Iterator<Item = &'a [f32]>,
) {
    let lines = z.chunks_exact_mut(latent).zip(log_var.chunks_exact(latent));
    for ((z, log_var), noise) in lines.zip(noise) {
        for ((z, log_var), noise) in z.iter_mut().zip(log_var).zip(noise) {
            *z += exp(log_var * 0.5) * noise;
        }
    }
}
