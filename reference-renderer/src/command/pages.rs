//! `srbf completions` and `srbf man`: made from the command line itself, so that they agree with it.

use crate::command::Cli;
use crate::out::output;
use crate::out::print::data;
use clap::CommandFactory;
use clap_complete::Shell;
use std::path::PathBuf;

/// Prints completions for a shell.
///
/// For example: `srbf completions bash > ~/.local/share/bash-completion/completions/srbf`.
#[derive(Debug, clap::Args)]
pub struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Writes manual pages, `srbf.1` and one for each command.
///
/// For example: `srbf man ~/.local/share/man/man1`, then `man srbf-fit`.
#[derive(Debug, clap::Args)]
pub struct Man {
    /// The folder to write to
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Prints the completions.
pub fn completions(args: Completions) -> anyhow::Result<()> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "srbf", &mut text);
    data(&String::from_utf8(text)?);
    Ok(())
}

/// Writes the pages.
pub fn man(args: Man) -> anyhow::Result<()> {
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    let pages = output::together();
    let count = write_pages(&program, &args.folder)?;
    pages.commit()?;
    println!("{count} pages in {}", crate::out::print::shown(&args.folder));
    Ok(())
}

/// Writes the page of a command and of those below it; gives their number.
fn write_pages(command: &clap::Command, folder: &std::path::Path) -> anyhow::Result<usize> {
    let name = command.get_display_name().unwrap_or(command.get_name()).to_owned();
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone()).render(&mut page)?;
    output::write(&folder.join(format!("{name}.1")), &page)?;
    let below = command.get_subcommands().filter(|below| !below.is_hide_set());
    below.map(|below| write_pages(below, folder)).sum::<anyhow::Result<usize>>().map(|pages| pages + 1)
}
