//! The white furnace: under a constant environment the radiance of a convex object is its directional albedo, which
//! the lobes give in closed form.

use crate::camera::Camera;
use crate::film::Film;
use crate::integrator::{AnyMixture, Frame};
use crate::scene::Scene;
use glam::{DVec3, Vec3};

/// Points along each side of a pixel at which the closed form is evaluated: with 4 the error of the grid shows at the
/// outline, where the albedo rises steeply within a pixel.
const GRID: u32 = 16;

/// What was rendered beside what was expected, means over the pixels that the sphere fills; linear sRGB.
#[derive(Clone, Copy, Debug)]
pub struct Furnace {
    pub pixels: usize,
    pub rendered: DVec3,
    /// Monte Carlo standard error of `rendered`.
    pub standard_error: DVec3,
    pub expected: DVec3,
}

/// Compares a film of the scene with the sphere, under constant radiance, with the closed form.
pub fn compare(scene: &Scene<'_>, camera: &Camera, radiance: Vec3, film: &Film) -> Furnace {
    let [width, height] = film.size();
    let mut mixture = AnyMixture::empty();
    let mut result =
        Furnace { pixels: 0, rendered: DVec3::ZERO, standard_error: DVec3::ZERO, expected: DVec3::ZERO };
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let (left, top) = (x as f32, y as f32);
        // The picture of a sphere is convex: a pixel with its four corners in it lies in it whole.
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
        if !corners.iter().all(|(dx, dy)| scene.hit(&camera.ray(left + dx, top + dy)).is_some()) {
            continue;
        }
        let pixel = (y * width + x) as usize;
        result.pixels += 1;
        result.rendered += film.mean(pixel);
        result.standard_error += film.variance_of_mean(pixel);
        for (i, j) in (0..GRID).flat_map(|i| (0..GRID).map(move |j| (i, j))) {
            let inside = |n: u32| (n as f32 + 0.5) / GRID as f32;
            let ray = camera.ray(left + inside(i), top + inside(j));
            let Some(surface) = scene.hit(&ray) else { continue };
            let wo = Frame::new(&surface, -ray.direction).to_local(-ray.direction);
            if scene.object().prepare(wo, &mut mixture).is_ok() {
                result.expected += (mixture.albedo() * radiance).as_dvec3() / f64::from(GRID * GRID);
            }
        }
    }
    let n = (result.pixels.max(1)) as f64;
    result.rendered /= n;
    result.expected /= n;
    result.standard_error = result.standard_error.map(f64::sqrt) / n;
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::Environment;
    use crate::integrator::Sampler;
    use crate::material::StoredMaterial;
    use crate::material::tests::{brushed, lacquer};
    use crate::progress::Progress;
    use crate::render::{Settings, add_samples};
    use crate::scene::SceneName;

    #[test]
    fn rendered_mean_is_the_closed_form_albedo() {
        check(&lacquer());
    }

    #[test]
    fn rendered_mean_is_the_closed_form_albedo_of_an_anisotropic_material() {
        check(&brushed());
    }

    fn check(material: &StoredMaterial) {
        let environment = Environment::constant(1.7).unwrap();
        let scene = Scene::new(SceneName::Sphere, material.get(), material.get(), &environment);
        let size = [32, 32];
        let camera = SceneName::Sphere.camera(size);
        for sampler in [Sampler::Lobes, Sampler::Mis, Sampler::Light] {
            let settings = Settings { sampler, max_bounces: 4, seed: 3 };
            let mut film = Film::new(size);
            add_samples(&scene, &camera, &settings, &mut film, 128, &Progress::hidden()).unwrap();
            let furnace = compare(&scene, &camera, Vec3::splat(1.7), &film);
            assert!(furnace.pixels > 300);
            // Within four standard errors and the error of evaluating the closed form on a grid in each pixel.
            let deviation = (furnace.rendered - furnace.expected).abs();
            let allowed = 4.0 * furnace.standard_error + 2e-4 * furnace.expected;
            assert!(deviation.cmple(allowed).all(), "{}: {furnace:?}", sampler.name());
            assert!(furnace.standard_error.max_element() < 0.02 * furnace.expected.max_element());
        }
    }
}
