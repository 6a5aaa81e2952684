//! Even sums for samplers other than lobes: the method of `Mixture::reflect`, by the density of any sampler.
//!
//! The estimator and the proof of its mean stand in `core/src/environment/reflect.rs`. The sums are of the rendered material: a table is evaluated
//! for every direction, which is dear.

use crate::shade::shader::Scattering;
use crate::trace::frame::Frame;
use crate::world::environment::Environment;
use glam::Vec3;
use srbf_core::{LIGHT_BLOCK, LightBlock, Reflection, Sample, luminance, power_heuristic};

/// Directions of the sampler, the path's ray among them.
pub(super) const RAYS: usize = 8;

const COUNT: usize = LIGHT_BLOCK + RAYS;

/// One direction: in the shading frame, radiance over its own density, and the density of the sampler.
#[derive(Clone, Copy)]
struct Towards {
    local: Vec3,
    light: Vec3,
    pdf: f32,
}

/// A direction that brings nothing.
const NOTHING: Towards = Towards { local: Vec3::Z, light: Vec3::ZERO, pdf: 0.0 };

/// Draws both rays; no ray of the path's own where the sampler draws none.
pub fn reflect(
    scattering: &Scattering<'_>,
    environment: &Environment,
    block: &LightBlock,
    frame: &Frame,
    u: &[[f32; RAYS]; 3],
    choice: f32,
) -> Reflection {
    let mut towards = [NOTHING; COUNT];
    let world = |i: usize| Vec3::from(block.direction.each_ref().map(|row| row[i]));
    for (i, one) in towards[..LIGHT_BLOCK].iter_mut().enumerate() {
        let direction = world(i);
        if frame.leaves(direction) {
            let local = frame.to_local(direction);
            let pdf = scattering.pdf(local);
            let weight = power_heuristic(1.0, block.pdf[i], 1.0, pdf);
            let light = Vec3::from(block.light.each_ref().map(|row| row[i])) * weight;
            *one = Towards { local, light, pdf };
        }
    }
    for (i, one) in towards[LIGHT_BLOCK..].iter_mut().enumerate() {
        let Some(local) = scattering.draw([u[0][i], u[1][i], u[2][i]]) else { continue };
        let direction = frame.to_world(local);
        let pdf = scattering.pdf(local);
        one.local = local;
        one.pdf = pdf;
        if frame.leaves(direction) && pdf > 0.0 && pdf.is_finite() {
            let (radiance, of_map) = environment.radiance_and_pdf(direction);
            one.light = radiance * (power_heuristic(1.0, pdf, 1.0, of_map) / pdf);
        }
    }
    let own = towards[LIGHT_BLOCK];
    let values = scattering.evaluate_all(&towards.map(|one| one.local));

    let brought: [Vec3; COUNT] = std::array::from_fn(|i| towards[i].light * values[i]);
    let (of_block, of_rays) = brought.split_at(LIGHT_BLOCK);
    let targets: [f32; LIGHT_BLOCK] = std::array::from_fn(|i| {
        let target = luminance(of_block[i]);
        // A channel may be negative: every value other than 0 has to have a chance.
        if target > 0.0 { target } else { of_block[i].abs().max_element() }
    });
    let whole: f32 = targets.iter().sum();
    let mut reflection = Reflection {
        ray: (own.pdf > 0.0 && own.pdf.is_finite()).then(|| Sample {
            direction: own.local,
            pdf: own.pdf,
            weight: values[LIGHT_BLOCK] / own.pdf,
        }),
        shadow: None,
        ray_light: own.light,
        shadow_light: Vec3::ZERO,
        // The radiance of the map is the truth.
        ray_factor: 0.0,
        shadow_factor: 0.0,
        shadow_value: Vec3::ZERO,
        ray_value: values[LIGHT_BLOCK],
        block_sum: of_block.iter().sum::<Vec3>() / LIGHT_BLOCK as f32,
        ray_sum: of_rays.iter().sum::<Vec3>() / RAYS as f32,
    };
    if whole > 0.0 && whole.is_finite() {
        let mut rest = choice * whole;
        let mut chosen = 0;
        for (i, target) in targets.iter().enumerate().filter(|(_, target)| **target > 0.0) {
            chosen = i;
            if rest < *target {
                break;
            }
            rest -= target;
        }
        reflection.shadow = Some(world(chosen));
        reflection.shadow_value = values[chosen];
        reflection.shadow_light = towards[chosen].light * (whole / (LIGHT_BLOCK as f32 * targets[chosen]));
    }
    reflection
}

#[cfg(test)]
mod tests {
    use crate::numbers::points::PointsName;
    use crate::out::progress::Progress;
    use crate::shade::shader::Shader;
    use crate::shade::{Light, Sampler, SamplerName};
    use crate::trace::film::Film;
    use crate::trace::render::add_samples;
    use crate::trace::scene::{Scene, SceneName};
    use crate::trace::settings::RenderSettings;
    use crate::truth::Truth;
    use crate::truth::measured::tests::model;
    use crate::truth::stored::tests::lacquer;
    use crate::world::environment::Environment;
    use glam::{DVec3, Vec3};

    const SIZE: [u32; 2] = [24, 16];

    /// Mean over the picture, and its standard error.
    fn mean(scene: &Scene<'_>, light: Light, samples: u32) -> (DVec3, DVec3) {
        let settings =
            RenderSettings { light, split: 1, max_bounces: 2, points: PointsName::Random, seed: 7 };
        let mut film = Film::new(SIZE);
        let camera = SceneName::Teapot.camera(SIZE);
        add_samples(scene, &camera, &settings, &mut film, samples, &Progress::hidden()).unwrap();
        let n = film.pixels.len() as f64;
        let sum: DVec3 = (0..film.pixels.len()).map(|i| film.mean(i)).sum();
        let variance: DVec3 = (0..film.pixels.len()).map(|i| film.variance_of_mean(i)).sum();
        (sum / n, (variance / (n * n)).map(f64::sqrt))
    }

    #[test]
    fn the_mean_is_that_of_the_power_heuristic_and_a_bias_of_two_percent_is_found() {
        let pixel = |i: usize| Vec3::splat(if i == 420 { 300.0 } else { 0.2 + ((i * 37) % 11) as f32 * 0.1 });
        let light = Environment::new(64, (0..64 * 32).map(pixel).collect()).unwrap();
        let (lobes, table) = (lacquer(), model("model:ggx:alpha=0.3,f0=0.9/0.5/0.1,diffuse=0.05"));
        // By the cosine, the highlights of lacquer have a variance in which 2 % are lost. Lobes that sample a table go by
        // `Mixture::reflect`.
        let cases = [
            (Truth::Lobes(&lobes.material), &[SamplerName::Ggx, SamplerName::Lobes][..]),
            (Truth::Table(&table), &[SamplerName::Ggx, SamplerName::Cosine, SamplerName::Lobes][..]),
        ];
        for (truth, names) in cases {
            for &name in names {
                let sampler = Sampler::fit(name, &truth, Some(&lobes.material)).unwrap();
                let shader = Shader { truth, sampler: &sampler };
                let scene = Scene::new(SceneName::Teapot, shader, shader, &light);
                let (ours, error) = mean(&scene, Light::Even, 1024);
                let (reference, own) = mean(&scene, Light::Mis, 4096);
                let error = (error * error + own * own).map(f64::sqrt);
                let apart = (ours - reference) / error;
                println!("{name:?}: {apart} standard errors of {:.2e}", error.max_element());
                assert!(apart.abs().max_element() < 4.0, "{name:?}: {ours} {reference}");
                let planted = (1.02 * ours - reference) / error;
                assert!(planted.abs().max_element() > 4.0, "{name:?}: a bias of 2 % is {planted} errors");
            }
        }
    }
}
