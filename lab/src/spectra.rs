//! `srbf-lab spectra`.

use anyhow::Context;
use glam::Vec3;
use srbf_core::Material;
use srbf_fit::Settings;
use srbf_fit::fit_source;
use srbf_fit::judge::spectral::SpectralReport;
use srbf_fit::read::{Conventions, SpectralErrors, read_with};
use srbf_reference_renderer::command::argument;
use srbf_reference_renderer::numbers::points::PointsName;
use srbf_reference_renderer::out::progress::Progress;
use srbf_reference_renderer::out::{output, picture_file};
use srbf_reference_renderer::shade::Light;
use srbf_reference_renderer::trace::film::Film;
use srbf_reference_renderer::trace::render::{add_samples, add_spectral_samples};
use srbf_reference_renderer::trace::scene::{Scene, SceneName};
use srbf_reference_renderer::trace::settings::RenderSettings;
use srbf_reference_renderer::truth::stored::StoredMaterial;
use srbf_reference_renderer::world::environment::sky;
use srbf_reference_renderer::world::illuminant::Illuminant;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Fits the measured spectra, and says how far those of the fits are off, by the samples' own colours (`colours`) and by the fit's (`fit`).
///
/// SRBF_DATA_DIR names the folder that holds them. Some minutes.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The table to write, .csv
    #[arg(short, long, default_value = "out/spectra.csv", value_name = "FILE")]
    output: PathBuf,
    /// In place of the table, the picture to write, .png: balls of garnet red and krylon blue in colours, and in spectra under D65, A and
    /// F11, from left to right. It needs no data
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

/// Materials of the picture, side of a ball in pixels, and samples a pixel.
const BALLS: [&str; 2] = ["garnet_red", "krylon_blue"];
const SIDE: u32 = 180;
const SAMPLES: u32 = 1024;

/// Measured files of spectra, under the folder of the data,
/// and what their values are divided by: those in one plane are reflectance factors.
const FILES: [(&str, f64); 6] = [
    ("cornell/garnet_red.brdf", 1.0),
    ("cornell/krylon_blue.brdf", 1.0),
    ("cornell/cayman.brdf", 1.0),
    ("cornell/acryl_blue.brdf", 1.0),
    ("field/in_plane_spectra.csv", PI),
    ("field/lidar_905nm.xompt", 1.0),
];

const HEAD: &str = "file,wavelengths,bytes of the block,\"colours: error, %\",colours: worst nm,\"colours: error there, %\",colours: dE under D65,\
    colours: under A,colours: under F11,\"fit: error, %\",fit: worst nm,\"fit: error there, %\",fit: dE under D65,fit: under A,fit: under F11\n";

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    if let Some(path) = &args.picture {
        return balls(path);
    }
    let data = argument::data_folder()?;
    output::check_place(&args.output)?;
    let mut table = HEAD.to_owned();
    for (file, divisor) in FILES {
        let conventions = Conventions { divide: divisor, ..Conventions::default() };
        let source = read_with(&data.join(file), &conventions)?;
        let fit = fit_source(&source, &Settings::default(), |_| {}).context(file)?;
        let material = Material::from_bytes(fit.bytes.as_slice())?;
        let map = material.spectral_map().with_context(|| format!("{file}: no spectra"))?;
        let report = fit.report.spectra.as_ref().with_context(|| format!("{file}: no spectra"))?;
        let SpectralReport { text, of_map, worst, of_fit, worst_of_fit, .. } = report;
        writeln!(
            table,
            "{},{text},{},{},{}",
            source.name,
            (8 + map.bytes().len()).next_multiple_of(4),
            errors(of_map, *worst),
            errors(of_fit, *worst_of_fit)
        )?;
        println!("{}: {}", source.name, errors(of_fit, *worst_of_fit));
    }
    output::write(&args.output, table.as_bytes())
}

/// Draws the balls, all with one exposure.
fn balls(path: &Path) -> anyhow::Result<()> {
    output::check_extension(path, "png")?;
    output::check_place(path)?;
    let (light, name, size) = (sky::haze(), SceneName::Sphere, [SIDE; 2]);
    let settings =
        RenderSettings { light: Light::Mis, split: 1, max_bounces: 1, points: PointsName::Sobol, seed: 0 };
    let lights = [None, Some("D65"), Some("A"), Some("F11")];
    let (width, hidden) = (SIDE as usize * lights.len(), Progress::hidden());
    let mut picture = vec![Vec3::ZERO; width * SIDE as usize * BALLS.len()];
    for (row, material) in BALLS.iter().enumerate() {
        let stored = StoredMaterial::load(material)?;
        let scene = Scene::new(name, &stored.material, &stored.material, &light);
        for (column, spectral) in lights.iter().enumerate() {
            let (camera, mut film) = (name.camera(size), Film::new(size));
            if let Some(illuminant) = spectral {
                let illuminant = Illuminant::load(illuminant)?;
                add_spectral_samples(&scene, &camera, &settings, &illuminant, &mut film, SAMPLES, &hidden)?;
            } else {
                add_samples(&scene, &camera, &settings, &mut film, SAMPLES, &hidden)?;
            }
            for (y, line) in film.to_picture().chunks(SIDE as usize).enumerate() {
                let at = (row * SIDE as usize + y) * width + column * SIDE as usize;
                picture[at..at + line.len()].copy_from_slice(line);
            }
        }
    }
    let size = [width as u32, SIDE * BALLS.len() as u32];
    picture_file::write_tone_mapped_png(path, size, &picture, picture_file::automatic_exposure(&picture))
}

/// Cells of one kind of colours.
fn errors(of: &SpectralErrors, (nm, worst): (f64, f64)) -> String {
    let colour = of
        .colour
        .map_or_else(|| ",,".to_owned(), |of| of.map(|[median, _]| format!("{median:.2}")).join(","));
    format!("{:.1},{nm},{:.1},{colour}", 100.0 * of.error, 100.0 * worst)
}
