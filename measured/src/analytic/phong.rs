//! Phong's model, modified so that it is reciprocal and keeps energy (Lafortune and Willems 1994, "Using the Modified Phong
//! Reflectance Model for Physically Based Rendering").

use super::dot;
use super::parameters::{Parameters, check_sum};
use crate::ReadError;
use crate::table::Brdf;
use std::f64::consts::{FRAC_1_PI, PI};

/// `diffuse / pi + specular (n + 2) / (2 pi) cos^n a`, `a` the angle to the mirror direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// Diffuse albedo, linear sRGB.
    pub diffuse: [f64; 3],
    /// Albedo of the highlight at normal incidence, linear sRGB; the two add up to at most 1.
    pub specular: [f64; 3],
    /// n, at least 0.
    pub exponent: f64,
}

impl Phong {
    pub(super) fn from_parameters(p: &mut Parameters<'_>) -> Result<Self, ReadError> {
        let (diffuse, specular) = (p.colour("diffuse", 0.3)?, p.colour("specular", 0.3)?);
        check_sum(diffuse, specular)?;
        Ok(Self { diffuse, specular, exponent: p.number("exponent", 50.0, 0.0..=1e6)? })
    }
}

impl Brdf for Phong {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let cosine = dot(wi, [-wo[0], -wo[1], wo[2]]).max(0.0);
        let lobe = (self.exponent + 2.0) / (2.0 * PI) * libm::pow(cosine, self.exponent);
        [0, 1, 2].map(|c| self.diffuse[c] * FRAC_1_PI + self.specular[c] * lobe)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::tests::albedo;

    #[test]
    fn the_furnace_at_normal_incidence_gives_the_sum() {
        for exponent in [0.0, 1.0, 30.0, 1000.0] {
            let model = Phong { diffuse: [0.2; 3], specular: [0.5; 3], exponent };
            let found = albedo(&model, [0.0, 0.0, 1.0], 0);
            assert!((found - 0.7).abs() < 2e-4, "{exponent}: {found}");
        }
    }

    #[test]
    fn the_peak_is_the_normaliser() {
        let model = Phong { diffuse: [0.0; 3], specular: [1.0; 3], exponent: 10.0 };
        let peak = model.evaluate([0.6, 0.0, 0.8], [-0.6, 0.0, 0.8])[1];
        assert!((peak - 6.0 / PI).abs() < 1e-12, "{peak}");
    }
}
