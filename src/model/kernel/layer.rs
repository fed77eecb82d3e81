//! One layer of a chain: forward and backward over some samples, channels last.
//!
//! Weights of a layer are `[K, N]` row major, then N biases where it has them. A convolution gathers windows into rows
//! of K and multiplies; a transposed convolution multiplies rows of K channels into windows of N and adds them back.

use super::gather::Windows;
use super::matmul::{Mat, Write, matmul};
use super::pointwise::{Activation, add_row, sum_rows};

/// What a layer does before its nonlinearity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `x (inputs) · W + b`.
    Dense {
        /// Numbers in.
        inputs: usize,
        /// Numbers out.
        outputs: usize,
    },
    /// Windows of the input times W, `(windows, len) · (len, outputs)`.
    Convolution {
        /// Windows over the input.
        windows: Windows,
        /// Channels out.
        outputs: usize,
    },
    /// Pixels of the input times W, `(pixels, inputs) · (inputs, len)`, added back as windows over the output.
    Transposed {
        /// Channels in.
        inputs: usize,
        /// Windows over the output: one for each pixel of the input.
        windows: Windows,
    },
}

/// A layer and where its weights lie in the chain's flat parameters.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    /// What it does.
    pub kind: Kind,
    /// Its nonlinearity.
    pub activation: Activation,
    /// Whether a bias follows the weights (dense layers only).
    pub bias: bool,
    /// Offset of its weights in the flat parameters.
    pub offset: usize,
}

impl Layer {
    /// Numbers in, for one sample.
    pub fn inputs(&self) -> usize {
        match self.kind {
            Kind::Dense { inputs, .. } => inputs,
            Kind::Convolution { windows, .. } => windows.image_len(),
            Kind::Transposed { inputs, windows } => windows.count() * inputs,
        }
    }

    /// Numbers out, for one sample.
    pub fn outputs(&self) -> usize {
        match self.kind {
            Kind::Dense { outputs, .. } => outputs,
            Kind::Convolution { windows, outputs } => windows.count() * outputs,
            Kind::Transposed { windows, .. } => windows.image_len(),
        }
    }

    /// The weight matrix, `(K, N)`.
    pub fn matrix(&self) -> (usize, usize) {
        match self.kind {
            Kind::Dense { inputs, outputs } => (inputs, outputs),
            Kind::Convolution { windows, outputs } => (windows.len(), outputs),
            Kind::Transposed { inputs, windows } => (inputs, windows.len()),
        }
    }

    /// Numbers in the weight matrix and the bias.
    pub fn parameters(&self) -> usize {
        let (k, n) = self.matrix();
        k * n + if self.bias { n } else { 0 }
    }

    /// Rows of the matrix product that one sample makes.
    pub fn rows(&self) -> usize {
        match self.kind {
            Kind::Dense { .. } => 1,
            Kind::Convolution { windows, .. } | Kind::Transposed { windows, .. } => windows.count(),
        }
    }

    /// Scratch that one sample needs: its gathered windows.
    pub fn scratch(&self) -> usize {
        match self.kind {
            Kind::Dense { .. } => 0,
            Kind::Convolution { windows, .. } | Kind::Transposed { windows, .. } => {
                if windows.is_whole() {
                    0
                } else {
                    windows.count() * windows.len()
                }
            }
        }
    }

    fn weights<'a>(&self, parameters: &'a [f32]) -> &'a [f32] {
        let (k, n) = self.matrix();
        &parameters[self.offset..self.offset + k * n]
    }

    /// `y = activation(layer(x))` for `samples`; `scratch` has room for each sample's windows.
    pub fn forward(
        &self,
        samples: usize,
        x: &[f32],
        parameters: &[f32],
        y: &mut [f32],
        scratch: &mut [f32],
    ) {
        let w = self.weights(parameters);
        let (k, n) = self.matrix();
        let rows = samples * self.rows();
        match self.kind {
            Kind::Dense { .. } => {
                matmul(
                    (rows, n, k),
                    Mat::rows(x, k),
                    Mat::rows(w, n),
                    y,
                    Write::Replace,
                );
                if self.bias {
                    let start = self.offset + k * n;
                    add_row(y, &parameters[start..start + n]);
                }
            }
            Kind::Convolution { windows, .. } => {
                let gathered = gathered(windows, x, scratch);
                matmul(
                    (rows, n, k),
                    Mat::rows(gathered, k),
                    Mat::rows(w, n),
                    y,
                    Write::Replace,
                );
            }
            Kind::Transposed { windows, .. } => {
                if windows.is_whole() {
                    matmul(
                        (rows, n, k),
                        Mat::rows(x, k),
                        Mat::rows(w, n),
                        y,
                        Write::Replace,
                    );
                } else {
                    matmul(
                        (rows, n, k),
                        Mat::rows(x, k),
                        Mat::rows(w, n),
                        scratch,
                        Write::Replace,
                    );
                    scatter(windows, scratch, y);
                }
            }
        }
        self.activation.apply(y);
    }

    /// Writes the gradient of the weights to `dw` (laid out as the chain's parameters), replacing or adding, and,
    /// where wanted, the gradient of the input to `dx`. `dy` comes in as the gradient of the output and leaves as that
    /// of the layer before its nonlinearity.
    #[expect(
        clippy::too_many_arguments,
        reason = "one gradient needs every one of them; a struct would only rename them"
    )]
    pub fn backward(
        &self,
        samples: usize,
        (x, y): (&[f32], &[f32]),
        parameters: &[f32],
        dy: &mut [f32],
        (dw, write): (&mut [f32], Write),
        dx: Option<&mut [f32]>,
        scratch: &mut [f32],
    ) {
        self.activation.backward(y, dy);
        let w = self.weights(parameters);
        let (k, n) = self.matrix();
        let rows = samples * self.rows();
        let (dw, after) = dw[self.offset..].split_at_mut(k * n);
        match self.kind {
            Kind::Dense { .. } => {
                matmul(
                    (k, n, rows),
                    Mat::transposed(x, k),
                    Mat::rows(dy, n),
                    dw,
                    write,
                );
                if self.bias {
                    if write == Write::Replace {
                        after[..n].fill(0.0);
                    }
                    sum_rows(dy, &mut after[..n]);
                }
                if let Some(dx) = dx {
                    matmul(
                        (rows, k, n),
                        Mat::rows(dy, n),
                        Mat::transposed(w, n),
                        dx,
                        Write::Replace,
                    );
                }
            }
            Kind::Convolution { windows, .. } => {
                let gathered = gathered(windows, x, scratch);
                matmul(
                    (k, n, rows),
                    Mat::transposed(gathered, k),
                    Mat::rows(dy, n),
                    dw,
                    write,
                );
                if let Some(dx) = dx {
                    matmul(
                        (rows, k, n),
                        Mat::rows(dy, n),
                        Mat::transposed(w, n),
                        scratch,
                        Write::Replace,
                    );
                    scatter(windows, scratch, dx);
                }
            }
            Kind::Transposed { windows, .. } => {
                let gathered = gathered(windows, dy, scratch);
                matmul(
                    (k, n, rows),
                    Mat::transposed(x, k),
                    Mat::rows(gathered, n),
                    dw,
                    write,
                );
                if let Some(dx) = dx {
                    matmul(
                        (rows, k, n),
                        Mat::rows(gathered, n),
                        Mat::transposed(w, n),
                        dx,
                        Write::Replace,
                    );
                }
            }
        }
    }
}

/// The windows of every image in `images` as rows; the images themselves where each is one window.
fn gathered<'a>(windows: Windows, images: &'a [f32], scratch: &'a mut [f32]) -> &'a [f32] {
    if windows.is_whole() {
        return images;
    }
    let rows = windows.count() * windows.len();
    for (image, rows) in images
        .chunks_exact(windows.image_len())
        .zip(scratch.chunks_exact_mut(rows))
    {
        windows.gather(image, rows);
    }
    scratch
}

/// Every image as the sum of its windows, which lie in `scratch` as rows.
fn scatter(windows: Windows, scratch: &[f32], images: &mut [f32]) {
    images.fill(0.0);
    let rows = windows.count() * windows.len();
    for (image, rows) in images
        .chunks_exact_mut(windows.image_len())
        .zip(scratch.chunks_exact(rows))
    {
        windows.scatter_add(rows, image);
    }
}
