//! Parse, dispatch, print what went wrong, exit.

use std::process::ExitCode;

use clap::Parser;
use poescope::cli::Cli;

fn main() -> ExitCode {
    match poescope::command::dispatch(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("poescope: {error:#}");
            ExitCode::FAILURE
        }
    }
}
