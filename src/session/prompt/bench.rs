//! Lines that damage inputs, edit controls and choose experts.

use super::{Choice, split};
use crate::measure::corruption::Damage;
use crate::session::command::Command;
use crate::session::settings::{ControlEdit, SCALES};
use crate::session::snapshot::Snapshot;
use crate::session::state::names;

/// `vision noise`, `haptic hold 0.3`, `proprio none`.
pub(super) fn corrupt(text: &str, snapshot: &Snapshot) -> Option<Command> {
    let (modality, rest) = split(text);
    let modality = names::modality(modality).ok()?;
    let (kind, severity) = split(rest);
    if kind == "none" {
        return severity.is_empty().then_some(Command::Corrupt {
            modality,
            corruption: None,
        });
    }
    let damage = Damage::of(modality).find(|damage| damage.name() == kind)?;
    let mut corruption = snapshot.aimed(damage);
    if !severity.is_empty() {
        let severity = severity.parse().ok();
        corruption.severity = severity.filter(|s| (0.0..=1.0).contains(s))?;
    }
    let corruption = Some(corruption);
    Some(Command::Corrupt {
        modality,
        corruption,
    })
}

/// What there is to damage, and how.
pub(super) fn corruptions(snapshot: &Snapshot) -> Vec<Choice> {
    let all = snapshot.modalities().flat_map(|modality| {
        let name = modality.name();
        let kinds = Damage::of(modality).map(Damage::name).chain(["none"]);
        kinds
            .map(|kind| (format!("{name} {kind}"), ""))
            .collect::<Vec<_>>()
    });
    all.collect()
}

/// `turn 30`, `scale 0.5`, `mirror`, `stop`, `recorded`: of the edit there is, else from the cursor on.
pub(super) fn controls(text: &str, snapshot: &Snapshot) -> Option<Command> {
    let (word, rest) = split(text);
    let edit = snapshot
        .control_edit
        .unwrap_or(ControlEdit::from(snapshot.cursor));
    let number = || rest.parse().ok().filter(|n: &f32| n.is_finite());
    let edit = match word {
        "turn" => ControlEdit {
            rotate_deg: 0.0,
            ..edit
        }
        .turned(number()?),
        "scale" => edit.scaled(number().filter(|scale| SCALES.contains(scale))?),
        "mirror" if rest.is_empty() => ControlEdit {
            mirror: !edit.mirror,
            ..edit
        },
        "stop" if rest.is_empty() => edit.scaled(0.0),
        "recorded" if rest.is_empty() => return Some(Command::EditControls(None)),
        _ => return None,
    };
    Some(Command::EditControls(edit.unless_identity()))
}

/// `VHD`: the experts of these letters.
pub(super) fn set(text: &str, snapshot: &Snapshot) -> Option<Command> {
    let wanted: Vec<char> = text.chars().map(|c| c.to_ascii_uppercase()).collect();
    let letters = || snapshot.experts.iter().map(|view| view.expert.letter());
    let known = !wanted.is_empty() && wanted.iter().all(|&c| letters().any(|l| l == c));
    known.then(|| Command::UseSet(letters().map(|letter| wanted.contains(&letter)).collect()))
}
