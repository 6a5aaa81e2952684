//! Round lobes on the sphere, without a fold: the thesis's equation 8.

use srbf_core::{Gaussian, Vec3};
use std::f64::consts::PI;

/// A Gaussian lobe with a colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundLobe {
    /// Axis, unit vector in the frame of the view; it may lie below the horizon.
    pub axis: [f64; 3],
    /// Sharpness; the thesis's bandwidth.
    pub sharpness: f64,
    /// Amplitude, linear sRGB, at least 0; the thesis's coefficient. Unit of f, 1/sr.
    pub amplitude: [f64; 3],
}

/// Below this exponent a lobe is 0.
pub(crate) const SMALLEST: f64 = -20.0;

impl RoundLobe {
    /// The lobe with amplitude 1 at a direction.
    #[inline]
    pub(crate) fn unit(&self, d: &[f64; 3]) -> f64 {
        let t = self.sharpness * (self.axis[0] * d[0] + self.axis[1] * d[1] + self.axis[2] * d[2] - 1.0);
        if t < SMALLEST { 0.0 } else { libm::exp(t) }
    }

    /// Integral over the sphere of the lobe with amplitude 1.
    pub(crate) fn unit_integral(&self) -> f64 {
        -2.0 * PI * libm::expm1(-2.0 * self.sharpness) / self.sharpness
    }

    /// The part of it above the horizon, to seven digits.
    pub(crate) fn unit_integral_above_horizon(&self) -> f64 {
        let axis = Vec3::from(self.axis.map(|v| v as f32));
        Gaussian::new(axis, self.sharpness as f32).map_or(0.0, |lobe| f64::from(lobe.hemisphere_integral()))
    }
}

/// f of a mixture at a direction.
pub(crate) fn evaluate(lobes: &[RoundLobe], d: &[f64; 3]) -> [f64; 3] {
    let mut rgb = [0.0; 3];
    for lobe in lobes {
        let unit = lobe.unit(d);
        (0..3).for_each(|c| rgb[c] += lobe.amplitude[c] * unit);
    }
    rgb
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thesis::cube::Cube;

    #[test]
    fn the_integral_is_the_sum_over_the_sphere() {
        let cube = Cube::new(64);
        for sharpness in [0.5, 3.0, 80.0] {
            let lobe = RoundLobe { axis: [0.8, 0.0, 0.6], sharpness, amplitude: [1.0; 3] };
            // The cube map holds one half of the sphere; the other is its mirror image.
            let sum = |z: f64| -> f64 {
                let texels = cube.directions.iter().zip(&cube.solid_angles);
                texels.map(|(d, w)| w * lobe.unit(&[d[0], d[1], z * d[2]])).sum()
            };
            let (above, below) = (sum(1.0), sum(-1.0));
            assert!(((above + below) / lobe.unit_integral() - 1.0).abs() < 2e-3, "{sharpness}: {above}");
            assert!((above / lobe.unit_integral_above_horizon() - 1.0).abs() < 2e-3, "{sharpness}: {above}");
        }
    }
}
