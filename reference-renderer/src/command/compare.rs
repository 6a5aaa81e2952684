//! `srbf compare`.

use super::argument;
use crate::numbers::points::PointsName;
use crate::out::output;
use crate::out::page::Page;
use crate::out::print::shown;
use crate::out::progress::Progress;
use crate::study::comparison::plot;
use crate::study::comparison::report;
use crate::study::comparison::{self, Budgets, Case, Comparison, Method, Plan};
use crate::trace::cast::{Cast, Names};
use crate::trace::scene::SceneName;
use crate::truth::stored;
use crate::world::environment::Environment;
use crate::world::mesh::{self, Mesh};
use anyhow::{Context, ensure};
use std::path::{Path, PathBuf};

/// Compares ways to sample: error against run time and against samples.
///
/// Renders scenes by each method with more and more samples, several times, and takes the error against a converged reference. Prints a
/// table for each scene, light and material, and writes OUT.csv, OUT.png (plots) and OUT.html (plots, tables, pictures side by side,
/// errors in false colours; a page that is complete by itself). Times are those of the processors that worked on a picture.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scenes, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', default_value = "sphere", value_name = "SCENE")]
    scenes: Vec<SceneName>,
    /// A .obj or .ply file, y up: the statue, or what takes the place of the teapot
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// Materials, separated by commas: .srbf files, names of presets, tables or models, as `render` takes them [default: all presets]
    #[arg(long, value_delimiter = ',', value_name = "FILE|PRESET|MODEL")]
    materials: Vec<String>,
    /// Lobes that sample tables: a .srbf file for each of the materials, separated by commas
    #[arg(long, value_delimiter = ',', value_name = "FILE|PRESET", requires = "materials")]
    lobes: Vec<String>,
    /// Lights, separated by commas: haze (the sun spread wide), sky, constant:VALUE, or .hdr or .exr files
    #[arg(long, value_delimiter = ',', default_value = "haze", value_name = "ENV")]
    env: Vec<String>,
    /// Methods, separated by commas; errors are given as multiples of the first one's. SAMPLER, SAMPLER+mis, mis, even, product or light, as
    /// `render --sampler` takes them; fit:METHOD renders the lobes that --lobes names in place of their table, which judges them
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "even,mis,product,lobes,ggx+mis,ggx,lafortune,cosine",
        value_name = "METHOD"
    )]
    samplers: Vec<Method>,
    /// The numbers of paths: Owen-scrambled Sobol points, as in `render`, or random numbers
    #[arg(long, value_enum, default_value = "sobol")]
    points: PointsName,
    /// Samples a pixel at which the error is taken, rising, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "1,4,16,64,256", conflicts_with = "seconds",
        value_parser = clap::value_parser!(u32).range(1..=1 << 24), value_name = "N")]
    spp: Vec<u32>,
    /// In place of --spp: seconds of processors after which the error is taken, rising, separated by commas; the same for each method
    #[arg(long, value_delimiter = ',', value_parser = seconds, value_name = "SECONDS")]
    seconds: Vec<f64>,
    /// Pictures of each method, each with a seed of its own: for error bars, and to tell bias from variance
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000), value_name = "N")]
    repeats: u32,
    /// Samples a pixel of the reference
    #[arg(long, default_value_t = 2048, value_parser = clap::value_parser!(u32).range(2..=1 << 24), value_name = "N")]
    reference_spp: u32,
    /// The folder where references are kept for later runs of the same program
    #[arg(long, default_value = "out/references", value_name = "DIR")]
    references: PathBuf,
    /// Keeps no references, and uses none that were kept
    #[arg(long, conflicts_with = "references")]
    no_references: bool,
    /// Sides of the square picture in pixels
    #[arg(long, default_value_t = 96, value_parser = clap::value_parser!(u32).range(1..=4096), value_name = "PIXELS")]
    side: u32,
    /// Scatterings along a path [default: 1 on the sphere, which is direct light only, else 6]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1000), value_name = "N")]
    max_bounces: Option<u32>,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; 0 is one a processor
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    threads: u16,
    /// The files to write, OUT.csv, OUT.png and OUT.html; any of the names will do
    #[arg(short, long, default_value = "out/compare", value_name = "OUT")]
    output: PathBuf,
}

/// Longest time budget.
const MAX_SECONDS: f64 = 86_400.0;

/// Parses a time budget.
pub fn seconds(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|v| *v > 0.0 && *v <= MAX_SECONDS);
    value.ok_or_else(|| format!("expected seconds, above 0 and at most {MAX_SECONDS}"))
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    check(args)?;
    let [csv, png, html] = outputs(&args.output);
    output::check_places(&[&csv, &png, &html])?;
    let comparisons = argument::on_threads(args.threads.into(), || compare(args))?;

    let files = output::together();
    report::write_csv(&csv, &comparisons)?;
    plot::write_png(&png, &comparisons)?;
    page(&comparisons)?.write(&html)?;
    files.commit()?;
    println!("processor: {}", srbf_core::Processor::this());
    println!("wrote {}, {} and {}", shown(&csv), shown(&png), shown(&html));
    Ok(())
}

/// Refuses options that do not fit together, before the work.
fn check(args: &Args) -> anyhow::Result<()> {
    ensure!(args.spp.is_sorted_by(|a, b| a < b), "--spp: numbers that rise are expected");
    ensure!(args.seconds.is_sorted_by(|a, b| a < b), "--seconds: numbers that rise are expected");
    ensure!(!args.samplers.is_empty() && !args.spp.is_empty(), "--samplers and --spp: at least one each");
    let count = materials(args).len();
    ensure!(
        args.lobes.is_empty() || args.lobes.len() == count,
        "--lobes: {} names for {count} materials, one each is expected",
        args.lobes.len(),
    );
    for (i, method) in args.samplers.iter().enumerate() {
        ensure!(
            !args.samplers[..i].contains(method),
            "--samplers: {method} is there twice, once is expected"
        );
    }
    for scene in &args.scenes {
        ensure!(
            *scene != SceneName::Statue || args.mesh.is_some(),
            "--scenes statue: --mesh FILE is expected, which is the statue"
        );
        ensure!(
            args.mesh.is_none() || scene.takes_mesh(),
            "--mesh: it takes the place of the teapot, --scenes teapot, statue or room are expected"
        );
        ensure!(
            *scene != SceneName::Furnace || args.env.iter().all(|env| env.starts_with("constant:")),
            "--scenes furnace: its light is the same from everywhere, --env constant:VALUE is expected"
        );
    }
    Ok(())
}

/// Names of the materials.
fn materials(args: &Args) -> Vec<String> {
    if args.materials.is_empty() {
        return stored::PRESETS.iter().map(|preset| preset.0.to_owned()).collect();
    }
    args.materials.clone()
}

/// A light and what tables call it.
struct Light {
    name: String,
    source: String,
    environment: Environment,
}

fn compare(args: &Args) -> anyhow::Result<Vec<Comparison>> {
    // All is loaded before the work, so that a fault in the last name is found at once.
    let lights: Vec<Light> = args.env.iter().map(|text| Light::load(text)).collect::<anyhow::Result<_>>()?;
    let mesh = args.mesh.as_deref().map(mesh::file::read).transpose()?.map(|mut mesh: Mesh| {
        mesh.turn_y_up();
        mesh
    });
    let materials = materials(args);
    let mut casts = Vec::new();
    for &scene in &args.scenes {
        for (i, object) in materials.iter().enumerate() {
            let lobes = args.lobes.get(i).map(String::as_str);
            casts.push((
                scene,
                object,
                lobes,
                Cast::load(scene, Names { object, lobes, ..Names::default() })?,
            ));
        }
    }
    let mut comparisons = Vec::new();
    for (scene, object, lobes, cast) in &casts {
        for light in &lights {
            let mut sources = vec![(*object).clone(), light.source.clone()];
            sources.extend(lobes.iter().map(|name| (*name).to_owned()));
            sources.extend(args.mesh.iter().map(|path| path.to_string_lossy().into_owned()));
            let case = Case {
                scene: *scene,
                mesh: mesh.as_ref(),
                cast,
                light: &light.name,
                environment: &light.environment,
                sources: &sources,
            };
            let plan = plan(args, *scene);
            let progress = Progress::new(cast.object().name(), plan.steps());
            let result = comparison::measure(&case, &plan, &progress)
                .with_context(|| format!("{} under {}", scene.text(), light.name))?;
            drop(progress);
            report::print(&result);
            println!();
            comparisons.push(result);
        }
    }
    Ok(comparisons)
}

fn plan(args: &Args, scene: SceneName) -> Plan {
    let budgets = if args.seconds.is_empty() {
        Budgets::Samples(args.spp.clone())
    } else {
        Budgets::Seconds(args.seconds.clone())
    };
    Plan {
        methods: args.samplers.clone(),
        size: [args.side; 2],
        budgets,
        repeats: args.repeats,
        reference_samples: args.reference_spp,
        max_bounces: args.max_bounces.unwrap_or(if scene.is_sphere() { 1 } else { 6 }),
        points: args.points,
        seed: args.seed,
        cache: (!args.no_references).then(|| args.references.clone()),
    }
}

/// The page of HTML.
fn page(comparisons: &[Comparison]) -> anyhow::Result<Page> {
    let mut page = Page::new("Error against run time");
    let command: Vec<String> = std::env::args().skip(1).collect();
    page.lines(&format!("srbf {}", command.join(" ")));
    page.paragraph(comparison::page::WORDS);
    comparison::page::add(&mut page, comparisons)?;
    Ok(page)
}

/// The files that are written. Only their own extensions are put in place of one another: a name may hold a point.
fn outputs(given: &Path) -> [PathBuf; 3] {
    const ENDINGS: [&str; 3] = ["csv", "png", "html"];
    let is_ours = given.extension().is_some_and(|e| ENDINGS.iter().any(|ending| e == *ending));
    let stem = if is_ours { given.with_extension("") } else { given.to_owned() };
    ENDINGS.map(|extension| {
        let mut path = stem.clone().into_os_string();
        path.push(format!(".{extension}"));
        PathBuf::from(path)
    })
}

impl Light {
    fn load(text: &str) -> anyhow::Result<Self> {
        // A file by its name without folder and extension.
        let name = if text.starts_with("constant:") {
            text.to_owned()
        } else {
            Path::new(text).file_stem().unwrap_or_default().to_string_lossy().into_owned()
        };
        Ok(Self { name, source: text.to_owned(), environment: argument::environment(text)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_name_of_the_outputs_names_all() {
        for (given, stem) in [
            ("a/b", "a/b"),
            ("b.csv", "b"),
            ("b.png", "b"),
            ("b.html", "b"),
            ("b.v1", "b.v1"),
            ("b.csv/c", "b.csv/c"),
        ] {
            let expected = ["csv", "png", "html"].map(|end| PathBuf::from(format!("{stem}.{end}")));
            assert_eq!(outputs(Path::new(given)), expected, "{given}");
        }
    }

    #[test]
    fn time_budgets() {
        assert_eq!(seconds("0.25"), Ok(0.25));
        for text in ["", "0", "-1", "nan", "inf", "1e9", "1s"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
