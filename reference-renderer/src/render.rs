//! Adds samples to a picture, in parallel over its rows.

use crate::camera::Camera;
use crate::film::Film;
use crate::integrator::{Sampler, radiance};
use crate::progress::Progress;
use crate::random::Random;
use crate::scene::Scene;
use crate::shader::Scattering;
use rayon::prelude::*;

/// How to render.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub sampler: Sampler,
    pub max_bounces: u32,
    pub seed: u64,
}

/// Adds `samples` samples to every pixel of a film; advances the progress by the number of rows.
///
/// What a pixel gets depends only on the seed, the pixel and the samples it holds already: not on the threads.
///
/// # Errors
/// A sample that is not finite, of a material or light whose values are too extreme for f32: never passed over.
pub fn add_samples(
    scene: &Scene<'_>,
    camera: &Camera,
    settings: &Settings,
    film: &mut Film,
    samples: u32,
    progress: &Progress,
) -> anyhow::Result<()> {
    let width = film.size()[0] as usize;
    let held = film.samples;
    film.pixels.par_chunks_mut(width).enumerate().for_each_init(Scattering::empty, |scattering, (y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let index = (y * width + x) as u64;
            for sample in held..held + samples {
                let mut random = Random::new(settings.seed, index, sample.into());
                let ray = camera.ray(x as f32 + random.unit(), y as f32 + random.unit());
                let Settings { sampler, max_bounces, .. } = *settings;
                pixel.add(radiance(scene, ray, sampler, max_bounces, &mut random, scattering));
            }
        }
        progress.advance(1);
    });
    film.samples += samples;
    match (0..film.pixels.len()).find(|&i| !film.mean(i).is_finite()) {
        Some(i) => anyhow::bail!(
            "the pixel in column {}, row {} is {}: finite radiance is expected, and the values of a material or of the light \
             leave the range of f32",
            i % width,
            i / width,
            film.mean(i)
        ),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::{Environment, sky};
    use crate::material::StoredMaterial;
    use crate::material::tests::lacquer;
    use crate::scene::SceneName;
    use glam::DVec3;

    const SIZE: [u32; 2] = [24, 16];

    fn film(scene: &Scene<'_>, name: SceneName, sampler: Sampler, samples: u32) -> Film {
        let mut film = Film::new(SIZE);
        let settings = Settings { sampler, max_bounces: 3, seed: 11 };
        add_samples(scene, &name.camera(SIZE), &settings, &mut film, samples, &Progress::hidden()).unwrap();
        film
    }

    #[test]
    fn picture_does_not_depend_on_the_threads_nor_on_the_steps() {
        let (sky, object, ground) = (sky::sky(), lacquer(), StoredMaterial::load("matte").unwrap());
        let scene = Scene::new(SceneName::Teapot, &object.material, &ground.material, &sky);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| film(&scene, SceneName::Teapot, Sampler::Mis, 4))
        };
        let one = on(1);
        assert_eq!(one, on(2));
        assert_eq!(one, on(3));
        let mut steps = Film::new(SIZE);
        for samples in [1, 3] {
            let settings = Settings { sampler: Sampler::Mis, max_bounces: 3, seed: 11 };
            let camera = SceneName::Teapot.camera(SIZE);
            add_samples(&scene, &camera, &settings, &mut steps, samples, &Progress::hidden()).unwrap();
        }
        assert_eq!(one, steps);
        assert_ne!(one, {
            let mut other = Film::new(SIZE);
            let settings = Settings { sampler: Sampler::Mis, max_bounces: 3, seed: 12 };
            let camera = SceneName::Teapot.camera(SIZE);
            add_samples(&scene, &camera, &settings, &mut other, 4, &Progress::hidden()).unwrap();
            other
        });
    }

    #[test]
    fn every_sampler_has_the_same_mean() {
        // A light without a sharp sun, so that samplers of the material alone converge too.
        let pixels = (0..32 * 16).map(|i| glam::Vec3::splat(0.1 + ((i * 37) % 11) as f32)).collect();
        let light = Environment::new(32, pixels).unwrap();
        let (object, ground) = (lacquer(), StoredMaterial::load("matte").unwrap());
        for name in [SceneName::Sphere, SceneName::Teapot] {
            let scene = Scene::new(name, &object.material, &ground.material, &light);
            let mean = |sampler| {
                let film = film(&scene, name, sampler, 256);
                let n = film.pixels.len() as f64;
                let sum: DVec3 = (0..film.pixels.len()).map(|i| film.mean(i)).sum();
                let variance: DVec3 = (0..film.pixels.len()).map(|i| film.variance_of_mean(i)).sum();
                (sum / n, variance / (n * n))
            };
            let (expected, own) = mean(Sampler::Mis);
            for sampler in
                [Sampler::Lobes, Sampler::Defensive, Sampler::Light, Sampler::Cosine, Sampler::Uniform]
            {
                let (rendered, variance) = mean(sampler);
                let error = (own + variance).map(f64::sqrt);
                let deviation = (rendered - expected).abs();
                assert!(
                    deviation.cmple(4.5 * error).all(),
                    "{}: {rendered} {expected} +- {error}",
                    sampler.name()
                );
                assert!(error.max_element() < 0.05 * expected.max_element(), "{}: {error}", sampler.name());
            }
        }
    }
}
