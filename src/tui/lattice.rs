//! Every set of experts at once: a small frame of each with its numbers, or a table where frames do not fit.
//!
//! ```text
//! sets 15 ──── dB of the frame, cm off, cm² of 1σ
//!▸VHPD ●         VHD             VPD
//! ▀▀▀▀▀▀▀▀ 28.1  ▀▀▀▀▀▀▀▀ 26.9   ▀▀▀▀▀▀▀▀ 22.0
//! ▀▀▀▀▀▀▀▀ 0.41  ▀▀▀▀▀▀▀▀ 0.82   ▀▀▀▀▀▀▀▀ 1.10
//! ▀▀▀▀▀▀▀▀ 1.24  ▀▀▀▀▀▀▀▀ 1.30   ▀▀▀▀▀▀▀▀ 2.71
//! VHPD  the present set, trained …                              ⏎ enter it
//! ```
//! `●` is the set of the present switches, `!` one that was never trained. Up and down choose, Enter switches to it.

mod grid;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};

use super::face::Face;
use super::fuse::empty;
use super::image::Raster;
use super::layout::{columns, rows};
use super::paint::{below_title, put, right, short, text, title, width};
use super::theme::{WARNING, dim, strong};
use super::view::Pane;
use crate::session::snapshot::lattice::{LatticeCell, LatticeView};
use crate::session::snapshot::{Badge, Snapshot};
use grid::Grid;

/// Square centimetres of a square metre.
const CM2_PER_M2: f32 = 1e4;

/// Draws the sets and a line about the chosen one.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Sets);
    let inner = below_title(pane);
    let lattice = match &snapshot.lattice {
        Some(lattice) if snapshot.badge != Badge::NoProduct && !lattice.cells.is_empty() => lattice,
        _ => {
            title(buf, pane, "sets", "", focused);
            empty::draw(buf, inner, snapshot);
            return;
        }
    };
    let count = lattice.cells.len();
    let units = if pane.width >= 60 {
        "frame dB, cm off, cm² of 1σ  ● now  ! untrained"
    } else {
        "dB, cm, cm²"
    };
    let name = if lattice.step == snapshot.cursor {
        format!("sets {count}")
    } else {
        format!("sets {count} at step {}", lattice.step + 1)
    };
    title(buf, pane, &name, units, focused);
    let chosen = chosen(lattice, face);
    let (cells, details) = rows(inner, inner.height.saturating_sub(1));
    let grid = Grid::of(cells, count);
    for (i, place) in grid.places(cells, chosen) {
        if let Some(cell) = lattice.cells.get(i) {
            if grid.side > 0 {
                framed(buf, place, (cell, i == chosen), grid.side, snapshot, face);
            } else {
                line(buf, place, (cell, i == chosen), snapshot, face);
            }
        }
    }
    if let Some(cell) = lattice.cells.get(chosen) {
        about(buf, details, cell);
    }
}

/// The set at a cell of the screen, of a pane drawn with this face.
pub fn set_at(
    pane: Rect,
    at: ratatui::layout::Position,
    snapshot: &Snapshot,
    face: &Face,
) -> Option<usize> {
    let lattice = snapshot.lattice.as_ref()?;
    let inner = below_title(pane);
    let (cells, _) = rows(inner, inner.height.saturating_sub(1));
    let places = Grid::of(cells, lattice.cells.len()).places(cells, chosen(lattice, face));
    let found = places.into_iter().find(|(_, place)| place.contains(at));
    found.map(|(i, _)| i)
}

fn chosen(lattice: &LatticeView, face: &Face) -> usize {
    face.lattice_cell.min(lattice.cells.len().saturating_sub(1))
}

/// Name and marks; returns the column after them.
fn name(
    buf: &mut Buffer,
    pane: Rect,
    (cell, chosen): (&LatticeCell, bool),
    snapshot: &Snapshot,
    face: &Face,
) -> u16 {
    if chosen {
        put(buf, pane, 0, 0, '▸', strong());
    }
    let mut at = 1;
    for (view, _) in snapshot
        .experts
        .iter()
        .zip(&cell.active)
        .filter(|(_, on)| **on)
    {
        let mut ink = strong().patch(face.depth.ink(view.expert.rgb()));
        if chosen {
            ink = ink.add_modifier(Modifier::UNDERLINED);
        }
        at = text(buf, pane, at, 0, &view.expert.letter().to_string(), ink);
    }
    if cell.current {
        at = text(buf, pane, at + 1, 0, "●", strong());
    }
    if !cell.trained {
        let warning = strong().patch(face.depth.ink(WARNING));
        at = text(buf, pane, at + 1, 0, "!", warning);
    }
    at
}

/// PSNR in dB, distance from the truth in cm, area of the 1σ ellipse in cm².
fn numbers(cell: &LatticeCell) -> [String; 3] {
    let or_dash = |value: Option<f32>| value.map_or_else(|| "–".to_owned(), short);
    [
        or_dash(cell.psnr_db),
        or_dash(cell.position_error_m.map(|metres| 100.0 * metres)),
        or_dash(cell.ellipse_m2.map(|area| CM2_PER_M2 * area)),
    ]
}

fn framed(
    buf: &mut Buffer,
    pane: Rect,
    (cell, chosen): (&LatticeCell, bool),
    side: u16,
    snapshot: &Snapshot,
    face: &Face,
) {
    name(buf, pane, (cell, chosen), snapshot, face);
    let below = below_title(pane);
    let (_, below) = columns(below, 0, 1);
    let (picture, words) = columns(below, side, 1);
    let picture = rows(picture, side.div_ceil(2)).0;
    match &cell.frame {
        Some(frame) => {
            let raster = Raster::from(&**frame);
            let shown = face
                .pixels
                .as_ref()
                .is_some_and(|pixels| pixels.draw(buf, picture, &raster));
            if !shown {
                raster.draw(buf, picture, face.depth);
            }
        }
        None => {
            text(buf, picture, 0, 0, "…", dim());
        }
    }
    for (row, number) in numbers(cell).iter().enumerate() {
        right(
            buf,
            words,
            words.width.min(4),
            row as u16,
            number,
            Style::new(),
        );
    }
}

fn line(
    buf: &mut Buffer,
    pane: Rect,
    (cell, chosen): (&LatticeCell, bool),
    snapshot: &Snapshot,
    face: &Face,
) {
    let name_end = name(buf, pane, (cell, chosen), snapshot, face);
    let mut end = pane.width;
    for number in numbers(cell).iter().rev() {
        if end < name_end + 6 {
            return;
        }
        right(buf, pane, end, 0, number, Style::new());
        end -= 6;
    }
}

/// The chosen set in words, as many as there is room for.
fn about(buf: &mut Buffer, pane: Rect, cell: &LatticeCell) {
    let enter = if cell.current {
        "↑↓ choose"
    } else {
        "↑↓ choose  ⏎ switch to it"
    };
    let mut parts = Vec::new();
    if cell.current {
        parts.push("the present switches".to_owned());
    }
    if !cell.trained {
        parts.push("! never trained".to_owned());
    }
    parts.extend(
        cell.squared_error
            .map(|error| format!("SE {}", short(error))),
    );
    let rmse = cell.episode_rmse_m.map(|metres| 100.0 * metres);
    parts.extend(rmse.map(|cm| format!("episode RMSE {} cm", short(cm))));
    let mut at = text(buf, pane, 0, 0, &cell.name, strong());
    for part in parts {
        if at + 2 + width(&part) + 2 + width(enter) <= pane.width {
            at = text(buf, pane, at + 2, 0, &part, Style::new());
        }
    }
    if at + 2 + width(enter) <= pane.width {
        right(buf, pane, pane.width, 0, enter, dim());
    }
}
