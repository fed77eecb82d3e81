//! One `run` per command: opens files, starts threads, joins the parts.

pub mod eval;
pub mod info;
pub mod sample;
pub mod simulate;
pub mod train;
pub mod view;

use crate::cli::{Cli, Command};

/// Runs what the command line asks for.
pub fn dispatch(cli: Cli) -> anyhow::Result<()> {
    match cli.command.unwrap_or(Command::View(cli.view)) {
        Command::View(args) => view::run(args),
        Command::Info(args) => info::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Train(args) => train::run(&args),
        Command::Eval(args) => eval::run(&args),
    }
}
