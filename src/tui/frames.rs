//! The frame row: what was recorded, what is believed, what was predicted, and how far that is off.
//!
//! ```text
//! truth              belief 31.2 dB     prediction +5      error ±0.50 pred
//! ▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀
//! ```
//! Before the rollout begins the prediction's place says `context`: nothing there was predicted.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::widgets::{Block, BorderType, Widget};

use super::face::Face;
use super::image::{ERROR_RANGE, Raster};
use super::paint::{below_title, text, width};
use super::theme::{PREDICTION, dim, strong};
use super::view::Pane;
use crate::session::snapshot::{ErrorOf, Snapshot};

/// One image with its label.
struct Slot {
    name: &'static str,
    /// Shown after the name as far as there is room.
    notes: Vec<String>,
    style: Style,
    image: Result<Raster, String>,
}

/// Draws the row; a zoomed row that could not grow otherwise shows only truth and what the error is of.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let mut slots = slots(snapshot, face);
    if face.zoomed && pane.width < 134 {
        let keep = match snapshot.frames.error_of {
            ErrorOf::Belief => 1,
            ErrorOf::Prediction => 2,
        };
        slots = slots
            .into_iter()
            .enumerate()
            .filter_map(|(i, slot)| (i == 0 || i == keep).then_some(slot))
            .collect();
    }
    let count = slots.len() as u16;
    let side =
        (pane.width.saturating_sub(count - 1) / count).min(pane.height.saturating_sub(1) * 2);
    let spare = pane.width.saturating_sub(count * side);
    let gap = (spare / (count - 1)).min(if face.zoomed { 4 } else { 2 });
    for (i, slot) in slots.iter().enumerate() {
        let at = i as u16 * (side + gap);
        let slot_pane = Rect {
            x: pane.x + at,
            width: side.min(pane.width.saturating_sub(at)),
            ..pane
        };
        let focused = i == 0 && face.is_focused(Pane::Frames);
        label(buf, slot_pane, slot, focused);
        picture(buf, below_title(slot_pane), slot, face);
    }
}

fn label(buf: &mut Buffer, pane: Rect, slot: &Slot, focused: bool) {
    let mark = if focused { "▸ " } else { "" };
    let mut at = text(buf, pane, 0, 0, mark, strong());
    let wanted: u16 = slot.notes.iter().map(|note| width(note) + 1).sum();
    let short = at + width(slot.name) + wanted > pane.width && slot.name == "prediction";
    let name = if short { "pred" } else { slot.name };
    at = text(buf, pane, at, 0, name, slot.style);
    for note in &slot.notes {
        if at + 1 + width(note) > pane.width {
            return;
        }
        at = text(buf, pane, at + 1, 0, note, Style::new());
    }
}

fn picture(buf: &mut Buffer, pane: Rect, slot: &Slot, face: &Face) {
    match &slot.image {
        Ok(raster) => {
            let shown = face
                .pixels
                .as_ref()
                .is_some_and(|pixels| pixels.draw(buf, pane, raster));
            if !shown {
                raster.draw(buf, pane, face.depth);
            }
        }
        Err(why) => {
            Block::bordered()
                .border_type(BorderType::Rounded)
                .border_style(dim())
                .render(pane.intersection(buf.area), buf);
            let indent = pane.width.saturating_sub(width(why)) / 2;
            text(buf, pane, indent, pane.height / 2, why, dim());
        }
    }
}

fn slots(snapshot: &Snapshot, face: &Face) -> Vec<Slot> {
    let row = &snapshot.frames;
    let psnr = snapshot
        .psnr_db
        .get(snapshot.cursor)
        .copied()
        .unwrap_or_default();
    let decibels = |value: Option<f32>| value.map(|db| format!("{db:.1} dB"));
    let ahead = snapshot
        .cursor
        .checked_sub(snapshot.start)
        .filter(|&ahead| ahead > 0);
    let unknown = if snapshot.busy {
        "computing…"
    } else {
        "none"
    };

    let first = snapshot
        .models
        .get(snapshot.model)
        .map_or(0, |model| model.frame_stack);
    let no_belief = if snapshot.cursor < first {
        format!("from step {}", first + 1)
    } else {
        unknown.to_owned()
    };
    let no_prediction = match ahead {
        None => format!("from step {}", snapshot.start + 2),
        Some(ahead) if ahead > snapshot.horizon => "past the horizon".to_owned(),
        Some(_) => unknown.to_owned(),
    };
    let mut prediction_notes = match ahead {
        None => vec!["context".to_owned()],
        Some(ahead) => vec![format!("+{ahead}")],
    };
    prediction_notes.extend(decibels(psnr.prediction));
    let of = match row.error_of {
        ErrorOf::Belief => "belief",
        ErrorOf::Prediction => "pred",
    };
    let raster = |frame: &std::sync::Arc<crate::episode::Frame>| Raster::from(&**frame);
    vec![
        Slot {
            name: "truth",
            notes: Vec::new(),
            style: strong(),
            image: row
                .truth
                .as_ref()
                .map(raster)
                .ok_or_else(|| unknown.to_owned()),
        },
        Slot {
            name: "belief",
            notes: decibels(psnr.belief).into_iter().collect(),
            style: strong(),
            image: row
                .belief
                .as_ref()
                .map(raster)
                .ok_or_else(|| no_belief.clone()),
        },
        Slot {
            name: "prediction",
            notes: prediction_notes,
            style: strong().patch(face.depth.ink(PREDICTION)),
            image: row.prediction.as_ref().map(raster).ok_or(no_prediction),
        },
        Slot {
            name: "error",
            notes: vec![format!("±{ERROR_RANGE:.2}"), of.to_owned()],
            style: strong(),
            image: row
                .error
                .as_ref()
                .map(|error| Raster::from(&**error))
                .ok_or(no_belief),
        },
    ]
}
