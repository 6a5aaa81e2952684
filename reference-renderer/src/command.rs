//! The command line: one file a command.

pub mod argument;
pub mod ball;
pub mod compare;
mod convention_args;
mod convert;
mod default_job;
mod export;
pub mod fit;
mod fit_page;
pub mod inputs;
pub mod inspect;
mod join;
pub mod judge;
pub mod look;
mod pack;
mod pages;
pub mod plot;
pub mod render;
pub mod view;
mod view_table;

use crate::out::{output, print};
use anyhow::{Context, ensure};
use clap::{Parser, Subcommand};
use srbf_core::Level;
use std::path::PathBuf;
use std::process::ExitCode;

/// Fits measured BRDFs with spherical Gaussian lobes, renders and compares them.
///
/// Without a command: renders a preset on two scenes, compares samplers, and writes pictures and a report to `out/`.
#[derive(Debug, Parser)]
#[command(
    name = "srbf",
    version,
    after_help = "Completions for a shell: srbf completions SHELL. Manual pages: srbf man DIR."
)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Folder that is written to when no command is given [default: out]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints nothing but errors
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Overwrites files that srbf did not write
    #[arg(long, global = true)]
    force: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    Fit(Box<fit::Args>),
    Convert(convert::Args),
    Export(export::Args),
    Pack(Box<pack::Args>),
    Join(Box<join::Args>),
    Inspect(inspect::Args),
    Look(look::Args),
    Judge(judge::Args),
    Render(render::Args),
    Plot(plot::Args),
    Ball(ball::Args),
    Compare(Box<compare::Args>),
    View(view::Args),
    #[command(hide = true)]
    Completions(pages::Completions),
    #[command(hide = true)]
    Man(pages::Man),
}

/// Reads the command line and runs its command. The exit status is 0, or 2 after an error, which is written behind `name`.
pub fn program<C: Parser>(name: &str, run: impl FnOnce(C) -> anyhow::Result<()>) -> ExitCode {
    let mut command = C::command();
    let parsed = command.try_get_matches_from_mut(std::env::args_os()).and_then(|matches| {
        inputs::keep(&command, &matches);
        C::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
    });
    let cli = parsed.unwrap_or_else(|error| {
        // Help and version go to standard output.
        let text = print::clap_text::<C>(&error);
        let text = text.trim_end_matches('\n');
        if error.use_stderr() {
            eprintln!("{text}");
        } else {
            println!("{text}");
            print::flush();
        }
        std::process::exit(error.exit_code())
    });
    match start().and_then(|()| run(cli)) {
        Ok(()) => {
            print::flush();
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{name}: {}", print::error_line(&error));
            ExitCode::from(2)
        }
    }
}

/// Runs the command.
pub fn run(cli: Cli) -> anyhow::Result<()> {
    if cli.quiet {
        print::be_quiet();
    }
    if !cli.force {
        output::keep_others();
    }
    ensure!(cli.command.is_none() || cli.out.is_none(), "--out: only where no command is given");
    match cli.command {
        None => default_job::run(&cli.out.unwrap_or_else(|| PathBuf::from("out"))),
        Some(Command::Fit(args)) => fit::run(*args),
        Some(Command::Convert(args)) => convert::run(args),
        Some(Command::Export(args)) => export::run(&args),
        Some(Command::Pack(args)) => pack::run(&args),
        Some(Command::Join(args)) => join::run(&args),
        Some(Command::Inspect(args)) => inspect::run(args),
        Some(Command::Look(args)) => look::run(&args),
        Some(Command::Judge(args)) => judge::run(args),
        Some(Command::Render(args)) => render::run(args),
        Some(Command::Plot(args)) => plot::run(args),
        Some(Command::Ball(args)) => ball::run(args),
        Some(Command::Compare(args)) => compare::run(&args),
        Some(Command::View(args)) => view::run(&args),
        Some(Command::Completions(args)) => pages::completions(args),
        Some(Command::Man(args)) => pages::man(args),
    }
}

/// Bytes of memory of any command, beside those of its table and its picture.
const WORK: u64 = 64_000_000;

/// Little memory is an error before threads have taken some. Where rayon would panic, as it cannot start its threads, one thread does the
/// work: this one, where there is no other. The environment variable `SRBF_SIMD` names the instruction set, if it is set; for tests and
/// comparisons.
fn start() -> anyhow::Result<()> {
    srbf_fit::check_memory(WORK)?;
    let threads = |count| rayon::ThreadPoolBuilder::new().num_threads(count);
    if threads(0).build().is_err() {
        let is_there = threads(1).build().is_ok();
        let one = if is_there { threads(1) } else { threads(1).use_current_thread() };
        one.build_global()?;
    }
    let Some(name) = std::env::var_os("SRBF_SIMD") else { return Ok(()) };
    let name = name.to_string_lossy();
    let known = || Level::ALL.map(Level::name).join(", ");
    let level = Level::from_name(&name)
        .with_context(|| format!("SRBF_SIMD is \"{name}\", expected one of {}", known()))?;
    level.set().with_context(|| format!("SRBF_SIMD is \"{name}\""))
}
