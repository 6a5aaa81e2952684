//! How far data are from their own mirror image in the plane of incidence. An isotropic material whose lobes lie in that plane, or
//! in pairs beside it, is its own image, as most surfaces are: the difference is noise of a measurement. Tables of
//! isotropic data have directions on one side of the plane only, so that fits and errors say nothing of the other.

use crate::table::Brdf;
use crate::table::{Table, direction};

/// Mean relative L2 norm, over the views of a table, of the part of `f cos` that changes sign in the mirror. It goes by the
/// samples and weights of the table; views where the BRDF is black left out. 0 for a BRDF that is its own image, 1 for one that is
/// 0 in its image.
pub fn handedness(brdf: &dyn Brdf, table: &Table) -> f64 {
    let (mut sum, mut views) = (0.0, 0usize);
    for view in &table.views {
        let wo = direction(view.theta, 0.0);
        let (mut odd, mut all) = (0.0, 0.0);
        for sample in &view.samples {
            let [x, y, z] = sample.direction;
            let (value, image) = (brdf.evaluate([x, y, z], wo), brdf.evaluate([x, -y, z], wo));
            for (v, m) in value.into_iter().zip(image) {
                odd += sample.weight * (0.5 * (v - m) * z).powi(2);
                all += sample.weight * 0.5 * (v * v + m * m) * z * z;
            }
        }
        if all > 0.0 {
            sum += libm::sqrt(odd / all);
            views += 1;
        }
    }
    sum / views.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Density;

    /// 1 + a on one side of the plane of incidence, 1 - a on the other.
    struct Sided(f64);

    impl Brdf for Sided {
        fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
            let side = wo[0] * wi[1] - wo[1] * wi[0];
            [1.0 + if side > 0.0 { self.0 } else { -self.0 }; 3]
        }
    }

    #[test]
    fn what_differs_from_its_image_is_measured() {
        for a in [0.0, 0.3, 1.0] {
            let brdf = Sided(a);
            let table = Table::from_brdf(&brdf, &[0.5, 1.0], Density { hemisphere: 400, cap: 0 }).unwrap();
            let expected = a / libm::sqrt(1.0 + a * a);
            assert!((handedness(&brdf, &table) - expected).abs() < 1e-9, "{a}");
        }
    }
}
