//! Standard output and standard error, through `print!`, `println!` and `eprintln!` of our own: those of the standard library
//! panic where nothing can be written.
//!
//! A reader that has gone (`srbf inspect FILE | head -1`) ends the program without a word, with the status 141 that shells give for
//! that signal: 0 would say that the files were written. Any other failure is an error like all others, with status 2.
//!
//! Both are behind the border for text: the text of a stranger, in a file, a name or an argument, reaches no terminal unchanged. A line
//! end within a name would pass here, as lines are ended here too: [`shown`] is for names of files.
//!
//! `--quiet` leaves standard output empty: [`be_quiet`].
//!
//! On a terminal, lines are broken at spaces to its width. `COLUMNS` in the environment sets another one, wherever the text goes. Data, such as
//! JSON, are not broken: [`data`].

use crate::out::wrap::wrapped;
use console::Term;
use srbf_core::{printable, printable_lines};
use std::fmt::Arguments;
use std::io::{Error, ErrorKind, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Status of a program that wrote to a pipe that nobody reads: 128 and the number of SIGPIPE.
const BROKEN_PIPE: i32 = 141;

#[macro_export]
macro_rules! print {
    ($($text:tt)*) => { $crate::out::print::to_output(format_args!($($text)*)) };
}

#[macro_export]
macro_rules! println {
    () => { $crate::print!("\n") };
    ($($text:tt)*) => { $crate::print!("{}\n", format_args!($($text)*)) };
}

#[macro_export]
macro_rules! eprintln {
    ($($text:tt)*) => { $crate::out::print::to_error(format_args!($($text)*)) };
}

/// Whether nothing but errors is written.
static QUIET: AtomicBool = AtomicBool::new(false);

/// From here on, nothing but errors is written.
pub fn be_quiet() {
    QUIET.store(true, Relaxed);
}

/// Whether nothing but errors is written.
pub fn is_quiet() -> bool {
    QUIET.load(Relaxed)
}

/// Columns of help that goes to no terminal.
const HELP: usize = 100;

/// Fewest columns that lines are broken to.
const NARROWEST: usize = 20;

/// The columns of a stream: those of `COLUMNS`, or of its terminal.
fn columns(of: &'static OnceLock<Option<usize>>, terminal: fn() -> Term) -> Option<usize> {
    *of.get_or_init(|| {
        let set = std::env::var("COLUMNS").ok().and_then(|text| text.trim().parse().ok());
        let found = || terminal().size_checked().map(|(_, columns)| usize::from(columns));
        set.or_else(found).map(|columns: usize| columns.max(NARROWEST))
    })
}

fn output_columns() -> Option<usize> {
    static COLUMNS: OnceLock<Option<usize>> = OnceLock::new();
    columns(&COLUMNS, Term::stdout)
}

fn error_columns() -> Option<usize> {
    static COLUMNS: OnceLock<Option<usize>> = OnceLock::new();
    columns(&COLUMNS, Term::stderr)
}

/// Text with visible characters alone, in lines of a width.
fn lines(text: &str, columns: Option<usize>) -> String {
    let text = printable_lines(text);
    columns.map_or_else(|| text.to_string(), |columns| wrapped(&text.to_string(), columns))
}

/// Writes to standard output; ends the program where that fails.
pub fn to_output(text: Arguments<'_>) {
    if !is_quiet() {
        or_end(write!(std::io::stdout(), "{}", lines(&text.to_string(), output_columns())));
    }
}

/// Writes text for a program to read, whose lines stay as they are, to standard output.
pub fn data(text: &str) {
    if !is_quiet() {
        or_end(write!(std::io::stdout(), "{}", printable_lines(text)));
    }
}

/// Writes a line to standard error; there is nobody to tell if that fails.
pub fn to_error(line: Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{}", lines(&line.to_string(), error_columns()));
}

/// The ending of a file's name, in small letters; empty without one.
pub fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

/// The name of a file, in one line of visible characters.
pub fn shown(path: impl AsRef<Path>) -> String {
    printable(&path.as_ref().to_string_lossy()).to_string()
}

/// An error with its causes, in one line of visible characters.
pub fn error_line(error: &anyhow::Error) -> String {
    printable(&format!("{error:#}")).to_string()
}

/// What clap says of the command line, the arguments in it as they may be shown.
///
/// The line is read once more with visible characters alone: clap leaves escapes out of its quotations, so that no argument can be
/// found in its text, and a line end within one would look like lines of its own.
pub fn clap_text<C: clap::Parser>(error: &clap::Error) -> String {
    let visible = std::env::args_os().map(|argument| printable(&argument.to_string_lossy()).to_string());
    let text = match C::try_parse_from(visible) {
        Err(error) => error.render().to_string(),
        Ok(_) => printable(&error.render().to_string()).to_string(),
    };
    let columns = if error.use_stderr() { error_columns() } else { output_columns() };
    wrapped(&text, columns.unwrap_or(HELP))
}

/// Writes what standard output still holds back.
pub fn flush() {
    or_end(std::io::stdout().flush());
}

/// Ends the program if standard output could not be written.
pub fn or_end(written: Result<(), Error>) {
    let Err(error) = written else { return };
    if error.kind() == ErrorKind::BrokenPipe {
        std::process::exit(BROKEN_PIPE);
    }
    eprintln!("srbf: cannot write to standard output: {error}");
    std::process::exit(2);
}
