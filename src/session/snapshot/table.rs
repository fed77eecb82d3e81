//! The episodes as a table, and the worst of them as a queue.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::episode::Split;
use crate::measure::failure::{Order, Scores};

/// A column to sort by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Column {
    /// As recorded.
    #[default]
    Index,
    /// By name.
    Id,
    /// By number of steps.
    Steps,
    /// By squared error of the predicted frames.
    Rmse,
    /// By distance of the predicted position.
    Distance,
    /// By how far the model is ahead of `v`.
    Gain,
    /// By NEES.
    Nees,
    /// By conflict energy.
    Conflict,
    /// By flags.
    Flags,
}

impl Column {
    /// All columns, in the order of the table.
    pub const ALL: [Self; 9] = [
        Self::Index,
        Self::Id,
        Self::Steps,
        Self::Rmse,
        Self::Distance,
        Self::Gain,
        Self::Nees,
        Self::Conflict,
        Self::Flags,
    ];

    /// What it is called after `:sort`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Index => "index",
            Self::Id => "id",
            Self::Steps => "steps",
            Self::Rmse => "rmse",
            Self::Distance => "distance",
            Self::Gain => "gain",
            Self::Nees => "nees",
            Self::Conflict => "conflict",
            Self::Flags => "flags",
        }
    }
}

/// Every episode of the dataset.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TableView {
    /// One an episode, in the dataset's order.
    pub rows: Arc<Vec<EpisodeRow>>,
    /// The rows that the filter lets through, sorted: indices of `rows`.
    pub shown: Arc<Vec<usize>>,
    /// Episodes scored so far.
    pub scored: usize,
    /// Whether scoring has been asked for.
    pub asked: bool,
    /// What it is sorted by.
    pub sort: Column,
    /// Whether the largest come first.
    pub descending: bool,
    /// Part of the names that are shown; empty for all.
    pub filter: String,
    /// What makes a failure.
    pub order: Order,
    /// Episode and its worst step, the worst episode first.
    pub queue: Arc<Vec<Failure>>,
    /// The place in the queue that was last gone to.
    pub place: Option<usize>,
}

impl TableView {
    /// Why the first of the episodes that could not be scored was not, with its name.
    pub fn first_fault(&self) -> Option<String> {
        self.rows.iter().find_map(|row| {
            let fault = row.score.as_ref()?.fault.as_ref()?;
            Some(format!("{} {fault}", row.id))
        })
    }
}

/// One episode of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EpisodeRow {
    /// Its name.
    pub id: String,
    /// Its part in the experiment.
    pub split: Option<Split>,
    /// What the model makes of it, every expert as trained; none until scored.
    pub score: Option<Arc<EpisodeScore>>,
}

/// What a model makes of an episode: filtered with every expert as trained, and predicted by the default protocol.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EpisodeScore {
    /// T.
    pub steps: usize,
    /// Over the episode: squared error of the predicted frames, summed over pixels, distance of the predicted position,
    /// NEES and conflict of the filtered belief, each a mean over its steps; gain over `v`.
    pub scores: Scores,
    /// The same at each step; the frame's error is of the prediction within the horizon, else of the belief.
    pub by_step: Vec<Scores>,
    /// What was odd about the recording.
    pub flags: usize,
    /// Why it could not be scored.
    pub fault: Option<String>,
}

/// A moment worth a look.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Failure {
    /// Index of the episode.
    pub episode: usize,
    /// Step, from 0.
    pub step: usize,
    /// What it is ranked by.
    pub value: f32,
}
