//! The data term of one view: squared differences between lobes and samples, and what Gauss-Newton needs of them.
//!
//! The derivative of a value by an unknown is that of a unit lobe, the same for all channels, times an amplitude. So only
//! the Gram matrix of the derivatives of unit lobes is summed over the samples, once for the three channels; the
//! differences are three more columns of it. Where factors give the channels weights of their own, the matrix has their mean: the
//! gradient is exact, the steps are a little shorter or longer than Gauss-Newton's.

use crate::family::lobes::Lobes;
use crate::family::unit::PANEL;
use crate::numeric::vector::{self, Operation, Vectors, WIDEST, fused};

/// A sample as the fit sees it.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub direction: [f64; 3],
    /// `f cos` of the table.
    pub target: [f64; 3],
    /// Factor from the lobes to the value there.
    pub factor: [f64; 3],
    /// The value that the lobes should have, per channel, and the weight of the squared difference, of all terms together.
    pub aim: [f64; 3],
    pub weight: [f64; 3],
    /// The rest of the terms where the lobes have that value.
    pub rest: f64,
    /// The weight of the difference of values alone.
    pub value: f64,
    /// Weight of the squared difference of values that makes the relative L2 error.
    pub base: f64,
    /// The same weight in the measure away from the peak, and the floor that is added to values there.
    pub measure: f64,
    pub measure_floor: f64,
    /// Weight of differences of densities, over the inverse of the value and of the floor that is added to it.
    pub tail: f64,
    pub floor: f64,
}

impl Point {
    /// Sets the weights: of the difference of values, which have the factor, and of that of the lobes alone, which are the density.
    pub fn weigh(&mut self, value: f64, density: f64) {
        (self.rest, self.value) = (0.0, value);
        for c in 0..3 {
            let (factor, target) = (self.factor[c], self.target[c]);
            self.weight[c] = value * factor * factor + density;
            if factor == 1.0 {
                self.aim[c] = target;
                continue;
            }
            self.aim[c] = (value * factor + density) * target / self.weight[c].max(f64::MIN_POSITIVE);
            self.rest += (value + density) * target * target - self.weight[c] * self.aim[c] * self.aim[c];
        }
    }

    /// Mean weight of the channels.
    #[inline(always)]
    fn mean_weight(&self) -> f64 {
        (self.weight[0] + self.weight[1] + self.weight[2]) / 3.0
    }
}

/// Sums over the samples of a view. Derivatives are in the order of [`Lobes::slopes`].
#[derive(Clone, Debug)]
pub(crate) struct Sums {
    /// Sum of the weighted squared differences.
    pub cost: f64,
    /// Products of derivatives of unit lobes; [width * width], lower half.
    pub gram: Vec<f64>,
    /// Products of derivatives of unit lobes with the difference, per channel; [width].
    pub moment: [Vec<f64>; 3],
}

/// Values of the lobes at every point, per channel. `amplitudes`: per channel, of the lobes and the diffuse term.
pub(crate) fn values(lobes: &Lobes, amplitudes: &[Vec<f64>; 3], points: &[Point]) -> Vec<[f64; 3]> {
    vector::run(Values { lobes, amplitudes, points })
}

/// Sum of the weighted squared differences.
pub(crate) fn cost(lobes: &Lobes, amplitudes: &[Vec<f64>; 3], points: &[Point]) -> f64 {
    let squares = values(lobes, amplitudes, points).into_iter().zip(points).map(|(value, point)| {
        let square = |c: usize| point.weight[c] * (value[c] - point.aim[c]) * (value[c] - point.aim[c]);
        square(0) + square(1) + square(2) + point.rest
    });
    squares.sum()
}

/// Sum of the weighted squares of a unit lobe, and of its weighted products with the residual `left` at every point, per channel. The
/// squares are by the mean weight of the channels.
pub(crate) fn projection(lobes: &Lobes, k: usize, points: &[Point], left: &[[f64; 3]]) -> (f64, [f64; 3]) {
    vector::run(Projection { lobes, k, points, left })
}

/// All sums.
pub(crate) fn sums(lobes: &Lobes, amplitudes: &[Vec<f64>; 3], points: &[Point]) -> Sums {
    vector::run(AllSums { lobes, amplitudes, points })
}

struct Values<'a> {
    lobes: &'a Lobes,
    amplitudes: &'a [Vec<f64>; 3],
    points: &'a [Point],
}

impl Operation for Values<'_> {
    type Output = Vec<[f64; 3]>;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> Vec<[f64; 3]> {
        let mut out = Vec::with_capacity(self.points.len());
        for chunk in self.points.chunks(PANEL) {
            let panel = self.lobes.panel(chunk.iter().map(|p| p.direction));
            let sums = self.lobes.sums(&panel, self.amplitudes);
            out.extend((0..chunk.len()).map(|n| [sums[0][n], sums[1][n], sums[2][n]]));
        }
        out
    }
}

struct Projection<'a> {
    lobes: &'a Lobes,
    k: usize,
    points: &'a [Point],
    left: &'a [[f64; 3]],
}

impl Operation for Projection<'_> {
    type Output = (f64, [f64; 3]);

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> (f64, [f64; 3]) {
        let (mut square, mut moment) = (0.0, [0.0; 3]);
        for (points, left) in self.points.chunks(PANEL).zip(self.left.chunks(PANEL)) {
            let panel = self.lobes.panel(points.iter().map(|p| p.direction));
            let Some(values) = self.lobes.column(self.k, &panel) else { continue };
            for ((point, left), value) in points.iter().zip(left).zip(values) {
                square += point.mean_weight() * value * value;
                (0..3).for_each(|c| moment[c] += point.weight[c] * value * left[c]);
            }
        }
        (square, moment)
    }
}

struct AllSums<'a> {
    lobes: &'a Lobes,
    amplitudes: &'a [Vec<f64>; 3],
    points: &'a [Point],
}

impl Operation for AllSums<'_> {
    type Output = Sums;

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) -> Sums {
        match V::LANES {
            WIDEST => self.sums::<V, 4>(vectors),
            4 => self.sums::<V, 3>(vectors),
            _ => self.sums::<V, 2>(vectors),
        }
    }
}

impl AllSums<'_> {
    /// The Gram matrix in tiles of `SIDE` columns across and down.
    #[inline(always)]
    fn sums<V: Vectors, const SIDE: usize>(self, vectors: V) -> Sums {
        let k = self.lobes.len();
        let width = self.lobes.slopes_len();
        // Derivatives, three differences, and a column of zeros that fills tiles up.
        let zero = width + 3;
        let stride = zero + 1;
        let mut columns = vec![[0.0; PANEL]; stride];
        let mut is_used = vec![true; width];
        let mut used: Vec<usize> = Vec::with_capacity(stride + SIDE);
        let mut gram = vec![[0.0; WIDEST / 2]; stride * stride];
        let mut cost = 0.0;
        for chunk in self.points.chunks(PANEL) {
            let panel = self.lobes.panel(chunk.iter().map(|p| p.direction));
            // Missing points of a panel have weight 0.
            let mut scale = [0.0; PANEL];
            scale.iter_mut().zip(chunk).for_each(|(s, p)| *s = p.mean_weight().sqrt());
            self.lobes.slopes(&panel, &scale, &mut columns[..width], &mut is_used);
            for c in 0..3 {
                let mut difference = [0.0; PANEL];
                for (n, point) in chunk.iter().enumerate() {
                    difference[n] = -scale[n] * point.aim[c];
                }
                let values = (0..k).map(|k| (k, 2 * self.lobes.len() + k)).chain([(k, width - 1)]);
                for (lobe, column) in values.filter(|v| is_used[v.1]) {
                    let amplitude = self.amplitudes[c][lobe];
                    for (d, v) in difference.iter_mut().zip(&columns[column]) {
                        *d = fused(amplitude, *v, *d);
                    }
                }
                // By the weight of the channel, over that of all, which the derivatives have.
                for (n, point) in chunk.iter().enumerate() {
                    let share = point.weight[c] / point.mean_weight().max(f64::MIN_POSITIVE);
                    cost += share * difference[n] * difference[n];
                    difference[n] *= share;
                }
                columns[width + c] = difference;
            }
            cost += chunk.iter().map(|p| p.rest).sum::<f64>();
            used.clear();
            used.extend((0..zero).filter(|&i| i >= width || is_used[i]));
            used.resize(used.len().next_multiple_of(SIDE), zero);
            for (first, across) in used.chunks_exact(SIDE).enumerate() {
                let right: [&[f64]; SIDE] = std::array::from_fn(|i| &columns[across[i]][..]);
                for down in used[SIDE * first..].chunks_exact(SIDE) {
                    let tile = vectors.tile(std::array::from_fn(|i| &columns[down[i]][..]), right);
                    for (i, row) in down.iter().zip(tile) {
                        for (j, product) in across.iter().zip(row) {
                            let sum = &mut gram[i * stride + j];
                            (0..WIDEST / 2).for_each(|n| sum[n] += product[n] + product[n + WIDEST / 2]);
                        }
                    }
                }
            }
        }
        let sum = |i: usize, j: usize| {
            let [a, b, c, d] = gram[i * stride + j];
            (a + c) + (b + d)
        };
        Sums {
            cost,
            gram: (0..width * width)
                .map(|n| if n % width <= n / width { sum(n / width, n % width) } else { 0.0 })
                .collect(),
            moment: [0, 1, 2].map(|c| (0..width).map(|i| sum(width + c, i)).collect()),
        }
    }
}
