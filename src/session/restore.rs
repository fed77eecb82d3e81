//! Between a session and its state string.

use super::state::State;
use super::{Pending, Session};

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
            match self.source.metas().iter().position(|meta| meta.id == *id) {
                Some(episode) => target.episode = episode,
                None => complaints.push(format!(
                    "episode: {} has none named {id:?}",
                    self.source.name()
                )),
            }
        }
        if let Some(name) = &state.model {
            match (0..self.models.len()).find(|&model| self.model_key(model) == *name) {
                Some(model) => target.model = model,
                None => complaints.push(format!("model: none named {name:?} is loaded")),
            }
        }
        self.pending.clear();
        if target != self.target {
            self.go_to(target);
        }
        let restoration = Restoration { state, complaints };
        if self.opened().is_some() {
            self.finish(restoration);
        } else {
            self.pending.push_back(Pending::Restoration(restoration));
        }
    }

    /// Takes over what needs the episode.
    pub(super) fn finish(&mut self, restoration: Restoration) {
        let Restoration {
            state,
            mut complaints,
        } = restoration;
        let steps = self.opened().map_or(0, |opened| opened.steps());
        self.change(|session| {
            let settings = &mut session.settings;
            settings.scope = state.scope.unwrap_or(settings.scope);
            settings.horizon = state.horizon.unwrap_or(settings.horizon);
            session.take_switches(&state, &mut complaints);
            // Where it already is may be the only place there is.
            let context = state
                .context
                .filter(|&context| context != session.rollout().start + 1);
            if let Some(Err(why)) = context.map(|context| session.set_context(context)) {
                complaints.push(format!("context: {why}"));
            }
            Ok("state restored".to_owned())
        });
        self.repair();
        match state.step {
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
        if !state.unknown.is_empty() {
            let keys: Vec<&str> = state.unknown.iter().map(|(key, _)| key.as_str()).collect();
            complaints.push(format!("kept without a meaning here: {}", keys.join(", ")));
        }
        self.unknown_keys = state.unknown;
        if !complaints.is_empty() {
            self.complain(complaints.join("; "));
        }
    }

    fn take_switches(&mut self, state: &State, complaints: &mut Vec<String>) {
        let switches = &state.switches;
        let silent = self
            .model()
            .filter(|model| model.has_product())
            .and_then(|model| switches.first_silent_step(&model.factors()));
        match silent {
            Some(step) => complaints.push(format!(
                "alpha: leaves no active expert at step {}",
                step + 1
            )),
            None => self.settings.switches.clone_from(switches),
        }
    }

    /// The state string that brings all of this back.
    pub(super) fn state(&self) -> State {
        let meta = self.source.metas().get(self.target.episode);
        let opened = self.opened();
        let rollout = opened.map(|_| self.rollout());
        State {
            episode: meta.map(|meta| meta.id.clone()),
            step: Some(self.playback.cursor + 1),
            model: self.model().map(|_| self.model_key(self.target.model)),
            context: Some(rollout.map_or(self.settings.context, |rollout| rollout.start + 1)),
            horizon: Some(self.settings.horizon),
            scope: Some(self.settings.scope),
            speed: Some(self.playback.speed()),
            looping: Some(self.playback.looping),
            switches: self.settings.switches.clone(),
            unknown: self.unknown_keys.clone(),
        }
    }

    /// A model's name, with a number where an earlier one has the same.
    fn model_key(&self, model: usize) -> String {
        let Some(info) = self.models.get(model) else {
            return String::new();
        };
        let earlier = self
            .models
            .iter()
            .take(model)
            .filter(|m| m.name == info.name)
            .count();
        if earlier == 0 {
            info.name.clone()
        } else {
            format!("{}#{}", info.name, earlier + 1)
        }
    }
}
