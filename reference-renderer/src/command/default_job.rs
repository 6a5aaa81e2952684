//! `srbf` without a command: pictures of a preset, and a comparison of samplers, from what is embedded.

use crate::cast::Cast;
use crate::comparison::{self, Budgets, Case, Method, Plan};
use crate::environment::sky;
use crate::film::Film;
use crate::material::{self, StoredMaterial};
use crate::points::PointsName;
use crate::progress::Progress;
use crate::render::{Settings, add_samples};
use crate::sampling::{Light, SamplerName, Strategy};
use crate::scene::{Scene, SceneName};
use crate::shader::LoadedMaterial;
use crate::{picture_file, plot, report};
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
    Picture { scene: SceneName::Teapot, file: "teapot.exr", size: [720, 450], samples: 128 },
];

/// What is compared.
const METHODS: [Strategy; 3] =
    [Strategy::PRODUCT, Strategy::alone(SamplerName::Lobes), Strategy::alone(SamplerName::Cosine)];

/// Runs the job; writes into the folder.
pub fn run(out: &Path) -> anyhow::Result<()> {
    let start = Instant::now();
    let sky = sky::sky();
    let object = StoredMaterial::load(material::DEFAULT)?;
    let ground = StoredMaterial::load(material::MATTE)?;
    for Picture { scene: name, file, size, samples } in PICTURES {
        let scene = Scene::new(name, &object.material, &ground.material, &sky);
        let settings =
            Settings { light: Light::Mis, split: 1, max_bounces: 6, points: PointsName::Sobol, seed: 0 };
        let (mut film, path) = (Film::new(size), out.join(file));
        let progress = Progress::new(file, size[1].into());
        add_samples(&scene, &name.camera(size), &settings, &mut film, samples, &progress)?;
        drop(progress);
        let picture = film.to_picture();
        picture_file::write_exr(&path, size, &picture)?;
        let exposure = picture_file::automatic_exposure(&picture);
        picture_file::write_tone_mapped_png(&path.with_extension("png"), size, &picture, exposure)?;
        println!(
            "{}: {} under the sky, {samples} samples a pixel, PNG beside it",
            path.display(),
            object.name
        );
    }

    let plan = Plan {
        methods: METHODS.map(Method::of).to_vec(),
        size: [96; 2],
        budgets: Budgets::Samples((0..=4).map(|i| 1 << (2 * i)).collect()),
        repeats: 3,
        reference_samples: 1024,
        max_bounces: 1,
        seed: 0,
        cache: None,
    };
    let (cast, haze) =
        (Cast::of(SceneName::Sphere, LoadedMaterial::Lobes(object), None, None, None)?, sky::haze());
    let case = Case {
        scene: SceneName::Sphere,
        mesh: None,
        cast: &cast,
        light: "haze",
        environment: &haze,
        sources: &[],
    };
    let progress = Progress::new("comparing samplers", plan.steps());
    let comparison = comparison::measure(&case, &plan, &progress)?;
    drop(progress);
    println!();
    report::print(&comparison);
    let csv = out.join("error-vs-time.csv");
    report::write_csv(&csv, std::slice::from_ref(&comparison))?;
    plot::write_png(&csv.with_extension("png"), &[comparison])?;
    println!("\n{}, plot beside it; {:.0} s in all", csv.display(), start.elapsed().as_secs_f64());
    Ok(())
}
