//! Layers one after another, their parameters in one flat tensor.
//!
//! Samples are shared out over the rayon pool in equal parts. Within a part, neighbouring layers with many rows a
//! sample run together over small groups, so that what one layer writes is still in the cache when the next reads it;
//! layers with few rows run over the whole part, so that their products are large.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use candle_core::{Layout, Result, bail};
use rayon::prelude::*;

use super::layer::{Kind, Layer};
use super::pointwise::Activation;
use super::values;

/// Samples of a group; 4 to 8 fill the second-level cache with the largest layers.
const GROUP: usize = 4;
/// Layers with at least this many rows a sample run in groups.
const GROUPED_ROWS: usize = 8;

/// Layers one after another with their parameters in one flat tensor.
#[derive(Debug)]
pub struct Chain {
    layers: Vec<Layer>,
    /// Runs of layers that share a loop over samples, and whether that loop goes by groups.
    segments: Vec<(Range<usize>, bool)>,
    parameters: usize,
    buffers: Mutex<Vec<Vec<f32>>>,
}

impl Chain {
    /// A chain of `(kind, activation, bias)`; parameters are laid out in that order.
    pub fn new(layers: impl IntoIterator<Item = (Kind, Activation, bool)>) -> Self {
        let mut parameters = 0;
        let layers: Vec<Layer> = layers
            .into_iter()
            .map(|(kind, activation, bias)| {
                let layer = Layer {
                    kind,
                    activation,
                    bias,
                    offset: parameters,
                };
                parameters += layer.parameters();
                layer
            })
            .collect();
        let mut segments: Vec<(Range<usize>, bool)> = Vec::new();
        for (index, layer) in layers.iter().enumerate() {
            let grouped = layer.rows() >= GROUPED_ROWS;
            match segments.last_mut() {
                Some((range, last)) if *last && grouped => range.end = index + 1,
                _ => segments.push((index..index + 1, grouped)),
            }
        }
        Self {
            layers,
            segments,
            parameters,
            buffers: Mutex::default(),
        }
    }

    /// The layers in order.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Numbers in the flat parameter tensor.
    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// Numbers in, for one sample.
    pub fn inputs(&self) -> usize {
        self.layers.first().map_or(0, Layer::inputs)
    }

    /// Numbers out, for one sample.
    pub fn outputs(&self) -> usize {
        self.layers.last().map_or(0, Layer::outputs)
    }

    /// Numbers that all layers put out for one sample.
    fn activations(&self) -> usize {
        self.layers.iter().map(Layer::outputs).sum()
    }

    fn scratch(&self, segment: &(Range<usize>, bool), samples: usize) -> usize {
        let group = if segment.1 {
            GROUP.min(samples)
        } else {
            samples
        };
        self.layers[segment.0.clone()]
            .iter()
            .map(Layer::scratch)
            .max()
            .unwrap_or(0)
            * group
    }

    /// A buffer of `len` numbers with arbitrary contents, reused between calls: fresh pages cost more than the sums.
    pub(super) fn take(&self, len: usize) -> Vec<f32> {
        let mut pool = self.buffers.lock().unwrap_or_else(PoisonError::into_inner);
        let at = pool.iter().position(|buffer| buffer.len() == len);
        at.map_or_else(|| vec![0.0; len], |at| pool.swap_remove(at))
    }

    /// Gives a buffer back; only a few are kept.
    pub(super) fn give(&self, buffer: Vec<f32>) {
        let mut pool = self.buffers.lock().unwrap_or_else(PoisonError::into_inner);
        if pool.len() >= 12 {
            pool.remove(0);
        }
        pool.push(buffer);
    }

    /// Outputs of every layer for `samples` of one part, layer by layer, written to `activations`.
    pub(super) fn forward_part(
        &self,
        samples: usize,
        x: &[f32],
        parameters: &[f32],
        activations: &mut [f32],
    ) {
        let mut outputs = self.split(samples, activations);
        for segment in &self.segments {
            let mut scratch = self.take(self.scratch(segment, samples));
            for group in groups(samples, segment.1) {
                for index in segment.0.clone() {
                    self.forward_layer(index, &group, x, parameters, &mut outputs, &mut scratch);
                }
            }
            self.give(scratch);
        }
    }

    /// Each layer's output for all samples of a part.
    fn split<'a>(&self, samples: usize, mut activations: &'a mut [f32]) -> Vec<&'a mut [f32]> {
        let each = |layer: &Layer| {
            let (head, tail) =
                std::mem::take(&mut activations).split_at_mut(samples * layer.outputs());
            activations = tail;
            head
        };
        self.layers.iter().map(each).collect()
    }

    fn forward_layer(
        &self,
        index: usize,
        group: &Range<usize>,
        x: &[f32],
        parameters: &[f32],
        outputs: &mut [&mut [f32]],
        scratch: &mut [f32],
    ) {
        let layer = &self.layers[index];
        let (before, from) = outputs.split_at_mut(index);
        let input: &[f32] = before.last().map_or(x, |output| output);
        let input = &input[group.start * layer.inputs()..group.end * layer.inputs()];
        let output = &mut from[0][group.start * layer.outputs()..group.end * layer.outputs()];
        let scratch = &mut scratch[..group.len() * layer.scratch()];
        layer.forward(group.len(), input, parameters, output, scratch);
    }

    /// Gradients of one part: adds to `dw`, and fills `dx` where wanted. `dy` is the gradient of the last output.
    pub(super) fn backward_part(
        &self,
        x: &[f32],
        parameters: &[f32],
        activations: &mut [f32],
        dy: &[f32],
        dw: &mut [f32],
        dx: Option<&mut [f32]>,
    ) {
        let samples = x.len() / self.inputs();
        let outputs = self.split(samples, activations);
        // Gradient of the current segment's output, over the whole part.
        let mut outer = self.take(dy.len());
        outer.copy_from_slice(dy);
        for segment in self.segments.iter().rev() {
            let first = segment.0.start;
            let mut inner = self.take(samples * self.layers[first].inputs());
            let wanted = first > 0 || dx.is_some();
            let mut scratch = self.take(self.scratch(segment, samples));
            for group in groups(samples, segment.1) {
                let last = self.layers[segment.0.end - 1].outputs();
                let mut gradient = outer[group.start * last..group.end * last].to_vec();
                for index in segment.0.clone().rev() {
                    let layer = &self.layers[index];
                    let input = index.checked_sub(1).map_or(x, |before| &*outputs[before]);
                    let input = &input[group.start * layer.inputs()..group.end * layer.inputs()];
                    let output =
                        &outputs[index][group.start * layer.outputs()..group.end * layer.outputs()];
                    let mut below = Vec::new();
                    let target = if index == first {
                        wanted.then(|| {
                            &mut inner[group.start * layer.inputs()..group.end * layer.inputs()]
                        })
                    } else {
                        below.resize(group.len() * layer.inputs(), 0.0);
                        Some(&mut below[..])
                    };
                    let scratch = &mut scratch[..group.len() * layer.scratch()];
                    layer.backward(
                        group.len(),
                        input,
                        output,
                        parameters,
                        &mut gradient,
                        dw,
                        target,
                        scratch,
                    );
                    gradient = below;
                }
            }
            self.give(scratch);
            self.give(std::mem::replace(&mut outer, inner));
        }
        if let Some(dx) = dx {
            dx.copy_from_slice(&outer);
        }
        self.give(outer);
    }

    /// Outputs of every layer, part after part, the parts in parallel.
    pub(super) fn forward_all(&self, x: &[f32], parameters: &[f32], activations: &mut [f32]) {
        let samples = x.len() / self.inputs();
        let part = part_size(samples);
        x.par_chunks(part * self.inputs())
            .zip(activations.par_chunks_mut(part * self.activations()))
            .for_each(|(x, activations)| {
                self.forward_part(x.len() / self.inputs(), x, parameters, activations);
            });
    }

    /// The number of samples in `x`, once both lengths have been checked.
    pub(super) fn check(&self, x: &[f32], w: &[f32]) -> Result<usize> {
        if !x.len().is_multiple_of(self.inputs()) {
            bail!(
                "a chain of {} inputs a sample got {} numbers",
                self.inputs(),
                x.len()
            );
        }
        if w.len() != self.parameters {
            bail!("a chain of {} parameters got {}", self.parameters, w.len());
        }
        Ok(x.len() / self.inputs())
    }

    /// Numbers of activations for `samples`.
    pub(super) fn activations_len(&self, samples: usize) -> usize {
        samples * self.activations()
    }

    /// The last layer's output within a part's activations.
    pub(super) fn last_output(&self, samples: usize) -> Range<usize> {
        let end = self.activations_len(samples);
        end - samples * self.outputs()..end
    }
}

/// Samples of each parallel part: an equal share of the pool's threads.
pub(super) fn part_size(samples: usize) -> usize {
    samples.div_ceil(rayon::current_num_threads()).max(1)
}

fn groups(samples: usize, grouped: bool) -> impl Iterator<Item = Range<usize>> {
    let size = if grouped { GROUP } else { samples.max(1) };
    (0..samples)
        .step_by(size)
        .map(move |start| start..(start + size).min(samples))
}

/// Adds up what each part found.
pub(super) fn sum_parts(parts: Vec<Vec<f32>>) -> Vec<f32> {
    let mut parts = parts.into_iter();
    let mut total = parts.next().unwrap_or_default();
    for part in parts {
        total
            .par_chunks_mut(1 << 16)
            .zip(part.par_chunks(1 << 16))
            .for_each(|(total, part)| {
                for (t, p) in total.iter_mut().zip(part) {
                    *t += p;
                }
            });
    }
    total
}

/// The numbers behind a tensor's storage guard.
pub(super) fn cpu<'a>(storage: &'a candle_core::Storage, layout: &Layout) -> Result<&'a [f32]> {
    match storage {
        candle_core::Storage::Cpu(storage) => values(storage, layout),
        _ => bail!("a kernel runs on the CPU only"),
    }
}
