//! The axis of a surface that a turn changes.
//!
//! Facets of a brushed metal lean `along` times farther along its axis than the mean of both ways, and as much less across it. Their
//! distribution is an isotropic one whose slopes are stretched, so the model (`microfacet`) has one text: a pair of directions brings
//! the stretched lengths along ([`Pair`](super::pair::Pair)). A second lobe has a stretch of its own: none of a coat, the
//! inverse one of the second thread of a cloth.

use crate::table::Symmetry;
use std::f64::consts::PI;

/// Largest length of the leaning part of a half vector.
const MOST_LEAN: f64 = 0.9999;

/// The symmetry of a surface that a turn changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kept {
    /// Both mirrors, along the axis and across it.
    #[default]
    Mirrors,
    /// Half a turn.
    HalfTurn,
    /// Nothing.
    Nothing,
}

impl Kept {
    /// All of them, the most first.
    pub(super) const ALL: [Self; 3] = [Self::Mirrors, Self::HalfTurn, Self::Nothing];

    /// In words.
    pub fn text(self) -> &'static str {
        match self {
            Self::Mirrors => "mirrors along the axis and across it change nothing",
            Self::HalfTurn => "half a turn changes nothing",
            Self::Nothing => "no turn and no mirror leaves it as it is",
        }
    }
}

/// The axis, and how far facets lean along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Azimuth of the axis, radians: along it facets lean farthest.
    pub axis: f64,
    /// How much farther facets lean along it than the geometric mean of both ways; 1 and more.
    pub along: f64,
    /// The same of the second lobe of the model.
    pub second: f64,
    /// Its symmetry.
    pub kept: Kept,
    cos: f64,
    sin: f64,
}

impl Turn {
    /// With an axis, radians, and the stretches of both lobes along it.
    pub(super) fn new(axis: f64, along: f64, second: f64, kept: Kept) -> Self {
        let (sin, cos) = libm::sincos(axis);
        Self { axis, along, second, kept, cos, sin }
    }

    /// The same with an axis along which facets lean farther than across, from 0 to pi.
    pub(super) fn upright(self) -> Self {
        let Self { axis, along, second, kept, .. } = self;
        let (axis, along, second) =
            if along < 1.0 { (axis + 0.5 * PI, 1.0 / along, 1.0 / second) } else { (axis, along, second) };
        let axis = libm::fmod(libm::fmod(axis, PI) + PI, PI);
        Self::new(axis, along, second, kept)
    }

    /// Along the axis and across it.
    fn seen(&self, x: f64, y: f64) -> [f64; 2] {
        [x * self.cos + y * self.sin, y * self.cos - x * self.sin]
    }

    /// Squared length of what leans of a vector, as each lobe sees it.
    pub(super) fn lean2(&self, half: [f64; 3]) -> [f64; 2] {
        let [x, y] = self.seen(half[0], half[1]);
        [self.along, self.second].map(|s| (x / s) * (x / s) + (y * s) * (y * s))
    }

    /// The same of a direction that facets of the first lobe hide: wide facets hide more.
    pub(super) fn seen2(&self, d: [f64; 3]) -> f64 {
        let [x, y] = self.seen(d[0], d[1]);
        (x * self.along) * (x * self.along) + (y / self.along) * (y / self.along)
    }

    /// Twice the azimuth of a vector from the axis, as a vector of its squared length.
    pub(super) fn doubled(&self, v: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.seen(v[0], v[1]);
        [x * x - y * y, 2.0 * x * y]
    }

    /// The azimuth of a half vector as the first lobe sees it, as often as the symmetry asks for it: a unit vector, or 0.
    pub(super) fn azimuth(&self, half: [f64; 3]) -> [f64; 2] {
        let [x, y] = self.seen(half[0], half[1]);
        let [x, y] = [x / self.along, y * self.along];
        let v = if self.kept == Kept::Nothing { [x, y] } else { [x * x - y * y, 2.0 * x * y] };
        let length = libm::hypot(v[0], v[1]);
        if length > 1e-12 { v.map(|v| v / length) } else { [0.0; 2] }
    }

    /// The turn after which the azimuth of a half vector is the same, radians.
    pub(super) fn period(&self) -> f64 {
        if self.kept == Kept::Nothing { 2.0 * PI } else { PI }
    }

    /// A pair of directions. `lean`, `azimuth`: the leaning part of the half vector as the first lobe sees it. `difference`: the angle between
    /// half vector and direction. `way`: the azimuth of the way between both about the half vector.
    pub(super) fn directions(&self, lean: f64, azimuth: f64, difference: f64, way: f64) -> [[f64; 3]; 2] {
        let (s, c) = libm::sincos(azimuth);
        let [x, y] = [lean * c * self.along, lean * s / self.along];
        let length = libm::hypot(x, y);
        let shorter = if length > MOST_LEAN { MOST_LEAN / length } else { 1.0 };
        let [x, y] = [x * shorter, y * shorter];
        let [x, y] = [x * self.cos - y * self.sin, y * self.cos + x * self.sin];
        let half = [x, y, libm::sqrt(1.0 - x * x - y * y)];
        let [outward, aside] = self.frame(half, [s, c]);
        let ((s, c), (sin, cos)) = (libm::sincos(way), libm::sincos(difference));
        [1.0, -1.0]
            .map(|sign| [0, 1, 2].map(|k| cos * half[k] + sign * sin * (c * outward[k] + s * aside[k])))
    }

    /// The azimuths of [`directions`](Self::directions): of the way, and of the half vector.
    pub(super) fn angles(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 2] {
        let sum = [0, 1, 2].map(|k| wi[k] + wo[k]);
        let length = libm::sqrt(sum.iter().map(|v| v * v).sum::<f64>()).max(1e-12);
        let half = sum.map(|v| v / length);
        let [x, y] = self.seen(half[0], half[1]);
        let azimuth = libm::atan2(y * self.along, x / self.along);
        let (s, c) = libm::sincos(azimuth);
        let [outward, aside] = self.frame(half, [s, c]);
        let dot = |v: [f64; 3]| (0..3).map(|k| v[k] * (wi[k] - wo[k])).sum::<f64>();
        [libm::atan2(dot(aside), dot(outward)), azimuth]
    }

    /// Directions across a half vector: away from the normal, and aside. At the normal the azimuth says which.
    fn frame(&self, half: [f64; 3], [s, c]: [f64; 2]) -> [[f64; 3]; 2] {
        let [x, y, z] = half;
        let across = libm::hypot(x, y);
        let [c, s] = if across > 1e-9 {
            [x / across, y / across]
        } else {
            let (x, y) = (c * self.along, s / self.along);
            let length = libm::hypot(x, y);
            [(x * self.cos - y * self.sin) / length, (y * self.cos + x * self.sin) / length]
        };
        [[z * c, z * s, -across], [-s, c, 0.0]]
    }

    /// Coordinates without those whose sign a mirror changes.
    pub(super) fn kept(&self, [c, s, along, aside]: [f64; 4]) -> [f64; 4] {
        if self.kept == Kept::Mirrors { [c, 0.0, along, 0.0] } else { [c, s, along, aside] }
    }

    /// The symmetry that a fit may rely on; mirrors are those of the axis.
    pub fn symmetry(&self) -> Symmetry {
        match self.kept {
            Kept::Mirrors => Symmetry::Quadrant,
            Kept::HalfTurn => Symmetry::HalfTurn,
            Kept::Nothing => Symmetry::None,
        }
    }

    /// In words.
    pub fn text(&self) -> String {
        format!(
            "the highlight is {:.1} times as wide along an axis at {:.0} degrees as across it; {}",
            self.along * self.along,
            self.axis.to_degrees(),
            self.kept.text()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::direction;

    #[test]
    fn directions_come_back_from_their_angles() {
        for kept in Kept::ALL {
            for i in 0..500 {
                let n = f64::from(i);
                let turn = Turn::new(0.2 * n, 1.7, 1.0, kept);
                let (wi, wo) =
                    (direction(1.5 * (0.618 * n).fract(), n), direction(1.5 * (0.37 * n).fract(), 2.7 * n));
                let [way, azimuth] = turn.angles(wi, wo);
                let sum = [0, 1, 2].map(|k| wi[k] + wo[k]);
                let length = libm::sqrt(sum.iter().map(|v| v * v).sum());
                let lean = libm::sqrt(turn.lean2(sum)[0]) / length;
                let difference = libm::acos((0.5 * length).min(1.0));
                let again = turn.directions(lean, azimuth, difference, way);
                for k in 0..3 {
                    assert!((again[0][k] - wi[k]).abs() < 1e-7 && (again[1][k] - wo[k]).abs() < 1e-7, "{i}");
                }
            }
        }
    }
}
