//! A clear coat: how much light its smooth face reflects.

use crate::float::sqrt;

/// Share of unpolarised light that a smooth dielectric of a refractive index reflects, seen from outside, at a cosine from the normal.
///
/// Fresnel's equations. Range: index from 1, where it is 0; the cosine counts without its sign. Returns: 0 to 1.
#[inline]
pub fn fresnel(index: f32, cosine: f32) -> f32 {
    let c = cosine.abs().min(1.0);
    // The index times the cosine of the refracted direction; 1 - c^2 without loss of digits.
    let g = sqrt((index - 1.0) * (index + 1.0) + c * c);
    let (sum, difference) = (g + c, g - c);
    if sum == 0.0 {
        // The index is 1.
        return 0.0;
    }
    let across = difference / sum;
    let along = (c * sum - 1.0) / (c * difference + 1.0);
    (0.5 * across * across * (1.0 + along * along)).clamp(0.0, 1.0)
}

/// The transmittance of a coat at a cosine from the normal.
#[inline(always)]
pub(super) fn through(index: f32, cosine: f32) -> f32 {
    if index > 1.0 { 1.0 - fresnel(index, cosine) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fresnel_has_its_known_values() {
        assert!((fresnel(1.5, 1.0) - 0.04).abs() < 1e-7);
        assert!((fresnel(1.33, 1.0) - 0.020_059_3).abs() < 1e-7);
        // Brewster's angle: light along the plane is not reflected, and half of the rest is.
        let cosine = 1.0 / (1.0f32 + 1.5 * 1.5).sqrt();
        let across: f32 = (1.5 * 1.5 - 1.0) / (1.5 * 1.5 + 1.0);
        assert!((fresnel(1.5, cosine) - 0.5 * across * across).abs() < 1e-6);
        for index in [1.0, 1.000_001, 1.3, 2.4, 10.0] {
            let edge = fresnel(index, 0.0);
            assert!((edge - if index == 1.0 { 0.0 } else { 1.0 }).abs() < 1e-6, "{index}: {edge}");
            for n in 0..=1000 {
                let f = fresnel(index, n as f32 * 1e-3);
                assert!((0.0..=1.0).contains(&f) && (index > 1.0 || f == 0.0), "{index} {n}: {f}");
            }
        }
    }
}
