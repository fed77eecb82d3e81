//! The state string: a session in one line that can be pasted into a shell, a chat or a paper.
//!
//! ```text
//! v=1;episode=push_0007;step=6;model=v-h-p;context=4;horizon=11;scope=frame;speed=0.5;loop=all;alpha=vision:0@1-15,haptic:0.5@4
//! ```
//! | key | what it says |
//! | --- | --- |
//! | `alpha` | tempering: `vision:0@1-15,haptic:0.5@4` |
//! | `corrupt` | damaged inputs: `haptic:noise:0.5@3-7,vision:occlude:1:0.25x0.75` |
//! | `controls` | other controls than the recorded ones: `from:6,rotate:30,scale:0.5,mirror` |
//! | `samples`, `sample`, `seed` | how many; `on` where one is shown instead of the mean path; of all noise |
//! | `compare` | the second model |
//! | `marks`, `select` | marked steps of the episode, `3,7`; selected ones, `4-9`, or `4-` while the end is open |
//! | `rank` | what makes a failure: `nees` |
//!
//! Steps count from 1. A reach is `@4` for one step, `@4-7` for some, `@4-` for all from there on; without one it is
//! every step. α, damage, controls, sampling, selection and rank are as at the start where they are not mentioned;
//! every other key that is not there leaves things as they are. `%`, `;` and white space in names are written as
//! `%xx`. Keys that are not known are kept and written back.

mod alpha;
mod controls;
mod damage;
mod escape;
pub(super) mod names;
mod reach;
mod steps;

#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::RangeInclusive;

use super::command::{Looping, Scope};
use super::settings::{ControlEdit, SAMPLES, Sampling};
use crate::measure::corruption::Corruption;
use crate::measure::failure::Order;
use crate::modality::Modality;
use crate::model::switches::Switches;
use escape::{escape, unescape};
use names::{LOOPINGS, SCOPES, count, name_of, one_of};

/// The version written, and the only one that can be read.
const VERSION: &str = "1";

/// What a state string says; a key that is not there is left as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// The episode's name.
    pub episode: Option<String>,
    /// Step under the cursor, from 1.
    pub step: Option<usize>,
    /// The model's name; the second of the same name is `name#2`.
    pub model: Option<String>,
    /// The name of the model beside it.
    pub compare: Option<String>,
    /// c, the images seen.
    pub context: Option<usize>,
    /// h, the images predicted.
    pub horizon: Option<usize>,
    /// How far the next switch reaches.
    pub scope: Option<Scope>,
    /// Playback speed.
    pub speed: Option<f32>,
    /// What playback does at the end.
    pub looping: Option<Looping>,
    /// α where it is not as trained; a string without any means every expert as trained.
    pub switches: Switches,
    /// Damaged inputs; a string without any means none. Their seed is that of `sampling`.
    pub corruptions: BTreeMap<Modality, Corruption>,
    /// Other controls; a string without any means the recorded ones.
    pub controls: Option<ControlEdit>,
    /// Mean path or samples.
    pub sampling: Sampling,
    /// Marked steps of the episode, from 0; none leaves its marks as they are.
    pub marks: BTreeSet<usize>,
    /// First selected step from 0, and the last one once it is chosen.
    pub selection: Option<(usize, Option<usize>)>,
    /// What makes a failure.
    pub order: Order,
    /// Keys that mean nothing to this version, in order.
    pub unknown: Vec<(String, String)>,
}

impl State {
    /// First and last selected step, from 0, in order; none while the last one is not chosen.
    pub fn selected(&self) -> Option<RangeInclusive<usize>> {
        let (first, last) = self.selection?;
        last.map(|last| first.min(last)..=first.max(last))
    }

    /// Reads a state string; without `v` it is of this version. Each complaint names the key it is about; all other keys
    /// count.
    pub fn parse(text: &str) -> (Self, Vec<String>) {
        let mut state = Self::default();
        let mut complaints = Vec::new();
        for part in text
            .trim()
            .split(';')
            .filter(|part| !part.trim().is_empty())
        {
            let Some((key, raw)) = part.trim().split_once('=') else {
                complaints.push(format!("{part:?} is not key=value"));
                continue;
            };
            let value = unescape(raw);
            if let Err(why) = state.take(key, &value) {
                complaints.push(format!("{key}: {why}"));
            }
        }
        // The seed may stand before or after what it is for.
        for corruption in state.corruptions.values_mut() {
            corruption.seed = state.sampling.seed;
        }
        (state, complaints)
    }

    fn take(&mut self, key: &str, value: &str) -> Result<(), String> {
        match key {
            "v" if value == VERSION => {}
            "v" => return Err(format!("version {value:?}, this poescope reads {VERSION}")),
            "episode" => self.episode = Some(value.to_owned()),
            "step" => self.step = Some(count(value)?),
            "model" => self.model = Some(value.to_owned()),
            "compare" => self.compare = Some(value.to_owned()),
            "context" => self.context = Some(count(value)?),
            "horizon" => self.horizon = Some(count(value)?),
            "scope" => self.scope = Some(one_of(value, &SCOPES)?),
            "speed" => {
                let speed = value.parse();
                self.speed = Some(speed.map_err(|_| format!("{value:?} is not a number"))?);
            }
            "loop" => self.looping = Some(one_of(value, &LOOPINGS)?),
            "alpha" => self.switches = alpha::read(value)?,
            "corrupt" => self.corruptions = damage::read(value)?,
            "controls" => self.controls = controls::read(value)?,
            "samples" => {
                let samples = value.parse().ok().filter(|count| SAMPLES.contains(count));
                self.sampling.count = samples.ok_or_else(|| {
                    let (least, most) = (SAMPLES.start(), SAMPLES.end());
                    format!("{value:?} is not a number from {least} to {most}")
                })?;
            }
            "sample" => self.sampling.shown = one_of(value, &[("on", true), ("off", false)])?,
            "seed" => {
                let seed = value.parse();
                self.sampling.seed =
                    seed.map_err(|_| format!("{value:?} is not a whole number"))?;
            }
            "marks" => self.marks = steps::marks(value)?,
            "select" => self.selection = Some(steps::selection(value)?),
            "rank" => self.order = names::order(value)?,
            _ => self.unknown.push((key.to_owned(), value.to_owned())),
        }
        Ok(())
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "v={VERSION}")?;
        let numbers = |n: Option<usize>| n.map(|n| n.to_string());
        let (sampling, usual) = (self.sampling, Sampling::default());
        let unless = |usual: bool, text: String| (!usual).then_some(text);
        let pairs = [
            ("episode", self.episode.clone()),
            ("step", numbers(self.step)),
            ("model", self.model.clone()),
            ("compare", self.compare.clone()),
            ("context", numbers(self.context)),
            ("horizon", numbers(self.horizon)),
            ("scope", self.scope.map(|scope| name_of(scope, &SCOPES))),
            ("speed", self.speed.map(|speed| speed.to_string())),
            (
                "loop",
                self.looping.map(|looping| name_of(looping, &LOOPINGS)),
            ),
            ("alpha", filled(alpha::text(&self.switches))),
            ("corrupt", filled(damage::text(&self.corruptions))),
            ("controls", self.controls.as_ref().map(controls::text)),
            (
                "samples",
                unless(sampling.count == usual.count, sampling.count.to_string()),
            ),
            ("sample", sampling.shown.then(|| "on".to_owned())),
            (
                "seed",
                unless(sampling.seed == usual.seed, sampling.seed.to_string()),
            ),
            ("marks", filled(steps::marks_text(&self.marks))),
            ("select", self.selection.map(steps::selection_text)),
            (
                "rank",
                unless(self.order == Order::default(), self.order.name().to_owned()),
            ),
        ];
        let known = pairs
            .into_iter()
            .filter_map(|(key, value)| Some((key.to_owned(), value?)));
        for (key, value) in known.chain(self.unknown.iter().cloned()) {
            write!(f, ";{key}={}", escape(&value))?;
        }
        Ok(())
    }
}

fn filled(text: String) -> Option<String> {
    Some(text).filter(|text| !text.is_empty())
}
