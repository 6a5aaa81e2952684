//! The inputs of a command: every file that its arguments name, but for those of [`OUTPUTS`]. So no command can forget one.

use crate::out::output;
use crate::truth::networks::Networks;
use clap::{Arg, ArgMatches, Command};
use srbf_fit::analytic;
use std::any::TypeId;
use std::ffi::OsStr;
use std::path::PathBuf;

/// The arguments that name files to write, of all commands. Those that name folders need not stand here: no output replaces a folder.
pub const OUTPUTS: [&str; 3] = ["output", "picture", "csv"];

/// The arguments of a command that may name files to read: paths, and texts but for those whose value is called `NAME`.
pub fn arguments(command: &Command) -> impl Iterator<Item = &Arg> {
    command.get_arguments().filter(|argument| {
        let of = argument.get_value_parser().type_id();
        let is_name = argument.get_value_names().is_some_and(|names| names == ["NAME"]);
        (of == TypeId::of::<PathBuf>() || of == TypeId::of::<String>() && !is_name)
            && !OUTPUTS.contains(&argument.get_id().as_str())
    })
}

/// Registers the files that a command line names.
pub fn keep(command: &Command, matches: &ArgMatches) {
    for argument in arguments(command) {
        // Not there: an argument of help.
        let values = matches.try_get_raw(argument.get_id().as_str()).ok().flatten();
        values.into_iter().flatten().flat_map(files).for_each(output::keep_input);
    }
    let below = matches.subcommand().map(|(name, matches)| (command.find_subcommand(name), matches));
    if let Some((Some(command), matches)) = below {
        keep(command, matches);
    }
}

/// The files that a value may name: itself; `FILE` of `FILE:PART`, with the names of networks beside it; the file that a model reads.
fn files(value: &OsStr) -> Vec<PathBuf> {
    let mut files = vec![PathBuf::from(value)];
    if let Some(text) = value.to_str() {
        if let Some((file, _)) = text.rsplit_once(':') {
            files.extend([file.into(), Networks::names_beside(file.as_ref())]);
        }
        files.extend(analytic::files_of(text));
    }
    files
}
