//! `poescope simulate`: records planar pushes in simulation as a dataset.

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use super::say;
use crate::{
    cli::SimulateArgs,
    data::DatasetWriter,
    episode::Recording,
    sim::{self, Motion, Motions, Params},
};

/// Episodes on the contact sheet.
const SHEET_ROWS: usize = 12;
/// Episodes a thread simulates before all are written, in order: what is held in memory at a time.
const CHUNK_PER_THREAD: usize = 8;

/// Runs it.
pub fn run(args: &SimulateArgs) -> anyhow::Result<()> {
    let mut writer = DatasetWriter::create(&args.out)?;
    let motions = record_all(args, &mut |recording| Ok(writer.write(recording)?))?;
    writer.finish()?;
    say(&format!("{motions}\n"))
}

/// Simulates all episodes and hands them to `sink` in the order of their index, whatever the threads.
fn record_all(
    args: &SimulateArgs,
    sink: &mut dyn FnMut(&Recording) -> anyhow::Result<()>,
) -> anyhow::Result<Motions> {
    let params = Params {
        steps: args.steps,
        window: args.window,
        rate_hz: args.rate_hz,
        planar: args.planar,
        ..Params::default()
    };
    params.check()?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads.unwrap_or(0))
        .thread_name(|i| format!("simulate-{i}"))
        .build()
        .context("starting the worker threads")?;

    let mut motions = Motions::default();
    let mut sheet_rows = Vec::new();
    let progress = progress_bar(args.episodes);
    let chunk = CHUNK_PER_THREAD * pool.current_num_threads();
    for first in (0..args.episodes).step_by(chunk) {
        let indices = first..args.episodes.min(first + chunk);
        let recordings: Vec<Recording> = pool.install(|| {
            indices
                .into_par_iter()
                .map(|index| sim::simulate(&params, args.seed, index as u64))
                .inspect(|_| progress.inc(1))
                .collect()
        });
        for mut recording in recordings {
            recording.meta.split = args.split;
            motions.extend(Motion::of(&recording));
            sink(&recording)?;
            if args.sheet.is_some() && sheet_rows.len() < SHEET_ROWS {
                sheet_rows.push(recording);
            }
        }
    }
    progress.finish_and_clear();
    if let Some(path) = &args.sheet {
        sim::sheet(&sheet_rows)
            .save_with_format(path, image::ImageFormat::Png)
            .with_context(|| format!("writing the contact sheet {}", path.display()))?;
    }
    Ok(motions)
}

fn progress_bar(episodes: usize) -> ProgressBar {
    let bar = ProgressBar::new(episodes as u64);
    let template = "{bar:40} {pos}/{len} episodes, {per_sec}, {eta} left";
    bar.with_style(
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::Split;

    #[test]
    fn episodes_come_in_order_and_alike_whatever_the_threads() {
        let record = |threads| {
            let args = SimulateArgs {
                episodes: 19,
                seed: 4,
                out: "unused.mcap".into(),
                split: Some(Split::Val),
                steps: 2,
                window: 4,
                rate_hz: 120.0,
                planar: false,
                threads: Some(threads),
                sheet: None,
            };
            let mut recordings = Vec::new();
            let mut keep = |recording: &Recording| {
                recordings.push(recording.clone());
                Ok(())
            };
            record_all(&args, &mut keep).expect("nothing can fail without a file");
            recordings
        };
        let recordings = record(1);
        assert!(recordings == record(3));
        let ids: Vec<_> = recordings.iter().map(|r| r.meta.id.as_str()).collect();
        assert_eq!(ids.len(), 19);
        assert_eq!((ids[0], ids[18]), ("ep00000", "ep00018"));
        assert!(recordings.iter().all(|r| r.meta.split == Some(Split::Val)));
    }
}
