//! The episodes a run trains on and is scored on.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::ProgressStyle;

use super::show;
use crate::data::Dataset;
use crate::episode::{Episode, EpisodeSource, Layout, Split};

/// Episodes to train on and for validation, all of one length, and why others were left out.
pub struct Sets {
    /// Fitted on.
    pub train: Vec<Episode>,
    /// Scored on.
    pub val: Vec<Episode>,
    /// Name and reason of each that was left out.
    pub left_out: Vec<(String, String)>,
}

impl Sets {
    /// Reads every episode that is not of the test split; the validation split is cut by `seed` where the dataset names
    /// none. None when stopped.
    pub fn load(dataset: &Dataset, layout: Layout, seed: u64, stop: &AtomicBool) -> Option<Self> {
        let mut sets = Self {
            train: Vec::new(),
            val: Vec::new(),
            left_out: Vec::new(),
        };
        let bar = show::bar();
        bar.set_length(dataset.metas().len() as u64);
        if let Ok(style) = ProgressStyle::with_template("reading {bar:30} {pos}/{len} episodes") {
            bar.set_style(style);
        }
        for (index, split) in dataset.splits(seed).into_iter().enumerate() {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            bar.inc(1);
            match (split, dataset.load(index, layout)) {
                (Split::Test, _) => {}
                (_, Err(error)) => sets
                    .left_out
                    .push((dataset.metas()[index].id.clone(), error.to_string())),
                (Split::Val, Ok(episode)) => sets.val.push(episode),
                (Split::Train, Ok(episode)) => sets.train.push(episode),
            }
        }
        bar.finish_and_clear();
        sets.leave_out_odd_ones();
        Some(sets)
    }

    /// An odd recording would teach the oddity, and one of another length does not fit a batch.
    fn leave_out_odd_ones(&mut self) {
        let mut lengths = BTreeMap::new();
        for episode in &self.train {
            *lengths.entry(episode.steps()).or_insert(0_usize) += 1;
        }
        let Some(usual) = lengths
            .into_iter()
            .max_by_key(|&(_, count)| count)
            .map(|(length, _)| length)
        else {
            return;
        };
        let left_out = &mut self.left_out;
        for set in [&mut self.train, &mut self.val] {
            set.retain(|episode| {
                let reason = match episode.flags.first() {
                    Some(flag) => format!("{}: {}", flag.topic, flag.what),
                    None if episode.steps() != usual => {
                        format!("{} images where most have {usual}", episode.steps())
                    }
                    None => return true,
                };
                left_out.push((episode.meta.id.clone(), reason));
                false
            });
        }
    }
}

impl fmt::Display for Sets {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "{} episodes to train on, {} for validation",
            self.train.len(),
            self.val.len()
        )?;
        if !self.left_out.is_empty() {
            write!(f, ", {} left out", self.left_out.len())?;
        }
        for (id, reason) in self.left_out.iter().take(3) {
            write!(f, "\n  {id}: {reason}")?;
        }
        Ok(())
    }
}
