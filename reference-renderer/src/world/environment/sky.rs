//! The embedded skies: procedural maps with thin clouds and a ground, the sun as a disc or spread wide by haze. They
//! need no file.

use super::Environment;
use glam::{Vec3, vec3};
use std::f32::consts::{PI, TAU};

const WIDTH: usize = 512;
const HEIGHT: usize = 256;

/// Height and azimuth of the sun, degrees: to the left behind the camera of the scenes.
const SUN_HEIGHT: f32 = 38.0;
const SUN_AZIMUTH: f32 = -142.0;

/// Angular radius of the sun, degrees. The true one, 0.27, is below a pixel of the map; haze makes it wider.
const SUN_RADIUS: f32 = 2.0;

/// Radiance of the sun: its irradiance is then about twice that of the rest of the sky.
const SUN_RADIANCE: f32 = 900.0;

const SUN_COLOUR: Vec3 = vec3(1.0, 0.90, 0.74);

/// Peak radiance of the sun that haze has spread, and how narrow it is then, as the sharpness of a Gaussian lobe.
///
/// The brightest is then about 15 times the mean, as in the light probes that are common in comparisons of samplers of
/// materials: such a sampler cannot find a small sun, for which there are samples of the light.
const HAZY_SUN_RADIANCE: f32 = 9.0;
const HAZY_SUN_SHARPNESS: f32 = 40.0;

/// Makes the sky with the disc of the sun.
pub fn sky() -> Environment {
    map(|d| clear(d) + disc(d, sun()) * SUN_COLOUR)
}

/// Makes the sky whose sun is spread by haze.
pub fn haze() -> Environment {
    map(|d| {
        let spread = (HAZY_SUN_SHARPNESS * (d.dot(sun()) - 1.0)).exp();
        clear(d) + SUN_COLOUR * (HAZY_SUN_RADIANCE * spread)
    })
}

/// Makes a white sun in that direction, alone on a black sky.
pub fn sun_alone(towards: Vec3) -> Environment {
    map(|d| disc(d, towards) * Vec3::ONE)
}

fn map(radiance: impl Fn(Vec3) -> Vec3) -> Environment {
    let pixels = (0..WIDTH * HEIGHT)
        .map(|i| {
            let turn = ((i % WIDTH) as f32 + 0.5) / WIDTH as f32;
            let down = PI * ((i / WIDTH) as f32 + 0.5) / HEIGHT as f32;
            let (sin, cos) = (-(turn - 0.5) * TAU).sin_cos();
            radiance(vec3(down.sin() * cos, down.sin() * sin, down.cos()))
        })
        .collect();
    Environment::new(WIDTH, pixels).expect("the sky is bright and finite")
}

/// Direction towards the sun.
fn sun() -> Vec3 {
    let (height, azimuth) = (SUN_HEIGHT.to_radians(), SUN_AZIMUTH.to_radians());
    vec3(height.cos() * azimuth.cos(), height.cos() * azimuth.sin(), height.sin())
}

/// The sky without the sun itself.
fn clear(d: Vec3) -> Vec3 {
    let horizon = vec3(0.80, 0.86, 0.92);
    let ground = vec3(0.30, 0.27, 0.23);
    if d.z < 0.0 {
        // Haze fades the ground into the horizon over a few degrees.
        return ground.lerp(horizon, (d.z / 0.05).exp());
    }
    let zenith = vec3(0.10, 0.24, 0.58);
    let mut colour = zenith.lerp(horizon, (1.0 - d.z).powi(4));

    // Clouds lie in a plane overhead, so that they crowd towards the horizon, where haze hides them.
    let overhead = [d.x / (d.z + 0.12), d.y / (d.z + 0.12)];
    let cover = smooth_step(0.48, 0.78, fractal_noise(overhead.map(|v| 1.3 * v + 40.0)));
    colour = colour.lerp(vec3(1.15, 1.12, 1.08), cover * smooth_step(0.02, 0.25, d.z));

    let toward_sun = d.dot(sun()).max(0.0);
    colour + vec3(1.0, 0.86, 0.66) * (0.35 * toward_sun.powi(6) + 2.0 * toward_sun.powi(200))
}

/// Radiance of the disc of the sun, before its colour. Its rim is a pixel wide and more, so that the map shows no steps.
fn disc(d: Vec3, sun: Vec3) -> f32 {
    let from_centre = d.dot(sun).clamp(-1.0, 1.0).acos().to_degrees();
    let share = 1.0 - smooth_step(SUN_RADIUS - 0.5, SUN_RADIUS + 0.5, from_centre);
    SUN_RADIANCE * share
}

fn smooth_step(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Five octaves of value noise, in [0, 1).
fn fractal_noise(at: [f32; 2]) -> f32 {
    let (mut sum, mut weight, mut scale) = (0.0, 0.5, 1.0);
    for _ in 0..5 {
        sum += weight * value_noise(at.map(|v| v * scale));
        weight *= 0.5;
        scale *= 2.03;
    }
    sum / 0.96875
}

/// Random values at the corners of a grid, smoothly interpolated; in [0, 1).
fn value_noise(at: [f32; 2]) -> f32 {
    let [x, y] = at.map(f32::floor);
    let [tx, ty] = [at[0] - x, at[1] - y].map(|t| t * t * (3.0 - 2.0 * t));
    let corner = |dx: i32, dy: i32| {
        let (x, y) = ((x as i32 + dx) as u32, (y as i32 + dy) as u32);
        crate::numbers::random::Random::new(1, x.into(), y.into()).unit()
    };
    let upper = corner(0, 0) + tx * (corner(1, 0) - corner(0, 0));
    let lower = corner(0, 1) + tx * (corner(1, 1) - corner(0, 1));
    upper + ty * (lower - upper)
}
