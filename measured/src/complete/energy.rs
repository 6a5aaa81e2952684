//! No surface reflects more than it receives. The completion keeps to that between samples and beyond the last one.

use crate::FitError;
use crate::complete::tuning::energy::{DENSITY, INTERVALS, MOST};
use crate::table::{Brdf, Symmetry, Table};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Angles, radians, and the albedos there in linear sRGB.
type Albedos = Vec<(f64, [f64; 3])>;

/// Turns of an anisotropic surface at which it holds.
const TURNS: usize = 8;

/// A surface at a turn, as if it were isotropic: both sides of the plane of incidence are one.
struct AtTurn<'a> {
    brdf: &'a dyn Brdf,
    turn: [f64; 2],
}

impl Brdf for AtTurn<'_> {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let [s, c] = self.turn;
        let side = |sign: f64| {
            let turned = |[x, y, z]: [f64; 3]| [c * x - s * sign * y, s * x + c * sign * y, z];
            self.brdf.evaluate(turned(wi), turned(wo))
        };
        let (left, right) = (side(1.0), side(-1.0));
        [0, 1, 2].map(|c| 0.5 * (left[c] + right[c]))
    }
}

/// What values are multiplied by, once for each of the two directions, so that they stay reciprocal.
#[derive(Clone)]
pub(super) struct Energy {
    factors: Vec<f64>,
}

impl Energy {
    /// Factors that hold the albedos of a BRDF, `None` where they hold by themselves; and the albedos before, with their angles, radians.
    pub fn new(brdf: &dyn Brdf) -> Result<(Option<Self>, Albedos), FitError> {
        let last = 0.999 * FRAC_PI_2;
        let theta = |n: usize| libm::acos(1.0 - (n as f64 / INTERVALS as f64).powi(2)).min(last);
        let thetas: Vec<f64> = (0..=INTERVALS).map(theta).collect();
        let factor = |albedo: [f64; 3]| libm::sqrt((MOST / albedo.into_iter().fold(MOST, f64::max)).min(1.0));
        if brdf.symmetry() != Symmetry::Isotropic {
            return Self::of_turns(brdf, &thetas, factor);
        }
        let table = Table::from_brdf(brdf, &thetas, DENSITY)?;
        let factors: Vec<f64> = table.views.iter().map(|view| factor(view.albedo)).collect();
        let albedos = table.views.iter().map(|view| (view.theta, view.albedo)).collect();
        Ok((factors.iter().any(|f| *f < 1.0).then_some(Self { factors }), albedos))
    }

    /// Factors that hold what both hold.
    pub fn least(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        match (a, b) {
            (Some(a), Some(b)) => {
                Some(Self { factors: a.factors.iter().zip(&b.factors).map(|(a, b)| a.min(*b)).collect() })
            }
            (a, b) => a.or(b),
        }
    }

    /// The least factors, and the mean albedos, of all turns.
    fn of_turns(
        brdf: &dyn Brdf,
        thetas: &[f64],
        factor: impl Fn([f64; 3]) -> f64,
    ) -> Result<(Option<Self>, Albedos), FitError> {
        let mut factors = vec![1.0f64; thetas.len()];
        let mut albedos: Albedos = thetas.iter().map(|theta| (*theta, [0.0; 3])).collect();
        for n in 0..TURNS {
            let (s, c) = libm::sincos(TAU * n as f64 / TURNS as f64);
            let table = Table::from_brdf(&AtTurn { brdf, turn: [s, c] }, thetas, DENSITY)?;
            for (k, view) in table.views.iter().enumerate() {
                factors[k] = factors[k].min(factor(view.albedo));
                (0..3).for_each(|c| albedos[k].1[c] += view.albedo[c] / TURNS as f64);
            }
        }
        Ok((factors.iter().any(|f| *f < 1.0).then_some(Self { factors }), albedos))
    }

    /// The factor of one direction, by its cosine.
    pub fn factor(&self, cos: f64) -> f64 {
        let place = libm::sqrt((1.0 - cos).clamp(0.0, 1.0)) * INTERVALS as f64;
        let node = (place as usize).min(INTERVALS - 1);
        let part = place - node as f64;
        self.factors[node] + part * (self.factors[node + 1] - self.factors[node])
    }
}
