//! Light from infinitely far away: a latitude-longitude map, its value towards a direction, and samples of it.
//!
//! Row 0 of the map looks up (+z). The centre of the map looks along +x, and to the right in the map is to the right
//! for one who stands inside (towards -y).

pub mod file;
mod order;
pub mod sky;
pub mod tile;

use glam::Vec3;
use order::Order;
use srbf_core::environment_len;
use std::sync::OnceLock;

/// Most pixels that a map may have, 8192 x 4096: such a map needs 2 GB of memory.
pub const MAX_PIXELS: usize = srbf_core::MAX_ENVIRONMENT_PIXELS;

/// Directions of the light that an exposure is measured by.
const METERED: u32 = 4096;

/// The radiance, as it is shown, of a white matte surface that faces most of the light. Surfaces that reflect half of it are as bright as a
/// display; the tone map compresses values above 0.76.
pub const WHITE: f32 = 2.0;

/// A map of radiance, which is sampled by its luminance.
pub struct Environment {
    /// The table of `core`: what looks up, samples, and samples together with a mixture.
    pub map: srbf_core::Environment<Vec<u32>>,
    constant: Option<Vec3>,
    /// Made when it is first asked for: random numbers do not need it.
    order: OnceLock<Order>,
}

/// Where on the map a sample of the light is, before the map is read.
#[derive(Clone, Copy, Debug)]
pub enum LightPlace {
    /// A cell, and where in it: height and azimuth.
    Cell(usize, [f32; 2]),
    /// The numbers of [`Environment::sample`].
    Numbers([f32; 3]),
}

/// A direction drawn from an environment.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit vector in the world, towards the light.
    pub direction: Vec3,
    /// Density; 1/sr.
    pub pdf: f32,
    /// Radiance from there.
    pub radiance: Vec3,
}

impl Environment {
    /// Makes an environment of rows of radiance, the top row first.
    ///
    /// # Errors
    /// No or too many pixels; a value that is NaN, negative or above 1e30; an image that is black all over.
    pub fn new(width: usize, radiance: Vec<Vec3>) -> anyhow::Result<Self> {
        let height = radiance.len() / width.max(1);
        let memory = vec![0; environment_len(width, height)?];
        let pixels: Vec<[f32; 3]> = radiance.iter().map(|c| c.to_array()).collect();
        let map = srbf_core::Environment::new(width, &pixels, memory)?;
        let constant = radiance.iter().all(|&c| c == radiance[0]).then(|| radiance[0]);
        Ok(Self { map, constant, order: OnceLock::new() })
    }

    /// The same radiance from everywhere.
    ///
    /// # Errors
    /// A radiance that is not finite and above 0.
    pub fn constant(radiance: f32) -> anyhow::Result<Self> {
        Self::new(1, vec![Vec3::splat(radiance)])
    }

    /// The radiance, if it is the same from everywhere.
    pub fn constant_radiance(&self) -> Option<Vec3> {
        self.constant
    }

    /// The factor on radiance that brings a white matte surface, which faces most of the light, to [`WHITE`]: pictures of any materials under one light
    /// have it in common.
    pub fn exposure(&self) -> f32 {
        if let Some(radiance) = self.constant {
            return WHITE / srbf_core::luminance(radiance);
        }
        // Draws by luminance, evenly spread (Roberts 2018): each stands for as much of the light.
        let steps = [0.819_172_513_396_164, 0.671_043_606_703_789, 0.549_700_477_901_970];
        let draw = |n: u32| self.sample(steps.map(|step: f64| (0.5 + step * f64::from(n)).fract() as f32));
        let lights: Vec<(Vec3, f32)> = (0..METERED)
            .map(draw)
            .map(|drawn| (drawn.direction, srbf_core::luminance(drawn.radiance) / drawn.pdf))
            .collect();
        let most: Vec3 = lights.iter().map(|(direction, light)| *direction * *light).sum();
        let normal = most.try_normalize().unwrap_or(Vec3::Z);
        let on_it = |(direction, light): &(Vec3, f32)| f64::from(light * normal.dot(*direction).max(0.0));
        let irradiance = lights.iter().map(on_it).sum::<f64>() / f64::from(METERED);
        let exposure = f64::from(WHITE) * std::f64::consts::PI / irradiance;
        if exposure.is_finite() { exposure as f32 } else { 1.0 }
    }

    /// Turns the map round +z, anticlockwise seen from above; radians.
    pub fn turned(self, turn: f32) -> Self {
        Self { map: self.map.turned(turn), ..self }
    }

    /// The radiance from a direction, interpolated between the centres of pixels.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        self.constant.unwrap_or_else(|| self.map.radiance(direction))
    }

    /// The density of [`sample`](Self::sample) towards a direction; 1/sr.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        self.map.pdf(direction)
    }

    /// The numbers of [`sample`](Self::sample) for two uniform ones in [0, 1), such that those that lie evenly become directions that do.
    #[inline]
    pub fn ordered(&self, u: [f32; 2]) -> [f32; 3] {
        self.order.get_or_init(|| Order::new(&self.map)).numbers(u)
    }

    /// The place on the map that numbers stand for: of two that lie evenly the directions do, of three by the alias table.
    #[inline]
    pub fn ordered_place(&self, u: [f32; 2]) -> LightPlace {
        let (cell, within) = self.order.get_or_init(|| Order::new(&self.map)).place(u);
        LightPlace::Cell(cell, within)
    }

    /// Requests the memory of a place ahead of reading it.
    #[inline]
    pub fn prefetch_place(&self, place: LightPlace) {
        match place {
            LightPlace::Cell(cell, _) => self.map.prefetch_cell(cell),
            LightPlace::Numbers(u) => self.map.prefetch(u),
        }
    }

    /// The direction of a place.
    #[inline]
    pub fn sample_place(&self, place: LightPlace) -> LightSample {
        let drawn = match place {
            // A cell that is found has light.
            LightPlace::Cell(cell, within) => self
                .map
                .sample_cell(cell, within)
                .unwrap_or_else(|| self.map.sample([within[0], 0.0, within[1]])),
            LightPlace::Numbers(u) => self.map.sample(u),
        };
        let radiance = self.constant.unwrap_or(drawn.radiance);
        LightSample { direction: drawn.direction, pdf: drawn.pdf, radiance }
    }

    /// Radiance and density in one look.
    #[inline]
    pub fn radiance_and_pdf(&self, direction: Vec3) -> (Vec3, f32) {
        let (radiance, pdf) = self.map.radiance_and_pdf(direction);
        (self.constant.unwrap_or(radiance), pdf)
    }

    /// Draws a direction by the luminance of the radiance, three uniform numbers in [0, 1).
    #[inline]
    pub fn sample(&self, u: [f32; 3]) -> LightSample {
        let drawn = self.map.sample(u);
        let radiance = self.constant.unwrap_or(drawn.radiance);
        LightSample { direction: drawn.direction, pdf: drawn.pdf, radiance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::random::Random;
    use crate::world::sphere_sampling;
    use std::f64::consts::{PI, TAU};

    fn uneven() -> Environment {
        let (width, height) = (16, 8);
        let pixels = (0..width * height)
            .map(|i| {
                let bright = if i == 37 { 500.0 } else { ((i * 7919) % 13) as f32 * 0.1 };
                Vec3::new(bright, 0.5 * bright, 0.25 * bright)
            })
            .collect();
        Environment::new(width, pixels).unwrap().turned(0.7)
    }

    /// Directions in the middle of small parts of the sphere, 1024 by 512, and the solid angle of each.
    fn parts() -> impl Iterator<Item = (Vec3, f64)> {
        let (columns, rows) = (1024, 512);
        (0..columns * rows).map(move |i| {
            let phi = (f64::from(i % columns) + 0.5) / f64::from(columns) * TAU;
            let edge = |row: i32| (f64::from(row) / f64::from(rows) * PI).cos();
            let (upper, lower) = (edge(i / columns), edge(i / columns + 1));
            let z = 0.5 * (upper + lower);
            let r = (1.0 - z * z).sqrt();
            let direction = Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32);
            (direction, (upper - lower) * TAU / f64::from(columns))
        })
    }

    #[test]
    fn an_exposure_shows_white_that_faces_the_light_alike() {
        let constant = Environment::constant(2.0).unwrap().exposure();
        assert!((2.0 * constant / WHITE - 1.0).abs() < 1e-3, "{constant}");
        for environment in [uneven(), sky::sky(), sky::haze(), sky::sun_alone(Vec3::new(0.6, 0.0, -0.8))] {
            let irradiance = |normal: Vec3| {
                let light = |(d, part): (Vec3, f64)| {
                    part * f64::from(srbf_core::luminance(environment.radiance(d)) * normal.dot(d).max(0.0))
                };
                parts().map(light).sum::<f64>()
            };
            let axes = [Vec3::X, Vec3::Y, Vec3::Z];
            let brightest = axes.iter().flat_map(|axis| [*axis, -*axis]).map(irradiance).fold(0.0, f64::max);
            let shown = f64::from(environment.exposure()) * brightest / PI / f64::from(WHITE);
            // An axis may lie 55 degrees from the light.
            assert!((0.5..1.05).contains(&shown), "{shown}");
        }
    }

    #[test]
    fn density_integrates_to_one() {
        for environment in [uneven(), Environment::constant(2.0).unwrap(), sky::sky(), sky::haze()] {
            let sum: f64 = parts().map(|(d, part)| f64::from(environment.pdf(d)) * part).sum();
            assert!((sum - 1.0).abs() < 1e-3, "{sum}");
        }
    }

    #[test]
    fn samples_have_the_density_that_is_reported() {
        let environment = uneven();
        let n = 200_000;
        // Bins of 32 by 16.
        let bin = |d: Vec3| {
            let turns = (f64::from(d.y).atan2(f64::from(d.x)) / TAU).rem_euclid(1.0);
            let down = f64::from(d.z).clamp(-1.0, 1.0).acos() / PI;
            (down * 16.0).min(15.0) as usize * 32 + (turns * 32.0).min(31.0) as usize
        };
        let (mut counts, mut expected) = (vec![0.0; 512], vec![0.0; 512]);
        let mut random = Random::new(9, 0, 0);
        for _ in 0..n {
            let sample = environment.sample([random.unit(), random.unit(), random.unit()]);
            assert!((sample.direction.length() - 1.0).abs() < 1e-5);
            counts[bin(sample.direction)] += 1.0;
        }
        for (direction, part) in parts() {
            expected[bin(direction)] += f64::from(n) * f64::from(environment.pdf(direction)) * part;
        }
        // Chi-square against the reported density; bins of small expectation are pooled.
        let (mut chi, mut freedom, mut pooled) = (0.0, -1.0, [0.0, 0.0]);
        for (&count, &expected) in counts.iter().zip(&expected) {
            if expected < 5.0 {
                pooled[0] += count;
                pooled[1] += expected;
            } else {
                chi += (count - expected) * (count - expected) / expected;
                freedom += 1.0;
            }
        }
        if pooled[1] > 0.0 {
            chi += (pooled[0] - pooled[1]) * (pooled[0] - pooled[1]) / pooled[1];
            freedom += 1.0;
        }
        // Mean `freedom`, variance `2 freedom`: five standard deviations.
        assert!(chi < freedom + 5.0 * f64::sqrt(2.0 * freedom), "chi-square {chi} for {freedom} degrees");
    }

    #[test]
    fn pdf_of_a_sample_is_the_pdf_of_its_direction() {
        let environment = uneven();
        let mut random = Random::new(10, 0, 0);
        let brightest = parts().map(|(d, _)| environment.pdf(d)).fold(0.0, f32::max);
        for _ in 0..10_000 {
            let sample = environment.sample([random.unit(), random.unit(), random.unit()]);
            let apart = (sample.pdf - environment.pdf(sample.direction)).abs();
            assert!(apart < 1e-4 * brightest, "{sample:?}");
        }
    }

    #[test]
    fn light_is_the_same_by_both_ways_to_sample() {
        // Mean of radiance / pdf against the mean over uniform directions; both estimate the integral.
        let environment = uneven();
        let (n, mut random) = (400_000, Random::new(11, 0, 0));
        let (mut by_light, mut uniform, mut squares) = (0.0, 0.0, 0.0);
        for _ in 0..n {
            let sample = environment.sample([random.unit(), random.unit(), random.unit()]);
            by_light += f64::from(sample.radiance.x / sample.pdf) / f64::from(n);
            let direction = sphere_sampling::uniform([random.unit(), random.unit()]);
            let value = f64::from(environment.radiance(direction).x) * 4.0 * PI;
            uniform += value / f64::from(n);
            squares += value * value / f64::from(n);
        }
        let error = ((squares - uniform * uniform) / f64::from(n)).sqrt();
        assert!((by_light - uniform).abs() < 5.0 * error, "{by_light} {uniform} +- {error}");
    }

    #[test]
    fn maps_without_meaning_are_refused() {
        assert!(Environment::new(0, vec![]).is_err());
        assert!(Environment::new(2, vec![Vec3::ONE; 3]).is_err());
        assert!(Environment::constant(0.0).is_err());
        assert!(Environment::constant(1e30).is_ok());
        let mut bright = vec![Vec3::ONE; 128];
        bright[77].y = 3e38;
        let error = Environment::new(16, bright).err().unwrap().to_string();
        assert!(error.contains("column 13, row 4") && error.contains("1e30"), "{error}");
        assert!(Environment::constant(f32::NAN).is_err());
        assert!(Environment::constant(-1.0).is_err());
        let mut pixels = vec![Vec3::ONE; 8];
        pixels[6].y = f32::INFINITY;
        let error = Environment::new(4, pixels).err().unwrap().to_string();
        assert!(error.contains("column 2, row 1"), "{error}");
    }

    #[test]
    fn orientation_is_as_seen_from_inside() {
        let mut pixels = vec![Vec3::splat(0.01); 16 * 8];
        pixels[12] = Vec3::splat(1.0); // top row
        pixels[4 * 16 + 12] = Vec3::splat(2.0); // below the horizon, a quarter turn to the right of the centre
        let environment = Environment::new(16, pixels).unwrap();
        let down = (0.5 * PI / 8.0).sin() as f32;
        let towards = |x: f32, y: f32, z: f32| environment.radiance(Vec3::new(x, y, z).normalize()).x;
        let side = (0.5 * TAU / 16.0).sin() as f32;
        assert!((towards(-side, -1.0, -down) - 2.0).abs() < 0.1);
        assert!(towards(-side, 1.0, -down) < 0.1);
    }
}
