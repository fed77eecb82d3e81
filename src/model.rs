//! What is learned: tensors in, tensors out. Knows no dataset file and no screen.
//!
//! Each sensor expert is an [`encoder`] from what it sees to a Gaussian; [`dynamics`] states the prior expert; [`experts`]
//! multiplies them; [`filter`] goes step by step; a [`decoder`] an expert turns a latent back into what it sees.

pub mod checkpoint;
pub mod config;
pub mod decoder;
pub mod dynamics;
pub mod elbo;
pub mod encoder;
pub mod experts;
pub mod fallback;
pub mod filter;
pub mod gaussian;
pub mod inspect;
pub mod kernel;
mod layers;
pub mod network;
pub mod observation;
pub mod probe;
pub mod switches;
pub mod trace;

use candle_core::{Device, Result, Tensor};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use self::config::Config;
use self::decoder::Decoder;
use self::dynamics::Dynamics;
use self::encoder::Encoder;
use self::network::{Draw, Network};
use crate::modality::Expert;

/// A model: an encoder for each sensor expert, a decoder for each stream they see, and the dynamics.
#[derive(Debug)]
pub struct Model {
    /// Its sizes and settings.
    pub config: Config,
    /// In the order of the experts.
    pub encoders: Vec<Encoder>,
    /// In the order of the streams.
    pub decoders: Vec<Decoder>,
    /// The prior expert.
    pub dynamics: Dynamics,
}

/// The folded weights of every network: with gradients while training, without once trained.
#[derive(Clone, Debug)]
pub struct Weights {
    /// In the order of the experts, one for each of an encoder's networks.
    pub encoders: Vec<Vec<Tensor>>,
    /// In the order of the streams.
    pub decoders: Vec<Tensor>,
    /// The dynamics'.
    pub dynamics: Tensor,
}

impl Weights {
    /// The same without a gradient.
    #[must_use]
    pub fn detach(&self) -> Self {
        let all = |weights: &[Tensor]| weights.iter().map(Tensor::detach).collect();
        Self {
            encoders: self.encoders.iter().map(|part| all(part)).collect(),
            decoders: all(&self.decoders),
            dynamics: self.dynamics.detach(),
        }
    }
}

/// The stem of an expert's networks in a checkpoint, as the authors name theirs.
fn stem(expert: Expert) -> &'static str {
    match expert {
        Expert::Vision => "img",
        Expert::Joint => "context",
        other => other.name(),
    }
}

impl Model {
    /// A model before training, its parameters drawn from `seed`. The config must have been validated.
    pub fn new(config: Config, seed: u64, device: &Device) -> Result<Self> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        Self::build(config, &mut |parameters| parameters.init(&mut rng), device)
    }

    /// A model before its parameters are read: all zero. The config must have been validated.
    pub fn blank(config: Config, device: &Device) -> Result<Self> {
        Self::build(
            config,
            &mut |parameters| vec![0.0; parameters.norm.trained()],
            device,
        )
    }

    fn build(config: Config, draw: &mut Draw, device: &Device) -> Result<Self> {
        let encoders = config
            .experts
            .iter()
            .map(|&expert| Encoder::new(&config, expert, draw, device))
            .collect::<Result<_>>()?;
        let decoders = config
            .streams()
            .into_iter()
            .map(|stream| Decoder::new(&config, stream, draw, device))
            .collect::<Result<_>>()?;
        let dynamics = Dynamics::new(&config, "dyn", draw, device)?;
        Ok(Self {
            config,
            encoders,
            decoders,
            dynamics,
        })
    }

    /// Every network: encoders, decoders, dynamics.
    pub fn networks(&self) -> impl Iterator<Item = &Network> {
        let encoders = self.encoders.iter().flat_map(Encoder::networks);
        let decoders = self.decoders.iter().map(|decoder| &decoder.network);
        encoders
            .chain(decoders)
            .chain(std::iter::once(&self.dynamics.network))
    }

    /// Trained numbers of all networks.
    pub fn parameters(&self) -> usize {
        self.networks()
            .map(|network| network.theta().elem_count())
            .sum()
    }

    /// The folded weights of every network, with gradients.
    pub fn weights(&self) -> Result<Weights> {
        Ok(Weights {
            encoders: self
                .encoders
                .iter()
                .map(Encoder::folded)
                .collect::<Result<_>>()?,
            decoders: self
                .decoders
                .iter()
                .map(|d| d.network.folded())
                .collect::<Result<_>>()?,
            dynamics: self.dynamics.network.folded()?,
        })
    }
}
