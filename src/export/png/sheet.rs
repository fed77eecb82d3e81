//! An episode as rows of a contact sheet: truth, and below it each model's frames.

use super::Figure;
use super::canvas::{BLACK, Canvas, LETTER};
use super::rows::{GAP, Grid, Shows};
use crate::export::Run;

/// Letters of an episode's name at most; its end is what tells it from others.
const NAME: usize = 16;
/// White around labels, and between episodes.
const MARGIN: usize = 4;

/// `first` is the one at the top, which has the numbers of the steps above it. None where it would be too large.
pub(super) fn sheet(run: &Run, figure: Figure, first: bool) -> Option<Canvas> {
    let grid = Grid::new(run, figure);
    let left = MARGIN + NAME * LETTER + MARGIN;
    let top = if first { MARGIN + LETTER + MARGIN } else { 0 };
    let models = run.models.len();
    let height = top + (1 + models) * (grid.cell + GAP) + MARGIN;
    let mut canvas = Canvas::within_limit(left + grid.width() + MARGIN, height)?;
    if first {
        for (column, step) in grid.steps.iter().enumerate() {
            let number = (step + 1).to_string();
            let room = grid.cell.saturating_sub(number.len() * LETTER) / 2;
            canvas.text([left + grid.column(column) + room, MARGIN], &number, BLACK);
        }
    }
    let shown = std::iter::once(Shows::Truth).chain((0..models).map(Shows::Model));
    for (row, shows) in shown.enumerate() {
        let y = top + row * (grid.cell + GAP);
        let label = match shows {
            Shows::Model(model) => &run.provenance.models[model].name,
            _ => &run.episode.meta.id,
        };
        canvas.text([MARGIN, y + MARGIN], end_of(label), BLACK);
        grid.draw(&mut canvas, [left, y], shows);
    }
    grid.bar(&mut canvas, [left, top], height - MARGIN - GAP);
    Some(canvas)
}

fn end_of(name: &str) -> &str {
    let skipped = name.chars().count().saturating_sub(NAME);
    let start = name.char_indices().nth(skipped).map_or(0, |(at, _)| at);
    &name[start..]
}

#[cfg(test)]
mod tests {
    use super::end_of;

    #[test]
    fn of_a_long_name_the_end_is_shown() {
        assert_eq!(end_of("ep00007"), "ep00007");
        assert_eq!(
            end_of("recordings/ünder/ep00007"),
            "ngs/ünder/ep00007".split_at(1).1
        );
        assert_eq!(end_of(""), "");
    }
}
