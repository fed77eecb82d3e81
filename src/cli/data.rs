//! Arguments of `info` and `simulate`, and where a dataset has its roles.

use std::path::PathBuf;

use clap::Args;

use super::parse::{parse_split, parse_topic};
use crate::data::Role;
use crate::episode::Split;

/// Topics of a recording that names them otherwise.
#[derive(Clone, Debug, Default, Args)]
pub struct TopicArgs {
    /// Topic of a role (vision, haptic, ee_pose, ee_twist, control, object); repeat for several; wins over dataset.toml
    #[arg(long = "topic", value_name = "ROLE=TOPIC", value_parser = parse_topic)]
    pub topics: Vec<(Role, String)>,
}

/// Arguments of `info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Dataset: an .mcap file or a folder of them, or the name of a sample, `pybullet`
    pub path: PathBuf,
    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
    /// Also read every episode, and say what is odd about it: gaps, values that are no numbers, damage
    #[arg(long)]
    pub check: bool,
    /// Where the dataset has its roles.
    #[command(flatten)]
    pub mapping: TopicArgs,
}

/// Arguments of `simulate`.
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// How many episodes
    #[arg(long, default_value_t = 100)]
    pub episodes: usize,
    /// Seed: the same seed writes the same bytes, whatever the threads
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// The dataset to write
    #[arg(long)]
    pub out: PathBuf,
    /// Replace a file that is there
    #[arg(long)]
    pub force: bool,
    /// Split the episodes are marked with
    #[arg(long, value_parser = parse_split)]
    pub split: Option<Split>,
    /// T, the images of an episode
    #[arg(long, default_value_t = 16)]
    pub steps: usize,
    /// W, the high-rate samples between two images
    #[arg(long, default_value_t = 32)]
    pub window: usize,
    /// Rate of force, torque, position and velocity
    #[arg(long, default_value_t = 120.0)]
    pub rate_hz: f64,
    /// Record only what a planar setup senses: force x, y, torque z; position x, y (the MIT set's channels)
    #[arg(long)]
    pub planar: bool,
    /// Worker threads [default: one per core]
    #[arg(long)]
    pub threads: Option<usize>,
    /// Also write a contact sheet of the first episodes (PNG)
    #[arg(long)]
    pub sheet: Option<PathBuf>,
}
