//! Adds samples to a picture, in parallel over its rows.

use crate::numbers::points::{Decision, Points};
use crate::out::progress::Progress;
use crate::shade::Light;
use crate::trace::camera::Camera;
use crate::trace::film::Film;
use crate::trace::integrator::even::Lighting;
use crate::trace::integrator::{Workspace, radiance};
use crate::trace::scene::Scene;
use crate::trace::settings::RenderSettings;
use cpu_time::ThreadTime;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// Samples of a million that may be lost: more are no accident.
const MAY_BE_LOST: u64 = 100;

/// Adds `samples` samples, rays of the camera, to every pixel of a film; advances the progress by the number of rows. Gives the time that
/// processors worked on it, summed over the threads: what else runs on the machine is not counted.
///
/// The value of a pixel depends only on the seed, the pixel and the samples it holds already: not on the threads. A sample that is not finite
/// is lost: it counts as black, and the film counts it.
///
/// # Errors
/// More than one lost sample in ten thousand: the values of a material or light are too extreme for f32.
pub fn add_samples(
    scene: &Scene<'_>,
    camera: &Camera,
    settings: &RenderSettings,
    film: &mut Film,
    samples: u32,
    progress: &Progress,
) -> anyhow::Result<Duration> {
    let mut time = Duration::ZERO;
    let (from, to) = (film.samples, film.samples + samples);
    let is_together = settings.light == Light::Even && scene.environment.constant_radiance().is_none();
    let at_once = if is_together { Lighting::samples(settings) } else { u32::MAX };
    let mut lost = Lost::default();
    let mut held = from;
    while held < to {
        let number = held / at_once;
        let next = (number + 1).saturating_mul(at_once).min(to);
        let start = ThreadTime::now();
        let lighting = is_together.then(|| {
            let key = [settings.seed, number.into()];
            let kept = film.lighting.take().filter(|kept| kept.0 == key).map(|kept| kept.1);
            let lighting =
                kept.unwrap_or_else(|| Arc::new(Lighting::new(scene, camera, film.size(), settings, key[1])));
            film.lighting = Some((key, lighting.clone()));
            lighting
        });
        time += start.elapsed();
        let (part, found) = add_range(scene, camera, settings, lighting.as_deref(), film, held..next, || {
            if next == to {
                progress.advance(1);
            }
        });
        (time, lost, held) = (time + part, lost.and(found), next);
    }
    film.samples = to;
    film.lost += lost.count;
    let (width, of) = (film.size()[0] as usize, u64::from(samples) * film.pixels.len() as u64);
    match lost.first {
        Some((i, radiance)) if lost.count * 1_000_000 > of * MAY_BE_LOST => anyhow::bail!(
            "{} of {of} samples are not finite, the first, in column {}, row {}, is {radiance}: finite radiance is expected, and the \
             values of a material or of the light leave the range of f32",
            lost.count,
            i % width,
            i / width,
        ),
        _ => Ok(time),
    }
}

/// Samples that are not finite: how many, and the first pixel that has one, with its value.
#[derive(Clone, Copy, Default)]
struct Lost {
    count: u64,
    first: Option<(usize, Vec3)>,
}

impl Lost {
    /// Together with those of another part of the picture.
    fn and(self, other: Self) -> Self {
        let first = match (self.first, other.first) {
            (Some(a), Some(b)) => Some(if b.0 < a.0 { b } else { a }),
            (a, b) => a.or(b),
        };
        Self { count: self.count + other.count, first }
    }
}

/// Adds a range of the samples of every pixel.
fn add_range(
    scene: &Scene<'_>,
    camera: &Camera,
    settings: &RenderSettings,
    lighting: Option<&Lighting>,
    film: &mut Film,
    samples: Range<u32>,
    advance: impl Fn() + Sync,
) -> (Duration, Lost) {
    let width = film.size()[0] as usize;
    let rows = film.pixels.par_chunks_mut(width).enumerate();
    let parts = rows.map_init(Workspace::default, |workspace, (y, row)| {
        let start = ThreadTime::now();
        let mut lost = Lost::default();
        for (x, pixel) in row.iter_mut().enumerate() {
            let index = y * width + x;
            for sample in samples.clone() {
                let points = Points::new(settings.points, settings.seed, index as u64, sample.into());
                let [across, down, ..] = points.draw(Decision::Pixel, 0);
                let ray = camera.ray(x as f32 + across, y as f32 + down);
                let found = radiance(scene, &ray, settings, lighting, &points, workspace);
                if found.is_finite() {
                    pixel.add(found);
                } else {
                    lost = lost.and(Lost { count: 1, first: Some((index, found)) });
                }
            }
        }
        advance();
        (start.elapsed(), lost)
    });
    parts.reduce(Default::default, |a, b| (a.0 + b.0, a.1.and(b.1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::points::PointsName;
    use crate::shade::shader::Shader;
    use crate::shade::{Sampler, SamplerName, Strategy};
    use crate::trace::scene::SceneName;
    use crate::truth::Truth;
    use crate::truth::measured::tests::vivid;
    use crate::truth::stored::StoredMaterial;
    use crate::truth::stored::tests::lacquer;
    use crate::world::environment::{Environment, sky};
    use glam::DVec3;

    const SIZE: [u32; 2] = [24, 16];
    const MIS: RenderSettings =
        RenderSettings { light: Light::Mis, split: 1, max_bounces: 3, points: PointsName::Random, seed: 11 };

    fn film(scene: &Scene<'_>, name: SceneName, settings: &RenderSettings, samples: u32) -> Film {
        let mut film = Film::new(SIZE);
        add_samples(scene, &name.camera(SIZE), settings, &mut film, samples, &Progress::hidden()).unwrap();
        film
    }

    #[test]
    fn picture_does_not_depend_on_the_threads_nor_on_the_steps() {
        let (sky, object, ground) = (sky::sky(), lacquer(), StoredMaterial::load("matte").unwrap());
        let scene = Scene::new(SceneName::Teapot, &object.material, &ground.material, &sky);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| film(&scene, SceneName::Teapot, &MIS, 4))
        };
        let one = on(1);
        assert_eq!(one, on(2));
        assert_eq!(one, on(3));
        let mut steps = Film::new(SIZE);
        for samples in [1, 3] {
            let camera = SceneName::Teapot.camera(SIZE);
            add_samples(&scene, &camera, &MIS, &mut steps, samples, &Progress::hidden()).unwrap();
        }
        assert_eq!(one, steps);
        assert_ne!(one, film(&scene, SceneName::Teapot, &RenderSettings { seed: 12, ..MIS }, 4));
    }

    #[test]
    fn every_sampler_has_the_same_mean() {
        // A light without a sharp sun, so that samplers of the material alone converge too.
        let pixels = (0..32 * 16).map(|i| glam::Vec3::splat(0.1 + ((i * 37) % 11) as f32)).collect();
        let light = Environment::new(32, pixels).unwrap();
        let (object, ground) = (lacquer(), StoredMaterial::load("matte").unwrap());
        let truths = [Truth::Lobes(&object.material), Truth::Lobes(&ground.material)];
        let is_tried = |name: &SamplerName| {
            !matches!(name, SamplerName::Rgl | SamplerName::Thesis | SamplerName::ThesisWalk)
        };
        let names: Vec<SamplerName> = SamplerName::all().filter(is_tried).collect();
        let fitted = names.iter().map(|&name| truths.map(|truth| Sampler::fit(name, &truth, None).unwrap()));
        let fitted: Vec<[Sampler<'_>; 2]> = fitted.collect();
        let means = |scene_name: SceneName, strategy: Strategy| {
            let samplers = &fitted[names.iter().position(|&name| name == strategy.sampler).unwrap()];
            let [object, ground] = [0, 1].map(|n| Shader { truth: truths[n], sampler: &samplers[n] });
            let scene = Scene::new(scene_name, object, ground, &light);
            let split = if strategy.sampler.is_multi() { 4 } else { 1 };
            let settings = RenderSettings { light: strategy.light, split, ..MIS };
            let film = film(&scene, scene_name, &settings, 256 / split);
            let n = film.pixels.len() as f64;
            let sum: DVec3 = (0..film.pixels.len()).map(|i| film.mean(i)).sum();
            let variance: DVec3 = (0..film.pixels.len()).map(|i| film.variance_of_mean(i)).sum();
            (sum / n, variance / (n * n))
        };
        for name in [SceneName::Sphere, SceneName::Teapot] {
            let (expected, own) = means(name, Strategy::MIS);
            let alone = names.iter().map(|&sampler| Strategy::alone(sampler));
            let beside = names.iter().map(|&sampler| Strategy { sampler, light: Light::Mis });
            // Where paths go on, the strategies that differ there are enough.
            let beside = beside.filter(|_| name == SceneName::Sphere);
            for strategy in
                alone.chain(beside).chain([Strategy::PRODUCT, Strategy::EVEN, "light".parse().unwrap()])
            {
                let (rendered, variance) = means(name, strategy);
                let error = (own + variance).map(f64::sqrt);
                let deviation = (rendered - expected).abs();
                assert!(deviation.cmple(4.5 * error).all(), "{strategy}: {rendered} {expected} +- {error}");
                assert!(error.max_element() < 0.05 * expected.max_element(), "{strategy}: {error}");
            }
        }
    }

    #[test]
    fn a_table_that_lobes_sample_together_with_the_light_has_its_own_mean() {
        let (table, lobes) = (vivid(), lacquer());
        let truth = Truth::Table(&table);
        let sampler = Sampler::fit(SamplerName::Lobes, &truth, Some(&lobes.material)).unwrap();
        let light = sky::haze();
        let shader = Shader { truth, sampler: &sampler };
        // The ground is sampled by a table's own guide, without the lobes: where paths go on, their competitors change.
        let scene = Scene::new(SceneName::Teapot, shader, &table, &light);
        let mean = |light: Light, split: u32| {
            let settings = RenderSettings { light, split, ..MIS };
            let film = film(&scene, SceneName::Teapot, &settings, 1024 / split);
            let n = film.pixels.len() as f64;
            let sum: DVec3 = (0..film.pixels.len()).map(|i| film.mean(i)).sum();
            let variance: DVec3 = (0..film.pixels.len()).map(|i| film.variance_of_mean(i)).sum();
            (sum / n, variance / (n * n))
        };
        let (expected, own) = mean(Light::Mis, 1);
        for split in [1, 4] {
            for light in [Light::Product, Light::Even] {
                let (found, variance) = mean(light, split);
                let error = (own + variance).map(f64::sqrt);
                assert!(
                    (found - expected).abs().cmple(4.5 * error).all(),
                    "{split}: {found} {expected} +- {error}"
                );
                assert!(error.max_element() < 0.02 * expected.abs().max_element(), "{error} of {expected}");
            }
        }
    }
}
