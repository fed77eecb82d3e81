//! What is wrong with each input.

use super::names::{AS_RECORDED, DAMAGE, SEVERITY, damage};
use super::panel::{Panel, Range};
use crate::measure::corruption::{Damage, applies};
use crate::modality::{Expert, Modality};
use crate::session::snapshot::Snapshot;

/// Adds the folder.
pub fn add(panel: &mut Panel, snapshot: &Snapshot) {
    panel.folder("damage", "Damaged inputs", false);
    for modality in looked_at(snapshot) {
        let name = modality.name();
        let found = snapshot
            .corruptions
            .iter()
            .find(|(damaged, _)| *damaged == modality);
        let now = found.map(|(_, corruption)| corruption);
        let kinds = kinds(modality).map(|kind| kind.name().to_owned());
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

/// What the present model's experts look at.
fn looked_at(snapshot: &Snapshot) -> impl Iterator<Item = Modality> {
    let experts = snapshot.experts.iter().map(|view| view.expert);
    let seen: Vec<Modality> = experts.flat_map(Expert::modalities).copied().collect();
    Modality::ALL
        .into_iter()
        .filter(move |modality| seen.contains(modality))
}

/// Kinds of damage that a modality can have.
fn kinds(modality: Modality) -> impl Iterator<Item = Damage> {
    let all = Damage::ALL.into_iter();
    all.filter(move |&kind| applies(kind, modality))
}
