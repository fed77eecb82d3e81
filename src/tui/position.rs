//! The table from above, in centimetres, equal aspect: where the object was, is believed and was predicted to be.
//!
//! ```text
//! position cm ──── ● 0.8  ◆ 1.4 off
//! 10        ╌╌╌×╌
//!         ────●
//!  0   +         ┈┈┈◆
//!      0         10
//! ╌ truth ─ belief ┈ pred + tip
//! 1σ solid 39 %, 95 % dashed
//! ```
//! This is the overview's pane; [`table`] draws the same with arrows, ghosts and samples, [`pulls`] the numbers.

pub mod arrows;
pub mod pulls;
pub mod table;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::braille::{Canvas, Stroke};
use super::face::Face;
use super::paint::{below_title, put, text, title, width};
use super::plane::{Extent, GUTTER, Plane};
use super::theme::{PREDICTION, dim, strong};
use super::view::{Pane, View};
use super::words;
use crate::measure::ellipse::{ONE_SIGMA_MASS, SIGMAS_OF_95_PERCENT};
use crate::session::snapshot::{Estimate, PositionView, Snapshot, estimate_at};

/// Draws the plane with its legend; in the view of its own the large one.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    if pane.is_empty() {
        return;
    }
    if face.view == View::Position {
        table::draw(buf, pane, snapshot, face);
        return;
    }
    let focused = face.is_focused(Pane::Position);
    let Some(position) = &snapshot.position else {
        title(buf, pane, "position", "", focused);
        let below = below_title(pane);
        text(buf, below, 0, 0, "no probe or no belief yet", dim());
        return;
    };
    title(buf, pane, "position cm", &off(position), focused);
    let inner = below_title(pane);
    let legend = if inner.height >= 6 { 2 } else { 0 };
    if let Some((plane, view)) = window(inner, legend, Extent::of(position)) {
        view.axes(buf, inner);
        let mut canvas = Canvas::new(plane.width, plane.height);
        paths(&mut canvas, &view, position, face);
        ellipses(&mut canvas, &view, position, snapshot.cursor, face);
        canvas.draw(buf, plane);
        marks(buf, plane, &view, position, snapshot.cursor, face);
    }
    if legend > 0 {
        let row = inner.height - 2;
        let ink = face.depth.ink(PREDICTION);
        let (full, short) = words::prediction(snapshot);
        let (gap, name) = if inner.width < 40 {
            (1, short)
        } else {
            (2, full)
        };
        let mut at = text(buf, inner, 0, row, "╌ truth", dim());
        at = text(buf, inner, at + gap, row, "─ belief", dim());
        let name = format!("┈ {name}");
        at = text(buf, inner, at + gap, row, &name, dim().patch(ink));
        if at + gap + width("+ tip") <= inner.width {
            text(buf, inner, at + gap, row, "+ tip", dim());
        }
        let masses = match inner.width {
            52.. => format!("{}; {full}: one step's σ", masses()),
            _ => masses(),
        };
        text(buf, inner, 0, row + 1, &masses, dim());
    }
}

/// What the two ellipses hold.
fn masses() -> String {
    let mass = ONE_SIGMA_MASS * 100.0;
    format!("1σ solid {mass:.0} %, 95 % dashed")
}

/// The plane's cells and its window on the table, above so many rows of legend; none without points or room.
fn window(inner: Rect, legend: u16, extent: Option<Extent>) -> Option<(Rect, Plane)> {
    let plane = Rect {
        x: inner.x + GUTTER.min(inner.width),
        width: inner.width.saturating_sub(GUTTER),
        height: inner.height.saturating_sub(legend + 1),
        ..inner
    };
    (plane.width >= 4 && plane.height >= 2).then_some((plane, Plane::new(extent?, plane)))
}

/// How far the estimates at the cursor are off, in cm.
fn off(position: &PositionView) -> String {
    let shown = [
        ("●", position.belief_error_m),
        ("◆", position.prediction_error_m),
    ];
    let parts: Vec<String> = shown
        .into_iter()
        .filter_map(|(mark, metres)| Some(format!("{mark} {:.1}", metres? * 100.0)))
        .collect();
    if parts.is_empty() {
        String::new()
    } else {
        format!("{} off", parts.join(" "))
    }
}

/// The dots of the estimates that there are.
fn dots(view: &Plane, estimates: &[Option<Estimate>]) -> Vec<(f32, f32)> {
    let points = estimates.iter().flatten();
    points
        .map(|estimate| view.dot([estimate.x, estimate.y]))
        .collect()
}

/// Truth dashed, prediction dotted, belief whole.
fn paths(canvas: &mut Canvas, view: &Plane, position: &PositionView, face: &Face) {
    let truth = position.truth.iter().map(|pose| view.dot([pose.x, pose.y]));
    canvas.path(&truth.collect::<Vec<_>>(), Stroke::Dashed, dim());
    let ink = face.depth.ink(PREDICTION);
    canvas.path(&dots(view, &position.prediction), Stroke::Dotted, ink);
    canvas.path(&dots(view, &position.belief), Stroke::Solid, Style::new());
}

/// Those at the cursor.
fn ellipses(
    canvas: &mut Canvas,
    view: &Plane,
    position: &PositionView,
    cursor: usize,
    face: &Face,
) {
    // A prediction states the spread of its last step only, which no mass can be claimed for.
    if let Some(estimate) = estimate_at(&position.prediction, cursor) {
        let ink = face.depth.ink(PREDICTION);
        canvas.path(&view.ellipse(&estimate, 1.0), Stroke::Solid, ink);
    }
    if let Some(estimate) = estimate_at(&position.belief, cursor) {
        let outline = view.ellipse(&estimate, SIGMAS_OF_95_PERCENT);
        canvas.path(&outline, Stroke::Dashed, Style::new());
        canvas.path(&view.ellipse(&estimate, 1.0), Stroke::Solid, Style::new());
    }
}

/// Tip, truth, prediction and belief at the cursor, the most important last.
fn marks(
    buf: &mut Buffer,
    pane: Rect,
    view: &Plane,
    position: &PositionView,
    cursor: usize,
    face: &Face,
) {
    let mut mark = |point: [f32; 2], symbol: char, style: Style| {
        if let Some((column, row)) = view.cell(view.dot(point)) {
            put(buf, pane, column, row, symbol, style);
        }
    };
    if let Some(&tip) = position.tip.get(cursor) {
        mark(tip, '+', Style::new());
    }
    if let Some(pose) = position.truth.get(cursor) {
        mark([pose.x, pose.y], '×', strong());
    }
    if let Some(estimate) = estimate_at(&position.prediction, cursor) {
        let ink = strong().patch(face.depth.ink(PREDICTION));
        mark([estimate.x, estimate.y], '◆', ink);
    }
    if let Some(estimate) = estimate_at(&position.belief, cursor) {
        mark([estimate.x, estimate.y], '●', strong());
    }
}

/// The cells of truth, prediction and belief at the cursor.
fn marked(view: &Plane, position: &PositionView, cursor: usize) -> Vec<(u16, u16)> {
    let truth = position.truth.get(cursor).map(|pose| [pose.x, pose.y]);
    let estimates = [&position.prediction, &position.belief].map(|path| {
        let now = estimate_at(path, cursor)?;
        Some([now.x, now.y])
    });
    let points = [truth].into_iter().chain(estimates).flatten();
    points
        .filter_map(|point| view.cell(view.dot(point)))
        .collect()
}
