//! Attacks: operations on the bytes of a stranger, and promises that hold for any bytes.
//!
//! A [`Target`] takes any bytes. It reads them as one format or builds its objects from them, and then calls everything that
//! can be called with these. A panic is a finding: promises are asserted.
//!
//! Three users share the list [`TARGETS`]. `tests/tests/fuzz.rs` feeds damaged seeds to every target in each test run.
//! `fuzz/run` feeds libFuzzer's inputs, which follow the coverage. `fuzz/found/NAME/` keeps findings, for both.
//!
//! To add a format: a function here, a line in [`TARGETS`], seeds in `tests/src/bin/seeds.rs`.

// With their paths, as `fuzz/src/lib.rs` compiles this file too, by its path.
#[path = "attack/blend.rs"]
mod blend;
#[path = "attack/environment.rs"]
mod environment;
#[path = "attack/input.rs"]
mod input;
#[path = "attack/material.rs"]
mod material;
#[path = "attack/mixture.rs"]
mod mixture;
#[path = "attack/sheet.rs"]
mod sheet;
#[cfg(feature = "readers")]
#[path = "attack/tables.rs"]
mod tables;

use crate::inputs::levels;
use input::random;
pub use input::{above, any_direction, mutate, put_right, uniform};
pub use sheet::put_quarters_right;
use std::path::{Path, PathBuf};

/// Something that takes the bytes of a stranger.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Name of its folders in `fuzz/seeds` and `fuzz/found`; `SRBF_TARGET` of `fuzz/src/main.rs`.
    pub name: &'static str,
    /// The operations on the bytes. Returns whether they were accepted.
    pub run: fn(&[u8]) -> bool,
}

const fn target(name: &'static str, run: fn(&[u8]) -> bool) -> Target {
    Target { name, run }
}

/// Every target.
pub const TARGETS: &[Target] = &[
    #[cfg(feature = "readers")]
    target("astm", tables::astm),
    target("blend", blend::blend),
    #[cfg(feature = "readers")]
    target("cornell", tables::cornell),
    #[cfg(feature = "readers")]
    target("csv", tables::csv),
    target("environment_made", environment::made),
    target("environment_read", environment::read),
    #[cfg(feature = "readers")]
    target("exports", tables::exports),
    #[cfg(feature = "readers")]
    target("formats", tables::formats),
    target("material", material::material),
    #[cfg(feature = "readers")]
    target("merl", tables::merl),
    target("mixture", mixture::mixture),
    #[cfg(feature = "readers")]
    target("neural", tables::neural),
    target("product", environment::product),
    #[cfg(feature = "readers")]
    target("rgl", tables::rgl),
    target("sheet", sheet::sheet),
    #[cfg(feature = "readers")]
    target("utia", tables::utia),
    #[cfg(feature = "readers")]
    target("window", tables::window),
];

/// Runs a target as a fuzzer does: at a SIMD level that the bytes choose, of those that this processor has.
///
/// # Panics
/// If there is no such target, or if it finds something.
pub fn run(name: &str, bytes: &[u8]) -> bool {
    let target = TARGETS.iter().find(|target| target.name == name).expect("the name of a target");
    let levels = levels();
    levels[random(bytes).below(levels.len())].set().expect("an available level");
    (target.run)(bytes)
}

/// The kept inputs of a target, of both folders, by name.
///
/// # Panics
/// If a folder cannot be read, or there is no seed.
pub fn kept(name: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let house = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz");
    let mut files = Vec::new();
    for folder in ["seeds", "found"].map(|folder| house.join(folder).join(name)) {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for entry in entries {
            let path = entry.expect("a folder that can be read").path();
            let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            files.push((path, bytes));
        }
    }
    assert!(!files.is_empty(), "no seeds of {name}: cargo run --release -p srbf-tests --bin seeds");
    files.sort();
    files
}
