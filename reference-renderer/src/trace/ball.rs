//! A ball of a material, or two balls of two materials under the same light: direct light only, no background.
//!
//! Every direction is drawn once and shaded by all materials: from the light and from each of the materials, weighted by the balance
//! heuristic over all of these. So where two materials are equal their balls are the same to the last digit, whatever the noise.

use crate::numbers::random::Random;
use crate::out::progress::Progress;
use crate::shade::shader::{Scattering, Shader};
use crate::trace::frame::Frame;
use crate::trace::scene::{Scene, SceneName};
use crate::world::environment::{Environment, LightSample};
use glam::Vec3;
use rayon::prelude::*;

/// One pixel of `N` balls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallPixel<const N: usize> {
    /// Radiance of each, linear sRGB: the mean over the part of the pixel that they fill.
    pub radiance: [Vec3; N],
    /// The share of the pixel that they fill, 0 to 1.
    pub coverage: f32,
}

/// Steps of evenly spread points in the square and the cube: powers of the inverses of the roots of `x^3 = x + 1` and `x^4 = x + 1`
/// (Roberts 2018).
const R2: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];
const R3: [f64; 3] = [0.819_172_513_396_164, 0.671_043_606_703_789, 0.549_700_477_901_970];

/// Point number `n` of evenly spread ones, shifted; each coordinate in [0, 1).
fn spread<const D: usize>(shift: [f32; D], steps: [f64; D], n: u32) -> [f32; D] {
    // A fraction just below 1 would round to 1.
    std::array::from_fn(|k| ((f64::from(shift[k]) + steps[k] * f64::from(n)).fract() as f32).min(LARGEST))
}

/// The largest f32 below 1.
const LARGEST: f32 = 1.0 - 0.5 * f32::EPSILON;

/// Renders balls in squares of `side` pixels of `samples` each, rows from the top; advances the progress by the number of rows. `turn`: degrees by
/// which samples are turned about their normals.
///
/// # Errors
/// Radiance that is not finite: of values that are too extreme for f32.
pub fn render<const N: usize>(
    shaders: [Shader<'_>; N],
    environment: &Environment,
    [side, samples]: [u32; 2],
    turn: f32,
    progress: &Progress,
) -> anyhow::Result<Vec<BallPixel<N>>> {
    // The frame depends on the material where that is anisotropic: then it is the frame of all.
    let framing = shaders.iter().find(|shader| !shader.is_isotropic()).unwrap_or(&shaders[0]);
    let scene = Scene::new(SceneName::Sphere, *framing, *framing, environment).turned(turn);
    let camera = SceneName::Sphere.camera([side; 2]);
    let mut pixels = vec![BallPixel { radiance: [Vec3::ZERO; N], coverage: 0.0 }; (side * side) as usize];
    let storage = || shaders.map(|_| Scattering::empty());
    pixels.par_chunks_mut(side as usize).enumerate().for_each_init(storage, |scattering, (y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let index = (y * side as usize + x) as u64;
            let mut hits = 0;
            let mut shift = Random::new(1, index, 0);
            let shift_inside = [(); 2].map(|()| shift.unit());
            let shifts = [[(); 3]; N].map(|own| own.map(|()| shift.unit()));
            for sample in 0..samples {
                let mut random = Random::new(0, index, sample.into());
                let inside = spread(shift_inside, R2, sample);
                let ray = camera.ray(x as f32 + inside[0], y as f32 + inside[1]);
                let Some(surface) = scene.hit(&ray) else { continue };
                let wo = -ray.direction;
                let frame = Frame::new(&surface, wo);
                hits += 1;
                let drawn = environment.sample([random.unit(), random.unit(), random.unit()]);
                let units = shifts.map(|shift| spread(shift, R3, sample));
                let found = direct(&shaders, environment, &frame, wo, drawn, units, scattering);
                (0..N).for_each(|k| pixel.radiance[k] += found[k]);
            }
            pixel.coverage = hits as f32 / samples as f32;
            pixel.radiance.iter_mut().for_each(|sum| *sum /= hits.max(1) as f32);
        }
        progress.advance(1);
    });
    let is_finite = |pixel: &BallPixel<N>| pixel.radiance.iter().all(|radiance| radiance.is_finite());
    match pixels.iter().position(|pixel| !is_finite(pixel)) {
        Some(i) => {
            anyhow::bail!("the pixel in column {}, row {} is not finite", i as u32 % side, i as u32 / side)
        }
        None => Ok(pixels),
    }
}

/// The direct light that each material scatters towards `wo`.
fn direct<'a, const N: usize>(
    shaders: &[Shader<'a>; N],
    environment: &Environment,
    frame: &Frame,
    wo: Vec3,
    drawn: LightSample,
    units: [[f32; 3]; N],
    scattering: &mut [Scattering<'a>; N],
) -> [Vec3; N] {
    let local_wo = frame.to_local(wo);
    for (shader, scattering) in shaders.iter().zip(scattering.iter_mut()) {
        if shader.prepare(local_wo, scattering).is_err() {
            // Impossible: the storage holds every material, and wo is a unit vector. A NaN is found in the picture.
            return [Vec3::NAN; N];
        }
    }
    let mut light = [Vec3::ZERO; N];
    let mut add = |local: Vec3, world: Vec3, radiance: Vec3, by_light: f32| {
        if !frame.leaves(world) {
            return;
        }
        let mut density = by_light;
        let values: [Vec3; N] = std::array::from_fn(|k| {
            let (value, pdf) = scattering[k].evaluate_and_pdf(local);
            density += pdf;
            value
        });
        // Far out in a tail f32 rounds the density and the values to 0.
        if density >= f32::MIN_POSITIVE {
            (0..N).for_each(|k| light[k] += values[k] * radiance / density);
        }
    };
    add(frame.to_local(drawn.direction), drawn.direction, drawn.radiance, drawn.pdf);
    let own: [_; N] = std::array::from_fn(|k| scattering[k].sample(units[k]).map(|sample| sample.direction));
    for local in own.into_iter().flatten() {
        let world = frame.to_world(local);
        add(local, world, environment.radiance(world), environment.pdf(world));
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::points::PointsName;
    use crate::shade::Light;
    use crate::trace::film::Film;
    use crate::trace::render::add_samples;
    use crate::trace::settings::RenderSettings;
    use crate::truth::measured::tests::{model, vivid};
    use crate::truth::stored::tests::lacquer;
    use crate::world::environment::sky;

    /// Mean radiance over the picture, black where there is no ball.
    fn mean<const N: usize>(pixels: &[BallPixel<N>], k: usize) -> Vec3 {
        pixels.iter().map(|p| p.radiance[k] * p.coverage).sum::<Vec3>() / pixels.len() as f32
    }

    #[test]
    fn both_balls_have_the_radiance_that_path_tracing_finds() {
        let (side, environment, hidden) = (24, sky::haze(), Progress::hidden());
        let (lacquer, vivid) = (lacquer(), vivid());
        let shaders = [Shader::from(&lacquer.material), Shader::from(&vivid)];
        let pixels = render(shaders, &environment, [side, 256], 0.0, &hidden).unwrap();
        // The outline is left out: there the film's pixels have background in them.
        let inside = |i: &usize| pixels[*i].coverage == 1.0;
        for (k, shader) in shaders.into_iter().enumerate() {
            let scene = Scene::new(SceneName::Sphere, shader, shader, &environment);
            let settings = RenderSettings {
                light: Light::Mis,
                split: 1,
                max_bounces: 1,
                points: PointsName::Random,
                seed: 5,
            };
            let mut film = Film::new([side; 2]);
            let camera = SceneName::Sphere.camera([side; 2]);
            add_samples(&scene, &camera, &settings, &mut film, 256, &hidden).unwrap();
            let within: Vec<usize> = (0..pixels.len()).filter(inside).collect();
            let traced: glam::DVec3 = within.iter().map(|&i| film.mean(i)).sum();
            let variance: glam::DVec3 = within.iter().map(|&i| film.variance_of_mean(i)).sum();
            let ours: glam::DVec3 = within.iter().map(|&i| pixels[i].radiance[k].as_dvec3()).sum();
            // The error of ours is below the other's: it has more samples of the same kinds.
            let error = (2.0 * variance).map(f64::sqrt);
            assert!((ours - traced).abs().cmple(4.0 * error).all(), "{k}: {ours} {traced} +- {error}");
            assert!(error.max_element() < 0.02 * traced.abs().max_element(), "{k}: {error} of {traced}");
        }
    }

    #[test]
    fn one_material_twice_has_no_difference() {
        let environment = sky::sky();
        let gloss = model("model:ggx:alpha_x=0.05,alpha_y=0.2,f0=0.9/0.5/0.1");
        let shaders = [Shader::from(&gloss); 2];
        let pixels = render(shaders, &environment, [20, 4], 0.0, &Progress::hidden()).unwrap();
        assert!(pixels.iter().all(|pixel| pixel.radiance[0] == pixel.radiance[1]));
        assert!(mean(&pixels, 0).min_element() > 0.0);
    }

    #[test]
    fn a_turn_by_a_quarter_is_the_other_roughness() {
        let environment = sky::sky();
        let [round, along] = ["alpha_x=0.05,alpha_y=0.2", "alpha_x=0.2,alpha_y=0.05"]
            .map(|alpha| model(&format!("model:ggx:{alpha},f0=0.9/0.5/0.1")));
        let turned = |measured, turn| {
            let pixels = render([Shader::from(measured)], &environment, [20, 64], turn, &Progress::hidden());
            pixels.unwrap().iter().map(|p| p.radiance[0] * p.coverage).collect::<Vec<_>>()
        };
        let apart = |a: &[Vec3], b: &[Vec3]| {
            let sum: Vec3 = a.iter().zip(b).map(|(a, b)| (*a - *b).abs()).sum();
            (sum / b.iter().copied().sum::<Vec3>()).x
        };
        let (of_other, turned_by, as_is) = (turned(&along, 0.0), turned(&round, 90.0), turned(&round, 0.0));
        let noise = apart(&turned_by, &of_other);
        assert!(noise < 0.25 * apart(&as_is, &of_other), "{noise} {}", apart(&as_is, &of_other));
        assert!(apart(&turned(&round, 180.0), &as_is) < 2.0 * noise + 1e-4);
    }
}
