//! The table of episodes: which are listed, in which order, and which are the worst.

use std::cmp::Ordering;
use std::sync::Arc;

use super::snapshot::table::{Column, EpisodeRow, EpisodeScore, Failure, TableView};
use crate::episode::{EpisodeMeta, Split};
use crate::measure::failure::{Order, Scores, queue};

/// What the table is made of; [`Table::view`] is what faces see.
#[derive(Debug, Default)]
pub struct Table {
    view: Arc<TableView>,
}

impl Table {
    /// Of a dataset whose episodes are not scored yet.
    pub fn new(metas: &[EpisodeMeta]) -> Self {
        let rows = metas.iter().map(|meta| EpisodeRow {
            id: meta.id.clone(),
            split: meta.split,
            score: None,
        });
        let mut table = Self::default();
        table.edit(|view| view.rows = Arc::new(rows.collect()));
        table
    }

    /// What faces see.
    pub fn view(&self) -> &Arc<TableView> {
        &self.view
    }

    /// Takes scores over; those of another model take the place of all earlier ones.
    pub fn take(&mut self, scores: &[Option<Arc<EpisodeScore>>]) {
        self.edit(|view| {
            let rows = view
                .rows
                .iter()
                .zip(scores.iter().chain(std::iter::repeat(&None)));
            let rows = rows.map(|(row, score)| EpisodeRow {
                score: score.clone(),
                ..row.clone()
            });
            view.rows = Arc::new(rows.collect());
        });
    }

    /// Scoring has been asked for.
    pub fn ask(&mut self) {
        Arc::make_mut(&mut self.view).asked = true;
    }

    /// Sorts by a column: the smallest first, and the other way round when asked again.
    pub fn sort_by(&mut self, column: Column) {
        let view = Arc::make_mut(&mut self.view);
        view.descending = view.sort == column && !view.descending;
        view.sort = column;
        view.shown = Arc::new(shown(view));
    }

    /// Lists only episodes whose name or split contains this.
    pub fn filter(&mut self, text: String) {
        let view = Arc::make_mut(&mut self.view);
        view.filter = text;
        view.shown = Arc::new(shown(view));
    }

    /// Ranks failures by this; the queue begins anew.
    pub fn rank_by(&mut self, order: Order) {
        self.edit(|view| {
            view.order = order;
            view.place = None;
        });
    }

    /// Goes so many places on in the queue, from the worst on; the failure there, and whether it is another one.
    pub fn step(&mut self, by: i64) -> Option<(Failure, bool)> {
        let last = self.view.queue.len().checked_sub(1)?;
        let place = match self.view.place {
            None => 0,
            Some(place) => {
                let by =
                    isize::try_from(by).unwrap_or(if by < 0 { isize::MIN } else { isize::MAX });
                place.saturating_add_signed(by).min(last)
            }
        };
        let moved = self.view.place != Some(place);
        Arc::make_mut(&mut self.view).place = Some(place);
        Some((self.view.queue[place], moved))
    }

    fn edit(&mut self, change: impl FnOnce(&mut TableView)) {
        let view = Arc::make_mut(&mut self.view);
        let gone_to = view.place.and_then(|place| view.queue.get(place).copied());
        change(view);
        view.scored = view.rows.iter().filter(|row| row.score.is_some()).count();
        view.shown = Arc::new(shown(view));
        view.queue = Arc::new(failures(view));
        // Where more has been scored, the failure that was gone to has another place.
        let is_it =
            |at: &Failure| gone_to.is_some_and(|f| (f.episode, f.step) == (at.episode, at.step));
        view.place = view.place.and_then(|_| view.queue.iter().position(is_it));
    }
}

fn shown(view: &TableView) -> Vec<usize> {
    let wanted = view.filter.to_lowercase();
    let matches = |row: &EpisodeRow| {
        let split = row.split.map_or("", Split::name);
        row.id.to_lowercase().contains(&wanted) || split.contains(&wanted)
    };
    let mut shown: Vec<usize> = (0..view.rows.len())
        .filter(|&i| matches(&view.rows[i]))
        .collect();
    shown.sort_by(|&a, &b| {
        let (a, b) = (&view.rows[a], &view.rows[b]);
        let order = compare(view.sort, a, b);
        // What has no value stands last, whichever way it is sorted.
        match (value(view.sort, a), value(view.sort, b)) {
            (None, Some(_)) | (Some(_), None) => order,
            _ if view.descending => order.reverse(),
            _ => order,
        }
    });
    if view.sort == Column::Index && view.descending {
        shown.reverse();
    }
    shown
}

fn compare(column: Column, a: &EpisodeRow, b: &EpisodeRow) -> Ordering {
    if column == Column::Id {
        return a.id.cmp(&b.id);
    }
    match (value(column, a), value(column, b)) {
        (Some(a), Some(b)) => a.total_cmp(&b),
        (Some(_), None) => Ordering::Less,
        (None, Some(_)) => Ordering::Greater,
        (None, None) => Ordering::Equal,
    }
}

fn value(column: Column, row: &EpisodeRow) -> Option<f32> {
    let score = row.score.as_ref()?;
    let Scores {
        error,
        distance_m,
        nees,
        conflict,
        gain,
        ..
    } = score.scores;
    match column {
        Column::Index | Column::Id => None,
        Column::Steps => Some(score.steps as f32),
        Column::Rmse => error,
        Column::Distance => distance_m,
        Column::Gain => gain,
        Column::Nees => nees,
        Column::Conflict => conflict,
        Column::Flags => Some(score.flags as f32),
    }
}

fn failures(view: &TableView) -> Vec<Failure> {
    let scored = view.rows.iter().enumerate();
    let scored = scored.filter_map(|(episode, row)| {
        let score = row.score.as_ref()?;
        Some((episode, score.by_step.as_slice()))
    });
    queue(scored, view.order)
        .into_iter()
        .filter_map(|(episode, step)| {
            let scores = view.rows[episode].score.as_ref()?.by_step.get(step)?;
            Some(Failure {
                episode,
                step,
                value: scores.value(view.order)?,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let meta = |id: &str| EpisodeMeta {
            id: id.to_owned(),
            split: Some(Split::Test),
            ..EpisodeMeta::default()
        };
        let mut table = Table::new(&["b", "a", "c", "d"].map(meta));
        let score = |errors: [f32; 2]| {
            let at = |error: f32| Scores {
                error: Some(error),
                ..Scores::default()
            };
            Some(Arc::new(EpisodeScore {
                steps: 2,
                scores: at(errors[0] + errors[1]),
                by_step: errors.map(at).to_vec(),
                ..EpisodeScore::default()
            }))
        };
        table.take(&[
            score([1.0, 5.0]),
            score([9.0, 2.0]),
            None,
            score([3.0, 3.0]),
        ]);
        table
    }

    #[test]
    fn sorts_both_ways_with_what_is_unknown_last() {
        let mut table = table();
        assert_eq!(table.view().scored, 3);
        assert_eq!(*table.view().shown, [0, 1, 2, 3]);
        table.sort_by(Column::Rmse);
        assert_eq!(*table.view().shown, [0, 3, 1, 2]);
        table.sort_by(Column::Rmse);
        assert_eq!(*table.view().shown, [1, 0, 3, 2]);
        table.sort_by(Column::Id);
        assert_eq!(*table.view().shown, [1, 0, 2, 3]);
        table.filter("TEST".to_owned());
        assert_eq!(table.view().shown.len(), 4);
        table.filter("tes".to_owned());
        assert_eq!(table.view().shown.len(), 4);
        table.filter("c".to_owned());
        assert_eq!(*table.view().shown, [2]);
    }

    #[test]
    fn the_queue_goes_from_the_worst_on_and_stops_at_its_ends() {
        let mut table = table();
        let at =
            |table: &mut Table, by| table.step(by).map(|(f, moved)| (f.episode, f.step, moved));
        assert_eq!(at(&mut table, 1), Some((1, 0, true)));
        assert_eq!(at(&mut table, 1), Some((0, 1, true)));
        assert_eq!(at(&mut table, -7), Some((1, 0, true)));
        assert_eq!(at(&mut table, i64::MAX), Some((3, 0, true)));
        assert_eq!(at(&mut table, 1), Some((3, 0, false)));
        table.rank_by(Order::Gain);
        assert_eq!(table.step(1), None);
    }
}
