//! `srbf`: fits, inspects, renders and compares materials. Without a command it does the main job on embedded defaults.

mod command;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    // clap prints its own errors and exits with status 2, as we do.
    match command::run(command::Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("srbf: {error:#}");
            ExitCode::from(2)
        }
    }
}
