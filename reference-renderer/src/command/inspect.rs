//! `srbf inspect`.

use crate::truth::LargeMixture;
use crate::truth::sheets::sheet_in;
use crate::truth::stored::{QUARTERS, StoredMaterial};
use glam::Vec3;
use srbf_core::{MAX_LOBES, Material, Quarter, Sheet, SheetMixture, SpectralMap, luminance, printable};
use srbf_fit::judge::report::{factor_bytes, factor_words};

/// Prints the content of a .srbf material or sheet.
///
/// A line for each view: its angle, the squeeze, the albedo in closed form, the share of it that the diffuse term has,
/// the range of the lobes' sharpness, and the share of the strongest lobe. Of an anisotropic material also the azimuth, and the
/// squeeze along and across the axes that it has. Of a sheet its quarters, and the shares of the light that it reflects and transmits.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A .srbf file or the name of a preset
    #[arg(value_name = "FILE|PRESET")]
    material: String,
    /// Also print every lobe of every view, its colour as luminance and relative colour differences
    #[arg(long)]
    lobes: bool,
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    if let Some(sheet) = sheet_in(args.material.as_ref())? {
        return print_sheet(&args.material, &sheet, args.lobes);
    }
    let stored = StoredMaterial::load(&args.material)?;
    let material = &stored.material;
    println!("name        {}", printable(&stored.name));
    println!("bytes       {}", material.bytes().len());
    println!("views       {}", material.view_count());
    println!(
        "lobes       {}, {} of them squeezed, {} in mirrored pairs (at most {MAX_LOBES})",
        material.lobe_count(),
        material.squeezed_count(),
        2 * material.mirrored_count()
    );
    if let Some(nodes) = factor_words(material) {
        println!(
            "factors     {nodes}, over half angle, difference angle and azimuth, largest {:.3}, {} bytes",
            material.largest_factor(),
            factor_bytes(material)
        );
    }
    if let Some(map) = material.spectral_map() {
        println!("spectra     {}", spectra_words(map));
    }
    for (n, line) in material.provenance().lines().enumerate() {
        println!("{}  {}", if n == 0 { "provenance" } else { "         |" }, printable(line));
    }
    println!();
    let isotropic = material.is_isotropic();
    let extra = if isotropic { "" } else { "azimuth    along  " };
    println!(
        "  view  degrees  {extra}squeeze   albedo red  green   blue    diffuse  sharpness              strongest lobe"
    );
    let mut mixture = LargeMixture::empty();
    for view in 0..material.view_count() {
        let theta = material.view_theta(view).unwrap_or_default();
        let azimuth = material.view_azimuth(view).unwrap_or_default();
        let (sin, cos) = azimuth.sin_cos();
        let across = theta.sin();
        material.prepare(Vec3::new(across * cos, across * sin, theta.cos().max(0.0)), &mut mixture)?;
        let albedo = mixture.albedo();
        let lobes: Vec<_> = (0..mixture.len()).filter_map(|k| mixture.lobe(k)).collect();
        let sharpness = |pick: fn(f32, f32) -> f32, start| {
            lobes.iter().map(|lobe| lobe.gaussian.sharpness).fold(start, pick)
        };
        let strongest = lobes
            .iter()
            .map(|lobe| srbf_core::luminance(lobe.amplitude) * lobe.gaussian.integral())
            .fold(0.0, f32::max);
        let share = |part: f32| 100.0 * part / mixture.power().max(f32::MIN_POSITIVE);
        let extra = match isotropic {
            true => String::new(),
            false => format!("{:>7.2}  {:>7.4}  ", azimuth.to_degrees(), mixture.squeeze_along()),
        };
        println!(
            "  {view:>4}  {:>7.2}  {extra}{:>7.4}      {:.4}  {:.4}  {:.4}  {:>5.1} %  {:>9.3e} - {:<9.3e}  {:>5.1} %",
            theta.to_degrees(),
            mixture.squeeze(),
            albedo.x,
            albedo.y,
            albedo.z,
            share(srbf_core::luminance(mixture.diffuse())),
            sharpness(f32::min, f32::INFINITY),
            sharpness(f32::max, 0.0),
            share(strongest)
        );
    }
    if args.lobes {
        print_lobes(material);
    }
    Ok(())
}

/// Prints the quarters of a sheet, and the shares of the light.
fn print_sheet(name: &str, sheet: &Sheet<Vec<u8>>, with_lobes: bool) -> anyhow::Result<()> {
    println!("name        {}", printable(name));
    println!("bytes       {}, a sheet", sheet.bytes().len());
    if sheet.is_symmetric() {
        println!("back        like the front");
    }
    for (quarter, own) in Quarter::ALL.into_iter().zip(QUARTERS) {
        let words = match sheet.quarter(quarter) {
            Some(material) => format!(
                "{} bytes, {} lobes at {} views{}",
                material.bytes().len(),
                material.lobe_count(),
                material.view_count(),
                if material.is_isotropic() { "" } else { ", anisotropic" }
            ),
            None => "black".to_owned(),
        };
        println!("{own:<18}  {words}");
    }
    for (n, line) in sheet.provenance().lines().enumerate() {
        println!("{}  {}", if n == 0 { "provenance" } else { "         |" }, printable(line));
    }
    println!("\n           in front                           behind");
    println!("  degrees  reflected  transmitted  of draws  reflected  transmitted  of draws");
    let mut pair = SheetMixture::<MAX_LOBES>::empty();
    for degrees in [0.0f32, 20.0, 40.0, 60.0, 75.0, 85.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        print!("  {degrees:>7}");
        for wo in [cos, -cos].map(|z| Vec3::new(sin, 0.0, z)) {
            sheet.prepare(wo, &mut pair)?;
            let [reflected, transmitted] = pair.albedos().map(luminance);
            print!("  {reflected:>9.4}  {transmitted:>11.4}  {:>8.3}", sheet.reflected_share(wo));
        }
        println!();
    }
    println!("\nShares of the light, and of the draws those that are reflected.");
    println!("A quarter is a material: {}:front-transmission", printable(name));
    for quarter in Quarter::ALL.into_iter().filter(|_| with_lobes) {
        let is_stored = !(sheet.is_symmetric() && quarter.is_back());
        if let Some(material) = sheet.quarter(quarter).filter(|_| is_stored) {
            println!("\n{}:", QUARTERS[quarter as usize]);
            print_lobes(&material);
        }
    }
    Ok(())
}

/// The map from colours to spectra in words.
fn spectra_words(map: SpectralMap<'_>) -> String {
    let [first, last] = [0, map.len() - 1].map(|n| map.wavelength(n).unwrap_or_default());
    let bytes = map.bytes().len();
    if map.len() == 1 {
        return format!("one wavelength, {first} nm, which colours are the value at, {bytes} bytes");
    }
    let of = if map.is_grey() { "the luminance" } else { "red, green and blue" };
    let error = 100.0 * map.error();
    format!(
        "{} wavelengths from {first} to {last} nm, of {of}, off by {error:.1} %, {bytes} bytes",
        map.len()
    )
}

/// Prints every lobe of every view, its colour as it is stored: luminance, and red and blue less that, relative to it.
fn print_lobes(material: &Material<impl AsRef<[u8]>>) {
    println!();
    println!("  view  lobe   along  across    sharpness    luminance  (R-Y)/Y  (B-Y)/Y  kind");
    for view in 0..material.view_count() {
        for k in 0..material.view_lobe_count() {
            let plane = material
                .view_lobe(view, k)
                .map(|l| ([l.angle, l.off_plane], l.log2_sharpness, l.log2_luminance, l.color_differences));
            let tilted = material
                .view_tilted_lobe(view, k)
                .map(|l| (l.tilt, l.log2_sharpness, l.log2_luminance, l.color_differences));
            let Some((axis, log2_sharpness, log2_luminance, [red, blue])) = plane.or(tilted) else {
                continue;
            };
            let [along, across] = axis.map(f32::to_degrees);
            let kind = match k {
                _ if k < material.squeezed_count() => "squeezed",
                _ if k + material.mirrored_count() >= material.view_lobe_count() => "round, mirrored",
                _ => "round",
            };
            println!(
                "  {view:>4}  {k:>4} {along:>7.2} {across:>7.2}  {:>11.4e}  {:>11.4e}  {red:>7.3}  {blue:>7.3}  {kind}",
                log2_sharpness.exp2(),
                log2_luminance.exp2()
            );
        }
    }
}
