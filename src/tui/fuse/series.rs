//! Diagnostics over time, a row a quantity, on the timeline's axis: what is read at a step stands below its force.
//!
//! ```text
//! pos    ░░░░▒▒▒▒▓▓▓▓▓▓▓▓▓▒▒▒▒▒▒▒▒▒▒
//!        ████████████████████████████          VHPD ↑
//! NIS V  ▂▁▃▂▄▃▂▁▂▅▆▲▲▇▅▃▂▁▁▂▂▃▂▁▂▁▂▃           14.1
//! Q      ▂▂▃▂▂▃▄▄▅▆▇▇▆▅▄▄▃▃▃▂▂▂▃▂▂▂▁▂           61.0
//! KL     ▁▁▁▂▂▂▃▃▃▄▅▅▅▄▃▃▂▂▂▁▁▁▁▁▁▁▁▁           2.10
//! ```
//! `pos` is the position-weighted share (D1), `NIS` each sensor against A P Aᵀ + Q (D8), `Q` the conflict (D10), `KL`
//! the surprise (D2). A row one cell high is full at the upper bound of 95 % and marked ▲ beyond it; a higher one
//! draws the bound as a line.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::{empty, mark};
use crate::measure::chi2::Bounds;
use crate::modality::Expert;
use crate::session::snapshot::reading::SeriesView;
use crate::session::snapshot::{Badge, Snapshot};
use crate::tui::axis::Axis;
use crate::tui::face::Face;
use crate::tui::paint::{column, eighth, put, right, short, text};
use crate::tui::stack::{legend, stack};
use crate::tui::theme::{WARNING, dim, strong};
use crate::tui::view::Pane;

/// The fewest rows that show everything of so many experts, the prior among them.
pub fn rows(experts: usize) -> u16 {
    4 + experts.clamp(1, 8) as u16 - 1
}

/// One quantity over time.
struct Row<'a> {
    name: String,
    style: Style,
    values: &'a [f32],
    bounds: Box<dyn Fn(usize) -> Option<Bounds> + 'a>,
}

/// Draws as many rows as there is room for, the shares first.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let steps = snapshot.steps();
    let axis = Axis::of(pane.width, steps);
    let series = match &snapshot.series {
        Some(series) if steps > 0 && snapshot.badge != Badge::NoProduct => series,
        _ => {
            text(buf, pane, 0, 0, "series", dim());
            text(buf, pane, 7, 0, &empty::why(snapshot), dim());
            return;
        }
    };
    let mut rows = curves(series, snapshot, face);
    let Sizes {
        share,
        row,
        shown,
        gap,
    } = Sizes::of(pane.height, rows.len(), face.is_zoomed(Pane::Series));
    rows.truncate(shown);
    let (shares, mut rest) = crate::tui::layout::rows(pane, share);
    stacks(buf, shares, axis, series, snapshot, face);
    for curve in &rows {
        let (own, below) = crate::tui::layout::rows(crate::tui::layout::rows(rest, gap).1, row);
        rest = below;
        bars(buf, own, axis, curve, snapshot.cursor, face);
    }
}

/// Rows of the shares, of each curve and of the gap before it, and how many curves there is room for.
#[derive(Debug, PartialEq, Eq)]
struct Sizes {
    share: u16,
    row: u16,
    shown: usize,
    gap: u16,
}

impl Sizes {
    fn of(height: u16, curves: usize, zoomed: bool) -> Self {
        let count = curves as u16;
        let highest = if zoomed { 4 } else { 2 };
        let gap = u16::from(height >= 3 + 3 * count);
        let row = (height.saturating_sub(2 + gap * count) / count.max(1)).clamp(1, highest);
        let share = height
            .saturating_sub(count * (row + gap))
            .clamp(2, 4)
            .min(height);
        let shown = usize::from(height.saturating_sub(share) / (row + gap)).min(curves);
        Self {
            share,
            row,
            shown,
            gap,
        }
    }
}

/// The curves in the order of their importance: conflict, NIS of each sensor, surprise; alone, NIS in both readings.
fn curves<'a>(series: &'a SeriesView, snapshot: &Snapshot, face: &Face) -> Vec<Row<'a>> {
    let nis = |name: &str, all: &'a [Vec<f32>]| -> Vec<Row<'a>> {
        let sensors = snapshot.experts.iter().zip(all);
        sensors
            .map(|(view, values)| Row {
                name: format!("{name} {}", view.expert.letter()),
                style: face.depth.ink(view.expert.rgb()),
                values,
                bounds: Box::new(|_| series.nis_bounds),
            })
            .collect()
    };
    let measured = |all: &[Vec<f32>]| all.iter().flatten().any(|value| value.is_finite());
    let mut rows = vec![Row {
        name: "Q".to_owned(),
        style: Style::new(),
        values: &series.conflict,
        bounds: Box::new(|step| series.conflict_bounds.get(step).copied().flatten()),
    }];
    match (
        face.is_zoomed(Pane::Series),
        measured(&series.nis_propagated),
    ) {
        (true, _) => {
            rows.extend(nis("prop", &series.nis_propagated));
            rows.extend(nis("head", &series.nis_head));
        }
        (false, true) => rows.extend(nis("NIS", &series.nis_propagated)),
        (false, false) => rows.extend(nis("head", &series.nis_head)),
    }
    rows.push(Row {
        name: "KL".to_owned(),
        style: Style::new(),
        values: &series.surprise,
        bounds: Box::new(|_| None),
    });
    rows
}

fn stacks(
    buf: &mut Buffer,
    pane: Rect,
    axis: Axis,
    series: &SeriesView,
    snapshot: &Snapshot,
    face: &Face,
) {
    let at = if face.is_focused(Pane::Series) {
        text(buf, pane, 0, 0, "▸ ", strong())
    } else {
        0
    };
    text(buf, pane, at, 0, "pos", dim());
    for step in (0..axis.steps).step_by(axis.every) {
        let share = |of: &[f32]| of.get(step).copied().unwrap_or(f32::NAN);
        let shares: Vec<(Expert, f32)> = snapshot
            .experts
            .iter()
            .zip(&series.share_position)
            .map(|(view, of)| (view.expert, share(of)))
            .collect();
        for i in 0..axis.columns {
            stack(buf, pane, axis.column(step) + i, &shares, face.depth);
        }
    }
    legend(buf, pane, pane.height.saturating_sub(1), snapshot, face);
}

fn bars(buf: &mut Buffer, pane: Rect, axis: Axis, row: &Row, cursor: usize, face: &Face) {
    if pane.height == 0 {
        return;
    }
    let floor = pane.height - 1;
    text(buf, pane, 0, floor, &row.name, dim().patch(row.style));
    let finite = row.values.iter().copied().filter(|value| value.is_finite());
    let bound = |step: usize| (row.bounds)(step).map(|bounds| bounds.high);
    let highest = (0..axis.steps).filter_map(bound).fold(1e-6, f32::max);
    let most = finite.fold(highest, f32::max);
    // One row is full at the bound, so that the marks beyond it stand out; more rows hold the largest value.
    let of_bound = pane.height == 1 && highest > 1e-6;
    // An eighth stays free, which keeps the rows apart.
    let top = if of_bound { highest } else { most } * 8.0 / 7.0;
    for step in (0..axis.steps).step_by(axis.every) {
        // Of steps that share a column the worst is drawn.
        let steps = step..(step + axis.every).min(row.values.len());
        let worst =
            steps.max_by(|&a, &b| ordered(row.values[a]).total_cmp(&ordered(row.values[b])));
        let value = worst.map_or(f32::NAN, |at| row.values[at]);
        let bounds = worst.and_then(|at| (row.bounds)(at));
        let above = mark(value, bounds) == '▲';
        for at in (0..axis.columns).map(|i| axis.column(step) + i) {
            if let Some(bounds) = bounds.filter(|_| pane.height > 1) {
                let line = (bounds.high / top * f32::from(pane.height)).ceil() as u16;
                put(
                    buf,
                    pane,
                    at,
                    pane.height - line.clamp(1, pane.height),
                    '┄',
                    dim(),
                );
            }
            let style = if above { strong() } else { dim() }.patch(row.style);
            if pane.height == 1 && value.is_finite() {
                let fill = if of_bound && above {
                    '▲'
                } else {
                    eighth(value / top).max('▁')
                };
                put(buf, pane, at, 0, fill, style);
            } else if value.is_finite() {
                column(buf, pane, at, value / top, style);
            }
        }
    }
    let now = row.values.get(cursor).copied().unwrap_or(f32::NAN);
    if now.is_finite() {
        let sign = mark(now, (row.bounds)(cursor));
        right(buf, pane, pane.width - 1, floor, &short(now), Style::new());
        if sign != ' ' {
            let warning = strong().patch(face.depth.ink(WARNING));
            put(buf, pane, pane.width - 1, floor, sign, warning);
        }
    }
}

/// What is no number is smaller than all that is.
fn ordered(value: f32) -> f32 {
    if value.is_finite() {
        value
    } else {
        f32::NEG_INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_to_the_pane() {
        for height in 0..60 {
            for curves in 1..12 {
                for zoomed in [false, true] {
                    let sizes = Sizes::of(height, curves, zoomed);
                    let used = sizes.share + sizes.shown as u16 * (sizes.row + sizes.gap);
                    assert!(used <= height, "{height}, {curves}: {sizes:?}");
                }
            }
        }
    }

    #[test]
    fn the_fewest_rows_show_every_curve() {
        for sensors in 1..=4 {
            let sizes = Sizes::of(rows(sensors + 1), sensors + 2, false);
            assert_eq!(sizes.shown, sensors + 2);
        }
    }
}
