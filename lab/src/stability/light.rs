//! Light from 1e-30 to 1e30: whatever its unit, the same map gives the same directions, densities and shares.

use super::measure::{Decade, Operation, relative};
use glam::Vec3;
use srbf_core::{Environment, LightBlock, Lobe, Mixture, ProductSampling, environment_len, luminance};
use srbf_reference_renderer::numbers::random::Random;

/// Width of the map, pixels; half as high.
const WIDTH: usize = 32;
/// The sun over the least of the sky.
const SUN: f32 = 1e5;
/// Powers of ten between two rows.
const STEP: usize = 3;
/// Candidates, and directions of the lobes.
const CANDIDATES: usize = 16;
const RAYS: usize = 8;

/// The light of a draw, over the unit of the light.
type Brought = fn(&Scene, &mut Random) -> Vec<f32>;

struct Scene {
    environment: Environment<Vec<u32>>,
    mixture: Mixture<'static, 16>,
    unit: f32,
}

impl Scene {
    /// With a sun of this radiance; `None` where the map is refused.
    fn new(sun: f32) -> Option<Self> {
        let unit = sun / SUN;
        let pixel = |i: usize| match i {
            200 => [sun; 3],
            i if i % 7 == 0 => [0.0; 3],
            i => [(1 + i % 5) as f32 * unit; 3],
        };
        let pixels: Vec<[f32; 3]> = (0..WIDTH * WIDTH / 2).map(pixel).collect();
        let memory = vec![0; environment_len(WIDTH, WIDTH / 2).ok()?];
        let environment = Environment::new(WIDTH, &pixels, memory).ok()?;
        let lobe = |x: f32, sharpness, amplitude| {
            Lobe::new(Vec3::new(x, 0.0, 1.0).normalize(), sharpness, Vec3::splat(amplitude)).ok()
        };
        let mixture = Mixture::hemisphere(&[lobe(0.5, 1e4, 1e3)?, lobe(0.2, 3.0, 0.1)?]).ok()?;
        Some(Self { environment, mixture, unit })
    }
}

const AXES: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];

fn numbers<const N: usize>(random: &mut Random) -> [[f32; N]; 3] {
    [(); 3].map(|()| [(); N].map(|()| random.unit()))
}

fn sample(scene: &Scene, random: &mut Random) -> Vec<f32> {
    let [[u], [v], [w]] = numbers::<1>(random);
    let sample = scene.environment.sample([u, v, w]);
    vec![sample.pdf, luminance(sample.radiance) / sample.pdf / scene.unit]
}

fn product(scene: &Scene, random: &mut Random) -> Vec<f32> {
    let u = numbers::<CANDIDATES>(random);
    let sampling = ProductSampling::new(CANDIDATES, 0.5, 4.0).expect("numbers in range");
    let u = u.each_ref().map(|u| &u[..]);
    let drawn = scene.mixture.sample_product(&scene.environment, &AXES, &sampling, u, random.unit());
    let weight = drawn.ok().flatten().map_or(0.0, |sample| luminance(sample.weight));
    vec![weight / scene.unit]
}

fn even(scene: &Scene, random: &mut Random) -> Vec<f32> {
    let block = numbers::<{ srbf_core::LIGHT_BLOCK }>(random);
    let block = LightBlock::new(&scene.environment, block.each_ref());
    let u = numbers::<RAYS>(random);
    let u = u.each_ref().map(|u| &u[..]);
    let choice = random.unit();
    let drawn = scene.mixture.reflect(&scene.environment, &block, &AXES, Vec3::Z, u, choice);
    let Ok(drawn) = drawn else { return vec![f32::NAN] };
    vec![luminance(drawn.block_sum + drawn.ray_sum) / scene.unit]
}

/// Measures all, `draws` a row.
pub fn measure(draws: u32, seed: u64) -> Vec<Operation> {
    let operations: [(&str, &str, Brought); 3] = [
        ("Environment::sample", "density, and radiance over density", sample),
        ("Mixture::sample_product", "weight of a direction chosen among candidates", product),
        ("Mixture::reflect", "sums of light and lobes without shadows", even),
    ];
    let of = |(n, (name, meaning, brought)): (usize, (&'static str, &'static str, Brought))| {
        let base = Scene::new(SUN).expect("a map of common radiance");
        let row = |power: i32| {
            let at = 10f64.powi(power);
            // Too bright or too dark a map is refused, which is no error of a draw.
            let scene = Scene::new(at as f32)?;
            // The same numbers for both.
            let [mut first, mut second] =
                [(); 2].map(|()| Random::new(seed, 200 + n as u64, (power + 40) as u64));
            let mut ours = 0.0f64;
            for _ in 0..draws {
                let expected = brought(&base, &mut first);
                for (want, got) in expected.into_iter().zip(brought(&scene, &mut second)) {
                    let is_nothing = want == 0.0 && got == 0.0;
                    ours = ours.max(if is_nothing { 0.0 } else { relative(want.into(), got) });
                }
            }
            Some(Decade { at, ours, plain: None })
        };
        let rows = (-30..=30).step_by(STEP).filter_map(row).collect();
        Operation {
            name,
            meaning,
            plain: "none: beside the same map in units of 1",
            along: "radiance of the sun",
            rows,
        }
    };
    operations.into_iter().enumerate().map(of).collect()
}
