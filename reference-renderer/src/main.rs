//! `srbf`: fits, inspects, renders and compares materials. Without a command it does the main job on embedded defaults.

/// `println!` and `print!` of the whole program: where nobody reads what it prints any more, it ends quietly in place of a panic.
macro_rules! println {
    () => { $crate::output::print(format_args!("\n")) };
    ($($text:tt)*) => { $crate::output::print(format_args!("{}\n", format_args!($($text)*))) };
}
macro_rules! print {
    ($($text:tt)*) => { $crate::output::print(format_args!($($text)*)) };
}

mod camera;
mod command;
mod comparison;
mod discrete;
mod environment;
mod film;
mod furnace;
mod integrator;
mod intersect;
mod material;
mod mesh;
mod output;
mod picture_file;
mod plot;
mod progress;
mod random;
mod render;
mod report;
mod scene;
mod sphere_sampling;
mod stability;
mod teapot;

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
