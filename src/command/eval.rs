//! `poescope eval`: the paper's tables and figures for any models on any dataset.

mod candidates;
mod figures;
mod names;
mod scores;
mod settings;

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use self::candidates::Fit;
use self::scores::{Identity, Line, ScoreFile};
use super::{open, sample, say};
use crate::cli::{EvalArgs, EvalPreset};
use crate::data::Dataset;
use crate::episode::{EpisodeSource, Split};
use crate::eval::protocol::Protocol;
use crate::eval::score::{Contest, EpisodeScores, score};
use crate::eval::summary::{Scope, summarise};
use crate::eval::{markdown, tables};
use crate::export::table::{write_csv, write_parquet};
use crate::model::checkpoint::write_atomic;
use crate::model::observation::{self, suits};

/// Episodes between two looks at whether to stop, and between two writes.
const CHUNK: usize = 16;

/// Runs it.
pub fn run(args: &EvalArgs) -> anyhow::Result<()> {
    let stop = super::stop_on_signals()?;
    let path = sample::data(args.data.as_ref())?;
    let folders = if args.model.is_empty() {
        sample::models(&path)?
    } else {
        args.model.clone()
    };
    let dataset = Dataset::open_with(&path, &args.mapping.topics)?;
    let mut contest = contest(args, &folders)?;
    let (split, wanted) = wanted(args, &dataset, &folders)?;
    // A shard keeps scores alone, which no regressor has a part in.
    if let (Some(data), None) = (&args.fit, args.shard) {
        let fit = Fit {
            data,
            topics: &args.mapping.topics,
            protocol: contest.protocol,
            never: wanted.iter().filter_map(|&i| dataset.origin(i)).collect(),
            stop: &stop,
        };
        fit.each(&mut contest.candidates, &folders)?;
    }
    if let Some(out) = &args.out {
        std::fs::create_dir_all(out).with_context(|| format!("making {}", out.display()))?;
    }
    let identity = Identity::of(&contest, &dataset, split);
    let mut file = match &args.out {
        Some(out) => ScoreFile::open(out, &identity, args.shard)?,
        None => ScoreFile::default(),
    };
    let own: Vec<usize> = match args.shard {
        Some((i, n)) => wanted.into_iter().skip(i - 1).step_by(n).collect(),
        None => wanted,
    };
    let left: Vec<usize> = own.iter().copied().filter(|&i| !file.has(i)).collect();
    if let (true, Some(&first)) = (args.merge, left.first()) {
        bail!(
            "{} of {} episodes are not scored yet, `{}` among them; run their shards, or leave out --merge",
            left.len(),
            own.len(),
            dataset.metas()[first].id
        );
    }
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
        let each = chunk.par_iter();
        let lines = each.map(|&index| one(&contest, &dataset, index, &path));
        for line in lines.collect::<anyhow::Result<Vec<Line>>>()? {
            if let Some(why) = &line.left_out {
                bar.suspend(|| eprintln!("left out: {why}"));
            }
            file.push(line)?;
        }
        bar.inc(chunk.len() as u64);
    }
    bar.finish_and_clear();
    if args.shard.is_some() {
        eprintln!("this shard is scored; sum up with --merge once all are");
        return Ok(());
    }
    let scope = Scope {
        data: dataset.name().to_owned(),
        data_hash: dataset.data_hash().to_owned(),
        split: split.name().to_owned(),
        left_out: file.left_out(),
    };
    let (indices, all) = file.scores();
    let scored = Scored {
        contest: &contest,
        all: &all,
        indices: &indices,
        scope: &scope,
        dataset: &dataset,
        folders: &folders,
    };
    conclude(args, &scored)
}

/// The models under every setting.
fn contest(args: &EvalArgs, folders: &[PathBuf]) -> anyhow::Result<Contest> {
    let preset = match args.preset {
        EvalPreset::Synthetic => Protocol::SYNTHETIC,
        EvalPreset::Mit => Protocol::MIT,
    };
    let protocol = Protocol {
        context: args.context.unwrap_or(preset.context),
        horizon: args.horizon.unwrap_or(preset.horizon),
    };
    let candidates = candidates::open(folders)?;
    for candidate in &candidates {
        let stack = candidate.inspector.model().config.frame_stack;
        if protocol.context <= stack {
            bail!("--context must be more than {stack}");
        }
    }
    let subjects = settings::subjects(&candidates, &args.state, protocol)?;
    let mean_frame = candidates::mean_frame(&folders[0], &candidates[0])?;
    Ok(Contest {
        candidates,
        subjects,
        protocol,
        mean_frame,
    })
}

/// The split that is scored, and its episodes. Where the dataset names no `val`, every training on it has cut its own by
/// its seed: episodes that one model has not seen another was trained on, so such models are refused together.
fn wanted(
    args: &EvalArgs,
    dataset: &Dataset,
    folders: &[PathBuf],
) -> anyhow::Result<(Split, Vec<usize>)> {
    let splits = |folder: &Path| dataset.splits(open::split_seed(folder));
    let trained_on_it = |folder: &&PathBuf| {
        let hash = open::report(folder)["data_hash"]
            .as_str()
            .map(str::to_owned);
        hash.is_none_or(|hash| hash == dataset.data_hash())
    };
    let cutters: Vec<&PathBuf> = folders.iter().filter(trained_on_it).collect();
    let cutter = *cutters.first().unwrap_or(&&folders[0]);
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
    for folder in cutters.into_iter().skip(1) {
        if of_split(&splits(folder)) != wanted {
            bail!(
                "{} names no split `val`: {} and {} have each cut their own from `train`, by different seeds; evaluate \
                 them apart, or on a dataset that names its splits",
                dataset.name(),
                cutter.display(),
                folder.display()
            );
        }
    }
    Ok((split, wanted))
}

/// Scores an episode, or says why it is left out.
fn one(contest: &Contest, dataset: &Dataset, index: usize, path: &Path) -> anyhow::Result<Line> {
    let left_out = |why: String| Line {
        index,
        left_out: Some(why),
        scores: None,
    };
    let first = &contest.candidates[0].inspector.model().config;
    let episode = match dataset.load(index, first.layout()) {
        Ok(episode) => episode,
        Err(error) => return Ok(left_out(error.to_string())),
    };
    if let Some(why) = candidates::odd(&episode) {
        return Ok(left_out(why));
    }
    let id = &episode.meta.id;
    for candidate in &contest.candidates {
        let config = &candidate.inspector.model().config;
        let missing = observation::missing(config, &episode);
        if !missing.is_empty() {
            bail!(
                "{}: episode `{id}` lacks {}, which model `{}` sees",
                path.display(),
                missing.join(", "),
                candidate.label
            );
        }
        suits(config, &episode).with_context(|| path.display().to_string())?;
    }
    let (steps, images) = (episode.steps(), contest.protocol.images());
    if steps < images {
        return Ok(left_out(format!(
            "episode `{id}` has {steps} images of {images}; choose a smaller --horizon"
        )));
    }
    let scores = score(contest, &episode).with_context(|| format!("episode `{id}`"))?;
    Ok(Line {
        index,
        left_out: None,
        scores: Some(scores),
    })
}

/// Scores, and what they are of.
struct Scored<'a> {
    contest: &'a Contest,
    all: &'a [EpisodeScores],
    /// Their places in the dataset.
    indices: &'a [usize],
    scope: &'a Scope,
    dataset: &'a Dataset,
    folders: &'a [PathBuf],
}

/// Says and writes what the scores come to.
fn conclude(args: &EvalArgs, scored: &Scored<'_>) -> anyhow::Result<()> {
    let Scored {
        contest,
        all,
        indices,
        scope,
        ..
    } = *scored;
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
