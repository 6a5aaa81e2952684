//! `srbf-lab equal-time`.

mod text;

use anyhow::Context;
use srbf_fit::Settings;
use srbf_reference_renderer::command::{argument, compare};
use srbf_reference_renderer::numbers::points::PointsName;
use srbf_reference_renderer::out::output;
use srbf_reference_renderer::out::progress::Progress;
use srbf_reference_renderer::shade::shader::LoadedMaterial;
use srbf_reference_renderer::study::comparison::report;
use srbf_reference_renderer::study::comparison::{self, Budgets, Case, Comparison, Method, Plan};
use srbf_reference_renderer::trace::cast::Cast;
use srbf_reference_renderer::trace::scene::SceneName;
use srbf_reference_renderer::truth::measured::{MeasuredMaterial, read_source};
use srbf_reference_renderer::truth::stored::{PRESETS, StoredMaterial};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Compares all unbiased methods after the same time, on measured materials of all kinds, and writes the page of it.
///
/// SRBF_DATA_DIR names the folder of the measurements. Tables are what is rendered, sampled by lobes that were fitted to them, which are
/// kept; and light and material together on the teapot. Writes OUT.md, and all measurements to OUT.csv beside the fits.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The folder of fits, NAME.srbf; what is missing is fitted and kept there
    #[arg(long, default_value = "out/fits", value_name = "DIR")]
    fits: PathBuf,
    /// Seconds of processors of each picture
    #[arg(long, default_value_t = 0.25, value_parser = compare::seconds)]
    seconds: f64,
    /// Pictures of each method
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(2..=1000), value_name = "N")]
    repeats: u32,
    /// Samples a pixel of references
    #[arg(long, default_value_t = 1024, value_parser = clap::value_parser!(u32).range(2..=1 << 24), value_name = "N")]
    reference_spp: u32,
    /// Sides of the square pictures in pixels
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=4096), value_name = "PIXELS")]
    side: u32,
    /// What the numbers of paths are: random ones, of which each sample is independent, or Owen-scrambled Sobol points
    #[arg(long, value_enum, default_value = "random")]
    points: PointsName,
    /// Only the materials whose names contain this
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// The page to write, .md
    #[arg(short, long, default_value = "out/error-against-time.md", value_name = "OUT.md")]
    output: PathBuf,
}

/// Measured materials: what they are called, and where they are in the data folder; from matte to mirror in each group.
const MATERIALS: [(&str, &str); 21] = [
    ("garnet_red", "cornell/garnet_red.brdf"),
    ("krylon_blue", "cornell/krylon_blue.brdf"),
    ("acryl_blue", "cornell/acryl_blue.brdf"),
    ("cayman", "cornell/cayman.brdf"),
    ("cm_military_green_rgb", "rgl/cm_military_green_rgb.bsdf"),
    ("aurora_white_rgb", "rgl/aurora_white_rgb.bsdf"),
    ("cc_green_malachite_rgb", "rgl/cc_green_malachite_rgb.bsdf"),
    ("vch_golden_yellow_rgb", "rgl/vch_golden_yellow_rgb.bsdf"),
    ("irid_flake_paint1_rgb", "rgl/irid_flake_paint1_rgb.bsdf"),
    ("chm_light_blue_rgb", "rgl/chm_light_blue_rgb.bsdf"),
    ("ilm_solo_m_68_rgb", "rgl/ilm_solo_m_68_rgb.bsdf"),
    ("pink-fabric", "merl/nbrdf_merl80.f32le:pink-fabric"),
    ("white-diffuse-bball", "merl/nbrdf_merl80.f32le:white-diffuse-bball"),
    ("green-latex", "merl/nbrdf_merl80.f32le:green-latex"),
    ("pvc", "merl/nbrdf_merl80.f32le:pvc"),
    ("yellow-matte-plastic", "merl/nbrdf_merl80.f32le:yellow-matte-plastic"),
    ("gold-metallic-paint", "merl/nbrdf_merl80.f32le:gold-metallic-paint"),
    ("blue-metallic-paint", "merl/nbrdf_merl80.f32le:blue-metallic-paint"),
    ("specular-green-phenolic", "merl/nbrdf_merl80.f32le:specular-green-phenolic"),
    ("alum-bronze", "merl/nbrdf_merl80.f32le:alum-bronze"),
    ("chrome", "merl/nbrdf_merl80.f32le:chrome"),
];

/// The light of the sphere.
const LIGHT: &str = "envmaps/cc0_forest_512.hdr";

/// Methods that sample the light too; the first is what the others are judged by.
const WITH_LIGHT: [&str; 10] = [
    "product",
    "even",
    "mis",
    "ggx+mis",
    "guided+mis",
    "lafortune+mis",
    "tabulated+mis",
    "rgl+mis",
    "cosine+mis",
    "light",
];

/// Methods that sample the material alone; the first is what the others are judged by.
const ALONE: [&str; 15] = [
    "lobes",
    "lobes-multi",
    "defensive",
    "guided",
    "ggx",
    "ward",
    "phong",
    "lafortune",
    "tabulated",
    "factored",
    "rgl",
    "thesis",
    "thesis-multi",
    "cosine",
    "uniform",
];

/// The lobes in place of their table.
const FIT: &str = "fit:product";

/// Lights and materials of the teapot, and what is compared there.
const TEAPOT_LIGHTS: [&str; 2] = ["envmaps/cc0_forest_512.hdr", "envmaps/grace_latlong.hdr"];
const TEAPOT_MATERIALS: [&str; 2] = ["garnet_red", "cayman"];
const TEAPOT_METHODS: [&str; 5] = ["product", "even", "mis", "ggx+mis", "lafortune+mis"];

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    output::check_extension(&args.output, "md")?;
    let csv = args.fits.join("error-against-time.csv");
    output::check_places(&[&args.output, &csv])?;
    let (start, commit) = (Instant::now(), text::commit());
    let data = argument::data_folder()?;
    let is_asked = |name: &str| args.only.as_ref().is_none_or(|part| name.contains(part.as_str()));
    let mut on_sphere = Vec::new();
    for (name, file) in MATERIALS.iter().filter(|entry| is_asked(entry.0)) {
        let result = sphere(args, &data, name, file).with_context(|| format!("material {name}"))?;
        println!("{}\n{}\n", result.title(), report::summary(&result));
        on_sphere.push(result);
    }
    let mut on_teapot = Vec::new();
    for name in TEAPOT_MATERIALS.iter().filter(|name| is_asked(name)) {
        for light in TEAPOT_LIGHTS {
            let result = teapot(args, &data, name, light)?;
            println!("{}\n{}\n", result.title(), report::summary(&result));
            on_teapot.push(result);
        }
    }
    let minutes = start.elapsed().as_secs_f64() / 60.0;
    let page = text::page(&text::Measured {
        on_sphere: &on_sphere,
        on_teapot: &on_teapot,
        seconds: args.seconds,
        repeats: args.repeats,
        side: args.side,
        minutes,
        commit,
    });
    output::write(&args.output, page.as_bytes())?;
    on_sphere.append(&mut on_teapot);
    report::write_csv(&csv, &on_sphere)?;
    println!("wrote {} and {}; {minutes:.1} minutes", args.output.display(), csv.display());
    Ok(())
}

/// All methods on the sphere, one scattering; the table is what is rendered.
fn sphere(args: &Args, data: &Path, name: &str, file: &str) -> anyhow::Result<Comparison> {
    let file = data.join(file).to_string_lossy().into_owned();
    let lobes = lobes(args, name, &file)?;
    let table = MeasuredMaterial::load(&file)?;
    let has_warps = table.draws().is_some();
    let object = LoadedMaterial::Table(Box::new(table));
    let cast = Cast::of(SceneName::Sphere, object, Some(lobes), None, None)?;
    let is_possible = |name: &&str| has_warps || !name.starts_with("rgl");
    let names = WITH_LIGHT.iter().chain(&ALONE).copied().filter(is_possible).chain([FIT]);
    measure(args, &cast, SceneName::Sphere, &data.join(LIGHT), methods(names)?)
}

/// What samples the light too on the teapot, with light between teapot and ground; the lobes are what is rendered.
fn teapot(args: &Args, data: &Path, name: &str, light: &str) -> anyhow::Result<Comparison> {
    let cast = Cast::of(SceneName::Teapot, LoadedMaterial::load(name)?, None, None, None)?;
    measure(args, &cast, SceneName::Teapot, &data.join(light), methods(TEAPOT_METHODS.into_iter())?)
}

fn methods(names: impl Iterator<Item = &'static str>) -> anyhow::Result<Vec<Method>> {
    names.map(|name| name.parse().map_err(anyhow::Error::msg)).collect()
}

fn measure(
    args: &Args,
    cast: &Cast,
    scene: SceneName,
    light: &Path,
    methods: Vec<Method>,
) -> anyhow::Result<Comparison> {
    let environment = argument::environment(&light.to_string_lossy())?;
    let plan = Plan {
        methods,
        size: [args.side; 2],
        budgets: Budgets::Seconds(vec![args.seconds]),
        repeats: args.repeats,
        reference_samples: args.reference_spp,
        points: args.points,
        max_bounces: if scene.is_sphere() { 1 } else { 6 },
        seed: 0,
        cache: None,
    };
    let light = light.file_stem().unwrap_or_default().to_string_lossy();
    let case = Case { scene, mesh: None, cast, light: &light, environment: &environment, sources: &[] };
    let progress = Progress::new(cast.object().name(), plan.steps());
    comparison::measure(&case, &plan, &progress)
}

/// The lobes of a material: a preset, a fit that was kept, or a fit that is made and kept.
fn lobes(args: &Args, name: &str, file: &str) -> anyhow::Result<StoredMaterial> {
    if PRESETS.iter().any(|preset| preset.0 == name) {
        return StoredMaterial::load(name);
    }
    let kept = args.fits.join(name).with_extension("srbf");
    if !kept.exists() {
        let progress = Progress::new(&format!("fitting {name}"), 1000);
        let mut done = 0;
        let fit = srbf_fit::fit_content(&read_source(file)?.content, &Settings::default(), |share| {
            let now = (1000.0 * share) as u64;
            progress.advance(now.saturating_sub(done));
            done = done.max(now);
        })?;
        output::write(&kept, &fit.bytes)?;
    }
    StoredMaterial::load(&kept.to_string_lossy())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_methods_are_known() {
        let names = WITH_LIGHT.iter().chain(&ALONE).chain(&TEAPOT_METHODS).copied();
        assert_eq!(methods(names.chain([FIT])).unwrap().len(), 31);
    }
}
