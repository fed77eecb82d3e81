//! The latent at the cursor, dimension by dimension: the belief's mean and ±σ, and those of the expert in focus.
//!
//! ```text
//! latents  belief ─●─  V ┄V┄
//!  0        ──●── ┄V┄
//!  1  ┄┄V─●──
//!    -3.1        0       3.1
//! ```
//! Alone on the screen it shows the raw numbers of every expert.

mod numbers;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::face::Face;
use super::layout::{columns, rows};
use super::paint::{below_title, put, right, text, title, width};
use super::theme::{dim, strong};
use super::view::Pane;
use crate::session::snapshot::{LatentView, Snapshot};

const NUMBERS: u16 = 3;
/// Columns of the table of numbers, where there is room for it.
const TABLE: u16 = 26;

/// Draws the intervals, and the numbers too on a pane that is wide enough.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    if pane.is_empty() {
        return;
    }
    let expert = snapshot.experts.get(face.expert);
    let note = if face.is_zoomed(Pane::Latents) {
        "of every expert".to_owned()
    } else {
        expert.map_or_else(
            || "● belief".to_owned(),
            |view| match view.expert.letter() {
                letter if pane.width < 30 => format!("● belief {letter}"),
                letter => format!("● belief {letter} {}", view.expert.name()),
            },
        )
    };
    title(buf, pane, "latents", &note, face.is_focused(Pane::Latents));
    let pane = below_title(pane);
    let Some(belief) = &snapshot.belief else {
        text(buf, pane, 0, 0, "no belief at this step", dim());
        return;
    };
    if face.is_zoomed(Pane::Latents) {
        let table = numbers::width_of(snapshot.experts.len()).min(pane.width);
        let (table, rest) = columns(pane, table, 3);
        numbers::draw(buf, table, snapshot, face);
        // The intervals stand in line with the numbers.
        intervals(buf, rows(rest, 2).1, belief, snapshot, face);
    } else {
        intervals(buf, pane, belief, snapshot, face);
    }
}

fn intervals(buf: &mut Buffer, pane: Rect, belief: &LatentView, snapshot: &Snapshot, face: &Face) {
    let expert = snapshot.experts.get(face.expert);
    let other = expert.and_then(|view| Some((view.expert, view.latent.as_ref()?)));
    let reach = reach(belief).max(other.map_or(0.0, |(_, latent)| reach(latent)));
    let table = if pane.width >= TABLE + 24 && !face.zoomed {
        TABLE
    } else {
        0
    };
    let axis = Axis {
        from: NUMBERS,
        columns: pane.width.saturating_sub(NUMBERS + table),
        reach: reach.clamp(1.0, 99.0),
    };
    if axis.columns < 5 || pane.height < 2 {
        return;
    }

    let dims = belief.mean.len().min(usize::from(pane.height - 1));
    for d in 0..dims {
        let row = d as u16;
        let active = snapshot.fusion.as_ref().map(|fusion| &fusion.active);
        let moves = active.is_none_or(|active| active.get(d).copied().unwrap_or(true));
        right(buf, pane, 2, row, &d.to_string(), dim());
        put(buf, pane, axis.at(0.0), row, '·', dim());
        if let Some((expert, latent)) = other
            && let Some((mean, sigma)) = interval(latent, d)
        {
            let ink = face.depth.ink(expert.rgb());
            axis.line(buf, pane, row, (mean, sigma), '┄', ink);
            put(
                buf,
                pane,
                axis.at(mean),
                row,
                expert.letter(),
                strong().patch(ink),
            );
            if table > 0 {
                numbers(buf, pane, (pane.width, row), (mean, sigma), ink);
            }
        }
        if let Some((mean, sigma)) = interval(belief, d) {
            // A dimension that never moves over the data is greyed, and hollow where there are no colours.
            let (mark, style) = if moves {
                ('●', strong())
            } else {
                ('○', dim())
            };
            let line = if moves { Style::new() } else { dim() };
            axis.line(buf, pane, row, (mean, sigma), '─', line);
            put(buf, pane, axis.at(mean), row, mark, style);
            if table > 0 {
                numbers(
                    buf,
                    pane,
                    (pane.width - 13, row),
                    (mean, sigma),
                    Style::new(),
                );
            }
        }
    }
    let row = dims as u16;
    let end = format!("{:.1}", axis.reach);
    text(buf, pane, axis.from, row, &format!("-{end}"), dim());
    put(buf, pane, axis.at(0.0), row, '0', dim());
    right(buf, pane, axis.from + axis.columns, row, &end, dim());
    let hidden = belief.mean.len() - dims;
    if hidden > 0 {
        let more = format!(" {hidden} more ");
        let at = axis.at(0.0).saturating_sub(width(&more) / 2);
        text(buf, pane, at, row, &more, dim());
    } else if table > 0 {
        right(buf, pane, pane.width - 13, row, "μ ± σ", dim());
        right(buf, pane, pane.width, row, "μ ± σ", dim());
    }
}

/// A scale from -reach to reach over some columns.
struct Axis {
    from: u16,
    columns: u16,
    reach: f32,
}

impl Axis {
    fn at(&self, value: f32) -> u16 {
        let part = f32::midpoint((value / self.reach).clamp(-1.0, 1.0), 1.0);
        self.from + (part * f32::from(self.columns - 1)).round() as u16
    }

    fn line(
        &self,
        buf: &mut Buffer,
        pane: Rect,
        row: u16,
        (mean, sigma): (f32, f32),
        fill: char,
        style: Style,
    ) {
        for column in self.at(mean - sigma)..=self.at(mean + sigma) {
            put(buf, pane, column, row, fill, style);
        }
    }
}

fn interval(latent: &LatentView, d: usize) -> Option<(f32, f32)> {
    Some((*latent.mean.get(d)?, *latent.sigma.get(d)?))
}

fn reach(latent: &LatentView) -> f32 {
    let ends = latent.mean.iter().zip(&latent.sigma);
    ends.map(|(mean, sigma)| mean.abs() + sigma)
        .fold(0.0, f32::max)
}

fn numbers(
    buf: &mut Buffer,
    pane: Rect,
    (end, row): (u16, u16),
    (mean, sigma): (f32, f32),
    style: Style,
) {
    right(
        buf,
        pane,
        end,
        row,
        &format!("{mean:.2} ± {sigma:.2}"),
        style,
    );
}
