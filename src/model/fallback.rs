//! The same layers in candle's own operations: for devices the kernels do not run on, and to hold the kernels against.

mod filter;

pub use self::filter::filter;

use candle_core::{Result, Tensor};

use super::kernel::cell::Sizes;
use super::kernel::chain::Chain;
use super::kernel::gather::Windows;
use super::kernel::layer::{Kind, Layer};
use super::kernel::pointwise::Activation;

/// `(samples, inputs)` and flat folded weights to `(samples, outputs)`, with gradients.
pub fn chain(chain: &Chain, x: &Tensor, weights: &Tensor) -> Result<Tensor> {
    let mut x = x.clone();
    for layer in chain.layers() {
        x = apply(layer, &x, weights)?;
    }
    Ok(x)
}

fn apply(layer: &Layer, x: &Tensor, weights: &Tensor) -> Result<Tensor> {
    let (k, n) = layer.matrix();
    let w = weights.narrow(0, layer.offset, k * n)?;
    let y = match layer.kind {
        Kind::Dense { .. } => {
            let y = x.matmul(&w.reshape((k, n))?)?;
            if layer.bias {
                y.broadcast_add(&weights.narrow(0, layer.offset + k * n, n)?)?
            } else {
                y
            }
        }
        Kind::Convolution { windows, outputs } => {
            let Windows {
                kernel_height,
                kernel_width,
                channels,
                padding,
                ..
            } = windows;
            let kernel = w
                .reshape((kernel_height, kernel_width, channels, outputs))?
                .permute((3, 2, 0, 1))?;
            // One row is padded to its left and right only.
            let image = channels_first(x, windows)?.pad_with_zeros(3, padding, padding)?;
            rows(&image.conv2d(&kernel.contiguous()?, 0, windows.stride, 1, 1)?)?
        }
        Kind::Transposed { inputs, windows } => {
            let Windows {
                kernel_height,
                kernel_width,
                channels,
                ..
            } = windows;
            let kernel = w
                .reshape((inputs, kernel_height, kernel_width, channels))?
                .permute((0, 3, 1, 2))?;
            let image = x
                .reshape((x.dim(0)?, windows.down(), windows.across(), inputs))?
                .permute((0, 3, 1, 2))?;
            rows(&image.contiguous()?.conv_transpose2d(
                &kernel.contiguous()?,
                0,
                0,
                windows.stride,
                1,
            )?)?
        }
    };
    match layer.activation {
        Activation::Linear => Ok(y),
        Activation::Elu => y.elu(1.0),
        Activation::Relu => y.relu(),
        Activation::Sigmoid => candle_nn::ops::sigmoid(&y),
    }
}

/// One step of the mixture cell: `(B, hidden)`, `(B, inputs)` and flat weights to `(B, hidden + 2 Z)`.
pub fn cell(sizes: Sizes, h: &Tensor, x: &Tensor, weights: &Tensor) -> Result<Tensor> {
    let Sizes {
        latent,
        inputs,
        hidden,
        mixtures,
    } = sizes;
    let mut start = 0;
    let parts = sizes.parts().map(|len| {
        let part = weights.narrow(0, start, len);
        start += len;
        part
    });
    let [
        input,
        recurrent,
        input_bias,
        recurrent_bias,
        head,
        head_bias,
        bases,
    ] = parts;
    let gates = x
        .matmul(&input?.reshape((inputs, 3 * hidden))?)?
        .broadcast_add(&input_bias?)?;
    let past = h
        .contiguous()?
        .matmul(&recurrent?.reshape((hidden, 3 * hidden))?)?
        .broadcast_add(&recurrent_bias?)?;
    let gate = |i: usize| {
        Ok::<_, candle_core::Error>((
            gates.narrow(1, i * hidden, hidden)?,
            past.narrow(1, i * hidden, hidden)?,
        ))
    };
    let sum = |(a, b): (Tensor, Tensor)| candle_nn::ops::sigmoid(&(a + b)?);
    let (r, z) = (sum(gate(0)?)?, sum(gate(1)?)?);
    let (own, past) = gate(2)?;
    let n = (own + (r * past)?)?.tanh()?;
    let state = (&n + (z * (h - &n)?)?)?;
    let head = state
        .matmul(&head?.reshape((hidden, mixtures + latent))?)?
        .broadcast_add(&head_bias?)?;
    let mixture = candle_nn::ops::softmax(&head.narrow(1, 0, mixtures)?, 1)?;
    let mapped = x.matmul(&bases?.reshape((mixtures * latent, inputs))?.t()?)?;
    let mapped = mapped.reshape((x.dim(0)?, mixtures, latent))?;
    let mean = mapped.broadcast_mul(&mixture.unsqueeze(2)?)?.sum(1)?;
    Tensor::cat(
        &[
            &state,
            &mean,
            &head.narrow(1, mixtures, latent)?.contiguous()?,
        ],
        1,
    )
}

fn channels_first(x: &Tensor, windows: Windows) -> Result<Tensor> {
    let shape = (x.dim(0)?, windows.height, windows.width, windows.channels);
    x.reshape(shape)?.permute((0, 3, 1, 2))?.contiguous()
}

fn rows(image: &Tensor) -> Result<Tensor> {
    image.permute((0, 2, 3, 1))?.contiguous()?.flatten_from(1)
}

#[cfg(test)]
mod tests;
