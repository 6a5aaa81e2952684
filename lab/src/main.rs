//! `srbf-lab`: the tool of this project alone. It makes the presets, and measures the figures of the documents.
//!
//! Run it by `cargo lab COMMAND`. It is never installed or published.

// These take the place of the standard library's, which panic where nothing can be written.
#[macro_use(print, println)]
extern crate srbf_reference_renderer;

mod any_light;
mod baselines;
mod bench_report;
mod equal_time;
mod figures;
mod forms;
mod good_inputs;
#[cfg(test)]
mod imagined;
mod leave_out;
mod made_tables;
mod presets;
mod residuals;
mod samples;
mod slice;
mod spectra;
mod stability;
mod stated;
mod survey;
mod thesis_table;
mod turns;
mod verdicts;
mod web;

use clap::{Parser, Subcommand};
use srbf_reference_renderer::command::program;
use srbf_reference_renderer::out::print;
use std::process::ExitCode;

/// Makes the presets of srbf, and measures what its documents say.
#[derive(Debug, Parser)]
#[command(name = "srbf-lab", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Prints nothing but errors
    #[arg(long, short, global = true)]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    Presets(presets::Args),
    Survey(Box<survey::Args>),
    Figures(figures::Args),
    GoodInputs(good_inputs::Args),
    ThesisTable(thesis_table::Args),
    Turns(turns::Args),
    Forms(forms::Args),
    AnyLight(any_light::Args),
    Baselines(baselines::Args),
    EqualTime(equal_time::Args),
    Stability(stability::Args),
    Stated(stated::Args),
    LeaveOut(leave_out::Args),
    MadeTables(made_tables::Args),
    Samples(samples::Args),
    Slice(slice::Args),
    Spectra(spectra::Args),
    Verdicts(verdicts::Args),
    Residuals(residuals::Args),
    BenchReport(bench_report::Args),
    Web(web::Args),
}

fn main() -> ExitCode {
    program("srbf-lab", |cli: Cli| {
        if cli.quiet {
            print::be_quiet();
        }
        match cli.command {
            Command::Presets(args) => presets::run(args),
            Command::Survey(args) => survey::run(*args),
            Command::Figures(args) => figures::run(&args),
            Command::GoodInputs(args) => good_inputs::run(&args),
            Command::ThesisTable(args) => thesis_table::run(args),
            Command::Turns(args) => turns::run(&args),
            Command::Forms(args) => forms::run(&args),
            Command::AnyLight(args) => any_light::run(&args),
            Command::Baselines(args) => baselines::run(&args),
            Command::EqualTime(args) => equal_time::run(&args),
            Command::Stability(args) => stability::run(args),
            Command::Stated(args) => stated::run(&args),
            Command::LeaveOut(args) => leave_out::run(args),
            Command::MadeTables(args) => made_tables::run(&args),
            Command::Samples(args) => samples::run(args),
            Command::Slice(args) => slice::run(args),
            Command::Spectra(args) => spectra::run(&args),
            Command::Verdicts(args) => verdicts::run(&args),
            Command::Residuals(args) => residuals::run(&args),
            Command::BenchReport(args) => bench_report::run(args),
            Command::Web(args) => web::run(&args),
        }
    })
}
