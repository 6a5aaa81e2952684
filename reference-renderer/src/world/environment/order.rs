//! The draws of a map in the order of its rows and columns: numbers that lie evenly then become directions that do.
//!
//! The alias table of `srbf_core` finds a cell by one look into memory, but neighbouring numbers hit cells far apart. Here a cell is found
//! by the inverse of the cumulative distribution, first of rows and then of the columns of a row, and the numbers are made with which the
//! alias table hits that cell. The density is the same.

use srbf_core::Environment;
use std::collections::HashMap;

/// A place in a cell is as fine as the numbers that hit it: a cell that keeps less of its draws is reached through another.
const LEAST_KEPT: f32 = 1e-4;

/// Digits of the two numbers that choose a cell: 24 each.
const STEPS: f64 = 16_777_216.0;

/// What finds a cell.
pub struct Order {
    width: usize,
    rows: Cumulative,
    /// Of each row.
    columns: Cumulative,
    /// How much of its draws a cell keeps.
    kept: Vec<f32>,
    /// Cells that keep next to nothing, and through which others they are reached.
    hosts: HashMap<usize, usize>,
}

impl Order {
    /// Reads the shares of a map.
    pub fn new(map: &Environment<Vec<u32>>) -> Self {
        let width = map.width();
        let cells: Vec<_> = (0..map.cell_count()).filter_map(|index| map.cell(index)).collect();
        let shares: Vec<f64> = cells.iter().map(|cell| cell.share).collect();
        let of_rows: Vec<f64> = shares.chunks(width).map(|row| row.iter().sum()).collect();
        let (rows, columns) = (Cumulative::new(&of_rows, of_rows.len()), Cumulative::new(&shares, width));
        let mut hosts: HashMap<usize, usize> = HashMap::new();
        for (index, cell) in cells.iter().enumerate() {
            let rest = 1.0 - cell.kept;
            if rest > LEAST_KEPT && cells[cell.other].kept < LEAST_KEPT {
                let host = hosts.entry(cell.other).or_insert(index);
                if 1.0 - cells[*host].kept < rest {
                    *host = index;
                }
            }
        }
        Self { width, rows, columns, kept: cells.iter().map(|cell| cell.kept).collect(), hosts }
    }

    /// The cell that two uniform numbers in [0, 1) stand for, and where in it: height and azimuth.
    #[inline]
    pub fn place(&self, [u, v]: [f32; 2]) -> (usize, [f32; 2]) {
        let (row, down) = self.rows.find(0, u);
        let (column, across) = self.columns.find(row, v);
        (row * self.width + column, [down, across])
    }

    /// The three numbers with which the map draws the direction that two uniform numbers in [0, 1) stand for: the first its height, the
    /// second its azimuth.
    #[inline]
    pub fn numbers(&self, u: [f32; 2]) -> [f32; 3] {
        let (cell, [down, across]) = self.place(u);
        let kept = self.kept[cell];
        let host = if kept < LEAST_KEPT { self.hosts.get(&cell) } else { None };
        let (hit, left) = match host {
            Some(&host) => (host, self.kept[host] + down * (1.0 - self.kept[host])),
            None => (cell, down * kept),
        };
        // Whole steps below 2^24. Up to the next step, so that rounding does not lead into the cell before.
        let place = (hit as f64 + f64::from(left)) / self.kept.len() as f64 * STEPS;
        let first = f64::from(place as u32);
        let second = f64::from(((place - first) * STEPS) as u32) + 1.0;
        [(first / STEPS) as f32, (second / STEPS) as f32, across]
    }
}

/// Parts of the guide of a distribution: so few that those of all rows of a map stay in a cache.
const GUIDE: usize = 64;

/// Sums that are compared at a time: a cache line.
const AT_ONCE: usize = 16;

/// Cumulative distributions of equally many shares each, and where to begin to look in them.
struct Cumulative {
    /// Shares of a distribution, and numbers from one distribution to the next.
    n: usize,
    stride: usize,
    /// Running sums, `n + 1` of each distribution, from 0 to 1; then a number above all.
    parts: Vec<f32>,
    /// The part that `k / GUIDE` falls into, `GUIDE` of each distribution: from there on sums are compared, a cache line at a time.
    first: Vec<u16>,
}

impl Cumulative {
    /// Of each `n` shares one; evenly where all are 0, as nothing is drawn from there.
    fn new(shares: &[f64], n: usize) -> Self {
        let stride = n + 1 + AT_ONCE;
        let (mut parts, mut first) = (Vec::new(), Vec::new());
        for shares in shares.chunks(n) {
            let sum: f64 = shares.iter().sum();
            let begin = parts.len();
            let mut below = 0.0;
            for (i, share) in shares.iter().enumerate() {
                parts.push(if sum > 0.0 { (below / sum) as f32 } else { i as f32 / n as f32 });
                below += share;
            }
            parts.push(1.0);
            let own = &parts[begin..];
            let falls_into = |u: f32| own.partition_point(|&part| part <= u).clamp(1, n) - 1;
            // A map has at most 65535 columns, and as many rows and one.
            first.extend((0..GUIDE).map(|k| falls_into(k as f32 / GUIDE as f32) as u16));
            parts.extend([2.0; AT_ONCE]);
        }
        Self { n, stride, parts, first }
    }

    /// The part of a distribution that a number in [0, 1) falls into, and where in it, in [0, 1).
    #[inline]
    fn find(&self, distribution: usize, u: f32) -> (usize, f32) {
        let parts = &self.parts[distribution * self.stride..][..self.stride];
        let near = ((u * GUIDE as f32) as usize).min(GUIDE - 1);
        let mut index = self.first[distribution * GUIDE + near] as usize;
        // The last sums are above all numbers, so that it ends before them.
        while let Some(block) = parts.get(index + 1..index + 1 + AT_ONCE) {
            let passed: u32 = block.iter().map(|part| u32::from(*part <= u)).sum();
            index += passed as usize;
            if passed < AT_ONCE as u32 {
                break;
            }
        }
        let index = index.min(self.n - 1);
        let (from, to) = (parts[index], parts[index + 1]);
        (index, ((u - from) / (to - from)).clamp(0.0, 1.0 - 0.5 * f32::EPSILON))
    }
}

#[cfg(test)]
mod tests {
    use super::Cumulative;
    use crate::numbers::random::Random;
    use crate::world::environment::{Environment, sky};
    use glam::Vec3;

    /// Maps with bright pixels, black rows, and of one pixel.
    fn maps() -> Vec<Environment> {
        let noise = (0..64 * 33).map(|i| Vec3::splat(((i * 7919) % 101) as f32)).collect();
        let mut half = vec![Vec3::ZERO; 16 * 8];
        (0..40).for_each(|i| half[i] = Vec3::splat(1.0 + (i * i) as f32));
        let mut one = vec![Vec3::splat(1e-4); 32 * 16];
        one[200] = Vec3::splat(1e4);
        vec![
            Environment::new(64, noise).unwrap(),
            Environment::new(16, half).unwrap(),
            Environment::new(32, one).unwrap(),
            Environment::constant(2.0).unwrap(),
            sky::sky(),
        ]
    }

    #[test]
    fn directions_have_the_density_of_the_map() {
        for (k, environment) in maps().into_iter().enumerate() {
            // Chi-square over 16 by 8 bins against as many directions of the alias table.
            let bin = |d: Vec3| {
                let turns = (d.y.atan2(d.x) / std::f32::consts::TAU).rem_euclid(1.0);
                (8.0 * (0.5 - 0.5 * d.z)).min(7.0) as usize * 16 + (16.0 * turns).min(15.0) as usize
            };
            let (n, mut random) = (200_000, Random::new(8, k as u64, 0));
            let (mut ordered, mut by_alias) = ([0.0f64; 128], [0.0f64; 128]);
            for _ in 0..n {
                let u = [random.unit(), random.unit()];
                let sample = environment.sample(environment.ordered(u));
                ordered[bin(sample.direction)] += 1.0;
                assert!(sample.pdf > 0.0, "map {k}: {sample:?} of {u:?}");
                let sample = environment.sample([random.unit(), random.unit(), random.unit()]);
                by_alias[bin(sample.direction)] += 1.0;
            }
            let (mut chi, mut freedom) = (0.0, 0.0);
            for (a, b) in ordered.iter().zip(&by_alias).filter(|(a, b)| *a + *b > 10.0) {
                chi += (a - b) * (a - b) / (a + b);
                freedom += 1.0;
            }
            assert!(chi < freedom + 5.0 * f64::sqrt(2.0 * freedom), "map {k}: {chi} for {freedom} bins");
        }
    }

    /// Shares that are 0, tiny and large, at numbers on the edges of parts and beside them.
    #[test]
    fn a_number_falls_into_the_part_that_a_search_of_all_finds() {
        let shares = [0.0, 1.0, 0.0, 0.0, 1e-9, 5.0, 1e-3, 0.0, 0.25, 0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 0.0];
        let cumulative = Cumulative::new(&shares, 8);
        let mut random = Random::new(12, 0, 0);
        for distribution in 0..2 {
            let parts = &cumulative.parts[distribution * cumulative.stride..][..9];
            let edges = parts.iter().flat_map(|&part| [part.next_down(), part, part.next_up()]);
            let grid = (0..8).flat_map(|k| [k as f32 / 8.0, (k as f32 / 8.0).next_down()]);
            let numbers: Vec<f32> = edges.chain(grid).filter(|u| (0.0..1.0).contains(u)).collect();
            for u in numbers.into_iter().chain((0..10_000).map(|_| random.unit())) {
                let want = parts.iter().rposition(|&part| part <= u).unwrap();
                let (index, within) = cumulative.find(distribution, u);
                assert_eq!(index, want, "{u} of {parts:?}");
                assert!((0.0..1.0).contains(&within));
            }
        }
    }

    #[test]
    fn neighbouring_numbers_are_neighbouring_directions() {
        // Down with the first number, and to the right with the second.
        for (k, environment) in maps().into_iter().enumerate() {
            let at = |u: f32, v: f32| environment.sample(environment.ordered([u, v])).direction;
            for i in 0..1000 {
                let u = i as f32 / 1000.0;
                let [high, low] = [at(u, 0.5), at(u + 1e-3 - 1e-6, 0.5)];
                assert!(high.z >= low.z - 1e-5, "map {k}, {u}: {high} {low}");
            }
        }
    }
}
