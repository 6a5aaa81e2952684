//! The door through which every file leaves: whole or absent, and those that belong together too. Nothing else of the programs writes files.
//!
//! An input of the command stays, whatever name the output has for it ([`keep_input`]). So does a file that this program did not
//! write, unless `--force` says otherwise ([`keep_others`]): every format that the program writes holds its name within its
//! first [`LOOKED_AT`] bytes, and MERL's at its end. Both are looked at where a file is written, and before a long work ([`check_place`]).

use crate::out::print::shown;
use anyhow::{Context, bail, ensure};
use srbf_fit::Outputs;
use srbf_fit::export::MERL_MARK;
use std::cell::RefCell;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// How much of a file is looked at to see whose it is.
const LOOKED_AT: u64 = 4096;

/// First bytes of a `.srbf` file.
const MATERIAL: &[u8] = b"\x89SRBF\r\n\x1a";

/// First bytes of the tables of comparisons, which other programs read.
const COMPARISON: &[u8] = b"scene,material,environment,method,";

/// Whether files of others stay.
static KEEPS_OTHERS: AtomicBool = AtomicBool::new(false);

/// Inputs of the command, as they are named, and their identities where they were there.
static INPUTS: Mutex<Vec<(PathBuf, Option<Identity>)>> = Mutex::new(Vec::new());

/// A file, whatever its name: device and number. No name of an input is given to an output.
#[cfg(unix)]
type Identity = (u64, u64);

/// A file, behind all links and as its folder spells it. Second names of a file are told nowhere else than on Unix.
#[cfg(not(unix))]
type Identity = PathBuf;

thread_local! {
    /// Files that wait for those that they belong to.
    static TOGETHER: RefCell<Option<Outputs>> = const { RefCell::new(None) };
}

/// From here on, files of others are not overwritten.
pub fn keep_others() {
    KEEPS_OTHERS.store(true, Relaxed);
}

/// From here on, no output replaces this file, by any name. One that is not there yet counts when it is.
pub fn keep_input(path: PathBuf) {
    let identity = identity(&path);
    INPUTS.lock().unwrap_or_else(PoisonError::into_inner).push((path, identity));
}

#[cfg(unix)]
fn identity(path: &Path) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    let found = std::fs::metadata(path).ok()?;
    Some((found.dev(), found.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path) -> Option<Identity> {
    path.canonicalize().ok()
}

/// Writes a file, with the folders above it; replaces a previous file in one step.
///
/// # Errors
/// Names the file; an input of the command, or a file of others.
pub fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    check_owner(path)?;
    TOGETHER
        .with_borrow_mut(|together| match together {
            Some(outputs) => outputs.add(path, bytes),
            None => srbf_fit::write_atomically(path, bytes),
        })
        .context("cannot write")
}

/// Files that this thread writes as long as this lives: none of them is there before [`commit`](Self::commit), then all are. Where it is
/// dropped before, none is.
#[must_use]
pub struct Together(());

/// Begins a set of files that belong together.
pub fn together() -> Together {
    TOGETHER.set(Some(Outputs::default()));
    Together(())
}

impl Together {
    /// Gives all files their names.
    ///
    /// # Errors
    /// Names the file that cannot be written; all others are then as they were.
    pub fn commit(self) -> anyhow::Result<()> {
        TOGETHER.take().unwrap_or_default().commit().context("cannot write")
    }
}

impl Drop for Together {
    fn drop(&mut self) {
        TOGETHER.set(None);
    }
}

/// The content that was written to a file, whether or not it has its name yet.
///
/// # Errors
/// Names the file.
pub fn read_back(path: &Path) -> anyhow::Result<Vec<u8>> {
    let staged = TOGETHER.with_borrow(|together| {
        together.as_ref().and_then(|outputs| outputs.staged(path)).map(Path::to_path_buf)
    });
    std::fs::read(staged.as_deref().unwrap_or(path)).with_context(|| shown(path))
}

/// Refuses a name that ends in another extension: files beside it have its name with another ending.
///
/// # Errors
/// Names the file and the extension.
pub fn check_extension(path: &Path, extension: &str) -> anyhow::Result<()> {
    let fits = path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    ensure!(fits, "output {}: a name that ends in .{extension} is expected", shown(path));
    Ok(())
}

/// [`check_place`] of several files.
///
/// # Errors
/// Names the first that cannot be written.
pub fn check_places(paths: &[&Path]) -> anyhow::Result<()> {
    paths.iter().try_for_each(|path| check_place(path))
}

/// Finds out, before a long work, whether a file can be written, and may be; leaves nothing behind.
///
/// # Errors
/// Names the file.
pub fn check_place(path: &Path) -> anyhow::Result<()> {
    srbf_fit::check_output(path).context("cannot write")?;
    check_owner(path)
}

/// Refuses the place of a file that has to stay. Folders and devices are refused by those who write.
fn check_owner(path: &Path) -> anyhow::Result<()> {
    let Some(found) = identity(path).filter(|_| path.is_file()) else { return Ok(()) };
    let inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
    let is_found = |(path, then): &&(PathBuf, Option<Identity>)| {
        then.as_ref().map_or_else(|| identity(path).as_ref() == Some(&found), |then| *then == found)
    };
    if let Some((input, _)) = inputs.iter().find(is_found) {
        bail!(
            "output {}: it is the command's own input {}, which no output replaces, not by --force either; another name is expected",
            shown(path),
            shown(input)
        );
    }
    if KEEPS_OTHERS.load(Relaxed) && !is_ours(path) {
        bail!("output {}: it is there, and srbf did not write it; --force overwrites it", shown(path));
    }
    Ok(())
}

/// Whether this program has written a file, as far as its first and last bytes tell. An empty file is nobody's.
fn is_ours(path: &Path) -> bool {
    let Ok(mut file) = std::fs::File::open(path) else { return false };
    let mut start = Vec::new();
    if file.by_ref().take(LOOKED_AT).read_to_end(&mut start).is_err() {
        return false;
    }
    let is_named = || start.windows(4).any(|window| window == b"srbf");
    start.is_empty()
        || start.starts_with(MATERIAL)
        || start.starts_with(COMPARISON)
        || is_named()
        || ends_in_mark(&mut file)
}

/// Whether a file ends as our MERL files do.
fn ends_in_mark(file: &mut std::fs::File) -> bool {
    let mut end = [0; MERL_MARK.len()];
    let back = -(MERL_MARK.len() as i64);
    file.seek(SeekFrom::End(back)).and_then(|_| file.read_exact(&mut end)).is_ok() && end == MERL_MARK
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_others_wrote_is_not_overwritten() {
        let folder = std::env::temp_dir().join(format!("srbf-ours-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("a.png");
        keep_others();
        let other = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR of another program";
        for (bytes, is_free) in [
            (&other[..], false),
            (b"", true),
            (b"theta_i,phi_i\n", false),
            (b"\x89SRBF\r\n\x1a", true),
            (&[&[0; 9000][..], &MERL_MARK[..]].concat(), true),
            (&[&MERL_MARK[..], &[0; 9000][..]].concat()[8..], false),
            (b"<meta name=\"generator\" content=\"srbf\">", true),
        ] {
            std::fs::write(&path, bytes).unwrap();
            assert_eq!(check_place(&path).is_ok(), is_free, "{}", bytes.escape_ascii());
        }
        std::fs::remove_file(&path).unwrap();
        check_place(&path).unwrap();
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn files_that_belong_together_come_together() {
        let folder = std::env::temp_dir().join(format!("srbf-together-{}", std::process::id()));
        let [a, b] = ["a", "b"].map(|name| folder.join(name));
        let set = together();
        write(&a, b"one").unwrap();
        assert!(!a.exists() && read_back(&a).unwrap() == b"one");
        drop(set);
        assert!(std::fs::read_dir(&folder).unwrap().next().is_none());
        let set = together();
        write(&a, b"two").unwrap();
        write(&b, b"three").unwrap();
        set.commit().unwrap();
        assert_eq!([&a, &b].map(|path| std::fs::read(path).unwrap()), [&b"two"[..], b"three"]);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
