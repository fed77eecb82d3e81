//! Arguments of `train`.

use std::path::PathBuf;

use clap::Args;

use super::TopicArgs;
use super::parse::{parse_bytes, parse_interval, parse_minutes, parse_preset};
use crate::model::config::Preset;

/// Arguments of `train`.
#[derive(Debug, Args)]
pub struct TrainArgs {
    /// Dataset: an .mcap file or a folder of them
    #[arg(long)]
    pub data: PathBuf,
    /// Which model: `v`, `vp`, `vh`, `vhp`, `vhp-c` or `v-h-p` [default: v-h-p]
    #[arg(long)]
    pub model: Option<String>,
    /// How to train it: `paper`, `released` (the authors' script) or `fast`, made for an hour of two cores (give
    /// --minutes) [default: fast]
    #[arg(long, value_parser = parse_preset)]
    pub preset: Option<Preset>,
    /// One key of the config, over the preset's; repeat for several: `--set training.batch=8` (docs/training.md)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Run folder: checkpoints, metrics, report
    #[arg(long)]
    pub out: PathBuf,
    /// A config.toml to train instead of a model's preset
    #[arg(long, conflicts_with = "preset")]
    pub config: Option<PathBuf>,
    /// Epochs over the training split [default: the preset's, or none with --minutes or --updates]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    pub epochs: Option<u64>,
    /// Updates to train for; with another limit too, whichever comes first
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    pub updates: Option<u64>,
    /// Minutes to train for; with another limit too, whichever comes first
    #[arg(long, value_parser = parse_minutes)]
    pub minutes: Option<f64>,
    /// Seed of initial weights, order, noise and masks, and of the validation split where the data name none
    /// [default: 0]
    #[arg(long)]
    pub seed: Option<u64>,
    /// Worker threads [default: one per core]
    #[arg(long)]
    pub threads: Option<usize>,
    /// Episodes to hold in memory, in bytes, KiB, MiB or GiB; others lie in the run folder while it runs
    #[arg(long, value_parser = parse_bytes, default_value = "512MiB")]
    pub memory: u64,
    /// Time between checkpoints, each of which can be resumed from and looked at
    #[arg(long, value_name = "MINUTES", value_parser = parse_interval, default_value = "3")]
    pub checkpoint_minutes: f64,
    /// Go on from the run folder's last checkpoint; what is said besides has to be what the run was started with, but
    /// for its limits
    #[arg(long)]
    pub resume: bool,
    /// Where the dataset has its roles.
    #[command(flatten)]
    pub mapping: TopicArgs,
}
