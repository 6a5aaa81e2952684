//! Calls of the program that a crate of tests names `PROGRAM`.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of a test.
pub fn folder(name: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("command-line").join(name);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    place
}

/// A call of the program, without SRBF_DATA_DIR and the columns of a terminal.
pub fn command(place: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(crate::PROGRAM);
    command.current_dir(place).args(arguments).env_remove("SRBF_DATA_DIR").env_remove("COLUMNS");
    command
}

/// The output of the program.
pub fn srbf(place: &Path, arguments: &[&str]) -> Output {
    command(place, arguments).output().unwrap()
}

/// The call fails with status 2, says all of this, and leaves no file but those that were there.
pub fn refused(place: &Path, arguments: &[&str], says: &[&str]) {
    refused_with_data(place, None, arguments, says);
}

/// The same with SRBF_DATA_DIR.
pub fn refused_with_data(place: &Path, data: Option<&str>, arguments: &[&str], says: &[&str]) {
    let files = || std::fs::read_dir(place).unwrap().map(|f| f.unwrap().file_name()).collect::<Vec<_>>();
    let before = files();
    let output = command(place, arguments).envs(data.map(|data| ("SRBF_DATA_DIR", data))).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
    for part in says {
        assert!(text.contains(part), "{arguments:?} does not say `{part}`: {text}");
    }
    assert!(!text.contains("panicked"), "{text}");
    assert_eq!(files(), before, "{arguments:?}");
}
