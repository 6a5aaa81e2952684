//! `srbf sheet`.

use crate::out::output;
use crate::out::print::shown;
use anyhow::{Context, ensure};
use srbf_core::{Material, Sheet, read_file};
use std::path::{Path, PathBuf};

/// Joins materials to a sheet, which reflects light and lets some through.
///
/// A quarter that is not given is black. Materials have both directions above the horizon: of a direction behind the sheet the height changes its
/// sign, so that straight through is the mirror direction. `srbf fit --quarter` makes them so, and `srbf fit` of a file of WINDOW makes a whole sheet.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Viewer and light in front
    #[arg(long, value_name = "FILE.srbf")]
    front_reflection: Option<PathBuf>,
    /// The viewer in front, the light behind
    #[arg(long, value_name = "FILE.srbf")]
    front_transmission: Option<PathBuf>,
    /// Viewer and light behind
    #[arg(long, value_name = "FILE.srbf")]
    back_reflection: Option<PathBuf>,
    /// The viewer behind, the light in front
    #[arg(long, value_name = "FILE.srbf")]
    back_transmission: Option<PathBuf>,
    /// The back is like the front
    #[arg(long, conflicts_with_all = ["back_reflection", "back_transmission"])]
    symmetric: bool,
    /// The sheet to write
    #[arg(short, long, value_name = "SHEET.srbf")]
    output: PathBuf,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    output::check_place(&args.output)?;
    let load = |path: &Option<PathBuf>| path.as_deref().map(load).transpose();
    let materials = [
        load(&args.front_reflection)?,
        load(&args.front_transmission)?,
        load(&args.back_reflection)?,
        load(&args.back_transmission)?,
    ];
    let quarters = materials.each_ref().map(Option::as_ref);
    ensure!(
        quarters.iter().any(Option::is_some),
        "no quarter is given, such as --front-transmission FILE.srbf"
    );
    let provenance = "joined by srbf sheet; each quarter has a provenance of its own\n";
    let mut bytes = vec![0; Sheet::encoded_len(quarters, provenance)];
    Sheet::encode(quarters, args.symmetric, provenance, &mut bytes)?;
    output::write(&args.output, &bytes)?;
    let count = quarters.iter().flatten().count();
    println!("{}: {} bytes, {count} quarters", shown(&args.output), bytes.len());
    Ok(())
}

fn load(path: &Path) -> anyhow::Result<Material<Vec<u8>>> {
    let read = || anyhow::Ok(Material::from_bytes(read_file(path)?)?);
    read().with_context(|| shown(path))
}
