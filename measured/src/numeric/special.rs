//! Integrals in closed form.

use std::f64::consts::PI;

/// Integral of a Gaussian lobe of unit amplitude over the sphere, and its derivative by the logarithm of the sharpness.
pub fn sphere_integral(ln_sharpness: f64) -> (f64, f64) {
    let s = libm::exp(ln_sharpness);
    let integral = -2.0 * PI * libm::expm1(-2.0 * s) / s;
    (integral, 4.0 * PI * libm::exp(-2.0 * s) - integral)
}
