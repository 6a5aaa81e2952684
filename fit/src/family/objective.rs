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
//! * *roughness*: differences of the unknowns from stored view to stored view (`Views::differences`).
//!
//! A view sees only the stored views round it, and roughness the next ones. So most of the matrix is 0.

pub(crate) mod data_term;
mod linearize;
pub(crate) mod solver;
#[cfg(test)]
mod tests;

use crate::FitError;
use crate::family::factors::{Demand, Factors};
use crate::family::layout::{Layout, Views};
use crate::family::lobes::Lobes;
use crate::family::tuning::factors::{AVERAGED, ENERGY};
use crate::family::tuning::objective::{
    ALBEDO_ERROR, CEILING, CEILING_WEIGHT, FALSELY_NEGATIVE, MOST_ALBEDO, MOST_FACTOR, MOST_GRAZING,
    MOST_SHORT, NEAR_ZERO, SHORT, TAIL_FLOOR,
};
use crate::judge::energy::EnergyError;
use crate::judge::measure::{self, brightness};
use crate::table::{Sample, View, check_bright, check_storable};
use data_term::{Panels, Point};
use rayon::prelude::*;
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
    /// Whether values towards grazing light were measured, and not completed from samples. Then errors there weigh more, and in fits with factors
    /// false signs anywhere.
    pub is_dense: bool,
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
pub(crate) struct Data<V: Views> {
    pub place: V::Place,
    pub points: Vec<Point>,
    /// The points as sums over them read them; made again wherever these change.
    pub panels: Panels,
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
pub(crate) struct Objective<V: Views> {
    pub layout: Layout<V>,
    pub views: Vec<Data<V>>,
    watched: Vec<V::Place>,
    /// Least and greatest value of each unknown.
    bounds: Vec<(f64, f64)>,
    energy: EnergyError,
    factors: Option<Factors>,
    is_dense: bool,
}

/// Largest difference of the channels of a grey sample, over the largest of them.
const GREY: f64 = 1e-6;

fn is_grey(sample: &Sample) -> bool {
    let [least, most] = [f64::min, f64::max].map(|of| sample.rgb.into_iter().reduce(of).unwrap_or_default());
    most - least <= GREY * most.abs().max(least.abs())
}

impl<V: Views> Objective<V> {
    /// Over views and where they lie. `factors`: the table that multiplies the lobes.
    pub fn over(
        table: &[(V::Place, &View)],
        layout: Layout<V>,
        emphasis: Emphasis,
        factors: Option<&Factors>,
    ) -> Result<Self, FitError> {
        let brightest = table.iter().flat_map(|(_, v)| v.albedo).fold(0.0, f64::max);
        let count = table.len() as f64;
        let strongest = table.iter().map(|(_, v)| norm_squared(v)).fold(0.0, f64::max);
        check_storable(table.iter().flat_map(|(_, view)| &view.samples))?;
        check_bright(strongest > 0.0 && strongest.is_finite())?;
        let more = |cos: f64| if emphasis.is_dense { grazing(cos) } else { 1.0 };
        let data = |&(place, view): &(V::Place, &View)| {
            let norm = norm_squared(view).max(1e-9 * strongest);
            let bright = |s: &Sample| brightness(s.rgb) * s.direction[2];
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
                    by_sign: [1.0; 3],
                    measure: emphasis.measure * more(s.direction[2]) * s.weight / count
                        * measure::weight(brightness(s.rgb), level, s.direction[2])
                        * measure::beside_highlight(s.direction, view.theta),
                    measure_floor: measure::floor(level) * s.direction[2],
                    tail: emphasis.tail * s.weight / (mean * solid) / 3.0 / count,
                    floor: TAIL_FLOOR * mean * V::tail_floor(s.direction[2]),
                };
                point.weigh(point.base + point.measure, point.tail / (bright(s) + point.floor));
                point
            });
            let points: Vec<Point> = points.collect();
            Data {
                place,
                panels: Panels::new(&points),
                points,
                albedo: view.albedo,
                solid_angle: norm * count,
                factors: None,
                energy: [1.0; 3],
            }
        };
        let views = table.iter().map(data).collect();
        let p = layout.stride();
        // Of one wavelength, say: rounding would grow to colours where a fit hardly feels them.
        let is_grey = table.iter().flat_map(|(_, view)| &view.samples).all(is_grey);
        let bounds = |unknown: usize| {
            let (stored, index) = (unknown / p, unknown % p);
            let is_fixed = V::fixed(&layout, stored, index) || is_grey && layout.is_color(index);
            if is_fixed { (0.0, 0.0) } else { layout.bounds(index) }
        };
        let mut bounds: Vec<(f64, f64)> = (0..layout.len()).map(bounds).collect();
        V::narrow(&layout, table, &mut bounds);
        Ok(Self {
            watched: layout.views.watched(),
            layout,
            views,
            bounds,
            energy: EnergyError::new(table.iter().map(|(_, v)| v.albedo)),
            factors: factors.cloned(),
            is_dense: emphasis.is_dense,
        })
    }

    /// One sample of each view for `every` of them, with the weight of all.
    pub fn thinned(mut self, every: usize) -> Self {
        for view in &mut self.views {
            view.points = view.points.iter().step_by(every).cloned().collect();
            for point in &mut view.points {
                point.weight = point.weight.map(|weight| every as f64 * weight);
                point.rest *= every as f64;
            }
            view.panels = Panels::new(&view.points);
        }
        self
    }

    /// The same with weights that follow the fit. Views count in inverse proportion to their error, so that the
    /// objective is the mean error, not the mean of its square. Away from the peak, differences of logarithms count. The
    /// tail counts as if the lobes' values were the table's where they are lower: there a renderer that samples the lobes gets its
    /// largest weights. Albedos count the more, the worse they are.
    pub fn reweighed(mut self, x: &[f64]) -> Self {
        let is_signed = self.is_dense && self.factors.is_some();
        let mut q = vec![0.0; self.layout.stride()];
        let mut views = std::mem::take(&mut self.views);
        let mut errors = Vec::with_capacity(views.len());
        let mut weights = Vec::with_capacity(views.len());
        for view in &mut views {
            self.layout.interpolate(x, view.place, &mut q);
            let (lobes, amplitudes) = (Lobes::new(&self.layout, &q), self.layout.amplitudes(&q));
            let mut square = 0.0;
            let values = data_term::values(&lobes, &amplitudes, &view.panels);
            let terms = view.points.iter().zip(values).map(|(point, lobes)| {
                let value = [0, 1, 2].map(|c| lobes[c] * point.factor[c]);
                let distance: f64 = (0..3).map(|c| (value[c] - point.target[c]).powi(2)).sum();
                let bright = brightness(point.target);
                let secant = measure::secant(brightness(value), bright, point.measure_floor);
                square += (point.base + point.measure * secant) * distance;
                let short = bright / (SHORT * brightness(lobes)).max(1e-300);
                let short = (short * short).clamp(1.0, MOST_SHORT);
                let density = point.tail * short / (brightness(lobes).min(bright) + point.floor);
                let by_sign =
                    [0, 1, 2].map(|c| if is_signed { by_sign(value[c], point.target[c]) } else { 1.0 });
                (point.measure * secant, density, by_sign)
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
            for (point, (measure, density, by_sign)) in view.points.iter_mut().zip(weights) {
                point.by_sign = by_sign;
                point.weigh(factor * (point.base + measure), density);
            }
            view.panels = Panels::new(&view.points);
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
                data_term::values(&Lobes::new(&self.layout, &q), &self.layout.amplitudes(&q), &view.panels);
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
                let mut cost = data_term::cost(&lobes, &amplitudes, &view.panels);
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
        V::differences(layout, weights.smoothness, |terms| {
            let r: f64 = terms.iter().map(|&(index, factor)| factor * x[index]).sum();
            cost += r * r;
        });
        cost
    }

    /// Residuals of the channels of an albedo, and their derivatives by it.
    fn energy_residuals(&self, fitted: [f64; 3], view: &Data<V>, weight: f64) -> [(f64, f64); 3] {
        let (errors, slopes) = (self.energy.errors(fitted, view.albedo), self.energy.slopes(view.albedo));
        [0, 1, 2].map(|c| {
            let weight = libm::sqrt(view.energy[c] * weight / (3.0 * self.views.len() as f64));
            (weight * errors[c], weight * slopes[c])
        })
    }

    fn excess(&self, albedo: f64) -> f64 {
        libm::sqrt(CEILING_WEIGHT / self.watched.len() as f64) * (albedo - CEILING).max(0.0)
    }
}

/// Factor on the weight of a channel whose value has another sign than that of the table, or nearly so: a fit that is below 0 beside a
/// bright highlight costs little, and shows as a ring of another colour.
fn by_sign(value: f64, target: f64) -> f64 {
    if target <= 0.0 {
        return 1.0;
    }
    let share = (NEAR_ZERO - value / target) / (2.0 * NEAR_ZERO);
    1.0 + (FALSELY_NEGATIVE - 1.0) * share.clamp(0.0, 1.0)
}

/// Factor on the weight of errors away from the peak towards grazing light. The measure counts them by the projected solid angle; a ball under
/// a sun behind it is lit by them alone.
fn grazing(cos: f64) -> f64 {
    libm::sqrt(0.5 / cos.max(1e-3)).clamp(1.0, MOST_GRAZING)
}

/// Squared norm of `f cos` over a view.
fn norm_squared(view: &View) -> f64 {
    let square = |s: &Sample| s.rgb.iter().map(|v| v * v).sum::<f64>() * s.direction[2] * s.direction[2];
    view.samples.iter().map(|s| s.weight * square(s)).sum()
}
