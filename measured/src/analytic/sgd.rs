//! The shifted-gamma model (Bagher, Soler and Holzschuch 2012, "Accurate fitting of measured reflectances using a Shifted Gamma
//! micro-facet distribution"), with parameters from a table of fits to the MERL materials.
//!
//! ```text
//! f = (rhoD + rhoS F(i.h) D(h) G(i) G(o) / (cos_i cos_o)) / pi
//! F(c) = f0 - f1 c + (1 - f0) (1 - c)^5
//! D = kap exp(-x) / (pi x^p cos_h^4),                       x = alpha + tan^2(theta_h) / alpha
//! G = clamp(1 + lambda (1 - exp(c max(0, theta - theta0)^k)), 0, 1)
//! ```

use super::{fits, half};
use crate::ReadError;
use crate::table::Brdf;
use std::f64::consts::FRAC_1_PI;

const HEADER: &str = "name,rhoD_r,rhoD_g,rhoD_b,rhoS_r,rhoS_g,rhoS_b,alpha_r,alpha_g,alpha_b,p_r,p_g,p_b,\
f0_r,f0_g,f0_b,f1_r,f1_g,f1_b,kap_r,kap_g,kap_b,lambda_r,lambda_g,lambda_b,c_r,c_g,c_b,k_r,k_g,k_b,\
theta0_r,theta0_g,theta0_b,error_r,error_g,error_b";

/// Parameters, in the order of the table, red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sgd {
    diffuse: [f64; 3],
    specular: [f64; 3],
    alpha: [f64; 3],
    power: [f64; 3],
    f0: [f64; 3],
    f1: [f64; 3],
    scale: [f64; 3],
    lambda: [f64; 3],
    c: [f64; 3],
    k: [f64; 3],
    theta0: [f64; 3],
}

/// Parses the parameters of one material in a table of fits.
///
/// # Errors
/// [`ReadError`] for another header, a row of another length, numbers that are not finite, and a material that is not there.
pub fn parse(bytes: &[u8], material: &str) -> Result<Sgd, ReadError> {
    let v = fits::find(bytes, HEADER, material)?;
    let triple = |n: usize| [v[3 * n], v[3 * n + 1], v[3 * n + 2]];
    if triple(2).iter().any(|a| *a <= 0.0) {
        return Err(ReadError::Content(format!("{material}: alpha has to be above 0")));
    }
    Ok(Sgd {
        diffuse: triple(0),
        specular: triple(1),
        alpha: triple(2),
        power: triple(3),
        f0: triple(4),
        f1: triple(5),
        scale: triple(6),
        lambda: triple(7),
        c: triple(8),
        k: triple(9),
        theta0: triple(10),
    })
}

impl Brdf for Sgd {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let (h, cosine) = half(wi, wo);
        let zz = (h[2] * h[2]).min(1.0);
        let tan_squared = (1.0 - zz) / zz;
        let m = 1.0 - cosine;
        let angle = |w: [f64; 3]| libm::atan2(libm::hypot(w[0], w[1]), w[2]);
        let angles = [angle(wi), angle(wo)];
        [0, 1, 2].map(|i| {
            let x = self.alpha[i] + tan_squared / self.alpha[i];
            let normals = self.scale[i] * libm::exp(-x) * FRAC_1_PI / (libm::pow(x, self.power[i]) * zz * zz);
            let fresnel = self.f0[i] - self.f1[i] * cosine + (1.0 - self.f0[i]) * (m * m) * (m * m) * m;
            let seen = |theta: f64| {
                let past = theta - self.theta0[i];
                if past <= 0.0 {
                    return 1.0;
                }
                (1.0 - self.lambda[i] * libm::expm1(self.c[i] * libm::pow(past, self.k[i]))).clamp(0.0, 1.0)
            };
            let shadow = seen(angles[0]) * seen(angles[1]);
            FRAC_1_PI
                * (self.diffuse[i] + self.specular[i] * fresnel * normals * shadow / (wi[2] * wo[2])).max(0.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(row: &str) -> Vec<u8> {
        format!("{HEADER}\n{row}\n").into_bytes()
    }

    /// A row of 36 numbers: the same three for every parameter, in the order of the header.
    fn row(values: [f64; 12]) -> String {
        let numbers: Vec<String> = values.iter().flat_map(|v| vec![v.to_string(); 3]).collect();
        format!("a-paint,{}", numbers.join(","))
    }

    #[test]
    fn a_value_by_hand() {
        // Normal incidence, mirror direction: x = alpha = 1, F = f0 - f1, D = exp(-1) / pi, G = 1.
        let model =
            parse(&table(&row([0.5, 0.2, 1.0, 2.0, 0.9, 0.1, 1.0, 1.0, 1.0, 1.0, 0.5, 0.0])), "a-paint")
                .unwrap();
        let f = model.evaluate([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
        let expected = FRAC_1_PI * (0.5 + 0.2 * 0.8 * libm::exp(-1.0) * FRAC_1_PI);
        assert!(f.iter().all(|v| (v - expected).abs() < 1e-15), "{f:?} {expected}");
        let (a, b) = ([0.6, 0.0, 0.8], [0.0, 0.8, 0.6]);
        assert_eq!(model.evaluate(a, b), model.evaluate(b, a));
    }

    #[test]
    fn damage_is_an_error() {
        let good = row([0.5; 12]);
        assert!(parse(&table(&good), "a-paint").is_ok());
        for bad in
            [good.replace("0.5", "x"), good.replace(",0.5", ",inf"), format!("{good},1"), "a-paint,1".into()]
        {
            assert!(parse(&table(&bad), "a-paint").is_err(), "{bad}");
        }
        assert!(parse(&table(&good), "b-paint").unwrap_err().to_string().contains("a-paint"));
        assert!(parse(b"name,x\n", "a-paint").is_err());
        assert!(parse(&[0xff, 0xfe], "a-paint").is_err());
        assert!(parse(b"", "a-paint").is_err());
    }
}
