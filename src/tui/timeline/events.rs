//! What stands out along the steps: contact `^`, marks `*`, flags of the recording `!`, damaged inputs `~`.
//!
//! ```text
//!        ━━━━━━━┃╌╌╌╌◆╌╌╌╌╌╌╌──
//! events    ^      *▔▔▔▔▔▔     ~~~~        ~V
//! ```
//! A selection is the line under its steps. Where there is no row for them the marks lie on the track itself.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::super::axis::Axis;
use super::super::face::Face;
use super::super::paint::{put, right, text};
use super::super::theme::{WARNING, dim, strong};
use crate::modality::{Expert, Modality};
use crate::session::snapshot::{EventKind, Snapshot};

/// The symbols of each step that has some, the most important first.
pub fn symbols(snapshot: &Snapshot, step: usize) -> Vec<char> {
    let has = |kind: EventKind| {
        let is_here =
            |event: &crate::session::snapshot::Event| event.step == step && event.kind == kind;
        snapshot.events.iter().any(is_here)
    };
    let is_flagged = snapshot
        .episode
        .as_ref()
        .is_some_and(|episode| episode.flagged_steps.contains(&step));
    let all = [
        (is_flagged, '!'),
        (has(EventKind::Mark), '*'),
        (has(EventKind::Contact), '^'),
    ];
    all.into_iter()
        .filter_map(|(is, symbol)| is.then_some(symbol))
        .collect()
}

/// The modalities whose input is damaged at a step.
fn damaged(snapshot: &Snapshot, step: usize) -> impl Iterator<Item = Modality> {
    snapshot
        .corruptions
        .iter()
        .filter_map(move |(modality, corruption)| corruption.acts_at(step).then_some(*modality))
}

/// The expert that looks at a modality alone: its letter and colour.
fn expert_of(modality: Modality) -> Option<Expert> {
    let alone = |expert: &Expert| expert.modalities() == [modality];
    Expert::ALL.into_iter().find(alone)
}

fn style(symbol: char, face: &Face) -> Style {
    if symbol == '!' {
        strong().patch(face.depth.ink(WARNING))
    } else {
        strong()
    }
}

/// Draws the row; of steps that share a column all are looked at.
pub fn row(buf: &mut Buffer, pane: Rect, axis: Axis, snapshot: &Snapshot, face: &Face) {
    if pane.height == 0 {
        return;
    }
    text(buf, pane, 0, 0, "events", dim());
    let selected = snapshot.selection.map(|(a, b)| a.min(b)..=a.max(b));
    for first in (0..axis.steps).step_by(axis.every) {
        let steps = first..(first + axis.every).min(axis.steps);
        let column = axis.column(first);
        let is_selected =
            |step: usize| selected.as_ref().is_some_and(|range| range.contains(&step));
        let ground = if let Some(modality) = steps
            .clone()
            .find_map(|step| damaged(snapshot, step).next())
        {
            let ink =
                expert_of(modality).map_or_else(Style::new, |expert| face.depth.ink(expert.rgb()));
            Some(('~', ink))
        } else {
            steps.clone().any(is_selected).then(|| ('▔', strong()))
        };
        if let Some((symbol, style)) = ground {
            for i in 0..axis.columns {
                put(buf, pane, column + i, 0, symbol, style);
            }
        }
        let mut shown: Vec<char> = steps.flat_map(|step| symbols(snapshot, step)).collect();
        shown.dedup();
        for (i, symbol) in (0..axis.columns).zip(shown) {
            put(buf, pane, column + i, 0, symbol, style(symbol, face));
        }
    }
    let letters: String = damaged(snapshot, snapshot.cursor)
        .filter_map(expert_of)
        .map(Expert::letter)
        .collect();
    if !letters.is_empty() {
        right(buf, pane, pane.width, 0, &format!("~{letters}"), strong());
    }
}

/// Draws the marks on the track, where they have no row of their own.
pub fn over_track(
    buf: &mut Buffer,
    pane: Rect,
    row: u16,
    axis: Axis,
    snapshot: &Snapshot,
    face: &Face,
) {
    for step in 0..axis.steps {
        if let Some(&symbol) = symbols(snapshot, step).first() {
            put(
                buf,
                pane,
                axis.column(step),
                row,
                symbol,
                style(symbol, face),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

    use std::sync::Arc;

    use super::*;
    use crate::measure::corruption::{Corruption, Damage};
    use crate::tui::fixture;

    fn drawn(snapshot: &Snapshot, width: u16) -> String {
        let mut buf = Buffer::empty(Rect::new(0, 0, width, 1));
        let pane = buf.area;
        let steps = snapshot.episode.as_ref().unwrap().secs.len();
        row(
            &mut buf,
            pane,
            Axis::of(width, steps),
            snapshot,
            &Face::default(),
        );
        crate::tui::print::to_text(&buf, false)
            .trim_end()
            .to_owned()
    }

    #[test]
    fn flags_mark_their_steps() {
        let mut snapshot = fixture::snapshot(6, 16);
        snapshot.events = Arc::default();
        let mut episode = (**snapshot.episode.as_ref().unwrap()).clone();
        episode.flagged_steps = vec![5, 7];
        snapshot.episode = Some(Arc::new(episode));
        assert_eq!(drawn(&snapshot, 31), "events      ! !");
    }

    #[test]
    fn selection_damage_and_events_share_the_row() {
        let mut snapshot = fixture::snapshot(10, 16);
        snapshot.selection = Some((2, 6));
        let corruption = Corruption {
            damage: Damage::Zero,
            severity: 1.0,
            from: 9,
            until: Some(12),
            patch: [0.5; 2],
            seed: 0,
        };
        snapshot.corruptions = vec![(Modality::Vision, corruption)];
        assert_eq!(drawn(&snapshot, 31), "events   ▔▔^▔▔* ~~~          ~V");
    }
}
