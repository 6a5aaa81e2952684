//! What an anisotropic fit makes small, with gradient and Gauss-Newton matrix.
//!
//! A sum of squares over all views at once, of the same parts as an isotropic fit's (`objective.rs`, which has the reasons):
//! *data*, relative to the view, with a share for the relative variance; *energy*, the relative error of the albedo; and *roughness*,
//! second differences outward from the normal and, times the sine of the angle, along each ring.

use super::layout::{CellPlace, Layout};
use super::model::{Lobes, Slopes};
use super::table::View;
use crate::FitError;
use crate::anisotropic::tuning::objective::{ENERGY, INNER_STEPS, TAIL, TAIL_FLOOR, TOLERANCE};
use crate::family::layout::{COLOR_SLOPES, rgb};
use crate::isotropic::tuning::schedule::FAINT_COLOR;
use crate::isotropic::tuning::solver::COLOR_STEP;
use crate::judge::energy::EnergyError;
use crate::judge::measure::brightness;
use crate::numeric::blocks::Blocks;
use crate::numeric::levenberg::{LeastSquares, Linear};
use crate::numeric::special::sphere_integral;
use crate::table::{Sample, check_bright, check_storable};
use rayon::prelude::*;
use std::f64::consts::FRAC_1_PI;

struct Point {
    direction: [f64; 3],
    target: [f64; 3],
    weight: f64,
}

struct Data {
    place: CellPlace,
    points: Vec<Point>,
    albedo: [f64; 3],
}

/// Linearisation in one view: half the gradient and the Gauss-Newton matrix by its own unknowns.
struct Local {
    cost: f64,
    gradient: Vec<f64>,
    matrix: Vec<f64>,
}

/// The whole problem linearised at a point.
pub(super) struct Linearized {
    pub cost: f64,
    /// Half the gradient.
    pub gradient: Vec<f64>,
    pub matrix: Blocks,
}

impl Linear for Linearized {
    fn cost(&self) -> f64 {
        self.cost
    }
    fn gradient(&self) -> &[f64] {
        &self.gradient
    }
    fn scale(&self) -> Vec<f64> {
        self.matrix.diagonal()
    }
    /// By conjugate gradients.
    fn step(&mut self, added: &[f64], free: &[bool]) -> Option<Vec<f64>> {
        let downhill: Vec<f64> = self.gradient.iter().map(|g| -g).collect();
        self.matrix.solve(added, free, &downhill, TOLERANCE, INNER_STEPS)
    }
}

impl LeastSquares for Objective {
    const LONGEST_STEP: f64 = 2.0;
    type Linear = Linearized;

    fn bounds(&self, unknown: usize) -> (f64, f64) {
        let (stored, index) = (unknown / self.layout.stride(), unknown % self.layout.stride());
        if self.layout.fixed(stored, index) { (0.0, 0.0) } else { self.layout.bounds(index) }
    }
    fn unit(&self, unknown: usize) -> f64 {
        if self.layout.is_color(unknown % self.layout.stride()) { COLOR_STEP } else { 1.0 }
    }
    fn faint(&self, unknown: usize) -> f64 {
        if self.layout.is_color(unknown % self.layout.stride()) { FAINT_COLOR } else { 1e-10 }
    }
    fn cost(&self, x: &[f64]) -> f64 {
        Self::cost(self, x)
    }
    fn linearize(&self, x: &[f64]) -> Linearized {
        Self::linearize(self, x)
    }
}

/// The sum of squares over a table, for a layout.
pub(super) struct Objective {
    pub layout: Layout,
    smoothness: f64,
    views: Vec<Data>,
    energy: EnergyError,
}

/// Squared norm of `f cos` over a view.
fn norm_squared(view: &View) -> f64 {
    let square = |s: &Sample| s.rgb.iter().map(|v| v * v).sum::<f64>() * s.direction[2] * s.direction[2];
    view.samples.iter().map(|s| s.weight * square(s)).sum()
}

impl Objective {
    /// Takes every `every`-th sample of the views.
    pub fn new(views: &[View], layout: Layout, smoothness: f64, every: usize) -> Result<Self, FitError> {
        let brightest = views.iter().flat_map(|v| v.albedo).fold(0.0, f64::max);
        let strongest = views.iter().map(norm_squared).fold(0.0, f64::max);
        check_storable(views.iter().flat_map(|view| &view.samples))?;
        check_bright(strongest > 0.0 && strongest.is_finite())?;
        let count = views.len() as f64;
        let data = |view: &View| {
            let norm = norm_squared(view).max(1e-9 * strongest);
            let bright = |s: &Sample| brightness(s.rgb) * s.direction[2];
            let energy: f64 = view.samples.iter().map(|s| s.weight * bright(s)).sum();
            let solid: f64 = view.samples.iter().map(|s| s.weight).sum();
            let mean = (energy / solid).max(1e-9 * brightest);
            let points = view.samples.iter().step_by(every).map(|s| {
                let relative = TAIL / ((bright(s) + TAIL_FLOOR * mean) * (mean * solid)) / 3.0;
                Point {
                    direction: s.direction,
                    target: s.rgb.map(|v| v * s.direction[2]),
                    weight: every as f64 * s.weight * (1.0 / norm + relative) / count,
                }
            });
            Data { place: layout.place(view.theta, view.phi), points: points.collect(), albedo: view.albedo }
        };
        let energy = EnergyError::new(views.iter().map(|v| v.albedo));
        let views = views.iter().map(data).collect();
        Ok(Self { layout, smoothness, views, energy })
    }

    /// The cost at a point.
    pub fn cost(&self, x: &[f64]) -> f64 {
        let layout = &self.layout;
        let parts: Vec<f64> = self
            .views
            .par_iter()
            .map(|view| {
                let mut q = vec![0.0; layout.stride()];
                layout.interpolate(x, &view.place, &mut q);
                let lobes = Lobes::new(layout, &q);
                let amplitudes = amplitudes(layout, &q);
                let mut unit = vec![0.0; layout.lobes + 1];
                let mut cost = 0.0;
                for p in &view.points {
                    lobes.values(&p.direction, &mut unit);
                    for (a, target) in amplitudes.iter().zip(p.target) {
                        let value: f64 = a.iter().zip(&unit).map(|(a, u)| a * u).sum();
                        cost += p.weight * (value - target) * (value - target);
                    }
                }
                let residuals = self.energy_residuals(layout.albedo(&q), view.albedo);
                cost += residuals.iter().map(|r| r.0 * r.0).sum::<f64>();
                cost
            })
            .collect();
        let mut cost: f64 = parts.iter().sum();
        self.for_each_difference(|row| {
            let r: f64 = row.iter().map(|&(i, factor)| factor * x[i]).sum();
            cost += r * r;
        });
        cost
    }

    /// The problem linearised at a point. The cost is that of [`cost`](Self::cost).
    pub fn linearize(&self, x: &[f64]) -> Linearized {
        let layout = &self.layout;
        let p = layout.stride();
        let locals: Vec<Local> = self.views.par_iter().map(|view| self.linearize_view(view, x)).collect();
        let mut sum = Linearized {
            cost: 0.0,
            gradient: vec![0.0; layout.len()],
            matrix: Blocks::new(p, layout.stored_views()),
        };
        for (view, local) in self.views.iter().zip(&locals) {
            sum.cost += local.cost;
            add_view(layout, &view.place, local, &mut sum);
        }
        self.for_each_difference(|row| {
            let r: f64 = row.iter().map(|&(i, factor)| factor * x[i]).sum();
            sum.cost += r * r;
            row.iter().for_each(|&(i, factor)| sum.gradient[i] += factor * r);
            sum.matrix.add_row(row.to_vec());
        });
        sum
    }

    fn linearize_view(&self, view: &Data, x: &[f64]) -> Local {
        let layout = &self.layout;
        let (p, k) = (layout.stride(), layout.lobes);
        let mut q = vec![0.0; p];
        layout.interpolate(x, &view.place, &mut q);
        let lobes = Lobes::new(layout, &q);
        let amplitude = amplitudes(layout, &q);

        // Columns: of each lobe two tilts, sharpness and value; the diffuse term; per channel three of the squeeze, which
        // all squeezed lobes share with their amplitudes. All but the last nine are the same for every channel.
        let (shared, width) = (4 * k + 1, 4 * k + 10);
        let mut gram = vec![0.0; width * width];
        let mut moment = vec![[0.0; 3]; width];
        // Four points at a time, so that the sums are loaded and stored once for four products.
        let mut basis = [(); 4].map(|()| vec![0.0; width]);
        let mut slopes = vec![Slopes::default(); k];
        let mut cost = 0.0;
        for points in view.points.chunks(4) {
            basis.iter_mut().skip(points.len()).for_each(|b| b.fill(0.0));
            for (point, basis) in points.iter().zip(&mut basis) {
                lobes.slopes(&point.direction, &mut slopes);
                let root = libm::sqrt(point.weight);
                fill(layout, &amplitude, &slopes, root, basis);
                basis[4 * k] = root * point.direction[2] * FRAC_1_PI;
                let mut residual = [0.0; 3];
                for c in 0..3 {
                    let value: f64 = amplitude[c].iter().zip(&basis[3 * k..]).map(|(a, u)| a * u).sum();
                    residual[c] = value - root * point.target[c];
                    cost += residual[c] * residual[c];
                }
                for (m, b) in moment.iter_mut().zip(basis.iter()) {
                    (0..3).for_each(|c| m[c] += b * residual[c]);
                }
            }
            let [p0, p1, p2, p3] = &basis;
            for i in 0..width {
                let (a0, a1, a2, a3) = (p0[i], p1[i], p2[i], p3[i]);
                let sums = gram[i * width..=i * width + i].iter_mut();
                for (g, (((b0, b1), b2), b3)) in sums.zip(p0.iter().zip(p1).zip(p2).zip(p3)) {
                    *g += (a0 * b0 + a1 * b1) + (a2 * b2 + a3 * b3);
                }
            }
        }

        // From columns to unknowns, channel by channel.
        let mut local = Local { cost, gradient: vec![0.0; p], matrix: vec![0.0; p * p] };
        for c in 0..3 {
            // A column, the unknown that it belongs to, and the factor on it.
            let mut columns: Vec<(usize, usize, f64)> = Vec::with_capacity(6 * k + 6);
            for (n, &own) in amplitude[c].iter().enumerate().take(k) {
                columns.push((n, layout.along(n), own));
                columns.push((k + n, layout.across(n), own));
                columns.push((2 * k + n, layout.sharpness(n), own));
            }
            for (n, &own) in amplitude[c].iter().enumerate() {
                let [luminance, red, blue] = layout.tint(n);
                let y = libm::exp(q[luminance]);
                columns.push((3 * k + n, luminance, own));
                columns.push((3 * k + n, red, y * COLOR_SLOPES[0][c]));
                columns.push((3 * k + n, blue, y * COLOR_SLOPES[1][c]));
            }
            columns.extend((0..3).map(|i| (shared + 3 * c + i, i, 1.0)));
            columns.retain(|column| column.2 != 0.0);
            for (n, &(i, a, factor_a)) in columns.iter().enumerate() {
                local.gradient[a] += factor_a * moment[i][c];
                for &(j, b, factor_b) in &columns[..=n] {
                    let value = factor_a * factor_b * gram[i.max(j) * width + i.min(j)];
                    local.matrix[a * p + b] += value;
                    if a != b {
                        local.matrix[b * p + a] += value;
                    }
                }
            }
        }
        let albedo = layout.albedo(&q);
        for (c, row) in self.energy_residuals(albedo, view.albedo).into_iter().enumerate() {
            self.add_albedo_row(&mut local, &q, c, row);
        }
        local
    }

    /// Adds the square of a residual of one channel's albedo to a view.
    fn add_albedo_row(
        &self,
        local: &mut Local,
        q: &[f64],
        channel: usize,
        (residual, by_albedo): (f64, f64),
    ) {
        let layout = &self.layout;
        let p = layout.stride();
        let mut row = Vec::with_capacity(4 * layout.lobes + 3);
        for k in 0..=layout.lobes {
            let [luminance, red, blue] = layout.tint(k);
            let color = by_albedo * rgb([luminance, red, blue].map(|i| q[i]))[channel];
            let mut integral = 1.0;
            if k < layout.lobes {
                let slope;
                (integral, slope) = sphere_integral(q[layout.sharpness(k)]);
                row.push((layout.sharpness(k), color * slope));
            }
            let y = by_albedo * libm::exp(q[luminance]) * integral;
            row.push((luminance, color * integral));
            row.push((red, y * COLOR_SLOPES[0][channel]));
            row.push((blue, y * COLOR_SLOPES[1][channel]));
        }
        local.cost += residual * residual;
        for &(i, a) in &row {
            local.gradient[i] += a * residual;
            row.iter().for_each(|&(j, b)| local.matrix[i * p + j] += a * b);
        }
    }

    /// Residuals of the channels of an albedo, and their derivatives by it.
    fn energy_residuals(&self, fitted: [f64; 3], data: [f64; 3]) -> [(f64, f64); 3] {
        let weight = libm::sqrt(ENERGY / (3.0 * self.views.len() as f64));
        let (errors, slopes) = (self.energy.errors(fitted, data), self.energy.slopes(data));
        [0, 1, 2].map(|c| (weight * errors[c], weight * slopes[c]))
    }

    /// Calls with the terms (unknown, factor) of each residual of the roughness.
    fn for_each_difference(&self, mut each: impl FnMut(&[(usize, f64)])) {
        let layout = &self.layout;
        let (p, last) = (layout.stride(), layout.thetas.len() - 1);
        let scale = libm::sqrt(self.smoothness / layout.len() as f64);
        // The normal turned into the frame of an azimuth, as a combination of its unknowns.
        let mut turned = vec![vec![]; p];
        for azimuth in 0..layout.azimuths {
            let (_, phi) = layout.angles(layout.stored_view(1.min(last), azimuth));
            let (sin, cos) = libm::sincos(phi + std::f64::consts::PI);
            for (i, row) in turned.iter_mut().enumerate() {
                let mut unit = vec![0.0; p];
                unit[i] = 1.0;
                layout.turn_transposed(&mut unit, [cos, sin]);
                *row = unit.iter().copied().enumerate().filter(|t| t.1 != 0.0).collect();
            }
            let terms = |ring: usize, index: usize, factor: f64, out: &mut Vec<(usize, f64)>| {
                if ring == 0 {
                    out.extend(turned[index].iter().map(|(j, share)| (*j, factor * share)));
                } else {
                    out.push((layout.stored_view(ring, azimuth) * p + index, factor));
                }
            };
            for index in 0..p {
                let weight = scale / layout.unit(index);
                for ring in 1..=last {
                    let mut row = Vec::new();
                    if ring < last {
                        terms(ring - 1, index, weight, &mut row);
                        terms(ring, index, -2.0 * weight, &mut row);
                        terms(ring + 1, index, weight, &mut row);
                        each(&row);
                        row.clear();
                    }
                    if layout.azimuths > 2 {
                        let weight = weight * libm::sin(layout.thetas[ring]);
                        let others =
                            [(azimuth + layout.azimuths - 1, 1.0), (azimuth, -2.0), (azimuth + 1, 1.0)];
                        row.extend(
                            others.map(|(a, f)| (layout.stored_view(ring, a) * p + index, f * weight)),
                        );
                        each(&row);
                    }
                }
            }
        }
    }
}

/// Fills in the derivatives of the lobes at one point, column by column; the columns are described where they are summed.
fn fill(layout: &Layout, amplitude: &[Vec<f64>; 3], slopes: &[Slopes], root: f64, basis: &mut [f64]) {
    let k = layout.lobes;
    let shared = 4 * k + 1;
    basis[shared..].fill(0.0);
    for (n, s) in slopes.iter().enumerate() {
        basis[n] = root * s.by_tilt[0];
        basis[k + n] = root * s.by_tilt[1];
        basis[2 * k + n] = root * s.by_ln_sharpness;
        basis[3 * k + n] = root * s.value;
        if n < layout.squeezed {
            for (c, a) in amplitude.iter().enumerate() {
                (0..3).for_each(|i| basis[shared + 3 * c + i] += root * a[n] * s.by_squeeze[i]);
            }
        }
    }
}

/// Adds the linearisation in a view to that of the whole, by the chain rule of the interpolation.
fn add_view(layout: &Layout, place: &CellPlace, local: &Local, sum: &mut Linearized) {
    let p = layout.stride();
    // By the unknowns of the normal, where it is one of the corners: turned gradient, H R, R^T H R.
    let is_turned = place.corners.iter().any(|c| c.0 == 0 && c.1 > 0.0);
    let (mut half, mut both) = (Vec::new(), Vec::new());
    if is_turned {
        half.clone_from(&local.matrix);
        half.chunks_exact_mut(p).for_each(|row| layout.turn_transposed(row, place.azimuth));
        both = vec![0.0; p * p];
        let mut column = vec![0.0; p];
        for j in 0..p {
            (0..p).for_each(|i| column[i] = half[i * p + j]);
            layout.turn_transposed(&mut column, place.azimuth);
            (0..p).for_each(|i| both[i * p + j] = column[i]);
        }
    }
    // Two corners are one stored view in a ring of one.
    let mut corners: Vec<(usize, f64)> = Vec::new();
    for &(stored, share) in place.corners.iter().filter(|c| c.1 > 0.0) {
        match corners.iter_mut().find(|c| c.0 == stored) {
            Some(corner) => corner.1 += share,
            None => corners.push((stored, share)),
        }
    }
    for (n, &(a, share_a)) in corners.iter().enumerate() {
        let mut gradient = local.gradient.clone();
        if a == 0 {
            layout.turn_transposed(&mut gradient, place.azimuth);
        }
        let to = &mut sum.gradient[a * p..(a + 1) * p];
        to.iter_mut().zip(&gradient).for_each(|(t, g)| *t += share_a * g);
        for &(b, share_b) in &corners[..=n] {
            let (row, column) = (a.max(b), a.min(b));
            let from = match (row, column) {
                (0, 0) => &both,
                (_, 0) => &half,
                _ => &local.matrix,
            };
            let share = share_a * share_b;
            let block = sum.matrix.block(row, column);
            block.iter_mut().zip(from).for_each(|(b, v)| *b += share * v);
        }
    }
}

/// Amplitudes of the lobes and of the diffuse term, per channel.
pub(super) fn amplitudes(layout: &Layout, q: &[f64]) -> [Vec<f64>; 3] {
    let colors: Vec<[f64; 3]> = (0..=layout.lobes).map(|k| rgb(layout.tint(k).map(|i| q[i]))).collect();
    [0, 1, 2].map(|c| colors.iter().map(|color| color[c]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::Random;
    use crate::table::direction;

    fn problem(azimuths: usize, turns: usize) -> (Objective, Vec<f64>) {
        let mut random = Random::new(3);
        let layout = Layout { lobes: 3, squeezed: 2, thetas: vec![0.0, 0.6, 1.2], azimuths, turns };
        let mut views = vec![];
        for (theta, phi) in [(0.0, 0.0), (0.3, 1.0), (0.4, 5.0), (0.6, 2.0), (0.9, 3.0), (1.3, 0.4)] {
            let mut samples = vec![];
            for _ in 0..30 {
                let d = direction(1.5 * random.next(), 6.2 * random.next());
                let rgb = [0.1 + random.next(), random.next(), 0.3 * random.next()];
                samples.push(Sample { direction: d, rgb, weight: 0.2 });
            }
            views.push(View { theta, phi, samples, albedo: [0.5, 0.3, 0.1] });
        }
        let mut x: Vec<f64> = (0..layout.len()).map(|_| 1.4 * random.next() - 0.6).collect();
        for stored in 0..layout.stored_views() {
            (0..layout.stride())
                .filter(|i| layout.fixed(stored, *i))
                .for_each(|i| x[stored * layout.stride() + i] = 0.0);
        }
        (Objective::new(&views, layout, 0.5, 1).unwrap(), x)
    }

    #[test]
    fn gradient_and_cost_agree_with_differences() {
        for (azimuths, turns) in [(4, 1), (3, 2), (1, 1)] {
            let (objective, x) = problem(azimuths, turns);
            let linearized = objective.linearize(&x);
            let cost = objective.cost(&x);
            assert!((linearized.cost - cost).abs() < 1e-12 * cost, "{} {cost}", linearized.cost);
            for i in 0..x.len() {
                let at = |h: f64| {
                    let mut x = x.clone();
                    x[i] += h;
                    objective.cost(&x)
                };
                let h = 1e-5;
                // `gradient` is that of half the cost.
                let difference = (at(h) - at(-h)) / (4.0 * h);
                let g = linearized.gradient[i];
                assert!((difference - g).abs() < 1e-6 * (g.abs() + cost), "{azimuths} {i}: {difference} {g}");
            }
        }
    }

    #[test]
    fn the_matrix_is_the_second_derivative_where_the_data_are_met() {
        for (azimuths, turns) in [(4, 1), (3, 2), (1, 1)] {
            let (mut objective, x) = problem(azimuths, turns);
            objective.smoothness = 0.0;
            let layout = objective.layout.clone();
            for view in &mut objective.views {
                let mut q = vec![0.0; layout.stride()];
                layout.interpolate(&x, &view.place, &mut q);
                view.albedo = layout.albedo(&q);
                let (lobes, a) = (Lobes::new(&layout, &q), amplitudes(&layout, &q));
                for point in &mut view.points {
                    let mut unit = [0.0; 4];
                    lobes.values(&point.direction, &mut unit);
                    point.target = [0, 1, 2].map(|c| (0..4).map(|k| a[c][k] * unit[k]).sum());
                }
            }
            let linearized = objective.linearize(&x);
            let mut random = Random::new(5);
            for _ in 0..10 {
                let step: Vec<f64> = x.iter().map(|_| 1e-5 * (random.next() - 0.5)).collect();
                let moved: Vec<f64> = x.iter().zip(&step).map(|(x, s)| x + s).collect();
                let expected = objective.cost(&moved);
                let mut product = vec![0.0; x.len()];
                linearized.matrix.times(&step, &mut product);
                let quadratic: f64 = product.iter().zip(&step).map(|(p, s)| p * s).sum();
                assert!((expected - quadratic).abs() < 1e-3 * expected, "{azimuths}: {expected} {quadratic}");
            }
        }
    }
}
