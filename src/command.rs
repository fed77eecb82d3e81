//! One `run` per command: opens files, starts threads, joins the parts.

pub mod eval;
pub mod export;
pub mod info;
pub mod open;
pub mod sample;
pub mod serve;
pub mod simulate;
#[cfg(feature = "rerun")]
pub mod stream;
pub mod train;
pub mod view;

use std::io::{self, ErrorKind, Write};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::{Cli, Command};

/// A bar of so many, on standard error where that is a terminal.
fn progress_bar(len: usize, template: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(template);
    let bar = ProgressBar::new(len as u64);
    bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Runs what the command line asks for.
pub fn dispatch(cli: Cli) -> anyhow::Result<()> {
    if let (None, Some(path)) = (&cli.command, &cli.view.path)
        && !sample::data(Some(path))?.exists()
    {
        bail!(
            "{}: neither a command nor a dataset that is there; `poescope --help` lists the commands",
            path.display()
        );
    }
    match cli.command.unwrap_or(Command::View(cli.view)) {
        Command::View(args) => view::run(&args),
        Command::Serve(args) => serve::run(args),
        Command::Info(args) => info::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Train(args) => train::run(&args),
        Command::Eval(args) => eval::run(&args),
        Command::Export(args) => export::run(&args),
    }
}

/// Writes to standard output. A reader that has seen enough, like `head`, is no error.
fn say(text: &str) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(error).context("writing to standard output")
        }
        _ => Ok(()),
    }
}

/// A line for the user beside what a command prints. Nobody may be listening any more: Ctrl-C ends `| tee log` first.
fn note(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Ctrl-C and SIGTERM ask for a stop; the second one ends the process at once.
fn stop_on_signals() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register_conditional_shutdown(signal, 130, Arc::clone(&stop))?;
        signal_hook::flag::register(signal, Arc::clone(&stop))?;
    }
    Ok(stop)
}
