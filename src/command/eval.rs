//! `poescope eval`: open-loop prediction of a model, horizon by horizon, beside the trivial predictors.

use std::fmt::Write as _;

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};

use super::{open, sample, say};
use crate::cli::EvalArgs;
use crate::data::Dataset;
use crate::episode::EpisodeSource;
use crate::eval::{self, Protocol, Report};
use crate::model::checkpoint;
use crate::model::inspect::Inspector;
use crate::model::observation::{self, suits};

/// Runs it.
pub fn run(args: &EvalArgs) -> anyhow::Result<()> {
    let folder = sample::model(args.model.as_ref())?;
    let (model, _) = checkpoint::load(&folder)?;
    let mean_path = folder.join(checkpoint::MEAN_FRAME);
    let mean_frame = image::open(&mean_path)
        .with_context(|| {
            format!(
                "{}: the mean training frame; train writes it",
                mean_path.display()
            )
        })?
        .into_luma8();
    let mean_frame: Vec<f32> = mean_frame
        .into_raw()
        .into_iter()
        .map(|p| f32::from(p) / 255.0)
        .collect();
    let path = sample::data(args.data.as_ref())?;
    let dataset = Dataset::open_with(&path, &args.mapping.topics)?;
    let protocol = Protocol {
        context: args.context,
        horizon: args.horizon,
    };
    let config = &model.config;
    if protocol.context <= config.frame_stack || protocol.horizon == 0 {
        bail!(
            "--context must be more than {} and --horizon more than 0",
            config.frame_stack
        );
    }
    if mean_frame.len() != config.frame_size * config.frame_size {
        bail!(
            "{} is not {1} x {1} pixels",
            mean_path.display(),
            config.frame_size
        );
    }
    let mut episodes = Vec::new();
    for (index, split) in dataset
        .splits(open::split_seed(&folder))
        .into_iter()
        .enumerate()
    {
        if split != args.split {
            continue;
        }
        let episode = match dataset.load(index, config.layout()) {
            Ok(episode) => episode,
            Err(error) => {
                eprintln!("left out: {error}");
                continue;
            }
        };
        let missing = observation::missing(config, &episode);
        if !missing.is_empty() {
            bail!(
                "{}: episode `{}` lacks {}",
                path.display(),
                episode.meta.id,
                missing.join(", ")
            );
        }
        suits(config, &episode).with_context(|| path.display().to_string())?;
        if episode.steps() >= protocol.context + protocol.horizon {
            episodes.push(episode);
        }
    }
    let bar = ProgressBar::new(episodes.len() as u64);
    bar.set_style(ProgressStyle::with_template(
        "scoring {bar:30} {pos}/{len} episodes",
    )?);
    let report = eval::report(
        &Inspector::new(model)?,
        &episodes,
        &mean_frame,
        protocol,
        || bar.inc(1),
    )?;
    bar.finish_and_clear();
    let Some(report) = report else {
        bail!(
            "{}: no episode of split `{}` with {} images or more; choose another --split, --context or --horizon",
            path.display(),
            args.split.name(),
            protocol.context + protocol.horizon
        );
    };
    let text = if args.json {
        serde_json::to_string_pretty(&report)? + "\n"
    } else {
        markdown(&report)
    };
    say(&text)
}

/// The report as a Markdown table.
fn markdown(report: &Report) -> String {
    let mut text = format!(
        "`{}`, {} episodes, context {}, PSNR in dB, differences with paired 95 % bootstrap intervals\n\n\
         | horizon | model | last frame held | mean frame | over held | over mean frame |\n\
         | --: | --: | --: | --: | --: | --: |\n",
        report.model, report.episodes, report.protocol.context
    );
    for row in &report.rows {
        let interval = |i: crate::measure::bootstrap::Interval| {
            format!("{:+.2} [{:+.2}, {:+.2}]", i.mean, i.low, i.high)
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {} | {:.2} | {:.2} | {:.2} | {} | {} |",
            row.horizon,
            row.model_db,
            row.held_db,
            row.mean_frame_db,
            interval(row.over_held),
            interval(row.over_mean_frame)
        );
    }
    text
}
