//! One lobe, as plain data.

use crate::guard::Failure;
use srbf_core::{Lobe, Vec3};

/// One spherical Gaussian lobe, `amplitude exp(sharpness (d . axis - 1))` over the whole sphere.
///
/// `srbf_mixture_from_lobes` makes a mixture of it, on `SRBF_DOMAIN_SPHERE` with the lobe's own values, integral, density and products.
/// It checks it: `SRBF_STATUS_AXIS`, `SRBF_STATUS_SHARPNESS`, `SRBF_STATUS_AMPLITUDE`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_lobe {
    /// Where the lobe is highest; unit vector.
    pub axis: [f32; 3],
    /// How narrow the lobe is, in [0, 1e8]; 0 is constant over the sphere.
    pub sharpness: f32,
    /// Value at the axis, linear sRGB. A channel may be negative, the luminance not, and no channel beyond 32 times that.
    pub amplitude: [f32; 3],
}

impl srbf_lobe {
    #[inline]
    pub(crate) fn to_core(self) -> Result<Lobe, Failure> {
        let amplitude = Vec3::from_array(self.amplitude);
        Ok(Lobe::new(Vec3::from_array(self.axis), self.sharpness, amplitude)?)
    }

    #[inline]
    pub(crate) fn from_core(lobe: Lobe) -> Self {
        Self {
            axis: lobe.gaussian.axis.to_array(),
            sharpness: lobe.gaussian.sharpness,
            amplitude: lobe.amplitude.to_array(),
        }
    }
}
