//! The command line: one file a command.

mod argument;
pub mod ball;
pub mod bench_report;
pub mod compare;
mod default_job;
pub mod figures;
pub mod fit;
pub mod inspect;
pub mod judge;
pub mod leave_out;
pub mod plot;
pub mod presets;
pub mod render;
pub mod samples;
pub mod stability;
pub mod thesis_table;
mod view_table;

use anyhow::Context;
use clap::{Parser, Subcommand};
use srbf_core::Level;
use std::path::PathBuf;

/// Fits measured BRDFs with spherical Gaussian lobes, renders and compares them.
///
/// Without a command: renders a preset on two scenes, compares samplers, and writes pictures and a report to `out/`.
#[derive(Debug, Parser)]
#[command(name = "srbf", version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Folder that is written to when no command is given
    #[arg(long, default_value = "out", value_name = "DIR")]
    out: PathBuf,
}

#[derive(Debug, Subcommand)]
enum Command {
    Fit(Box<fit::Args>),
    Presets(presets::Args),
    Inspect(inspect::Args),
    Judge(judge::Args),
    LeaveOut(leave_out::Args),
    Render(render::Args),
    Plot(plot::Args),
    Ball(ball::Args),
    Compare(Box<compare::Args>),
    Samples(samples::Args),
    Figures(figures::Args),
    Stability(stability::Args),
    ThesisTable(thesis_table::Args),
    BenchReport(bench_report::Args),
}

/// Runs what the command line asks for.
pub fn run(cli: Cli) -> anyhow::Result<()> {
    choose_level()?;
    match cli.command {
        None => default_job::run(&cli.out),
        Some(Command::Fit(args)) => fit::run(*args),
        Some(Command::Presets(args)) => presets::run(args),
        Some(Command::Inspect(args)) => inspect::run(args),
        Some(Command::Judge(args)) => judge::run(args),
        Some(Command::LeaveOut(args)) => leave_out::run(args),
        Some(Command::Render(args)) => render::run(args),
        Some(Command::Plot(args)) => plot::run(args),
        Some(Command::Ball(args)) => ball::run(args),
        Some(Command::Compare(args)) => compare::run(&args),
        Some(Command::Samples(args)) => samples::run(args),
        Some(Command::Figures(args)) => figures::run(&args),
        Some(Command::Stability(args)) => stability::run(args),
        Some(Command::ThesisTable(args)) => thesis_table::run(args),
        Some(Command::BenchReport(args)) => bench_report::run(args),
    }
}

/// The instruction set that the environment variable `SRBF_SIMD` names, if it is set; for tests and comparisons.
fn choose_level() -> anyhow::Result<()> {
    let Some(name) = std::env::var_os("SRBF_SIMD") else { return Ok(()) };
    let name = name.to_string_lossy();
    let known = || Level::ALL.map(Level::name).join(", ");
    let level = Level::from_name(&name)
        .with_context(|| format!("SRBF_SIMD is \"{name}\", expected one of {}", known()))?;
    level.set().with_context(|| format!("SRBF_SIMD is \"{name}\""))
}
