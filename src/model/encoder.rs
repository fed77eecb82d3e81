//! An observation to an expert: image encoder (Ha & Schmidhuber 2018) and window encoder, each with a head of its own,
//! or both under one.

use std::sync::Arc;

use candle_core::{Device, Result, Tensor};

use super::config::Config;
use super::fallback;
use super::gaussian::DiagGaussian;
use super::kernel::apply::Apply;
use super::kernel::chain::Chain;
use super::kernel::gather::Windows;
use super::layers::Builder;
use super::network::{Draw, Network, Parameters};
use super::stem;
use crate::modality::Expert;

/// One expert's encoder, from what it sees to mean and log-variance.
#[derive(Debug)]
pub struct Encoder {
    /// One for each stream it sees, and for several of them the head over what they say, side by side.
    parts: Vec<Part>,
    streams: usize,
    latent: usize,
}

/// A chain with its parameters.
#[derive(Debug)]
struct Part {
    network: Network,
    chain: Arc<Chain>,
}

/// Channels of the four convolutions.
const CHANNELS: [usize; 4] = [32, 64, 128, 256];

/// Frames, `(64, 64, channels)`: convolutions 32, 64, 128, 256 with kernel 4 and stride 2; and the pixels left.
fn image(config: &Config) -> (Builder, usize) {
    let mut build = Builder::new(config.training.init);
    let (mut side, mut channels) = (config.frame_size, config.frame_stack + 1);
    for (i, outputs) in CHANNELS.into_iter().enumerate() {
        let windows = Windows {
            height: side,
            width: side,
            channels,
            kernel_height: 4,
            kernel_width: 4,
            stride: 2,
            padding: 0,
        };
        build.convolution(
            &format!("layers.{}", 2 * i),
            windows,
            outputs,
            config.activation,
        );
        (side, channels) = (windows.across(), outputs);
    }
    (build, side * side)
}

/// Windows, `(W, channels)`: convolutions 32, 64, 128, 256 with kernel 3 and padding 1; and the samples left.
fn window(config: &Config, mut channels: usize) -> (Builder, usize) {
    let mut build = Builder::new(config.training.init);
    for (i, outputs) in CHANNELS.into_iter().enumerate() {
        let windows = row_windows(config.window, channels);
        build.convolution(
            &format!("layers.{}", 2 * i),
            windows,
            outputs,
            config.activation,
        );
        channels = outputs;
    }
    (build, config.window)
}

/// Three neighbouring samples of a window of `length`, with a zero at both ends.
pub(super) fn row_windows(length: usize, channels: usize) -> Windows {
    Windows {
        height: 1,
        width: length,
        channels,
        kernel_height: 1,
        kernel_width: 3,
        stride: 1,
        padding: 1,
    }
}

impl Encoder {
    /// The layers of each of its networks.
    pub fn chains(&self) -> impl Iterator<Item = &Arc<Chain>> {
        self.parts.iter().map(|part| &part.chain)
    }

    /// The encoder of `expert`.
    pub fn new(config: &Config, expert: Expert, draw: &mut Draw, device: &Device) -> Result<Self> {
        let streams = expert.streams();
        let alone = streams.len() == 1;
        let (mut parts, mut features) = (Vec::new(), 0);
        for &stream in streams {
            let (mut build, places) = match stream {
                Expert::Vision => image(config),
                _ => window(config, config.window_channels(stream)),
            };
            if alone {
                build.heads(CHANNELS[3], places, config.latent);
            }
            features += CHANNELS[3] * places;
            let name = format!("{}_enc", stem(stream));
            parts.push(Part::new(&name, build.finish(), draw, device)?);
        }
        if !alone {
            let mut build = Builder::new(config.training.init);
            build.heads(features, 1, config.latent);
            let name = format!("{}_enc", stem(expert));
            parts.push(Part::new(&name, build.finish(), draw, device)?);
        }
        Ok(Self {
            parts,
            streams: streams.len(),
            latent: config.latent,
        })
    }

    /// Its networks.
    pub fn networks(&self) -> impl Iterator<Item = &Network> {
        self.parts.iter().map(|part| &part.network)
    }

    /// The folded weights of its networks.
    pub fn folded(&self) -> Result<Vec<Tensor>> {
        self.networks().map(Network::folded).collect()
    }

    /// How many streams it sees.
    pub fn streams(&self) -> usize {
        self.streams
    }

    /// Numbers that one observation of stream `index` has.
    pub fn inputs(&self, index: usize) -> usize {
        self.parts[index].chain.inputs()
    }

    /// `(n, inputs)` observations of each stream to Gaussians `(n, Z)`; `weights` are the folded ones.
    pub fn encode(
        &self,
        observations: &[Tensor],
        weights: &[Tensor],
        train: bool,
    ) -> Result<DiagGaussian> {
        if observations.len() != self.streams {
            candle_core::bail!(
                "an encoder of {} streams got {}",
                self.streams,
                observations.len()
            );
        }
        let mut said = self
            .parts
            .iter()
            .zip(observations)
            .zip(weights)
            .map(|((part, observed), weights)| part.run(observed, weights, train, false))
            .collect::<Result<Vec<_>>>()?;
        let out = match (self.parts.get(self.streams), weights.get(self.streams)) {
            (Some(head), Some(weights)) => {
                head.run(&Tensor::cat(&said, 1)?, weights, train, true)?
            }
            _ => said.swap_remove(0),
        };
        Ok(DiagGaussian {
            mean: out.narrow(1, 0, self.latent)?.contiguous()?,
            log_var: out.narrow(1, self.latent, self.latent)?.contiguous()?,
        })
    }
}

impl Part {
    fn new(
        name: &str,
        (chain, parameters): (Arc<Chain>, Parameters),
        draw: &mut Draw,
        device: &Device,
    ) -> Result<Self> {
        Ok(Self {
            network: Network::new(name, parameters, draw, device)?,
            chain,
        })
    }

    fn run(
        &self,
        input: &Tensor,
        weights: &Tensor,
        train: bool,
        input_gradient: bool,
    ) -> Result<Tensor> {
        if !weights.device().is_cpu() {
            return fallback::chain(&self.chain, input, weights);
        }
        let op = Apply::new(Arc::clone(&self.chain), train, input_gradient);
        input.contiguous()?.apply_op2(weights, op)
    }
}
