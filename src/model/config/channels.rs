//! Which channels of a window a model sees, and how they are scaled.

use serde::{Deserialize, Serialize};

use super::{ConfigError, refuse, repeats};

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

impl Channels {
    pub(super) fn of(names: &[&str]) -> Self {
        Self {
            names: names.iter().map(|&name| name.to_owned()).collect(),
            mean: Vec::new(),
            scale: Vec::new(),
        }
    }

    pub(super) fn validate(&self, key: &'static str, known: &[&str]) -> Result<(), ConfigError> {
        if let Some(name) = self
            .names
            .iter()
            .find(|name| !known.contains(&name.as_str()))
        {
            return refuse(
                key,
                format!("no channel {name:?}; there are {}", known.join(" ")),
            );
        }
        if self.names.is_empty() || repeats(&self.names) {
            return refuse(key, "name at least one channel, and each once");
        }
        for numbers in [&self.mean, &self.scale] {
            if !numbers.is_empty() && numbers.len() != self.names.len() {
                return refuse(
                    key,
                    format!(
                        "{} channels but {} numbers",
                        self.names.len(),
                        numbers.len()
                    ),
                );
            }
        }
        if self.mean.iter().any(|mean| !mean.is_finite())
            || self.scale.iter().any(|s| !s.is_finite() || *s <= 0.0)
        {
            return refuse(key, "a mean must be a number, a scale a positive one");
        }
        Ok(())
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
