//! The command line: the doc comments here are the help.

use std::net::{IpAddr, SocketAddr};
use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::data::Role;
use crate::episode::Split;
use crate::measure::failure::Order;
use crate::model::config::Preset;

/// Where a Rerun viewer listens unless it was told otherwise.
const RERUN_VIEWER: &str = "rerun+http://127.0.0.1:9876/proxy";

/// Look inside a product-of-experts fusion.
///
/// Without a command, opens the sample episodes and the trained model that ship with it.
#[derive(Debug, Parser)]
#[command(version, about, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// What to do; `view` if left out.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The arguments of `view`, so that it can be left out.
    #[command(flatten)]
    pub view: ViewArgs,
}

/// What poescope can do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Open a model on a dataset in the terminal
    View(ViewArgs),
    /// Open the same in a browser
    Serve(ServeArgs),
    /// List a dataset: episodes, topics, types, rates, and what was left out
    Info(InfoArgs),
    /// Record planar pushes in simulation as a dataset
    Simulate(SimulateArgs),
    /// Train a model on a dataset
    Train(TrainArgs),
    /// Score a model's open-loop prediction against trivial predictors
    Eval(EvalArgs),
    /// Write what a model makes of episodes as a file for other tools
    Export(ExportArgs),
}

/// Arguments of `view`.
#[derive(Clone, Debug, Default, Args)]
#[expect(clippy::struct_excessive_bools, reason = "flags of a command line")]
pub struct ViewArgs {
    /// Dataset: an .mcap file or a folder of them, or the name of a sample, `pybullet` [default: the sample episodes]
    #[arg(long)]
    pub data: Option<PathBuf>,
    /// Checkpoint folder; repeat for several models [default: the sample model]
    #[arg(long)]
    pub model: Vec<PathBuf>,
    /// State string to start from, as copied with `y`
    #[arg(long)]
    pub state: Option<String>,
    /// Keys to send first: plain characters, names in angle brackets (`<space>`), blanks ignored
    #[arg(long)]
    pub keys: Option<String>,
    /// Draw one frame to standard output and exit
    #[arg(long)]
    pub print: bool,
    /// Print what the frame says as text instead, a labelled fact a line, for scripts and screen readers
    #[arg(long, conflicts_with = "json")]
    pub plain: bool,
    /// Print everything the frame is drawn from as JSON instead; only the rows of all decoded frames (`strip`) are
    /// left out, and numbers that are not finite are null
    #[arg(long)]
    pub json: bool,
    /// Size of the printed frame, in columns x rows
    #[arg(long, default_value = "80x24", value_parser = parse_size)]
    pub size: (u16, u16),
    /// How to draw images: `auto` asks the terminal
    #[arg(long, value_enum, default_value_t)]
    pub images: ImageProtocol,
    /// Print the episodes ranked by how badly the model does on them, the worst first, a line each with tabs between
    #[arg(long, conflicts_with_all = ["json", "plain"])]
    pub failures: bool,
    /// What failures are ranked by: `error`, `distance`, `nees`, `conflict`, `gain` or `escape` [default: error]
    #[arg(long, value_name = "ORDER", value_parser = parse_order)]
    pub rank: Option<Order>,
    /// Let browsers look at this session too, at this address [default: 127.0.0.1:8080]
    #[arg(
        long,
        value_name = "ADDRESS",
        num_args = 0..=1,
        default_missing_value = "127.0.0.1:8080",
        conflicts_with_all = ["print", "plain", "json", "failures"]
    )]
    pub serve: Option<SocketAddr>,
    /// With --serve: browsers may only look
    #[arg(long, requires = "serve")]
    pub read_only: bool,
    /// Stream what is shown to a running Rerun viewer, at this address [default: the viewer's own]
    #[arg(
        long,
        value_name = "URL",
        num_args = 0..=1,
        default_missing_value = RERUN_VIEWER,
        conflicts_with_all = ["print", "plain", "json", "failures"]
    )]
    pub rerun: Option<String>,
    /// How many colours to use: `auto` goes by TERM, COLORTERM and NO_COLOR
    #[arg(long, value_enum, default_value_t)]
    pub color: Colors,
    /// Where the dataset has its roles.
    #[command(flatten)]
    pub mapping: TopicArgs,
}

/// Arguments of `serve`.
#[derive(Clone, Debug, Args)]
pub struct ServeArgs {
    /// Address to listen on: beyond this machine (`0.0.0.0`) a token is demanded, which is printed
    #[arg(long, default_value = "127.0.0.1", value_parser = parse_host)]
    pub host: IpAddr,
    /// Port to listen on; 0 takes a free one
    #[arg(long, default_value_t = 8080)]
    pub port: u16,
    /// Dataset: an .mcap file or a folder of them, or the name of a sample, `pybullet` [default: the sample episodes]
    #[arg(long)]
    pub data: Option<PathBuf>,
    /// Checkpoint folder; repeat for several models [default: the sample model]
    #[arg(long)]
    pub model: Vec<PathBuf>,
    /// State string to start from, as copied with `y`
    #[arg(long)]
    pub state: Option<String>,
    /// Browsers may only look
    #[arg(long)]
    pub read_only: bool,
    /// Stream what is shown to a running Rerun viewer, at this address [default: the viewer's own]
    #[arg(long, value_name = "URL", num_args = 0..=1, default_missing_value = RERUN_VIEWER)]
    pub rerun: Option<String>,
    /// Serve the page of this folder instead of the built-in one
    #[arg(long, value_name = "DIR")]
    pub web_root: Option<PathBuf>,
    /// Where the dataset has its roles.
    #[command(flatten)]
    pub mapping: TopicArgs,
}

/// Topics of a recording that names them otherwise.
#[derive(Clone, Debug, Default, Args)]
pub struct TopicArgs {
    /// Topic of a role (vision, haptic, ee_pose, ee_twist, control, object); repeat for several; wins over dataset.toml
    #[arg(long = "topic", value_name = "ROLE=TOPIC", value_parser = parse_topic)]
    pub topics: Vec<(Role, String)>,
}

/// How images reach the terminal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum ImageProtocol {
    /// Ask the terminal, and take half-blocks where it does not answer.
    #[default]
    Auto,
    /// Half-block characters.
    Halfblocks,
    /// The kitty graphics protocol.
    Kitty,
    /// Sixel graphics.
    Sixel,
    /// iTerm2's inline images.
    Iterm2,
}

/// How many colours the terminal has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Colors {
    /// As the environment says.
    #[default]
    Auto,
    /// 24 bits.
    True,
    /// The 256 indexed ones.
    #[value(name = "256")]
    Indexed,
    /// The terminal's own 16.
    #[value(name = "16")]
    Sixteen,
    /// None: letters and fills say everything.
    Never,
}

/// Arguments of `info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// An .mcap file or a folder of them
    pub path: PathBuf,
    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
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

/// Arguments of `train`.
#[derive(Debug, Args)]
pub struct TrainArgs {
    /// Dataset: an .mcap file or a folder of them
    #[arg(long)]
    pub data: PathBuf,
    /// Which model: `v`, `vp`, `vh`, `vhp`, `vhp-c` or `v-h-p`
    #[arg(long, default_value = "v-h-p")]
    pub model: String,
    /// How to train it: `paper`, `released` (the authors' script) or `fast` (an hour on two cores)
    #[arg(long, default_value = "fast", value_parser = parse_preset)]
    pub preset: Preset,
    /// One key of the config, over the preset's; repeat for several: `--set training.batch=8` (docs/training.md)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Run folder: checkpoints, metrics, report
    #[arg(long)]
    pub out: PathBuf,
    /// A config.toml to train instead of the model's own settings
    #[arg(long)]
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
    /// Go on from the run folder's last checkpoint
    #[arg(long)]
    pub resume: bool,
    /// Where the dataset has its roles.
    #[command(flatten)]
    pub mapping: TopicArgs,
}

/// Arguments of `eval`.
#[derive(Debug, Args)]
pub struct EvalArgs {
    /// Dataset to score on [default: the sample episodes]
    #[arg(long)]
    pub data: Option<PathBuf>,
    /// Checkpoint folder; repeat for several [default: every one beside the data, else the sample's]
    #[arg(long)]
    pub model: Vec<PathBuf>,
    /// The paper's protocol: `synthetic` sees 4 images and predicts 11, `mit` sees 5 and predicts 37
    #[arg(long, value_enum, default_value_t)]
    pub preset: EvalPreset,
    /// Split to score [default: test, or val where the dataset has no test split]
    #[arg(long, value_parser = parse_split)]
    pub split: Option<Split>,
    /// c, the images seen before the rollout [default: the preset's]
    #[arg(long)]
    pub context: Option<usize>,
    /// h, the images predicted [default: the preset's]
    #[arg(long)]
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

/// `2/4`: the second of four.
fn parse_shard(text: &str) -> Result<(usize, usize), String> {
    let shard = text
        .split_once('/')
        .and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    match shard {
        Some((i, n)) if (1..=n).contains(&i) => Ok((i, n)),
        _ => Err(format!("{text:?} is not like 2/4, the second of four")),
    }
}

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

fn parse_size(text: &str) -> Result<(u16, u16), String> {
    let parse = || {
        let (columns, rows) = text.split_once('x')?;
        Some((columns.parse().ok()?, rows.parse().ok()?))
    };
    parse()
        .filter(|&(columns, rows)| (1..=1000).contains(&columns) && (1..=1000).contains(&rows))
        .ok_or_else(|| format!("{text:?} is not COLUMNSxROWS, for example 120x40"))
}

fn parse_host(text: &str) -> Result<IpAddr, String> {
    let text = if text == "localhost" {
        "127.0.0.1"
    } else {
        text
    };
    text.parse().map_err(|_| {
        format!("{text:?} is no address of this machine, for example 127.0.0.1 or 0.0.0.0")
    })
}

fn parse_minutes(text: &str) -> Result<f64, String> {
    let minutes = text
        .parse::<f64>()
        .ok()
        .filter(|minutes| minutes.is_finite() && *minutes > 0.0);
    minutes.ok_or_else(|| format!("{text:?} is not a positive number of minutes"))
}

fn parse_preset(name: &str) -> Result<Preset, String> {
    Preset::ALL
        .into_iter()
        .find(|preset| preset.name() == name)
        .ok_or_else(|| format!("there are {}", Preset::ALL.map(Preset::name).join(", ")))
}

/// Up to a month; 0 is after every update.
fn parse_interval(text: &str) -> Result<f64, String> {
    let minutes = text.parse::<f64>().ok();
    minutes
        .filter(|minutes| (0.0..=43_200.0).contains(minutes))
        .ok_or_else(|| format!("{text:?} is not a number of minutes from 0 to 43200"))
}

fn parse_bytes(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, u64); 3] = [("KiB", 1 << 10), ("MiB", 1 << 20), ("GiB", 1 << 30)];
    let unit = UNITS
        .into_iter()
        .find_map(|(unit, bytes)| Some((text.strip_suffix(unit)?, bytes)));
    let (number, unit) = unit.unwrap_or((text, 1));
    let bytes = number.trim().parse::<u64>().ok();
    bytes
        .and_then(|number| number.checked_mul(unit))
        .ok_or_else(|| format!("{text:?} is not a whole number of bytes, KiB, MiB or GiB: 2GiB"))
}

fn parse_split(text: &str) -> Result<Split, String> {
    Split::from_name(text).ok_or_else(|| format!("{text:?} is not train, val or test"))
}

/// First and last step from 1 on, as they are counted on screen.
fn parse_steps(text: &str) -> Result<RangeInclusive<usize>, String> {
    let parse = || {
        let (first, last) = text.split_once('-').unwrap_or((text, text));
        Some(first.trim().parse().ok()?..=last.trim().parse().ok()?)
    };
    parse()
        .filter(|steps: &RangeInclusive<usize>| *steps.start() > 0 && !steps.is_empty())
        .ok_or_else(|| format!("{text:?} is not FIRST-LAST, counted from 1, for example 4-9"))
}

fn parse_order(name: &str) -> Result<Order, String> {
    Order::from_name(name).ok_or_else(|| {
        let names = Order::ALL.map(Order::name).join(", ");
        format!("there are {names}")
    })
}

fn parse_topic(text: &str) -> Result<(Role, String), String> {
    let (role, topic) = text
        .split_once('=')
        .filter(|(_, topic)| !topic.is_empty())
        .ok_or_else(|| format!("{text:?} is not ROLE=TOPIC, for example vision=/camera/image"))?;
    let role = Role::from_name(role).ok_or_else(|| {
        let names = Role::ALL.map(Role::name).join(", ");
        format!("there is no role {role:?}, only {names}")
    })?;
    Ok((role, topic.to_owned()))
}
