//! One lobe, as plain data.
#![allow(unsafe_code)]

use crate::convert::{direction, uniform};
use crate::guard::{Failure, guard};
use crate::pointers::{Out, read, read_array};
use crate::status::srbf_status;
use srbf_core::{Lobe, Vec3};

/// One spherical Gaussian lobe, `amplitude exp(sharpness (d . axis - 1))` over the whole sphere.
///
/// Every call that takes a lobe checks it: `SRBF_STATUS_AXIS`, `SRBF_STATUS_SHARPNESS`, `SRBF_STATUS_AMPLITUDE`.
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

/// Evaluates a lobe towards a direction.
///
/// Shapes: `direction` [3], unit vector; `value` [3], overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_lobe_evaluate(
    lobe: *const srbf_lobe,
    direction: *const f32,
    value: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (lobe, d, out) = unsafe { (read(lobe)?, read_array(direction)?, Out::<[f32; 3]>::array(value)?) };
        let lobe = lobe.to_core()?;
        out.set((lobe.amplitude * lobe.gaussian.value(self::direction(d)?)).to_array());
        Ok(())
    })
}

/// Integrates a lobe over the whole sphere: `2 pi amplitude (1 - exp(-2 s)) / s`.
///
/// Infinite where it is more than a float holds, for amplitudes from 2.7e37 on.
/// Shapes: `integral` [3], overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_lobe_integrate(lobe: *const srbf_lobe, integral: *mut f32) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (lobe, out) = unsafe { (read(lobe)?, Out::<[f32; 3]>::array(integral)?) };
        let lobe = lobe.to_core()?;
        out.set((lobe.amplitude * lobe.gaussian.integral()).to_array());
        Ok(())
    })
}

/// Evaluates the density of `srbf_lobe_sample` at a direction; 1/sr. The amplitude does not matter.
///
/// Shapes: `direction` [3], unit vector; `pdf` one number, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_lobe_pdf(
    lobe: *const srbf_lobe,
    direction: *const f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (lobe, d, out) = unsafe { (read(lobe)?, read_array(direction)?, Out::new(pdf)?) };
        out.set(lobe.to_core()?.gaussian.pdf(self::direction(d)?));
        Ok(())
    })
}

/// Draws a direction on the whole sphere from a lobe's density.
///
/// Shapes: `u` [2], uniform numbers in [0, 1); `direction` [3], overwritten with a unit vector.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_lobe_sample(
    lobe: *const srbf_lobe,
    u: *const f32,
    direction: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (lobe, u, out) =
            unsafe { (read(lobe)?, read_array::<2>(u)?, Out::<[f32; 3]>::array(direction)?) };
        out.set(lobe.to_core()?.gaussian.sample(uniform(u)?).to_array());
        Ok(())
    })
}
