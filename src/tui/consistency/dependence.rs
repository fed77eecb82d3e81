//! Whether experts err alike, what that does to confidence (D14), and the α that would fit (D15).
//!
//! ```text
//! experts ────────────── ρ of errors, fitted α
//!         V     H     P   fit α
//! V       1  0.41  0.35    0.71  oversure
//! H             1  0.77    0.33  oversure
//! P                   1    1.12
//! 3 experts count as 1.5: …
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::super::face::Face;
use super::super::paint::{below_title, right, text, title, width};
use super::super::theme::{dim, strong};
use super::super::view::Pane;
use super::super::words::sentence;
use super::board;
use crate::modality::Expert;
use crate::session::snapshot::Snapshot;
use crate::session::snapshot::board::BoardView;

/// Columns of a number of the matrix.
const CELL: u16 = 6;

/// Draws matrix, readings and what they mean.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Dependence);
    let Ok(board) = board(snapshot) else { return };
    if pane.is_empty() {
        return;
    }
    title(buf, pane, "experts", "ρ of errors, fitted α", focused);
    let inner = below_title(pane);
    let sensors = sensors(board);
    if sensors.is_empty() {
        text(
            buf,
            inner,
            0,
            0,
            "no product of experts, or too few episodes",
            dim(),
        );
        return;
    }
    let ink = |expert: Expert| strong().patch(face.depth.ink(expert.rgb()));
    let letter = |expert: Expert| expert.letter().to_string();
    let end = |column: usize| 2 + (column as u16 + 1) * CELL;
    let fitted = end(sensors.len()) + 1;
    for (column, &expert) in sensors.iter().enumerate() {
        right(buf, inner, end(column), 0, &letter(expert), ink(expert));
    }
    if !board.alphas.is_empty() {
        right(buf, inner, fitted, 0, "fit α", dim());
    }
    for (row, &expert) in sensors.iter().enumerate() {
        let at = 1 + row as u16;
        text(buf, inner, 0, at, &letter(expert), ink(expert));
        for column in row..sensors.len() {
            let (value, style) = match rho(board, row, column) {
                Some(rho) => (format!("{rho:.2}"), Style::new()),
                None if row == column => ("1".to_owned(), dim()),
                None => ("–".to_owned(), dim()),
            };
            right(buf, inner, end(column), at, &value, style);
        }
        if let Some((_, alpha)) = board.alphas.iter().find(|(of, _)| *of == expert) {
            right(
                buf,
                inner,
                fitted,
                at,
                &format!("{:.2}", alpha.alpha),
                Style::new(),
            );
            let [short, long] = reading(alpha.alpha);
            let fits = fitted + 2 + width(long) <= inner.width;
            text(
                buf,
                inner,
                fitted + 2,
                at,
                if fits { long } else { short },
                dim(),
            );
        }
    }
    let mut row = 1 + sensors.len() as u16;
    if let Some(dependence) = &board.dependence {
        row = sentence(buf, inner, row, &dependence.sentence, Style::new());
    }
    if !board.alphas.is_empty() {
        let from = format!(
            "α fitted on {}: a reading, the model stays as it is",
            board.alphas_from
        );
        sentence(buf, inner, row, &from, dim());
    }
}

/// The experts that have a reading of either kind, in the order of the model.
fn sensors(board: &BoardView) -> Vec<Expert> {
    if board.experts.is_empty() {
        board.alphas.iter().map(|&(expert, _)| expert).collect()
    } else {
        board.experts.clone()
    }
}

fn rho(board: &BoardView, a: usize, b: usize) -> Option<f64> {
    let pairs = &board.dependence.as_ref()?.pairs;
    let same = |(x, y): (usize, usize)| (x, y) == (a, b) || (x, y) == (b, a);
    pairs
        .iter()
        .find(|pair| same((pair.a, pair.b)))
        .map(|pair| pair.rho)
}

/// What a fitted α says of an expert as trained, short and long.
fn reading(alpha: f64) -> [&'static str; 2] {
    match alpha {
        alpha if alpha < 0.9 => ["oversure", "oversure as trained"],
        alpha if alpha > 1.1 => ["too timid", "too timid as trained"],
        _ => ["fair", "as sure as it should be"],
    }
}
