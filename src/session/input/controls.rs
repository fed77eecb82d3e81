//! `r`: what would have happened under other controls, from the cursor on.
//!
//! ```text
//! controls from step 6: turned 30°, 0.5 times as fast | - = turn, ↑ ↓ speed, m mirror, . stop, r recorded, Esc ends
//! ```

use super::{Input, Taken};
use crate::session::command::Command;
use crate::session::keys::Key;
use crate::session::settings::ControlEdit;
use crate::session::snapshot::Snapshot;

/// What `-` and `=` turn by, in degrees.
const TURN_DEG: f32 = 15.0;
/// What ↑ and ↓ change the speed by, as a part of the recorded one.
const SCALE: f32 = 0.25;

impl Input {
    pub(super) fn controls(&mut self, key: &Key, snapshot: &Snapshot) -> Taken {
        let now = self.edit(snapshot);
        let edit = match key.name() {
            "-" => now.turned(-TURN_DEG),
            "=" | "+" => now.turned(TURN_DEG),
            "<up>" => now.scaled(now.scale + SCALE),
            "<down>" => now.scaled(now.scale - SCALE),
            "." => now.scaled(0.0),
            "m" => ControlEdit {
                mirror: !now.mirror,
                ..now
            },
            "r" => ControlEdit::from(now.from),
            _ => return Taken::Not,
        };
        Some(Command::EditControls(edit.unless_identity())).into()
    }

    pub(super) fn controls_hint(&self, snapshot: &Snapshot) -> String {
        let edit = self.edit(snapshot);
        format!(
            "controls from step {}: {} | - = turn, ↑ ↓ speed, m mirror, . stop, r recorded, Esc ends",
            edit.from + 1,
            edit.what()
        )
    }

    /// The edit there is, else one that changes nothing from where the mode began.
    fn edit(&self, snapshot: &Snapshot) -> ControlEdit {
        snapshot
            .control_edit
            .unwrap_or(ControlEdit::from(self.from))
    }
}
