//! Writing a file so that it is never there half.

use crate::FitError;
use std::path::Path;

/// Writes bytes under a temporary name in the same folder, which is made if need be, and renames the file.
///
/// # Errors
/// [`FitError::Io`] with the path; the temporary file is removed then.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FitError> {
    if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(FitError::io(folder))?;
    }
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", std::process::id()));
    let temporary = path.with_file_name(name);
    let written = std::fs::write(&temporary, bytes).and_then(|()| std::fs::rename(&temporary, path));
    if written.is_err() {
        // The reason of the failure is the one to report.
        let _ = std::fs::remove_file(&temporary);
    }
    written.map_err(FitError::io(path))
}
