//! A chain, the error of what it puts out and the gradient, in one pass.

use std::ops::Range;

use super::backward::Gradients;
use super::{Chain, of_group};
use crate::model::kernel::layer::Layer;

impl Chain {
    /// Forward, error and backward of one part, the last segment group by group: what is put out is compared and
    /// differentiated while it is in the cache. `error(samples, y, dy)` leaves the gradient of `y` in `dy`. Without
    /// `gradients`, of parameters and of `x`, nothing is differentiated.
    pub(in super::super) fn fused_part(
        &self,
        x: &[f32],
        parameters: &[f32],
        mut error: impl FnMut(Range<usize>, &[f32], &mut [f32]),
        gradients: Option<(&mut [f32], &mut [f32])>,
    ) {
        let Some((segment, leading)) = self.segments.split_last() else {
            return;
        };
        let samples = x.len() / self.inputs();
        let first = segment.layers.start;
        let led: usize = self.layers[..first].iter().map(Layer::outputs).sum();
        let mut activations = self.take(samples * led);
        self.forward_segments(leading, samples, x, parameters, &mut activations);
        let inputs = self.layers[first].inputs();
        let input = if first == 0 {
            x
        } else {
            &activations[samples * (led - inputs)..]
        };
        let room = segment.room(samples);
        let layers = &self.layers[segment.layers.clone()];
        let mut buffers: Vec<Vec<f32>> = layers
            .iter()
            .map(|layer| self.take(room * layer.outputs()))
            .collect();
        let mut scratch = self.take(self.scratch(segment, samples));
        let mut inner = self.take(samples * inputs);
        let mut between = Gradients::default();
        let (mut dw, dx) = gradients.unzip();
        for group in segment.groups(samples) {
            let mut outputs: Vec<&mut [f32]> = buffers
                .iter_mut()
                .zip(layers)
                .map(|(buffer, layer)| &mut buffer[..group.len() * layer.outputs()])
                .collect();
            let input = of_group(input, &group, inputs);
            self.forward_group(
                segment,
                group.len(),
                input,
                parameters,
                &mut outputs,
                &mut scratch,
            );
            let outputs: Vec<&[f32]> = outputs.into_iter().map(|output| &*output).collect();
            let y = outputs[outputs.len() - 1];
            between.above.resize(y.len(), 0.0);
            error(group.clone(), y, &mut between.above);
            if let Some(dw) = &mut dw {
                let target = &mut inner[group.start * inputs..group.end * inputs];
                self.backward_group(
                    segment,
                    &group,
                    input,
                    &outputs,
                    parameters,
                    &mut between,
                    dw,
                    Some(target),
                    &mut scratch,
                );
            }
        }
        for buffer in buffers {
            self.give(buffer);
        }
        self.give(scratch);
        if let Some(dw) = dw {
            self.backward_segments(leading, x, parameters, &mut activations, inner, dw, dx);
        } else {
            self.give(inner);
        }
        self.give(activations);
    }
}
