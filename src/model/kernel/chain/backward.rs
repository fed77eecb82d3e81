//! The gradients of a chain.

use std::ops::Range;

use rayon::prelude::*;

use super::{Chain, Segment, of_group};
use crate::model::kernel::matmul::Write;

/// The gradients above and below a layer, for one group.
#[derive(Default)]
pub(super) struct Gradients {
    pub(super) above: Vec<f32>,
    pub(super) below: Vec<f32>,
}

impl Chain {
    /// Gradients of one part: fills `dw`, and `dx` where wanted. `dy` is the gradient of the last output.
    pub(in super::super) fn backward_part(
        &self,
        x: &[f32],
        parameters: &[f32],
        activations: &mut [f32],
        dy: &[f32],
        dw: &mut [f32],
        dx: Option<&mut [f32]>,
    ) {
        let mut outer = self.take(dy.len());
        outer.copy_from_slice(dy);
        self.backward_segments(&self.segments, x, parameters, activations, outer, dw, dx);
    }

    /// The same for the first segments alone; `outer` is the gradient of the last one's output.
    #[expect(clippy::too_many_arguments, reason = "see Layer::backward")]
    pub(super) fn backward_segments(
        &self,
        segments: &[Segment],
        x: &[f32],
        parameters: &[f32],
        activations: &mut [f32],
        mut outer: Vec<f32>,
        dw: &mut [f32],
        dx: Option<&mut [f32]>,
    ) {
        let samples = x.len() / self.inputs();
        let outputs = self.split(samples, activations);
        let mut gradients = Gradients::default();
        for segment in segments.iter().rev() {
            let Range { start: first, end } = segment.layers;
            let (inputs, last) = (self.layers[first].inputs(), self.layers[end - 1].outputs());
            let mut inner = self.take(samples * inputs);
            let wanted = first > 0 || dx.is_some();
            let mut scratch = self.take(self.scratch(segment, samples));
            let input = first.checked_sub(1).map_or(x, |before| &*outputs[before]);
            for group in segment.groups(samples) {
                let outputs: Vec<&[f32]> = segment
                    .layers
                    .clone()
                    .map(|index| of_group(outputs[index], &group, self.layers[index].outputs()))
                    .collect();
                gradients.above.clear();
                gradients
                    .above
                    .extend_from_slice(of_group(&outer, &group, last));
                let target = wanted.then(|| &mut inner[group.start * inputs..group.end * inputs]);
                self.backward_group(
                    segment,
                    &group,
                    of_group(input, &group, inputs),
                    &outputs,
                    parameters,
                    &mut gradients,
                    dw,
                    target,
                    &mut scratch,
                );
            }
            self.give(scratch);
            self.give(std::mem::replace(&mut outer, inner));
        }
        if let Some(dx) = dx {
            dx.copy_from_slice(&outer);
        }
        self.give(outer);
    }

    /// Gradients of one group of a segment, from that of its output in `gradients.above`. The first group of a part
    /// replaces what is in `dw`, the others add to it.
    #[expect(clippy::too_many_arguments, reason = "see Layer::backward")]
    pub(super) fn backward_group(
        &self,
        segment: &Segment,
        group: &Range<usize>,
        input: &[f32],
        outputs: &[&[f32]],
        parameters: &[f32],
        gradients: &mut Gradients,
        dw: &mut [f32],
        mut target: Option<&mut [f32]>,
        scratch: &mut [f32],
    ) {
        let write = if group.start == 0 {
            Write::Replace
        } else {
            Write::Add
        };
        for (i, layer) in self.layers[segment.layers.clone()].iter().enumerate().rev() {
            let input = i.checked_sub(1).map_or(input, |before| outputs[before]);
            let Gradients { above, below } = gradients;
            let target = if i == 0 {
                target.take()
            } else {
                below.resize(group.len() * layer.inputs(), 0.0);
                Some(&mut below[..])
            };
            let scratch = &mut scratch[..group.len() * layer.scratch()];
            layer.backward(
                group.len(),
                (input, outputs[i]),
                parameters,
                above,
                (dw, write),
                target,
                scratch,
            );
            std::mem::swap(above, below);
        }
    }

    /// Adds up the gradients that each part found.
    pub(in super::super) fn sum_parts(&self, parts: Vec<Vec<f32>>) -> Vec<f32> {
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
            self.give(part);
        }
        total
    }
}
