//! The episodes a run trains on and is scored on.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::bail;

use crate::command::progress_bar;
use crate::data::{Dataset, Episodes, Store};
use crate::episode::{EpisodeSource, Split};
use crate::model::config::Config;
use crate::model::observation::missing;

/// Episodes to train on and for validation, all of one length, and why others were left out.
pub struct Sets {
    store: Store,
    train: Vec<usize>,
    val: Vec<usize>,
    /// Name and reason of each that was left out.
    pub left_out: Vec<(String, String)>,
}

impl Sets {
    /// Reads every episode that is not of the test split; the validation split is cut by `seed` where the dataset names
    /// none. What is beyond `memory` bytes is set aside in `folder`. An odd recording would teach the oddity, one that
    /// lacks what the model sees teaches it nothing, and one of another length does not fit a batch: they are left out.
    pub fn load(
        dataset: &Dataset,
        config: &Config,
        seed: u64,
        memory: u64,
        folder: &Path,
        stop: &AtomicBool,
    ) -> anyhow::Result<Self> {
        let mut sets = Self {
            store: Store::new(memory, folder),
            train: Vec::new(),
            val: Vec::new(),
            left_out: Vec::new(),
        };
        let template = "reading {bar:30} {pos}/{len} episodes";
        let bar = progress_bar(dataset.metas().len(), template);
        let mut lengths = BTreeMap::new();
        for (index, split) in dataset.splits(seed).into_iter().enumerate() {
            if stop.load(Ordering::Relaxed) {
                bail!("stopped before training began");
            }
            bar.inc(1);
            if split == Split::Test {
                continue;
            }
            let mut leave_out = |why| {
                let id = dataset.metas()[index].id.clone();
                sets.left_out.push((id, why));
            };
            let episode = match dataset.load(index, config.layout()) {
                Ok(episode) => episode,
                Err(error) => {
                    leave_out(error.to_string());
                    continue;
                }
            };
            if let Some(odd) = episode.oddities().next() {
                leave_out(odd);
                continue;
            }
            let missing = missing(config, &episode);
            if !missing.is_empty() {
                let (roles, model) = (missing.join(", "), &config.name);
                leave_out(format!("lacks {roles}, which model `{model}` sees"));
                continue;
            }
            if split == Split::Train {
                *lengths.entry(episode.steps()).or_insert(0_usize) += 1;
            }
            let stored = sets.store.push(episode)?;
            if split == Split::Train {
                sets.train.push(stored);
            } else {
                sets.val.push(stored);
            }
        }
        bar.finish_and_clear();
        let usual = lengths.into_iter().max_by_key(|&(_, count)| count);
        if let Some((usual, _)) = usual {
            sets.keep_those_of(usual);
        }
        Ok(sets)
    }

    fn keep_those_of(&mut self, usual: usize) {
        let (store, left_out) = (&self.store, &mut self.left_out);
        for set in [&mut self.train, &mut self.val] {
            set.retain(|&index| {
                let steps = store.steps(index);
                if steps != usual {
                    let why = format!("{steps} images where most have {usual}");
                    left_out.push((store.id(index).to_owned(), why));
                }
                steps == usual
            });
        }
    }

    /// Fitted on.
    pub fn train(&self) -> Episodes<'_> {
        Episodes::new(&self.store, &self.train)
    }

    /// Scored on.
    pub fn val(&self) -> Episodes<'_> {
        Episodes::new(&self.store, &self.val)
    }

    /// What to do where there are too few to train on.
    pub fn remedy(&self) -> &'static str {
        if self.train.is_empty() && self.left_out.is_empty() {
            "its episodes are of another split (poescope info)"
        } else {
            "mend or record more, or lower `training.batch` (--set)"
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
        if self.store.spilled() > 0 {
            let (spilled, all) = (self.store.spilled(), self.store.len());
            write!(
                f,
                "; {spilled} of {all} do not fit into --memory and are on disk"
            )?;
        }
        for (id, reason) in self.left_out.iter().take(3) {
            write!(f, "\n  {id}: {reason}")?;
        }
        Ok(())
    }
}
