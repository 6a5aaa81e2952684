//! An analytic material in C, which a measured one is timed beside.
#![allow(unsafe_code)]

/// A GGX reflection above a diffuse term.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Ggx {
    /// Albedo of the diffuse term, linear sRGB.
    pub diffuse: [f32; 3],
    /// Reflectance at normal incidence.
    pub specular: [f32; 3],
    /// Roughness.
    pub alpha: f32,
    /// Share of the draws that the reflection gets.
    pub share: f32,
}

unsafe extern "C" {
    fn srbf_ggx_evaluate(m: *const Ggx, wo: *const f32, wi: *const f32, value: *mut f32, pdf: *mut f32);
    fn srbf_ggx_sample(
        m: *const Ggx,
        wo: *const f32,
        u: *const f32,
        wi: *mut f32,
        weight: *mut f32,
        pdf: *mut f32,
    );
}

impl Ggx {
    /// `f cos` and the density towards `wi`.
    pub fn evaluate_and_pdf(&self, wo: [f32; 3], wi: [f32; 3]) -> ([f32; 3], f32) {
        let (mut value, mut pdf) = ([0.0; 3], 0.0);
        // SAFETY: the C function reads a material and two vectors of three numbers, and writes three and one.
        unsafe { srbf_ggx_evaluate(self, wo.as_ptr(), wi.as_ptr(), value.as_mut_ptr(), &mut pdf) };
        (value, pdf)
    }

    /// A direction, its weight and its density.
    pub fn sample(&self, wo: [f32; 3], u: [f32; 3]) -> ([f32; 3], [f32; 3], f32) {
        let (mut wi, mut weight, mut pdf) = ([0.0; 3], [0.0; 3], 0.0);
        // SAFETY: as above; it writes three, three and one.
        unsafe {
            srbf_ggx_sample(self, wo.as_ptr(), u.as_ptr(), wi.as_mut_ptr(), weight.as_mut_ptr(), &mut pdf);
        }
        (wi, weight, pdf)
    }
}
