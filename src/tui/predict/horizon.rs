//! PSNR of the belief's and the prediction's frames over the horizon, of both models where there are two.
//!
//! ```text
//! PSNR dB ──────────── ●29.1 ◆24.2
//! 30│●━━━━━━━━━━━━
//! 25│   ┈┈┈┈◆┈┈┈┈┈
//!   └+1   +5   +11
//! ─● belief  ┈◆ prediction
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::super::braille::Stroke;
use super::super::face::Face;
use super::super::paint::{below_title, text, title, width};
use super::super::plot::Plot;
use super::super::scale::Scale;
use super::super::theme::{PREDICTION, SECOND, dim, strong};
use super::super::view::Pane;
use super::super::words::{self, Entry, legend_below};
use super::{ahead, cursor_ahead, labels};
use crate::session::model_key;
use crate::session::snapshot::{Snapshot, StepPsnr};

/// One line of the plot.
struct Line<'a> {
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
    let now: Vec<String> = lines
        .iter()
        .filter(|line| line.at(snapshot.cursor).is_finite())
        .map(|line| format!("{}{:.1}", line.mark, line.at(snapshot.cursor)))
        .collect();
    // Where not all values fit, those of the first model do.
    let note = now.join(" ");
    let fits = width(&note) + 10 <= pane.width;
    let note = if fits {
        note
    } else {
        now[..now.len().min(2)].join(" ")
    };
    title(buf, pane, "PSNR dB", &note, focused);
    let inner = below_title(pane);
    let names = names(snapshot, pane.width);
    let entries: Vec<Entry> = std::iter::zip(&lines, &names)
        .map(|(line, name)| (line.glyph, line.style, name.as_str()))
        .collect();
    let plot_pane = legend_below(buf, inner, &entries);

    let steps: Vec<(usize, usize)> = ahead(snapshot).collect();
    let last = steps.last().map_or(0, |&(h, _)| h);
    let values = lines
        .iter()
        .flat_map(|line| steps.iter().map(|&(_, step)| line.at(step)));
    let Some(y) = Scale::around(values) else {
        let why = if snapshot.busy {
            "computing…"
        } else {
            "nothing was predicted yet"
        };
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
        let points: Vec<(f32, f32)> = steps
            .iter()
            .map(|&(h, step)| (h as f32, line.at(step)))
            .collect();
        plot.line(&points, line.stroke, line.style);
    }
    if let Some(now) = cursor_ahead(snapshot) {
        for line in &lines {
            plot.mark(
                (now as f32, line.at(snapshot.cursor)),
                line.mark,
                strong().patch(line.style),
            );
        }
    }
    plot.draw(buf, &labels(last));
}

/// What the lines are called, in their order.
fn names(snapshot: &Snapshot, columns: u16) -> Vec<String> {
    let (full, short) = words::prediction(snapshot);
    let prediction = if columns < 26 { short } else { full };
    let mut names = vec!["belief".to_owned(), prediction.to_owned()];
    if let Some(other) = &snapshot.other {
        let model = model_key(&snapshot.models, other.model);
        names.extend([format!("{model} belief"), prediction.to_owned()]);
    }
    names
}

/// The strokes are those of the position plane.
fn lines<'a>(snapshot: &'a Snapshot, face: &Face) -> Vec<Line<'a>> {
    let prediction = face.depth.ink(PREDICTION);
    let other = face.depth.ink(SECOND);
    let line = |(glyph, mark), stroke, style, of, value| Line {
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
        line(("─●", '●'), Stroke::Solid, Style::new(), own, belief),
        line(("┈◆", '◆'), Stroke::Dotted, prediction, own, predicted),
    ];
    if let Some(b) = &snapshot.other {
        let of = &b.psnr_db[..];
        lines.push(line(("╴·○", '○'), Stroke::DashDot, other, of, belief));
        lines.push(line(("· ◇", '◇'), Stroke::Sparse, other, of, predicted));
    }
    lines
}
