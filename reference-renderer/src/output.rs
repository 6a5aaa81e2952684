//! Standard output, and files that are whole or absent: written under a temporary name, then renamed.

use anyhow::Context;
use std::fmt;
use std::io::{self, Write};
use std::path::Path;

/// Prints to standard output. Ends the program if that cannot be: quietly if its reader has gone (`srbf ... | head`), otherwise with
/// the reason and status 2.
pub fn print(text: fmt::Arguments<'_>) {
    if let Err(error) = io::stdout().write_fmt(text) {
        if error.kind() == io::ErrorKind::BrokenPipe {
            std::process::exit(0);
        }
        eprintln!("srbf: standard output: {error}");
        std::process::exit(2);
    }
}

/// Writes a file, with the folders above it; replaces what was there in one step.
///
/// # Errors
/// Names the file.
pub fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let put = || {
        if let Some(folder) = path.parent().filter(|p| !p.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder)?;
        }
        // In the same folder, so that the rename stays within one file system.
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.tmp", std::process::id()));
        let temporary = path.with_file_name(name);
        std::fs::write(&temporary, bytes)
            .and_then(|()| std::fs::rename(&temporary, path))
            .inspect_err(|_| drop(std::fs::remove_file(&temporary)))
    };
    put().with_context(|| format!("cannot write {}", path.display()))
}
