//! A fit as a BRDF.

use crate::table::{Brdf, Symmetry};
use srbf_core::{MAX_LOBES, Material, Mixture, Vec3};

/// The lobes of a material, and its factors, as a BRDF.
pub struct Lobes<B>(pub Material<B>);

impl<B: AsRef<[u8]> + Sync> Brdf for Lobes<B> {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let mut mixture = Mixture::<MAX_LOBES>::empty();
        let [wi32, wo32] = [wi, wo].map(|d| Vec3::from(d.map(|v| v as f32)));
        // A direction that rounding puts below the horizon has no value.
        if self.0.prepare(wo32, &mut mixture).is_err() {
            return [f64::NAN; 3];
        }
        mixture.evaluate(wi32).to_array().map(|v| f64::from(v) / wi[2])
    }

    fn symmetry(&self) -> Symmetry {
        if self.0.is_isotropic() { Symmetry::Isotropic } else { Symmetry::None }
    }
}
