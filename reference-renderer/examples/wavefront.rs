//! Time of pictures by single paths and by waves of paths, on one thread: `cargo run --release -p srbf-reference-renderer --example wavefront`.
//!
//! The teapot with the material garnet red on matte ground, and the teapot on a floor of tiles of thirty materials, no two alike. Light
//! and lobes are sampled side by side. Times are of the processor, the least of several rounds in which both ways take turns; means
//! are of all pixels.

use glam::DVec3;
use srbf_core::{Line, Material, PlaneLobe, Processor, View};
use srbf_reference_renderer::numbers::points::PointsName;
use srbf_reference_renderer::out::progress::Progress;
use srbf_reference_renderer::shade::Light;
use srbf_reference_renderer::trace::film::Film;
use srbf_reference_renderer::trace::render::{add_samples, add_samples_by_waves};
use srbf_reference_renderer::trace::scene::{Scene, SceneName};
use srbf_reference_renderer::trace::settings::RenderSettings;
use srbf_reference_renderer::truth::stored::StoredMaterial;
use srbf_reference_renderer::world::environment::sky;
use std::borrow::Cow;

const SIZE: [u32; 2] = [160, 120];
const SAMPLES: u32 = 16;
const ROUNDS: usize = 7;
const MATERIALS: usize = 30;

fn main() -> anyhow::Result<()> {
    println!("processor: {}", Processor::this());
    let settings =
        RenderSettings { light: Light::Mis, split: 1, max_bounces: 6, points: PointsName::Sobol, seed: 0 };
    let light = sky::haze();
    let (garnet, ground) = (StoredMaterial::load("garnet_red")?, StoredMaterial::load("matte")?);
    let many: Vec<StoredMaterial> =
        (0..MATERIALS).map(|i| varied(&garnet, i)).collect::<anyhow::Result<_>>()?;
    let shaders: Vec<_> = many.iter().map(|stored| (&stored.material).into()).collect();
    let scenes = [
        ("teapot", Scene::new(SceneName::Teapot, &garnet.material, &ground.material, &light)),
        ("thirty materials", Scene::mosaic(&shaders, &light)),
    ];
    let camera = SceneName::Teapot.camera(SIZE);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    println!("{:<18}{:>12}{:>12}{:>8}   mean of the pictures", "ns a path", "single", "waves", "ratio");
    for (name, scene) in &scenes {
        let (mut least, mut means) = ([f64::INFINITY; 2], [DVec3::ZERO; 2]);
        for _ in 0..ROUNDS {
            for (way, add) in [add_samples, add_samples_by_waves].into_iter().enumerate() {
                let mut film = Film::new(SIZE);
                let hidden = Progress::hidden();
                let time = pool.install(|| add(scene, &camera, &settings, &mut film, SAMPLES, &hidden))?;
                let paths = film.pixels.len() as f64 * f64::from(SAMPLES);
                least[way] = least[way].min(time.as_secs_f64() * 1e9 / paths);
                means[way] =
                    (0..film.pixels.len()).map(|i| film.mean(i)).sum::<DVec3>() / film.pixels.len() as f64;
            }
        }
        let [single, waves] = least;
        println!(
            "{name:<18}{single:>12.0}{waves:>12.0}{:>8.3}   {:.5} {:.5}",
            waves / single,
            means[0],
            means[1]
        );
    }
    Ok(())
}

/// The material with other widths and colours, by a number.
fn varied(from: &StoredMaterial, number: usize) -> anyhow::Result<StoredMaterial> {
    let material: &Material<_> = &from.material;
    let change = |k: usize| 0.5 * ((0.618 * (number * (k + 1)) as f32).fract() - 0.5);
    let lobes_of = |view: usize| -> Vec<PlaneLobe> {
        let of = |k| {
            let mut lobe = material.view_lobe(view, k)?;
            lobe.log2_sharpness += change(0);
            // -126 stands for none.
            lobe.log2_luminance = (lobe.log2_luminance + change(0) + change(1)).max(-126.0);
            lobe.color_differences = lobe.color_differences.map(|d| d * (0.75 + change(2)));
            Some(lobe)
        };
        (0..material.view_lobe_count()).filter_map(of).collect()
    };
    let lobes: Vec<Vec<PlaneLobe>> = (0..material.view_count()).map(lobes_of).collect();
    let view = |v: usize| -> Option<View<'_>> {
        Some(View {
            theta: material.view_theta(v)?,
            log2_squeeze: material.view_log2_squeeze(v)?,
            log2_diffuse: (material.view_log2_diffuse(v)? + change(3)).max(-126.0),
            diffuse_color_differences: material.view_diffuse_color_differences(v)?,
            lobes: &lobes[v],
        })
    };
    let views: Vec<View<'_>> = (0..material.view_count()).filter_map(view).collect();
    let line = Line {
        views: &views,
        squeezed: material.squeezed_count(),
        mirrored: material.mirrored_count(),
        factors: None,
    };
    let mut bytes = vec![0; line.encoded_len("")];
    let length = line.encode("", &mut bytes)?;
    bytes.truncate(length);
    StoredMaterial::new(&format!("garnet {number}"), Cow::Owned(bytes))
}
