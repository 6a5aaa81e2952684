//! Directions round an axis, by the angle from it and the azimuth round it.

use crate::float;
use core::f32::consts::PI;
use glam::Vec3;

/// The vector normalised, if it is finite and of length 1 within 1e-3.
pub(crate) fn unit(v: Vec3) -> Option<Vec3> {
    let squared = v.length_squared();
    // False for NaN and infinity. What f32 could normalise is left as it is, to the last bit: a turn by one
    // rounding would cost a lobe of sharpness 1e8 three digits on its flank, a length off by 2e-7 costs
    // nothing.
    if (squared - 1.0).abs() <= 6e-7 {
        Some(v)
    } else {
        ((squared - 1.0).abs() <= 2e-3).then(|| v.normalize())
    }
}

/// The direction at `w = 1 - cos` from the axis, turned `turns` round it.
#[inline]
pub(crate) fn around(axis: Vec3, w: f32, turns: f32) -> Vec3 {
    let sin_theta = float::sqrt(w * (2.0 - w));
    let (sin_phi, cos_phi) = float::sin_cos_turns(turns);
    let (tangent, bitangent) = frame(axis);
    // The axis is added last and whole: `axis (1 - w)` would round the narrow lobe to the grid round the
    // axis.
    let across = tangent * (sin_theta * cos_phi) + bitangent * (sin_theta * sin_phi);
    axis + (across - axis * w)
}

/// Inverts [`around`]: `w`, and the turns in [0, 1).
#[inline]
pub(crate) fn where_around(axis: Vec3, direction: Vec3) -> [f32; 2] {
    let chord = direction - axis;
    let (tangent, bitangent) = frame(axis);
    let turns = float::atan2(chord.dot(bitangent), chord.dot(tangent)) * (0.5 / PI);
    // Adding 1 to a tiny negative number would round to 1.
    let turns = if turns < 0.0 { (turns + 1.0).min(float::BELOW_ONE) } else { turns };
    [(0.5 * chord.length_squared()).min(2.0), turns]
}

/// Completes a unit vector to a right-handed frame, without a singular direction.
///
/// Source: Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
#[inline]
pub(crate) fn frame(n: Vec3) -> (Vec3, Vec3) {
    let sign = 1f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
}
