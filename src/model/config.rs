//! What a model is made of, and how it was trained: the `config.toml` of a checkpoint.

mod channels;
mod preset;
mod set;
mod training;

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use self::channels::Channels;
pub use self::preset::Preset;
pub use self::training::{Clipped, Init, Scaling, Training};
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
    /// `v`, `vp`, `vh`, `vhp`, `vhp-c`, `v-h-p`, or one's own.
    pub name: String,
    /// Sensor experts, in the order of the digits that switch them. What each sees is also decoded.
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

impl Config {
    /// Numbers of a control.
    pub const CONTROL: usize = 2;

    /// The sizes an episode is laid out in for this model.
    pub fn layout(&self) -> Layout {
        Layout {
            frame_size: self.frame_size,
            window: self.window,
        }
    }

    /// What is observed and decoded, each with networks of its own: the experts, but for the concatenation, which sees
    /// frames and windows.
    pub fn streams(&self) -> Vec<Expert> {
        self.experts
            .iter()
            .flat_map(|expert| expert.streams())
            .copied()
            .collect()
    }

    /// Experts that can be switched: the sensors and the prior.
    pub fn switches(&self) -> usize {
        self.experts.len() + 1
    }

    /// Whether a belief is a product, of which an expert can be left out.
    pub fn has_product(&self) -> bool {
        self.experts.len() + usize::from(self.prior_expert) > 1
    }

    /// The sets of sensor experts it is trained on, with the prior always in.
    pub fn trained_sets(&self) -> Vec<ExpertSet> {
        let all = ExpertSet::full(self.experts.len());
        if self.training.masks {
            (0..=all.0).map(ExpertSet).collect()
        } else if self.training.rollouts > 0.0 {
            vec![ExpertSet(0), all]
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

    /// How many channels the windows of a stream have.
    pub fn window_channels(&self, stream: Expert) -> usize {
        let each = self.channels(stream).into_iter();
        each.map(|(channels, _)| channels.names.len()).sum()
    }

    /// Checks what the networks rely on.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let streams = self.streams();
        let first = streams.first() == Some(&Expert::Vision);
        if !first || self.experts.contains(&Expert::Prior) || repeats(&streams) {
            let what = "start with \"vision\", name each once, and leave out \"prior\", which is always there; or \
                        \"concat\" alone";
            return refuse("experts", what);
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
        let sizes = [
            ("window", self.window),
            ("latent", self.latent),
            ("hidden", self.hidden),
            ("mixtures", self.mixtures),
            ("training.batch", self.training.batch),
        ];
        if let Some((key, size)) = sizes
            .into_iter()
            .find(|(_, size)| !(1..=MOST).contains(size))
        {
            return refuse(key, format!("must lie between 1 and {MOST}, is {size}"));
        }
        let from_none = [
            ("frame_stack", self.frame_stack),
            ("training.n_step_after", self.training.n_step_after.len()),
        ];
        if let Some((key, count)) = from_none.into_iter().find(|&(_, count)| count >= MOST) {
            return refuse(
                key,
                format!("has {count} of them, where fewer than {MOST} are possible"),
            );
        }
        // A window encoder's last layer, and a window decoder's first.
        let widest = 2 * MOST_CHANNELS * self.window * self.latent;
        if widest > MOST_TOGETHER {
            let what = format!(
                "with {} latents these are {widest} numbers, more than {MOST_TOGETHER}",
                self.latent
            );
            return refuse("window", what);
        }
        // K matrices of Z by Z and Z by U, each read from a hidden layer.
        let largest = self.mixtures * self.latent * (self.latent + 2);
        if largest > MOST_TOGETHER {
            let what = format!(
                "with {} latents these are {largest} numbers, more than {MOST_TOGETHER}",
                self.latent
            );
            return refuse("mixtures", what);
        }
        if self
            .step_secs
            .is_some_and(|secs| !(secs.is_finite() && secs > 0.0))
        {
            return refuse("step_secs", "must be a positive number");
        }
        self.haptic.validate("haptic", &HAPTIC_CHANNELS)?;
        self.proprio.validate("proprio", &PROPRIO_CHANNELS)?;
        self.training.validate(streams.len())
    }
}

/// The most channels of a layer of the window networks.
const MOST_CHANNELS: usize = 256;
/// No size of a model is larger.
const MOST: usize = 4096;
/// Nor is a layer, or are the base matrices of its dynamics together: 256 MiB of them.
const MOST_TOGETHER: usize = 1 << 26;

fn refuse<T>(key: &'static str, what: impl Into<String>) -> Result<T, ConfigError> {
    Err(ConfigError {
        key,
        what: what.into(),
    })
}

fn repeats<T: PartialEq>(items: &[T]) -> bool {
    items
        .iter()
        .enumerate()
        .any(|(i, item)| items[..i].contains(item))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_named_models_are_valid_and_what_cannot_be_is_refused_by_key() {
        for (name, preset) in Config::NAMES
            .iter()
            .flat_map(|name| Preset::ALL.map(|p| (name, p)))
        {
            let config = Config::preset(name, preset);
            assert!(
                config.is_some_and(|c| c.validate().is_ok()),
                "{name} {preset:?}"
            );
        }
        let refused = |change: fn(&mut Config)| {
            let mut config = Config::named("v-h-p").expect("a known name");
            change(&mut config);
            config.validate().map_err(|error| error.key)
        };
        assert_eq!(refused(|c| c.hidden = 4_000_000_000), Err("hidden"));
        assert_eq!(
            refused(|c| (c.window, c.latent, c.mixtures) = (4096, 2048, 1)),
            Err("window")
        );
        assert_eq!(refused(|c| c.step_secs = Some(-0.1)), Err("step_secs"));
        assert_eq!(refused(|c| c.training.epochs = 0), Err("training.epochs"));
        assert_eq!(refused(|c| c.experts.push(Expert::Haptic)), Err("experts"));
        assert_eq!(refused(|c| c.experts.clear()), Err("experts"));
        assert_eq!(refused(|c| c.haptic.names.clear()), Err("haptic"));
        assert_eq!(
            refused(|c| c.proprio.names[0] = "qx".into()),
            Err("proprio")
        );
        assert_eq!(refused(|c| c.experts.push(Expert::Concat)), Err("experts"));
        assert_eq!(
            refused(|c| c.training.rollouts = 1.5),
            Err("training.rollouts")
        );
        // Each size may be had, but not all of them at once.
        assert_eq!(refused(|c| c.latent = 2048), Ok(()));
        let large = refused(|c| (c.latent, c.mixtures) = (4096, 4096));
        assert_eq!(large, Err("mixtures"));
        assert_eq!(refused(|c| c.training.segment = 1), Err("training.segment"));
        assert_eq!(
            refused(|c| c.training.learning_rate = f64::NAN),
            Err("training.learning_rate")
        );
        assert_eq!(
            refused(|c| c.training.error_weights = vec![1.0]),
            Err("training.error_weights")
        );
    }
}
