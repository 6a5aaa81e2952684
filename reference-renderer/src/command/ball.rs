//! `srbf ball`.

use super::argument;
use crate::out::output;
use crate::out::picture_file;
use crate::out::print::shown;
use crate::shade::shader::LoadedMaterial;
use crate::show::ball_sheet::{self, Light};
use anyhow::ensure;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Largest turn, degrees: f32 tells tenths of a degree apart there.
const MOST_TURNED: f32 = 1e5;

/// Draws a ball of a material; with a table, also a ball of the table and their difference.
///
/// Direct light, one PNG: on the left the material, in the middle the other one, under the same light and with the
/// same exposure, on the right four times the difference on the display, where grey is none. Both balls are shaded along the same
/// random directions, so that their noise cancels in the difference.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A .srbf file, the name of a preset, or a table or model as in `render`
    #[arg(value_name = "FILE|PRESET|MODEL")]
    material: String,
    /// The table that it was fitted to, or another material
    #[arg(long, value_name = "FILE|PRESET|MODEL")]
    against: Option<String>,
    /// The light: sky, haze (the sun spread wide), sun:DEGREES (a sun alone, so far from the viewer, 0 to 180), constant:VALUE, or a
    /// latitude-longitude map in a .hdr or .exr file; several, separated by commas, stand below each other
    #[arg(long, default_value = "sky", value_delimiter = ',')]
    env: Vec<String>,
    /// Samples a pixel
    #[arg(long, default_value_t = ball_sheet::SAMPLES, value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    spp: u32,
    /// Stops to brighten the balls by, from the exposure of the light, under which a matte surface that reflects half of it, and faces
    /// it, is shown as white: so pictures of several materials can be compared
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_name = "STOPS")]
    exposure: f32,
    /// Degrees by which the sample is turned about its normal, counterclockwise: with 0 the x axis of an anisotropic surface goes round the
    /// ball, with 90 along its meridians. It changes nothing of an isotropic one
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_name = "DEGREES")]
    turn: f32,
    /// Threads; 0 is one a processor. The picture does not depend on it
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    threads: u16,
    /// The picture to write, .png
    #[arg(short, long, default_value = "out/ball.png", value_name = "OUT.png")]
    output: PathBuf,
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    check_output(&args.output)?;
    argument::check_stops(args.exposure)?;
    ensure!(
        args.turn.abs() <= MOST_TURNED,
        "--turn {}: within -{MOST_TURNED} to {MOST_TURNED} degrees is expected",
        args.turn
    );
    argument::on_threads(args.threads.into(), || {
        let material = LoadedMaterial::load(&args.material)?;
        let against = args.against.as_deref().map(LoadedMaterial::load).transpose()?;
        let environments =
            args.env.iter().map(|text| argument::environment(text)).collect::<Result<Vec<_>, _>>()?;
        let light = |(name, environment)| Light {
            name,
            environment,
            samples: args.spp,
            stops: args.exposure,
            turn: args.turn,
        };
        let lights: Vec<Light<'_>> =
            args.env.iter().map(String::as_str).zip(&environments).map(light).collect();
        write(&args.output, &material, against.as_ref(), &lights)
    })
}

/// Finds out, before a long work, whether a picture of that name can be written.
///
/// # Errors
/// Names the file.
pub fn check_output(path: &Path) -> anyhow::Result<()> {
    output::check_extension(path, "png")?;
    output::check_place(path)
}

/// Draws and writes a picture with a row for each light, and prints its content.
///
/// # Errors
/// As [`ball_sheet::draw`]; names the file that cannot be written.
pub fn write(
    path: &Path,
    material: &LoadedMaterial,
    against: Option<&LoadedMaterial>,
    lights: &[Light<'_>],
) -> anyhow::Result<()> {
    let start = Instant::now();
    let (mut size, mut rgb, mut numbers) = ([0; 2], Vec::new(), String::new());
    for light in lights {
        let sheet = ball_sheet::draw(material, against, light)?;
        size = [sheet.size[0], size[1] + sheet.size[1]];
        rgb.extend(sheet.rgb);
        let of = if lights.len() > 1 { format!(" under {}", light.name) } else { String::new() };
        numbers += &format!(", exposure {:.3}", light.exposure());
        numbers += &sheet.difference.map_or_else(String::new, |found| {
            format!(
                ", difference of the balls{of}: mean {:.2} % of the mean radiance, root mean square {:.2} %",
                100.0 * found.mean,
                100.0 * found.root_mean_square
            )
        });
    }
    picture_file::write_png(path, size, &rgb)?;
    println!("{} in {:.2} s{numbers}", shown(path), start.elapsed().as_secs_f64());
    Ok(())
}
