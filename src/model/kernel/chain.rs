//! Layers one after another, their parameters in one flat tensor.
//!
//! Samples are shared out over the rayon pool in equal parts. Within a part, neighbouring layers with many rows a
//! sample run together over small groups, so that what one layer writes is still in the cache when the next reads it;
//! layers with few rows run over the whole part, so that their products are large.

mod backward;
mod fused;

use std::ops::Range;
use std::sync::Mutex;

use candle_core::{Layout, Result, bail};
use rayon::prelude::*;

use super::layer::{Kind, Layer};
use super::pointwise::Activation;
use super::values;
use crate::lock::lock;

/// Samples of a group; 4 to 8 fill the second-level cache with the largest layers.
const GROUP: usize = 4;
/// Buffers that are kept for the next call: a training step has some thirty on two threads.
const POOL: usize = 40;
/// Layers with at least this many rows a sample run in groups.
const GROUPED_ROWS: usize = 8;

/// Layers that share a loop over samples.
#[derive(Debug)]
struct Segment {
    layers: Range<usize>,
    /// Whether that loop goes by groups, or takes all samples at once.
    grouped: bool,
}

impl Segment {
    /// Samples that are in work at once, of these.
    fn room(&self, samples: usize) -> usize {
        if self.grouped {
            GROUP.min(samples)
        } else {
            samples
        }
    }

    fn groups(&self, samples: usize) -> impl Iterator<Item = Range<usize>> {
        let size = self.room(samples).max(1);
        (0..samples)
            .step_by(size)
            .map(move |start| start..(start + size).min(samples))
    }
}

/// The numbers of a group, of `each` a sample.
fn of_group<'a>(all: &'a [f32], group: &Range<usize>, each: usize) -> &'a [f32] {
    &all[group.start * each..group.end * each]
}

/// Layers one after another with their parameters in one flat tensor.
#[derive(Debug)]
pub struct Chain {
    layers: Vec<Layer>,
    segments: Vec<Segment>,
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
        let mut segments: Vec<Segment> = Vec::new();
        for (index, layer) in layers.iter().enumerate() {
            let grouped = layer.rows() >= GROUPED_ROWS;
            match segments.last_mut() {
                Some(last) if last.grouped && grouped => last.layers.end = index + 1,
                _ => segments.push(Segment {
                    layers: index..index + 1,
                    grouped,
                }),
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

    /// Samples that layer `index` multiplies at once, of a part of `samples`.
    pub fn at_once(&self, index: usize, samples: usize) -> usize {
        let segment = self.segments.iter().find(|s| s.layers.contains(&index));
        segment.map_or(samples, |segment| segment.room(samples))
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

    fn scratch(&self, segment: &Segment, samples: usize) -> usize {
        let each = self.layers[segment.layers.clone()].iter();
        each.map(Layer::scratch).max().unwrap_or(0) * segment.room(samples)
    }

    /// A buffer of `len` numbers with arbitrary contents, reused between calls: fresh pages cost more than the sums.
    pub(super) fn take(&self, len: usize) -> Vec<f32> {
        let mut pool = lock(&self.buffers);
        let at = pool.iter().position(|buffer| buffer.len() == len);
        at.map_or_else(|| vec![0.0; len], |at| pool.swap_remove(at))
    }

    /// Gives a buffer back; one goes where there are too many.
    pub(super) fn give(&self, buffer: Vec<f32>) {
        let mut pool = lock(&self.buffers);
        if pool.len() >= POOL {
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
        self.forward_segments(&self.segments, samples, x, parameters, activations);
    }

    /// The same for the first segments alone.
    fn forward_segments(
        &self,
        segments: &[Segment],
        samples: usize,
        x: &[f32],
        parameters: &[f32],
        activations: &mut [f32],
    ) {
        let mut outputs = self.split(samples, activations);
        for segment in segments {
            let mut scratch = self.take(self.scratch(segment, samples));
            let (before, after) = outputs.split_at_mut(segment.layers.start);
            let input: &[f32] = before.last().map_or(x, |output| output);
            for group in segment.groups(samples) {
                let input = of_group(input, &group, self.layers[segment.layers.start].inputs());
                let mut outputs: Vec<&mut [f32]> = after
                    .iter_mut()
                    .zip(&self.layers[segment.layers.clone()])
                    .map(|(out, layer)| {
                        &mut out[group.start * layer.outputs()..group.end * layer.outputs()]
                    })
                    .collect();
                self.forward_group(
                    segment,
                    group.len(),
                    input,
                    parameters,
                    &mut outputs,
                    &mut scratch,
                );
            }
            self.give(scratch);
        }
    }

    /// Outputs of a segment's layers for one group.
    fn forward_group(
        &self,
        segment: &Segment,
        samples: usize,
        input: &[f32],
        parameters: &[f32],
        outputs: &mut [&mut [f32]],
        scratch: &mut [f32],
    ) {
        for (i, layer) in self.layers[segment.layers.clone()].iter().enumerate() {
            let (before, here) = outputs.split_at_mut(i);
            let input: &[f32] = before.last().map_or(input, |output| output);
            let scratch = &mut scratch[..samples * layer.scratch()];
            layer.forward(samples, input, parameters, here[0], scratch);
        }
    }

    /// Each layer's output for all samples of a part; fewer layers where `activations` has room for fewer.
    fn split<'a>(&self, samples: usize, mut activations: &'a mut [f32]) -> Vec<&'a mut [f32]> {
        let mut outputs = Vec::with_capacity(self.layers.len());
        for layer in &self.layers {
            let len = samples * layer.outputs();
            if activations.len() < len {
                break;
            }
            let (head, tail) = activations.split_at_mut(len);
            activations = tail;
            outputs.push(head);
        }
        outputs
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

/// The numbers behind a tensor's storage guard.
pub(super) fn cpu<'a>(storage: &'a candle_core::Storage, layout: &Layout) -> Result<&'a [f32]> {
    match storage {
        candle_core::Storage::Cpu(storage) => values(storage, layout),
        _ => bail!("a kernel runs on the CPU only"),
    }
}
