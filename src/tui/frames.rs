//! The frame row: what was recorded, what is believed, what was predicted, and how far that is off.
//!
//! ```text
//! truth              belief 31.2 dB     prediction +5      error ±0.50 pred
//! ▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀
//! ```
//! Before the rollout begins the prediction's place says `context`: nothing there was predicted. The other slots are
//! those of a second model and of a damaged input; see [`slots`].

mod slots;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::Style;
use ratatui::widgets::{Block, BorderType, Widget};

use super::face::Face;
use super::paint::{below_title, text, width};
use super::theme::{dim, strong};
use super::view::Pane;
use crate::session::snapshot::Snapshot;
use slots::{Slot, slots};

/// The columns at which a row of all slots is wide enough not to leave any out when it is alone on the screen.
const ALL_FIT: u16 = 134;

/// Draws the row; a zoomed row that could not grow otherwise shows only what is compared.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let slots = shown(pane, snapshot, face);
    let places = places(pane, slots.len(), face.zoomed);
    for (i, (slot, place)) in slots.iter().zip(places).enumerate() {
        let focused = i == 0 && face.is_focused(Pane::Frames);
        label(buf, place, slot, focused);
        picture(buf, below_title(place), slot, face);
    }
}

/// Where in the picture that is compared a cell of the screen is, from 0 at its left to 1 at its right; none outside.
pub fn part_of_compared(pane: Rect, at: Position, snapshot: &Snapshot, face: &Face) -> Option<f32> {
    let slots = shown(pane, snapshot, face);
    let places = places(pane, slots.len(), face.zoomed);
    let compared = slots.iter().zip(places).find(|(slot, _)| slot.compared);
    let (_, place) = compared.filter(|(_, place)| place.contains(at))?;
    Some((f32::from(at.x - place.x) + 0.5) / f32::from(place.width.max(1)))
}

fn shown(pane: Rect, snapshot: &Snapshot, face: &Face) -> Vec<Slot> {
    let slots = slots(snapshot, face);
    if face.is_zoomed(Pane::Frames) && pane.width < ALL_FIT {
        slots.into_iter().filter(|slot| slot.keep).collect()
    } else {
        slots
    }
}

/// Where each of so many square slots stands, its label included.
fn places(pane: Rect, count: usize, zoomed: bool) -> Vec<Rect> {
    let count = count.max(1) as u16;
    let side =
        (pane.width.saturating_sub(count - 1) / count).min(pane.height.saturating_sub(1) * 2);
    let spare = pane.width.saturating_sub(count * side);
    let gap = (spare / count.saturating_sub(1).max(1)).min(if zoomed { 4 } else { 2 });
    let place = |i: u16| {
        let at = i * (side + gap);
        Rect {
            x: pane.x + at.min(pane.width),
            width: side.min(pane.width.saturating_sub(at)),
            ..pane
        }
    };
    (0..count).map(place).collect()
}

fn label(buf: &mut Buffer, pane: Rect, slot: &Slot, focused: bool) {
    let mark = if focused { "▸ " } else { "" };
    let mut at = text(buf, pane, 0, 0, mark, strong());
    let wanted: u16 = slot.notes.iter().map(|note| width(note) + 1).sum();
    let short = at + width(&slot.name) + wanted > pane.width && slot.name == "prediction";
    let name = if short { "pred" } else { &slot.name };
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
