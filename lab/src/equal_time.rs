//! `srbf-lab equal-time`: samplers and ways to sample the light beside each other, with every truth, scene, map and kind of points.
//!
//! | file | holds |
//! |---|---|
//! | `ratio` | errors over one another, and their uncertainty |
//! | `text` | the page, as Markdown and as HTML |

mod ratio;
mod text;

use anyhow::{Context, ensure};
use srbf_fit::Settings;
use srbf_reference_renderer::command::argument;
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
use srbf_reference_renderer::world::environment::Environment;
use srbf_reference_renderer::world::mesh::{self, Mesh};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Compares samplers alone, with a sample of the light, and by even sums: after the same time and after the same samples.
///
/// SRBF_DATA_DIR names the folder of the measurements. Four materials, as lobes and as the table that they were fitted to, in five scenes
/// and under three maps, with Sobol points and with random numbers. Writes OUT.md, OUT.html, OUT.csv, OUT.points.csv, and
/// OUT.summary.csv, which docs/figures has as error-against-time.csv; a quarter of an hour on two processors that nothing else uses.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The folder of fits, NAME.srbf, and of references; missing ones are made and kept there
    #[arg(long, default_value = "out/fits", value_name = "DIR")]
    fits: PathBuf,
    /// Samples a pixel after which the error is taken: two numbers, rising. Between them the time of a sample is taken too
    #[arg(long, value_delimiter = ',', default_value = "16,64", value_parser = clap::value_parser!(u32).range(1..=1 << 20), value_name = "N,N")]
    spp: Vec<u32>,
    /// What draws, beside `lobes`, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "ggx,lafortune,rgl", value_name = "SAMPLER")]
    samplers: Vec<String>,
    /// Pictures of each method; fewer make the interval wider, by the t factor
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(2..=1000), value_name = "N")]
    repeats: u32,
    /// Samples a pixel of references
    #[arg(long, default_value_t = 1024, value_parser = clap::value_parser!(u32).range(2..=1 << 24), value_name = "N")]
    reference_spp: u32,
    /// Sides of the square pictures in pixels
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=4096), value_name = "PIXELS")]
    side: u32,
    /// Only the materials whose names contain this
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Only the scenes whose names contain this
    #[arg(long, value_name = "SCENE")]
    scene: Option<String>,
    /// The page to write, .md
    #[arg(short, long, default_value = "out/error-against-time.md", value_name = "OUT.md")]
    output: PathBuf,
}

/// Measured materials: their names, and their places in the data folder.
pub const MATERIALS: [(&str, &str); 4] = [
    ("garnet_red", "cornell/garnet_red.brdf"),
    ("cayman", "cornell/cayman.brdf"),
    ("vch_golden_yellow_rgb", "rgl/vch_golden_yellow_rgb.bsdf"),
    ("cc_green_malachite_rgb", "rgl/cc_green_malachite_rgb.bsdf"),
];

/// Maps of light.
const FOREST: &str = "envmaps/cc0_forest_512.hdr";
const GRACE: &str = "envmaps/grace_latlong.hdr";
const UFFIZI: &str = "envmaps/uffizi_latlong.hdr";
/// The same light from everywhere.
const EVERYWHERE: &str = "constant:1";

/// The statue.
const STATUE: &str = "meshes/happy_buddha_20k.ply";

/// Scenes with their light.
const PLACES: [(SceneName, &str); 7] = [
    (SceneName::Sphere, FOREST),
    (SceneName::Sphere, GRACE),
    (SceneName::Teapot, FOREST),
    (SceneName::Teapot, GRACE),
    (SceneName::Statue, UFFIZI),
    (SceneName::Room, GRACE),
    (SceneName::Furnace, EVERYWHERE),
];

/// What draws and is ours.
const OURS: &str = "lobes";

/// Ways to sample the light; the last is the renderer's own.
const WAYS: [Way; 3] = [Way::Alone, Way::Mis, Way::Even];

/// The treatment of the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    /// It is not sampled.
    Alone,
    /// One sample of it, weighted by the power heuristic.
    Mis,
    /// Sixteen samples of it, in sums that two rays correct.
    Even,
}

impl Way {
    /// As headings call it.
    fn text(self) -> &'static str {
        match self {
            Self::Alone => "alone",
            Self::Mis => "mis",
            Self::Even => "even",
        }
    }
}

/// The name of a method.
fn method_name(sampler: &str, way: Way) -> String {
    match (sampler, way) {
        ("lobes", Way::Mis) => "mis".to_owned(),
        ("lobes", Way::Even) => "even".to_owned(),
        (name, Way::Alone) => name.to_owned(),
        (name, way) => format!("{name}+{}", way.text()),
    }
}

/// Names of all methods with these samplers, the renderer's own first.
fn method_names(samplers: &[String]) -> Vec<String> {
    let mut names = vec!["even".to_owned()];
    for way in WAYS {
        let all = std::iter::once(OURS).chain(samplers.iter().map(String::as_str));
        names.extend(all.map(|name| method_name(name, way)).filter(|name| name != "even"));
    }
    names.push("product".to_owned());
    names
}

/// The material that is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rendered {
    Lobes,
    Table,
}

impl Rendered {
    fn text(self) -> &'static str {
        match self {
            Self::Lobes => "lobes",
            Self::Table => "table",
        }
    }
}

/// The curves of one case.
struct Measured {
    rendered: Rendered,
    points: PointsName,
    comparison: Comparison,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    output::check_extension(&args.output, "md")?;
    ensure!(args.spp.len() == 2 && args.spp[0] < args.spp[1], "--spp: two numbers that rise are expected");
    for name in method_names(&args.samplers) {
        name.parse::<Method>().map_err(|error| anyhow::anyhow!("--samplers: {name}: {error}"))?;
    }
    let ends = ["csv", "html", "points.csv", "summary.csv"];
    let [csv, html, points, summary] = ends.map(|end| args.output.with_extension(end));
    output::check_places(&[&args.output, &csv, &html, &points, &summary])?;
    let (start, commit) = (Instant::now(), text::commit());
    let data = argument::data_folder()?;
    let is_asked =
        |name: &str, part: &Option<String>| part.as_ref().is_none_or(|part| name.contains(part.as_str()));
    let places: Vec<_> = PLACES.iter().filter(|place| is_asked(place.0.text(), &args.scene)).collect();
    let materials: Vec<_> = MATERIALS.iter().filter(|entry| is_asked(entry.0, &args.only)).collect();
    ensure!(!places.is_empty() && !materials.is_empty(), "--only and --scene: no such material or scene");
    // All that is read, before the work.
    let mut statue = mesh::file::read(&data.join(STATUE))?;
    statue.turn_y_up();
    let mut lights: Vec<(&str, Environment)> = Vec::new();
    for (_, light) in &places {
        if lights.iter().all(|(name, _)| name != light) {
            let named = if light.contains(':') {
                (*light).to_owned()
            } else {
                data.join(light).to_string_lossy().into_owned()
            };
            lights.push((light, argument::environment(&named)?));
        }
    }
    let mut measured = Vec::new();
    for (name, file) in materials {
        let file = data.join(file).to_string_lossy().into_owned();
        let lobes = lobes(&args.fits, name, &file)?;
        for rendered in [Rendered::Lobes, Rendered::Table] {
            // Read, and completed, once for all scenes.
            let mut object = match rendered {
                Rendered::Lobes => LoadedMaterial::Lobes(lobes.clone()),
                Rendered::Table => LoadedMaterial::Table(Box::new(MeasuredMaterial::load(&file)?)),
            };
            for (scene, light) in &places {
                let environment = &lights.iter().find(|(other, _)| other == light).context("a light")?.1;
                let of_table = (rendered == Rendered::Table).then(|| lobes.clone());
                let mut cast = Cast::of(*scene, object, of_table, None, None)?;
                let place = SceneUnderLight { scene: *scene, statue: &statue, light, environment };
                for points in [PointsName::Sobol, PointsName::Random] {
                    let comparison = measure(args, &cast, &place, rendered, name, points)
                        .with_context(|| format!("material {name}, {} rendered", rendered.text()))?;
                    println!("{}, {}, {}", comparison.title(), rendered.text(), points_text(points));
                    println!("{}\n", text::summary(&comparison));
                    measured.push(Measured { rendered, points, comparison });
                }
                object = cast.roles.swap_remove(0).1;
                // After every scene, so that a run that is stopped has printed its results so far.
                let minutes = start.elapsed().as_secs_f64() / 60.0;
                let page = text::Text { measured: &measured, args, minutes, commit: &commit };
                let files = output::together();
                output::write(&args.output, page.markdown().as_bytes())?;
                page.html().write(&html)?;
                let comparisons: Vec<Comparison> = measured.iter().map(Measured::named).collect();
                report::write_csv(&points, &comparisons)?;
                output::write(&csv, &page.csv()?)?;
                output::write(&summary, &page.summary_csv()?)?;
                files.commit()?;
            }
        }
    }
    let files = [&args.output, &html, &csv, &points, &summary].map(|path| path.display().to_string());
    println!("wrote {}", files.join(", "));
    Ok(())
}

impl Measured {
    /// With the rendered material and the points in its name, for a file.
    fn named(&self) -> Comparison {
        let material =
            format!("{} ({}, {})", self.comparison.material, self.rendered.text(), points_text(self.points));
        Comparison { material, ..self.comparison.clone() }
    }
}

fn points_text(points: PointsName) -> &'static str {
    match points {
        PointsName::Sobol => "Sobol",
        PointsName::Random => "random",
    }
}

/// A scene and its light.
struct SceneUnderLight<'a> {
    scene: SceneName,
    statue: &'a Mesh,
    light: &'a str,
    environment: &'a Environment,
}

fn measure(
    args: &Args,
    cast: &Cast,
    place: &SceneUnderLight<'_>,
    rendered: Rendered,
    name: &str,
    points: PointsName,
) -> anyhow::Result<Comparison> {
    let has_warps = cast.object().truth().draws().is_some();
    let names = method_names(&args.samplers).into_iter().filter(|name| has_warps || !name.starts_with("rgl"));
    let methods: Vec<Method> =
        names.map(|name| name.parse().map_err(anyhow::Error::msg)).collect::<anyhow::Result<_>>()?;
    let plan = Plan {
        methods,
        size: [args.side; 2],
        budgets: Budgets::Samples(args.spp.clone()),
        repeats: args.repeats,
        reference_samples: args.reference_spp,
        points,
        max_bounces: if place.scene.is_sphere() { 1 } else { 6 },
        seed: 0,
        cache: Some(args.fits.join("references")),
    };
    let light = Path::new(place.light).file_stem().unwrap_or_default().to_string_lossy();
    let sources = [name.to_owned(), rendered.text().to_owned(), place.light.to_owned()];
    let case = Case {
        scene: place.scene,
        mesh: (place.scene == SceneName::Statue).then_some(place.statue),
        cast,
        light: &light,
        environment: place.environment,
        sources: &sources,
    };
    let progress = Progress::new(cast.object().name(), plan.steps());
    comparison::measure(&case, &plan, &progress)
}

/// The lobes of a material: a preset, a fit that was kept, or a fit that is made and kept.
pub fn lobes(fits: &Path, name: &str, file: &str) -> anyhow::Result<StoredMaterial> {
    if PRESETS.iter().any(|preset| preset.0 == name) {
        return StoredMaterial::load(name);
    }
    let kept = fits.join(name).with_extension("srbf");
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
    fn all_methods_are_known_and_named_as_they_are_read() {
        let names = method_names(&["ggx", "lafortune", "rgl"].map(String::from));
        assert_eq!(names.len(), 4 * WAYS.len() + 1);
        for name in names {
            assert_eq!(name.parse::<Method>().unwrap().to_string(), name);
        }
    }
}
