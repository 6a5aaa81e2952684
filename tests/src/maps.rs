//! Maps of radiance: made, and read from Radiance pictures; the truth about them in f64; and estimates by them.

use glam::{DVec3, Vec3};
use srbf_core::{AnyMixture, Environment, environment_len, luminance};
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// A map, the top row first.
#[derive(Clone, Debug)]
pub struct Map {
    /// Its name.
    pub name: String,
    /// Columns.
    pub width: usize,
    /// Radiance, linear sRGB.
    pub pixels: Vec<[f32; 3]>,
}

impl Map {
    fn of(name: &str, width: usize, height: usize, pixel: impl Fn(f64, f64) -> [f32; 3]) -> Self {
        let centre = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
        let pixels = (0..width * height)
            .map(|i| pixel(TAU * (0.5 - centre(i % width, width)), PI * centre(i / width, height)))
            .collect();
        Self { name: name.into(), width, pixels }
    }

    /// A sky with a small sun of 1e4 times its radiance, above dark ground; 128 x 64 pixels.
    pub fn sky() -> Self {
        Self::of("sky", 128, 64, |phi, theta| {
            if theta > 0.5 * PI {
                return [0.05, 0.04, 0.03];
            }
            let sun = (phi - 1.0).hypot(theta - 0.9) < 0.06;
            let glow = 0.4 + 0.6 * theta.cos();
            if sun { [9000.0, 8000.0, 6000.0] } else { [0.3, 0.45, 0.9].map(|c: f32| c * glow as f32) }
        })
    }

    /// The same radiance from everywhere.
    pub fn constant() -> Self {
        Self::of("constant", 1, 1, |_, _| [1.5; 3])
    }

    /// Black but for one white pixel.
    pub fn pixel(width: usize, height: usize, column: usize, row: usize) -> Self {
        let mut map = Self::of(&format!("pixel of {width} x {height}"), width, height, |_, _| [0.0; 3]);
        map.pixels[row * width + column] = [1.0; 3];
        map
    }

    /// Coloured noise of four decades; no row or column like another.
    pub fn noise(width: usize, height: usize) -> Self {
        let mut map = Self::of(&format!("noise of {width} x {height}"), width, height, |_, _| [0.0; 3]);
        let mut random = crate::inputs::Random(width as u64 * 65_537 + height as u64);
        for pixel in &mut map.pixels {
            let bright = 10f32.powf(random.between(-2.0, 2.0));
            *pixel = random.three().map(|c| bright * c);
        }
        map
    }

    /// A Radiance picture, `.hdr`, run-length encoded or not.
    ///
    /// # Panics
    /// For a file that is no map.
    pub fn read(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let head = bytes.windows(2).position(|two| two == b"\n\n").expect("an empty line") + 2;
        let end = head + bytes[head..].iter().position(|&b| b == b'\n').expect("the size");
        let size = String::from_utf8_lossy(&bytes[head..end]).into_owned();
        let words: Vec<&str> = size.split_whitespace().collect();
        let (height, width): (usize, usize) = (words[1].parse().unwrap(), words[3].parse().unwrap());
        let (mut at, mut pixels) = (end + 1, Vec::with_capacity(width * height));
        for _ in 0..height {
            let is_packed = bytes[at..at + 2] == [2, 2];
            at += if is_packed { 4 } else { 0 };
            let mut row = vec![[0u8; 4]; width];
            for part in (0..4).filter(|_| is_packed) {
                let mut x = 0;
                while x < width {
                    let count = usize::from(bytes[at]);
                    let (run, step) = if count > 128 { (count - 128, 0) } else { (count, 1) };
                    (0..run).for_each(|i| row[x + i][part] = bytes[at + 1 + step * i]);
                    at += 1 + if step == 0 { 1 } else { run };
                    x += run;
                }
            }
            if !is_packed {
                row.iter_mut().for_each(|rgbe| {
                    rgbe.copy_from_slice(&bytes[at..at + 4]);
                    at += 4;
                });
            }
            pixels.extend(row.iter().map(|&[r, g, b, e]| {
                let scale = if e == 0 { 0.0 } else { f64::from(i32::from(e) - 136).exp2() };
                [r, g, b].map(|c| (f64::from(c) * scale) as f32)
            }));
        }
        let name = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        Self { name, width, pixels }
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.pixels.len() / self.width
    }

    /// As `core` holds it.
    pub fn environment(&self) -> Environment<Vec<u32>> {
        let words = environment_len(self.width, self.height()).expect("a size that a map may have");
        Environment::new(self.width, &self.pixels, vec![0; words]).expect("a map with light")
    }

    /// The radiance towards a direction, interpolated in azimuth and height, of a map that is turned by radians; and the
    /// largest channel of the sixteen pixels around.
    pub fn radiance(&self, d: DVec3, turn: f64) -> (DVec3, f64) {
        let (width, height) = (self.width as f64, self.height() as f64);
        let right = ((0.5 - (d.y.atan2(d.x) - turn) / TAU).rem_euclid(1.0) * width - 0.5).rem_euclid(width);
        let below = d.x.hypot(d.y).atan2(d.z) / PI * height - 0.5;
        let (column, row) = (right.floor(), below.floor());
        let depth = |row: f64| (PI * (row + 0.5).clamp(0.0, height) / height).cos();
        let [upper, lower] = [depth(row), depth(row + 1.0)];
        let down = (upper - d.z / d.length()) / (upper - lower);
        let pixel = |dx: i64, dy: i64| {
            let x = (column as i64 + dx).rem_euclid(self.width as i64) as usize;
            let y = (row as i64 + dy).clamp(0, self.height() as i64 - 1) as usize;
            DVec3::from_array(self.pixels[y * self.width + x].map(f64::from))
        };
        let along = |dy| pixel(0, dy).lerp(pixel(1, dy), right - column);
        let around = (-1..3).flat_map(|dy| (-1..3).map(move |dx| (dx, dy)));
        let largest = around.map(|(dx, dy)| pixel(dx, dy).max_element()).fold(0.0, f64::max);
        (along(0).lerp(along(1), down.clamp(0.0, 1.0)), largest)
    }

    /// Integral of the luminance over the sphere, in closed form.
    pub fn power(&self) -> f64 {
        let height = self.height();
        let edge = |row: usize| (PI * (row as f64 - 0.5).clamp(0.0, height as f64) / height as f64).cos();
        let bright = |row: usize| -> f64 {
            let row = &self.pixels[row * self.width..][..self.width];
            row.iter().map(|&c| crate::oracle::luminance(DVec3::from_array(c.map(f64::from)))).sum()
        };
        let part = |row: usize| {
            let mean = 0.5 * (bright(row.saturating_sub(1)) + bright(row.min(height - 1)));
            let lower = if row == height { -1.0 } else { edge(row + 1) };
            mean * (edge(row) - lower) * TAU / self.width as f64
        };
        (0..=height).map(part).sum()
    }
}

/// From the caller's shading frame to the world.
pub fn to_world(frame: &[Vec3; 3], d: Vec3) -> Vec3 {
    frame[0] * d.x + frame[1] * d.y + frame[2] * d.z
}

/// From the world to the caller's shading frame.
pub fn to_local(frame: &[Vec3; 3], d: Vec3) -> Vec3 {
    Vec3::new(frame[0].dot(d), frame[1].dot(d), frame[2].dot(d))
}

/// A frame round a normal.
pub fn frame(normal: Vec3) -> [Vec3; 3] {
    let tangent = normal.any_orthonormal_vector();
    [tangent, normal.cross(tangent), normal]
}

/// The light that is reflected from directions that are seen, estimated by one draw from the lobes and one from the environment, both
/// weighed by the balance heuristic (Veach and Guibas 1995): two rays.
pub fn both_ways(
    mixture: &AnyMixture<'_>,
    environment: &Environment<impl AsRef<[u32]>>,
    frame: &[Vec3; 3],
    seen: impl Fn(Vec3) -> bool,
    u: [[f32; 3]; 2],
) -> Vec3 {
    let mut sum = Vec3::ZERO;
    if let Some(sample) = mixture.sample(u[0]) {
        let world = to_world(frame, sample.direction);
        let (radiance, pdf) = environment.radiance_and_pdf(world);
        let brought = sample.weight * radiance * (sample.pdf / (sample.pdf + pdf));
        sum += if seen(world) { brought } else { Vec3::ZERO };
    }
    let sample = environment.sample(u[1]);
    let (value, pdf) = mixture.evaluate_and_pdf(to_local(frame, sample.direction));
    let brought = value * sample.radiance / (sample.pdf + pdf);
    sum + if seen(sample.direction) { brought } else { Vec3::ZERO }
}

/// Mean and variance of numbers, the mean's standard error too.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Moments {
    /// One number more.
    pub fn see(&mut self, x: f64) {
        self.count += 1.0;
        self.sum += x;
        self.squares += x * x;
    }
    /// The mean.
    pub fn mean(&self) -> f64 {
        self.sum / self.count
    }
    /// The variance.
    pub fn variance(&self) -> f64 {
        (self.squares / self.count - self.mean() * self.mean()).max(0.0)
    }
    /// The standard error of the mean.
    pub fn error(&self) -> f64 {
        (self.variance() / self.count).sqrt()
    }
}

/// Luminance in f64.
pub fn bright(rgb: Vec3) -> f64 {
    f64::from(luminance(rgb))
}
