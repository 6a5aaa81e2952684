//! The command line: one file a command.

mod argument;
pub mod ball;
pub mod compare;
mod convert;
mod default_job;
pub mod figures;
pub mod fit;
mod fit_page;
pub mod inspect;
pub mod judge;
pub mod plot;
mod project;
pub mod render;
mod view_table;

use crate::out::print;
use anyhow::{Context, ensure};
use clap::{Parser, Subcommand};
use srbf_core::Level;
use std::path::PathBuf;

/// Fits measured BRDFs with spherical Gaussian lobes, renders and compares them.
///
/// Without a command: renders a preset on two scenes, compares samplers, and writes pictures and a report to `out/`.
#[derive(Debug, Parser)]
#[command(name = "srbf", version)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Folder that is written to when no command is given [default: out]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints nothing but errors
    #[arg(long, short, global = true)]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    Fit(Box<fit::Args>),
    Convert(convert::Args),
    Inspect(inspect::Args),
    Judge(judge::Args),
    Render(render::Args),
    Plot(plot::Args),
    Ball(ball::Args),
    Compare(Box<compare::Args>),
    Figures(figures::Args),
    /// Tables, figures and presets of the project itself; completions and manual pages
    #[command(subcommand)]
    Project(project::Command),
}

/// Runs what the command line asks for.
pub fn run(cli: Cli) -> anyhow::Result<()> {
    choose_level()?;
    if cli.quiet {
        print::be_quiet();
    }
    ensure!(cli.command.is_none() || cli.out.is_none(), "--out: only where no command is given");
    match cli.command {
        None => default_job::run(&cli.out.unwrap_or_else(|| PathBuf::from("out"))),
        Some(Command::Fit(args)) => fit::run(*args),
        Some(Command::Convert(args)) => convert::run(args),
        Some(Command::Inspect(args)) => inspect::run(args),
        Some(Command::Judge(args)) => judge::run(args),
        Some(Command::Render(args)) => render::run(args),
        Some(Command::Plot(args)) => plot::run(args),
        Some(Command::Ball(args)) => ball::run(args),
        Some(Command::Compare(args)) => compare::run(&args),
        Some(Command::Figures(args)) => figures::run(&args),
        Some(Command::Project(command)) => project::run(command),
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
