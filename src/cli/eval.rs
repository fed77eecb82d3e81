//! Arguments of `eval`.

use std::path::PathBuf;

use clap::Args;

use super::TopicArgs;
use super::parse::{parse_images, parse_shard, parse_split};
use crate::episode::Split;

/// Arguments of `eval`.
#[derive(Debug, Args)]
pub struct EvalArgs {
    /// Dataset to score on: an .mcap file or a folder of them, or the name of a sample, `pybullet` [default: the sample episodes]
    #[arg(long)]
    pub data: Option<PathBuf>,
    /// Checkpoint folder, or the scores that an earlier run left of one; repeat for several
    /// [default: every checkpoint beside the data, else the sample's]
    #[arg(long)]
    pub model: Vec<PathBuf>,
    /// The paper's protocol: `synthetic` sees 4 images and predicts 11, `mit` sees 5 and predicts 37
    #[arg(long, value_enum, default_value_t)]
    pub preset: EvalPreset,
    /// Split to score [default: test, or val where the dataset has no test split]
    #[arg(long, value_parser = parse_split)]
    pub split: Option<Split>,
    /// c, the images seen before the rollout [default: the preset's]
    #[arg(long, value_parser = parse_images)]
    pub context: Option<usize>,
    /// h, the images predicted [default: the preset's]
    #[arg(long, value_parser = parse_images)]
    pub horizon: Option<usize>,
    /// Score models under these switches and damaged inputs as well, as a state string has them:
    /// `alpha=haptic:0` or `corrupt=vision:noise:0.5`; repeat for several
    #[arg(long, value_name = "STATE")]
    pub state: Vec<String>,
    /// Fit the pose regressors anew on the training split of this dataset, instead of taking the checkpoints'
    #[arg(long, value_name = "DATA")]
    pub fit: Option<PathBuf>,
    /// Folder for scores, tables and figures; a run that was stopped goes on from what it holds
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Score only every n-th episode, from the i-th on: `2/4`; the scores go to --out
    #[arg(long, value_name = "I/N", value_parser = parse_shard, requires = "out", conflicts_with = "merge")]
    pub shard: Option<(usize, usize)>,
    /// Score nothing, sum up what shards have left in --out
    #[arg(long, requires = "out")]
    pub merge: bool,
    /// Print JSON instead of Markdown tables
    #[arg(long)]
    pub json: bool,
    /// Where the dataset has its roles.
    #[command(flatten)]
    pub mapping: TopicArgs,
}

/// How much is seen and predicted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum EvalPreset {
    /// 4 and 11.
    #[default]
    Synthetic,
    /// 5 and 37.
    Mit,
}
