//! Fresnel reflectance, by the cosine between a direction and the half vector.

/// Schlick 1994: `f0 + (1 - f0) (1 - c)^5`.
pub(super) fn schlick(f0: f64, cosine: f64) -> f64 {
    let m = 1.0 - cosine;
    f0 + (1.0 - f0) * (m * m) * (m * m) * m
}

/// Unpolarised light on a dielectric of index of refraction `ior`, at least 1.
pub(super) fn dielectric(ior: f64, cosine: f64) -> f64 {
    // Cook and Torrance 1982: g = ior cos of the refracted ray.
    let g = libm::sqrt(ior * ior - 1.0 + cosine * cosine);
    let (minus, plus) = (g - cosine, g + cosine);
    let a = minus / plus;
    let b = (cosine * plus - 1.0) / (cosine * minus + 1.0);
    0.5 * a * a * (1.0 + b * b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        assert_eq!(schlick(0.04, 1.0), 0.04);
        assert_eq!(schlick(0.04, 0.0), 1.0);
        assert!((dielectric(1.5, 1.0) - 0.04).abs() < 1e-15);
        assert!((dielectric(1.5, 0.0) - 1.0).abs() < 1e-12);
        // At Brewster's angle one polarisation vanishes: R = (sin^2(i - t)) / 2 with i + t = 90 degrees.
        let i = libm::atan(1.5);
        let expected = 0.5 * libm::pow(libm::sin(2.0 * i - std::f64::consts::FRAC_PI_2), 2.0);
        assert!((dielectric(1.5, libm::cos(i)) - expected).abs() < 1e-14);
        assert_eq!(dielectric(1.0, 0.5), 0.0);
    }
}
