//! What undo takes back: switches, scope, context and horizon, with their history.

use super::command::Scope;
use super::switches::Switches;

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
}

impl Default for Settings {
    /// The paper's synthetic protocol: four images seen, eleven predicted.
    fn default() -> Self {
        Self {
            switches: Switches::default(),
            scope: Scope::Episode,
            context: 4,
            horizon: 11,
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
