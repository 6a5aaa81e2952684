//! `srbf` without a command: pictures of a preset, error against run time, and a page of both, from embedded materials and light.

use crate::numbers::points::PointsName;
use crate::out::output;
use crate::out::page::{Figure, Page};
use crate::out::picture_file;
use crate::out::print::shown;
use crate::out::progress::Progress;
use crate::shade::shader::LoadedMaterial;
use crate::shade::{SamplerName, Strategy};
use crate::study::comparison::plot;
use crate::study::comparison::report;
use crate::study::comparison::{self, Budgets, Case, Comparison, Method, Plan};
use crate::trace::cast::Cast;
use crate::trace::film::Film;
use crate::trace::render::add_samples;
use crate::trace::scene::{Scene, SceneName};
use crate::trace::settings::RenderSettings;
use crate::truth::stored::{self, StoredMaterial};
use crate::world::environment::{Environment, sky};
use std::path::Path;
use std::time::Instant;

/// A picture of the job.
struct Picture {
    scene: SceneName,
    file: &'static str,
    size: [u32; 2],
    samples: u32,
}

/// Sizes and samples are such that the job takes about a minute on two cores, most of it the teapot.
const PICTURES: [Picture; 2] = [
    Picture { scene: SceneName::Sphere, file: "sphere.exr", size: [400, 400], samples: 64 },
    Picture { scene: SceneName::Teapot, file: "teapot.exr", size: [720, 450], samples: 64 },
];

/// The materials of the comparison: a lacquer with a wide highlight, and a metallic paint with a sharp one.
const METHODS: [Strategy; 7] = [
    Strategy::EVEN,
    Strategy::MIS,
    Strategy::PRODUCT,
    Strategy::alone(SamplerName::Lobes),
    Strategy::alone(SamplerName::Ggx),
    Strategy::alone(SamplerName::Lafortune),
    Strategy::alone(SamplerName::Cosine),
];
const MATERIALS: [&str; 2] = ["garnet_red", "cayman"];

/// Runs the job; writes into the folder.
pub fn run(out: &Path) -> anyhow::Result<()> {
    let start = Instant::now();
    let (csv, report) = (out.join("error-vs-time.csv"), out.join("report.html"));
    let plot = csv.with_extension("png");
    output::check_places(&[&csv, &plot, &report])?;
    for picture in PICTURES {
        let path = out.join(picture.file);
        output::check_places(&[&path, &path.with_extension("png")])?;
    }
    let mut page = Page::new("Measured materials as lobes");
    render(out, &mut page)?;
    let comparisons = compare()?;

    report::write_csv(&csv, &comparisons)?;
    plot::write_png(&plot, &comparisons)?;
    page.heading("Error against run time");
    page.paragraph(comparison::page::WORDS);
    comparison::page::add(&mut page, &comparisons)?;
    page.write(&report)?;
    println!("{}, plot beside it; all of it: {}", shown(&csv), shown(&report));
    println!("{:.0} s in all", start.elapsed().as_secs_f64());
    Ok(())
}

/// Renders the pictures, light and material sampled together.
fn render(out: &Path, page: &mut Page) -> anyhow::Result<()> {
    let sky = sky::sky();
    let object = StoredMaterial::load(stored::DEFAULT)?;
    let ground = StoredMaterial::load(stored::MATTE)?;
    let mut figures = Vec::new();
    for Picture { scene: name, file, size, samples } in PICTURES {
        let scene = Scene::new(name, &object.material, &ground.material, &sky);
        let settings = RenderSettings {
            light: Strategy::EVEN.light,
            split: 1,
            max_bounces: 6,
            points: PointsName::Sobol,
            seed: 0,
        };
        let (mut film, path) = (Film::new(size), out.join(file));
        let progress = Progress::new(file, size[1].into());
        add_samples(&scene, &name.camera(size), &settings, &mut film, samples, &progress)?;
        drop(progress);
        if let Some(warning) = film.warning() {
            eprintln!("{}: {warning}", shown(&path));
        }
        let picture = film.to_picture();
        picture_file::write_exr(&path, size, &picture)?;
        let bytes = picture_file::tone_mapped(&picture, sky.exposure());
        picture_file::write_png(&path.with_extension("png"), size, &bytes)?;
        let title = format!("{} under the sky, {samples} samples a pixel", object.name);
        println!("{}: {title}, PNG beside it", shown(&path));
        figures.push(Figure::new(picture_file::encode_png(size, &bytes)?, title));
    }
    page.heading("Pictures");
    page.paragraph("Twelve lobes a view and a diffuse term; light and lobes are sampled together by even sums, one shadow ray a surface.");
    page.row(&figures);
    Ok(())
}

/// Compares on the sphere.
fn compare() -> anyhow::Result<Vec<Comparison>> {
    let plan = Plan {
        methods: METHODS.map(Method::of).to_vec(),
        size: [96; 2],
        budgets: Budgets::Samples(vec![1, 4, 16, 64]),
        repeats: 3,
        reference_samples: 1024,
        max_bounces: 1,
        points: PointsName::Sobol,
        seed: 0,
        cache: None,
    };
    let haze = sky::haze();
    MATERIALS.iter().map(|name| compare_one(&plan, name, &haze)).collect()
}

fn compare_one(plan: &Plan, name: &str, haze: &Environment) -> anyhow::Result<Comparison> {
    let cast = Cast::of(SceneName::Sphere, LoadedMaterial::load(name)?, None, None, None)?;
    let case = Case {
        scene: SceneName::Sphere,
        mesh: None,
        cast: &cast,
        light: "haze",
        environment: haze,
        sources: &[],
    };
    let progress = Progress::new(&format!("comparing on {name}"), plan.steps());
    let comparison = comparison::measure(&case, plan, &progress)?;
    drop(progress);
    println!("\n{}\n{}", comparison.title(), report::summary(&comparison));
    Ok(comparison)
}
