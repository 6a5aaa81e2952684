//! Adds samples to a picture, in parallel over its rows.

use crate::numbers::points::{Decision, Points};
use crate::out::progress::Progress;
use crate::shade::Light;
use crate::trace::camera::Camera;
use crate::trace::carried::Wavelengths;
use crate::trace::film::Film;
use crate::trace::integrator::even::Lighting;
use crate::trace::integrator::wave::{PATHS, Room, wave};
use crate::trace::integrator::{Workspace, radiance, spectral_radiance};
use crate::trace::scene::Scene;
use crate::trace::settings::RenderSettings;
use crate::world::illuminant::Illuminant;
use crate::world::ray::Ray;
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
pub fn add_samples<'a>(
    scene: &Scene<'a>,
    camera: &Camera,
    settings: &RenderSettings,
    film: &mut Film,
    samples: u32,
    progress: &Progress,
) -> anyhow::Result<Duration> {
    let mut time = Duration::ZERO;
    let (from, to) = (film.samples, film.samples + samples);
    // Even sums are of the light round the scene; beside a bulb each is sampled by itself.
    let is_together = settings.light == Light::Even
        && scene.environment.constant_radiance().is_none()
        && scene.bulb.is_none();
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
        let lighting = lighting.as_deref();
        let of = |ray: &Ray, points: &Points, workspace: &mut Workspace<'a>| {
            radiance(scene, ray, settings, lighting, points, workspace)
        };
        let (part, found) = add_range(camera, settings, film, held..next, of, || {
            if next == to {
                progress.advance(1);
            }
        });
        (time, lost, held) = (time + part, lost.and(found), next);
    }
    film.samples = to;
    film.lost += lost.count;
    lost.check(film, samples).map(|()| time)
}

/// As [`add_samples`], by paths of four wavelengths each under a light whose colours are those of the scene. Light and lobes are not
/// sampled together by even sums, which are of colours.
///
/// # Errors
/// As [`add_samples`].
pub fn add_spectral_samples<'a>(
    scene: &Scene<'a>,
    camera: &Camera,
    settings: &RenderSettings,
    illuminant: &Illuminant,
    film: &mut Film,
    samples: u32,
    progress: &Progress,
) -> anyhow::Result<Duration> {
    let of = |ray: &Ray, points: &Points, workspace: &mut Workspace<'a>| {
        let [u, ..] = points.draw(Decision::Wavelengths, 0);
        spectral_radiance(scene, ray, settings, Wavelengths::draw(illuminant, u), points, workspace)
    };
    let held = film.samples;
    let (time, lost) = add_range(camera, settings, film, held..held + samples, of, || progress.advance(1));
    film.samples = held + samples;
    film.lost += lost.count;
    lost.check(film, samples).map(|()| time)
}

/// As [`add_samples`], by waves of paths whose hits of a material are asked together. It is for lobes that sample themselves, beside one
/// sample of the light or none.
///
/// # Errors
/// As [`add_samples`]; another material, sampler or light.
pub fn add_samples_by_waves(
    scene: &Scene<'_>,
    camera: &Camera,
    settings: &RenderSettings,
    film: &mut Film,
    samples: u32,
    progress: &Progress,
) -> anyhow::Result<Duration> {
    let is_fit = matches!(settings.light, Light::Mis | Light::Only | Light::Off) && settings.split == 1;
    if !is_fit || scene.bulb.is_some() || scene.shaders().any(|shader| shader.own_lobes().is_none()) {
        anyhow::bail!(
            "waves: materials of lobes, sampled by these alone or with one sample of the light, are expected: --sampler mis or lobes"
        );
    }
    let held = film.samples;
    let width = film.size()[0] as usize;
    let rows = film.pixels.par_chunks_mut(width).enumerate();
    let parts = rows.map_init(<(Room<'_>, Vec<Vec3>)>::default, |(room, light), (y, row)| {
        let start = ThreadTime::now();
        let mut lost = Lost::default();
        let all = row.len() * samples as usize;
        let of = |i: usize| (i / samples as usize, held + (i % samples as usize) as u32);
        for from in (0..all).step_by(PATHS) {
            let part = from..all.min(from + PATHS);
            let rays = part.clone().map(|i| {
                let (x, sample) = of(i);
                let points =
                    Points::new(settings.points, settings.seed, (y * width + x) as u64, sample.into());
                let [across, down, ..] = points.draw(Decision::Pixel, 0);
                (camera.ray(x as f32 + across, y as f32 + down), points)
            });
            wave(scene, settings, rays, light, room);
            for (i, &found) in part.zip(&*light) {
                let x = of(i).0;
                if found.is_finite() {
                    row[x].add(found);
                } else {
                    lost = lost.and(Lost { count: 1, first: Some((y * width + x, found)) });
                }
            }
        }
        progress.advance(1);
        (start.elapsed(), lost)
    });
    let (time, lost) = parts.reduce(Default::default, |a, b| (a.0 + b.0, a.1.and(b.1)));
    film.samples = held + samples;
    film.lost += lost.count;
    lost.check(film, samples).map(|()| time)
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

    /// Refuses more than are an accident among the samples that every pixel got.
    fn check(self, film: &Film, samples: u32) -> anyhow::Result<()> {
        let (width, of) = (film.size()[0] as usize, u64::from(samples) * film.pixels.len() as u64);
        let Some((i, radiance)) = self.first.filter(|_| self.count * 1_000_000 > of * MAY_BE_LOST) else {
            return Ok(());
        };
        anyhow::bail!(
            "{} of {of} samples are not finite, the first, in column {}, row {}, is {radiance}: finite radiance is expected, and the \
             values of a material or of the light leave the range of f32",
            self.count,
            i % width,
            i / width,
        )
    }
}

/// Adds a range of the samples of every pixel, each the light along a ray of the camera.
fn add_range<'a>(
    camera: &Camera,
    settings: &RenderSettings,
    film: &mut Film,
    samples: Range<u32>,
    light: impl Fn(&Ray, &Points, &mut Workspace<'a>) -> Vec3 + Sync,
    advance: impl Fn() + Sync,
) -> (Duration, Lost) {
    let width = film.size()[0] as usize;
    let rows = film.pixels.par_chunks_mut(width).enumerate();
    let parts = rows.map_init(Workspace::<'a>::default, |workspace, (y, row)| {
        let start = ThreadTime::now();
        let mut lost = Lost::default();
        for (x, pixel) in row.iter_mut().enumerate() {
            let index = y * width + x;
            for sample in samples.clone() {
                let points = Points::new(settings.points, settings.seed, index as u64, sample.into());
                let [across, down, ..] = points.draw(Decision::Pixel, 0);
                let ray = camera.ray(x as f32 + across, y as f32 + down);
                let found = light(&ray, &points, workspace);
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
    fn waves_render_what_paths_do() {
        let (sky, object, ground) = (sky::sky(), lacquer(), StoredMaterial::load("matte").unwrap());
        let scene = Scene::new(SceneName::Teapot, &object.material, &ground.material, &sky);
        let camera = SceneName::Teapot.camera(SIZE);
        for light in [Light::Mis, Light::Only, Light::Off] {
            let settings = RenderSettings { light, max_bounces: 6, points: PointsName::Sobol, ..MIS };
            let paths = film(&scene, SceneName::Teapot, &settings, 16);
            let mut waves = Film::new(SIZE);
            let hidden = Progress::hidden();
            add_samples_by_waves(&scene, &camera, &settings, &mut waves, 16, &hidden).unwrap();
            // The same numbers: where rounding sends a path another way, a pixel differs by its noise.
            let mut differ = 0;
            let (mut sums, mut noise) = ([DVec3::ZERO; 2], DVec3::ZERO);
            for i in 0..paths.pixels.len() {
                let off = (paths.mean(i) - waves.mean(i)).abs().max_element();
                differ += usize::from(off > 1e-4 * paths.mean(i).max_element());
                sums = [sums[0] + paths.mean(i), sums[1] + waves.mean(i)];
                noise += paths.variance_of_mean(i);
            }
            let off = (sums[0] - sums[1]).abs();
            println!("{light:?}: {differ} of {} pixels, sums {sums:?}", paths.pixels.len());
            assert!(differ * 20 < paths.pixels.len() && off.cmple(noise.map(f64::sqrt)).all(), "{light:?}");
        }
        let product = RenderSettings { light: Light::Product, ..MIS };
        let refused =
            add_samples_by_waves(&scene, &camera, &product, &mut Film::new(SIZE), 1, &Progress::hidden());
        assert!(refused.unwrap_err().to_string().contains("--sampler mis"));
    }

    #[test]
    fn every_sampler_has_the_same_mean() {
        // A light without a sharp sun, so that samplers of the material alone converge too.
        let pixels = (0..32 * 16).map(|i| glam::Vec3::splat(0.1 + ((i * 37) % 11) as f32)).collect();
        let light = Environment::new(32, pixels).unwrap();
        let lacquer = lacquer();
        let truth = Truth::Lobes(&lacquer.material);
        let is_tried = |name: &SamplerName| {
            !matches!(name, SamplerName::Rgl | SamplerName::Thesis | SamplerName::ThesisWalk)
        };
        let names: Vec<SamplerName> = SamplerName::all().filter(is_tried).collect();
        let fitted = Sampler::fit_all(names.iter().copied(), &truth, None);
        let fitted: Vec<Sampler<'_>> = fitted.map(|(_, sampler)| sampler.unwrap()).collect();
        let means = |scene_name: SceneName, strategy: Strategy| {
            let sampler = &fitted[names.iter().position(|&name| name == strategy.sampler).unwrap()];
            let shader = Shader { truth, sampler };
            let scene = Scene::new(scene_name, shader, shader, &light);
            let split = if strategy.sampler.is_multi() { 4 } else { 1 };
            let settings = RenderSettings { light: strategy.light, split, ..MIS };
            let film = film(&scene, scene_name, &settings, 256 / split);
            let n = film.pixels.len() as f64;
            let sum: DVec3 = (0..film.pixels.len()).map(|i| film.mean(i)).sum();
            let variance: DVec3 = (0..film.pixels.len()).map(|i| film.variance_of_mean(i)).sum();
            (sum / n, variance / (n * n))
        };
        // Paths go on here. `study::agreement` has every pixel of a sphere, and samplers beside the light.
        let (expected, own) = means(SceneName::Teapot, Strategy::MIS);
        let alone = names.iter().map(|&sampler| Strategy::alone(sampler));
        for strategy in alone.chain([Strategy::PRODUCT, Strategy::EVEN, "light".parse().unwrap()]) {
            let (rendered, variance) = means(SceneName::Teapot, strategy);
            let error = (own + variance).map(f64::sqrt);
            let deviation = (rendered - expected).abs();
            assert!(deviation.cmple(4.5 * error).all(), "{strategy}: {rendered} {expected} +- {error}");
            assert!(error.max_element() < 0.05 * expected.max_element(), "{strategy}: {error}");
        }
    }

    /// A surface of spectra under grey light: the mean colour in daylight is that of a picture of colours, however the light is sampled. Under
    /// another light it is not.
    #[test]
    fn spectral_pictures_in_daylight_have_the_colours_of_others() {
        let pixels = (0..32 * 16).map(|i| Vec3::splat(0.1 + ((i * 37) % 11) as f32)).collect();
        let light = Environment::new(32, pixels).unwrap();
        let object = StoredMaterial::load("garnet_red").unwrap();
        assert!(object.material.has_spectrum());
        let scene = Scene::new(SceneName::Sphere, &object.material, &object.material, &light);
        let camera = SceneName::Sphere.camera(SIZE);
        let mean = |film: &Film| {
            let n = film.pixels.len() as f64;
            let sum: DVec3 = (0..film.pixels.len()).map(|i| film.mean(i)).sum();
            let variance: DVec3 = (0..film.pixels.len()).map(|i| film.variance_of_mean(i)).sum();
            (sum / n, variance / (n * n))
        };
        let spectral = |name: &str, settings: &RenderSettings| {
            let mut film = Film::new(SIZE);
            let light = Illuminant::load(name).unwrap();
            let hidden = Progress::hidden();
            add_spectral_samples(&scene, &camera, settings, &light, &mut film, 512, &hidden).unwrap();
            mean(&film)
        };
        for light in [Light::Mis, Light::Off, Light::Only, Light::Product] {
            let settings = RenderSettings { light, ..MIS };
            let (expected, own) = mean(&film(&scene, SceneName::Sphere, &settings, 512));
            let (found, variance) = spectral("D65", &settings);
            let error = (own + variance).map(f64::sqrt);
            println!("{light:?}: {found} {expected} +- {error}");
            assert!((found - expected).abs().cmple(4.5 * error).all(), "{light:?}: {found} {expected}");
            assert!(error.max_element() < 0.02 * expected.max_element(), "{light:?}: {error}");
            // Red reflects more of a lamp's light.
            let (lamp, _) = spectral("A", &settings);
            assert!(lamp.x > found.x + 4.5 * error.x && lamp.x / lamp.z > found.x / found.z, "{lamp}");
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
