//! The named models, and the named ways to train them.

use super::training::{Clipped, Init, Scaling};
use super::{Channels, Config, Training};
use crate::episode::{HAPTIC_CHANNELS, PROPRIO_CHANNELS};
use crate::modality::Expert;
use crate::model::kernel::pointwise::Activation;

/// Where the values come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// What the paper says; the released script where it is silent.
    Paper,
    /// The authors' released script.
    Released,
    /// What predicts best after an hour on two cores.
    #[default]
    Fast,
}

impl Preset {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Paper, Self::Released, Self::Fast];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Released => "released",
            Self::Fast => "fast",
        }
    }

    fn training(self) -> Training {
        let released = Training {
            epochs: 4096,
            batch: 32,
            learning_rate: 3e-4,
            warm_up: 0,
            final_rate: 1.0,
            clip: 0.5,
            clipped: Clipped::All,
            init: Init::Torch,
            scaling: Scaling::Released,
            force_scale: 100.0,
            sampled: true,
            n_step_after: vec![0, 3072],
            kl_weight: 1.0,
            kl_annealing: 0,
            kl_balance: 0.5,
            error_weight: 1.0,
            error_weights: Vec::new(),
            autoencoder_epochs: 0,
            bases_epochs: 0,
            masks: false,
            rollouts: 0.0,
            decoded: 0,
            segment: 0,
            segment_until: 0.0,
            average: 0.0,
        };
        match self {
            Self::Released => released,
            Self::Paper => Training {
                clipped: Clipped::Dynamics,
                n_step_after: Vec::new(),
                ..released
            },
            Self::Fast => Training {
                epochs: 200,
                batch: 16,
                learning_rate: 1e-3,
                warm_up: 200,
                final_rate: 0.02,
                init: Init::Scaled,
                scaling: Scaling::Standard,
                n_step_after: vec![0],
                kl_weight: 0.5,
                rollouts: 0.5,
                decoded: 5,
                ..released
            },
        }
    }
}

impl Config {
    /// Names that [`Self::preset`] knows.
    pub const NAMES: [&str; 6] = ["v", "vp", "vh", "vhp", "vhp-c", "v-h-p"];

    /// A named model, to be trained as `preset` says; none for a name that is not known.
    pub fn preset(name: &str, preset: Preset) -> Option<Self> {
        // As released, a model without a product has no prior in it either.
        let (experts, prior_expert): (&[Expert], bool) = match name {
            "v" => (&[Expert::Vision], false),
            "vp" => (&[Expert::Vision, Expert::Proprio], true),
            "vh" => (&[Expert::Vision, Expert::Haptic], true),
            "vhp" => (&[Expert::Vision, Expert::Joint], true),
            "vhp-c" => (&[Expert::Concat], false),
            "v-h-p" => (&[Expert::Vision, Expert::Haptic, Expert::Proprio], true),
            _ => return None,
        };
        let paper = preset == Preset::Paper;
        Some(Self {
            name: name.to_owned(),
            experts: experts.to_vec(),
            prior_expert,
            frame_size: 64,
            frame_stack: usize::from(!paper),
            window: 32,
            step_secs: None,
            latent: 16,
            hidden: 256,
            mixtures: 15,
            activation: if paper {
                Activation::Relu
            } else {
                Activation::Elu
            },
            haptic: Channels::of(&HAPTIC_CHANNELS),
            proprio: Channels::of(&PROPRIO_CHANNELS),
            training: Training {
                masks: name == "v-h-p",
                ..preset.training()
            },
        })
    }

    /// A named model with the default preset.
    pub fn named(name: &str) -> Option<Self> {
        Self::preset(name, Preset::default())
    }
}
