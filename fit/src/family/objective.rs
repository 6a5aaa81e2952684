//! The objective of a fit, with gradient and Gauss-Newton matrix.
//!
//! A sum of squares over all views at once, of
//!
//! * *data*: `f cos` of the lobes, times factors if there are any, minus that of the table at every sample, relative to the view:
//!   the squared relative L2 error, plus the squared error away from the peak (`crate::judge::measure`), plus a share of the
//!   *tail*; the tail is the relative variance that the lobes alone would have as a density; there an error counts relative to the
//!   value at its direction;
//! * *energy*: the albedo minus the table's, relative to that, per channel;
//! * *ceiling*: what any channel's albedo exceeds `CEILING` by, at the views, at the stored views and between them;
//! * *roughness*: second differences of the unknowns from stored view to stored view, with the symmetry at the normal (angles are
//!   odd in theta, the rest even); and a weak pull towards no change in the last interval, which Cornell's data do not reach.
//!
//! A view sees only the two stored views round it, and roughness three in a row. So the matrix is a band two stored views wide.

pub(crate) mod data_term;
mod linearize;
pub(crate) mod solver;

use crate::FitError;
use crate::family::factors::{Demand, Factors};
use crate::family::layout::Layout;
use crate::family::lobes::Lobes;
use crate::isotropic::tuning::factors::{AVERAGED, ENERGY};
use crate::isotropic::tuning::parameters::LN_SHARPNESS_DEFENSIVE;
use crate::judge::energy::EnergyError;
use crate::judge::measure::{self, brightness};
use crate::numeric::special::sphere_integral;
use crate::table::{ALBEDO_LIMIT, Table, View, check_bright, check_storable, luminance};
use data_term::Point;
use rayon::prelude::*;

use crate::isotropic::tuning::objective::{
    ALBEDO_ERROR, CEILING, CEILING_WEIGHT, DEFENSIVE, DEFENSIVE_DIFFUSE, HOLD, MOST_ALBEDO, MOST_FACTOR,
    MOST_SHORT, SHORT, TAIL_FLOOR, WATCHED,
};
pub(crate) use solver::Weighted;

/// What counts beside the squared relative L2 error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Emphasis {
    /// Weight of the relative variance.
    pub tail: f64,
    /// Weight of errors away from the peak, over that in the measure (`crate::judge::measure`).
    pub measure: f64,
    /// Weight of the albedo in the last stages.
    pub energy: f64,
}

/// Weights that change in the course of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weights {
    /// Of the roughness.
    pub smoothness: f64,
    /// Of the squared relative error of the albedo beside the squared relative L2 error.
    pub energy: f64,
    /// Damping of a colour, over the cost: else faint lobes would change theirs by large steps, which shorten all others.
    pub faint_color: f64,
}

/// One view as the fit sees it.
#[derive(Clone)]
pub(crate) struct Data {
    pub place: (usize, f64),
    pub points: Vec<Point>,
    albedo: [f64; 3],
    /// Solid angle of a sample over its weight in the squared relative L2 error.
    solid_angle: f64,
    /// Means of the factors that the lobes and the diffuse term see, if there are any.
    factors: Option<Vec<[f64; 3]>>,
    /// Factors of the weights of its errors.
    energy: [f64; 3],
}

/// The sum of squares over a table, for a layout.
#[derive(Clone)]
pub(crate) struct Objective {
    pub layout: Layout,
    pub views: Vec<Data>,
    watched: Vec<(usize, f64)>,
    /// Least logarithm of the luminance of the defensive lobe, by stored view.
    ln_defensive: Vec<f64>,
    energy: EnergyError,
    factors: Option<Factors>,
}

impl Objective {
    /// `factors`: the table that multiplies the lobes.
    pub fn new(
        table: &Table,
        layout: Layout,
        emphasis: Emphasis,
        factors: Option<&Factors>,
    ) -> Result<Self, FitError> {
        let brightest = table.views.iter().flat_map(|v| v.albedo).fold(0.0, f64::max);
        let count = table.views.len() as f64;
        let strongest = table.views.iter().map(norm_squared).fold(0.0, f64::max);
        check_storable(table.views.iter().flat_map(|view| &view.samples))?;
        check_bright(strongest > 0.0 && strongest.is_finite())?;
        let data = |view: &View| {
            let norm = norm_squared(view).max(1e-9 * strongest);
            let bright = |s: &crate::table::Sample| brightness(s.rgb) * s.direction[2];
            let energy: f64 = view.samples.iter().map(|s| s.weight * bright(s)).sum();
            let solid: f64 = view.samples.iter().map(|s| s.weight).sum();
            let mean = (energy / solid).max(1e-9 * brightest);
            let (sin, cos) = libm::sincos(view.theta);
            let level = measure::level(view.albedo).max(1e-9 * brightest);
            let points = view.samples.iter().map(|s| {
                let mut point = Point {
                    direction: s.direction,
                    target: s.rgb.map(|v| v * s.direction[2]),
                    factor: factors.map_or([1.0; 3], |f| f.at(s.direction, [-sin, 0.0, cos])),
                    aim: [0.0; 3],
                    weight: [0.0; 3],
                    rest: 0.0,
                    value: 0.0,
                    base: s.weight / norm / count,
                    measure: emphasis.measure * s.weight / count
                        * measure::weight(brightness(s.rgb), level, s.direction[2])
                        * measure::beside_highlight(s.direction, view.theta),
                    measure_floor: measure::floor(level) * s.direction[2],
                    tail: emphasis.tail * s.weight / (mean * solid) / 3.0 / count,
                    floor: TAIL_FLOOR * mean * 2.0 * s.direction[2],
                };
                point.weigh(point.base + point.measure, point.tail / (bright(s) + point.floor));
                point
            });
            Data {
                place: layout.place(view.theta),
                points: points.collect(),
                albedo: view.albedo,
                solid_angle: norm * count,
                factors: None,
                energy: [1.0; 3],
            }
        };
        let views = table.views.iter().map(data).collect();
        let albedo = |theta: f64| {
            let far = |v: &&View| (v.theta - theta).abs();
            table.views.iter().min_by(|a, b| far(a).total_cmp(&far(b))).map_or([0.0; 3], |v| v.albedo)
        };
        let ln_defensive = layout.view_angles.iter().map(|&theta| {
            let albedo = albedo(theta);
            // A share of the largest albedo that a fit may have, because the table's own may be any number.
            let share = DEFENSIVE * luminance(albedo).max(1e-9 * brightest).min(ALBEDO_LIMIT);
            libm::log(share / sphere_integral(LN_SHARPNESS_DEFENSIVE.1).0)
        });
        let ln_defensive = ln_defensive.collect();
        let last = layout.view_angles.len() - 1;
        let between = |stored: usize| (0..WATCHED).map(move |i| (stored, i as f64 / WATCHED as f64));
        let mut watched: Vec<(usize, f64)> = (0..last).flat_map(between).collect();
        watched.push((last - usize::from(last > 0), if last > 0 { 1.0 } else { 0.0 }));
        Ok(Self {
            layout,
            views,
            watched,
            ln_defensive,
            energy: EnergyError::new(table.views.iter().map(|v| v.albedo)),
            factors: factors.cloned(),
        })
    }

    /// Least and greatest value of an unknown, at its stored view.
    pub fn bounds(&self, unknown: usize) -> (f64, f64) {
        let (stored, index) = (unknown / self.layout.stride(), unknown % self.layout.stride());
        if self.layout.fixed(stored, index) {
            return (0.0, 0.0);
        }
        let (low, high) = self.layout.bounds(index);
        match self.layout.defensive() {
            Some(lobe) if index == self.layout.luminance(lobe) => (low.max(self.ln_defensive[stored]), high),
            None if index == self.layout.diffuse() => {
                let share = sphere_integral(LN_SHARPNESS_DEFENSIVE.1).0 * DEFENSIVE_DIFFUSE / DEFENSIVE;
                (low.max(self.ln_defensive[stored] + libm::log(share)), high)
            }
            _ => (low, high),
        }
    }

    /// The same with weights that follow the fit. Views count in inverse proportion to their error, so that the
    /// objective is the mean error, not the mean of its square. Away from the peak, differences of logarithms count. The
    /// tail counts as if the lobes' values were the table's where they are lower: there a renderer that samples the lobes gets its
    /// largest weights. Albedos count the more, the worse they are.
    pub fn reweighed(mut self, x: &[f64]) -> Self {
        let mut q = vec![0.0; self.layout.stride()];
        let mut views = std::mem::take(&mut self.views);
        let mut errors = Vec::with_capacity(views.len());
        let mut weights = Vec::with_capacity(views.len());
        for view in &mut views {
            self.layout.interpolate(x, view.place, &mut q);
            let (lobes, amplitudes) = (Lobes::new(&self.layout, &q), self.layout.amplitudes(&q));
            let mut square = 0.0;
            let values = data_term::values(&lobes, &amplitudes, &view.points);
            let terms = view.points.iter().zip(values).map(|(point, lobes)| {
                let value = [0, 1, 2].map(|c| lobes[c] * point.factor[c]);
                let distance: f64 = (0..3).map(|c| (value[c] - point.target[c]).powi(2)).sum();
                let bright = brightness(point.target);
                let secant = measure::secant(brightness(value), bright, point.measure_floor);
                square += (point.base + point.measure * secant) * distance;
                let short = bright / (SHORT * brightness(lobes)).max(1e-300);
                let short = (short * short).clamp(1.0, MOST_SHORT);
                let density = point.tail * short / (brightness(lobes).min(bright) + point.floor);
                (point.measure * secant, density)
            });
            weights.push(terms.collect::<Vec<_>>());
            errors.push(libm::sqrt(square));
            view.factors = self
                .factors
                .as_ref()
                .map(|f| f.means(&self.layout, &q, self.layout.theta(view.place), AVERAGED));
            let albedo = self.layout.albedo(&q, view.factors.as_deref());
            let off = self.energy.errors(albedo, view.albedo);
            view.energy = off.map(|e| (e / ALBEDO_ERROR).powi(2).clamp(1.0, MOST_ALBEDO));
        }
        let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        for ((view, error), weights) in views.iter_mut().zip(errors).zip(weights) {
            let factor = if error > 0.0 { (mean / error).clamp(1.0 / MOST_FACTOR, MOST_FACTOR) } else { 1.0 };
            for (point, (measure, density)) in view.points.iter_mut().zip(weights) {
                point.weigh(factor * (point.base + measure), density);
            }
        }
        self.views = views;
        self
    }

    /// What factors are to make of the lobes, at all samples.
    pub fn into_demands(mut self, x: &[f64]) -> Vec<Demand> {
        let views = std::mem::take(&mut self.views);
        let count = views.len() as f64;
        let demands = views.into_par_iter().enumerate().map(|(number, view)| {
            let slopes = self.energy.slopes(view.albedo);
            let by_albedo =
                [0, 1, 2].map(|c| libm::sqrt(ENERGY * view.energy[c] / (3.0 * count)) * slopes[c]);

            let mut q = vec![0.0; self.layout.stride()];
            self.layout.interpolate(x, view.place, &mut q);
            let values =
                data_term::values(&Lobes::new(&self.layout, &q), &self.layout.amplitudes(&q), &view.points);
            let (sin, cos) = libm::sincos(self.layout.theta(view.place));
            let demand = |(point, lobes): (&Point, [f64; 3])| Demand {
                wi: point.direction,
                wo: [-sin, 0.0, cos],
                lobes,
                target: point.target,
                weight: point.value,
                measure: point.measure,
                view: number,
                by_energy: by_albedo.map(|slope| slope * point.base * view.solid_angle),
            };
            view.points.iter().zip(values).map(demand).collect::<Vec<_>>()
        });
        demands.collect::<Vec<_>>().into_iter().flatten().collect()
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
                let amplitudes = layout.amplitudes(&q);
                let mut cost = data_term::cost(&lobes, &amplitudes, &view.points);
                let albedo = layout.albedo(&q, view.factors.as_deref());
                let residuals = self.energy_residuals(albedo, view, weights.energy);
                cost += residuals.iter().map(|r| r.0 * r.0).sum::<f64>();
                cost
            })
            .collect();
        let mut cost: f64 = parts.iter().sum();
        let mut q = vec![0.0; layout.stride()];
        for &place in &self.watched {
            layout.interpolate(x, place, &mut q);
            cost += layout.albedo(&q, None).iter().map(|a| self.excess(*a).powi(2)).sum::<f64>();
        }
        self.for_each_difference(weights.smoothness, |terms| {
            let r: f64 = terms.iter().map(|&(index, factor)| factor * x[index]).sum();
            cost += r * r;
        });
        cost
    }

    /// Residuals of the channels of an albedo, and their derivatives by it.
    fn energy_residuals(&self, fitted: [f64; 3], view: &Data, weight: f64) -> [(f64, f64); 3] {
        let (errors, slopes) = (self.energy.errors(fitted, view.albedo), self.energy.slopes(view.albedo));
        [0, 1, 2].map(|c| {
            let weight = libm::sqrt(view.energy[c] * weight / (3.0 * self.views.len() as f64));
            (weight * errors[c], weight * slopes[c])
        })
    }

    fn excess(&self, albedo: f64) -> f64 {
        libm::sqrt(CEILING_WEIGHT / self.watched.len() as f64) * (albedo - CEILING).max(0.0)
    }

    /// Calls with the terms (unknown, factor) of each residual of the roughness, unknowns rising.
    fn for_each_difference(&self, smoothness: f64, mut each: impl FnMut(&[(usize, f64)])) {
        let layout = &self.layout;
        let view_angles = &layout.view_angles;
        let (p, last) = (layout.stride(), view_angles.len() - 1);
        if last == 0 || smoothness == 0.0 {
            return;
        }
        let first = layout.first_smooth();
        let mean = view_angles[last] / last as f64;
        let per_interval: Vec<f64> = view_angles.windows(2).map(|w| mean / (w[1] - w[0])).collect();
        for index in 0..p {
            let weight = libm::sqrt(smoothness / ((last as f64) * p as f64)) / layout.unit(index);
            if !layout.angles().contains(&index) {
                let d = 2.0 * weight * per_interval[first];
                each(&[(first * p + index, -d), ((first + 1) * p + index, d)]);
            }
            for k in first + 1..last {
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
        x.chunks_mut(layout.stride()).for_each(|stored| stored[0] = -0.4);
        (Objective::new(&table, layout, Emphasis { tail: 0.03, measure: 1.0, energy: 1.0 }, None).unwrap(), x)
    }

    #[test]
    fn gradient_and_cost_agree_with_differences() {
        let (objective, x) = problem();
        let smoothness = Weights { smoothness: 0.1, energy: 2.0, faint_color: 0.0 };
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
            view.albedo = layout.albedo(&q, None);
            let (lobes, a) = (Lobes::new(&layout, &q), layout.amplitudes(&q));
            for point in &mut view.points {
                let mut unit = [0.0; 5];
                lobes.values(&point.direction, &mut unit);
                point.target = [0, 1, 2].map(|c| (0..5).map(|k| a[c][k] * unit[k]).sum());
                point.weigh(point.base, 0.0);
            }
        }
        let none = Weights { smoothness: 0.0, energy: 1.0, faint_color: 0.0 };
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
