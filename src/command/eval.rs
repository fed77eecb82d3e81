//! `poescope eval`: the paper's tables and figures for any models on any dataset.

mod entrants;
mod figures;
mod fit;
mod ledger;
mod names;
mod scores;
mod settings;

use std::path::Path;
use std::sync::atomic::Ordering;

use anyhow::bail;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use self::entrants::Entrant;
use self::fit::Fit;
use self::ledger::{Joined, Ledger};
use super::{sample, say};
use crate::cli::{EvalArgs, EvalPreset};
use crate::data::Dataset;
use crate::episode::{Episode, EpisodeSource, Split};
use crate::eval::protocol::Protocol;
use crate::eval::score::Contest;
use crate::eval::summary::{Scope, summarise};
use crate::eval::{markdown, tables};
use crate::export::table::{write_csv, write_parquet};
use crate::model::checkpoint::write_atomic;

/// Episodes between two looks at whether to stop, and between two writes.
const CHUNK: usize = 16;

/// Runs it.
pub fn run(args: &EvalArgs) -> anyhow::Result<()> {
    let stop = super::stop_on_signals()?;
    let path = sample::data(args.data.as_ref())?;
    let models = if args.model.is_empty() {
        sample::models(&path)?
    } else {
        args.model.clone()
    };
    let mut entrants = entrants::open(&models)?;
    let mut contest = contest(args, &entrants)?;
    let (dataset, mut scope, wanted) = scope(args, &path, &entrants)?;
    // A shard keeps scores alone, which no regressor has a part in.
    if let (Some(data), None) = (&args.fit, args.shard) {
        let origin = |&i: &usize| dataset.as_ref().and_then(|dataset| dataset.origin(i));
        let fit = Fit {
            data,
            topics: &args.mapping.topics,
            protocol: contest.protocol,
            never: wanted.iter().filter_map(origin).collect(),
            stop: &stop,
        };
        fit.each(&mut contest.candidates, &entrants)?;
    }
    let mut ledger = Ledger::open(args, &scope, &contest, &mut entrants)?;
    let own: Vec<usize> = match args.shard {
        Some((i, n)) => wanted.into_iter().skip(i - 1).step_by(n).collect(),
        None => wanted,
    };
    let lacks = |index: &usize| !ledger.lacking(*index).is_empty();
    let left: Vec<usize> = own.iter().copied().filter(lacks).collect();
    if let (true, Some(&first)) = (args.merge || dataset.is_none(), left.first()) {
        let id = dataset.as_ref().map(|dataset| &dataset.metas()[first].id);
        bail!(
            "{} of {} episodes are not scored yet{}; {}",
            left.len(),
            own.len(),
            id.map_or_else(String::new, |id| format!(", `{id}` among them")),
            if args.merge {
                "run their shards, or leave out --merge"
            } else {
                "name the dataset by --data, and the checkpoint folders"
            }
        );
    }
    if let Some(dataset) = &dataset {
        let bar = ProgressBar::new(own.len() as u64);
        bar.set_style(ProgressStyle::with_template(
            "scoring {bar:30} {pos}/{len} episodes, {eta} left",
        )?);
        bar.inc((own.len() - left.len()) as u64);
        for chunk in left.chunks(CHUNK) {
            if stop.load(Ordering::Relaxed) {
                bar.finish_and_clear();
                bail!(match &args.out {
                    Some(_) => "stopped; go on with the same command",
                    None => "stopped",
                });
            }
            let each = chunk.par_iter().map(|&index| {
                let lacking = ledger.lacking(index);
                ledger::one(&contest, &entrants, &lacking, dataset, (index, &path))
            });
            for lines in each.collect::<anyhow::Result<Vec<_>>>()? {
                let why = lines.iter().find_map(|(_, line)| line.left_out.as_ref());
                if let Some(why) = why {
                    bar.suspend(|| eprintln!("left out: {why}"));
                }
                ledger.push(lines)?;
            }
            bar.inc(chunk.len() as u64);
        }
        bar.finish_and_clear();
    }
    if args.shard.is_some() {
        eprintln!("this shard is scored; sum up with --merge once all are");
        return Ok(());
    }
    let joined = ledger.joined(&contest, &own);
    scope.left_out.clone_from(&joined.left_out);
    let scored = Scored {
        contest: &contest,
        joined: &joined,
        scope: &scope,
        dataset: dataset.as_ref(),
        entrants: &entrants,
    };
    conclude(args, &scored)
}

/// The models under every setting.
fn contest(args: &EvalArgs, entrants: &[Entrant]) -> anyhow::Result<Contest> {
    let preset = match args.preset {
        EvalPreset::Synthetic => Protocol::SYNTHETIC,
        EvalPreset::Mit => Protocol::MIT,
    };
    let protocol = Protocol {
        context: args.context.unwrap_or(preset.context),
        horizon: args.horizon.unwrap_or(preset.horizon),
    };
    let candidates = entrants::candidates(entrants);
    for candidate in &candidates {
        let stack = candidate.config.frame_stack;
        if protocol.context <= stack {
            bail!("--context must be more than {stack}");
        }
    }
    let subjects = settings::subjects(&candidates, &args.state, protocol)?;
    Ok(Contest {
        candidates,
        subjects,
        protocol,
    })
}

/// The dataset, what is scored of it, and those episodes. Scores say themselves what they are of, so that they can be
/// summed up where the episodes are not at hand.
fn scope(
    args: &EvalArgs,
    path: &Path,
    entrants: &[Entrant],
) -> anyhow::Result<(Option<Dataset>, Scope, Vec<usize>)> {
    let published = entrants.iter().all(|entrant| entrant.scorer.is_none());
    if let (true, None, Some(scores)) = (published, &args.data, &entrants[0].scores) {
        let head = scores.head();
        let scope = Scope {
            data: head.data.clone(),
            data_hash: head.data_hash.clone(),
            split: head.split.clone(),
            left_out: Vec::new(),
        };
        return Ok((None, scope, scores.indices().collect()));
    }
    let dataset = Dataset::open_with(path, &args.mapping.topics)?;
    let (split, wanted) = wanted(args, &dataset, entrants)?;
    let scope = Scope {
        data: dataset.name().to_owned(),
        data_hash: dataset.data_hash().to_owned(),
        split: split.name().to_owned(),
        left_out: Vec::new(),
    };
    Ok((Some(dataset), scope, wanted))
}

/// The split that is scored, and its episodes. Where the dataset names no `val`, every training on it has cut its own by
/// its seed: episodes that one model has not seen another was trained on, so such models are refused together.
fn wanted(
    args: &EvalArgs,
    dataset: &Dataset,
    entrants: &[Entrant],
) -> anyhow::Result<(Split, Vec<usize>)> {
    let splits = |entrant: &Entrant| dataset.splits(entrant.about.split_seed());
    let trained_on_it = |entrant: &&Entrant| {
        let hash = entrant.about.report["data_hash"].as_str();
        hash.is_none_or(|hash| hash == dataset.data_hash())
    };
    let cutters: Vec<&Entrant> = entrants.iter().filter(trained_on_it).collect();
    let cutter = *cutters.first().unwrap_or(&&entrants[0]);
    let first = splits(cutter);
    let split = args.split.unwrap_or_else(|| {
        let has = |split: &Split| first.contains(split);
        let known = [Split::Test, Split::Val].into_iter().find(has);
        known.unwrap_or(Split::Test)
    });
    let of_split = |splits: &[Split]| -> Vec<usize> {
        let own = splits.iter().enumerate().filter(|(_, own)| **own == split);
        own.map(|(index, _)| index).collect()
    };
    let wanted = of_split(&first);
    for entrant in cutters.into_iter().skip(1) {
        if of_split(&splits(entrant)) != wanted {
            bail!(
                "{} names no split `val`: {} and {} have each cut their own from `train`, by different seeds; evaluate \
                 them apart, or on a dataset that names its splits",
                dataset.name(),
                cutter.path.display(),
                entrant.path.display()
            );
        }
    }
    Ok((split, wanted))
}

/// Why an episode says nothing about a model: what was odd when it was recorded, as training has it.
pub fn odd(episode: &Episode) -> Option<String> {
    let flag = episode.flags.first()?;
    let id = &episode.meta.id;
    Some(format!("episode `{id}`: {}: {}", flag.topic, flag.what))
}

/// Scores, and what they are of.
struct Scored<'a> {
    contest: &'a Contest,
    joined: &'a Joined,
    scope: &'a Scope,
    /// None where scores alone were named.
    dataset: Option<&'a Dataset>,
    entrants: &'a [Entrant],
}

/// Says and writes what the scores come to.
fn conclude(args: &EvalArgs, scored: &Scored<'_>) -> anyhow::Result<()> {
    let Scored {
        contest,
        joined,
        scope,
        ..
    } = *scored;
    let Joined { indices, all, .. } = joined;
    let Some(summary) = summarise(contest, all, scope)? else {
        if let Some(why) = scope.left_out.first() {
            let count = scope.left_out.len();
            bail!(
                "{}: all {count} episodes of split `{}` were left out: {why}",
                scope.data,
                scope.split
            );
        }
        bail!(
            "{}: no episode of split `{}`; choose another --split",
            scope.data,
            scope.split
        );
    };
    let text = markdown::markdown(&summary);
    if let Some(out) = &args.out {
        for table in tables::tables(contest, all, indices, &summary) {
            write_csv(&table, &out.join(format!("{}.csv", table.name)))?;
            write_parquet(&table, &out.join(format!("{}.parquet", table.name)))?;
        }
        figures::write(scored, &summary, out)?;
        write_atomic(&out.join("tables.md"), text.as_bytes())?;
        eprintln!("tables and figures: {}", out.display());
    }
    if args.json {
        return say(&(serde_json::to_string_pretty(&summary)? + "\n"));
    }
    say(&text)
}
