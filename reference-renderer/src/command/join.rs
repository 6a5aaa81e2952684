//! `srbf join`.

use super::fit::sheet::say_light;
use crate::out::output;
use crate::out::print::shown;
use crate::truth::stored::StoredMaterial;
use anyhow::ensure;
use srbf_fit::{joined, light_of_sheet};
use std::path::PathBuf;

/// Puts materials together to a sheet: a thin surface that reflects light, and lets some through.
///
/// Each quarter is a fit, a preset, or a quarter of another sheet, such as FILE.srbf:front-transmission. The front or the back in its name
/// is the side of the viewer. A quarter that is not given is black. Prints where the light goes.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Reflection seen from the front
    #[arg(long, value_name = "FILE")]
    front_reflection: Option<PathBuf>,
    /// Transmission seen from the front, of light that falls on the back
    #[arg(long, value_name = "FILE")]
    front_transmission: Option<PathBuf>,
    /// Reflection seen from the back
    #[arg(long, value_name = "FILE")]
    back_reflection: Option<PathBuf>,
    /// Transmission seen from the back, of light that falls on the front
    #[arg(long, value_name = "FILE")]
    back_transmission: Option<PathBuf>,
    /// The back is like the front, and is stored once
    #[arg(long, conflicts_with_all = ["back_reflection", "back_transmission"])]
    symmetric: bool,
    /// The file to write
    #[arg(short, long)]
    output: PathBuf,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    let named =
        [&args.front_reflection, &args.front_transmission, &args.back_reflection, &args.back_transmission];
    ensure!(
        named.iter().any(|name| name.is_some()),
        "a quarter is expected, such as --front-transmission FILE"
    );
    output::check_place(&args.output)?;
    let load = |name: &Option<PathBuf>| {
        name.as_ref().map(|name| StoredMaterial::load(&name.to_string_lossy())).transpose()
    };
    let [a, b, c, d] = named.map(load);
    let loaded = [a?, b?, c?, d?];
    let quarters = loaded.each_ref().map(|stored| stored.as_ref().map(|stored| &stored.material));
    let bytes = joined(quarters, args.symmetric)?;
    output::write(&args.output, &bytes)?;
    println!(
        "{}: {} bytes, {} quarters",
        shown(&args.output),
        bytes.len(),
        quarters.iter().flatten().count()
    );
    let sides = light_of_sheet(&bytes)?;
    let most = sides.iter().flatten().map(|light| light.fit[0] + light.fit[1]).fold(0.0, f64::max);
    if most > 1.0 {
        println!("note  up to {:.1} % of the light that falls on it leaves it", 100.0 * most);
    }
    say_light(&sides, args.symmetric);
    Ok(())
}
