//! Arguments of `view` and `serve`.

use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;

use clap::Args;

use super::TopicArgs;
use super::parse::{parse_host, parse_order, parse_size};
use crate::measure::failure::Order;

/// Where a Rerun viewer listens unless it was told otherwise.
const RERUN_VIEWER: &str = "rerun+http://127.0.0.1:9876/proxy";

/// Arguments of `view`.
#[derive(Clone, Debug, Default, Args)]
#[expect(clippy::struct_excessive_bools, reason = "flags of a command line")]
pub struct ViewArgs {
    /// The same as --data
    #[arg(value_name = "DATA", conflicts_with = "data")]
    pub path: Option<PathBuf>,
    /// Dataset: an .mcap file or a folder of them, or the name of a sample, `pybullet` [default: the sample episodes]
    #[arg(long)]
    pub data: Option<PathBuf>,
    /// Checkpoint folder; repeat for several models [default: the sample model]
    #[arg(long)]
    pub model: Vec<PathBuf>,
    /// State string to start from, as copied with `y`
    #[arg(long)]
    pub state: Option<String>,
    /// Keys to send first, from the first step on: plain characters, names in angle brackets (`<space>`), blanks ignored
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
    /// The same as --data
    #[arg(value_name = "DATA", conflicts_with = "data")]
    pub path: Option<PathBuf>,
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
