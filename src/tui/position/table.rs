//! The table plane, large: paths and ellipses as in the overview, and who pulls the belief where.
//!
//! ```text
//! table cm ─────────────────────── pulls ×10
//! 10        ╌╌╌×╌╌╌
//!         ────●──  (V)
//!  5    D━━V   H
//!      0         5        10
//! ╌ truth  ─ belief  ┈ prediction  + tip  1σ solid 39 %, 95 % dashed
//! D─V─H pulls ×10, sum Σ  (V) without V
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::super::braille::{Canvas, Stroke};
use super::super::face::Face;
use super::super::paint::{below_title, put, text, title};
use super::super::plane::{Extent, Plane};
use super::super::theme::{PREDICTION, SECOND, dim, strong};
use super::super::view::Pane;
use super::super::words::{self, Entry, legend, legend_rows};
use super::arrows::{Arrows, ghosts};
use super::{dots, ellipses, marked, marks, masses, off, paths, window};
use crate::measure::ellipse::SIGMAS_OF_95_PERCENT;
use crate::modality::Expert;
use crate::session::model_key;
use crate::session::snapshot::{PositionView, Snapshot, estimate_at};

/// Draws the plane with its legend.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Position);
    if pane.is_empty() {
        return;
    }
    let Some(position) = &snapshot.position else {
        title(buf, pane, "table", "", focused);
        let below = below_title(pane);
        text(buf, below, 0, 0, "no probe or no belief yet", dim());
        return;
    };
    title(buf, pane, "table cm", &off(position), focused);
    let inner = below_title(pane);
    let other = snapshot
        .other
        .as_ref()
        .and_then(|other| other.position.as_ref());
    let extent = Extent::of(position).map(|extent| extent.and(other.and_then(Extent::of)));
    let fan = snapshot
        .spread
        .as_ref()
        .filter(|_| snapshot.sampling.shown || face.zoomed);
    // Room for the longest legend of these settings: the window must not jump while the cursor moves.
    let longest = Said {
        arrows: Some(100.0),
        samples: fan.map(|spread| spread.samples),
        cut: false,
    };
    let entries = longest.entries(snapshot, face);
    let wanted = legend_rows(&borrowed(&entries), inner.width).len() as u16;
    let room = wanted.min(inner.height / 4).max(1);
    let Some((plane, view)) = window(inner, room, extent) else {
        return;
    };
    view.axes(buf, inner);
    let arrows = Arrows::of(snapshot, &view);
    let mut canvas = Canvas::new(plane.width, plane.height);
    for path in fan.iter().flat_map(|spread| &spread.fan) {
        let path: Vec<(f32, f32)> = path.iter().map(|&point| view.dot(point)).collect();
        let ink = dim().patch(face.depth.ink(PREDICTION));
        canvas.path(&path, Stroke::Sparse, ink);
    }
    let recorded = dots(&view, &position.recorded_controls);
    canvas.path(&recorded, Stroke::Sparse, dim());
    if let Some(other) = other {
        let ink = face.depth.ink(SECOND);
        canvas.path(&dots(&view, &other.prediction), Stroke::Sparse, ink);
        canvas.path(&dots(&view, &other.belief), Stroke::DashDot, ink);
    }
    paths(&mut canvas, &view, position, face);
    ellipses(&mut canvas, &view, position, snapshot.cursor, face);
    if let Some(arrows) = &arrows {
        arrows.lines(&mut canvas, face);
    }
    canvas.draw(buf, plane);
    if let Some(other) = other {
        other_marks(buf, plane, &view, other, snapshot.cursor, face);
    }
    if let Some(now) = estimate_at(&position.recorded_controls, snapshot.cursor)
        && let Some((column, row)) = view.cell(view.dot([now.x, now.y]))
    {
        put(buf, plane, column, row, 'r', strong());
    }
    let marked = marked(&view, position, snapshot.cursor);
    let letters = arrows
        .iter()
        .flat_map(|arrows| arrows.cells(&view, &marked));
    let taken: Vec<(u16, u16)> = letters.chain(marked.iter().copied()).collect();
    ghosts(buf, (plane, &taken), &view, snapshot, face);
    marks(buf, plane, &view, position, snapshot.cursor, face);
    if let Some(arrows) = &arrows {
        arrows.draw(buf, (plane, &marked), &view, face);
    }

    let cut = estimate_at(&position.belief, snapshot.cursor)
        .is_some_and(|now| view.cuts(&view.ellipse(&now, SIGMAS_OF_95_PERCENT)));
    let said = Said {
        arrows: arrows.as_ref().map(|arrows| arrows.factor),
        cut,
        ..longest
    };
    let entries = said.entries(snapshot, face);
    let entries = borrowed(&entries);
    let lines = legend_rows(&entries, inner.width);
    for (i, line) in lines.into_iter().take(usize::from(room)).enumerate() {
        legend(buf, inner, inner.height - room + i as u16, line);
    }
}

fn other_marks(
    buf: &mut Buffer,
    pane: Rect,
    view: &Plane,
    other: &PositionView,
    cursor: usize,
    face: &Face,
) {
    let ink = strong().patch(face.depth.ink(SECOND));
    for (path, symbol) in [(&other.prediction, '◇'), (&other.belief, '○')] {
        if let Some(now) = estimate_at(path, cursor)
            && let Some((column, row)) = view.cell(view.dot([now.x, now.y]))
        {
            put(buf, pane, column, row, symbol, ink);
        }
    }
}

/// What the legend has to explain besides paths and ellipses.
struct Said {
    /// Factor of the arrows, where there are some.
    arrows: Option<f32>,
    /// Samples of the fan, where it is drawn.
    samples: Option<usize>,
    /// Whether the ellipse at the cursor is wider than the plane.
    cut: bool,
}

impl Said {
    fn entries(&self, snapshot: &Snapshot, face: &Face) -> Vec<(String, Style, String)> {
        let prediction = face.depth.ink(PREDICTION);
        let second = face.depth.ink(SECOND);
        let mut entries = Vec::new();
        let mut entry = |glyph: &str, style: Style, name: String| {
            entries.push((glyph.to_owned(), style, name));
        };
        entry("╌×", dim(), "truth".to_owned());
        entry("─●", Style::new(), "belief".to_owned());
        let (predicted, _) = words::prediction(snapshot);
        entry("┈◆", prediction, predicted.to_owned());
        entry("+", Style::new(), "tip".to_owned());
        if let Some(factor) = self.arrows {
            let pulls = if factor > 1.0 {
                format!("pulls ×{factor}, sum Σ")
            } else {
                "pulls, sum ●".to_owned()
            };
            entry(&chain(snapshot), strong(), pulls);
            entry("(V)", dim(), "without V".to_owned());
        }
        if let Some(other) = &snapshot.other {
            let name = model_key(&snapshot.models, other.model);
            entry("╴·○", second, format!("{name} belief"));
            entry("· ◇", second, predicted.to_owned());
        }
        if snapshot.control_edit.is_some() {
            entry("· r", dim(), "recorded controls".to_owned());
        }
        if let Some(samples) = self.samples {
            entry("···", prediction, format!("of {samples} samples"));
        }
        let cut = if self.cut { ", wider than this" } else { "" };
        entry("○", Style::new(), format!("{}{cut}", masses()));
        entries
    }
}

/// The prior and the sensors as a chain: `D─V─H─P`.
fn chain(snapshot: &Snapshot) -> String {
    let experts = snapshot.experts.iter().map(|view| view.expert);
    let sensors = experts.filter(|&expert| expert != Expert::Prior);
    let mut chain = Expert::Prior.letter().to_string();
    for expert in sensors {
        chain.extend(['─', expert.letter()]);
    }
    chain
}

fn borrowed(entries: &[(String, Style, String)]) -> Vec<Entry<'_>> {
    entries
        .iter()
        .map(|(glyph, style, name)| (glyph.as_str(), *style, name.as_str()))
        .collect()
}
