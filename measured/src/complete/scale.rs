//! A scale that is logarithmic for bright values, and linear around 0: measured values may be 0, or negative.

use super::measurement::Measurement;
use crate::complete::tuning::scale::FLOOR;
use crate::numeric::vector::fused;

/// `asinh(f / (2 floor))`: the logarithm of `f / floor` where f is much more than that.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    twice: f64,
}

impl Scale {
    /// For samples with that mean radiance.
    pub fn of(measurement: &Measurement) -> Self {
        Self { twice: (2.0 * FLOOR * measurement.level).max(f64::MIN_POSITIVE) }
    }

    /// On the scale.
    pub fn to(self, f: f64) -> f64 {
        libm::asinh(f / self.twice)
    }

    /// Derivative of the place on the scale by the value.
    pub fn slope(self, f: f64) -> f64 {
        1.0 / libm::sqrt(fused(f, f, self.twice * self.twice))
    }

    /// Back.
    pub fn back(self, scaled: f64) -> f64 {
        self.twice * libm::sinh(scaled)
    }
}
