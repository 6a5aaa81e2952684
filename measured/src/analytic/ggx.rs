//! The microfacet model of Cook and Torrance 1982 with the GGX distribution of normals (Walter et al. 2007, "Microfacet Models for
//! Refraction through Rough Surfaces"), isotropic and anisotropic, and height-correlated shadowing (Heitz 2014,
//! "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs").

use super::parameters::Parameters;
use super::{fresnel, half};
use crate::ReadError;
use crate::table::{Brdf, Symmetry};
use std::f64::consts::{FRAC_1_PI, PI};

/// How the facets reflect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Facets {
    /// By Schlick's approximation, from the reflectance at normal incidence, linear sRGB.
    Schlick([f64; 3]),
    /// As a dielectric of this index of refraction.
    Dielectric(f64),
}

/// `diffuse / pi + F D G / (4 cos_i cos_o)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// Diffuse albedo below the facets, linear sRGB; it is not lowered by their reflection.
    pub diffuse: [f64; 3],
    /// Roughness along x and y.
    pub alpha: [f64; 2],
    /// How the facets reflect.
    pub facets: Facets,
}

impl Ggx {
    pub(super) fn from_parameters(p: &mut Parameters<'_>) -> Result<Self, ReadError> {
        let (diffuse, alpha) = (p.colour("diffuse", 0.0)?, p.roughness()?);
        if p.has("ior") && p.has("f0") {
            return Err(ReadError::Content("ior takes the place of f0: not both".into()));
        }
        let facets = if p.has("ior") {
            Facets::Dielectric(p.number("ior", 1.5, 1.0..=10.0)?)
        } else {
            Facets::Schlick(p.colour("f0", 0.9)?)
        };
        Ok(Self { diffuse, alpha, facets })
    }

    /// Distribution of normals over the hemisphere; 1/sr.
    fn normals(&self, h: [f64; 3]) -> f64 {
        let [ax, ay] = self.alpha;
        let (x, y) = (h[0] / ax, h[1] / ay);
        let q = x * x + y * y + h[2] * h[2];
        1.0 / (PI * ax * ay * q * q)
    }

    /// Smith's ratio of hidden to visible projected area.
    fn hidden(&self, w: [f64; 3]) -> f64 {
        let (x, y) = (self.alpha[0] * w[0] / w[2], self.alpha[1] * w[1] / w[2]);
        0.5 * (libm::sqrt(1.0 + x * x + y * y) - 1.0)
    }
}

impl Brdf for Ggx {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let (h, cosine) = half(wi, wo);
        let seen = 1.0 / (1.0 + self.hidden(wi) + self.hidden(wo));
        let lobe = self.normals(h) * seen / (4.0 * wi[2] * wo[2]);
        [0, 1, 2].map(|c| {
            let reflectance = match self.facets {
                Facets::Schlick(f0) => fresnel::schlick(f0[c], cosine),
                Facets::Dielectric(ior) => fresnel::dielectric(ior, cosine),
            };
            self.diffuse[c] * FRAC_1_PI + reflectance * lobe
        })
    }

    fn symmetry(&self) -> Symmetry {
        if self.alpha[0] == self.alpha[1] { Symmetry::Isotropic } else { Symmetry::Quadrant }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{dot, tests::albedo};
    use crate::table::direction;

    /// The facets' projected area is that of the surface, and what of it is visible from a direction is its cosine.
    #[test]
    fn distribution_and_shadowing_fit_each_other() {
        let model = Ggx { diffuse: [0.0; 3], alpha: [0.15, 0.5], facets: Facets::Dielectric(1.5) };
        for wo in [direction(0.0, 0.0), direction(0.7, 0.3), direction(1.3, 1.2)] {
            let (mut whole, mut visible) = (0.0, 0.0);
            let (rings, spokes) = (3000, 600);
            for i in 0..rings {
                // Slopes t / (1 - t): the tail of GGX is long.
                let t = (f64::from(i) + 0.5) / f64::from(rings);
                let slope = t / (1.0 - t);
                let cos = 1.0 / libm::sqrt(1.0 + slope * slope);
                let ring = slope * cos * cos * cos / ((1.0 - t) * (1.0 - t)) * 2.0 * PI
                    / (f64::from(rings) * f64::from(spokes));
                for j in 0..spokes {
                    let (s, c) = libm::sincos(2.0 * PI * (f64::from(j) + 0.5) / f64::from(spokes));
                    let h = [slope * cos * c, slope * cos * s, cos];
                    let d = model.normals(h) * ring;
                    whole += d * cos;
                    visible += d * dot(h, wo).max(0.0) / (1.0 + model.hidden(wo));
                }
            }
            assert!((whole - 1.0).abs() < 2e-3, "{whole}");
            assert!((visible - wo[2]).abs() < 2e-3, "{wo:?}: {visible}");
        }
    }

    /// With perfect mirrors as facets only light that is hidden on the way out is lost: little on a smooth surface.
    #[test]
    fn a_smooth_mirror_reflects_everything() {
        let model = Ggx { diffuse: [0.0; 3], alpha: [0.02, 0.02], facets: Facets::Schlick([1.0; 3]) };
        for theta in [0.0, 0.5, 1.0] {
            let found = albedo(&model, direction(theta, 0.3), 0);
            assert!(found < 1.0001 && found > 0.995, "{theta}: {found}");
        }
    }
}
