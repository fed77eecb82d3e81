//! The latent dimensions at the cursor: each expert's share of precision, and what each carries of the position.
//!
//! ```text
//! dims ─────── 14 of 16 active, ±0.98 cm
//! share  █ ▒ █ █ ░ ░ ▓ █ █ ▓ █ ░ ░ █ █ █
//! per z  █ ▓ █ █ ░ ░ ▓ █ █ ▓ █ ░ ░ █ █ █
//! x cm   ▄ ▔ ▁ ▀ ▁ ▁ ▔ ▄ ▔ ▁ ▔ ▄ ▀ ▁ ▁ ▄
//! y cm   ▁ ▔ ▀ ▄ ▁ ▔ ▄ ▄ ▔ ▔ ▄ ▁ ▔ ▁ ▄ ▀
//! dim    0 1 2 3 4 · 6 7 8 9 0 · 2 3 4 5
//! ```
//! `x cm` and `y cm` are W_kd (μ_d − mean_d), upwards positive, hanging negative (D18); `σ² x` the part of the
//! position's variance that comes through the dimension. One whose mean does not move over the data is greyed and has
//! no number (D19).

use std::fmt::Write;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::empty;
use crate::modality::Expert;
use crate::session::snapshot::Snapshot;
use crate::session::snapshot::reading::FusionView;
use crate::tui::axis::LABELS;
use crate::tui::face::Face;
use crate::tui::layout::rows;
use crate::tui::paint::{below_title, column, put, right, text, title};
use crate::tui::stack::stack;
use crate::tui::theme::{Depth, dim};
use crate::tui::view::{Pane, View};

/// Columns of the dimensions: where each begins, and how much of its pitch is filled.
#[derive(Clone, Copy)]
struct Grid {
    dims: usize,
    pitch: u16,
}

impl Grid {
    fn of(width: u16, dims: usize, widest: u16) -> Self {
        let room = width.saturating_sub(LABELS) / dims.max(1) as u16;
        Self {
            dims,
            pitch: room.clamp(1, widest),
        }
    }

    fn fat(self) -> u16 {
        self.pitch.saturating_sub(1).max(1)
    }

    fn at(self, d: usize) -> u16 {
        LABELS + d as u16 * self.pitch
    }
}

/// Rows of each part below the title; those that there is no room for have none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Parts {
    share: u16,
    axis: u16,
    variance: u16,
    importance: u16,
    gap: u16,
}

impl Parts {
    /// Divides the rows between title and numbers.
    fn of(rows: u16, carries: bool, shuffled: bool) -> Self {
        if !carries {
            return Self {
                share: rows.min(12),
                ..Self::default()
            };
        }
        let (axis, variance, gap) = match rows {
            0..=3 => (0, 0, 0),
            4..=8 => (1, 0, 0),
            9..=12 => (2, 1, 0),
            13..=23 => (2, 1, 1),
            _ => (4, 2, 1),
        };
        let importance = u16::from(shuffled && rows >= 11);
        let used = 2 * axis + 2 * variance + importance + 2 * gap;
        Self {
            share: rows.saturating_sub(used).min(12),
            axis,
            variance,
            importance,
            gap,
        }
    }
}

/// Draws the stacks; in the fuse view and alone on the screen, also what each dimension carries.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let dims = snapshot.experts.iter().map(|view| view.share.len()).max();
    let dims = dims.unwrap_or(0);
    let fusion = snapshot.fusion.as_deref();
    if face.view != View::Fuse {
        if dims > 0 && pane.width > LABELS {
            plain(buf, pane, Grid::of(pane.width, dims, 4), snapshot, face);
        }
        return;
    }
    let focused = face.is_focused(Pane::Dims);
    let inner = below_title(pane);
    if dims == 0 || pane.width <= LABELS {
        title(buf, pane, "dims", "", focused);
        empty::draw(buf, inner, snapshot);
        return;
    }
    let grid = Grid::of(pane.width, dims, if face.zoomed { 7 } else { 4 });
    title(buf, pane, "dims", &note(fusion, dims, face.zoomed), focused);
    carried(buf, inner, grid, snapshot, face.depth);
}

/// Shares alone, with the dimensions' numbers below them where there is room.
fn plain(buf: &mut Buffer, pane: Rect, grid: Grid, snapshot: &Snapshot, face: &Face) {
    let numbered = pane.height >= 5;
    let stacks = Rect {
        height: pane.height - u16::from(numbered),
        ..pane
    };
    shares(buf, stacks, grid, snapshot, face.depth);
    for d in (0..grid.dims).filter(|d| numbered && (grid.pitch > 2 || d % 5 == 0)) {
        let end = grid.at(d) + grid.fat();
        right(buf, pane, end, pane.height - 1, &d.to_string(), dim());
    }
}

fn note(fusion: Option<&FusionView>, dims: usize, zoomed: bool) -> String {
    let Some(fusion) = fusion else {
        return String::new();
    };
    let active = fusion.active.iter().filter(|&&active| active).count();
    let mut note = format!("{active} of {dims} active");
    if zoomed && !fusion.active_from.is_empty() {
        note.push_str(" over ");
        note.push_str(&fusion.active_from);
    }
    if fusion.attribution.is_some() {
        // Writing to a string cannot fail.
        let _ = write!(note, ", ±{:.2} cm", 100.0 * most_metres(fusion));
    }
    note
}

/// The largest contribution of any dimension along either axis, in metres.
fn most_metres(fusion: &FusionView) -> f32 {
    let attribution = fusion.attribution.as_deref();
    let all = attribution
        .iter()
        .flat_map(|a| a.contribution_m.iter().flatten());
    all.map(|metres| metres.abs())
        .filter(|metres| metres.is_finite())
        .fold(1e-9, f32::max)
}

fn carried(buf: &mut Buffer, pane: Rect, grid: Grid, snapshot: &Snapshot, depth: Depth) {
    let fusion = snapshot.fusion.as_deref();
    let attribution = fusion.and_then(|fusion| fusion.attribution.as_deref());
    let importance = fusion.map_or(&[][..], |fusion| &fusion.importance_m[..]);
    let numbered = u16::from(pane.height > 2);
    let parts = Parts::of(
        pane.height - numbered,
        attribution.is_some(),
        !importance.is_empty(),
    );
    let active = |d: usize| fusion.is_none_or(|f| f.active.get(d).copied().unwrap_or(true));
    let (stacks, rest) = rows(pane, parts.share);
    shares(buf, stacks, grid, snapshot, depth);
    for d in (0..grid.dims).filter(|&d| !active(d)) {
        grey(buf, stacks, grid, d, snapshot);
    }
    let mut rest = rows(rest, parts.gap).1;
    let mut part = |height: u16| {
        let (part, below) = rows(rest, height);
        rest = below;
        part
    };
    if let (Some(fusion), Some(attribution)) = (fusion, attribution) {
        let most = most_metres(fusion);
        for (name, metres) in ["x cm", "y cm"]
            .into_iter()
            .zip(&attribution.contribution_m)
        {
            signed(buf, part(parts.axis), grid, name, metres, most, &active);
        }
        part(parts.gap);
        for (name, of) in ["σ² x", "σ² y"].into_iter().zip(&attribution.variance_part) {
            bars(buf, part(parts.variance), grid, name, of, &active);
        }
        let metres: Vec<f32> = importance.iter().map(|&metres| metres as f32).collect();
        bars(buf, part(parts.importance), grid, "perm", &metres, &active);
    }
    if numbered == 1 {
        let row = parts.share + 2 * (parts.axis + parts.variance + parts.gap) + parts.importance;
        numbers(buf, pane, row, grid, &active);
    }
}

fn shares(buf: &mut Buffer, pane: Rect, grid: Grid, snapshot: &Snapshot, depth: Depth) {
    text(buf, pane, 0, 0, "share", dim());
    text(buf, pane, 0, 1, "per z", dim());
    for d in 0..grid.dims {
        let at = grid.at(d);
        for column in at..(at + grid.fat()).min(pane.width) {
            stack(buf, pane, column, &share_of(snapshot, d), depth);
        }
    }
}

fn share_of(snapshot: &Snapshot, d: usize) -> Vec<(Expert, f32)> {
    let share = |views: &crate::session::snapshot::ExpertView| {
        (views.expert, views.share.get(d).copied().unwrap_or(0.0))
    };
    snapshot.experts.iter().map(share).collect()
}

/// Draws an inactive dimension's stack again, by fills alone and dim.
fn grey(buf: &mut Buffer, pane: Rect, grid: Grid, d: usize, snapshot: &Snapshot) {
    let at = grid.at(d);
    for column in at..(at + grid.fat()).min(pane.width) {
        stack(buf, pane, column, &share_of(snapshot, d), Depth::Plain);
        for row in 0..pane.height {
            if let Some(cell) = buf.cell_mut((pane.x + column, pane.y + row)) {
                cell.set_style(dim());
            }
        }
    }
}

/// Bars up for what is positive and hanging for what is negative; on two rows or more, about a line between them.
fn signed(
    buf: &mut Buffer,
    pane: Rect,
    grid: Grid,
    name: &str,
    metres: &[f32],
    most: f32,
    active: &impl Fn(usize) -> bool,
) {
    if pane.height == 0 {
        return;
    }
    let middle = pane.height / 2;
    text(buf, pane, 0, middle.saturating_sub(1), name, dim());
    for (d, &value) in metres.iter().enumerate().take(grid.dims) {
        let part = (value / most).clamp(-1.0, 1.0);
        let style = if active(d) { Style::new() } else { dim() };
        for at in grid.at(d)..(grid.at(d) + grid.fat()).min(pane.width) {
            if pane.height == 1 {
                put(buf, pane, at, 0, sign(part), style);
            } else {
                bar_about(buf, pane, at, part, style);
            }
        }
    }
}

/// One cell: low or hanging, half or an eighth; a dot for next to nothing.
fn sign(part: f32) -> char {
    match part {
        part if part >= 0.4 => '▄',
        part if part >= 0.06 => '▁',
        part if part <= -0.4 => '▀',
        part if part <= -0.06 => '▔',
        _ => '·',
    }
}

fn bar_about(buf: &mut Buffer, pane: Rect, at: u16, part: f32, style: Style) {
    let (above, below) = rows(pane, pane.height / 2);
    if part > 0.0 {
        column(
            buf,
            above,
            at,
            part.max(0.13 / f32::from(above.height)),
            style,
        );
        return;
    }
    let length = -part * f32::from(below.height);
    for row in 0..below.height {
        let fill = match length - f32::from(row) {
            left if left >= 0.75 => '█',
            left if left >= 0.4 => '▀',
            left if left >= 0.06 => '▔',
            _ => break,
        };
        put(buf, below, at, row, fill, style);
    }
}

/// Bars of parts of a whole; the largest fills the rows.
fn bars(
    buf: &mut Buffer,
    pane: Rect,
    grid: Grid,
    name: &str,
    values: &[f32],
    active: &impl Fn(usize) -> bool,
) {
    if pane.height == 0 || values.is_empty() {
        return;
    }
    text(buf, pane, 0, pane.height - 1, name, dim());
    let most = values.iter().copied().filter(|value| value.is_finite());
    let most = most.fold(1e-9, f32::max);
    for (d, &value) in values.iter().enumerate().take(grid.dims) {
        let style = if active(d) { Style::new() } else { dim() };
        for at in grid.at(d)..(grid.at(d) + grid.fat()).min(pane.width) {
            column(buf, pane, at, value / most, style);
        }
    }
}

/// The dimensions' numbers, the last figure where a column has no room for two; a dot for one that is inactive.
fn numbers(buf: &mut Buffer, pane: Rect, row: u16, grid: Grid, active: &impl Fn(usize) -> bool) {
    text(buf, pane, 0, row, "dim", dim());
    for d in 0..grid.dims {
        let number = match () {
            () if !active(d) => "·".to_owned(),
            () if grid.pitch > 2 => d.to_string(),
            () => (d % 10).to_string(),
        };
        right(buf, pane, grid.at(d) + grid.fat(), row, &number, dim());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_never_take_more_rows_than_there_are() {
        for rows in 0..40 {
            for carries in [false, true] {
                let parts = Parts::of(rows, carries, true);
                let used =
                    parts.share + 2 * (parts.axis + parts.variance + parts.gap) + parts.importance;
                assert!(used <= rows, "{rows}: {parts:?}");
                assert!(rows < 4 || parts.share >= 2, "{rows}: {parts:?}");
            }
        }
    }

    #[test]
    fn signs_differ_without_colour() {
        assert_eq!(
            [-1.0, -0.2, 0.0, 0.2, 1.0].map(sign),
            ['▀', '▔', '·', '▁', '▄']
        );
        let mut buf = Buffer::empty(Rect::new(0, 0, 4, 2));
        let pane = buf.area;
        for (at, part) in [(0, 1.0), (1, -1.0), (2, 0.25), (3, -0.25)] {
            bar_about(&mut buf, pane, at, part, Style::new());
        }
        assert_eq!(buf, Buffer::with_lines(["█ ▂ ", " █ ▔"]));
    }
}
