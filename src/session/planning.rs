//! Where the rollout starts and how far it goes.

use super::Session;
use super::fusing::Refusal;

/// No horizon is longer: an hour at 30 Hz.
pub(super) const MOST_HORIZON: usize = 108_000;

impl Session {
    /// Sets c, if there is a belief at the c-th image and something to predict after it.
    pub(super) fn set_context(&mut self, context: usize) -> Result<String, Refusal> {
        let (least, _) = self.context_range();
        let steps = self.steps();
        if context < least {
            return Err(format!(
                "the first belief is at step {least}: nothing can be predicted before it"
            ));
        }
        if context >= steps {
            return Err(format!(
                "nothing to predict after step {context} of {steps}"
            ));
        }
        self.settings.context = context;
        Ok(format!(
            "predicts from step {} on: {context} images seen",
            context + 1
        ))
    }

    /// Changes c within its range.
    pub(super) fn change_context(&mut self, by: i64) -> String {
        let (least, most) = self.context_range();
        let context = moved(self.rollout().start + 1, by, least, most);
        self.settings.context = context;
        format!("context {context}")
    }

    /// Sets h.
    pub(super) fn set_horizon(&mut self, horizon: usize) -> Result<String, Refusal> {
        if horizon == 0 {
            return Err("a horizon is at least 1".to_owned());
        }
        if horizon > MOST_HORIZON {
            return Err(format!("a horizon is at most {MOST_HORIZON}"));
        }
        self.settings.horizon = horizon;
        let fitting = self.rollout().horizon;
        Ok(if fitting < horizon {
            format!("horizon {horizon}, of which this episode has room for {fitting}")
        } else {
            format!("horizon {horizon}")
        })
    }

    /// Changes h within what the episode has room for.
    pub(super) fn change_horizon(&mut self, by: i64) -> String {
        let rollout = self.rollout();
        let steps = self.steps();
        let most = steps.saturating_sub(rollout.start + 1).max(1);
        let horizon = moved(rollout.horizon, by, 1, most);
        self.settings.horizon = horizon;
        format!("horizon {horizon}")
    }

    /// The least and the greatest c of this model on this episode.
    pub(super) fn context_range(&self) -> (usize, usize) {
        let least = self.first_belief() + 1;
        let steps = self.steps();
        (least, steps.saturating_sub(1).max(least))
    }
}

fn moved(value: usize, by: i64, least: usize, most: usize) -> usize {
    let by = isize::try_from(by).unwrap_or(if by < 0 { isize::MIN } else { isize::MAX });
    value.saturating_add_signed(by).clamp(least, most)
}
