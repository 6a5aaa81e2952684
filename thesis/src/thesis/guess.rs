//! The initial guess of the thesis's section 4.1.2.
//!
//! The *coverage* of a direction is the region that spreads from it until the squared difference of intensities exceeds a
//! threshold. Directions queue by the solid angle of their coverage times the squared intensity; the first is taken unless
//! it lies in what those taken before cover. When the queue is empty before there are enough, the threshold is narrowed
//! and everything starts again. An axis is a direction taken, the lobe half as high at the edge of a cap as large as the
//! coverage.
//!
//! Spreading from every texel would cost the square of their number. The solid angle of all texels whose intensity is
//! near enough, connected or not, bounds a coverage from above; the queue holds that bound until the texel is at its
//! front, and only then the region is made. The order is that of the whole queue.

use super::cube::{Cube, cap};
use super::lobes::RoundLobe;
use srbf_core::LUMINANCE;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::LN_2;

/// Each next threshold, as a share of the one before.
const NARROWING: f64 = 0.7;
/// Thresholds that are tried: the last is a 10000th of the first.
const THRESHOLDS: usize = 27;

/// Makes at most `count` lobes; fewer for a vector that has fewer levels, none for a black one.
///
/// `first` is the first threshold of the difference of intensities, as a share of the largest.
pub(crate) fn guess(cube: &Cube, values: &[[f64; 3]], count: usize, first: f64) -> Vec<RoundLobe> {
    let sharpest = sharpest(cube);
    let intensity: Vec<f64> =
        values.iter().map(|v| (0..3).map(|c| f64::from(LUMINANCE[c]) * v[c]).sum()).collect();
    let largest = intensity.iter().copied().fold(0.0, f64::max);
    if !(largest > 0.0 && largest.is_finite()) {
        return Vec::new();
    }
    let levels = Levels::new(cube, &intensity);
    let mut best: Vec<(usize, f64)> = Vec::new();
    let mut threshold = first * largest;
    for _ in 0..THRESHOLDS {
        let chosen = choose(cube, &intensity, &levels, count, threshold);
        if chosen.len() > best.len() {
            best = chosen;
        }
        if best.len() == count {
            break;
        }
        threshold *= NARROWING;
    }
    let lobe = |(texel, coverage): (usize, f64)| {
        let one_minus_cosine = (coverage / cap(0.0)).min(1.0);
        RoundLobe {
            axis: cube.directions[texel],
            sharpness: (LN_2 / one_minus_cosine).min(sharpest),
            amplitude: values[texel],
        }
    };
    best.into_iter().map(lobe).collect()
}

/// Intensities in order, with the solid angle up to each.
struct Levels {
    sorted: Vec<f64>,
    solid_angle_before: Vec<f64>,
}

impl Levels {
    fn new(cube: &Cube, intensity: &[f64]) -> Self {
        let mut order: Vec<usize> = (0..intensity.len()).collect();
        order.sort_by(|&a, &b| intensity[a].total_cmp(&intensity[b]));
        let mut sum = 0.0;
        let mut before = vec![0.0];
        for &n in &order {
            sum += cube.solid_angles[n];
            before.push(sum);
        }
        Self { sorted: order.into_iter().map(|n| intensity[n]).collect(), solid_angle_before: before }
    }

    /// Solid angle of all texels whose intensity differs by at most the threshold.
    fn near(&self, intensity: f64, threshold: f64) -> f64 {
        let from = self.sorted.partition_point(|&v| v < intensity - threshold);
        let to = self.sorted.partition_point(|&v| v <= intensity + threshold);
        self.solid_angle_before[to] - self.solid_angle_before[from]
    }
}

/// A texel in the queue.
struct Candidate {
    priority: f64,
    texel: usize,
    /// Its coverage, once it is known and not only bounded.
    region: Option<(f64, Vec<u32>)>,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        self.priority.total_cmp(&other.priority).then(other.texel.cmp(&self.texel))
    }
}
impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Candidate {}

/// Takes candidates with one threshold: texels and the solid angles of their coverage.
fn choose(
    cube: &Cube,
    intensity: &[f64],
    levels: &Levels,
    count: usize,
    threshold: f64,
) -> Vec<(usize, f64)> {
    let candidate = |texel: usize| {
        let i = intensity[texel];
        Candidate { priority: levels.near(i, threshold) * i * i, texel, region: None }
    };
    let mut queue: BinaryHeap<Candidate> = (0..intensity.len()).map(candidate).collect();
    let mut covered = vec![false; intensity.len()];
    let mut seen = vec![false; intensity.len()];
    let mut chosen = Vec::with_capacity(count);
    while chosen.len() < count
        && let Some(first) = queue.pop()
    {
        if covered[first.texel] {
            continue;
        }
        match first.region {
            Some((solid_angle, region)) => {
                region.iter().for_each(|&n| covered[n as usize] = true);
                chosen.push((first.texel, solid_angle));
            }
            None => {
                let region = spread(cube, intensity, first.texel, threshold, &mut seen);
                let solid_angle: f64 = region.iter().map(|&n| cube.solid_angles[n as usize]).sum();
                let i = intensity[first.texel];
                let priority = (solid_angle * i * i).min(first.priority);
                queue.push(Candidate { priority, texel: first.texel, region: Some((solid_angle, region)) });
            }
        }
    }
    chosen
}

/// The texels that a direction covers. `seen` is all false before and after.
fn spread(cube: &Cube, intensity: &[f64], from: usize, threshold: f64, seen: &mut [bool]) -> Vec<u32> {
    let mut region = vec![from as u32];
    seen[from] = true;
    let mut next = 0;
    while next < region.len() {
        for &n in &cube.neighbours[region[next] as usize] {
            let difference = intensity[n as usize] - intensity[from];
            if !seen[n as usize] && difference * difference <= threshold * threshold {
                seen[n as usize] = true;
                region.push(n);
            }
        }
        next += 1;
    }
    region.iter().for_each(|&n| seen[n as usize] = false);
    region
}

/// Largest sharpness that texels can tell: a lobe that falls to `exp(-2)` half a diagonal from its axis.
///
/// A narrower one could have any height between the texels.
pub(crate) fn sharpest(cube: &Cube) -> f64 {
    let half_diagonal = cube.texel_width() * std::f64::consts::FRAC_1_SQRT_2;
    4.0 / (half_diagonal * half_diagonal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thesis::lobes::evaluate;
    use srbf_fit::table::direction;
    use std::f64::consts::PI;

    fn planted() -> [RoundLobe; 2] {
        let lobe = |theta: f64, azimuth, sharpness, a: f64| RoundLobe {
            axis: direction(theta, azimuth),
            sharpness,
            amplitude: [a, 0.8 * a, 0.5 * a],
        };
        [lobe(0.9, 0.1, 40.0, 3.0), lobe(0.6, 2.6, 30.0, 2.5)]
    }

    #[test]
    fn two_planted_lobes_are_the_first_two_guesses() {
        let cube = Cube::new(32);
        let planted = planted();
        let values: Vec<[f64; 3]> = cube.directions.iter().map(|d| evaluate(&planted, d)).collect();
        let guessed = guess(&cube, &values, 2, 0.04);
        assert_eq!(guessed.len(), 2);
        for lobe in &planted {
            let nearest = guessed
                .iter()
                .map(|g| ((0..3).map(|k| g.axis[k] * lobe.axis[k]).sum::<f64>(), g))
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap();
            // On the top of the lobe: where it has not fallen below exp(-1/2).
            assert!(lobe.sharpness * (1.0 - nearest.0) < 0.5, "{lobe:?}: {nearest:?}");
            // The coverage is only the top, which is narrower.
            let ratio = nearest.1.sharpness / lobe.sharpness;
            assert!((1.0..40.0).contains(&ratio), "{lobe:?}: {nearest:?}");
        }
    }

    #[test]
    fn the_queue_in_order_of_bounds_is_the_queue_in_order_of_priorities() {
        let cube = Cube::new(12);
        let planted = planted();
        let values: Vec<[f64; 3]> = cube.directions.iter().map(|d| evaluate(&planted, d)).collect();
        let intensity: Vec<f64> = values.iter().map(|v| v[1]).collect();
        let levels = Levels::new(&cube, &intensity);
        for threshold in [0.6, 0.2, 0.05] {
            // The text of the thesis: every coverage, then sort, then choose.
            let mut seen = vec![false; intensity.len()];
            let mut all: Vec<(f64, usize, f64, Vec<u32>)> = (0..intensity.len())
                .map(|n| {
                    let region = spread(&cube, &intensity, n, threshold, &mut seen);
                    let solid_angle: f64 = region.iter().map(|&n| cube.solid_angles[n as usize]).sum();
                    (solid_angle * intensity[n] * intensity[n], n, solid_angle, region)
                })
                .collect();
            all.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let mut covered = vec![false; intensity.len()];
            let mut expected = vec![];
            for (_, n, solid_angle, region) in all {
                if !covered[n] && expected.len() < 8 {
                    region.iter().for_each(|&m| covered[m as usize] = true);
                    expected.push((n, solid_angle));
                }
            }
            let found = choose(&cube, &intensity, &levels, 8, threshold);
            assert_eq!(found.len(), expected.len(), "{threshold}");
            for (found, expected) in found.iter().zip(&expected) {
                // Mirror images tie but for rounding.
                assert!((found.1 - expected.1).abs() < 1e-9, "{threshold}: {found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn a_threshold_that_is_too_wide_is_narrowed() {
        let cube = Cube::new(16);
        let values: Vec<[f64; 3]> = cube.directions.iter().map(|d| [0.5 + 0.4 * d[0]; 3]).collect();
        let guessed = guess(&cube, &values, 12, 0.5);
        assert_eq!(guessed.len(), 12);
        let levels = Levels::new(&cube, &values.iter().map(|v| v[0]).collect::<Vec<_>>());
        assert!((levels.near(0.5, 10.0) - 2.0 * PI).abs() < 1e-9);
    }

    #[test]
    fn black_has_no_guess_and_a_constant_one() {
        let cube = Cube::new(8);
        assert!(guess(&cube, &vec![[0.0; 3]; cube.directions.len()], 12, 0.5).is_empty());
        let constant = guess(&cube, &vec![[0.3; 3]; cube.directions.len()], 12, 0.5);
        assert_eq!(constant.len(), 1);
        assert!((constant[0].sharpness - LN_2).abs() < 1e-9, "{constant:?}");
    }
}
