//! Files that are whole or absent: written under a temporary name, then renamed.

use anyhow::{Context, ensure};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

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
        let temporary = path.with_file_name(temporary_name(path));
        std::fs::write(&temporary, bytes)
            .and_then(|()| std::fs::rename(&temporary, path))
            .inspect_err(|_| drop(std::fs::remove_file(&temporary)))
    };
    put().with_context(|| format!("cannot write {}", path.display()))
}

/// Refuses a name that ends in another extension: what is written beside the file has its name with another ending.
///
/// # Errors
/// Names the file and the extension.
pub fn check_extension(path: &Path, extension: &str) -> anyhow::Result<()> {
    let fits = path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    ensure!(fits, "output {}: a name that ends in .{extension} is expected", path.display());
    Ok(())
}

/// Finds out, before a long work, whether a file can be written; leaves nothing behind.
///
/// # Errors
/// Names the file.
pub fn check_place(path: &Path) -> anyhow::Result<()> {
    let put = || {
        ensure!(!path.is_dir(), "it is a folder");
        // Folders that are missing will be made; what counts is where the first of them would lie.
        let above = path.ancestors().skip(1).find(|folder| folder.as_os_str().is_empty() || folder.exists());
        let probe: PathBuf = above.unwrap_or(Path::new("")).join(temporary_name(path));
        std::fs::write(&probe, [])?;
        Ok(std::fs::remove_file(&probe)?)
    };
    put().with_context(|| format!("cannot write {}", path.display()))
}

/// A name that no other program uses at the same time.
fn temporary_name(path: &Path) -> OsString {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.tmp", std::process::id()));
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_checked_without_a_trace() {
        let folder = std::env::temp_dir().join(format!("srbf-output-{}", std::process::id()));
        std::fs::create_dir(&folder).unwrap();
        check_place(&folder.join("a.png")).unwrap();
        check_place(&folder.join("not/yet/there/a.png")).unwrap();
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
        assert!(check_place(&folder).is_err());
        std::fs::write(folder.join("file"), "").unwrap();
        let error = format!("{:#}", check_place(&folder.join("file/a.png")).unwrap_err());
        assert!(error.contains("file/a.png"), "{error}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
