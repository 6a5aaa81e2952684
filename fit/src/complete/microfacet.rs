//! The model that a completion starts from: a diffuse term and one microfacet lobe.
//!
//! `d + D(h) G(wi, wo) (f0 + (f90 - f0) (1 - cos d)^5) / (4 cos_i cos_o)` with the distribution of normals of Burley's generalised
//! Trowbridge and Reitz (2012, "Physically Based Shading at Disney"), Smith's height-correlated shadowing of GGX with its width, and
//! Schlick's approximation with a free colour at grazing angles.

use super::measurement::Measurement;
use super::pair::Pair;
use super::scale::Scale;
use crate::numeric::cholesky::Square;
use crate::numeric::levenberg::{LeastSquares, Limits, Linear, minimize};

/// The unknowns, logarithms all: diffuse term, width, exponent less 1, reflectance along the normal and at grazing angles.
pub(super) const UNKNOWNS: usize = 11;
const WIDTH: usize = 3;
const EXPONENT: usize = 4;
const NORMAL: usize = 5;
const GRAZING: usize = 8;

/// Least and greatest of the width and of the exponent less 1.
const WIDTHS: (f64, f64) = (0.002, 1.2);
const EXPONENTS: (f64, f64) = (0.05, 6.0);

/// Greatest logarithm of a reflectance, and of diffuse radiance; least of both.
const MOST: (f64, f64) = (3.0, 2.0);
const LEAST: f64 = -25.0;

/// Least cosine that is divided by.
const HORIZON: f64 = 1e-3;

/// Weight of squared differences of logarithms beside that of the relative squared ones.
const BY_LOGARITHM: f64 = 0.09;

/// What is likely of reflectances: that at grazing angles over that along the normal is this, give or take the logarithm's deviation
/// (dielectrics have 25, metals 1 to 2), and the channels have about the same. Weight of both beside the squares of the first fit.
const RISE: f64 = 12.0;
const DEVIATION: f64 = 0.5;
const OF_CHANNELS: f64 = 0.4;
const LIKELY: f64 = 1e-3;

/// Steps of the fit, and change of an unknown that derivatives are taken over.
const LIMITS: Limits = Limits { steps: 60, improvement: 1e-4 };
const REFINED: Limits = Limits { steps: 25, improvement: 1e-4 };
const CHANGE: f64 = 1e-5;

/// A diffuse term and a microfacet lobe.
#[derive(Clone, Copy, Debug)]
pub(super) struct Microfacet {
    unknowns: [f64; UNKNOWNS],
    values: Values,
}

impl From<[f64; UNKNOWNS]> for Microfacet {
    fn from(unknowns: [f64; UNKNOWNS]) -> Self {
        Self { unknowns, values: Values::new(&unknowns) }
    }
}

impl Microfacet {
    /// No more than diffuse.
    pub fn diffuse(radiance: [f64; 3]) -> Self {
        let mut unknowns = [LEAST; UNKNOWNS];
        (0..3).for_each(|c| unknowns[c] = libm::log(radiance[c].max(1e-10)).clamp(LEAST, MOST.1));
        unknowns[WIDTH] = libm::log(0.1);
        unknowns.into()
    }

    /// Fitted to samples from a width on; with what is left of the squares.
    pub fn fit(measurement: &Measurement, scale: Scale, width: f64) -> (f64, Self) {
        let mut unknowns = Self::diffuse(measurement.dark).unknowns;
        unknowns[WIDTH] = libm::log(width);
        unknowns[EXPONENT] = 0.0;
        unknowns[NORMAL..GRAZING].fill(libm::log(0.05));
        unknowns[GRAZING..].fill(0.0);
        let mut x = unknowns.to_vec();
        let (cost, _) = minimize(&Fit::new(measurement, scale), &mut x, LIMITS, || {});
        unknowns.copy_from_slice(&x);
        (cost, unknowns.into())
    }

    /// Moved to where what is left of the logarithms is likeliest, if it is a process whose matrix has that factor: the model says what
    /// is sharp, the process what is smooth.
    pub fn refined(&self, measurement: &Measurement, scale: Scale, factor: &Square) -> Self {
        let mut x = self.unknowns.to_vec();
        let fit = Fit { factor: Some(factor), ..Fit::new(measurement, scale) };
        minimize(&fit, &mut x, REFINED, || {});
        let mut unknowns = self.unknowns;
        unknowns.copy_from_slice(&x);
        unknowns.into()
    }

    /// Width of the lobe: the tangent of the angle of facets at which they have become few.
    pub fn width(&self) -> f64 {
        self.values.width
    }

    /// Exponent with which facets become fewer; 2 is GGX.
    pub fn exponent(&self) -> f64 {
        self.values.exponent
    }

    /// f; 1/sr.
    pub fn value(&self, pair: &Pair) -> [f64; 3] {
        self.values.at(pair)
    }
}

/// The unknowns as the formula has them.
#[derive(Clone, Copy, Debug)]
struct Values {
    diffuse: [f64; 3],
    width: f64,
    exponent: f64,
    normal: [f64; 3],
    grazing: [f64; 3],
}

impl Values {
    fn new(x: &[f64]) -> Self {
        let three = |at: usize| [0, 1, 2].map(|c| libm::exp(x[at + c]));
        Self {
            diffuse: three(0),
            width: libm::exp(x[WIDTH]),
            exponent: 1.0 + libm::exp(x[EXPONENT]),
            normal: three(NORMAL),
            grazing: three(GRAZING),
        }
    }

    fn at(&self, pair: &Pair) -> [f64; 3] {
        let [ci, co] = pair.cosines.map(|c| c.max(HORIZON));
        let squared = pair.cos_half.max(HORIZON).powi(2);
        let facets =
            libm::exp(-self.exponent * libm::log1p(pair.sin2_half / (squared * self.width * self.width)));
        let hidden = |c: f64| {
            let tangent = self.width * self.width * (1.0 - c * c).max(0.0) / (c * c);
            0.5 * (libm::sqrt(1.0 + tangent) - 1.0)
        };
        let seen = 1.0 / (1.0 + hidden(ci) + hidden(co));
        let lobe = facets / (squared * squared) * seen / (4.0 * ci * co);
        let schlick = (1.0 - pair.cos_difference).powi(5);
        [0, 1, 2]
            .map(|c| self.diffuse[c] + lobe * (self.normal[c] + (self.grazing[c] - self.normal[c]) * schlick))
    }
}

/// The fit: the relative L2 error of every view, and differences of logarithms.
struct Fit<'a> {
    measurement: &'a Measurement,
    scale: Scale,
    /// The data on the logarithmic scale.
    logarithms: Vec<[f64; 3]>,
    /// Factor of the matrix by which differences go together, if they do.
    factor: Option<&'a Square>,
}

impl<'a> Fit<'a> {
    fn new(measurement: &'a Measurement, scale: Scale) -> Self {
        let logarithms = measurement.samples.iter().map(|s| s.rgb.map(|v| scale.to(v))).collect();
        Self { measurement, scale, logarithms, factor: None }
    }

    /// Weighted differences.
    fn differences(&self, x: &[f64]) -> Vec<f64> {
        let values = Values::new(x);
        if let Some(factor) = self.factor {
            let said: Vec<[f64; 3]> = self.measurement.samples.iter().map(|s| values.at(&s.pair)).collect();
            let channel = |c: usize| {
                let left = said.iter().zip(&self.logarithms).map(|(v, l)| self.scale.to(v[c]) - l[c]);
                factor.solve_lower(&left.collect::<Vec<f64>>())
            };
            return (0..3).flat_map(channel).chain(unlikely(x, 1.0)).collect();
        }
        let mut out = Vec::with_capacity(6 * self.logarithms.len());
        for (s, logarithms) in self.measurement.samples.iter().zip(&self.logarithms) {
            let value = values.at(&s.pair);
            let (relative, even) = (libm::sqrt(s.relative), libm::sqrt(BY_LOGARITHM * s.even));
            for c in 0..3 {
                out.push(relative * (value[c] - s.rgb[c]));
                out.push(even * (self.scale.to(value[c]) - logarithms[c]));
            }
        }
        out.extend(unlikely(x, LIKELY));
        out
    }
}

/// How far unknowns are from what is likely, in deviations, times the root of a weight.
fn unlikely(x: &[f64], weight: f64) -> impl Iterator<Item = f64> {
    let root = libm::sqrt(weight);
    let rise = |c: usize| (x[GRAZING + c] - x[NORMAL + c] - libm::log(RISE)) / DEVIATION;
    let apart = |at: usize, c: usize| (x[at + c] - (x[at] + x[at + 1] + x[at + 2]) / 3.0) / OF_CHANNELS;
    let all = [0, 1, 2].map(|c| [rise(c), apart(NORMAL, c), apart(GRAZING, c)]);
    all.into_iter().flatten().map(move |off| root * off)
}

struct At {
    cost: f64,
    gradient: Vec<f64>,
    gram: Vec<[f64; UNKNOWNS]>,
}

impl Linear for At {
    fn cost(&self) -> f64 {
        self.cost
    }
    fn gradient(&self) -> &[f64] {
        &self.gradient
    }
    fn scale(&self) -> Vec<f64> {
        (0..UNKNOWNS).map(|i| self.gram[i][i]).collect()
    }
    fn step(&self, added: &[f64], free: &[bool]) -> Option<Vec<f64>> {
        let mut matrix = Square::zeros(UNKNOWNS);
        for i in 0..UNKNOWNS {
            for j in 0..UNKNOWNS {
                matrix.row_mut(i)[j] = if i == j {
                    if free[i] { self.gram[i][i] + added[i] } else { 1.0 }
                } else if free[i] && free[j] {
                    self.gram[i][j]
                } else {
                    0.0
                };
            }
        }
        let right: Vec<f64> = (0..UNKNOWNS).map(|i| if free[i] { -self.gradient[i] } else { 0.0 }).collect();
        Some(matrix.cholesky()?.solve(&right))
    }
}

impl LeastSquares for Fit<'_> {
    const LONGEST_STEP: f64 = 1.0;
    type Linear = At;

    fn bounds(&self, unknown: usize) -> (f64, f64) {
        let log = |(low, high): (f64, f64)| (libm::log(low), libm::log(high));
        match unknown {
            WIDTH => log(WIDTHS),
            EXPONENT => log(EXPONENTS),
            _ if unknown < WIDTH => (LEAST, MOST.1),
            _ => (LEAST, MOST.0),
        }
    }

    fn cost(&self, x: &[f64]) -> f64 {
        self.differences(x).iter().map(|d| d * d).sum()
    }

    fn linearize(&self, x: &[f64]) -> At {
        let here = self.differences(x);
        let slope = |i: usize| {
            let mut moved = x.to_vec();
            moved[i] += CHANGE;
            let there = self.differences(&moved);
            there.iter().zip(&here).map(|(a, b)| (a - b) / CHANGE).collect::<Vec<f64>>()
        };
        let slopes: Vec<Vec<f64>> = (0..UNKNOWNS).map(slope).collect();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut gram = vec![[0.0; UNKNOWNS]; UNKNOWNS];
        for i in 0..UNKNOWNS {
            for j in 0..=i {
                gram[i][j] = product(&slopes[i], &slopes[j]);
                gram[j][i] = gram[i][j];
            }
        }
        let gradient = slopes.iter().map(|slope| product(slope, &here)).collect();
        At { cost: product(&here, &here), gradient, gram }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{Scattered, Table, direction};

    #[test]
    fn a_model_that_is_likely_is_found_again_from_its_samples() {
        let truth = Values {
            diffuse: [0.1, 0.05, 0.02],
            width: 0.12,
            exponent: 2.2,
            normal: [0.05; 3],
            grazing: [0.05 * RISE; 3],
        };
        let view = |theta: f64| -> (f64, Scattered) {
            let wo = [-libm::sin(theta), 0.0, libm::cos(theta)];
            let wi = (0..200).map(|i| direction(1.4 * (0.618 * f64::from(i)).fract(), 0.1 * f64::from(i)));
            (theta, wi.map(|wi| (wi, truth.at(&Pair::new(wi, wo)))).collect())
        };
        let table = Table::from_scattered([0.2, 0.6, 1.0, 1.3].map(view).to_vec()).unwrap();
        let measurement = Measurement::new(&table);
        let (_, found) = Microfacet::fit(&measurement, Scale::of(&measurement), 0.3);
        assert!((found.width() / truth.width - 1.0).abs() < 0.01, "{found:?}");
        assert!((found.exponent() / truth.exponent - 1.0).abs() < 0.02, "{found:?}");
    }
}
