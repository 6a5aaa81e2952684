//! A pair of directions in coordinates that are the same for (wi, wo) and (wo, wi).
//!
//! An isotropic and reciprocal BRDF is a function of three numbers. A smooth one of these here is close to what measurements are:
//! the angle of the half vector from the normal, spread where highlights are; half of the angle between the directions; the
//! product of their cosines; and the share by which the half vector leans sideways. Highlights are wider or narrower across the
//! plane of incidence than a function of the half vector alone has them.
//!
//! Of a surface that a turn changes there are four more, which [`Turn`] has. An isotropic surface is the case without a turn.

use super::turn::Turn;

/// Least cosine in a division.
pub(super) const HORIZON: f64 = 1e-3;

/// The coordinates of a pair, which need no surface.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pair {
    /// Cosines of incident and outgoing direction.
    pub cosines: [f64; 2],
    /// Cosine of the angle of the half vector from the normal, and square of the sine.
    pub cos_half: f64,
    pub sin2_half: f64,
    /// Cosine of the angle between half vector and direction, and square of the sine.
    pub cos_difference: f64,
    pub sin2_difference: f64,
    /// Square of the part of the half vector that leans out of the plane of the two directions, times `sin2_difference`.
    pub sideways: f64,
    /// How far the half vector leans as the first and the second lobe see it, squared: `sin2_half` where a turn changes nothing.
    pub lean2: [f64; 2],
    /// Squares of the sines of incident and outgoing direction as the facets of the first lobe see them.
    pub across2: [f64; 2],
    /// Half the outgoing direction's cosine less the incident one's; 0 where both may change places.
    pub toward: f64,
    /// Twice the azimuth of the half vector, and of the way between both directions: cosines and sines, the latter times
    /// `sin2_difference`. 0 where a turn changes nothing.
    pub turned: [f64; 4],
}

/// Coordinates in which the logarithm of a BRDF is smooth: the first ones of an isotropic surface, one more of a sheet whose sides
/// differ, all of a surface that a turn changes.
pub(crate) const COORDINATES: usize = 9;
pub(crate) const ISOTROPIC: usize = 4;
pub(super) const OF_SIDES: usize = 5;

/// Scale of the coordinate that tells sides apart: values vary little with it, and close points are taken together.
const SIDES: f64 = 0.25;

/// Squared sine of a direction with that cosine, at the horizon a little less.
fn across2(cos: f64) -> f64 {
    let c = cos.max(HORIZON);
    (1.0 - c * c).max(0.0)
}

impl Pair {
    /// Of unit vectors with z > 0, in any frame with +z the normal.
    pub fn new(wi: [f64; 3], wo: [f64; 3]) -> Self {
        let sum = [0, 1, 2].map(|k| wi[k] + wo[k]);
        let length2: f64 = sum.iter().map(|v| v * v).sum::<f64>().max(1e-12);
        let apart2: f64 = (0..3).map(|k| (wi[k] - wo[k]) * (wi[k] - wo[k])).sum();
        let across = wi[0] * wo[1] - wi[1] * wo[0];
        let cos2_difference = 0.25 * length2;
        let sin2_half = (sum[0] * sum[0] + sum[1] * sum[1]) / length2;
        Self {
            cosines: [wi[2], wo[2]],
            cos_half: (sum[2] / libm::sqrt(length2)).min(1.0),
            sin2_half,
            lean2: [sin2_half; 2],
            across2: [across2(wi[2]), across2(wo[2])],
            toward: 0.0,
            turned: [0.0; 4],
            cos_difference: libm::sqrt(cos2_difference).min(1.0),
            sin2_difference: 0.25 * apart2,
            sideways: 0.25 * across * across / cos2_difference,
        }
    }

    /// Of unit vectors with z > 0 in the frame of a surface that a turn changes.
    pub fn turned(wi: [f64; 3], wo: [f64; 3], turn: &Turn) -> Self {
        let half = [0, 1, 2].map(|k| wi[k] + wo[k]);
        let length2: f64 = half.iter().map(|v| v * v).sum::<f64>().max(1e-12);
        let pair = Self::new(wi, wo);
        let apart = [wi[0] - wo[0], wi[1] - wo[1]];
        let [a, b] = turn.doubled(apart);
        let [c, s] = turn.azimuth(half);
        let length = libm::hypot(a, b);
        let way = if length > 1e-12 { [a / length, b / length] } else { [0.0; 2] };
        Self {
            lean2: turn.lean2(half).map(|v| v / length2),
            across2: [turn.seen2(wi), turn.seen2(wo)],
            turned: turn.kept([c, s, pair.sin2_difference * way[0], pair.sin2_difference * way[1]]),
            ..pair
        }
    }

    /// From angles: the half vector's from the normal and the direction's from the half vector, radians. Then the cosine of the azimuth of
    /// the outgoing direction about the half vector, from the normal.
    pub fn from_angles(half: f64, difference: f64, cos_toward: f64) -> Self {
        let pair = Self::from_share(half, difference, 1.0 - cos_toward * cos_toward);
        if cos_toward < 0.0 {
            return pair;
        }
        let ([i, o], [of_i, of_o]) = (pair.cosines, pair.across2);
        Self { cosines: [o, i], across2: [of_o, of_i], ..pair }
    }

    /// The same with the share of the half vector that leans sideways, 0 to 1; the incident direction is the higher one.
    pub fn from_share(half: f64, difference: f64, sideways: f64) -> Self {
        let ((sin_half, cos_half), (sin_difference, cos_difference)) =
            (libm::sincos(half), libm::sincos(difference));
        let along = sin_half * sin_difference * libm::sqrt((1.0 - sideways).max(0.0));
        let mean = cos_half * cos_difference;
        let (cosines, sin2_half) = ([mean + along, mean - along], sin_half * sin_half);
        Self {
            cosines,
            cos_half,
            sin2_half,
            lean2: [sin2_half; 2],
            across2: cosines.map(across2),
            toward: 0.0,
            turned: [0.0; 4],
            cos_difference,
            sin2_difference: sin_difference * sin_difference,
            sideways: sideways * sin_half * sin_half * sin_difference * sin_difference,
        }
    }

    /// The coordinates; `width`: sine of the angle of the half vector up to which they are even.
    pub fn coordinates(&self, width: f64) -> [f64; COORDINATES] {
        let [c, s, along, aside] = self.turned;
        // At the normal the half vector has no azimuth.
        let share = self.lean2[0] / (self.lean2[0] + width * width);
        [
            self.spread_half(width),
            self.difference(),
            self.cosines[0] * self.cosines[1],
            2.0 * self.sideways / (self.sin2_half + width * width),
            SIDES * self.toward / libm::sqrt(self.sin2_half + width * width),
            share * c,
            share * s,
            along,
            aside,
        ]
    }

    /// The angle of the half vector, even up to `width` and by its logarithm beyond.
    pub fn spread_half(&self, width: f64) -> f64 {
        libm::asinh(libm::sqrt(self.lean2[0]) / width)
    }

    /// The same of a sheet whose sides differ, so that both directions do not change places.
    pub fn told_apart(self) -> Self {
        Self { toward: 0.5 * (self.cosines[1] - self.cosines[0]), ..self }
    }

    /// Cosine of the azimuth of the outgoing direction about the half vector, from the normal; 0 where there is none.
    pub fn cos_toward(&self) -> f64 {
        let all = self.sin2_half * self.sin2_difference;
        if all > 1e-18 { (self.toward / libm::sqrt(all)).clamp(-1.0, 1.0) } else { 0.0 }
    }

    /// Angle between half vector and direction, radians.
    pub fn difference(&self) -> f64 {
        libm::atan2(libm::sqrt(self.sin2_difference), self.cos_difference)
    }

    /// Share of the half vector that leans sideways, 0 to 1; anything where it does not lean, or where there is no plane.
    pub fn share_sideways(&self) -> f64 {
        let all = self.sin2_half * self.sin2_difference;
        if all > 1e-18 { (self.sideways / all).clamp(0.0, 1.0) } else { 0.5 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::complete::turn::Kept;
    use crate::table::direction;

    #[test]
    fn a_pair_is_the_same_both_ways_whatever_the_frame_and_from_its_angles() {
        for i in 0..2000 {
            let n = f64::from(i);
            let (wi, wo) =
                (direction(1.5 * (0.618 * n).fract(), n), direction(1.5 * (0.37 * n).fract(), 2.7 * n));
            let (there, back) = (Pair::new(wi, wo).coordinates(0.1), Pair::new(wo, wi).coordinates(0.1));
            assert!((0..COORDINATES).all(|k| (there[k] - back[k]).abs() < 1e-12), "{there:?} {back:?}");
            let pair = Pair::new(wi, wo);
            let half = libm::atan2(libm::sqrt(pair.sin2_half), pair.cos_half);
            let again = Pair::from_share(half, pair.difference(), pair.share_sideways()).coordinates(0.1);
            assert!((0..COORDINATES).all(|k| (there[k] - again[k]).abs() < 1e-9), "{there:?} {again:?}");
        }
    }

    #[test]
    fn a_turned_pair_is_the_same_both_ways_and_without_a_stretch_an_isotropic_one() {
        for i in 0..2000 {
            let n = f64::from(i);
            let (wi, wo) =
                (direction(1.5 * (0.618 * n).fract(), n), direction(1.5 * (0.37 * n).fract(), 2.7 * n));
            let turn = Turn::new(0.3 * n, 2.0, 0.7, Kept::Nothing);
            let [there, back] = [Pair::turned(wi, wo, &turn), Pair::turned(wo, wi, &turn)];
            let [a, b] = [there, back].map(|p| p.coordinates(0.1));
            assert!((0..COORDINATES).all(|k| (a[k] - b[k]).abs() < 1e-9), "{a:?} {b:?}");
            let even = Pair::turned(wi, wo, &Turn::new(0.3 * n, 1.0, 1.0, Kept::Nothing));
            let plain = Pair::new(wi, wo);
            assert!((even.lean2[0] - plain.lean2[0]).abs() < 1e-12, "{even:?} {plain:?}");
            assert!((0..2).all(|k| (even.across2[k] - plain.across2[k]).abs() < 1e-12), "{even:?} {plain:?}");
            // Half a turn, and a mirror, leave coordinates as they are.
            for (kept, mirror) in [(Kept::HalfTurn, [-1.0, -1.0]), (Kept::Mirrors, [1.0, -1.0])] {
                let turn = Turn::new(0.0, 2.0, 0.7, kept);
                let moved = |d: [f64; 3]| [mirror[0] * d[0], mirror[1] * d[1], d[2]];
                let [a, b] = [Pair::turned(wi, wo, &turn), Pair::turned(moved(wi), moved(wo), &turn)]
                    .map(|p| p.coordinates(0.1));
                assert!((0..COORDINATES).all(|k| (a[k] - b[k]).abs() < 1e-9), "{a:?} {b:?}");
            }
        }
    }
}
