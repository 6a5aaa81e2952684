//! Adds samples to a picture, in parallel over its rows.

use crate::camera::Camera;
use crate::film::Film;
use crate::integrator::{AnyMixture, Sampler, radiance};
use crate::progress::Progress;
use crate::random::Random;
use crate::scene::Scene;
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
/// A sample that is not finite: a fault of this program, never passed over.
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
    film.pixels.par_chunks_mut(width).enumerate().for_each_init(AnyMixture::empty, |mixture, (y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let index = (y * width + x) as u64;
            for sample in held..held + samples {
                let mut random = Random::new(settings.seed, index, sample.into());
                let ray = camera.ray(x as f32 + random.unit(), y as f32 + random.unit());
                let Settings { sampler, max_bounces, .. } = *settings;
                pixel.add(radiance(scene, ray, sampler, max_bounces, &mut random, mixture));
            }
        }
        progress.advance(1);
    });
    film.samples += samples;
    match (0..film.pixels.len()).find(|&i| !film.mean(i).is_finite()) {
        Some(i) => anyhow::bail!("internal error: pixel {}, {} is not finite", i % width, i / width),
        None => Ok(()),
    }
}
