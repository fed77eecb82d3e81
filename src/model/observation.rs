//! An episode as what each expert sees: stacked frames, and the scaled channels of a window.

use thiserror::Error;

use super::config::Config;
use crate::episode::{Episode, HAPTIC_CHANNELS, PROPRIO_CHANNELS};
use crate::modality::{Expert, Modality};

/// Why a model cannot look at an episode.
#[derive(Debug, Error)]
pub enum ObserveError {
    /// The model needs what was not recorded.
    #[error("model `{model}` needs {roles}, which episode `{episode}` lacks")]
    Missing {
        /// The model's name.
        model: String,
        /// The roles, joined by commas.
        roles: String,
        /// The episode's name.
        episode: String,
    },
    /// The episode is laid out in other sizes than the model's.
    #[error("model `{model}` wants {wanted}, episode `{episode}` has {found}")]
    Sizes {
        /// The model's name.
        model: String,
        /// Its sizes.
        wanted: String,
        /// The episode's name.
        episode: String,
        /// Its sizes.
        found: String,
    },
}

/// A model was trained on another kind of data than it is shown.
#[derive(Debug, Error)]
pub enum Unsuited {
    /// The time between images differs.
    #[error(
        "model `{model}` was trained on images {trained_secs:.3} s apart, those of episode `{episode}` are \
         {found_secs:.3} s apart; choose a model trained on such data"
    )]
    Rate {
        /// The model's name.
        model: String,
        /// In its training set.
        trained_secs: f64,
        /// The episode's name.
        episode: String,
        /// In the episode.
        found_secs: f64,
    },
    /// A channel has values that are no numbers.
    #[error(
        "channel `{channel}` of episode `{episode}` has values that are not finite numbers, which model `{model}` cannot \
         be shown; switch to a model without that sensor, or record the episode again"
    )]
    NotFinite {
        /// The channel.
        channel: String,
        /// The model's name.
        model: String,
        /// The episode's name.
        episode: String,
    },
    /// A channel is far outside of what the model has seen.
    #[error(
        "channel `{channel}` of episode `{episode}` lies {times:.0} times model `{model}`'s scale from its mean: other \
         units or another sensor than it was trained on; choose a model trained on such data"
    )]
    Scaling {
        /// The channel.
        channel: String,
        /// The model's name.
        model: String,
        /// The episode's name.
        episode: String,
        /// Root mean square of the scaled channel.
        times: f32,
    },
}

/// Times between images may differ by this factor from those of the training set.
const RATE_TOLERANCE: f64 = 1.25;
/// Channels that are scaled by the training set's deviation have a root mean square near 1; beyond this they are of another
/// kind. Of fixed scales, as `released` has them, it tells only what is off by more than that from all that was seen.
const SCALE_TOLERANCE: f32 = 30.0;

/// Whether `episode` is of the kind of data the model was trained on: image rate, and units of its channels.
pub fn suits(config: &Config, episode: &Episode) -> Result<(), Unsuited> {
    if let (Some(trained_secs), Some(found_secs)) = (config.step_secs, episode.step_secs()) {
        let ratio = (found_secs / trained_secs).max(trained_secs / found_secs);
        if ratio.is_nan() || ratio > RATE_TOLERANCE {
            let (model, episode) = (config.name.clone(), episode.meta.id.clone());
            return Err(Unsuited::Rate {
                model,
                trained_secs,
                episode,
                found_secs,
            });
        }
    }
    for (channels, modality) in config
        .experts
        .iter()
        .flat_map(|&expert| config.channels(expert))
    {
        let Some((data, known)) = channels_of(episode, modality) else {
            continue;
        };
        for ((at, mean, scale), channel) in channels.columns(known).zip(&channels.names) {
            let squares = data
                .iter()
                .skip(at)
                .step_by(6)
                .map(|x| ((x - mean) / scale).powi(2))
                .sum::<f32>();
            let times = (squares * 6.0 / data.len() as f32).sqrt();
            let (model, episode) = (&config.name, &episode.meta.id);
            if !times.is_finite() {
                return Err(Unsuited::NotFinite {
                    channel: channel.clone(),
                    model: model.clone(),
                    episode: episode.clone(),
                });
            }
            if times > SCALE_TOLERANCE {
                return Err(Unsuited::Scaling {
                    channel: channel.clone(),
                    model: model.clone(),
                    episode: episode.clone(),
                    times,
                });
            }
        }
    }
    Ok(())
}

/// Names of all channels that windows of a modality have; none for vision.
pub fn known(modality: Modality) -> &'static [&'static str] {
    match modality {
        Modality::Vision => &[],
        Modality::Haptic => &HAPTIC_CHANNELS,
        Modality::Proprio => &PROPRIO_CHANNELS,
    }
}

/// The windows of a modality, `(T, W, 6)`, and the names of its channels; none for vision or where not recorded.
pub fn channels_of(
    episode: &Episode,
    modality: Modality,
) -> Option<(&[f32], &'static [&'static str])> {
    let data = match modality {
        Modality::Vision => None,
        Modality::Haptic => episode.haptic.as_deref(),
        Modality::Proprio => episode.proprio.as_deref(),
    };
    data.map(|data| (data, known(modality)))
}

/// What each stream of a model holds of one episode, belief by belief.
#[derive(Clone, Debug, PartialEq)]
pub struct Observations {
    /// Beliefs: the steps but the first `frame_stack`.
    pub beliefs: usize,
    /// One a stream, `(beliefs, inputs)`, channels last.
    pub streams: Vec<Vec<f32>>,
    /// `(beliefs - 1, U)`: row i acts from belief i to i + 1.
    pub controls: Vec<[f32; 2]>,
}

/// Roles that a model needs and an episode lacks.
pub fn missing(config: &Config, episode: &Episode) -> Vec<String> {
    let mut roles = Vec::new();
    for modality in config.experts.iter().flat_map(|expert| expert.modalities()) {
        match modality {
            Modality::Haptic if episode.haptic.is_none() => roles.push("haptic".to_owned()),
            Modality::Proprio if episode.proprio.is_none() => roles.push("proprio".to_owned()),
            _ => {}
        }
    }
    if episode.controls.is_none() {
        roles.push("control".to_owned());
    }
    roles
}

/// What each expert sees of `episode`.
pub fn observe(config: &Config, episode: &Episode) -> Result<Observations, ObserveError> {
    seen(config, episode, &config.streams())
}

/// What expert `index` alone sees of `episode`: the streams of no other are made. As in [`observe`], an episode that
/// lacks a role of any expert is refused.
pub fn observe_expert(
    config: &Config,
    episode: &Episode,
    index: usize,
) -> Result<Observations, ObserveError> {
    let expert = config.experts.get(index);
    seen(config, episode, expert.map_or(&[], |e| e.streams()))
}

fn seen(
    config: &Config,
    episode: &Episode,
    streams: &[Expert],
) -> Result<Observations, ObserveError> {
    let beliefs = beliefs(config, episode)?;
    let stack = config.frame_stack;
    let streams = streams
        .iter()
        .map(|&stream| match stream {
            Expert::Vision => frames(episode, stack),
            _ => windows(config, stream, episode, stack),
        })
        .collect();
    let controls = episode.controls.iter().flatten();
    Ok(Observations {
        beliefs,
        streams,
        controls: controls.skip(stack).copied().collect(),
    })
}

/// The beliefs that an episode gives, which has everything in the model's sizes.
fn beliefs(config: &Config, episode: &Episode) -> Result<usize, ObserveError> {
    let roles = missing(config, episode);
    if !roles.is_empty() {
        return Err(ObserveError::Missing {
            model: config.name.clone(),
            roles: roles.join(", "),
            episode: episode.meta.id.clone(),
        });
    }
    let size_error = |wanted: String, found: String| ObserveError::Sizes {
        model: config.name.clone(),
        wanted,
        episode: episode.meta.id.clone(),
        found,
    };
    let (wanted, found) = (config.layout(), episode.layout);
    if wanted != found {
        let say = |layout: crate::episode::Layout| {
            format!(
                "frames of {0} x {0} pixels and windows of {1} samples",
                layout.frame_size, layout.window
            )
        };
        return Err(size_error(say(wanted), say(found)));
    }
    let stack = config.frame_stack;
    let beliefs = episode.steps().saturating_sub(stack);
    if beliefs < 2 {
        return Err(size_error(
            format!("{} images or more", stack + 2),
            format!("{}", episode.steps()),
        ));
    }
    Ok(beliefs)
}

/// `(beliefs, height, width, stack + 1)`: channel 0 the newest frame, in [0, 1].
fn frames(episode: &Episode, stack: usize) -> Vec<f32> {
    let pixels = episode.layout.frame_size * episode.layout.frame_size;
    let channels = stack + 1;
    let mut out = vec![0.0; (episode.steps() - stack) * pixels * channels];
    for (belief, image) in out.chunks_exact_mut(pixels * channels).enumerate() {
        for channel in 0..channels {
            let frame = &episode.frames[belief + stack - channel];
            for (to, &from) in image[channel..]
                .iter_mut()
                .step_by(channels)
                .zip(&frame.pixels)
            {
                *to = f32::from(from) / 255.0;
            }
        }
    }
    out
}

/// `(beliefs, W, channels)`, scaled, haptic before proprio.
fn windows(config: &Config, expert: Expert, episode: &Episode, stack: usize) -> Vec<f32> {
    let mut sources = Vec::new();
    for (channels, modality) in config.channels(expert) {
        if let Some((data, known)) = channels_of(episode, modality) {
            sources.push((data, channels.columns(known).collect::<Vec<_>>()));
        }
    }
    let samples = episode.layout.window * stack..episode.layout.window * episode.steps();
    let mut out = Vec::new();
    for sample in samples {
        for (data, columns) in &sources {
            out.extend(
                columns
                    .iter()
                    .map(|&(at, mean, scale)| (data[sample * 6 + at] - mean) / scale),
            );
        }
    }
    out
}
