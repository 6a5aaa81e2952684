//! The model that a completion starts from: a diffuse term, one microfacet lobe, and where samples ask for it a second lobe.
//!
//! `d + D(h) G(wi, wo) (f0 + (f90 - f0) (1 - cos d)^5) / (4 cos_i cos_o)`. D is the distribution of normals of Burley's generalised
//! Trowbridge and Reitz (2012, "Physically Based Shading at Disney"). G is Smith's height-correlated shadowing of GGX with its
//! width. The Fresnel term is Schlick's approximation with a free colour at grazing angles. A second lobe is a clear coat, or
//! about the back direction ([`Family`]).

mod fit;

use super::measurement::{Measured, Measurement};
use super::pair::{HORIZON, Pair};
use super::scale::Scale;
use crate::complete::tuning::microfacet::{
    COAT_RISE, LEAST, LEAST_HUE, LIMITS, MOST_DIFFUSE, REFINED, SECOND_START,
};
use crate::numeric::cholesky::Square;
use crate::numeric::levenberg::{Limits, minimize};
use fit::Fit;

/// The unknowns, logarithms all: diffuse term, width, exponent less 1, reflectance along the normal and at grazing angles; of the
/// second lobe width, exponent less 1, and a coat's two reflectances or three channels of a lobe about the back direction.
const UNKNOWNS: usize = 16;
const WIDTH: usize = 3;
const EXPONENT: usize = 4;
const NORMAL: usize = 5;
const GRAZING: usize = 8;
const SECOND_WIDTH: usize = 11;
const SECOND_EXPONENT: usize = 12;
const SECOND: usize = 13;

/// The part of a model beside a diffuse term and a lobe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Family {
    /// Nothing.
    #[default]
    OneLobe,
    /// A clear coat: a second microfacet lobe, without colour.
    Coat,
    /// A lobe about the back direction, `c (1 + |wi - wo|^2 / w^2)^-e` with a colour `c`.
    Retro,
}

impl Family {
    /// All of them, the simplest first.
    pub(super) const ALL: [Self; 3] = [Self::OneLobe, Self::Coat, Self::Retro];

    /// The parts of the model, in words.
    pub fn description(self) -> &'static str {
        match self {
            Self::OneLobe => "a diffuse term and a microfacet lobe",
            Self::Coat => "a diffuse term, a microfacet lobe and a clear coat",
            Self::Retro => "a diffuse term, a microfacet lobe and one about the back direction",
        }
    }

    /// One word.
    pub fn name(self) -> &'static str {
        match self {
            Self::OneLobe => "one lobe",
            Self::Coat => "coat",
            Self::Retro => "retro",
        }
    }

    /// Widths of both lobes that fits start from.
    fn starts(self) -> &'static [[f64; 2]] {
        match self {
            Self::OneLobe => &[[0.3, 0.1], [0.1, 0.1], [0.03, 0.1], [0.01, 0.1]],
            Self::Coat => &[[0.4, 0.03], [0.4, 0.008], [0.1, 0.008], [0.1, 0.003]],
            Self::Retro => &[[0.3, 0.2], [0.3, 0.05], [0.1, 0.05]],
        }
    }
}

/// A diffuse term and a microfacet lobe, or two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Microfacet {
    unknowns: [f64; UNKNOWNS],
    values: Values,
}

impl Microfacet {
    fn new(unknowns: [f64; UNKNOWNS], family: Family) -> Self {
        Self { unknowns, values: Values::new(&unknowns, family) }
    }

    /// Fitted to samples from each pair of widths of a family, each with the sum of squares; the best first.
    pub fn fits(measurement: &Measurement, scale: Scale, family: Family) -> Vec<(f64, Self)> {
        use rayon::prelude::*;
        let starts = family.starts().par_iter();
        let mut fits: Vec<(f64, Self)> =
            starts.map(|&widths| Self::fit(measurement, scale, family, widths)).collect();
        fits.sort_by(|a, b| a.0.total_cmp(&b.0));
        fits
    }

    fn fit(measurement: &Measurement, scale: Scale, family: Family, widths: [f64; 2]) -> (f64, Self) {
        let mut x = [LEAST; UNKNOWNS];
        (0..3).for_each(|c| x[c] = libm::log(measurement.dark[c].max(1e-10)).clamp(LEAST, MOST_DIFFUSE));
        x[WIDTH] = libm::log(widths[0]);
        x[EXPONENT] = 0.0;
        x[NORMAL..GRAZING].fill(libm::log(0.05));
        x[GRAZING..SECOND_WIDTH].fill(0.0);
        x[SECOND_WIDTH] = libm::log(widths[1]);
        x[SECOND_EXPONENT] = if family == Family::Retro { 1.0 } else { 0.0 };
        // As high as the sample that is nearest to its axis.
        let distance = |s: &Measured| {
            if family == Family::Coat { s.pair.lean2[1] } else { s.pair.sin2_difference }
        };
        let nearest = measurement.samples.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let start = nearest.map_or(0.0, |s| {
            let size = if family == Family::Coat { 4.0 * s.pair.cosines[0] * s.pair.cosines[1] } else { 1.0 };
            let height = size * s.value.iter().sum::<f64>() / 3.0;
            libm::log(height.max(SECOND_START.0)).min(SECOND_START.1)
        });
        match family {
            Family::OneLobe => {}
            Family::Coat => (x[SECOND], x[SECOND + 1]) = (start, start + libm::log(COAT_RISE)),
            Family::Retro => x[SECOND..].fill(start),
        }
        moved(&Fit::new(measurement, scale, family, None), x, LIMITS)
    }

    /// The same family, fitted from here to other samples.
    pub fn fitted_to(&self, measurement: &Measurement, scale: Scale) -> Self {
        self.moved_to(measurement, scale).1
    }

    /// The same, with the sum of squares.
    pub fn moved_to(&self, measurement: &Measurement, scale: Scale) -> (f64, Self) {
        moved(&Fit::new(measurement, scale, self.family(), None), self.unknowns, REFINED)
    }

    /// Moved to where the residual of the logarithms is likeliest, if it is a process whose matrix has that factor. The model has
    /// the sharp part, the process the smooth one.
    pub fn refined(&self, measurement: &Measurement, scale: Scale, factor: &Square) -> Self {
        moved(&Fit::new(measurement, scale, self.family(), Some(factor)), self.unknowns, REFINED).1
    }

    /// Its part beside a diffuse term and a lobe.
    pub fn family(&self) -> Family {
        self.values.family
    }

    /// Width of the lobe, of a coat if that is narrower: the tangent of the angle of facets at which they have become few.
    pub fn width(&self) -> f64 {
        let Values { width, second_width, family, .. } = self.values;
        if family == Family::Coat { width.min(second_width) } else { width }
    }

    /// Exponent with which facets become fewer; 2 is GGX.
    pub fn exponent(&self) -> f64 {
        self.values.exponent
    }

    /// Freedom of the channels from the model, 0 to 1: the share that is not of the coat.
    pub fn hue(&self, pair: &Pair) -> f64 {
        self.values.hue(pair)
    }

    /// f, XYZ over white; 1/sr.
    pub fn value(&self, pair: &Pair) -> [f64; 3] {
        self.values.at(pair)
    }
}

fn moved(fit: &Fit<'_>, mut unknowns: [f64; UNKNOWNS], limits: Limits) -> (f64, Microfacet) {
    let mut x = unknowns.to_vec();
    let (cost, _) = minimize(fit, &mut x, limits, || {});
    unknowns.copy_from_slice(&x);
    (cost, Microfacet::new(unknowns, fit.family))
}

/// The unknowns as the formula has them.
#[derive(Clone, Copy, Debug)]
struct Values {
    family: Family,
    diffuse: [f64; 3],
    width: f64,
    exponent: f64,
    normal: [f64; 3],
    grazing: [f64; 3],
    second_width: f64,
    second_exponent: f64,
    second: [f64; 3],
}

/// Unknowns that one channel depends on.
const OF_A_CHANNEL: usize = 9;

/// Which ones: diffuse term, width, exponent and reflectances, then those of the second lobe.
fn of_a_channel(channel: usize, family: Family) -> [usize; OF_A_CHANNEL] {
    let second = if family == Family::Retro { [SECOND + channel; 2] } else { [SECOND, SECOND + 1] };
    [
        channel,
        WIDTH,
        EXPONENT,
        NORMAL + channel,
        GRAZING + channel,
        SECOND_WIDTH,
        SECOND_EXPONENT,
        second[0],
        second[1],
    ]
}

/// How many facets there are at a half vector, and its derivatives by the logarithms of width and of the exponent less 1.
fn facets(distance: f64, exponent: f64) -> [f64; 3] {
    let spread = libm::log1p(distance);
    let value = libm::exp(-exponent * spread);
    [value, value * 2.0 * exponent * distance / (1.0 + distance), -value * (exponent - 1.0) * spread]
}

impl Values {
    fn new(x: &[f64], family: Family) -> Self {
        let three = |at: usize| [0, 1, 2].map(|c| libm::exp(x[at + c]));
        Self {
            family,
            diffuse: three(0),
            width: libm::exp(x[WIDTH]),
            exponent: 1.0 + libm::exp(x[EXPONENT]),
            normal: three(NORMAL),
            grazing: three(GRAZING),
            second_width: libm::exp(x[SECOND_WIDTH]),
            second_exponent: 1.0 + libm::exp(x[SECOND_EXPONENT]),
            second: three(SECOND),
        }
    }

    fn at(&self, pair: &Pair) -> [f64; 3] {
        self.with_slopes(pair).0
    }

    fn hue(&self, pair: &Pair) -> f64 {
        if self.family != Family::Coat {
            return 1.0;
        }
        let (values, slopes) = self.with_slopes(pair);
        // The derivative by a logarithm is the term itself.
        let of_coat = 3.0 * (slopes[0][OF_A_CHANNEL - 2] + slopes[0][OF_A_CHANNEL - 1]);
        1.0 - (1.0 - LEAST_HUE) * of_coat / values.iter().sum::<f64>().max(f64::MIN_POSITIVE)
    }

    /// The value, and of each channel the derivatives by its unknowns, in the order of [`of_a_channel`].
    #[inline(always)]
    fn with_slopes(&self, pair: &Pair) -> ([f64; 3], [[f64; OF_A_CHANNEL]; 3]) {
        let [ci, co] = pair.cosines.map(|c| c.max(HORIZON));
        let squared = pair.cos_half.max(HORIZON).powi(2);
        let [tangent2, of_second] = pair.lean2.map(|lean2| lean2 / squared);
        let schlick = (1.0 - pair.cos_difference).powi(5);
        let narrowing = 1.0 / (squared * squared * 4.0 * ci * co);

        // Hidden by other facets: Smith's function less 1, and its derivative by the logarithm of the width.
        let hidden = |c: f64, across2: f64| {
            let tangent = self.width * self.width * across2 / (c * c);
            let root = libm::sqrt(1.0 + tangent);
            (0.5 * (root - 1.0), 0.5 * tangent / root)
        };
        let (of_incident, of_outgoing) = (hidden(ci, pair.across2[0]), hidden(co, pair.across2[1]));
        let seen = 1.0 / (1.0 + of_incident.0 + of_outgoing.0);
        let [many, by_width, by_exponent] =
            facets(tangent2 / (self.width * self.width), self.exponent).map(|v| v * narrowing * seen);
        let by_width = by_width - many * seen * (of_incident.1 + of_outgoing.1);

        let second = match self.family {
            Family::OneLobe => [0.0; 3],
            Family::Coat => {
                let distance = of_second / (self.second_width * self.second_width);
                facets(distance, self.second_exponent).map(|v| v * narrowing)
            }
            Family::Retro => {
                let distance = 4.0 * pair.sin2_difference / (self.second_width * self.second_width);
                facets(distance, self.second_exponent)
            }
        };
        let channel = |c: usize| {
            let (along, grazing) = (self.normal[c] * (1.0 - schlick), self.grazing[c] * schlick);
            // Factors on the second lobe, in the two parts that are unknowns of their own.
            let parts = match self.family {
                Family::OneLobe => [0.0; 2],
                Family::Coat => [self.second[0] * (1.0 - schlick), self.second[1] * schlick],
                Family::Retro => [self.second[c], 0.0],
            };
            let (of_first, of_second) = (along + grazing, parts[0] + parts[1]);
            let slopes = [
                self.diffuse[c],
                by_width * of_first,
                by_exponent * of_first,
                many * along,
                many * grazing,
                second[1] * of_second,
                second[2] * of_second,
                second[0] * parts[0],
                second[0] * parts[1],
            ];
            (self.diffuse[c] + many * of_first + second[0] * of_second, slopes)
        };
        let [x, y, z] = [channel(0), channel(1), channel(2)];
        ([x.0, y.0, z.0], [x.1, y.1, z.1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::complete::color::rgb;
    use crate::table::{Scattered, Table, direction};

    fn truth(family: Family) -> Values {
        Values {
            family,
            diffuse: [0.1, 0.05, 0.02],
            width: 0.12,
            exponent: 2.2,
            normal: [0.05; 3],
            grazing: [0.6; 3],
            second_width: 0.02,
            second_exponent: 1.8,
            second: [0.3, 7.5, 2.0],
        }
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        for family in Family::ALL {
            let values = truth(family);
            let mut unknowns = [0.0; UNKNOWNS];
            (0..3).for_each(|c| {
                unknowns[c] = libm::log(values.diffuse[c]);
                unknowns[NORMAL + c] = libm::log(values.normal[c]);
                unknowns[GRAZING + c] = libm::log(values.grazing[c]);
                unknowns[SECOND + c] = libm::log(values.second[c]);
            });
            unknowns[WIDTH] = libm::log(values.width);
            unknowns[EXPONENT] = libm::log(values.exponent - 1.0);
            unknowns[SECOND_WIDTH] = libm::log(values.second_width);
            unknowns[SECOND_EXPONENT] = libm::log(values.second_exponent - 1.0);
            for i in 0..50 {
                let n = f64::from(i);
                let wi = direction(1.5 * (0.618 * n).fract(), n);
                let pair = Pair::new(wi, direction(1.4 * (0.37 * n).fract(), 2.7 * n));
                let (value, slopes) = Values::new(&unknowns, family).with_slopes(&pair);
                for c in 0..3 {
                    for (k, unknown) in of_a_channel(c, family).into_iter().enumerate() {
                        if family == Family::Retro && k == OF_A_CHANNEL - 1 {
                            continue;
                        }
                        let mut moved = unknowns;
                        moved[unknown] += 1e-6;
                        let slope = (Values::new(&moved, family).at(&pair)[c] - value[c]) / 1e-6;
                        let apart = (slope - slopes[c][k]).abs();
                        assert!(
                            apart < 1e-4 * (value[c] + slope.abs()),
                            "{family:?} {c} {k}: {slope} {slopes:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_model_that_is_likely_is_found_again_from_its_samples() {
        let truth = truth(Family::OneLobe);
        let view = |theta: f64| -> (f64, Scattered) {
            let wo = [-libm::sin(theta), 0.0, libm::cos(theta)];
            let wi = (0..200).map(|i| direction(1.4 * (0.618 * f64::from(i)).fract(), 0.1 * f64::from(i)));
            (theta, wi.map(|wi| (wi, rgb(truth.at(&Pair::new(wi, wo))))).collect())
        };
        let table = Table::from_scattered([0.2, 0.6, 1.0, 1.3].map(view).to_vec()).unwrap();
        let measurement = Measurement::new(&table);
        let (_, found) = Microfacet::fits(&measurement, Scale::of(&measurement), Family::OneLobe)[0];
        assert!((found.width() / truth.width - 1.0).abs() < 0.01, "{found:?}");
        assert!((found.exponent() / truth.exponent - 1.0).abs() < 0.02, "{found:?}");
    }
}
