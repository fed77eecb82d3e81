//! Between a session and its state string.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::planning::MOST_HORIZON;
use super::settings::Settings;
use super::snapshot::ModelInfo;
use super::state::State;
use super::{Pending, Session};
use crate::modality::Expert;

/// A state whose model and episode have been found, and what was wrong with it so far.
pub(super) struct Restoration {
    state: State,
    complaints: Vec<String>,
}

impl Session {
    /// Goes to the model and the episode; the rest follows when the episode is there.
    pub(super) fn restore(&mut self, text: &str) {
        let (state, mut complaints) = State::parse(text);
        let mut target = self.target;
        if let Some(id) = &state.episode {
            match self.episode_keys.iter().position(|key| key == id) {
                Some(episode) => target.episode = episode,
                None => complaints.push(format!(
                    "episode: {} has none named {id:?}",
                    self.source.name()
                )),
            }
        }
        if let Some(name) = &state.model {
            match model_named(&self.models, name) {
                Some(model) => target.model = model,
                None => complaints.push(format!("model: none named {name:?} is loaded")),
            }
        }
        self.take_compared(&state, target.model, &mut complaints);
        self.pending.clear();
        if target != self.target {
            self.go_to(target);
        }
        let restoration = Restoration { state, complaints };
        if self.opened().is_some() {
            self.finish(restoration);
        } else {
            let restoration = Pending::Restoration(Box::new(restoration));
            self.pending.push_back(restoration);
        }
    }

    /// Takes over what needs the episode.
    pub(super) fn finish(&mut self, restoration: Restoration) {
        let Restoration {
            state,
            mut complaints,
        } = restoration;
        let steps = self.steps();
        self.change(|session| {
            let settings = &mut session.settings;
            settings.scope = state.scope.unwrap_or(settings.scope);
            let horizon = state.horizon.unwrap_or(settings.horizon);
            settings.horizon = horizon.min(MOST_HORIZON);
            take_bench(settings, &state);
            session.take_switches(&state, &mut complaints);
            // A wish, as the horizon is: an episode that has no room for it is shown with as much as it has.
            if let Some(context) = state.context {
                session.settings.context = context;
            }
            Ok("state restored".to_owned())
        });
        self.repair();
        let key = self.episode_keys.get(self.target.episode);
        // What was asked for while its episode was read, and is of another that was gone to meanwhile.
        let left = |id: &String| Some(id) != key && self.episode_keys.contains(id);
        let is_left = state.episode.as_ref().is_some_and(left);
        match state.step.filter(|_| !is_left) {
            Some(step) if step <= steps => self.playback.seek(step - 1, steps),
            Some(step) => complaints.push(format!("step: {step} is outside 1 to {steps}")),
            None => {}
        }
        if let Some(speed) = state.speed.filter(|&speed| !self.playback.set_speed(speed)) {
            complaints.push(format!(
                "speed: {speed} is not a power of two from 1/8 to 8"
            ));
        }
        self.playback.looping = state.looping.unwrap_or(self.playback.looping);
        if self.table.view().order != state.order {
            self.table.rank_by(state.order);
        }
        if !is_left {
            self.take_steps(&state, steps, &mut complaints);
        }
        let keys: Vec<&str> = state.unknown.iter().map(|(key, _)| key.as_str()).collect();
        let kept = format!("kept without a meaning here: {}", keys.join(", "));
        let is_known = keys.is_empty();
        self.unknown_keys = state.unknown;
        match (complaints.is_empty(), is_known) {
            (true, true) => {}
            // A later version may have written it: nothing is wrong.
            (true, false) => self.inform(kept),
            (false, _) => {
                complaints.extend((!is_known).then_some(kept));
                self.complain(complaints.join("; "));
            }
        }
    }

    fn take_compared(&mut self, state: &State, shown: usize, complaints: &mut Vec<String>) {
        let Some(name) = &state.compare else {
            return;
        };
        match model_named(&self.models, name) {
            Some(model) if model == shown => {
                complaints.push(format!("compare: {name:?} is the model itself"));
            }
            Some(model) => self.compare = Some(model),
            None => complaints.push(format!("compare: none named {name:?} is loaded")),
        }
    }

    /// Marks and selection, where the episode has such steps.
    fn take_steps(&mut self, state: &State, steps: usize, complaints: &mut Vec<String>) {
        let (marks, outside): (Vec<usize>, Vec<usize>) =
            state.marks.iter().partition(|&&mark| mark < steps);
        if let Some(mark) = outside.first() {
            complaints.push(format!("marks: {} is outside 1 to {steps}", mark + 1));
        }
        if let Some(key) = self.episode_keys.get(self.target.episode) {
            // Marks are work of the user's: a string without any leaves them.
            if !marks.is_empty() {
                self.marks.insert(key.clone(), marks.into_iter().collect());
            }
        }
        let last = |(first, last): (usize, Option<usize>)| last.unwrap_or(first);
        let selection = state.selection.filter(|&selection| last(selection) < steps);
        self.playback.selection = selection;
        if selection != state.selection {
            complaints.push(format!("select: reaches outside 1 to {steps}"));
        }
    }

    fn take_switches(&mut self, state: &State, complaints: &mut Vec<String>) {
        let switches = &state.switches;
        let of_none = |expert: &Expert| {
            let has = |model: &Arc<ModelInfo>| model.all_experts().contains(expert);
            !switches.runs(*expert).is_empty() && !self.models.iter().any(has)
        };
        complaints.extend(
            Expert::ALL
                .into_iter()
                .find(of_none)
                .map(|expert| format!("alpha: no model here has the expert {}", expert.name())),
        );
        match self.model().and_then(|model| model.silent_step(switches)) {
            Some(step) => complaints.push(format!(
                "alpha: leaves no active expert at step {}",
                step + 1
            )),
            None => self.settings.switches.clone_from(switches),
        }
    }

    /// The state string that opens the present model at a step, from 0, of an episode, ranked as now.
    pub fn state_at(&self, episode: usize, step: usize) -> String {
        let state = State {
            episode: self.episode_keys.get(episode).cloned(),
            step: Some(step + 1),
            model: self
                .model()
                .map(|_| model_key(&self.models, self.target.model)),
            order: self.table.view().order,
            ..State::default()
        };
        state.to_string()
    }

    /// The state string that brings all of this back.
    pub(super) fn state(&self) -> State {
        let key = self.episode_keys.get(self.target.episode);
        let steps = self.steps();
        let compare = self.compare.filter(|&model| model != self.target.model);
        State {
            episode: key.cloned(),
            step: Some(self.playback.cursor + 1),
            model: self
                .model()
                .map(|_| model_key(&self.models, self.target.model)),
            compare: compare.map(|model| model_key(&self.models, model)),
            context: Some(self.settings.context),
            horizon: Some(self.settings.horizon),
            scope: Some(self.settings.scope),
            speed: Some(self.playback.speed()),
            looping: Some(self.playback.looping),
            switches: self.settings.switches.clone(),
            corruptions: self.settings.corruptions.clone(),
            controls: self.settings.controls,
            sampling: self.settings.sampling,
            marks: key
                .and_then(|key| self.marks.get(key).cloned())
                .unwrap_or_default(),
            selection: self
                .playback
                .selection
                .filter(|&(first, last)| last.unwrap_or(first) < steps),
            order: self.table.view().order,
            unknown: self.unknown_keys.clone(),
        }
    }
}

/// What is computed otherwise than at the start, and only that: what a string does not mention is as at the start.
fn take_bench(settings: &mut Settings, state: &State) {
    settings.corruptions.clone_from(&state.corruptions);
    settings.controls = state.controls;
    settings.sampling = state.sampling;
}

/// Names, each with a number where earlier ones are the same: the next that makes a name nobody has.
pub(super) fn keys<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let names: Vec<&str> = names.collect();
    let taken: BTreeSet<&str> = names.iter().copied().collect();
    let mut seen = BTreeMap::new();
    let mut key = |name: &'a str| {
        let count: &mut usize = seen.entry(name).or_default();
        *count += 1;
        if *count == 1 {
            return name.to_owned();
        }
        loop {
            let numbered = format!("{name}#{count}");
            if !taken.contains(numbered.as_str()) {
                return numbered;
            }
            *count += 1;
        }
    };
    names.iter().map(|name| key(name)).collect()
}

/// A model's name, with a number where an earlier one has the same.
pub fn model_key(models: &[Arc<ModelInfo>], model: usize) -> String {
    let mut keys = model_keys(models);
    if model < keys.len() {
        keys.swap_remove(model)
    } else {
        String::new()
    }
}

/// The model of a key.
pub(super) fn model_named(models: &[Arc<ModelInfo>], key: &str) -> Option<usize> {
    model_keys(models).iter().position(|named| named == key)
}

fn model_keys(models: &[Arc<ModelInfo>]) -> Vec<String> {
    keys(models.iter().map(|info| info.name.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_numbered_key_is_nobody_s_name() {
        let names = ["a", "a", "a#2", "a"];
        assert_eq!(keys(names.into_iter()), ["a", "a#3", "a#2", "a#4"]);
    }
}
