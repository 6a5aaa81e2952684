//! Lambert's law: the same brightness from everywhere.

use super::parameters::Parameters;
use crate::ReadError;
use crate::table::Brdf;
use std::f64::consts::FRAC_1_PI;

/// `albedo / pi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambert {
    /// Linear sRGB, in [0, 1].
    pub albedo: [f64; 3],
}

impl Lambert {
    pub(super) fn from_parameters(p: &mut Parameters<'_>) -> Result<Self, ReadError> {
        Ok(Self { albedo: p.colour("albedo", 0.5)? })
    }
}

impl Brdf for Lambert {
    fn evaluate(&self, _: [f64; 3], _: [f64; 3]) -> [f64; 3] {
        self.albedo.map(|a| a * FRAC_1_PI)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::tests::albedo;

    #[test]
    fn the_furnace_gives_the_albedo() {
        let model = Lambert { albedo: [0.3, 0.5, 0.7] };
        for (c, expected) in model.albedo.into_iter().enumerate() {
            assert!((albedo(&model, [0.6, 0.0, 0.8], c) - expected).abs() < 1e-4 * expected);
        }
    }
}
