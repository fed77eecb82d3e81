//! `p(z_t | z_{t-1}, u_{t-1})`: the prior expert, locally linear with matrices mixed by a recurrent network.

use candle_core::{D, Device, Result, Tensor};

use super::config::{self, Config};
use super::fallback;
use super::gaussian::DiagGaussian;
use super::kernel::cell::{Cell, Sizes};
use super::kernel::weight_norm::Stretch;
use super::network::{Draw, Init, Network, Parameters};

/// Variance of the first prior, N(0, 20 I).
pub const FIRST_VARIANCE: f64 = 20.0;

/// The learned dynamics.
#[derive(Debug)]
pub struct Dynamics {
    /// Its parameters.
    pub network: Network,
    sizes: Sizes,
}

/// The recurrent state after a transition, and the prior it states.
#[derive(Clone, Debug)]
pub struct Transition {
    /// `(B, hidden)`.
    pub hidden: Tensor,
    /// `(B, Z)`.
    pub prior: DiagGaussian,
}

fn parameters(sizes: Sizes, init: config::Init) -> Parameters {
    let Sizes {
        latent,
        inputs,
        hidden,
        mixtures,
    } = sizes;
    let mut p = Parameters::default();
    let (gates, head) = (3 * hidden, mixtures + latent);
    let recurrent = Init::Uniform(1.0 / (hidden as f32).sqrt());
    for (name, rows) in [("weight_ih_l0", inputs), ("weight_hh_l0", hidden)] {
        let base = p.push(Stretch::Plain(rows * gates), recurrent);
        p.slot(
            format!("rnn.{name}"),
            &[gates, rows],
            &[(gates, 1), (rows, gates as isize)],
            base,
        );
    }
    for name in ["bias_ih_l0", "bias_hh_l0"] {
        let base = p.push(Stretch::Plain(gates), recurrent);
        p.slot(format!("rnn.{name}"), &[gates], &[(gates, 1)], base);
    }
    let g = p.push(
        Stretch::Normed {
            outer: hidden,
            norms: head,
            inner: 1,
        },
        recurrent,
    );
    let bias = match init {
        config::Init::Torch => recurrent,
        config::Init::Scaled => Init::Zero,
    };
    let bias = p.push(Stretch::Plain(head), bias);
    for (name, first, len) in [("linear", 0, mixtures), ("fc_logvar", mixtures, latent)] {
        p.slot(format!("{name}.bias"), &[len], &[(len, 1)], bias + first);
        p.slot(
            format!("{name}.weight_g"),
            &[len, 1],
            &[(len, 1)],
            g + first,
        );
        p.slot(
            format!("{name}.weight_v"),
            &[len, hidden],
            &[(len, 1), (hidden, head as isize)],
            g + head + first,
        );
    }
    let bases = p.push(
        Stretch::Plain(mixtures * latent * inputs),
        Init::Bases {
            latent,
            columns: inputs,
            disturbed: (init == config::Init::Scaled).then_some(0.1),
        },
    );
    for (name, first, len) in [("A", 0, latent), ("B", latent, inputs - latent)] {
        let axes = [
            (mixtures, (latent * inputs) as isize),
            (latent, inputs as isize),
            (len, 1),
        ];
        p.slot(name, &[mixtures, latent, len], &axes, bases + first);
    }
    p
}

impl Dynamics {
    /// Dynamics of a model's sizes.
    pub fn new(config: &Config, name: &str, draw: &mut Draw, device: &Device) -> Result<Self> {
        let sizes = Sizes {
            latent: config.latent,
            inputs: config.latent + Config::CONTROL,
            hidden: config.hidden,
            mixtures: config.mixtures,
        };
        Ok(Self {
            network: Network::new(name, parameters(sizes, config.training.init), draw, device)?,
            sizes,
        })
    }

    /// 1 at the base matrices, else 0, laid out as the parameters.
    pub fn bases_mask(&self) -> Result<Tensor> {
        let all = self.network.theta().elem_count();
        let bases = self.sizes.parts()[6];
        let mask = (0..all).map(|i| f32::from(i >= all - bases)).collect();
        Tensor::from_vec(mask, all, self.network.theta().device())
    }

    /// Sizes of its cell.
    pub(super) fn sizes(&self) -> Sizes {
        self.sizes
    }

    /// What is believed before anything is seen: the zero state and N(0, 20 I), for `batch` episodes.
    pub fn zero_state(&self, batch: usize, device: &Device) -> Result<Transition> {
        let mean = Tensor::zeros((batch, self.sizes.latent), candle_core::DType::F32, device)?;
        let log_var = mean.affine(0.0, FIRST_VARIANCE.ln())?;
        let hidden = Tensor::zeros((batch, self.sizes.hidden), candle_core::DType::F32, device)?;
        Ok(Transition {
            hidden,
            prior: DiagGaussian { mean, log_var },
        })
    }

    /// One step from the state `hidden (B, hidden)` with latent `z (B, Z)` and control `u (B, U)`.
    pub fn step(
        &self,
        hidden: &Tensor,
        z: &Tensor,
        u: &Tensor,
        weights: &Tensor,
    ) -> Result<Transition> {
        let x = Tensor::cat(&[z, u], 1)?;
        let out = if weights.device().is_cpu() {
            hidden
                .contiguous()?
                .apply_op3(&x, weights, Cell::new(self.sizes))?
        } else {
            fallback::cell(self.sizes, hidden, &x, weights)?
        };
        let Sizes { latent, hidden, .. } = self.sizes;
        Ok(Transition {
            hidden: out.narrow(1, 0, hidden)?,
            prior: DiagGaussian {
                mean: out.narrow(1, hidden, latent)?,
                log_var: out.narrow(1, hidden + latent, latent)?,
            },
        })
    }

    /// `[A_t | B_t]`, `(B, Z, Z + U)`, of the transition that led to the state `hidden (B, hidden)`.
    pub fn matrices(&self, hidden: &Tensor, weights: &Tensor) -> Result<Tensor> {
        let Sizes {
            latent,
            inputs,
            hidden: width,
            mixtures,
        } = self.sizes;
        let parts = self.sizes.parts();
        let start: usize = parts[..4].iter().sum();
        let head = weights
            .narrow(0, start, parts[4])?
            .reshape((width, mixtures + latent))?;
        let bias = weights.narrow(0, start + parts[4], parts[5])?;
        let logits = hidden
            .contiguous()?
            .matmul(&head)?
            .broadcast_add(&bias)?
            .narrow(1, 0, mixtures)?;
        let mixture = candle_nn::ops::softmax(&logits, D::Minus1)?;
        let bases = weights
            .narrow(0, start + parts[4] + parts[5], parts[6])?
            .reshape((mixtures, latent * inputs))?;
        mixture
            .matmul(&bases)?
            .reshape((hidden.dim(0)?, latent, inputs))
    }
}
