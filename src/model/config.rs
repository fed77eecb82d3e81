//! What a model is made of, and how it was trained: the `config.toml` of a checkpoint.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::kernel::pointwise::Activation;
use crate::episode::{HAPTIC_CHANNELS, Layout, PROPRIO_CHANNELS};
use crate::modality::{Expert, ExpertSet, Modality};

/// A setting that cannot be.
#[derive(Debug, Error)]
#[error("config key `{key}`: {what}")]
pub struct ConfigError {
    /// The key.
    pub key: &'static str,
    /// What is wrong, and what would be right.
    pub what: String,
}

/// Everything that describes a model. Unknown keys in a file are refused by name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// `v`, `vhp`, `v-h-p`.
    pub name: String,
    /// Sensor experts, in the order of the digits that switch them. Each decodes what it sees.
    pub experts: Vec<Expert>,
    /// Whether the dynamics prior is multiplied in; if not, it enters only the KL.
    pub prior_expert: bool,
    /// Side of the square frames in pixels.
    pub frame_size: usize,
    /// Earlier frames stacked under each frame, in and out: 1 as released, 0 in the paper.
    pub frame_stack: usize,
    /// W, samples of a window.
    pub window: usize,
    /// Time between two images in the training set; none until one has been seen.
    #[serde(default)]
    pub step_secs: Option<f64>,
    /// Z.
    pub latent: usize,
    /// Hidden state of the recurrent network.
    pub hidden: usize,
    /// K, base matrices of the dynamics.
    pub mixtures: usize,
    /// Nonlinearity of encoders and decoders: `elu` as released, `relu` in the paper.
    pub activation: Activation,
    /// Channels and scaling of force and torque.
    pub haptic: Channels,
    /// Channels and scaling of position and velocity.
    pub proprio: Channels,
    /// How it is trained.
    pub training: Training,
}

/// Which channels of a window a model sees, and how they are scaled: `(x - mean) / scale`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channels {
    /// Names: `fx fy fz tx ty tz` or `px py pz vx vy vz`.
    pub names: Vec<String>,
    /// One a channel; empty until a training set has been seen.
    #[serde(default)]
    pub mean: Vec<f32>,
    /// One a channel; empty until a training set has been seen.
    #[serde(default)]
    pub scale: Vec<f32>,
}

/// How a model is trained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Training {
    /// Episodes of a batch.
    pub batch: usize,
    /// Peak learning rate of Adam.
    pub learning_rate: f64,
    /// Updates over which the rate rises to its peak.
    pub warm_up: usize,
    /// The rate falls along a cosine to this part of its peak; 1 keeps it.
    pub final_rate: f64,
    /// Largest gradient norm of each network.
    pub clip: f32,
    /// Steps ahead that the prior is held to the posterior (overshooting); 1 is the plain KL.
    pub n_step: usize,
    /// Weight of the KL.
    pub kl_weight: f64,
    /// Weight of each expert's squared error, in the order of the experts; empty until a training set has been seen.
    #[serde(default)]
    pub error_weights: Vec<f32>,
    /// Whether experts are left out at random while training, so that switches are in the distribution.
    pub masks: bool,
}

impl Config {
    /// The settings of a named model; none for a name that is not known.
    pub fn named(name: &str) -> Option<Self> {
        let (experts, prior_expert, masks) = match name {
            "v" => (vec![Expert::Vision], false, false),
            "vhp" => (vec![Expert::Vision, Expert::Joint], true, false),
            "v-h-p" => (
                vec![Expert::Vision, Expert::Haptic, Expert::Proprio],
                true,
                true,
            ),
            _ => return None,
        };
        Some(Self {
            name: name.to_owned(),
            experts,
            prior_expert,
            frame_size: 64,
            frame_stack: 1,
            window: 32,
            step_secs: None,
            latent: 16,
            hidden: 256,
            mixtures: 15,
            activation: Activation::Elu,
            haptic: Channels::of(&HAPTIC_CHANNELS),
            proprio: Channels::of(&PROPRIO_CHANNELS),
            training: Training {
                batch: 32,
                learning_rate: 1e-3,
                warm_up: 200,
                final_rate: 0.02,
                clip: 0.5,
                n_step: 2,
                kl_weight: 0.5,
                error_weights: Vec::new(),
                masks,
            },
        })
    }

    /// Names that [`Self::named`] knows.
    pub const NAMES: [&str; 3] = ["v", "vhp", "v-h-p"];

    /// Numbers of a control.
    pub const CONTROL: usize = 2;

    /// The sizes an episode is laid out in for this model.
    pub fn layout(&self) -> Layout {
        Layout {
            frame_size: self.frame_size,
            window: self.window,
        }
    }

    /// Experts that can be switched: the sensors and the prior.
    pub fn switches(&self) -> usize {
        self.experts.len() + 1
    }

    /// The sets of sensor experts it is trained on, with the prior always in.
    pub fn trained_sets(&self) -> Vec<ExpertSet> {
        let all = ExpertSet::full(self.experts.len());
        if self.training.masks {
            (0..=all.0).map(ExpertSet).collect()
        } else {
            vec![all]
        }
    }

    /// The channels of a window expert, haptic before proprio.
    pub fn channels(&self, expert: Expert) -> Vec<(&Channels, Modality)> {
        let of = |&modality: &Modality| match modality {
            Modality::Vision => None,
            Modality::Haptic => Some((&self.haptic, modality)),
            Modality::Proprio => Some((&self.proprio, modality)),
        };
        expert.modalities().iter().filter_map(of).collect()
    }

    /// Checks what the networks rely on.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let refuse = |key, what: String| Err(ConfigError { key, what });
        if self.experts.first() != Some(&Expert::Vision) || self.experts.contains(&Expert::Prior) {
            return refuse(
                "experts",
                "start with \"vision\", and leave out \"prior\", which is always there".into(),
            );
        }
        if self.frame_size != 64 {
            return refuse(
                "frame_size",
                format!(
                    "the image networks are for 64 pixels, not {}",
                    self.frame_size
                ),
            );
        }
        if self.window == 0 || self.latent == 0 || self.hidden == 0 || self.mixtures == 0 {
            return refuse("window, latent, hidden, mixtures", "must not be 0".into());
        }
        for (key, channels, known) in [
            ("haptic", &self.haptic, HAPTIC_CHANNELS),
            ("proprio", &self.proprio, PROPRIO_CHANNELS),
        ] {
            if let Some(name) = channels
                .names
                .iter()
                .find(|name| !known.contains(&name.as_str()))
            {
                return refuse(
                    key,
                    format!("no channel {name:?}; there are {}", known.join(" ")),
                );
            }
            for numbers in [&channels.mean, &channels.scale] {
                if !numbers.is_empty() && numbers.len() != channels.names.len() {
                    return refuse(
                        key,
                        format!(
                            "{} channels but {} numbers",
                            channels.names.len(),
                            numbers.len()
                        ),
                    );
                }
            }
            if channels
                .scale
                .iter()
                .any(|scale| !scale.is_finite() || *scale <= 0.0)
            {
                return refuse(key, "a scale must be a positive number".into());
            }
        }
        if !self.training.error_weights.is_empty()
            && self.training.error_weights.len() != self.experts.len()
        {
            return refuse(
                "training.error_weights",
                format!("one for each of {} experts", self.experts.len()),
            );
        }
        if self.training.batch == 0 || self.training.n_step == 0 {
            return refuse(
                "training.batch, training.n_step",
                "must be at least 1".into(),
            );
        }
        Ok(())
    }
}

impl Channels {
    fn of(names: &[&str]) -> Self {
        Self {
            names: names.iter().map(|&name| name.to_owned()).collect(),
            mean: Vec::new(),
            scale: Vec::new(),
        }
    }

    /// For each channel: its place among all of the modality's channels, its mean and its scale.
    pub fn columns<'a>(
        &'a self,
        known: &'a [&str],
    ) -> impl Iterator<Item = (usize, f32, f32)> + 'a {
        self.names.iter().enumerate().filter_map(move |(i, name)| {
            let at = known.iter().position(|known| known == name)?;
            Some((
                at,
                self.mean.get(i).copied().unwrap_or(0.0),
                self.scale.get(i).copied().unwrap_or(1.0),
            ))
        })
    }
}
