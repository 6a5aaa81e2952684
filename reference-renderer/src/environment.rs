//! Light from infinitely far away: a latitude-longitude map, its value towards a direction, and samples of it.
//!
//! Row 0 of the map looks up (+z). The centre of the map looks along +x, and to the right in the map is to the right
//! for one who stands inside (towards -y).

pub mod file;
pub mod sky;

use crate::discrete::AliasTable;
use crate::random::Random;
use anyhow::ensure;
use glam::Vec3;
use srbf_core::luminance;
use std::f32::consts::{PI, TAU};

/// Most pixels that a map may have, 8192 x 4096: while its distribution is made, such a map needs 2 GB of memory.
pub const MAX_PIXELS: usize = 1 << 25;

/// Largest radiance that a map may have: sums of it stay far below the largest f32, 3e38.
const MAX_RADIANCE: f32 = 1e30;

/// A map of radiance, and the distribution that samples it by luminance.
pub struct Environment {
    width: usize,
    height: usize,
    radiance: Vec<Vec3>,
    /// Density of `sample` in each pixel; 1/sr.
    density: Vec<f32>,
    table: AliasTable,
    /// Heights z of the edges between rows, from 1 down to -1.
    edges: Vec<f64>,
    /// What the map is turned by round +z, radians.
    turn: f32,
    constant: bool,
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
        ensure!(width > 0 && !radiance.is_empty(), "the map has no pixels");
        ensure!(radiance.len().is_multiple_of(width), "the last row of the map is incomplete");
        ensure!(
            radiance.len() <= MAX_PIXELS,
            "the map has {} pixels, at most {MAX_PIXELS} are allowed",
            radiance.len()
        );
        let fits = |v: f32| (0.0..=MAX_RADIANCE).contains(&v);
        let bad = radiance.iter().position(|c| !c.to_array().into_iter().all(fits));
        if let Some(i) = bad {
            anyhow::bail!(
                "the pixel in column {}, row {} is {}: values from 0 to {MAX_RADIANCE:e} are expected",
                i % width,
                i / width,
                radiance[i]
            );
        }
        let height = radiance.len() / width;

        // A lookup blends four pixels, so each is weighted by the mean of itself and its neighbours: wherever a lookup
        // gives light the density is positive.
        let bright: Vec<f32> = radiance.iter().map(|&c| luminance(c)).collect();
        let around: Vec<f32> = (0..bright.len())
            .map(|i| {
                let (x, y) = (i % width, i / width);
                let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
                let columns = [(x + width - 1) % width, x, (x + 1) % width];
                let sum: f32 =
                    rows.clone().map(|r| columns.map(|c| bright[r * width + c]).iter().sum::<f32>()).sum();
                sum / (3 * rows.count()) as f32
            })
            .collect();
        let edges: Vec<f64> =
            (0..=height).map(|row| (std::f64::consts::PI * row as f64 / height as f64).cos()).collect();
        let power: Vec<f64> =
            (0..bright.len()).map(|i| f64::from(around[i]) * solid_angle(&edges, i / width, width)).collect();
        let total: f64 = power.iter().sum();
        let Some(table) = AliasTable::new(&power) else {
            anyhow::bail!("the map is black all over: there is nothing to render");
        };
        let density = around.iter().map(|&l| (f64::from(l) / total) as f32).collect();
        let constant = radiance.iter().all(|&c| c == radiance[0]);
        Ok(Self { width, height, radiance, density, table, edges, turn: 0.0, constant })
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
        self.constant.then(|| self.radiance[0])
    }

    /// Turns the map round +z, anticlockwise seen from above; radians.
    pub fn turned(self, turn: f32) -> Self {
        Self { turn, ..self }
    }

    /// The place of a direction in the map: column and row, in pixels.
    #[inline]
    fn place(&self, direction: Vec3) -> [f32; 2] {
        let turns = (self.turn - direction.y.atan2(direction.x)) / TAU + 0.5;
        let down = direction.z.clamp(-1.0, 1.0).acos() / PI;
        [(turns - turns.floor()) * self.width as f32, down * self.height as f32]
    }

    /// The radiance from a direction, interpolated between the centres of pixels.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        if self.constant {
            return self.radiance[0];
        }
        let [x, y] = self.place(direction).map(|v| v - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (along, down) = (x - column, y - row);
        let pixel = |dx: i64, dy: i64| {
            let c = (column as i64 + dx).rem_euclid(self.width as i64) as usize;
            let r = (row as i64 + dy).clamp(0, self.height as i64 - 1) as usize;
            self.radiance[r * self.width + c]
        };
        let upper = pixel(0, 0).lerp(pixel(1, 0), along);
        let lower = pixel(0, 1).lerp(pixel(1, 1), along);
        upper.lerp(lower, down)
    }

    /// The density of [`sample`](Self::sample) towards a direction; 1/sr.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let [x, y] = self.place(direction);
        let column = (x as usize).min(self.width - 1);
        let row = (y as usize).min(self.height - 1);
        self.density[row * self.width + column]
    }

    /// Draws a direction: a pixel by its power, uniformly within it.
    pub fn sample(&self, random: &mut Random) -> LightSample {
        let hit = random.below(self.table.len());
        let pixel = self.table.choose(hit, random.unit());
        let (column, row) = (pixel % self.width, pixel / self.width);
        let turns = (column as f32 + random.unit()) / self.width as f32;
        let [upper, lower] = [self.edges[row], self.edges[row + 1]];
        let z = (upper + (lower - upper) * f64::from(random.unit())) as f32;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (self.turn - (turns - 0.5) * TAU).sin_cos();
        let direction = Vec3::new(radius * cos, radius * sin, z);
        LightSample { direction, pdf: self.density[pixel], radiance: self.radiance(direction) }
    }
}

/// Solid angle of a pixel of a row.
fn solid_angle(edges: &[f64], row: usize, width: usize) -> f64 {
    std::f64::consts::TAU / width as f64 * (edges[row] - edges[row + 1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere_sampling;

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

    #[test]
    fn density_integrates_to_one() {
        for environment in [uneven(), Environment::constant(2.0).unwrap(), sky::sky(), sky::haze()] {
            let (w, h) = (environment.width, environment.height);
            let sum: f64 = (0..w * h)
                .map(|i| f64::from(environment.density[i]) * solid_angle(&environment.edges, i / w, w))
                .sum();
            assert!((sum - 1.0).abs() < 1e-5, "{sum}");
        }
    }

    #[test]
    fn samples_have_the_density_that_is_reported() {
        let environment = uneven();
        let (n, bins) = (200_000, environment.width * environment.height);
        let mut counts = vec![0.0; bins];
        let mut random = Random::new(9, 0, 0);
        for _ in 0..n {
            let sample = environment.sample(&mut random);
            assert!((sample.direction.length() - 1.0).abs() < 1e-5);
            let [x, y] = environment.place(sample.direction);
            let bin = (y as usize).min(environment.height - 1) * environment.width
                + (x as usize).min(environment.width - 1);
            counts[bin] += 1.0;
        }
        // Chi-square against the reported density; bins of small expectation are pooled.
        let (mut chi, mut freedom, mut pooled) = (0.0, -1.0, [0.0, 0.0]);
        for (bin, &count) in counts.iter().enumerate() {
            let expected = f64::from(n)
                * f64::from(environment.density[bin])
                * solid_angle(&environment.edges, bin / environment.width, environment.width);
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
        let mut different = 0;
        for _ in 0..10_000 {
            let sample = environment.sample(&mut random);
            // A direction within rounding of an edge may be placed on the other side of it.
            different += usize::from(sample.pdf != environment.pdf(sample.direction));
        }
        assert!(different < 20, "{different} of 10000");
    }

    #[test]
    fn light_is_the_same_by_both_ways_to_sample() {
        // Mean of radiance / pdf against the mean over uniform directions; both estimate the integral.
        let environment = uneven();
        let (n, mut random) = (400_000, Random::new(11, 0, 0));
        let (mut by_light, mut uniform, mut squares) = (0.0, 0.0, 0.0);
        for _ in 0..n {
            let sample = environment.sample(&mut random);
            by_light += f64::from(sample.radiance.x / sample.pdf) / f64::from(n);
            let direction = sphere_sampling::uniform([random.unit(), random.unit()]);
            let value = f64::from(environment.radiance(direction).x) * 4.0 * std::f64::consts::PI;
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
        let down = (0.5f32 * PI / 8.0).sin();
        let towards = |x: f32, y: f32, z: f32| environment.radiance(Vec3::new(x, y, z).normalize()).x;
        let side = (0.5f32 * TAU / 16.0).sin();
        assert!((towards(-side, -1.0, -down) - 2.0).abs() < 0.1);
        assert!(towards(-side, 1.0, -down) < 0.1);
    }
}
