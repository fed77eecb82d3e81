//! A latent to what an expert sees: image decoder (Ha & Schmidhuber 2018) and window decoder.

use std::sync::{Arc, Mutex};

use candle_core::{Device, Result, Tensor};

use super::config::Config;
use super::encoder::row_windows;
use super::fallback;
use super::kernel::apply::Apply;
use super::kernel::chain::Chain;
use super::kernel::gather::Windows;
use super::kernel::pointwise::Activation;
use super::kernel::squared_error::{PerSample, SquaredError};
use super::layers::Builder;
use super::network::{Draw, Network, Parameters};
use super::stem;
use crate::modality::Expert;

/// One expert's decoder: a chain from the latent to an observation.
#[derive(Debug)]
pub struct Decoder {
    /// Its parameters.
    pub network: Network,
    chain: Arc<Chain>,
}

/// Latent to 1024, then transposed convolutions 128 (k5), 64 (k5), 32 (k6), out (k6), stride 2, sigmoid.
fn image(config: &Config) -> (Arc<Chain>, Parameters) {
    let mut build = Builder::new(config.training.init);
    let mut inputs = 1024;
    build.expand("linear", config.latent, inputs, 1, config.activation);
    let mut side = 1;
    let layers = [(128, 5), (64, 5), (32, 6), (config.frame_stack + 1, 6)];
    for (i, (channels, kernel)) in layers.into_iter().enumerate() {
        side = (side - 1) * 2 + kernel;
        let windows = Windows {
            height: side,
            width: side,
            channels,
            kernel_height: kernel,
            kernel_width: kernel,
            stride: 2,
            padding: 0,
        };
        let activation = if i + 1 == layers.len() {
            Activation::Sigmoid
        } else {
            config.activation
        };
        build.transposed(&format!("layers.{}", 2 * i), windows, inputs, activation);
        inputs = channels;
    }
    build.finish()
}

/// Latent to 256 at each of W samples, then transposed convolutions 128, 64, 32, channels with kernel 3, no final
/// nonlinearity.
fn window(config: &Config, channels: usize) -> (Arc<Chain>, Parameters) {
    let mut build = Builder::new(config.training.init);
    let mut inputs = 256;
    build.expand(
        "linear",
        config.latent,
        inputs,
        config.window,
        config.activation,
    );
    let layers = [128, 64, 32, channels];
    for (i, outputs) in layers.into_iter().enumerate() {
        let activation = if i + 1 == layers.len() {
            Activation::Linear
        } else {
            config.activation
        };
        build.transposed_row(
            &format!("layers.{}", 2 * i),
            row_windows(config.window, inputs),
            outputs,
            activation,
        );
        inputs = outputs;
    }
    build.finish()
}

impl Decoder {
    /// Its layers.
    pub fn chain(&self) -> &Arc<Chain> {
        &self.chain
    }

    /// The decoder of `stream`.
    pub fn new(config: &Config, stream: Expert, draw: &mut Draw, device: &Device) -> Result<Self> {
        let (chain, parameters) = match stream {
            Expert::Vision => image(config),
            _ => window(config, config.window_channels(stream)),
        };
        let name = format!("{}_dec", stem(stream));
        Ok(Self {
            network: Network::new(&name, parameters, draw, device)?,
            chain,
        })
    }

    /// Latents `(n, Z)` to observations `(n, outputs)`, without a gradient.
    pub fn decode(&self, latents: &Tensor, weights: &Tensor) -> Result<Tensor> {
        if !weights.device().is_cpu() {
            return fallback::chain(&self.chain, latents, weights);
        }
        latents
            .contiguous()?
            .apply_op2_no_bwd(weights, &Apply::new(Arc::clone(&self.chain), false, false))
    }

    /// Σ wₙ ‖decode(zₙ) − targetₙ‖² with one weight a sample, and where each sample's unweighted error will be.
    pub fn squared_error(
        &self,
        latents: &Tensor,
        weights: &Tensor,
        targets: &Tensor,
        sample_weights: Vec<f32>,
        train: bool,
    ) -> Result<(Tensor, PerSample)> {
        if !weights.device().is_cpu() {
            let errors = (fallback::chain(&self.chain, latents, weights)? - targets)?
                .sqr()?
                .sum(1)?;
            let per_sample = Arc::new(Mutex::new(errors.to_vec1()?));
            let factors = Tensor::from_vec(sample_weights, errors.shape(), errors.device())?;
            return Ok(((errors * factors)?.sum_all()?, per_sample));
        }
        let op = SquaredError::new(Arc::clone(&self.chain), sample_weights, train);
        let per_sample = op.per_sample();
        let total = latents
            .contiguous()?
            .apply_op3(weights, &targets.contiguous()?, op)?;
        Ok((total, per_sample))
    }
}
