//! What is kept of a survey from one run of the program to the next.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::session::known::Known;
use crate::session::snapshot::ModelInfo;
use crate::session::snapshot::table::EpisodeScore;

/// Written with every entry; another one is not read.
const VERSION: u32 = 1;

/// A place for results that can be made again; what goes wrong with it is nobody's business.
pub trait Cache: Send + Sync {
    /// The bytes of a key, if there are any.
    fn load(&self, key: &str) -> Option<Vec<u8>>;
    /// Keeps bytes under a key.
    fn store(&self, key: &str, bytes: &[u8]);
}

/// One an episode.
pub type ScoreList = Vec<Option<Arc<EpisodeScore>>>;

#[derive(Serialize)]
struct Written<'a> {
    version: u32,
    scores: ScoreList,
    known: Option<&'a Known>,
}

#[derive(Deserialize)]
struct Kept {
    version: u32,
    scores: ScoreList,
    known: Option<Known>,
}

/// Model and data; empty for a model without a hash, which is not kept.
pub fn key(model: &ModelInfo, data_hash: &str) -> String {
    if model.hash.is_empty() {
        return String::new();
    }
    format!("survey-{}-{data_hash}.json", model.hash)
}

/// Scores of `count` episodes and what is known; none where there is nothing of use.
pub fn load(cache: &dyn Cache, key: &str, count: usize) -> Option<(ScoreList, Option<Known>)> {
    if key.is_empty() {
        return None;
    }
    let kept: Kept = serde_json::from_slice(&cache.load(key)?).ok()?;
    let fits = kept.version == VERSION && kept.scores.len() == count;
    fits.then_some((kept.scores, kept.known))
}

/// Keeps them.
pub fn store(
    cache: &dyn Cache,
    key: &str,
    scores: &[Option<Arc<EpisodeScore>>],
    known: Option<&Known>,
) {
    if key.is_empty() {
        return;
    }
    // What went wrong once may go right the next time.
    let sound =
        |score: &Option<Arc<EpisodeScore>>| score.clone().filter(|score| score.fault.is_none());
    let written = Written {
        version: VERSION,
        scores: scores.iter().map(sound).collect(),
        known,
    };
    if let Ok(bytes) = serde_json::to_vec(&written) {
        cache.store(key, &bytes);
    }
}
