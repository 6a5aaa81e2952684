//! The uniform numbers that a path is made of: points of a Sobol sequence, or random ones.
//!
//! Each [`Decision`] along a path, at each surface that it meets, has dimensions of its own, four at a time: a sequence of Sobol's,
//! scrambled and shuffled by Owen's method with a seed of the pixel, the decision and the surface. Within the four, the samples of a pixel
//! lie evenly; between decisions, surfaces and pixels they have nothing to do with each other (Burley 2020, "Practical hash-based Owen
//! scrambling", section 4). So a path may be as long as it likes, and every number by itself is uniform: estimates are as unbiased as with
//! random numbers, but the samples of a pixel are not independent, so that they have no standard error.
//!
//! A sequence has 2^16 points. From there on another begins, as evenly spread and independent of the first. Where a decision takes more
//! numbers than four (the thesis's random walk), three of them begin a stream of random ones.

use crate::numbers::random::Random;
use std::array::from_fn;

/// Points of a sequence.
const LENGTH: u64 = 1 << 16;

/// Where the numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum PointsName {
    /// Sobol points, scrambled by Owen's method for each pixel: evenly spread, with the least grain.
    Sobol,
    /// Random numbers, whose samples are independent: a standard error can be told.
    Random,
}

/// The decisions along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// The place in the pixel.
    Pixel,
    /// The direction that the path goes on in.
    Material,
    /// The direction towards the light.
    Light,
    /// A candidate of the lobes.
    LobeCandidate,
    /// A candidate of the light.
    LightCandidate,
    /// A block of samples of the light.
    Block,
    /// Which candidate, or where systematic resampling begins.
    Choice,
    /// Whether the path ends.
    Roulette,
    /// The wavelengths that the path carries.
    Wavelengths,
    /// The direction towards the bulb.
    Bulb,
}

/// Where the numbers of one sample of one pixel come from.
#[derive(Clone, Copy, Debug)]
pub struct Points {
    pub name: PointsName,
    /// Of the seed and the pixel.
    key: u64,
    /// Which point.
    index: u64,
}

impl Points {
    /// The points of one sample of one pixel.
    pub fn new(name: PointsName, seed: u64, pixel: u64, sample: u64) -> Self {
        Self { name, key: Random::new(seed, pixel, 0).key(), index: sample }
    }

    /// The points of part `i` of `n` that this sample branches into: those of all samples together are again evenly spread.
    #[inline]
    pub fn branch(&self, i: usize, n: usize) -> Self {
        Self { index: self.index * n as u64 + i as u64, ..*self }
    }

    /// Four numbers, uniform in [0, 1), for a decision at a surface; 0 is the first that the ray of the camera meets.
    #[inline]
    pub fn draw(&self, decision: Decision, surface: u32) -> [f32; 4] {
        let of = u64::from(surface) << 8 | decision as u64;
        match self.name {
            PointsName::Random => {
                let mut random = Random::new(self.key, of, self.index);
                [(); 4].map(|()| random.unit())
            }
            PointsName::Sobol => {
                let seed = Random::new(self.key, of, self.index / LENGTH).key() as u32;
                sobol_burley::sample_4d((self.index % LENGTH) as u32, 0, seed)
            }
        }
    }

    /// Which of 2^k blocks of samples of the light a surface takes, of which another pixel takes others.
    ///
    /// Sobol: the samples of a pixel take each block once before one comes again, in an order in which those of 2^j are evenly spread.
    #[inline]
    pub fn block(&self, surface: u32, count: usize) -> usize {
        let of = u64::from(surface) << 8 | Decision::Block as u64;
        let number = match self.name {
            PointsName::Random => Random::new(self.key, of, self.index).key(),
            PointsName::Sobol => Random::new(self.key, of, 0).key() ^ self.index,
        };
        number as usize & (count - 1)
    }

    /// Four numbers for each of several choices of a kind that are made together. Each number by itself is uniform.
    ///
    /// Sobol: one point and its shifts along a lattice, so that the choices lie evenly too, in the order of their first number.
    #[inline]
    pub fn draw_together(&self, decision: Decision, surface: u32, choices: &mut [[f32; 4]]) {
        let n = choices.len();
        match self.name {
            PointsName::Random => {
                choices
                    .iter_mut()
                    .enumerate()
                    .for_each(|(i, u)| *u = self.branch(i, n).draw(decision, surface));
            }
            PointsName::Sobol => {
                let [first, rest @ ..] = self.draw(decision, surface);
                let part = 1.0 / n as f32;
                for (i, u) in choices.iter_mut().enumerate() {
                    let at = i as f32;
                    let [v, w, x] = from_fn(|k| {
                        let shifted = rest[k] + at * LATTICE[k] * part;
                        shifted - shifted as u32 as f32
                    });
                    *u = [((at + first) * part).min(LARGEST), v, w, x];
                }
            }
        }
    }
}

/// A point and its shifts along a lattice, `n` in all, each uniform by itself: three rows of numbers.
#[inline]
pub fn shifts<const N: usize>([u, v, w, _]: [f32; 4]) -> [[f32; N]; 3] {
    let part = 1.0 / N as f32;
    let shift = |x: f32, i: usize, by: f32| {
        let x = x + i as f32 * by * part;
        (x - x as u32 as f32).min(LARGEST)
    };
    [
        from_fn(|i| shift(u, i, 1.0)),
        from_fn(|i| shift(v, i, LATTICE[0])),
        from_fn(|i| shift(w, i, LATTICE[1])),
    ]
}

/// How far a lattice goes on in each dimension while it takes one step in the first: odd, so that it meets each of 2^k parts once.
const LATTICE: [f32; 3] = [3.0, 5.0, 7.0];

/// The largest f32 below 1.
const LARGEST: f32 = 1.0 - 0.5 * f32::EPSILON;

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [PointsName; 2] = [PointsName::Sobol, PointsName::Random];

    #[test]
    fn numbers_are_uniform_and_in_range() {
        for name in NAMES {
            // Over pixels at one sample: mean 1/2 within five standard errors, and no two decisions correlated.
            let n = 40_000;
            let (mut sum, mut products) = ([0.0; 8], [0.0; 8]);
            for pixel in 0..n {
                let points = Points::new(name, 3, pixel, 17);
                let [a, b] = [(Decision::Material, 1), (Decision::Light, 1)].map(|(d, k)| points.draw(d, k));
                let numbers: Vec<f64> = a.iter().chain(&b).map(|&u| f64::from(u)).collect();
                assert!(numbers.iter().all(|u| (0.0..1.0).contains(u)));
                for k in 0..8 {
                    sum[k] += numbers[k] - 0.5;
                    products[k] += (numbers[k] - 0.5) * (numbers[(k + 1) % 8] - 0.5);
                }
            }
            for k in 0..8 {
                let root = (n as f64).sqrt();
                assert!(sum[k].abs() < 5.0 * root * (1.0f64 / 12.0).sqrt(), "{name:?}: {sum:?}");
                assert!(products[k].abs() < 5.0 * root / 12.0, "{name:?}: {products:?}");
            }
        }
    }

    #[test]
    fn sobol_points_are_evenly_spread_and_those_of_branches_too() {
        let count = |points: &dyn Fn(u64) -> [f32; 4], n: u64| {
            let mut cells = [[0; 16]; 16];
            for i in 0..n {
                let [x, y, ..] = points(i).map(|u| (16.0 * u) as usize);
                cells[y][x] += 1;
            }
            cells.as_flattened().iter().all(|&c| c == n / 256)
        };
        for pixel in 0..20 {
            let points = |name, i| Points::new(name, 5, pixel, i);
            assert!(count(&|i| points(PointsName::Sobol, i).draw(Decision::Light, 2), 1024));
            let branches = |i: u64| points(PointsName::Sobol, i / 16).branch((i % 16) as usize, 16);
            assert!(count(&|i| branches(i).draw(Decision::Light, 0), 1024));
            // Beyond the end of the sequence another begins.
            assert!(count(&|i| points(PointsName::Sobol, LENGTH + i).draw(Decision::Light, 0), 1024));
            assert!(!count(&|i| points(PointsName::Random, i).draw(Decision::Light, 2), 1024));
        }
    }

    #[test]
    fn choices_that_are_made_together_are_uniform_and_evenly_spread() {
        for name in NAMES {
            let mut cells = [[0; 16]; 4];
            for sample in 0..4096 {
                let mut choices = [[0.0; 4]; 8];
                Points::new(name, 6, 1, sample).draw_together(Decision::LightCandidate, 0, &mut choices);
                assert!(choices.as_flattened().iter().all(|u| (0.0..1.0).contains(u)), "{choices:?}");
                if name == PointsName::Sobol {
                    assert!(choices.is_sorted_by(|a, b| a[0] <= b[0]), "{choices:?}");
                    for k in 0..4 {
                        let mut parts = choices.map(|u| (8.0 * u[k]) as usize);
                        parts.sort_unstable();
                        assert_eq!(parts, [0, 1, 2, 3, 4, 5, 6, 7], "{choices:?}");
                    }
                }
                choices.iter().for_each(|u| (0..4).for_each(|k| cells[k][(16.0 * u[k]) as usize] += 1));
            }
            // 2048 numbers a cell: exactly, or within five standard errors.
            let allowed = if name == PointsName::Sobol { 0 } else { 226 };
            let apart = cells.as_flattened().iter().map(|&count: &i32| (count - 2048).abs()).max();
            assert!(apart <= Some(allowed), "{name:?}: {cells:?}");
        }
    }

    #[test]
    fn every_decision_surface_pixel_and_seed_has_numbers_of_its_own() {
        for name in NAMES {
            let of =
                |seed, pixel, decision, surface| Points::new(name, seed, pixel, 9).draw(decision, surface);
            let one = of(1, 2, Decision::Light, 3);
            assert_eq!(one, of(1, 2, Decision::Light, 3));
            let others = [
                of(2, 2, Decision::Light, 3),
                of(1, 3, Decision::Light, 3),
                of(1, 2, Decision::Material, 3),
                of(1, 2, Decision::Light, 4),
            ];
            assert!(others.iter().all(|&other| other != one), "{name:?}: {one:?} {others:?}");
        }
    }
}
