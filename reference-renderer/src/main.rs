//! `srbf`: fits, inspects, renders and compares materials. Without a command it does the main job on embedded defaults.

// First, so that its macros take the place of the standard library's in all that follows.
#[macro_use]
mod print;

#[cfg(test)]
mod agreement;
mod ball;
mod ball_sheet;
mod camera;
mod cast;
mod command;
mod comparison;
mod environment;
mod figures;
mod film;
mod fit_sheet;
mod furnace;
mod integrator;
mod intersect;
mod material;
mod measured;
mod mesh;
mod networks;
mod output;
mod page;
mod panel;
mod picture_file;
mod plot;
mod points;
mod progress;
mod random;
mod ray;
mod render;
mod report;
mod sampling;
mod scene;
mod settings;
mod shader;
#[cfg(test)]
mod sphere_sampling;
mod stability;
mod teapot;
mod truth;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = command::Cli::try_parse().unwrap_or_else(|error| {
        // Help and version go to standard output; clap's own way passes over a failure there.
        let written = error.print();
        if !error.use_stderr() {
            print::or_end(written);
        }
        std::process::exit(error.exit_code())
    });
    match command::run(cli) {
        Ok(()) => {
            print::flush();
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("srbf: {error:#}");
            ExitCode::from(2)
        }
    }
}
