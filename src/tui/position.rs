//! The table from above, in centimetres, equal aspect: where the object was, is believed and was predicted to be.
//!
//! ```text
//! position cm ──── ● 0.8  ◆ 1.4 off
//!  12        ╌╌╌×╌
//!         ────●
//!   0  +         ┈┈┈◆
//!     -3              12
//! ╌ truth ─ belief ┈ pred + tip
//! 1σ solid 39 %, 95 % dashed
//! ```

pub mod pulls;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::braille::{Canvas, Stroke};
use super::face::Face;
use super::paint::{below_title, put, right, text, title};
use super::theme::{PREDICTION, dim, strong};
use super::view::Pane;
use crate::measure::ellipse::{Ellipse, ONE_SIGMA_MASS, SIGMAS_OF_95_PERCENT};
use crate::session::snapshot::{Estimate, PositionView, Snapshot};

/// Columns of the numbers on the y axis.
const GUTTER: u16 = 4;

/// Draws the plane with its legend.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    if pane.is_empty() {
        return;
    }
    let focused = face.is_focused(Pane::Position);
    let Some(position) = &snapshot.position else {
        title(buf, pane, "position", "", focused);
        text(
            buf,
            below_title(pane),
            0,
            0,
            "no probe or no belief yet",
            dim(),
        );
        return;
    };
    title(buf, pane, "position cm", &off(position), focused);
    let inner = below_title(pane);
    let legend = if inner.height >= 6 { 2 } else { 0 };
    let plane = Rect {
        x: inner.x + GUTTER.min(inner.width),
        width: inner.width.saturating_sub(GUTTER),
        height: inner.height.saturating_sub(legend + 1),
        ..inner
    };
    if plane.width >= 4
        && plane.height >= 2
        && let Some(view) = Plane::around(position, plane)
    {
        view.axes(buf, inner);
        view.draw(buf, plane, position, snapshot.cursor, face);
    }
    if legend > 0 {
        let row = inner.height - 2;
        let ink = face.depth.ink(PREDICTION);
        let (gap, prediction) = if inner.width < 40 {
            (1, "┈ pred")
        } else {
            (2, "┈ prediction")
        };
        let mut at = text(buf, inner, 0, row, "╌ truth", dim());
        at = text(buf, inner, at + gap, row, "─ belief", dim());
        at = text(buf, inner, at + gap, row, prediction, dim().patch(ink));
        text(buf, inner, at + gap, row, "+ tip", dim());
        let mass = ONE_SIGMA_MASS * 100.0;
        let masses = if inner.width < 52 {
            format!("1σ solid {mass:.0} %, 95 % dashed")
        } else {
            format!("1σ solid {mass:.0} %, 95 % dashed; prediction: one step's σ")
        };
        text(buf, inner, 0, row + 1, &masses, dim());
    }
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

/// A window on the table: centimetres to dots.
struct Plane {
    left: f32,
    top: f32,
    cm_per_dot: f32,
    dots: (f32, f32),
}

impl Plane {
    /// The window that holds every point of the episode and keeps still while the cursor moves.
    fn around(position: &PositionView, pane: Rect) -> Option<Self> {
        let truth = position.truth.iter().map(|pose| (pose.x, pose.y));
        let tip = position.tip.iter().map(|&[x, y]| (x, y));
        let estimates = position
            .belief
            .iter()
            .chain(position.prediction.iter())
            .flatten();
        let points: Vec<(f32, f32)> = truth
            .chain(tip)
            .chain(estimates.map(|estimate| (estimate.x, estimate.y)))
            .filter(|(x, y)| x.is_finite() && y.is_finite())
            .map(|(x, y)| (x * 100.0, y * 100.0))
            .collect();
        let &first = points.first()?;
        let ends = points.iter().fold((first, first), |(low, high), &(x, y)| {
            ((low.0.min(x), low.1.min(y)), (high.0.max(x), high.1.max(y)))
        });
        let ((x0, y0), (x1, y1)) = ends;
        let dots = (f32::from(pane.width) * 2.0, f32::from(pane.height) * 4.0);
        let border = 1.0;
        let width = x1 - x0 + 2.0 * border;
        let height = y1 - y0 + 2.0 * border;
        let cm_per_dot = (width / dots.0).max(height / dots.1);
        Some(Self {
            left: f32::midpoint(x0, x1) - cm_per_dot * dots.0 / 2.0,
            top: f32::midpoint(y0, y1) + cm_per_dot * dots.1 / 2.0,
            cm_per_dot,
            dots,
        })
    }

    /// Dots of a point in metres, y upwards.
    fn dot(&self, x: f32, y: f32) -> (f32, f32) {
        (
            (x * 100.0 - self.left) / self.cm_per_dot,
            (self.top - y * 100.0) / self.cm_per_dot,
        )
    }

    fn axes(&self, buf: &mut Buffer, pane: Rect) {
        let (width, height) = self.dots;
        let rows = (height / 4.0) as u16;
        // Through whole numbers, so that nothing reads -0.
        let cm = |value: f32| (value.round() as i32).to_string();
        let bottom = self.top - height * self.cm_per_dot;
        right(buf, pane, GUTTER - 1, 0, &cm(self.top), dim());
        right(buf, pane, GUTTER - 1, rows - 1, &cm(bottom), dim());
        for row in 0..rows {
            put(buf, pane, GUTTER - 1, row, '│', dim());
        }
        let end = GUTTER + (width / 2.0) as u16;
        text(buf, pane, GUTTER, rows, &cm(self.left), dim());
        right(
            buf,
            pane,
            end,
            rows,
            &cm(self.left + width * self.cm_per_dot),
            dim(),
        );
        put(buf, pane, GUTTER - 1, rows, '└', dim());
    }

    fn draw(
        &self,
        buf: &mut Buffer,
        pane: Rect,
        position: &PositionView,
        cursor: usize,
        face: &Face,
    ) {
        let ink = face.depth.ink(PREDICTION);
        let path = |estimates: &[Option<Estimate>]| -> Vec<(f32, f32)> {
            let points = estimates.iter().flatten();
            points
                .map(|estimate| self.dot(estimate.x, estimate.y))
                .collect()
        };
        let truth: Vec<(f32, f32)> = position
            .truth
            .iter()
            .map(|pose| self.dot(pose.x, pose.y))
            .collect();
        let mut canvas = Canvas::new(pane.width, pane.height);
        canvas.path(&truth, Stroke::Dashed, dim());
        canvas.path(&path(&position.prediction), Stroke::Dotted, ink);
        canvas.path(&path(&position.belief), Stroke::Solid, Style::new());
        let at = |estimates: &[Option<Estimate>]| estimates.get(cursor).copied().flatten();
        let (belief, prediction) = (at(&position.belief), at(&position.prediction));
        // A prediction states the spread of its last step only, which no mass can be claimed for.
        if let Some(estimate) = prediction {
            canvas.path(&self.ellipse(&estimate, 1.0), Stroke::Solid, ink);
        }
        if let Some(estimate) = belief {
            canvas.path(
                &self.ellipse(&estimate, SIGMAS_OF_95_PERCENT),
                Stroke::Dashed,
                Style::new(),
            );
            canvas.path(&self.ellipse(&estimate, 1.0), Stroke::Solid, Style::new());
        }
        canvas.draw(buf, pane);

        let mut mark = |(x, y): (f32, f32), symbol: char, style: Style| {
            if x >= 0.0 && y >= 0.0 && x.is_finite() && y.is_finite() {
                put(buf, pane, (x / 2.0) as u16, (y / 4.0) as u16, symbol, style);
            }
        };
        if let Some(&[x, y]) = position.tip.get(cursor) {
            mark(self.dot(x, y), '+', Style::new());
        }
        if let Some(pose) = position.truth.get(cursor) {
            mark(self.dot(pose.x, pose.y), '×', strong());
        }
        if let Some(estimate) = prediction {
            mark(self.dot(estimate.x, estimate.y), '◆', strong().patch(ink));
        }
        if let Some(estimate) = belief {
            mark(self.dot(estimate.x, estimate.y), '●', strong());
        }
    }

    /// The outline of so many standard deviations, closed.
    fn ellipse(&self, estimate: &Estimate, sigmas: f32) -> Vec<(f32, f32)> {
        const POINTS: usize = 48;
        let ellipse = Ellipse::of_covariance(estimate.covariance);
        let outline = ellipse.outline([estimate.x, estimate.y], sigmas, POINTS);
        let closing = outline.first().copied();
        outline
            .iter()
            .copied()
            .chain(closing)
            .map(|[x, y]| self.dot(x, y))
            .collect()
    }
}
