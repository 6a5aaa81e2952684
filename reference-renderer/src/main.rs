//! `srbf`: fits, inspects, renders and compares materials. Without a command it does the main job on embedded defaults.

// First, so that its macros take the place of the standard library's in all that follows.
#[macro_use]
mod out;

mod command;
mod numbers;
mod shade;
mod show;
mod study;
mod trace;
mod truth;
mod world;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = command::Cli::try_parse().unwrap_or_else(|error| {
        // Help and version go to standard output; clap's own way passes over a failure there.
        let written = error.print();
        if !error.use_stderr() {
            out::print::or_end(written);
        }
        std::process::exit(error.exit_code())
    });
    match command::run(cli) {
        Ok(()) => {
            out::print::flush();
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("srbf: {error:#}");
            ExitCode::from(2)
        }
    }
}
