//! The command line: the doc comments here are the help.

mod data;
mod eval;
mod export;
mod parse;
mod train;
mod view;

pub use self::data::{InfoArgs, SimulateArgs, TopicArgs};
pub use self::eval::{EvalArgs, EvalPreset};
pub use self::export::{ExportArgs, ExportFormat, Figure};
pub use self::train::TrainArgs;
pub use self::view::{Colors, ImageProtocol, ServeArgs, ViewArgs};

use clap::{Parser, Subcommand};

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
    /// The paper's tables and figures: predictions and positions of models, compared on a dataset
    Eval(EvalArgs),
    /// Write what a model makes of episodes as a file for other tools
    Export(ExportArgs),
}
