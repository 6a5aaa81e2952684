//! `srbf inspect`.

use crate::out::print::data;
use crate::truth::LargeMixture;
use crate::truth::sheets::sheet_in;
use crate::truth::stored::{QUARTERS, StoredMaterial};
use glam::Vec3;
use serde_json::{Value, json};
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
    /// Prints the same as a JSON document: angles in degrees, shares from 0 to 1
    #[arg(long, conflicts_with = "quiet")]
    json: bool,
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    if let Some(sheet) = sheet_in(args.material.as_ref())? {
        if args.json {
            data(&format!("{:#}\n", sheet_json(&args.material, &sheet, args.lobes)?));
            return Ok(());
        }
        return print_sheet(&args.material, &sheet, args.lobes);
    }
    let StoredMaterial { name, material } = StoredMaterial::load(&args.material)?;
    if args.json {
        let mut json = material_json(&material, args.lobes)?;
        json["name"] = printable(&name).to_string().into();
        data(&format!("{json:#}\n"));
        return Ok(());
    }
    print_material(&name, &material)?;
    if args.lobes {
        print_lobes(&material);
    }
    Ok(())
}

/// A view of a material in numbers: angles in degrees, shares of its power.
struct ViewNumbers {
    degrees: f32,
    azimuth: f32,
    squeeze: f32,
    along: f32,
    albedo: Vec3,
    diffuse: f32,
    sharpness: [f32; 2],
    strongest: f32,
}

impl ViewNumbers {
    fn new(material: &Material<impl AsRef<[u8]>>, view: usize) -> anyhow::Result<Self> {
        let mut mixture = LargeMixture::empty();
        let theta = material.view_theta(view).unwrap_or_default();
        let azimuth = material.view_azimuth(view).unwrap_or_default();
        let (sin, cos) = azimuth.sin_cos();
        let across = theta.sin();
        material.prepare(Vec3::new(across * cos, across * sin, theta.cos().max(0.0)), &mut mixture)?;
        let lobes: Vec<_> = (0..mixture.len()).filter_map(|k| mixture.lobe(k)).collect();
        let sharpness = |pick: fn(f32, f32) -> f32, start| {
            lobes.iter().map(|lobe| lobe.gaussian.sharpness).fold(start, pick)
        };
        let strongest =
            lobes.iter().map(|lobe| luminance(lobe.amplitude) * lobe.gaussian.integral()).fold(0.0, f32::max);
        let share = |part: f32| part / mixture.power().max(f32::MIN_POSITIVE);
        Ok(Self {
            degrees: theta.to_degrees(),
            azimuth: azimuth.to_degrees(),
            squeeze: mixture.squeeze(),
            along: mixture.squeeze_along(),
            albedo: mixture.albedo(),
            diffuse: share(luminance(mixture.diffuse())),
            sharpness: [sharpness(f32::min, f32::INFINITY), sharpness(f32::max, 0.0)],
            strongest: share(strongest),
        })
    }
}

fn print_material(name: &str, material: &Material<impl AsRef<[u8]>>) -> anyhow::Result<()> {
    println!("name        {}", printable(name));
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
    print_provenance(material.provenance());
    println!();
    let isotropic = material.is_isotropic();
    let extra = |text: &str| if isotropic { String::new() } else { text.to_owned() };
    println!(
        "           {}           albedo              diffuse  sharpness       strongest",
        extra("               ")
    );
    println!(
        "view degrees{} squeeze   red green  blue        %  from      to     lobe, %",
        extra(" azimuth   along")
    );
    for view in 0..material.view_count() {
        let v = ViewNumbers::new(material, view)?;
        let extra = if isotropic { String::new() } else { format!(" {:>7.2} {:>7.4}", v.azimuth, v.along) };
        println!(
            "{view:>4} {:>7.2}{extra} {:>7.4} {:>5.3} {:>5.3} {:>5.3} {:>8.1}  {:<7.1e} {:<7.1e} {:>6.1}",
            v.degrees,
            v.squeeze,
            v.albedo.x,
            v.albedo.y,
            v.albedo.z,
            100.0 * v.diffuse,
            v.sharpness[0],
            v.sharpness[1],
            100.0 * v.strongest
        );
    }
    Ok(())
}

fn print_provenance(text: &str) {
    for (n, line) in text.lines().enumerate() {
        println!("{}  {}", if n == 0 { "provenance" } else { "         |" }, printable(line));
    }
}

/// A material as JSON, without its name.
fn material_json(material: &Material<impl AsRef<[u8]>>, with_lobes: bool) -> anyhow::Result<Value> {
    let mut views = Vec::new();
    for view in 0..material.view_count() {
        let v = ViewNumbers::new(material, view)?;
        let mut json = json!({
            "degrees": v.degrees,
            "azimuth": v.azimuth,
            "squeeze": v.squeeze,
            "squeeze_along": v.along,
            "albedo": v.albedo.to_array(),
            "diffuse": v.diffuse,
            "sharpness": v.sharpness,
            "strongest_lobe": v.strongest,
        });
        if with_lobes {
            let lobe = |lobe: LobeNumbers| {
                json!({
                    "along": lobe.axis[0],
                    "across": lobe.axis[1],
                    "sharpness": lobe.sharpness,
                    "luminance": lobe.luminance,
                    "color_differences": lobe.color_differences,
                    "kind": lobe.kind,
                })
            };
            json["lobes"] = lobes_of(material, view).map(lobe).collect();
        }
        views.push(json);
    }
    Ok(json!({
        "kind": "material",
        "bytes": material.bytes().len(),
        "is_isotropic": material.is_isotropic(),
        "lobes": material.lobe_count(),
        "squeezed": material.squeezed_count(),
        "mirrored_pairs": material.mirrored_count(),
        "factors": factor_words(material).map(|nodes| {
            json!({ "nodes": nodes, "largest": material.largest_factor(), "bytes": factor_bytes(material) })
        }),
        "spectra": material.spectral_map().map(|map| {
            let wavelengths = (0..map.len()).filter_map(|n| map.wavelength(n));
            json!({ "wavelengths": wavelengths.collect::<Vec<_>>(), "error": map.error(), "bytes": map.bytes().len() })
        }),
        "provenance": provenance_json(material.provenance()),
        "views": views,
    }))
}

fn provenance_json(text: &str) -> Vec<String> {
    text.lines().map(|line| printable(line).to_string()).collect()
}

/// Angles of a viewer for which the shares of a sheet are told, degrees.
const DEGREES: [f32; 6] = [0.0, 20.0, 40.0, 60.0, 75.0, 85.0];

/// Of a viewer in front of a sheet, and of one behind it, at an angle: shares of light that is reflected and transmitted, and the share of the
/// draws that are reflected.
fn shares(sheet: &Sheet<Vec<u8>>, degrees: f32) -> anyhow::Result<[[f32; 3]; 2]> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let mut pair = SheetMixture::<MAX_LOBES>::empty();
    let mut shares = [[0.0; 3]; 2];
    for (share, z) in shares.iter_mut().zip([cos, -cos]) {
        let wo = Vec3::new(sin, 0.0, z);
        sheet.prepare(wo, &mut pair)?;
        let [reflected, transmitted] = pair.albedos().map(luminance);
        *share = [reflected, transmitted, sheet.reflected_share(wo)];
    }
    Ok(shares)
}

/// A sheet as JSON.
fn sheet_json(name: &str, sheet: &Sheet<Vec<u8>>, with_lobes: bool) -> anyhow::Result<Value> {
    let mut quarters = serde_json::Map::new();
    for (quarter, own) in Quarter::ALL.into_iter().zip(QUARTERS) {
        let material = sheet.quarter(quarter).map(|material| material_json(&material, with_lobes));
        quarters.insert(own.to_owned(), material.transpose()?.into());
    }
    let side = |[reflected, transmitted, of_draws]: [f32; 3]| json!({ "reflected": reflected, "transmitted": transmitted, "reflected_draws": of_draws });
    let mut light = Vec::new();
    for degrees in DEGREES {
        let [front, behind] = shares(sheet, degrees)?.map(side);
        light.push(json!({ "degrees": degrees, "in_front": front, "behind": behind }));
    }
    Ok(json!({
        "kind": "sheet",
        "name": printable(name).to_string(),
        "bytes": sheet.bytes().len(),
        "is_symmetric": sheet.is_symmetric(),
        "provenance": provenance_json(sheet.provenance()),
        "light": light,
        "quarters": quarters,
    }))
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
    print_provenance(sheet.provenance());
    println!("\n           in front                           behind");
    println!("  degrees  reflected  transmitted  of draws  reflected  transmitted  of draws");
    for degrees in DEGREES {
        let side = |[reflected, transmitted, of_draws]: [f32; 3]| {
            format!("  {reflected:>9.4}  {transmitted:>11.4}  {of_draws:>8.3}")
        };
        let [front, behind] = shares(sheet, degrees)?.map(side);
        println!("  {degrees:>7}{front}{behind}");
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

/// A stored lobe; its colour as it is stored: luminance, and red and blue less that, relative to it.
struct LobeNumbers {
    axis: [f32; 2],
    sharpness: f32,
    luminance: f32,
    color_differences: [f32; 2],
    kind: &'static str,
}

/// The lobes of a view; angles in degrees.
fn lobes_of(material: &Material<impl AsRef<[u8]>>, view: usize) -> impl Iterator<Item = LobeNumbers> {
    (0..material.view_lobe_count()).filter_map(move |k| {
        let plane = material
            .view_lobe(view, k)
            .map(|l| ([l.angle, l.off_plane], l.log2_sharpness, l.log2_luminance, l.color_differences));
        let tilted = material
            .view_tilted_lobe(view, k)
            .map(|l| (l.tilt, l.log2_sharpness, l.log2_luminance, l.color_differences));
        let (axis, log2_sharpness, log2_luminance, color_differences) = plane.or(tilted)?;
        let kind = match k {
            _ if k < material.squeezed_count() => "squeezed",
            _ if k + material.mirrored_count() >= material.view_lobe_count() => "mirrored",
            _ => "round",
        };
        let axis = axis.map(f32::to_degrees);
        let (sharpness, luminance) = (log2_sharpness.exp2(), log2_luminance.exp2());
        Some(LobeNumbers { axis, sharpness, luminance, color_differences, kind })
    })
}

/// Prints every lobe of every view.
fn print_lobes(material: &Material<impl AsRef<[u8]>>) {
    println!();
    println!("view  lobe   along  across   sharpness   luminance  (R-Y)/Y  (B-Y)/Y  kind");
    for view in 0..material.view_count() {
        for (k, lobe) in lobes_of(material, view).enumerate() {
            let ([along, across], [red, blue]) = (lobe.axis, lobe.color_differences);
            println!(
                "{view:>4}  {k:>4} {along:>7.2} {across:>7.2}  {:>10.3e}  {:>10.3e}  {red:>7.3}  {blue:>7.3}  {}",
                lobe.sharpness, lobe.luminance, lobe.kind
            );
        }
    }
}
