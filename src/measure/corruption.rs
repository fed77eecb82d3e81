//! Damage to what a modality recorded (D17): `x̃ = C_s(x)` with severity s.
//!
//! "Input damaged" is not "expert removed": the expert of a damaged modality still speaks, and a good one lowers its
//! own share. Damage acts on the recording, before anything is scaled or encoded, and never in place.
//!
//! All draws belong to the seed, the modality and the step alone. So the same step is hurt in the same way whatever
//! the range, and a sweep over severities scales one noise (or grows one set of held steps) instead of redrawing it.

mod frames;
mod timing;
mod windows;

use std::ops::Range;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::episode::Episode;
use crate::modality::Modality;

/// A kind of damage. What severity s in 0..=1 means is said at each; 0 is always the identity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Damage {
    /// Blended towards zero, `(1 − s) x`: frames towards black, windows towards 0 N, N·m, m and m/s. That is a
    /// reading like any other, not a sensor that is missing.
    Zero,
    /// The stream hangs: the first damaged step comes through, each later one repeats what the step before it showed
    /// with probability s. At 1 the whole range shows its first step. A window is repeated whole.
    Hold,
    /// Gaussian noise on every value, independent, of standard deviation s times the channel's own over the episode;
    /// for frames s times half the grey range, rounded and clamped.
    Noise,
    /// A mid-grey square whose side is s times the shorter side of the frame, centred at the patch, cut off at the
    /// border. For vision only.
    Occlude,
    /// A constant on every value: 3 s standard deviations of the channel over the episode; for frames s times half
    /// the grey range, clamped.
    Bias,
    /// The stream comes late by `round(8 s)` steps and never runs backwards: until the first late data arrive, the
    /// first damaged step's are shown.
    Delay,
}

impl Damage {
    /// Every kind, in the order in which faces list them.
    pub const ALL: [Self; 6] = [
        Self::Zero,
        Self::Hold,
        Self::Noise,
        Self::Occlude,
        Self::Bias,
        Self::Delay,
    ];

    /// `zero`, `hold`, `noise`, `occlude`, `bias` or `delay`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Hold => "hold",
            Self::Noise => "noise",
            Self::Occlude => "occlude",
            Self::Bias => "bias",
            Self::Delay => "delay",
        }
    }

    /// The damage of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|damage| damage.name() == name)
    }

    /// Those that have a meaning for a modality: windows cannot be occluded.
    pub fn of(modality: Modality) -> impl Iterator<Item = Self> {
        let fits = move |&damage: &Self| damage != Self::Occlude || modality == Modality::Vision;
        Self::ALL.into_iter().filter(fits)
    }
}

/// What is done to a modality's input, how badly, and from when to when.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Corruption {
    /// The kind of damage.
    pub damage: Damage,
    /// s, 0 to 1; anything beyond counts as the nearer end, NaN as 0.
    pub severity: f32,
    /// First damaged step.
    pub from: usize,
    /// The step after the last damaged one; none: to the end.
    pub until: Option<usize>,
    /// Centre of the occluding patch in parts of the frame: x to the right, y down, each 0 to 1.
    pub patch: [f32; 2],
    /// Seed of all draws.
    pub seed: u64,
}

impl Default for Corruption {
    /// Zeroed altogether, over the whole episode, the patch in the middle.
    fn default() -> Self {
        Self {
            damage: Damage::Zero,
            severity: 1.0,
            from: 0,
            until: None,
            patch: [0.5, 0.5],
            seed: 0,
        }
    }
}

impl Corruption {
    /// The severity that is acted on, in 0..=1.
    pub fn strength(&self) -> f32 {
        if self.severity.is_nan() {
            0.0
        } else {
            self.severity.clamp(0.0, 1.0)
        }
    }

    /// Whether a step is among those that it damages.
    pub fn acts_at(&self, step: usize) -> bool {
        self.severity > 0.0 && step >= self.from && self.until.is_none_or(|until| step < until)
    }

    /// The damaged ones of `steps` steps.
    fn range(&self, steps: usize) -> Range<usize> {
        let until = self.until.unwrap_or(steps).min(steps);
        self.from.min(until)..until
    }

    /// The draws of one step of one modality.
    fn draws(&self, modality: Modality, step: usize) -> ChaCha8Rng {
        let lane = match modality {
            Modality::Vision => 0,
            Modality::Haptic => 1,
            Modality::Proprio => 2,
        };
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(4 * step as u64 + lane);
        rng
    }
}

/// Whether a damage has a meaning for a modality.
pub fn applies(damage: Damage, modality: Modality) -> bool {
    Damage::of(modality).any(|fit| fit == damage)
}

/// The episode with one modality's input damaged.
///
/// Only that modality's `frames`, `haptic` or `proprio` change, and only the steps `from..until`; controls, `tip` and
/// `object` are ground truth and stay. What does not apply (see [`applies`]), was not recorded or has severity 0
/// leaves the episode as it is, bit for bit. A damaged frame also reaches the belief after its own, since encoders
/// see frames in stacks.
pub fn corrupt(episode: &Episode, modality: Modality, corruption: &Corruption) -> Episode {
    let mut damaged = episode.clone();
    if corruption.strength() == 0.0 || !applies(corruption.damage, modality) {
        return damaged;
    }
    let window = episode.layout.window;
    match modality {
        Modality::Vision => frames::damage(&mut damaged.frames, corruption),
        Modality::Haptic => {
            if let Some(data) = &mut damaged.haptic {
                windows::damage(data, window, modality, corruption);
            }
        }
        Modality::Proprio => {
            if let Some(data) = &mut damaged.proprio {
                windows::damage(data, window, modality, corruption);
            }
        }
    }
    damaged
}

#[cfg(test)]
mod tests;
