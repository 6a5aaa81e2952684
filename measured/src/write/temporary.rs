//! Files under names that nobody else has, which go with their owner.
//!
//! Each is locked as long as its owner lives. One that nobody has locked was left behind by a process that was killed; the next
//! that writes into the folder takes it away.

use std::fs::{File, Permissions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Begin and end of the names.
const NAME: [&str; 2] = [".srbf-", ".part"];

/// A file that is removed when this is dropped, unless it has got another name by then.
pub(super) struct Temporary {
    /// Locked, for others to see that it is in use.
    file: File,
    pub path: PathBuf,
    is_kept: bool,
}

impl Temporary {
    /// Creates a file in the folder of another, under a name that is short whatever that is called.
    pub fn beside(path: &Path) -> io::Result<Self> {
        loop {
            let path = new_name(path);
            let file = match File::create_new(&path) {
                // What another process of this number has there is not ours.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
                created => created?,
            };
            // Where there are no locks, leftovers stay.
            let _ = file.lock();
            let temporary = Self { file, path, is_kept: false };
            // Between creation and lock it looks like a leftover, and may have been removed.
            if temporary.path.exists() {
                return Ok(temporary);
            }
        }
    }

    /// A second name, in the same folder, for a file that is there.
    pub fn second_name(path: &Path) -> io::Result<Self> {
        let name = new_name(path);
        std::fs::hard_link(path, &name)?;
        let file = File::open(&name).inspect_err(|_| drop(std::fs::remove_file(&name)))?;
        let _ = file.try_lock();
        Ok(Self { file, path: name, is_kept: false })
    }

    /// Writes the bytes, so that they are on the disk afterwards. Nobody who may not read the old bytes sees the new ones.
    pub fn fill(&mut self, bytes: &[u8], permissions: Option<&Permissions>) -> io::Result<()> {
        if let Some(permissions) = permissions {
            self.file.set_permissions(permissions.clone())?;
        }
        self.file.write_all(bytes)?;
        self.file.sync_all()
    }

    /// Gives it its name, and replaces the file that has it.
    pub fn rename(&mut self, path: &Path) -> io::Result<()> {
        std::fs::rename(&self.path, path)?;
        self.is_kept = true;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.is_kept {
            // There is nobody to tell; the next that writes here tries again.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

fn new_name(beside: &Path) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let [start, end] = NAME;
    beside.with_file_name(format!("{start}{}-{number}{end}", std::process::id()))
}

/// Removes what killed processes have left in the folder of a file.
pub(super) fn remove_leftovers(beside: &Path) {
    let folder = beside.with_file_name("");
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_named = name.to_str().is_some_and(|name| name.starts_with(NAME[0]) && name.ends_with(NAME[1]));
        // A link is not ours, nor is a pipe, which would hold whoever opens it.
        if !is_named || !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        let path = entry.path();
        let Ok(file) = File::open(&path) else { continue };
        // Held until the file is gone: its maker, who waits for the lock, then sees that it was removed.
        if file.try_lock().is_ok() {
            let _ = std::fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leftovers_go_and_what_is_in_use_or_not_ours_stays() {
        let folder = std::env::temp_dir().join(format!("srbf-leftovers-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir(&folder).unwrap();
        for name in [".srbf-1-0.part", ".srbf-99999999-3.part", "a.srbf", ".srbf-notes", "x.part"] {
            std::fs::write(folder.join(name), b"left").unwrap();
        }
        std::fs::create_dir(folder.join(".srbf-folder.part")).unwrap();
        let used = Temporary::beside(&folder.join("b.srbf")).unwrap();
        let second = Temporary::second_name(&folder.join("a.srbf")).unwrap();
        remove_leftovers(&folder.join("b.srbf"));
        assert!(used.path.exists() && second.path.exists());
        drop((used, second));
        let mut names: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, [".srbf-folder.part", ".srbf-notes", "a.srbf", "x.part"]);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
