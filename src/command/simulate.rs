//! `poescope simulate`: records planar pushes in simulation as a dataset.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, bail};
use rayon::prelude::*;

use super::{progress_bar, say, stop_on_signals};
use crate::{
    cli::SimulateArgs,
    data::DatasetWriter,
    episode::Recording,
    export::{ExportError, output::Output},
    sim::{self, Motion, Motions, Params},
};

/// Episodes on the contact sheet.
const SHEET_ROWS: usize = 12;
/// Episodes a thread simulates before all are written, in order: what is held in memory at a time.
const CHUNK_PER_THREAD: usize = 8;

/// Whether two paths are of one file, which need not be there yet.
fn same(a: &Path, b: &Path) -> bool {
    let folder = |path: &Path| {
        let parent = path
            .parent()
            .filter(|parent| !parent.as_os_str().is_empty());
        let parent = parent.unwrap_or(Path::new("."));
        parent.canonicalize().unwrap_or_else(|_| parent.to_owned())
    };
    a.file_name() == b.file_name() && folder(a) == folder(b)
}

/// Runs it.
pub fn run(args: &SimulateArgs) -> anyhow::Result<()> {
    if args
        .sheet
        .as_deref()
        .is_some_and(|sheet| same(sheet, &args.out))
    {
        bail!("--sheet: name another file than --out");
    }
    let stop = stop_on_signals()?;
    // Before anything is computed: what cannot be written should not cost an hour.
    let out = Output::create(&args.out, args.force)?;
    let sheet = args.sheet.as_deref();
    let sheet = sheet.map(|path| Output::create(path, args.force));
    let sheet = sheet.transpose().context("--sheet")?;
    let mut writer = DatasetWriter::create(out, &args.out)?;
    let mut rows = Vec::new();
    let motions = record_all(args, &stop, &mut |recording| {
        if sheet.is_some() && rows.len() < SHEET_ROWS {
            rows.push(recording.clone());
        }
        Ok(writer.write(recording)?)
    })?;
    writer.finish()?.commit()?;
    if let Some(sheet) = sheet {
        save_sheet(&rows, sheet)?;
    }
    say(&format!("{motions}\n"))
}

fn save_sheet(rows: &[Recording], mut output: Output) -> anyhow::Result<()> {
    let name = output.path().display().to_string();
    sim::sheet(rows)
        .write_to(&mut output, image::ImageFormat::Png)
        .with_context(|| format!("writing the contact sheet {name}"))?;
    Ok(output.commit()?)
}

/// Simulates all episodes and hands them to `sink` in the order of their index, whatever the threads, until `stop`.
fn record_all(
    args: &SimulateArgs,
    stop: &AtomicBool,
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
    let progress = progress_bar(
        args.episodes,
        "{bar:40} {pos}/{len} episodes, {per_sec}, {eta} left",
    );
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
        if stop.load(Ordering::Relaxed) {
            return Err(ExportError::Stopped.into());
        }
        for mut recording in recordings {
            recording.meta.split = args.split;
            motions.extend(Motion::of(&recording));
            sink(&recording)?;
        }
    }
    progress.finish_and_clear();
    Ok(motions)
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
                force: false,
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
            let stop = AtomicBool::new(false);
            record_all(&args, &stop, &mut keep).expect("nothing can fail without a file");
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
