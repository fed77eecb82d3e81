//! `x`: what is wrong with the input of an expert. The expert stays on; it only sees something else.
//!
//! ```text
//! vision input: noise 0.5 from step 4 | x kind, - = severity, a digit another, @ from here, Esc ends
//! ```
//! A new damage reaches as far as the scope at the cursor says; what is changed afterwards keeps its steps, until `@`.

use super::{Action, Input, Taken, adjust, sensor};
use crate::measure::corruption::{Corruption, Damage};
use crate::modality::Modality;
use crate::session::command::Command;
use crate::session::keys::Key;
use crate::session::snapshot::Snapshot;

/// How far an arrow moves the patch, in parts of the frame.
const ARROW: f32 = 0.125;

impl Input {
    pub(super) fn corrupt(&mut self, key: &Key, snapshot: &Snapshot) -> Taken {
        if key.name() == "9" {
            let text = "the prior has no input; 9 switches it outside of this".to_owned();
            return Taken::Action(Action::Explain { error: true, text });
        }
        match sensor(key, snapshot) {
            Some(Ok(position)) => {
                self.focus_expert(position);
                return Taken::Quietly;
            }
            Some(Err(complaint)) => return Taken::Action(complaint),
            None => {}
        }
        let Some(modality) = self.damaged(snapshot) else {
            return Taken::Not;
        };
        let now = snapshot.corruption_of(modality);
        let corruption = match (key.name(), now) {
            ("<tab>", _) if self.choices(snapshot).len() > 1 => {
                self.modality += 1;
                return Taken::Quietly;
            }
            ("x", now) => next(modality, now, snapshot),
            ("@", Some(now)) => Some(Corruption {
                severity: now.severity,
                patch: now.patch,
                ..snapshot.aimed(now.damage)
            }),
            (_, Some(now)) if adjust::by(key).is_some() => {
                let tenths = (now.severity * 10.0).round() + adjust::by(key).unwrap_or(0) as f32;
                Some(Corruption {
                    severity: (tenths / 10.0).clamp(0.0, 1.0),
                    ..now
                })
            }
            (name, Some(now)) if now.damage == Damage::Occlude => match moved(name, now.patch) {
                Some(patch) => Some(Corruption { patch, ..now }),
                None => return Taken::Not,
            },
            // Nothing to be more or less of yet.
            (_, None) if adjust::by(key).is_some() => return Taken::Quietly,
            _ => return Taken::Not,
        };
        Some(Command::Corrupt {
            modality,
            corruption,
        })
        .into()
    }

    pub(super) fn corrupt_hint(&self, snapshot: &Snapshot) -> String {
        let Some(modality) = self.damaged(snapshot) else {
            return "whose input? a digit".to_owned();
        };
        let name = modality.name();
        let another = if self.choices(snapshot).len() > 1 {
            "Tab or a digit another"
        } else {
            "a digit another"
        };
        let Some(now) = snapshot.corruption_of(modality) else {
            return format!("{name} input: as recorded | x damages it, {another}, Esc ends");
        };
        let patch = if now.damage == Damage::Occlude {
            ", arrows patch"
        } else {
            ""
        };
        format!(
            "{name} input: {} {} {} | x kind, - = severity{patch}, {another}, @ from here, Esc ends",
            now.damage.name(),
            now.severity,
            reach(&now)
        )
    }

    /// What the focused expert looks at.
    fn choices(&self, snapshot: &Snapshot) -> &'static [Modality] {
        let expert = snapshot.experts.get(self.focused);
        expert.map_or(&[], |view| view.expert.modalities())
    }

    /// The modality whose input is meant; none for the prior.
    fn damaged(&self, snapshot: &Snapshot) -> Option<Modality> {
        let choices = self.choices(snapshot);
        let place = self.modality.checked_rem(choices.len())?;
        choices.get(place).copied()
    }
}

/// The next kind, as strong and on the same steps as the one before it; after the last one none.
fn next(modality: Modality, now: Option<Corruption>, snapshot: &Snapshot) -> Option<Corruption> {
    let Some(now) = now else {
        return Damage::of(modality)
            .next()
            .map(|first| snapshot.aimed(first));
    };
    let damage = Damage::of(modality)
        .skip_while(|damage| *damage != now.damage)
        .nth(1)?;
    Some(Corruption { damage, ..now })
}

/// The centre of the patch after an arrow: from the left and from the top, in parts of the frame.
fn moved(key: &str, [x, y]: [f32; 2]) -> Option<[f32; 2]> {
    let (dx, dy) = match key {
        "<left>" => (-ARROW, 0.0),
        "<right>" => (ARROW, 0.0),
        "<up>" => (0.0, -ARROW),
        "<down>" => (0.0, ARROW),
        _ => return None,
    };
    Some([(x + dx).clamp(0.0, 1.0), (y + dy).clamp(0.0, 1.0)])
}

/// In words, counted from 1.
fn reach(corruption: &Corruption) -> String {
    let first = corruption.from + 1;
    match corruption.until {
        None => format!("from step {first}"),
        Some(until) if until == first => format!("at step {first}"),
        Some(until) => format!("at steps {first} to {until}"),
    }
}
