//! Columns, collected from whatever the rows are.

use crate::eval::score::EpisodeScores;
use crate::eval::table::{Cells, Column};

/// An episode and its place in the dataset.
pub(super) type Placed<'a> = (usize, &'a EpisodeScores);

/// Words.
pub(super) fn text<T>(
    name: &'static str,
    about: &'static str,
    rows: &[T],
    of: impl Fn(&T) -> String,
) -> Column {
    let cells = Cells::Text(rows.iter().map(of).collect());
    Column { name, about, cells }
}

/// Whole numbers.
pub(super) fn whole<T, N: Into<Option<i64>>>(
    name: &'static str,
    about: &'static str,
    rows: &[T],
    of: impl Fn(&T) -> N,
) -> Column {
    let cells = Cells::Whole(rows.iter().map(|row| of(row).into()).collect());
    Column { name, about, cells }
}

/// Numbers, those that are finite.
pub(super) fn number<T>(
    name: &'static str,
    about: &'static str,
    rows: &[T],
    of: impl Fn(&T) -> Option<f64>,
) -> Column {
    let finite = |row| of(row).filter(|number| number.is_finite());
    let cells = Cells::Number(rows.iter().map(finite).collect());
    Column { name, about, cells }
}

/// The place of a row's episode.
pub(super) fn place<'a, T>(rows: &[T], of: impl Fn(&T) -> Placed<'a>) -> [Column; 2] {
    [
        whole("index", "the episode's place in the dataset", rows, |r| {
            of(r).0 as i64
        }),
        text("episode", "its name", rows, |r| of(r).1.episode.clone()),
    ]
}
