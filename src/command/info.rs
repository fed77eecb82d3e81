//! `poescope info`: what a dataset holds, and what of it cannot be used.

mod table;

use anyhow::Context;
use serde::Serialize;

use super::{sample, say};
use crate::cli::InfoArgs;
use crate::data::{Dataset, FileReport, LeftOut};
use crate::episode::{EpisodeMeta, EpisodeSource, Layout};

/// Everything that is told of a dataset.
#[derive(Debug, Serialize)]
struct Info {
    dataset: String,
    data_hash: String,
    duration_secs: f64,
    episodes: Vec<EpisodeInfo>,
    files: Vec<FileReport>,
    left_out: Vec<LeftOut>,
}

/// One episode.
#[derive(Debug, Serialize)]
struct EpisodeInfo {
    #[serde(flatten)]
    meta: EpisodeMeta,
    duration_secs: f64,
    /// None where the file is damaged.
    images: Option<u64>,
}

/// Prints a dataset's table of contents.
pub fn run(args: &InfoArgs) -> anyhow::Result<()> {
    let info = gather(args)?;
    let text = if args.json {
        let mut text = serde_json::to_string_pretty(&info).context("writing JSON")?;
        text.push('\n');
        text
    } else {
        table::render(&info)
    };
    say(&text)
}

fn gather(args: &InfoArgs) -> anyhow::Result<Info> {
    let dataset = Dataset::inspect(&sample::data(Some(&args.path))?, &args.mapping.topics)?;
    let counts = dataset.image_counts();
    let episodes: Vec<_> = dataset
        .metas()
        .iter()
        .zip(counts)
        .map(|(meta, images)| EpisodeInfo {
            duration_secs: meta.end_nanos.saturating_sub(meta.start_nanos) as f64 * 1e-9,
            images,
            meta: meta.clone(),
        })
        .collect();
    let mut left_out = dataset.left_out().to_vec();
    if args.check {
        left_out.extend(oddities(&dataset));
    }
    let unread = dataset.unread(&args.mapping.topics).into_iter();
    left_out.extend(unread.map(|why| LeftOut {
        what: "--topic".to_owned(),
        why,
    }));
    left_out.extend(episodes.iter().filter_map(|episode| {
        let why = match episode.images {
            Some(images) if images >= 2 => return None,
            Some(images) => format!("{images} image(s), and an episode needs two"),
            None => "its file is damaged, so its images could not be counted".to_owned(),
        };
        let what = format!("episode {}", episode.meta.id);
        Some(LeftOut { what, why })
    }));
    Ok(Info {
        dataset: dataset.name().to_owned(),
        data_hash: dataset.data_hash().to_owned(),
        duration_secs: episodes
            .iter()
            .fold(0.0, |sum, episode| sum + episode.duration_secs),
        episodes,
        files: dataset.files(),
        left_out,
    })
}

/// What is odd about the episodes, or why they cannot be read.
fn oddities(dataset: &Dataset) -> Vec<LeftOut> {
    let mut odd = Vec::new();
    for (index, meta) in dataset.metas().iter().enumerate() {
        let found = match dataset.load(index, Layout::default()) {
            Ok(episode) => episode.oddities().collect(),
            Err(error) => vec![error.to_string()],
        };
        let what = format!("episode {}", meta.id);
        odd.extend(found.into_iter().map(|why| LeftOut {
            what: what.clone(),
            why,
        }));
    }
    odd
}
