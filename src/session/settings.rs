//! What undo takes back: switches, scope, context, horizon, damaged inputs, edited controls and sampling.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::command::Scope;
use crate::measure::corruption::Corruption;
use crate::measure::protocol::Protocol;
use crate::modality::Modality;
use crate::model::switches::Switches;

/// So many samples at least, for a covariance, and at most: more tell nothing new and take their time.
pub const SAMPLES: RangeInclusive<usize> = 2..=256;
/// From a stop to the fastest edited controls.
pub const SCALES: RangeInclusive<f32> = 0.0..=4.0;
/// How many changes can be taken back.
const HISTORY: usize = 256;

/// What a user sets besides the cursor. Context and horizon are wishes; [`Settings::rollout`] fits them to an episode.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// α of every expert.
    pub switches: Switches,
    /// How far the next switch reaches.
    pub scope: Scope,
    /// c, the images seen before the rollout.
    pub context: usize,
    /// h, the images predicted.
    pub horizon: usize,
    /// What is wrong with each modality's input.
    pub corruptions: BTreeMap<Modality, Corruption>,
    /// What the rollout does instead of the recorded controls.
    pub controls: Option<ControlEdit>,
    /// Mean path or samples.
    pub sampling: Sampling,
}

/// Whether a sample is shown instead of the mean path, and how many there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sampling {
    /// Whether frames show a sample.
    pub shown: bool,
    /// How many samples of the rollout there are.
    pub count: usize,
    /// Seed of their noise, and of the corruptions'.
    pub seed: u64,
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            shown: false,
            count: 32,
            seed: 0,
        }
    }
}

/// Other controls than the recorded ones from a step on: turned, scaled, mirrored, or none at all.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ControlEdit {
    /// The first step whose control is another one.
    pub from: usize,
    /// Turned by so many degrees from x towards y.
    pub rotate_deg: f32,
    /// Times as fast; 0 stops.
    pub scale: f32,
    /// Whether left and right of the path are exchanged: y becomes −y before it is turned.
    pub mirror: bool,
}

impl ControlEdit {
    /// The recorded controls from a step on.
    pub fn from(step: usize) -> Self {
        Self {
            from: step,
            rotate_deg: 0.0,
            scale: 1.0,
            mirror: false,
        }
    }

    /// Turned by so many degrees more; what it comes to lies in (-180, 180].
    #[must_use]
    pub fn turned(self, by_deg: f32) -> Self {
        let mut rotate_deg = self.rotate_deg + by_deg;
        // What is within keeps every bit, so that it can be written and read back.
        if rotate_deg <= -180.0 || rotate_deg > 180.0 {
            let whole = rotate_deg.rem_euclid(360.0);
            rotate_deg = if whole > 180.0 { whole - 360.0 } else { whole };
        }
        Self { rotate_deg, ..self }
    }

    /// So many times as fast as recorded, within [`SCALES`].
    #[must_use]
    pub fn scaled(self, scale: f32) -> Self {
        Self {
            scale: scale.clamp(*SCALES.start(), *SCALES.end()),
            ..self
        }
    }

    /// This edit, or none where it leaves every control as it was.
    pub fn unless_identity(self) -> Option<Self> {
        (!self.is_identity()).then_some(self)
    }

    /// Whether it leaves every control as it was.
    pub fn is_identity(&self) -> bool {
        self.rotate_deg == 0.0 && !self.mirror && (self.scale - 1.0).abs() < f32::EPSILON
    }

    /// The controls of the steps `first_step..`, edited: row i acts from step `first_step + i` on.
    pub fn apply(&self, first_step: usize, controls: &[[f32; 2]]) -> Vec<[f32; 2]> {
        let (sin, cos) = self.rotate_deg.to_radians().sin_cos();
        let edited = |(i, &[x, y]): (usize, &[f32; 2])| {
            if first_step + i < self.from || self.is_identity() {
                return [x, y];
            }
            let y = if self.mirror { -y } else { y };
            [
                self.scale * (cos * x - sin * y),
                self.scale * (sin * x + cos * y),
            ]
        };
        controls.iter().enumerate().map(edited).collect()
    }
}

impl Default for Settings {
    /// The paper's synthetic protocol: four images seen, eleven predicted.
    fn default() -> Self {
        Self {
            switches: Switches::default(),
            scope: Scope::Episode,
            context: Protocol::SYNTHETIC.context,
            horizon: Protocol::SYNTHETIC.horizon,
            corruptions: BTreeMap::new(),
            controls: None,
            sampling: Sampling::default(),
        }
    }
}

/// The steps of a rollout within one episode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Rollout {
    /// The last step it has seen, from 0.
    pub start: usize,
    /// How many steps it predicts; 0 only where the episode is too short for any.
    pub horizon: usize,
}

impl Settings {
    /// Context and horizon fitted to an episode: a belief before it, and at least one step after it where there is.
    pub fn rollout(&self, steps: usize, frame_stack: usize) -> Rollout {
        let latest = steps.saturating_sub(2).max(frame_stack);
        let start = self.context.saturating_sub(1).clamp(frame_stack, latest);
        let left = steps.saturating_sub(start + 1);
        Rollout {
            start,
            horizon: self.horizon.min(left),
        }
    }
}

/// Earlier and undone settings.
#[derive(Debug, Default)]
pub struct History {
    past: Vec<Settings>,
    future: Vec<Settings>,
}

impl History {
    /// Remembers what was before a change.
    pub fn record(&mut self, before: Settings) {
        if self.past.len() == HISTORY {
            self.past.remove(0);
        }
        self.past.push(before);
        self.future.clear();
    }

    /// The settings before the last change.
    pub fn undo(&mut self, now: &Settings) -> Option<Settings> {
        let before = self.past.pop()?;
        self.future.push(now.clone());
        Some(before)
    }

    /// The settings that were undone last.
    pub fn redo(&mut self, now: &Settings) -> Option<Settings> {
        let after = self.future.pop()?;
        self.past.push(now.clone());
        Some(after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::corruption::Damage;

    #[test]
    fn context_and_horizon_fit_the_episode() {
        let settings = Settings::default();
        let rollout = |steps, stack| {
            let Rollout { start, horizon } = settings.rollout(steps, stack);
            (start, horizon)
        };
        assert_eq!(rollout(16, 1), (3, 11));
        assert_eq!(rollout(8, 1), (3, 4));
        assert_eq!(rollout(3, 1), (1, 1));
        assert_eq!(rollout(2, 1), (1, 0));
        assert_eq!(rollout(1, 0), (0, 0));
        assert_eq!(rollout(0, 0), (0, 0));
        assert_eq!(rollout(16, 6), (6, 9));
    }

    #[test]
    fn edited_controls_turn_scale_mirror_and_stop_from_their_step_on() {
        let recorded = [[1.0, 0.0], [0.0, 2.0], [1.0, 1.0]];
        let edit = |edit: ControlEdit| edit.apply(4, &recorded);
        let from = ControlEdit::from(5);
        assert_eq!(edit(from), recorded);
        let stop = edit(ControlEdit { scale: 0.0, ..from });
        assert_eq!(stop, [[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]]);
        let mirror = edit(ControlEdit {
            mirror: true,
            ..from
        });
        assert_eq!(mirror, [[1.0, 0.0], [0.0, -2.0], [1.0, -1.0]]);
        let turned = edit(ControlEdit {
            rotate_deg: 90.0,
            scale: 0.5,
            ..from
        });
        assert!((turned[1][0] + 1.0).abs() < 1e-6 && turned[1][1].abs() < 1e-6);
    }

    #[test]
    fn turns_come_round_and_scales_keep_their_bounds() {
        let turned = |by: f32| ControlEdit::from(0).turned(by).rotate_deg;
        let whole: Vec<f32> = [15.0, 180.0, 195.0, -180.0, -190.0, 720.0]
            .map(turned)
            .to_vec();
        assert_eq!(whole, [15.0, 180.0, -165.0, 180.0, 170.0, 0.0]);
        let scales = [-1.0, 0.5, 9.0].map(|scale| ControlEdit::from(0).scaled(scale).scale);
        assert_eq!(scales.to_vec(), [0.0, 0.5, 4.0]);
        assert_eq!(ControlEdit::from(3).unless_identity(), None);
    }

    #[test]
    fn a_damaged_input_edited_controls_and_samples_can_be_taken_back() {
        let mut history = History::default();
        let before = Settings::default();
        let mut after = before.clone();
        let corruption = Corruption {
            damage: Damage::Noise,
            severity: 0.5,
            from: 0,
            until: None,
            patch: [0.5; 2],
            seed: 0,
        };
        after.corruptions.insert(Modality::Vision, corruption);
        after.controls = Some(ControlEdit::from(2).turned(30.0));
        after.sampling.shown = true;
        assert_ne!(before, after);
        history.record(before.clone());
        assert_eq!(history.undo(&after), Some(before.clone()));
        assert_eq!(history.redo(&before), Some(after));
    }

    #[test]
    fn a_new_change_forgets_what_was_undone() {
        let mut history = History::default();
        let at = |context| Settings {
            context,
            ..Settings::default()
        };
        history.record(at(4));
        assert_eq!(history.undo(&at(5)), Some(at(4)));
        assert_eq!(history.redo(&at(4)), Some(at(5)));
        assert_eq!(history.undo(&at(5)), Some(at(4)));
        history.record(at(4));
        assert_eq!(history.redo(&at(9)), None);
    }
}
