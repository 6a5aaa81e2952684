//! What a fit makes small, with gradient and Gauss-Newton matrix.
//!
//! A sum of squares over all views at once, of
//!
//! * *data*: `f cos` of the lobes minus that of the table at every sample, relative to the view: the squared relative L2
//!   error, plus a share of the relative variance that the lobes would have as a density, in which an error
//!   counts relative to the value where it is (a view's norm is its peak; the variance sees the rest of the hemisphere);
//! * *energy*: the logarithm of the albedo over the table's, per channel;
//! * *ceiling*: what any channel's albedo exceeds `CEILING` by, at the views, at the knots and between them;
//! * *roughness*: second differences of the unknowns from knot to knot, with the symmetry at the normal (angles are odd in
//!   theta, the rest even) and a weak pull towards no change in the last interval, which Cornell's data do not reach.
//!
//! A view sees only the two knots round it, and roughness three in a row, so the matrix is a band two knots wide.

pub(crate) mod data_term;

use crate::FitError;
use crate::isotropic::model::Lobes;
use crate::isotropic::model::parameters::{LN_SHARPNESS_DEFENSIVE, Layout};
use crate::numeric::banded::Banded;
use crate::numeric::special::sphere_integral;
use crate::table::albedo_log::Ratio;
use crate::table::{Table, View, check_bright, check_storable};
use data_term::Point;
use rayon::prelude::*;

/// Share of a view's mean below which the variance no longer asks for relative accuracy: there it is noise.
const TAIL_FLOOR: f64 = 0.05;
/// Times by which lobes may fall short of the table before the tail weighs more there, by the square, and how much more at most:
/// `f cos / pdf` is about as many times the mean there (chrome: 10 in place of 27).
const SHORT: f64 = 3.0;
const MOST_SHORT: f64 = 1000.0;
/// Share of the albedo that the defensive lobe has at least. With its bounds (`crate::isotropic::model::parameters`) every direction has at
/// least 0.012 of it as density, 2.5e-5 / sr: that bounds `f cos / pdf`. Without such a lobe the diffuse term
/// has `DEFENSIVE_DIFFUSE`.
const DEFENSIVE: f64 = 0.002;
const DEFENSIVE_DIFFUSE: f64 = 0.01;

/// Error of an albedo from which it counts more, with its square, and how much more at most: the goal is for the largest.
const ALBEDO_ERROR: f64 = 0.005;
const MOST_ALBEDO: f64 = 10.0;

/// Albedo from which a view is pulled down.
const CEILING: f64 = 0.96;
/// Weight of the excess.
const CEILING_WEIGHT: f64 = 30.0;
/// Views between two knots at which the ceiling is watched.
const WATCHED: usize = 4;
/// Most that the weight of a view changes by its error.
const MOST_FACTOR: f64 = 2.5;
/// Weight of the change in the last interval beside that of second differences.
const HOLD: f64 = 0.1;

/// Weights that change in the course of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weights {
    /// Of the roughness.
    pub smoothness: f64,
    /// Of the squared relative error of the albedo beside the squared relative L2 error.
    pub energy: f64,
}

/// One view as the fit sees it.
#[derive(Clone)]
pub(crate) struct Data {
    pub place: (usize, f64),
    pub points: Vec<Point>,
    albedo: [f64; 3],
    /// Factors of the weights of its errors.
    energy: [f64; 3],
}

/// Linearisation in one view: half the gradient, and the upper half of the Gauss-Newton matrix, by its unknowns.
struct Block {
    place: (usize, f64),
    /// Diagonal of the data term.
    scale: Vec<f64>,
    cost: f64,
    gradient: Vec<f64>,
    matrix: Vec<f64>,
}

impl Block {
    /// Makes the lower half of the matrix that of the upper.
    fn mirror(&mut self) {
        let p = self.gradient.len();
        for i in 0..p {
            for j in 0..i {
                self.matrix[i * p + j] = self.matrix[j * p + i];
            }
        }
    }
}

/// The whole problem linearised at a point.
pub(crate) struct Linearized {
    pub cost: f64,
    pub gradient: Vec<f64>,
    pub matrix: Banded,
    /// Diagonal of the matrix without the albedo terms, to which damping is relative: those terms are stiff in one direction
    /// and must not hold up the others.
    pub scale: Vec<f64>,
}

/// The sum of squares over a table, for a layout.
#[derive(Clone)]
pub(crate) struct Objective {
    pub layout: Layout,
    pub views: Vec<Data>,
    watched: Vec<(usize, f64)>,
    /// Least logarithm of the amplitude of the defensive lobe, by knot and channel.
    ln_defensive: Vec<[f64; 3]>,
    ratio: Ratio,
}

impl Objective {
    /// `tail`: weight of the relative variance beside the squared relative L2 error.
    pub fn new(table: &Table, layout: Layout, tail: f64) -> Result<Self, FitError> {
        let brightest = table.views.iter().flat_map(|v| v.albedo).fold(0.0, f64::max);
        let count = table.views.len() as f64;
        let strongest = table.views.iter().map(norm_squared).fold(0.0, f64::max);
        check_storable(table.views.iter().flat_map(|view| &view.samples))?;
        check_bright(strongest > 0.0 && strongest.is_finite())?;
        let data = |view: &View| {
            let norm = norm_squared(view).max(1e-9 * strongest);
            let bright = |s: &crate::table::Sample| s.rgb.iter().sum::<f64>() / 3.0 * s.direction[2];
            let energy: f64 = view.samples.iter().map(|s| s.weight * bright(s)).sum();
            let solid: f64 = view.samples.iter().map(|s| s.weight).sum();
            let mean = (energy / solid).max(1e-9 * brightest);
            let points = view.samples.iter().map(|s| {
                let base = s.weight / norm / count;
                let tail = tail * s.weight / (mean * solid) / 3.0 / count;
                let floor = TAIL_FLOOR * mean * 2.0 * s.direction[2];
                let target = s.rgb.map(|v| v * s.direction[2]);
                Point {
                    direction: s.direction,
                    target,
                    weight: base + tail / (bright(s) + floor),
                    base,
                    tail,
                    floor,
                }
            });
            Data {
                place: layout.place(view.theta),
                points: points.collect(),
                albedo: view.albedo,
                energy: [1.0; 3],
            }
        };
        let views = table.views.iter().map(data).collect();
        let ln_defensive = layout.knots.iter().map(|&theta| {
            let far = |v: &&View| (v.theta - theta).abs();
            let nearest = table.views.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
            let albedo = nearest.map_or([0.0; 3], |v| v.albedo);
            albedo.map(|a| {
                libm::log(DEFENSIVE * a.max(1e-9 * brightest) / sphere_integral(LN_SHARPNESS_DEFENSIVE.1).0)
            })
        });
        let ln_defensive = ln_defensive.collect();
        let last = layout.knots.len() - 1;
        let between = |knot: usize| (0..WATCHED).map(move |i| (knot, i as f64 / WATCHED as f64));
        let mut watched: Vec<(usize, f64)> = (0..last).flat_map(between).collect();
        watched.push((last - usize::from(last > 0), if last > 0 { 1.0 } else { 0.0 }));
        Ok(Self {
            layout,
            views,
            watched,
            ln_defensive,
            ratio: Ratio::new(table.views.iter().map(|v| v.albedo)),
        })
    }

    /// Least and greatest value of an unknown, at its knot.
    pub fn bounds(&self, unknown: usize) -> (f64, f64) {
        let (knot, index) = (unknown / self.layout.stride(), unknown % self.layout.stride());
        let (low, high) = self.layout.bounds(index);
        if let Some(lobe) = self.layout.defensive() {
            for c in 0..3 {
                if index == self.layout.amplitude(c, lobe) {
                    return (low.max(self.ln_defensive[knot][c]), high);
                }
            }
        } else if let Some(c) = (0..3).find(|&c| index == self.layout.diffuse(c)) {
            let share = self.ln_defensive[knot][c]
                + libm::log(sphere_integral(LN_SHARPNESS_DEFENSIVE.1).0 * DEFENSIVE_DIFFUSE / DEFENSIVE);
            return (low.max(share), high);
        }
        (low, high)
    }

    /// The same with weights that follow the fit. Views count in inverse proportion to their error, so that what is made small
    /// is the mean error, not the mean of its square. The tail counts as if the lobes' values were the table's where they
    /// are lower: there a renderer that samples the lobes gets its largest weights. `evenly`: albedos count the more, the worse
    /// they are.
    pub fn reweighed(&self, x: &[f64], evenly: bool) -> Self {
        let mut new = self.clone();
        let mut q = vec![0.0; self.layout.stride()];
        let mut errors = Vec::with_capacity(new.views.len());
        for view in &mut new.views {
            self.layout.interpolate(x, view.place, &mut q);
            let (lobes, amplitudes) = (Lobes::new(&self.layout, &q), amplitudes(&self.layout, &q));
            let mut square = 0.0;
            let values = data_term::values(&lobes, &amplitudes, &view.points);
            for (point, values) in view.points.iter_mut().zip(values) {
                let mut sum = 0.0;
                for (value, target) in values.into_iter().zip(point.target) {
                    square += point.base * (value - target) * (value - target);
                    sum += value;
                }
                let bright = point.target.iter().sum::<f64>();
                let short = bright / (SHORT * sum).max(1e-300);
                let short = (short * short).clamp(1.0, MOST_SHORT);
                point.weight = point.tail * short / (sum.min(bright) / 3.0 + point.floor);
            }
            errors.push(libm::sqrt(square));
            if evenly {
                let albedo = self.layout.albedo(&q);
                view.energy = [0, 1, 2].map(|c| {
                    let error = self.ratio.ln(albedo[c], view.albedo[c]) / ALBEDO_ERROR;
                    (error * error).clamp(1.0, MOST_ALBEDO)
                });
            }
        }
        let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        for (view, error) in new.views.iter_mut().zip(errors) {
            let factor = if error > 0.0 { (mean / error).clamp(1.0 / MOST_FACTOR, MOST_FACTOR) } else { 1.0 };
            view.points.iter_mut().for_each(|p| p.weight += factor * p.base);
        }
        new
    }

    /// The cost at a point.
    pub fn cost(&self, x: &[f64], weights: Weights) -> f64 {
        let layout = &self.layout;
        let parts: Vec<f64> = self
            .views
            .par_iter()
            .map(|view| {
                let mut q = vec![0.0; layout.stride()];
                layout.interpolate(x, view.place, &mut q);
                let lobes = Lobes::new(layout, &q);
                let amplitudes = amplitudes(layout, &q);
                let mut cost = data_term::cost(&lobes, &amplitudes, &view.points);
                let albedo = layout.albedo(&q);
                (0..3).for_each(|c| {
                    cost += self
                        .energy_residual(albedo[c], view.albedo[c], view.energy[c] * weights.energy)
                        .powi(2)
                });
                cost
            })
            .collect();
        let mut cost: f64 = parts.iter().sum();
        let mut q = vec![0.0; layout.stride()];
        for &place in &self.watched {
            layout.interpolate(x, place, &mut q);
            cost += layout.albedo(&q).iter().map(|a| self.excess(*a).powi(2)).sum::<f64>();
        }
        self.for_each_difference(weights.smoothness, |terms| {
            let r: f64 = terms.iter().map(|&(index, factor)| factor * x[index]).sum();
            cost += r * r;
        });
        cost
    }

    /// The problem linearised at a point. The cost is that of [`cost`](Self::cost).
    pub fn linearize(&self, x: &[f64], weights: Weights) -> Linearized {
        let layout = &self.layout;
        let p = layout.stride();
        let mut blocks: Vec<Block> =
            self.views.par_iter().map(|view| self.linearize_view(view, x, weights.energy)).collect();
        for &place in &self.watched {
            let mut q = vec![0.0; p];
            layout.interpolate(x, place, &mut q);
            let albedo = layout.albedo(&q);
            if albedo.iter().all(|a| self.excess(*a) == 0.0) {
                continue;
            }
            let mut block = Block {
                place,
                scale: vec![0.0; p],
                cost: 0.0,
                gradient: vec![0.0; p],
                matrix: vec![0.0; p * p],
            };
            for (channel, &a) in albedo.iter().enumerate() {
                let excess = self.excess(a);
                if excess > 0.0 {
                    self.add_albedo_row(
                        &mut block,
                        &q,
                        channel,
                        excess,
                        self.excess(a + 1.0) - self.excess(a),
                    );
                }
            }
            blocks.push(block);
        }

        let mut sum = Linearized {
            cost: 0.0,
            gradient: vec![0.0; layout.len()],
            scale: vec![0.0; layout.len()],
            matrix: Banded::zeros(layout.len(), (2 * p).min(layout.len() - 1)),
        };
        for block in &mut blocks {
            block.mirror();
            sum.cost += block.cost;
            let (knot, blend) = block.place;
            let ends = [(knot, 1.0 - blend), (knot + 1, blend)];
            for (a, (knot_a, share_a)) in ends.into_iter().enumerate().filter(|e| e.1.1 > 0.0) {
                for i in 0..p {
                    sum.gradient[knot_a * p + i] += share_a * block.gradient[i];
                    sum.scale[knot_a * p + i] += share_a * share_a * block.scale[i];
                }
                for (knot_b, share_b) in ends.into_iter().take(a + 1).filter(|e| e.1 > 0.0) {
                    let share = share_a * share_b;
                    for j in 0..p {
                        let start = if knot_a == knot_b { j } else { 0 };
                        let row = &block.matrix[j * p + start..(j + 1) * p];
                        sum.matrix.add_run(knot_a * p + start, knot_b * p + j, share, row);
                    }
                }
            }
        }
        self.for_each_difference(weights.smoothness, |terms| {
            let r: f64 = terms.iter().map(|&(index, factor)| factor * x[index]).sum();
            sum.cost += r * r;
            for (a, &(i, fi)) in terms.iter().enumerate() {
                sum.gradient[i] += fi * r;
                sum.scale[i] += fi * fi;
                for &(j, fj) in &terms[..=a] {
                    sum.matrix.add(i, j, fi * fj);
                }
            }
        });
        sum
    }

    fn linearize_view(&self, view: &Data, x: &[f64], energy: f64) -> Block {
        let layout = &self.layout;
        let (p, k) = (layout.stride(), layout.lobes);
        let mut q = vec![0.0; p];
        layout.interpolate(x, view.place, &mut q);
        let lobes = Lobes::new(layout, &q);
        let amplitude = amplitudes(layout, &q);

        let data_term::Sums { cost, gram, moment } = data_term::sums(&lobes, &amplitude, &view.points);

        // From derivatives of unit lobes to derivatives by the unknowns.
        let width = lobes.slopes_len();
        let off_plane = 3 * k + layout.squeezed;
        let mut block = Block {
            place: view.place,
            scale: vec![0.0; p],
            cost,
            gradient: vec![0.0; p],
            matrix: vec![0.0; p * p],
        };
        // Which unknown a derivative belongs to, and the amplitude that it is multiplied by.
        let lobe_of = |i: usize| match i {
            _ if i == width - 1 => k,
            _ if i >= off_plane => layout.first_mirrored() + i - off_plane,
            _ => i % k,
        };
        let target = |i: usize, channel: usize| match i / k {
            _ if i == width - 1 => layout.diffuse(channel),
            _ if i >= off_plane => layout.off_plane(i - off_plane),
            0 => layout.angle(lobe_of(i)),
            1 => layout.sharpness(lobe_of(i)),
            2 => layout.amplitude(channel, lobe_of(i)),
            _ => 0,
        };
        for c in 0..3 {
            let targets: Vec<(usize, f64)> =
                (0..width).map(|i| (target(i, c), amplitude[c][lobe_of(i)])).collect();
            for (i, &(a, factor)) in targets.iter().enumerate() {
                block.gradient[a] += factor * moment[c][i];
                for (&(b, other), product) in targets[..=i].iter().zip(&gram[i * width..]) {
                    let value = factor * other * product;
                    let element = &mut block.matrix[a.min(b) * p + a.max(b)];
                    // Both (i, j) and (j, i) of the Gram matrix may fall on one element: the squeeze is shared.
                    *element += value;
                }
                let shared = targets[..i].iter().zip(&gram[i * width..]).filter(|(target, _)| target.0 == a);
                block.matrix[a * p + a] +=
                    shared.map(|(target, product)| factor * target.1 * product).sum::<f64>();
            }
        }
        (0..p).for_each(|i| block.scale[i] = block.matrix[i * p + i]);
        let albedo = layout.albedo(&q);
        for (c, (&fitted, &data)) in albedo.iter().zip(&view.albedo).enumerate() {
            let energy = view.energy[c] * energy;
            let residual = self.energy_residual(fitted, data, energy);
            let slope = libm::sqrt(energy / (3.0 * self.views.len() as f64)) / self.ratio.shifted(fitted);
            self.add_albedo_row(&mut block, &q, c, residual, slope);
        }
        block
    }

    /// Adds the square of a residual of one channel's albedo to a view.
    fn add_albedo_row(&self, block: &mut Block, q: &[f64], channel: usize, residual: f64, by_albedo: f64) {
        let layout = &self.layout;
        let p = layout.stride();
        let mut row = Vec::with_capacity(2 * layout.lobes);
        for k in 0..layout.lobes {
            let (integral, slope) = sphere_integral(q[layout.sharpness(k)]);
            let amplitude = by_albedo * layout.copies(k) * libm::exp(q[layout.amplitude(channel, k)]);
            row.push((layout.sharpness(k), amplitude * slope));
            row.push((layout.amplitude(channel, k), amplitude * integral));
        }
        row.push((layout.diffuse(channel), by_albedo * libm::exp(q[layout.diffuse(channel)])));
        block.cost += residual * residual;
        for &(i, a) in &row {
            block.gradient[i] += a * residual;
            for &(j, b) in row.iter().filter(|e| e.0 <= i) {
                block.matrix[j * p + i] += a * b;
            }
        }
    }

    fn energy_residual(&self, fitted: f64, data: f64, weight: f64) -> f64 {
        libm::sqrt(weight / (3.0 * self.views.len() as f64)) * self.ratio.ln(fitted, data)
    }

    fn excess(&self, albedo: f64) -> f64 {
        libm::sqrt(CEILING_WEIGHT / self.watched.len() as f64) * (albedo - CEILING).max(0.0)
    }

    /// Calls with the terms (unknown, factor) of each residual of the roughness, unknowns rising.
    fn for_each_difference(&self, smoothness: f64, mut each: impl FnMut(&[(usize, f64)])) {
        let layout = &self.layout;
        let knots = &layout.knots;
        let (p, last) = (layout.stride(), knots.len() - 1);
        if last == 0 || smoothness == 0.0 {
            return;
        }
        let mean = knots[last] / last as f64;
        let per_interval: Vec<f64> = knots.windows(2).map(|w| mean / (w[1] - w[0])).collect();
        for index in 0..p {
            let weight = libm::sqrt(smoothness / ((last as f64) * p as f64)) / layout.unit(index);
            if !layout.angles().contains(&index) {
                let d = 2.0 * weight * per_interval[0];
                each(&[(index, -d), (p + index, d)]);
            }
            for k in 1..last {
                let (a, b) = (weight * per_interval[k - 1], weight * per_interval[k]);
                each(&[((k - 1) * p + index, a), (k * p + index, -a - b), ((k + 1) * p + index, b)]);
            }
            let d = HOLD * weight * per_interval[last - 1];
            each(&[((last - 1) * p + index, -d), (last * p + index, d)]);
        }
    }
}

/// Squared norm of `f cos` over a view.
fn norm_squared(view: &View) -> f64 {
    let square =
        |s: &crate::table::Sample| s.rgb.iter().map(|v| v * v).sum::<f64>() * s.direction[2] * s.direction[2];
    view.samples.iter().map(|s| s.weight * square(s)).sum()
}

/// Amplitudes of the lobes and of the diffuse term, per channel.
pub(crate) fn amplitudes(layout: &Layout, q: &[f64]) -> [Vec<f64>; 3] {
    let channel = |c| (0..layout.lobes).map(move |k| layout.amplitude(c, k)).chain([layout.diffuse(c)]);
    [0, 1, 2].map(|c| channel(c).map(|i| libm::exp(q[i])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::Random;
    use crate::table::direction;

    fn problem() -> (Objective, Vec<f64>) {
        let mut random = Random::new(3);
        let mut views = vec![];
        for theta in [0.3, 0.5, 1.1] {
            let mut scattered = vec![];
            for _ in 0..40 {
                let d = direction(1.5 * random.next(), 3.1 * random.next());
                scattered.push((d, [0.1 + random.next(), random.next(), 0.3 * random.next()]));
            }
            views.push((theta, scattered));
        }
        let table = Table::from_scattered(views).unwrap();
        let layout = Layout::new(4, 2, 1, vec![0.0, 0.5, 1.0, 1.5]);
        let mut x: Vec<f64> = (0..layout.len()).map(|_| 2.0 * random.next() - 0.7).collect();
        x.chunks_mut(layout.stride()).for_each(|knot| knot[0] = -0.4);
        (Objective::new(&table, layout, 0.03).unwrap(), x)
    }

    #[test]
    fn gradient_and_cost_agree_with_differences() {
        let (objective, x) = problem();
        let smoothness = Weights { smoothness: 0.1, energy: 2.0 };
        let linearized = objective.linearize(&x, smoothness);
        let cost = objective.cost(&x, smoothness);
        assert!((linearized.cost - cost).abs() < 1e-12 * cost, "{} {cost}", linearized.cost);
        for i in 0..x.len() {
            let at = |h: f64| {
                let mut x = x.clone();
                x[i] += h;
                objective.cost(&x, smoothness)
            };
            let h = 1e-5;
            // `gradient` is that of half the cost.
            let difference = (at(h) - at(-h)) / (4.0 * h);
            let g = linearized.gradient[i];
            assert!((difference - g).abs() < 1e-6 * (g.abs() + cost), "{i}: {difference} {g}");
        }
    }

    #[test]
    fn the_matrix_is_the_second_derivative_where_the_data_are_met() {
        // Gauss-Newton is exact where residuals vanish: make the targets the values themselves.
        let (mut objective, x) = problem();
        let layout = objective.layout.clone();
        objective.watched.clear();
        for view in &mut objective.views {
            let mut q = vec![0.0; layout.stride()];
            layout.interpolate(&x, view.place, &mut q);
            view.albedo = layout.albedo(&q);
            let (lobes, a) = (Lobes::new(&layout, &q), amplitudes(&layout, &q));
            for point in &mut view.points {
                let mut unit = [0.0; 5];
                lobes.values(&point.direction, &mut unit);
                point.target = [0, 1, 2].map(|c| (0..5).map(|k| a[c][k] * unit[k]).sum());
            }
        }
        let none = Weights { smoothness: 0.0, energy: 1.0 };
        let linearized = objective.linearize(&x, none);
        let scale = (0..x.len()).map(|i| linearized.matrix.diagonal(i)).fold(0.0, f64::max);
        let mut random = Random::new(5);
        for _ in 0..20 {
            let step: Vec<f64> = x.iter().map(|_| 1e-5 * (random.next() - 0.5)).collect();
            let moved: Vec<f64> = x.iter().zip(&step).map(|(x, s)| x + s).collect();
            let expected = objective.cost(&moved, none);
            let quadratic = linearized.matrix.quadratic(&step);
            assert!((expected - quadratic).abs() < 1e-3 * expected + 1e-16 * scale, "{expected} {quadratic}");
        }
    }
}
