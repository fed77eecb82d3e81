//! `poescope eval`: the paper's tables and figures for any models on any dataset.

mod entrants;
mod figures;
mod fit;
mod ground;
mod kept;
mod ledger;
mod names;
mod scores;
mod scoring;
mod settings;

use anyhow::{Context, bail};

use self::entrants::Entrant;
use self::fit::Fit;
use self::ground::Ground;
use self::ledger::{Joined, Ledger, Place};
use self::scoring::Scoring;
use super::{note, sample, say};
use crate::cli::{EvalArgs, EvalPreset};
use crate::eval::protocol::Protocol;
use crate::eval::score::Contest;
use crate::eval::summary::summarise;
use crate::eval::{markdown, tables};
use crate::export::table::{write_csv, write_parquet};
use crate::model::checkpoint::write_atomic;

/// Runs it.
pub fn run(args: &EvalArgs) -> anyhow::Result<()> {
    let stop = super::stop_on_signals()?;
    let models = if args.model.is_empty() {
        sample::models(&sample::data(args.data.as_ref())?)?
    } else {
        args.model.clone()
    };
    let mut entrants = entrants::open(&models)?;
    let mut contest = contest(args, &entrants)?;
    let mut ground = Ground::of(args, &entrants)?;
    let out = args.out.as_deref();
    if let Some(out) = out {
        std::fs::create_dir_all(out).with_context(|| format!("making {}", out.display()))?;
    }
    let place = Place {
        out,
        shard: args.shard,
        merge: args.merge,
    };
    let mut ledger = Ledger::open(place, &ground, &contest, &mut entrants)?;
    let (i, n) = args.shard.unwrap_or((1, 1));
    let own = ground.episodes.iter().copied().skip(i - 1).step_by(n);
    let own: Vec<usize> = own.collect();
    let left = scoring::left(args, &ground, &entrants, &ledger, &own)?;
    // A shard keeps scores alone, which no regressor has a part in.
    if let (Some(data), None) = (&args.fit, args.shard) {
        let fit = Fit {
            data,
            topics: &args.mapping.topics,
            protocol: contest.protocol,
            never: ground.origins(),
            stop: &stop,
        };
        let refit = fit.each(&mut contest.candidates, &entrants)?;
        ground.scope.refit = Some(refit);
    }
    let scoring = Scoring {
        contest: &contest,
        ground: &ground,
        entrants: &entrants,
        of: own.len(),
        kept: out.is_some(),
        stop: &stop,
    };
    let left_out = scoring.run(&left, &mut ledger)?;
    // Where nothing is left to sum up, that is the error, and why.
    if args.shard.is_some() || left_out.len() < own.len() {
        for why in &left_out {
            note(&format!("left out: {why}"));
        }
    }
    if args.shard.is_some() {
        note("this shard is scored; sum up with --merge once all are");
        return Ok(());
    }
    let mut joined = ledger.joined(&contest, &own);
    ground.scope.left_out = std::mem::take(&mut joined.left_out);
    let scored = Scored {
        contest: &contest,
        joined: &joined,
        ground: &ground,
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
    let subjects = settings::subjects(&candidates, &args.state)?;
    Ok(Contest {
        candidates,
        subjects,
        protocol,
    })
}

/// Scores, and what they are of.
struct Scored<'a> {
    contest: &'a Contest,
    joined: &'a Joined,
    ground: &'a Ground,
    entrants: &'a [Entrant],
}

/// Says and writes what the scores come to.
fn conclude(args: &EvalArgs, scored: &Scored<'_>) -> anyhow::Result<()> {
    let Scored {
        contest,
        joined,
        ground,
        ..
    } = *scored;
    let scope = &ground.scope;
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
            "{}: no episode of split `{}`{}; choose another --split",
            scope.data,
            scope.split,
            ground.has()
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
        note(&format!("tables and figures: {}", out.display()));
    }
    if args.json {
        return say(&(serde_json::to_string_pretty(&summary)? + "\n"));
    }
    say(&text)
}
