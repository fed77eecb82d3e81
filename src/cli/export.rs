//! Arguments of `export`.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::Args;

use super::TopicArgs;
use super::parse::{parse_size, parse_split, parse_steps};
use crate::episode::Split;

/// Arguments of `export`.
#[derive(Debug, Default, Args)]
pub struct ExportArgs {
    /// The file to write; an ending of .rrd, .mcap, .csv, .json, .jsonl or .png says the format
    #[arg(long)]
    pub out: PathBuf,
    /// Format, where the file's ending does not say it
    #[arg(long, value_enum)]
    pub format: Option<ExportFormat>,
    /// Replace a file that is there
    #[arg(long)]
    pub force: bool,
    /// Dataset: an .mcap file or a folder of them, or the name of a sample, `pybullet` [default: the sample episodes]
    #[arg(long)]
    pub data: Option<PathBuf>,
    /// Checkpoint folder; repeat for several models in one file [default: the sample model]
    #[arg(long)]
    pub model: Vec<PathBuf>,
    /// State string as copied with `y`: switches, context, horizon, damage, controls; its episode and selected steps
    /// where nothing else says them
    #[arg(long)]
    pub state: Option<String>,
    /// Every episode of this split: train, val or test
    #[arg(long, value_parser = parse_split, conflicts_with = "episode")]
    pub split: Option<Split>,
    /// Episode by its name; repeat for several [default: the first]
    #[arg(long, value_name = "ID")]
    pub episode: Vec<String>,
    /// Only these steps, counted from 1: `4-9`, or one
    #[arg(long, value_name = "FIRST-LAST", value_parser = parse_steps)]
    pub steps: Option<RangeInclusive<usize>>,
    /// What a PNG shows: `strip`, a figure of truth, model and error an episode; `sheet`, a row an episode; `view`, what
    /// the terminal shows
    #[arg(long, value_enum, default_value_t)]
    pub figure: Figure,
    /// Size of the terminal of `--figure view`, in columns x rows
    #[arg(long, default_value = "120x40", value_parser = parse_size)]
    pub size: (u16, u16),
    /// Keys to send to the terminal of `--figure view` first, as for `view`
    #[arg(long)]
    pub keys: Option<String>,
    /// Only every K-th step in a PNG [default: so that at most 16 are shown]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..))]
    pub every: Option<u16>,
    /// Each pixel of a frame becomes a square of this side in a PNG [default: 2 in a strip, 1 in a sheet]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=16))]
    pub zoom: Option<u16>,
    /// Where the dataset has its roles.
    #[command(flatten)]
    pub mapping: TopicArgs,
}

/// What a PNG shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Figure {
    /// Truth, model and error of every episode, as in the paper.
    #[default]
    Strip,
    /// A contact sheet: truth and model of every episode.
    Sheet,
    /// The terminal.
    View,
}

/// What `export` writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ExportFormat {
    /// A recording for the Rerun viewer.
    Rrd,
    /// The recording with beliefs, predictions and readings beside it, for Foxglove and PlotJuggler.
    Mcap,
    /// Two tables, of steps and of episodes.
    Csv,
    /// JSON Lines: every number.
    Json,
    /// A figure.
    Png,
}
