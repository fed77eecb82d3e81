//! The episode along its steps: where the cursor is, what was seen, what is predicted, what was felt, who was heard.
//!
//! ```text
//! step  9/16  2.13 s ▸ 1×       context 4  horizon 11
//!        ━━━━━━━┃╌╌╌╌╌╌╌╌◆╌╌╌╌╌╌╌╌╌╌╌──            +5
//! force             ▂▄▅▆▆▇▇██▇▆▅▄▃▂            3.2 N
//! share  ░░░░▒▒▒▒▓▓▓▓▓▓▓▓▓▒▒▒▒▒▒▒▒▒▒
//!        ████████████████████████████         VHPD ↑
//! belief ▆▆▆▆▆▅▅▅▆▆▆▆▆▆▆▇▇▇▆▆▆▆▆▆▆▆▆▆        29.9 dB
//! ```
//! Rows share one axis, a step never less than a column unless the header says how many.

mod events;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::axis::{Axis, LABELS};
use super::face::Face;
use super::layout::rows;
use super::paint::{column, put, right, text};
use super::stack::{legend, stack};
use super::theme::{PREDICTION, dim, strong};
use super::view::Pane;
use super::words::prediction;
use crate::modality::Expert;
use crate::session::command::Looping;
use crate::session::snapshot::{Snapshot, StepPsnr};

/// Bars of PSNR go from here to here, in dB.
const PSNR_RANGE: (f32, f32) = (10.0, 40.0);

/// Rows of each part of a timeline, and the blank ones between them.
#[derive(Default)]
struct Parts {
    events: u16,
    force: u16,
    share: u16,
    psnr: u16,
    gap: u16,
}

impl Parts {
    /// Divides the rows below header and track; more than makes a calm picture is left blank.
    fn of(rows: u16) -> Self {
        let events = u16::from(rows >= 4);
        let rows = rows - events;
        let (psnr, gap) = match rows {
            0..=4 => (0, 0),
            5..=8 => (1, 0),
            9..=13 => (1, 1),
            _ => (2, 1),
        };
        let rest = rows - 2 * psnr - 2 * gap;
        let force = (rest / 3).max(u16::from(rest > 0)).min(4);
        Self {
            events,
            force,
            share: (rest - force).min(8),
            psnr,
            gap,
        }
    }
}

/// Draws the rows that there is room for.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    header(buf, pane, snapshot, face);
    let Some(episode) = &snapshot.episode else {
        return;
    };
    let axis = Axis::of(pane.width, episode.secs.len());
    if pane.height < 2 || axis.steps == 0 {
        return;
    }
    let parts = Parts::of(pane.height - 2);
    track(buf, pane, 1, axis, snapshot, face);
    let (event_rows, rest) = rows(rows(pane, 2).1, parts.events);
    events::row(buf, event_rows, axis, snapshot, face);
    let (force_rows, rest) = rows(rest, parts.force);
    let (share_rows, rest) = rows(rows(rest, parts.gap).1, parts.share);
    let (belief_rows, rest) = rows(rows(rest, parts.gap).1, parts.psnr);
    let (prediction_rows, _) = rows(rest, parts.psnr);
    force(buf, force_rows, axis, snapshot);
    shares(buf, share_rows, axis, snapshot, face);
    let ink = face.depth.ink(PREDICTION);
    psnr(
        buf,
        belief_rows,
        axis,
        snapshot,
        ("belief", Style::new()),
        |psnr| psnr.belief,
    );
    psnr(
        buf,
        prediction_rows,
        axis,
        snapshot,
        (prediction(snapshot).1, ink),
        |psnr| psnr.prediction,
    );
}

fn header(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let steps = snapshot.steps();
    let mark = if face.is_focused(Pane::Timeline) {
        "▸ step "
    } else {
        "step "
    };
    let mut at = text(buf, pane, 0, 0, mark, strong());
    let shown = if steps == 0 { 0 } else { snapshot.cursor + 1 };
    at = text(buf, pane, at, 0, &format!("{shown:>2}/{steps}"), strong());
    let secs = snapshot
        .episode
        .as_ref()
        .and_then(|episode| episode.secs.get(snapshot.cursor));
    if let Some(secs) = secs {
        at = text(
            buf,
            pane,
            at + 1,
            0,
            &format!("{secs:>5.2} s"),
            Style::new(),
        );
    }
    let playing = if snapshot.playing { "▸" } else { "‖" };
    let mut play = format!("{playing} {}×", snapshot.speed);
    if pane.width >= 54 {
        play.push_str(match snapshot.looping {
            Looping::Off => "",
            Looping::All => " loop",
            Looping::Selection => " loop sel",
        });
    }
    at = text(
        buf,
        pane,
        at + 1,
        0,
        &play,
        if snapshot.playing { strong() } else { dim() },
    );
    let axis = Axis::of(pane.width, steps);
    if axis.every > 1 {
        at = text(
            buf,
            pane,
            at + 2,
            0,
            &format!("{} steps a column", axis.every),
            dim(),
        );
    }
    let rollout = format!("context {}  horizon {}", snapshot.context, snapshot.horizon);
    if at + 2 + super::paint::width(&rollout) <= pane.width {
        right(buf, pane, pane.width, 0, &rollout, Style::new());
    } else {
        text(
            buf,
            pane,
            at + 2,
            0,
            &format!("context {} + {}", snapshot.context, snapshot.horizon),
            Style::new(),
        );
    }
}

fn track(buf: &mut Buffer, pane: Rect, row: u16, axis: Axis, snapshot: &Snapshot, face: &Face) {
    let first = snapshot.first_belief();
    let (start, end) = (snapshot.start, snapshot.start + snapshot.horizon);
    let prediction = face.depth.ink(PREDICTION);
    for step in (0..axis.steps).step_by(axis.every) {
        let (fill, style) = match step {
            step if step < first => ('·', dim()),
            step if step <= start => ('━', Style::new()),
            step if step <= end => ('╌', prediction),
            _ => ('─', dim()),
        };
        for i in 0..axis.columns {
            put(buf, pane, axis.column(step) + i, row, fill, style);
        }
    }
    // The bar closes the last step that was seen.
    let boundary = axis.column(start) + axis.columns - 1;
    if start < axis.steps {
        put(buf, pane, boundary, row, '┃', strong());
    }
    if Parts::of(pane.height.saturating_sub(2)).events == 0 {
        events::over_track(buf, pane, row, axis, snapshot, face);
    }
    let middle = (axis.columns - 1) / 2;
    put(
        buf,
        pane,
        axis.column(snapshot.cursor) + middle,
        row,
        '◆',
        strong(),
    );
    let seen = if snapshot.cursor <= start {
        "seen".to_owned()
    } else if snapshot.cursor <= end {
        format!("+{}", snapshot.cursor - start)
    } else {
        "past".to_owned()
    };
    // What the cursor covers is said beside the track.
    let start = right(buf, pane, pane.width, row, &seen, dim());
    let here: String = events::symbols(snapshot, snapshot.cursor)
        .into_iter()
        .collect();
    right(buf, pane, start.saturating_sub(1), row, &here, strong());
}

fn force(buf: &mut Buffer, pane: Rect, axis: Axis, snapshot: &Snapshot) {
    let Some(episode) = snapshot.episode.as_ref().filter(|_| pane.height > 0) else {
        return;
    };
    let newtons = &episode.force_newtons;
    text(buf, pane, 0, 0, "force", dim());
    if newtons.is_empty() {
        text(buf, pane, LABELS, 0, "not recorded", dim());
        return;
    }
    let most = newtons
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .fold(1e-6, f32::max);
    bars(buf, pane, axis, dim(), |step| {
        Some(newtons.get(step)? / most)
    });
    if let Some(now) = newtons.get(snapshot.cursor) {
        right(
            buf,
            pane,
            pane.width,
            pane.height - 1,
            &format!("{now:.1} N"),
            Style::new(),
        );
    }
}

fn shares(buf: &mut Buffer, pane: Rect, axis: Axis, snapshot: &Snapshot, face: &Face) {
    if pane.height == 0 {
        return;
    }
    text(buf, pane, 0, 0, "share", dim());
    for step in (0..axis.steps).step_by(axis.every) {
        let shares: Vec<(Expert, f32)> = snapshot
            .experts
            .iter()
            .map(|view| {
                (
                    view.expert,
                    view.share_over_time.get(step).copied().unwrap_or(f32::NAN),
                )
            })
            .collect();
        for i in 0..axis.columns {
            stack(buf, pane, axis.column(step) + i, &shares, face.depth);
        }
    }
    legend(buf, pane, pane.height - 1, snapshot, face);
}

fn psnr(
    buf: &mut Buffer,
    pane: Rect,
    axis: Axis,
    snapshot: &Snapshot,
    (name, style): (&str, Style),
    of: impl Fn(&StepPsnr) -> Option<f32>,
) {
    text(buf, pane, 0, 0, name, dim().patch(style));
    let (low, high) = PSNR_RANGE;
    let value = |step: usize| snapshot.psnr_db.get(step).and_then(&of);
    bars(buf, pane, axis, dim().patch(style), |step| {
        Some((value(step)? - low) / (high - low))
    });
    if let Some(db) = value(snapshot.cursor) {
        right(
            buf,
            pane,
            pane.width,
            pane.height - 1,
            &format!("{db:.1} dB"),
            style,
        );
    }
}

/// Bars along the axis; of steps that share a column the highest is drawn.
fn bars(
    buf: &mut Buffer,
    pane: Rect,
    axis: Axis,
    style: Style,
    fraction: impl Fn(usize) -> Option<f32>,
) {
    let shown = Rect {
        width: pane.width.min(LABELS + axis.width()),
        ..pane
    };
    for step in (0..axis.steps).step_by(axis.every) {
        let highest = (step..step + axis.every)
            .filter_map(&fraction)
            .fold(0.0, f32::max);
        for i in 0..axis.columns {
            column(buf, shown, axis.column(step) + i, highest, style);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_fill_their_rows_up_to_a_calm_size() {
        for rows in 0..40 {
            let parts = Parts::of(rows);
            let used = parts.events + parts.force + parts.share + 2 * (parts.psnr + parts.gap);
            assert!(used <= rows && (used == rows || rows > 18), "{rows}");
        }
    }
}
