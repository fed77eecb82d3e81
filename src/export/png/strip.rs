//! An episode as a figure: truth above, below it each model's frames and their errors, with labels.

use super::Figure;
use super::canvas::{BLACK, Canvas, LETTER, WHITE};
use super::rows::{GAP, Grid, Shows};
use crate::export::{Run, color};

/// White around a figure, and between a label and what it is of.
const MARGIN: usize = 8;
/// From one line of letters to the next.
const LINE: usize = LETTER + 4;

/// None where it would be too large.
pub(super) fn strip(run: &Run, figure: Figure) -> Option<Canvas> {
    let grid = Grid::new(run, figure);
    let names: Vec<&str> = run.provenance.models.iter().map(|m| &*m.name).collect();
    let mut rows = vec![("truth".to_owned(), Shows::Truth)];
    for (model, name) in names.iter().enumerate() {
        let label = match names.len() {
            1 => "model".to_owned(),
            _ => (*name).to_owned(),
        };
        rows.push((label, Shows::Model(model)));
        rows.push(("error".to_owned(), Shows::Error(model)));
    }
    let longest = rows.iter().map(|(label, _)| label.chars().count()).max();
    let left = MARGIN + longest.unwrap_or(0) * LETTER + MARGIN;
    let title = title(run, &names);
    let width = (left + grid.width() + MARGIN).max(MARGIN * 2 + title.chars().count() * LETTER);
    let top = MARGIN + 3 * LINE;
    let height = top + rows.len() * (grid.cell + GAP) + MARGIN;
    let mut canvas = Canvas::within_limit(width, height)?;
    canvas.text([MARGIN, MARGIN], &title, BLACK);
    head(&grid, &mut canvas, left);
    for (row, (label, shows)) in rows.iter().enumerate() {
        let y = top + row * (grid.cell + GAP);
        let middle = y + grid.cell.saturating_sub(LETTER) / 2;
        canvas.text([MARGIN, middle], label, BLACK);
        grid.draw(&mut canvas, [left, y], *shows);
    }
    let bottom = canvas.height() - MARGIN - GAP;
    grid.bar(&mut canvas, [left, top - LINE], bottom);
    Some(canvas)
}

/// Above the columns: what the model's frames are, and the steps counted from 1.
fn head(grid: &Grid<'_>, canvas: &mut Canvas, left: usize) {
    let (words, numbers) = (MARGIN + LINE, MARGIN + 2 * LINE);
    let predicted = grid.first_predicted();
    if predicted != Some(0) {
        canvas.text([left, words], "belief", BLACK);
    }
    if let Some(column) = predicted {
        let x = left + grid.column(column);
        // Where the context is too narrow for its own word, that gives way.
        canvas.fill([x, words], [canvas.width(), LETTER], WHITE);
        canvas.text([x, words], "prediction", BLACK);
    }
    for (column, step) in grid.steps.iter().enumerate() {
        let number = (step + 1).to_string();
        let room = grid.cell.saturating_sub(number.len() * LETTER) / 2;
        canvas.text([left + grid.column(column) + room, numbers], &number, BLACK);
    }
}

/// The episode, the models, and what is not as trained and recorded.
fn title(run: &Run, names: &[&str]) -> String {
    let meta = &run.episode.meta;
    let mut words = vec![meta.id.clone()];
    words.extend(meta.split.map(|split| split.name().to_owned()));
    words.push(names.join(", "));
    let unusual = ["alpha=", "corrupt=", "controls=", "sample="];
    let parts = run.provenance.state.split(';');
    let parts = parts.filter(|part| unusual.iter().any(|key| part.starts_with(key)));
    words.extend(parts.map(str::to_owned));
    words.join("  ")
}

/// What the colours of errors mean.
pub(super) fn legend() -> Canvas {
    let (low, high) = (
        "error: -0.5 ",
        " +0.5 of the grey range, too dark to too bright",
    );
    let bar = 128;
    let text = |text: &str| text.len() * LETTER;
    let mut canvas = Canvas::new(
        2 * MARGIN + text(low) + bar + text(high),
        2 * MARGIN + LETTER,
    );
    canvas.text([MARGIN, MARGIN], low, BLACK);
    let left = MARGIN + text(low);
    for x in 0..bar {
        // The middle of the bar is no error, its ends are the range's.
        let part = 2.0 * x as f32 / (bar - 1) as f32 - 1.0;
        let error = (part * color::ERROR_RANGE).round() as i16;
        canvas.fill([left + x, MARGIN], [1, LETTER], color::signed(error));
    }
    canvas.text([left + bar, MARGIN], high, BLACK);
    canvas
}
