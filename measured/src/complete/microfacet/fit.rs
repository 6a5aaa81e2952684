//! The fit of the model: which differences are squared, and their derivatives.

use super::{
    COAT_RISE, EXPONENT, Family, GRAZING, LEAST, MOST_DIFFUSE, NORMAL, OF_A_CHANNEL, SECOND, SECOND_EXPONENT,
    SECOND_WIDTH, UNKNOWNS, Values, WIDTH, of_a_channel,
};
use crate::complete::measurement::Measurement;
use crate::complete::scale::Scale;
use crate::complete::tuning::microfacet_fit::{
    BY_LOGARITHM, COAT_DEVIATION, DEVIATION, EXPONENTS, LIKELY, MOST, MOST_COAT, OF_CHANNELS, OVER_BRIGHTEST,
    RETRO_EXPONENTS, RISE, SECOND_WIDTHS, WIDTHS,
};
use crate::numeric::cholesky::Square;
use crate::numeric::levenberg::{LeastSquares, Linear};
use crate::numeric::vector::{self, Operation, Vectors};

/// The fit: the relative L2 error of every view, and differences of logarithms, or residuals of these with a process.
pub(super) struct Fit<'a> {
    measurement: &'a Measurement,
    scale: Scale,
    pub family: Family,
    /// The data on the logarithmic scale.
    logarithms: Vec<[f64; 3]>,
    /// Factor of the matrix by which differences go together, if they do.
    factor: Option<&'a Square>,
    /// The likelihoods.
    likely: Vec<Likely>,
    /// Greatest logarithm of the factor on a second lobe.
    most_second: f64,
}

/// A sum of unknowns and its likely value, both over the deviation.
struct Likely {
    terms: Vec<(usize, f64)>,
    sum: f64,
}

impl Likely {
    fn new(terms: Vec<(usize, f64)>, sum: f64, deviation: f64) -> Self {
        Self { terms: terms.into_iter().map(|(i, f)| (i, f / deviation)).collect(), sum: sum / deviation }
    }

    fn off(&self, x: &[f64]) -> f64 {
        self.terms.iter().map(|&(i, f)| f * x[i]).sum::<f64>() - self.sum
    }

    fn all(family: Family) -> Vec<Self> {
        let rise = |normal: usize, grazing: usize, rise: f64, deviation: f64| {
            Self::new(vec![(grazing, 1.0), (normal, -1.0)], libm::log(rise), deviation)
        };
        let apart = |at: usize, c: usize| {
            let share = |k: usize| (at + k, if k == c { 2.0 / 3.0 } else { -1.0 / 3.0 });
            Self::new(vec![share(0), share(1), share(2)], 0.0, OF_CHANNELS)
        };
        let mut all: Vec<Self> = (0..3)
            .flat_map(|c| {
                [rise(NORMAL + c, GRAZING + c, RISE, DEVIATION), apart(NORMAL, c), apart(GRAZING, c)]
            })
            .collect();
        match family {
            Family::OneLobe => {}
            Family::Coat => all.push(rise(SECOND, SECOND + 1, COAT_RISE, COAT_DEVIATION)),
            Family::Retro => all.extend((0..3).map(|c| apart(SECOND, c))),
        }
        all
    }
}

impl<'a> Fit<'a> {
    pub fn new(
        measurement: &'a Measurement,
        scale: Scale,
        family: Family,
        factor: Option<&'a Square>,
    ) -> Self {
        let logarithms = measurement.samples.iter().map(|s| s.value.map(|v| scale.to(v))).collect();
        let most_second = match family {
            Family::OneLobe | Family::Coat => MOST_COAT,
            Family::Retro => {
                let brightest = measurement.samples.iter().flat_map(|s| s.value).fold(0.0, f64::max);
                libm::log(OVER_BRIGHTEST * brightest).clamp(LEAST, MOST_COAT)
            }
        };
        Self { measurement, scale, family, logarithms, factor, likely: Likely::all(family), most_second }
    }

    fn of_likely(&self) -> f64 {
        if self.factor.is_some() { 1.0 } else { LIKELY }
    }

    /// The sum at unknowns, and if asked for its derivatives.
    fn at(&self, x: &[f64], with_slopes: bool) -> At {
        let mut at = At { cost: 0.0, gradient: vec![0.0; UNKNOWNS], gram: vec![[0.0; UNKNOWNS]; UNKNOWNS] };
        match self.factor {
            None => vector::run(Apart {
                fit: self,
                values: Values::new(x, self.family),
                with_slopes,
                at: &mut at,
            }),
            Some(factor) => self.together(&Values::new(x, self.family), factor, with_slopes, &mut at),
        }
        for likely in &self.likely {
            let off = likely.off(x);
            at.cost += self.of_likely() * off * off;
            for &(i, a) in &likely.terms {
                at.gradient[i] += self.of_likely() * off * a;
                likely.terms.iter().for_each(|&(j, b)| at.gram[i][j] += self.of_likely() * a * b);
            }
        }
        at
    }

    /// Adds what differences are that go together.
    fn together(&self, values: &Values, factor: &Square, with_slopes: bool, at: &mut At) {
        let samples = &self.measurement.samples;
        let columns = if with_slopes { 1 + OF_A_CHANNEL } else { 1 };
        let mut right = Square::rows(3 * columns, samples.len());
        for (n, (s, logarithms)) in samples.iter().zip(&self.logarithms).enumerate() {
            let (value, slopes) = values.with_slopes(&s.pair);
            for c in 0..3 {
                right.row_mut(c * columns)[n] = self.scale.to(value[c]) - logarithms[c];
                let slope = self.scale.slope(value[c]);
                for (k, by) in slopes[c].iter().enumerate().take(columns - 1) {
                    right.row_mut(c * columns + 1 + k)[n] = slope * by;
                }
            }
        }
        factor.solve_lower_all(&mut right);
        for c in 0..3 {
            let row = |k: usize| right.row(c * columns + k);
            at.cost += vector::dot(row(0), row(0));
            if with_slopes {
                let unknowns = of_a_channel(c, self.family);
                for (k, &i) in unknowns.iter().enumerate() {
                    at.gradient[i] += vector::dot(row(1 + k), row(0));
                    for (l, &j) in unknowns.iter().enumerate() {
                        at.gram[i][j] += vector::dot(row(1 + k), row(1 + l));
                    }
                }
            }
        }
    }
}

/// Adds what differences are that are apart.
struct Apart<'a> {
    fit: &'a Fit<'a>,
    values: Values,
    with_slopes: bool,
    at: &'a mut At,
}

impl Operation for Apart<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        let Self { fit, values, with_slopes, at } = self;
        let mut grams = [[[0.0; OF_A_CHANNEL]; OF_A_CHANNEL]; 3];
        let mut gradients = [[0.0; OF_A_CHANNEL]; 3];
        for (s, logarithms) in fit.measurement.samples.iter().zip(&fit.logarithms) {
            let (value, slopes) = values.with_slopes(&s.pair);
            let even = BY_LOGARITHM * s.even;
            for c in 0..3 {
                let (off, apart) = (value[c] - s.value[c], fit.scale.to(value[c]) - logarithms[c]);
                at.cost += s.relative * off * off + even * apart * apart;
                if with_slopes {
                    let slope = fit.scale.slope(value[c]);
                    let (first, second) =
                        (s.relative * off + even * apart * slope, s.relative + even * slope * slope);
                    for k in 0..OF_A_CHANNEL {
                        gradients[c][k] += first * slopes[c][k];
                        let scaled = second * slopes[c][k];
                        for l in 0..OF_A_CHANNEL {
                            grams[c][k][l] += scaled * slopes[c][l];
                        }
                    }
                }
            }
        }
        for c in 0..3 {
            let unknowns = of_a_channel(c, fit.family);
            for (k, &i) in unknowns.iter().enumerate() {
                at.gradient[i] += gradients[c][k];
                unknowns.iter().enumerate().for_each(|(l, &j)| at.gram[i][j] += grams[c][k][l]);
            }
        }
    }
}

pub(super) struct At {
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
    fn step(&mut self, added: &[f64], free: &[bool]) -> Option<Vec<f64>> {
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
        let second = |bounds: (f64, f64), rest: f64| {
            if self.family == Family::OneLobe { (rest, rest) } else { bounds }
        };
        match unknown {
            WIDTH => log(WIDTHS),
            EXPONENT => log(EXPONENTS),
            SECOND_WIDTH => second(log(SECOND_WIDTHS), libm::log(0.1)),
            SECOND_EXPONENT if self.family == Family::Retro => log(RETRO_EXPONENTS),
            SECOND_EXPONENT => second(log(EXPONENTS), 0.0),
            // A coat has two.
            _ if unknown == SECOND + 2 && self.family == Family::Coat => (LEAST, LEAST),
            _ if unknown >= SECOND => second((LEAST, self.most_second), LEAST),
            _ if unknown < WIDTH => (LEAST, MOST_DIFFUSE),
            _ => (LEAST, MOST),
        }
    }

    fn cost(&self, x: &[f64]) -> f64 {
        self.at(x, false).cost
    }

    fn linearize(&self, x: &[f64]) -> At {
        self.at(x, true)
    }
}
