//! The converged picture, in two halves that do not depend on one another; kept in a file, as it takes most of the time.

use crate::out::output;
use crate::out::print::shown;
use anyhow::Context;
use glam::DVec3;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// First bytes of a file of a reference.
const MAGIC: &[u8; 16] = b"srbf reference\0\x01";

/// Bytes of the sum at the end.
const SUM: usize = 32;

/// Two pictures.
pub type Halves = [Vec<DVec3>; 2];

/// All that decides a picture, boiled down to a name.
pub struct Key(Sha256);

impl Key {
    /// Begins with the program itself: whatever changes in it may change the picture.
    ///
    /// # Errors
    /// A program that cannot be read.
    pub fn new() -> anyhow::Result<Self> {
        let read = || std::fs::read(std::env::current_exe()?);
        let program = read().context("cannot read the program that runs, to name a reference by it")?;
        let mut key = Self(Sha256::new());
        key.add(&program);
        Ok(key)
    }

    /// Adds bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    /// Adds a name, and the content of the file that it names: `FILE`, or `FILE:PART`. Other names are built in.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn add_source(&mut self, name: &str) -> anyhow::Result<()> {
        self.add(name.as_bytes());
        let before = name.rsplit_once(':').map_or(name, |parts| parts.0);
        if let Some(file) = [name, before].map(Path::new).into_iter().find(|file| file.is_file()) {
            self.add(&std::fs::read(file).with_context(|| shown(file))?);
        }
        Ok(())
    }

    /// The file in a folder.
    pub fn file(self, folder: &Path) -> PathBuf {
        let digits: String = self.0.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect();
        folder.join(format!("{digits}.reference"))
    }
}

/// Reads the halves of a picture of `pixels` pixels; `None` where there is no such file, or it is not whole.
pub fn read(path: &Path, pixels: usize) -> Option<Halves> {
    // So that a file of any size is not taken into memory.
    let expected = MAGIC.len() + 2 * 3 * 8 * pixels + SUM;
    if std::fs::metadata(path).ok()?.len() != expected as u64 {
        return None;
    }
    let bytes = std::fs::read(path).ok()?;
    let (content, sum) = bytes.split_at_checked(bytes.len().checked_sub(SUM)?)?;
    if bytes.len() != expected || Sha256::digest(content).as_slice() != sum {
        return None;
    }
    let numbers = content.strip_prefix(MAGIC)?.as_chunks::<8>().0;
    let colour = |c: &[[u8; 8]; 3]| DVec3::from(c.map(f64::from_le_bytes));
    let (first, second) = numbers.as_chunks::<3>().0.split_at(pixels);
    Some([first, second].map(|half| half.iter().map(colour).collect()))
}

/// Writes them; the file is whole or absent.
///
/// # Errors
/// Names the file.
pub fn write(path: &Path, halves: &Halves) -> anyhow::Result<()> {
    let mut bytes = MAGIC.to_vec();
    let numbers = halves.iter().flatten().flat_map(DVec3::to_array);
    bytes.extend(numbers.flat_map(f64::to_le_bytes));
    bytes.extend_from_slice(&Sha256::digest(&bytes));
    output::write(path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_is_read_and_what_was_harmed_is_not() {
        let folder = std::env::temp_dir().join(format!("srbf-reference-{}", std::process::id()));
        let path = folder.join("a.reference");
        let halves = [1.0, 2.0].map(|v| (0..6).map(|i| DVec3::new(v, f64::from(i), -v)).collect::<Vec<_>>());
        assert_eq!(read(&path, 6), None);
        write(&path, &halves).unwrap();
        assert_eq!(read(&path, 6), Some(halves));
        assert_eq!(read(&path, 5), None);
        let mut bytes = std::fs::read(&path).unwrap();
        bytes[60] ^= 1;
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(read(&path, 6), None);
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn the_name_depends_on_all_that_is_added() {
        let name = |parts: &[&str]| {
            let mut key = Key::new().unwrap();
            parts.iter().for_each(|part| key.add_source(part).unwrap());
            key.file(Path::new("x"))
        };
        assert_eq!(name(&["a", "b"]), name(&["a", "b"]));
        assert_ne!(name(&["a", "b"]), name(&["ab"]));
        assert_ne!(name(&["a"]), name(&["b"]));
    }
}
