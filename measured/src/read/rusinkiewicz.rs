//! The half and the difference vector of two directions (Rusinkiewicz 1998), as measured files index them.

/// Half and difference vector of an isotropic pair.
pub(super) struct HalfAndDifference {
    /// The half vector's length across the normal, and along it: its azimuth does not matter.
    pub across: f64,
    pub along: f64,
    /// The incident direction, seen from the half vector as the normal.
    pub difference: [f64; 3],
}

/// Makes them of two unit vectors.
pub(super) fn half_and_difference(wi: [f64; 3], wo: [f64; 3]) -> HalfAndDifference {
    let mut h = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]];
    let length = libm::sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
    h.iter_mut().for_each(|v| *v /= length);
    let across = libm::hypot(h[0], h[1]);
    let (c, s) = if across > 0.0 { (h[0] / across, h[1] / across) } else { (1.0, 0.0) };
    let (x, y) = (c * wi[0] + s * wi[1], c * wi[1] - s * wi[0]);
    let difference = [h[2] * x - across * wi[2], y, across * x + h[2] * wi[2]];
    HalfAndDifference { across, along: h[2], difference }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_that_mirror_each_other_differ_across_the_plane_only() {
        let HalfAndDifference { across, along, difference } =
            half_and_difference([0.0, 0.6, 0.8], [0.0, -0.6, 0.8]);
        assert!(across < 1e-15 && (along - 1.0).abs() < 1e-15);
        assert!((difference[1] - 0.6).abs() < 1e-15 && (difference[2] - 0.8).abs() < 1e-15);
    }
}
