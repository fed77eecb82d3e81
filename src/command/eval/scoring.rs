//! Scores the episodes that no scores are kept of, a chunk after the other; it can be stopped between two.

use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::bail;
use rayon::prelude::*;

use super::entrants::Entrant;
use super::ground::Ground;
use super::ledger::Ledger;
use super::scores::Outcome;
use crate::cli::EvalArgs;
use crate::command::progress_bar;
use crate::episode::EpisodeSource;
use crate::eval::score::Contest;

/// Episodes between two looks at whether to stop, and between two writes.
const CHUNK: usize = 16;

/// Those of `own`, places in the dataset, that are still to be scored.
///
/// # Errors
///
/// Where nobody can score one that is missing: its model is there by its scores alone, or `--merge` only sums up.
pub fn left(
    args: &EvalArgs,
    ground: &Ground,
    entrants: &[Entrant],
    ledger: &Ledger,
    own: &[usize],
) -> anyhow::Result<Vec<usize>> {
    for (candidate, entrant) in entrants.iter().enumerate() {
        let missing = own.iter().filter(|index| ledger.lacks(candidate, **index));
        let missing = missing.count();
        if entrant.scorer().is_none() && missing > 0 {
            bail!(
                "{} lacks {missing} of {} episodes; name the checkpoint folder instead, or finish its run",
                entrant.path.display(),
                own.len()
            );
        }
    }
    let lacking = |index: &usize| !ledger.lacking(*index).is_empty();
    let left: Vec<usize> = own.iter().copied().filter(lacking).collect();
    if let (true, Some(dataset), Some(&first)) = (args.merge, ground.dataset(), left.first()) {
        bail!(
            "{} of {} episodes are not scored yet, `{}` among them; run their shards, or leave out --merge",
            left.len(),
            own.len(),
            dataset.metas()[first].id
        );
    }
    Ok(left)
}

/// Scores by whom and on what.
#[derive(Clone, Copy)]
pub struct Scoring<'a> {
    pub contest: &'a Contest,
    pub ground: &'a Ground,
    pub entrants: &'a [Entrant],
    /// Episodes that were to be scored before any was.
    pub of: usize,
    /// Whether scores are kept, to go on with.
    pub kept: bool,
    pub stop: &'a AtomicBool,
}

impl Scoring<'_> {
    /// Scores what is left into the ledger; why episodes were left out.
    pub fn run(self, left: &[usize], ledger: &mut Ledger) -> anyhow::Result<Vec<String>> {
        let bar = progress_bar(self.of, "scoring {bar:30} {pos}/{len} episodes, {eta} left");
        bar.inc((self.of - left.len()) as u64);
        let mut left_out: Vec<String> = Vec::new();
        for chunk in left.chunks(CHUNK) {
            if self.stop.load(Ordering::Relaxed) {
                bar.finish_and_clear();
                bail!(if self.kept {
                    "stopped; go on with the same command"
                } else {
                    "stopped"
                });
            }
            let each = chunk.par_iter().map(|&index| {
                let lacking = ledger.lacking(index);
                let outcomes = self
                    .ground
                    .score(self.contest, self.entrants, &lacking, index)?;
                Ok((index, lacking, outcomes))
            });
            for (index, lacking, outcomes) in each.collect::<anyhow::Result<Vec<_>>>()? {
                let mut why = outcomes.iter().filter_map(Outcome::left_out);
                left_out.extend(why.next().map(str::to_owned));
                for (candidate, outcome) in lacking.into_iter().zip(outcomes) {
                    ledger.push(candidate, index, outcome)?;
                }
            }
            bar.inc(chunk.len() as u64);
        }
        bar.finish_and_clear();
        Ok(left_out)
    }
}
