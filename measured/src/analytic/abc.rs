//! The ABC microfacet model (Low, Kronander, Ynnerman and Unger 2012, "BRDF Models for Accurate and Efficient Rendering of Glossy
//! Surfaces"), with parameters from a table of fits to the MERL materials.
//!
//! `f = kD / pi + F D G / (pi cos_i cos_o)` with `D = A / (1 + B (1 - cos_h))^C`, F of a dielectric, and the V-cavity shadowing of
//! Cook and Torrance 1982, `G = min(1, 2 h.z i.z / i.h, 2 h.z o.z / i.h)`.

use super::{fits, fresnel, half};
use crate::ReadError;
use crate::table::Brdf;
use std::f64::consts::FRAC_1_PI;

const HEADER: &str = "name,kD_r,kD_g,kD_b,A_r,A_g,A_b,B,C,ior";

/// Parameters of one material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Abc {
    diffuse: [f64; 3],
    scale: [f64; 3],
    b: f64,
    c: f64,
    ior: f64,
}

/// Parses the parameters of one material in a table of fits.
///
/// # Errors
/// [`ReadError`] for another header, a row of another length, numbers that are not finite or out of range; and for a material that
/// is not there.
pub fn parse(bytes: &[u8], material: &str) -> Result<Abc, ReadError> {
    let v = fits::find(bytes, HEADER, material)?;
    if v[6] < 0.0 || v[8] < 1.0 {
        return Err(ReadError::Content(format!("{material}: B at least 0 and ior at least 1 were expected")));
    }
    Ok(Abc { diffuse: [v[0], v[1], v[2]], scale: [v[3], v[4], v[5]], b: v[6], c: v[7], ior: v[8] })
}

impl Brdf for Abc {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let (h, cosine) = half(wi, wo);
        // 1 - cos from the sine: B is up to 1e6.
        let down = (h[0] * h[0] + h[1] * h[1]) / (1.0 + h[2]);
        let normals = libm::pow(1.0 + self.b * down, -self.c);
        let shadow = (2.0 * h[2] * wi[2].min(wo[2]) / cosine).min(1.0);
        let lobe = fresnel::dielectric(self.ior, cosine) * normals * shadow / (wi[2] * wo[2]);
        [0, 1, 2].map(|i| FRAC_1_PI * (self.diffuse[i] + self.scale[i] * lobe).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(row: &str) -> Vec<u8> {
        format!("{HEADER}\na-paint,{row}\n").into_bytes()
    }

    #[test]
    fn a_value_by_hand() {
        let model = parse(&table("0.1,0.2,0.3,2,4,6,1000,1.5,1.5"), "a-paint").unwrap();
        let f = model.evaluate([0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]);
        // At the mirror direction D = A; the shadow is min(1, 2 * 0.8 / 0.8) = 1.
        let expected =
            [0.1, 0.2, 0.3].map(|d| FRAC_1_PI * (d + 20.0 * d * fresnel::dielectric(1.5, 0.8) / 0.64));
        assert!((0..3).all(|i| (f[i] - expected[i]).abs() < 1e-14), "{f:?} {expected:?}");
        let (a, b) = ([0.6, 0.0, 0.8], [0.0, 0.96, 0.28]);
        assert_eq!(model.evaluate(a, b), model.evaluate(b, a));
    }

    #[test]
    fn damage_is_an_error() {
        for bad in
            ["", "0.1", "0.1,0.2,0.3,2,4,6,-1,1.5,1.5", "0.1,0.2,0.3,2,4,6,10,1.5,0.5", "a,b,c,d,e,f,g,h,i"]
        {
            assert!(parse(&table(bad), "a-paint").is_err(), "{bad}");
        }
    }
}
