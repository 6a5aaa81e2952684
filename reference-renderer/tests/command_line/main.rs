//! The program `srbf` as a user calls it: what is wrong is named, the exit status is 2, and nothing half-written is left.

mod files;
mod fits;
mod options;
mod pictures;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of a test.
fn folder(name: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("command-line").join(name);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    place
}

fn command(place: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_srbf"));
    command.current_dir(place).args(arguments).env_remove("SRBF_DATA_DIR");
    command
}

fn srbf(place: &Path, arguments: &[&str]) -> Output {
    command(place, arguments).output().unwrap()
}

/// The call fails with status 2, says all of this, and leaves no file but those that were there.
fn refused(place: &Path, arguments: &[&str], says: &[&str]) {
    refused_with_data(place, None, arguments, says);
}

/// The same with SRBF_DATA_DIR.
fn refused_with_data(place: &Path, data: Option<&str>, arguments: &[&str], says: &[&str]) {
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

/// Samples of a diffuse surface at two views.
fn rows() -> String {
    let mut text = String::from("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b\n");
    for (wo_x, wo_z) in [(0.0f64, 1.0f64), (0.6, 0.8)] {
        for i in 0..60 {
            let (z, phi) = ((f64::from(i) + 0.5) / 60.0, 2.4 * f64::from(i));
            let r = (1.0 - z * z).sqrt();
            text += &format!("{},{},{z},{wo_x},0,{wo_z},0.2,0.1,0.05\n", r * phi.cos(), r * phi.sin());
        }
    }
    text
}
