//! Outgoing directions as the views lie: by their angle from the normal and their azimuth.

use crate::simd::elementary::atan2_positive;
use crate::simd::lanes::{Lanes, splat3};
use glam::Vec3;

/// One outgoing direction.
pub(crate) struct Outgoing {
    pub wo: Vec3,
    /// Angle from the normal, radians.
    pub theta: f32,
    /// Cosine and sine, in the caller's frame, of the azimuth of +x of the view.
    pub azimuth: [f32; 2],
}

/// Outgoing directions as angle from the normal and azimuth; anything for a vector that is no unit vector above the horizon.
pub(crate) struct Facing<L: Lanes> {
    pub theta: L,
    /// Cosine and sine, in the caller's frame, of the azimuth of +x of the view.
    pub azimuth: [L; 2],
    /// The same, of any length.
    #[cfg(feature = "simd")]
    pub away: [L; 2],
    /// A unit vector, and one above the horizon.
    unit: L::Mask,
    there: L::Mask,
}

impl<L: Lanes> Facing<L> {
    #[inline(always)]
    pub fn new([x, y, z]: [L; 3]) -> Self {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let across_squared = x * x + y * y;
        let off = (across_squared + z * z - one).abs();
        // Not set for a NaN.
        let unit = L::splat(2e-3).ge(off);
        let across = across_squared.sqrt();
        // +x of the view points away from wo, towards the mirror direction; at the normal any azimuth serves,
        // and the square of a distance below 1e-19 from it has lost its digits.
        let inverse = one / across;
        let is_tilted = across_squared.ge(L::splat(f32::MIN_POSITIVE));
        Self {
            theta: atan2_positive(across, z),
            azimuth: [
                L::select(is_tilted, (zero - x) * inverse, one),
                L::select(is_tilted, (zero - y) * inverse, zero),
            ],
            #[cfg(feature = "simd")]
            away: [L::select(is_tilted, zero - x, one), L::select(is_tilted, zero - y, zero)],
            unit,
            there: L::both(unit, z.ge(zero)),
        }
    }

    /// The unit vectors above the horizon.
    #[inline(always)]
    pub fn is_there(&self) -> L::Mask {
        self.there
    }

    /// The unit vectors.
    #[cfg(feature = "simd")]
    #[inline(always)]
    pub fn is_unit(&self) -> L::Mask {
        self.unit
    }

    /// The first lane, which is of `wo`; `None` if that is no unit vector.
    #[inline(always)]
    pub fn first(&self, wo: Vec3) -> Option<Outgoing> {
        let azimuth = [self.azimuth[0].first(), self.azimuth[1].first()];
        (L::bits(self.unit) & 1 == 1).then(|| Outgoing { wo, theta: self.theta.first(), azimuth })
    }
}

/// One outgoing direction, `None` for a vector that is no unit vector: in one number, but in a vector where only that has
/// fused operations, so that it has the same bits as one of many.
#[inline(always)]
pub(crate) fn facing<L: Lanes>(wo: Vec3) -> Option<Outgoing> {
    let numbers = wo.to_array();
    if L::FUSED && !L::One::FUSED {
        Facing::<L>::new(splat3(numbers)).first(wo)
    } else {
        Facing::<L::One>::new(splat3(numbers)).first(wo)
    }
}
