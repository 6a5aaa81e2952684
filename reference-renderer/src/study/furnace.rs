//! The white furnace: under a constant environment the radiance of a convex object is its directional albedo, which
//! the lobes give in closed form, and a quadrature of a table.

use crate::shade::shader::Scattering;
use crate::trace::camera::Camera;
use crate::trace::film::Film;
use crate::trace::frame::Frame;
use crate::trace::scene::Scene;
use crate::truth::Truth;
use crate::truth::measured::albedo::AlbedoTable;
use crate::world::ray::Ray;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Points along each side of a pixel at which the closed form is evaluated: with 4 the error of the grid shows at the
/// outline, where the albedo rises steeply within a pixel.
const GRID: u32 = 16;

/// Rendered and expected radiance, means over the pixels that the sphere fills; linear sRGB.
#[derive(Clone, Copy, Debug)]
pub struct Furnace {
    pub pixels: usize,
    pub rendered: DVec3,
    /// Monte Carlo standard error of `rendered`.
    pub standard_error: DVec3,
    pub expected: DVec3,
}

/// Share of a value below which a standard error says nothing: what f32 loses in a value is the same in every sample.
const ROUNDING: f64 = 1e-6;

impl Furnace {
    /// How many standard errors a channel lies off; `None` where rounding, and not chance, decides that.
    pub fn deviation(&self, channel: usize) -> Option<f64> {
        let (error, expected) = (self.standard_error[channel], self.expected[channel]);
        (error > ROUNDING * expected).then(|| (self.rendered[channel] - expected) / error)
    }
}

/// The mean directional albedo of each pixel of a picture of the given size; `None` where the sphere does not fill it.
pub fn albedos(scene: &Scene<'_>, camera: &Camera, size: [u32; 2]) -> Vec<Option<DVec3>> {
    let table = match scene.object().truth {
        Truth::Lobes(_) | Truth::Sheet(_) => None,
        Truth::Table(measured) => Some(AlbedoTable::new(measured)),
    };
    let pixels = (0..size[0] * size[1]).into_par_iter();
    pixels
        .map_init(Scattering::empty, |scattering, i| {
            let at = [(i % size[0]) as f32, (i / size[0]) as f32];
            of_pixel(scene, camera, at, |ray| albedo(scene, ray, table.as_ref(), scattering))
        })
        .collect()
}

/// The mean albedo of the pixel whose left upper corner is at `at`.
fn of_pixel(
    scene: &Scene<'_>,
    camera: &Camera,
    at: [f32; 2],
    mut albedo: impl FnMut(&Ray) -> DVec3,
) -> Option<DVec3> {
    let ray = |x: f32, y: f32| camera.ray(at[0] + x, at[1] + y);
    // The picture of a sphere is convex: a pixel with its four corners in it lies in it whole.
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    if !corners.iter().all(|&(x, y)| scene.hit(&ray(x, y)).is_some()) {
        return None;
    }
    let inside = |n: u32| (n as f32 + 0.5) / GRID as f32;
    let points = (0..GRID).flat_map(|i| (0..GRID).map(move |j| (i, j)));
    let sum: DVec3 = points.map(|(i, j)| albedo(&ray(inside(i), inside(j)))).sum();
    Some(sum / f64::from(GRID * GRID))
}

/// Compares a film of the scene with the sphere, under constant radiance, with the albedos of its pixels.
///
/// # Panics
/// If there are not as many albedos as pixels.
pub fn compare(albedos: &[Option<DVec3>], radiance: Vec3, film: &Film) -> Furnace {
    assert_eq!(albedos.len(), (film.size()[0] * film.size()[1]) as usize, "an albedo for each pixel");
    let mut result = NOTHING;
    // Of the standard error: the sum of squares.
    for (pixel, albedo) in albedos.iter().enumerate().filter_map(|(pixel, albedo)| Some((pixel, (*albedo)?)))
    {
        result.pixels += 1;
        result.rendered += film.mean(pixel);
        result.standard_error += film.variance_of_mean(pixel);
        result.expected += albedo * radiance.as_dvec3();
    }
    let n = (result.pixels.max(1)) as f64;
    result.rendered /= n;
    result.expected /= n;
    result.standard_error = result.standard_error.map(f64::sqrt) / n;
    result
}

const NOTHING: Furnace =
    Furnace { pixels: 0, rendered: DVec3::ZERO, standard_error: DVec3::ZERO, expected: DVec3::ZERO };

/// The directional albedo where a ray meets the sphere; 0 where it does not.
fn albedo<'a>(
    scene: &Scene<'a>,
    ray: &Ray,
    table: Option<&AlbedoTable>,
    scattering: &mut Scattering<'a>,
) -> DVec3 {
    let Some(surface) = scene.hit(ray) else { return DVec3::ZERO };
    let wo = Frame::new(&surface, -ray.direction).to_local(-ray.direction);
    if let Some(table) = table {
        return table.at(wo);
    }
    let prepared = scene.object().prepare(wo, scattering);
    if prepared.is_ok() { scattering.albedo().as_dvec3() } else { DVec3::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::points::PointsName;
    use crate::out::progress::Progress;
    use crate::shade::shader::Shader;
    use crate::shade::{Light, Sampler, SamplerName};
    use crate::trace::render::add_samples;
    use crate::trace::scene::SceneName;
    use crate::trace::settings::RenderSettings;
    use crate::truth::measured::tests::{model, vivid};
    use crate::truth::stored::tests::{brushed, lacquer};
    use crate::world::environment::Environment;

    #[test]
    fn no_deviation_is_told_where_there_is_only_rounding() {
        let furnace = Furnace {
            pixels: 9,
            rendered: DVec3::new(0.5, 0.500_000_1, 0.51),
            standard_error: DVec3::new(0.0, 1e-9, 0.01),
            expected: DVec3::splat(0.5),
        };
        assert_eq!([0, 1].map(|i| furnace.deviation(i)), [None, None]);
        assert!((furnace.deviation(2).unwrap() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn rendered_mean_is_the_closed_form_albedo() {
        check(&lacquer().material);
    }

    #[test]
    fn rendered_mean_is_the_closed_form_albedo_of_an_anisotropic_material() {
        let brushed = brushed();
        [0.0, 30.0, 90.0].iter().for_each(|turn| check_turned(&brushed.material, *turn));
    }

    #[test]
    fn rendered_mean_is_the_quadrature_of_a_table() {
        let lobe = "model:ggx:alpha=0.3,f0=0.9/0.5/0.1,diffuse=0.05";
        check(&model(lobe));
        check(&vivid());
    }

    #[test]
    fn rendered_mean_is_the_quadrature_of_an_anisotropic_table() {
        let ward = model("model:ward:alpha_x=0.15,alpha_y=0.4,specular=0.5/0.3/0.1");
        [0.0, 60.0].iter().for_each(|turn| check_turned(&ward, *turn));
    }

    #[test]
    fn every_sampler_renders_the_albedo() {
        let (lobes, table) = (lacquer(), model("model:ggx:alpha=0.3,f0=0.9/0.5/0.1,diffuse=0.05"));
        let environment = Environment::constant(1.7).unwrap();
        let (size, camera) = ([12, 12], SceneName::Sphere.camera([12, 12]));
        for truth in [Truth::Lobes(&lobes.material), Truth::Table(&table)] {
            let mut expected = None;
            // Warps come with files, and the random walk is biased.
            let is_tried = |name: &SamplerName| !matches!(name, SamplerName::Rgl | SamplerName::ThesisWalk);
            for (name, fitted) in Sampler::fit_all(SamplerName::all().filter(is_tried), &truth, None) {
                // The thesis's algorithm fits no lobes to lobes that are this sharp.
                let Ok(sampler) = fitted else { continue };
                let shader = Shader { truth, sampler: &sampler };
                let scene = Scene::new(SceneName::Sphere, shader, shader, &environment);
                let expected = expected.get_or_insert_with(|| albedos(&scene, &camera, size));
                let split = if name.is_multi() { 4 } else { 1 };
                for light in [Light::Off, Light::Mis] {
                    let settings =
                        RenderSettings { light, split, max_bounces: 1, points: PointsName::Random, seed: 4 };
                    let mut film = Film::new(size);
                    add_samples(&scene, &camera, &settings, &mut film, 256 / split, &Progress::hidden())
                        .unwrap();
                    let furnace = compare(expected, Vec3::splat(1.7), &film);
                    let deviation = (furnace.rendered - furnace.expected).abs();
                    let allowed = 4.0 * furnace.standard_error + 2e-4 * furnace.expected.abs();
                    assert!(deviation.cmple(allowed).all(), "{}, {light:?}: {furnace:?}", name.text());
                }
            }
        }
    }

    fn check<'a>(material: impl Into<Shader<'a>>) {
        check_turned(material, 0.0);
    }

    /// `turn`: of the sample about its normal, degrees.
    fn check_turned<'a>(material: impl Into<Shader<'a>>, turn: f32) {
        let material = material.into();
        let environment = Environment::constant(1.7).unwrap();
        let scene = Scene::new(SceneName::Sphere, material, material, &environment).turned(turn);
        let size = [32, 32];
        let camera = SceneName::Sphere.camera(size);
        let expected = albedos(&scene, &camera, size);
        for light in [Light::Off, Light::Mis, Light::Only, Light::Product] {
            let settings =
                RenderSettings { light, split: 1, max_bounces: 4, points: PointsName::Random, seed: 3 };
            let mut film = Film::new(size);
            add_samples(&scene, &camera, &settings, &mut film, 256, &Progress::hidden()).unwrap();
            let furnace = compare(&expected, Vec3::splat(1.7), &film);
            assert!(furnace.pixels > 300);
            // Within four standard errors and the error of evaluating the closed form on a grid in each pixel.
            let deviation = (furnace.rendered - furnace.expected).abs();
            let allowed = 4.0 * furnace.standard_error + 2e-4 * furnace.expected.abs();
            assert!(deviation.cmple(allowed).all(), "{light:?}: {furnace:?}");
            let error = furnace.standard_error.max_element();
            assert!(error < 0.02 * furnace.expected.max_element(), "{light:?}: {furnace:?}");
        }
    }
}
