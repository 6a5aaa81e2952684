//! The browser of the desktop.

use std::io;
use std::process::{Command, Stdio};

/// Asks the desktop to open an address, and waits for nothing.
///
/// # Errors
/// Where the program that does so is not there.
pub fn open(address: &str) -> io::Result<()> {
    let (program, before): (&str, &[&str]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("cmd", &["/C", "start", ""]),
        _ => ("xdg-open", &[]),
    };
    let mut command = Command::new(program);
    command.args(before).arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().map(drop).map_err(|error| io::Error::new(error.kind(), format!("{program}: {error}")))
}
