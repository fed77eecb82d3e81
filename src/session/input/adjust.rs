//! The modes in which `-` and `=` change one number: α, context, horizon, samples.

use super::{Input, Taken, sensor};
use crate::session::command::Command;
use crate::session::keys::Key;
use crate::session::settings::SAMPLES;
use crate::session::snapshot::Snapshot;

/// One less or one more.
pub(super) fn by(key: &Key) -> Option<i64> {
    match key.name() {
        "-" => Some(-1),
        "=" | "+" => Some(1),
        _ => None,
    }
}

/// Half or twice as many samples, within what there may be.
pub(super) fn samples(key: &Key, snapshot: &Snapshot) -> Taken {
    let count = snapshot.sampling.count;
    let count = by(key).map(|by| {
        if by < 0 {
            count / 2
        } else {
            count.saturating_mul(2)
        }
    });
    let within = |count: usize| count.clamp(*SAMPLES.start(), *SAMPLES.end());
    count.map(|count| Command::SetSamples(within(count))).into()
}

impl Input {
    /// α of the focused expert by a tenth; a digit picks another.
    pub(super) fn temper(&mut self, key: &Key, snapshot: &Snapshot) -> Taken {
        if key.name() == "9" {
            self.focus_expert(snapshot.experts.len().saturating_sub(1));
            return Taken::Quietly;
        }
        match sensor(key, snapshot) {
            Some(Ok(position)) => {
                self.focus_expert(position);
                Taken::Quietly
            }
            Some(Err(complaint)) => Taken::Action(complaint),
            None => {
                let expert = self.focused_expert();
                by(key)
                    .map(|tenths| Command::Temper { expert, tenths })
                    .into()
            }
        }
    }

    pub(super) fn temper_hint(&self, snapshot: &Snapshot) -> String {
        match snapshot.experts.get(self.focused_expert()) {
            Some(view) => {
                let name = view.expert.name();
                format!(
                    "α of {name} {} | - = change it, a digit picks another, Esc ends",
                    view.alpha
                )
            }
            None => "α of which expert? a digit".to_owned(),
        }
    }
}
