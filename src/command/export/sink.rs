//! The writer of each format.

use std::path::Path;
use std::sync::Arc;

use anyhow::bail;

use crate::cli::{self, ExportArgs, ExportFormat};
use crate::data::Dataset;
use crate::export::Sink;
use crate::export::csv::Tables;
use crate::export::json::Lines;
use crate::export::mcap::Recording;
use crate::export::png::{Figure, Kind, Picture};

/// The format that a file's ending says.
pub(super) fn by_ending(path: &Path) -> Option<ExportFormat> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    Some(match ending.as_str() {
        "rrd" => ExportFormat::Rrd,
        "mcap" => ExportFormat::Mcap,
        "csv" => ExportFormat::Csv,
        "json" | "jsonl" | "ndjson" => ExportFormat::Json,
        "png" => ExportFormat::Png,
        _ => return None,
    })
}

/// The writer of a format, with its file begun.
pub(super) fn sink(
    format: ExportFormat,
    args: &ExportArgs,
    dataset: &Arc<Dataset>,
) -> anyhow::Result<Box<dyn Sink>> {
    let (out, force) = (&args.out, args.force);
    let recorded = dataset.files().into_iter();
    if let Ok(own) = out.canonicalize()
        && recorded
            .filter_map(|file| file.path.canonicalize().ok())
            .any(|path| path == own)
    {
        bail!(
            "{} is the recording itself; choose another --out",
            out.display()
        );
    }
    Ok(match format {
        ExportFormat::Rrd => rrd(out, force, dataset)?,
        ExportFormat::Csv => Box::new(Tables::create(out, force)?),
        ExportFormat::Json => Box::new(Lines::create(out, force)?),
        ExportFormat::Mcap => Box::new(Recording::create(out, force, Arc::clone(dataset))?),
        ExportFormat::Png => Box::new(Picture::create(out, force, figure(args))?),
    })
}

fn figure(args: &ExportArgs) -> Figure {
    let (kind, zoom) = match args.figure {
        cli::Figure::Sheet => (Kind::Sheet, 1),
        // The terminal's picture has no sink: it is of one moment.
        cli::Figure::Strip | cli::Figure::View => (Kind::Strip, 2),
    };
    Figure {
        kind,
        every: args.every.map(usize::from),
        zoom: args.zoom.map_or(zoom, usize::from),
    }
}

/// A recording for the Rerun viewer.
#[cfg(feature = "rerun")]
fn rrd(out: &Path, force: bool, dataset: &Arc<Dataset>) -> anyhow::Result<Box<dyn Sink>> {
    use crate::export::rerun::Recording;
    Ok(Box::new(Recording::create(
        out,
        force,
        Arc::clone(dataset),
    )?))
}

/// This build has none.
#[cfg(not(feature = "rerun"))]
fn rrd(_: &Path, _: bool, _: &Arc<Dataset>) -> anyhow::Result<Box<dyn Sink>> {
    bail!(
        "this build has no Rerun in it; build it with the feature `rerun`, which is on by default"
    )
}
