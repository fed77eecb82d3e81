//! Layers in two languages at once: the kernels' layout to compute in, PyTorch's names and shapes to store.

use std::sync::Arc;

use super::config;
use super::kernel::chain::Chain;
use super::kernel::gather::Windows;
use super::kernel::layer::Kind;
use super::kernel::pointwise::Activation;
use super::kernel::weight_norm::Stretch;
use super::network::{Init, Parameters};

/// A chain under construction with its parameters.
pub struct Builder {
    init: config::Init,
    layers: Vec<(Kind, Activation, bool)>,
    parameters: Parameters,
}

/// He's gain where a nonlinearity follows that halves the variance, else 1.
fn gain(activation: Activation) -> f32 {
    match activation {
        Activation::Elu | Activation::Relu => std::f32::consts::SQRT_2,
        Activation::Linear | Activation::Sigmoid => 1.0,
    }
}

impl Builder {
    /// A chain without layers; parameters will be drawn as `init` says.
    pub fn new(init: config::Init) -> Self {
        Self {
            init,
            layers: Vec::new(),
            parameters: Parameters::default(),
        }
    }

    /// How weights are drawn of which `reached` meet in one output, and which PyTorch counts as `fan_in`.
    fn uniform(&self, activation: Activation, reached: usize, fan_in: usize) -> Init {
        match self.init {
            config::Init::Torch => Init::Uniform(1.0 / (fan_in as f32).sqrt()),
            config::Init::Scaled => Init::Uniform(gain(activation) * (3.0 / reached as f32).sqrt()),
        }
    }

    /// The chain, and what is trained in it.
    pub fn finish(self) -> (Arc<Chain>, Parameters) {
        (Arc::new(Chain::new(self.layers)), self.parameters)
    }

    /// A convolution without bias; stored `(out, in, height, width)`, or `(out, in, width)` over one row.
    pub fn convolution(
        &mut self,
        name: &str,
        windows: Windows,
        outputs: usize,
        activation: Activation,
    ) {
        let (ci, co) = (windows.channels, outputs);
        let (kh, kw) = (windows.kernel_height, windows.kernel_width);
        let normed = Stretch::Normed {
            outer: kh * kw * ci,
            norms: co,
            inner: 1,
        };
        let init = self.uniform(activation, windows.len(), windows.len());
        let g = self.parameters.push(normed, init);
        let row = windows.height == 1;
        let (ones, shape): (&[usize], &[usize]) = if row {
            (&[co, 1, 1], &[co, ci, kw])
        } else {
            (&[co, 1, 1, 1], &[co, ci, kh, kw])
        };
        let co_stride = co as isize;
        let axes = [
            (co, 1),
            (ci, co_stride),
            (kh, (kw * ci) as isize * co_stride),
            (kw, ci as isize * co_stride),
        ];
        self.parameters
            .slot(format!("{name}.weight_g"), ones, &[(co, 1)], g);
        self.parameters
            .slot(format!("{name}.weight_v"), shape, &axes, g + co);
        self.layers
            .push((Kind::Convolution { windows, outputs }, activation, false));
    }

    /// A transposed convolution without bias; stored `(in, out, height, width)`, its norms over the *input* channel.
    pub fn transposed(
        &mut self,
        name: &str,
        windows: Windows,
        inputs: usize,
        activation: Activation,
    ) {
        let co = windows.channels;
        let (kh, kw) = (windows.kernel_height, windows.kernel_width);
        let normed = Stretch::Normed {
            outer: 1,
            norms: inputs,
            inner: kh * kw * co,
        };
        // Each output pixel is reached by this many products, on average.
        let reached = if windows.is_whole() {
            inputs
        } else {
            inputs * kh * kw / (windows.stride * windows.stride)
        };
        // PyTorch counts the outputs of a transposed convolution as its inputs.
        let init = self.uniform(activation, reached, windows.len());
        let g = self.parameters.push(normed, init);
        let axes = [
            (inputs, (kh * kw * co) as isize),
            (co, 1),
            (kh, (kw * co) as isize),
            (kw, co as isize),
        ];
        self.parameters.slot(
            format!("{name}.weight_g"),
            &[inputs, 1, 1, 1],
            &[(inputs, 1)],
            g,
        );
        self.parameters.slot(
            format!("{name}.weight_v"),
            &[inputs, co, kh, kw],
            &axes,
            g + inputs,
        );
        self.layers
            .push((Kind::Transposed { inputs, windows }, activation, false));
    }

    /// A transposed convolution along a row with stride 1: a convolution with the kernel turned round. Stored
    /// `(in, out, width)`, its norms over the *input* channel.
    pub fn transposed_row(
        &mut self,
        name: &str,
        windows: Windows,
        outputs: usize,
        activation: Activation,
    ) {
        let (ci, co, k) = (windows.channels, outputs, windows.kernel_width);
        let normed = Stretch::Normed {
            outer: k,
            norms: ci,
            inner: co,
        };
        let init = self.uniform(activation, windows.len(), co * k);
        let g = self.parameters.push(normed, init);
        let stride = (ci * co) as isize;
        let axes = [(ci, co as isize), (co, 1), (k, -stride)];
        self.parameters
            .slot(format!("{name}.weight_g"), &[ci, 1, 1], &[(ci, 1)], g);
        self.parameters.slot(
            format!("{name}.weight_v"),
            &[ci, co, k],
            &axes,
            g + ci + (k - 1) * ci * co,
        );
        self.layers
            .push((Kind::Convolution { windows, outputs }, activation, false));
    }

    /// The heads of an encoder, mean and log-variance side by side, over `channels` at each of `places`; stored as two
    /// linear layers over `(channels, places)`.
    pub fn heads(&mut self, channels: usize, places: usize, latent: usize) {
        let (inputs, outputs) = (channels * places, 2 * latent);
        let init = self.uniform(Activation::Linear, inputs, inputs);
        let normed = Stretch::Normed {
            outer: inputs,
            norms: outputs,
            inner: 1,
        };
        let g = self.parameters.push(normed, init);
        let bias = match self.init {
            config::Init::Torch => init,
            config::Init::Scaled => Init::Zero,
        };
        let bias = self.parameters.push(Stretch::Plain(outputs), bias);
        for (name, first) in [("fc_mu", 0), ("fc_logvar", latent)] {
            let row = outputs as isize;
            let axes = [
                (latent, 1),
                (channels, row),
                (places, channels as isize * row),
            ];
            self.parameters.slot(
                format!("{name}.bias"),
                &[latent],
                &[(latent, 1)],
                bias + first,
            );
            self.parameters.slot(
                format!("{name}.weight_g"),
                &[latent, 1],
                &[(latent, 1)],
                g + first,
            );
            self.parameters.slot(
                format!("{name}.weight_v"),
                &[latent, inputs],
                &axes,
                g + outputs + first,
            );
        }
        self.layers
            .push((Kind::Dense { inputs, outputs }, Activation::Linear, true));
    }

    /// A linear layer without bias from the latent to `channels` at each of `places`; stored over
    /// `(channels, places)`.
    pub fn expand(
        &mut self,
        name: &str,
        latent: usize,
        channels: usize,
        places: usize,
        activation: Activation,
    ) {
        let outputs = channels * places;
        let normed = Stretch::Normed {
            outer: latent,
            norms: outputs,
            inner: 1,
        };
        let init = self.uniform(activation, latent, latent);
        let g = self.parameters.push(normed, init);
        let by_place = [(channels, 1), (places, channels as isize)];
        let axes = [by_place[0], by_place[1], (latent, outputs as isize)];
        self.parameters
            .slot(format!("{name}.weight_g"), &[outputs, 1], &by_place, g);
        self.parameters.slot(
            format!("{name}.weight_v"),
            &[outputs, latent],
            &axes,
            g + outputs,
        );
        self.layers.push((
            Kind::Dense {
                inputs: latent,
                outputs,
            },
            activation,
            false,
        ));
    }
}
