//! PSNR of the belief's and the prediction's frames over the horizon, of both models where there are two.
//!
//! ```text
//! PSNR dB ──────── A v-h-p  B vhp
//! 30│●━━━━━━━━━━━━
//! 25│   ┈┈┈┈◆┈┈┈┈┈
//!   └+1   +5   +11
//! ─ belief 29.1  ┈ prediction 24.2
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::super::braille::Stroke;
use super::super::face::Face;
use super::super::paint::{below_title, text, title};
use super::super::plot::Plot;
use super::super::scale::Scale;
use super::super::theme::{OTHER, PREDICTION, dim, strong};
use super::super::view::Pane;
use super::super::words::{Entry, legend, legend_rows};
use super::{ahead, cursor_ahead, labels};
use crate::session::snapshot::{Snapshot, StepPsnr};

/// One line of the plot.
struct Line<'a> {
    name: &'static str,
    glyph: &'static str,
    mark: char,
    stroke: Stroke,
    style: Style,
    of: &'a [StepPsnr],
    value: fn(&StepPsnr) -> Option<f32>,
}

impl Line<'_> {
    fn at(&self, step: usize) -> f32 {
        self.of.get(step).and_then(self.value).unwrap_or(f32::NAN)
    }
}

/// Draws the plot with its legend.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Quality);
    if pane.is_empty() {
        return;
    }
    let lines = lines(snapshot, face);
    let names: Vec<String> = snapshot
        .other
        .iter()
        .flat_map(|other| [("A", snapshot.model), ("B", other.model)])
        .filter_map(|(letter, model)| Some(format!("{letter} {}", snapshot.models.get(model)?.name)))
        .collect();
    title(buf, pane, "PSNR dB", &names.join("  "), focused);
    let inner = below_title(pane);

    let now: Vec<String> = lines
        .iter()
        .map(|line| match line.at(snapshot.cursor) {
            db if db.is_finite() => format!("{} {db:.1}", line.name),
            _ => line.name.to_owned(),
        })
        .collect();
    let entries: Vec<Entry> = std::iter::zip(&lines, &now)
        .map(|(line, now)| (line.glyph, line.style, now.as_str()))
        .collect();
    let rows = legend_rows(&entries, inner.width);
    let shown = (rows.len() as u16).min(inner.height / 3);
    let plot_pane = Rect {
        height: inner.height.saturating_sub(shown),
        ..inner
    };
    for (i, row) in rows.into_iter().take(usize::from(shown)).enumerate() {
        legend(buf, inner, plot_pane.height + i as u16, row);
    }

    let steps: Vec<(usize, usize)> = ahead(snapshot).collect();
    let last = steps.last().map_or(0, |&(h, _)| h);
    let values = lines
        .iter()
        .flat_map(|line| steps.iter().map(|&(_, step)| line.at(step)));
    let Some(y) = Scale::around(values) else {
        let why = if snapshot.busy { "computing…" } else { "nothing was predicted yet" };
        text(buf, inner, 0, 0, why, dim());
        return;
    };
    let Some(mut plot) = Plot::new(plot_pane, Scale::linear(0.0, last as f32), y) else {
        return;
    };
    if let Some(now) = cursor_ahead(snapshot) {
        plot.upright(now as f32, dim());
    }
    for line in &lines {
        let points: Vec<(f32, f32)> = steps.iter().map(|&(h, step)| (h as f32, line.at(step))).collect();
        plot.line(&points, line.stroke, line.style);
    }
    if let Some(now) = cursor_ahead(snapshot) {
        for line in &lines {
            plot.mark((now as f32, line.at(snapshot.cursor)), line.mark, strong().patch(line.style));
        }
    }
    plot.draw(buf, &labels(last));
}

/// The strokes are those of the position plane.
fn lines<'a>(snapshot: &'a Snapshot, face: &Face) -> Vec<Line<'a>> {
    let prediction = face.depth.ink(PREDICTION);
    let other = face.depth.ink(OTHER);
    let line = |name, (glyph, mark), stroke, style, of, value| Line {
        name,
        glyph,
        mark,
        stroke,
        style,
        of,
        value,
    };
    let belief: fn(&StepPsnr) -> Option<f32> = |psnr| psnr.belief;
    let predicted: fn(&StepPsnr) -> Option<f32> = |psnr| psnr.prediction;
    let own = &snapshot.psnr_db[..];
    let mut lines = vec![
        line("belief", ("─", '●'), Stroke::Solid, Style::new(), own, belief),
        line("prediction", ("┈", '◆'), Stroke::Dotted, prediction, own, predicted),
    ];
    if let Some(b) = &snapshot.other {
        let of = &b.psnr_db[..];
        lines.push(line("B belief", ("╴·", '○'), Stroke::DashDot, other, of, belief));
        lines.push(line("B prediction", ("· ·", '◇'), Stroke::Sparse, other, of, predicted));
    }
    lines
}
