//! An observation to an expert: image encoder (Ha & Schmidhuber 2018) and window encoder.

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

/// One expert's encoder: a chain from what it sees to mean and log-variance.
#[derive(Debug)]
pub struct Encoder {
    /// Its parameters.
    pub network: Network,
    chain: Arc<Chain>,
    latent: usize,
}

/// Channels of the four convolutions.
const CHANNELS: [usize; 4] = [32, 64, 128, 256];

/// Frames, `(64, 64, channels)`: convolutions 32, 64, 128, 256 with kernel 4 and stride 2.
fn image(config: &Config) -> (Arc<Chain>, Parameters) {
    let mut build = Builder::default();
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
    build.heads(channels, side * side, config.latent);
    build.finish()
}

/// Windows, `(W, channels)`: convolutions 32, 64, 128, 256 with kernel 3 and padding 1.
fn window(config: &Config, mut channels: usize) -> (Arc<Chain>, Parameters) {
    let mut build = Builder::default();
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
    build.heads(channels, config.window, config.latent);
    build.finish()
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
    /// Its layers.
    pub fn chain(&self) -> &Arc<Chain> {
        &self.chain
    }

    /// The encoder of frames.
    pub fn of_images(
        config: &Config,
        name: &str,
        draw: &mut Draw,
        device: &Device,
    ) -> Result<Self> {
        Self::new(image(config), name, config.latent, draw, device)
    }

    /// The encoder of windows with `channels` channels.
    pub fn of_windows(
        config: &Config,
        channels: usize,
        name: &str,
        draw: &mut Draw,
        device: &Device,
    ) -> Result<Self> {
        Self::new(window(config, channels), name, config.latent, draw, device)
    }

    fn new(
        (chain, parameters): (Arc<Chain>, Parameters),
        name: &str,
        latent: usize,
        draw: &mut Draw,
        device: &Device,
    ) -> Result<Self> {
        Ok(Self {
            network: Network::new(name, parameters, draw, device)?,
            chain,
            latent,
        })
    }

    /// Numbers that one observation has.
    pub fn inputs(&self) -> usize {
        self.chain.inputs()
    }

    /// `(n, inputs)` observations to Gaussians `(n, Z)`; `weights` are the network's folded ones.
    pub fn encode(
        &self,
        observations: &Tensor,
        weights: &Tensor,
        train: bool,
    ) -> Result<DiagGaussian> {
        let out = if weights.device().is_cpu() {
            let op = Apply::new(Arc::clone(&self.chain), train, false);
            observations.contiguous()?.apply_op2(weights, op)?
        } else {
            fallback::chain(&self.chain, observations, weights)?
        };
        Ok(DiagGaussian {
            mean: out.narrow(1, 0, self.latent)?.contiguous()?,
            log_var: out.narrow(1, self.latent, self.latent)?.contiguous()?,
        })
    }
}
