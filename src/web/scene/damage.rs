//! What is wrong with each input.

use super::names::{AS_RECORDED, DAMAGE, SEVERITY, damage};
use super::panel::{Panel, Range};
use crate::measure::corruption::Damage;
use crate::session::snapshot::Snapshot;

/// Adds the folder.
pub fn add(panel: &mut Panel, snapshot: &Snapshot) {
    panel.folder("damage", "Damaged inputs", false);
    for modality in snapshot.modalities() {
        let name = modality.name();
        let now = snapshot.corruption_of(modality);
        let kinds = Damage::of(modality).map(|kind| kind.name().to_owned());
        let options = std::iter::once(AS_RECORDED.to_owned())
            .chain(kinds)
            .collect();
        let hint = "The expert stays on; it only sees something else";
        let value = damage(now.map(|corruption| corruption.damage));
        panel.dropdown(
            &format!("{DAMAGE}{name}"),
            (&format!("{name} input"), hint),
            value,
            options,
        );
        let severity = now.map_or(0.0, |corruption| super::experts::tidy(corruption.severity));
        let range = Range {
            min: 0.0,
            max: 1.0,
            step: 0.1,
        };
        let label = format!("{name} severity");
        panel.slider(
            &format!("{SEVERITY}{name}"),
            (&label, ""),
            severity,
            range,
            now.is_some(),
        );
    }
}
