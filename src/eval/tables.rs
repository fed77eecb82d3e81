//! Every number as rows: one a frame and model, one a regressor, one a comparison, and so on.

mod column;
mod findings;
mod images;
mod poses;
mod sensors;

use self::column::Placed;
use super::score::{Contest, EpisodeScores};
use super::summary::Summary;
use super::table::Table;

/// All tables of episodes with their places in the dataset.
pub fn tables(
    contest: &Contest,
    all: &[EpisodeScores],
    places: &[usize],
    summary: &Summary,
) -> Vec<Table> {
    let placed: Vec<Placed<'_>> = places.iter().copied().zip(all).collect();
    vec![
        images::models(summary),
        images::frames(contest, &placed),
        images::horizons(summary),
        findings::seeds(summary),
        findings::comparisons(summary),
        poses::regression(summary),
        sensors::shapley(contest, &placed),
        sensors::contact(summary),
    ]
}
