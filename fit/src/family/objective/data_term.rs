//! The data term of one view: squared differences between lobes and samples, and what Gauss-Newton needs of them.
//!
//! The derivative of a value by an unknown is that of a unit lobe, the same for all channels, times an amplitude. So only
//! the Gram matrix of the derivatives of unit lobes is summed over the samples, once for the three channels; the
//! differences are three more columns of it. Where factors give the channels weights of their own, the matrix has their mean: the
//! gradient is exact, the steps are a little shorter or longer than Gauss-Newton's.

use crate::family::lobes::Lobes;
use crate::family::unit::{Column, PANEL};
use crate::numeric::vector::{self, Operation, Vectors, WIDEST, fused_f32};

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
    /// Factors on the weight of the difference of values, of channels that are falsely below 0.
    pub by_sign: [f64; 3],
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
            let value = value * self.by_sign[c];
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

/// The samples of a view as loops over them read these: number by number, without those that the loops do not need.
#[derive(Clone, Debug)]
pub(crate) struct Panels {
    panels: Vec<Panel>,
    /// How many samples there are.
    count: usize,
    /// The largest mean weight of a sample. Weights are over it, so that squares of anything are within the range of f32.
    largest: f64,
    /// Sum of [`Point::rest`].
    rest: f64,
}

/// Samples side by side. Those that lack are straight up and have no weight.
#[derive(Clone, Debug)]
struct Panel {
    at: [Column; 3],
    aim: [Column; 3],
    /// Root of the mean weight of the channels, over the largest; and that of each channel over the mean.
    scale: Column,
    share: [Column; 3],
}

impl Panels {
    /// Of samples whose weights are set.
    pub fn new(points: &[Point]) -> Self {
        let largest = points.iter().map(Point::mean_weight).fold(f64::MIN_POSITIVE, f64::max);
        let panel = |points: &[Point]| {
            let zero = [0.0; PANEL];
            let mut panel =
                Panel { at: [zero, zero, [1.0; PANEL]], aim: [zero; 3], scale: zero, share: [zero; 3] };
            for (n, point) in points.iter().enumerate() {
                let mean = point.mean_weight();
                panel.scale[n] = (mean / largest).sqrt() as f32;
                for c in 0..3 {
                    panel.at[c][n] = point.direction[c] as f32;
                    panel.aim[c][n] = point.aim[c] as f32;
                    panel.share[c][n] = (point.weight[c] / mean.max(f64::MIN_POSITIVE)) as f32;
                }
            }
            panel
        };
        let panels = points.chunks(PANEL).map(panel).collect();
        Self { panels, count: points.len(), largest, rest: points.iter().map(|p| p.rest).sum() }
    }
}

/// Sums over the samples of a view. Derivatives are in the order of [`Lobes::slopes`].
#[derive(Clone, Debug)]
pub(crate) struct Sums {
    /// Sum of the weighted squared differences.
    pub cost: f64,
    /// Products of derivatives of unit lobes; [width * width].
    pub gram: Vec<f64>,
    /// Products of derivatives of unit lobes with the difference, per channel; [width].
    pub moment: [Vec<f64>; 3],
}

/// Values of the lobes at every sample, per channel. `amplitudes`: per channel, of the lobes and the diffuse term.
pub(crate) fn values(lobes: &Lobes, amplitudes: &[Vec<f64>; 3], samples: &Panels) -> Vec<[f64; 3]> {
    let columns = vector::run(Values { lobes, amplitudes, samples });
    let of = |n: usize| [0, 1, 2].map(|c| f64::from(columns[n / PANEL][c][n % PANEL]));
    (0..samples.count).map(of).collect()
}

/// Sum of the weighted squared differences.
pub(crate) fn cost(lobes: &Lobes, amplitudes: &[Vec<f64>; 3], samples: &Panels) -> f64 {
    vector::run(Cost(Values { lobes, amplitudes, samples }))
}

/// Sum of the weighted squares of the first unit lobe, and of its weighted products with the residual `left` at every sample, per channel. The
/// squares are by the mean weight of the channels.
pub(crate) fn projection(lobes: &Lobes, samples: &Panels, left: &[[f64; 3]]) -> (f64, [f64; 3]) {
    vector::run(Projection { lobes, samples, left })
}

/// All sums.
pub(crate) fn sums(lobes: &Lobes, amplitudes: &[Vec<f64>; 3], samples: &Panels) -> Sums {
    vector::run(AllSums { lobes, amplitudes, samples })
}

struct Values<'a> {
    lobes: &'a Lobes,
    amplitudes: &'a [Vec<f64>; 3],
    samples: &'a Panels,
}

impl Operation for Values<'_> {
    type Output = Vec<[Column; 3]>;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> Vec<[Column; 3]> {
        let mut out = Vec::with_capacity(self.samples.panels.len());
        for panel in &self.samples.panels {
            out.push(self.lobes.sums(&self.lobes.panel(&panel.at), self.amplitudes));
        }
        out
    }
}

struct Cost<'a>(Values<'a>);

impl Operation for Cost<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> f64 {
        let Values { lobes, amplitudes, samples } = self.0;
        let mut sums = [0.0; WIDEST];
        for panel in &samples.panels {
            let values = lobes.sums(&lobes.panel(&panel.at), amplitudes);
            for (values, (aim, share)) in values.iter().zip(panel.aim.iter().zip(&panel.share)) {
                add_squares(&mut sums, share, |n| panel.scale[n] * (values[n] - aim[n]));
            }
        }
        samples.largest * sums.iter().sum::<f64>() + samples.rest
    }
}

/// Adds weighted squares, lane by lane.
#[inline(always)]
fn add_squares(sums: &mut [f64; WIDEST], weights: &Column, at: impl Fn(usize) -> f32) {
    let mut of_panel = [0.0; WIDEST];
    for first in (0..PANEL).step_by(WIDEST) {
        for lane in 0..WIDEST {
            let v = at(first + lane);
            of_panel[lane] = fused_f32(weights[first + lane] * v, v, of_panel[lane]);
        }
    }
    (0..WIDEST).for_each(|lane| sums[lane] += f64::from(of_panel[lane]));
}

struct Projection<'a> {
    lobes: &'a Lobes,
    samples: &'a Panels,
    left: &'a [[f64; 3]],
}

impl Operation for Projection<'_> {
    type Output = (f64, [f64; 3]);

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> (f64, [f64; 3]) {
        let (mut square, mut moment) = (0.0, [0.0; 3]);
        for (panel, left) in self.samples.panels.iter().zip(self.left.chunks(PANEL)) {
            let Some(values) = self.lobes.column(0, &self.lobes.panel(&panel.at)) else { continue };
            for (n, left) in left.iter().enumerate() {
                let value = f64::from(values[n]);
                let weighted = f64::from(panel.scale[n] * panel.scale[n]) * value;
                square += weighted * value;
                (0..3).for_each(|c| moment[c] += f64::from(panel.share[c][n]) * weighted * left[c]);
            }
        }
        (self.samples.largest * square, moment.map(|m| self.samples.largest * m))
    }
}

struct AllSums<'a> {
    lobes: &'a Lobes,
    amplitudes: &'a [Vec<f64>; 3],
    samples: &'a Panels,
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
        let mut squares = [0.0; WIDEST];
        for panel in &self.samples.panels {
            let directions = self.lobes.panel(&panel.at);
            self.lobes.slopes(&directions, &panel.scale, &mut columns[..width], &mut is_used);
            for c in 0..3 {
                let mut difference: Column = std::array::from_fn(|n| -panel.scale[n] * panel.aim[c][n]);
                let values = (0..k).map(|k| (k, 2 * self.lobes.len() + k)).chain([(k, width - 1)]);
                for (lobe, column) in values.filter(|v| is_used[v.1]) {
                    let amplitude = self.amplitudes[c][lobe] as f32;
                    for (d, v) in difference.iter_mut().zip(&columns[column]) {
                        *d = fused_f32(amplitude, *v, *d);
                    }
                }
                add_squares(&mut squares, &panel.share[c], |n| difference[n]);
                // By the weight of the channel, over that of all, which the derivatives have.
                difference.iter_mut().zip(&panel.share[c]).for_each(|(d, share)| *d *= share);
                columns[width + c] = difference;
            }
            used.clear();
            used.extend((0..zero).filter(|&i| i >= width || is_used[i]));
            used.resize(used.len().next_multiple_of(SIDE), zero);
            for (first, across) in used.chunks_exact(SIDE).enumerate() {
                let right: [&[f32]; SIDE] = std::array::from_fn(|i| &columns[across[i]][..]);
                for down in used[SIDE * first..].chunks_exact(SIDE) {
                    let tile = vectors.tile_f32(std::array::from_fn(|i| &columns[down[i]][..]), right);
                    for (i, row) in down.iter().zip(tile) {
                        for (j, product) in across.iter().zip(row) {
                            let sum = &mut gram[i * stride + j];
                            (0..WIDEST / 2)
                                .for_each(|n| sum[n] += f64::from(product[n] + product[n + WIDEST / 2]));
                        }
                    }
                }
            }
        }
        let largest = self.samples.largest;
        let sum = |i: usize, j: usize| {
            let [a, b, c, d] = gram[i * stride + j];
            largest * ((a + c) + (b + d))
        };
        Sums {
            cost: largest * squares.iter().sum::<f64>() + self.samples.rest,
            gram: (0..width * width)
                .map(|n| sum((n / width).max(n % width), (n / width).min(n % width)))
                .collect(),
            moment: [0, 1, 2].map(|c| (0..width).map(|i| sum(width + c, i)).collect()),
        }
    }
}
