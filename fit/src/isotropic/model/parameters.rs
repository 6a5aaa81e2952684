//! The unknowns of a fit: lobes at the knots, and what lies between.
//!
//! A knot has `4 + 5 K + M` unknowns: `ln c`, K angles of the axes in radians, M angles of the axes of mirrored lobes out of the
//! plane of incidence, K `ln sharpness`, K `ln amplitude` per channel, and per channel the logarithm of the albedo of the
//! diffuse term. Lobe k of one knot is lobe k of the next; between knots everything is interpolated linearly in the angle of
//! the outgoing direction, as `srbf_core` does it with the same numbers as base-2 logarithms.

use crate::numeric::special::sphere_integral;
use std::f64::consts::FRAC_PI_2;

/// How many lobes there are, and where the knots lie.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    /// Lobes, K, mirrored ones counted once.
    pub lobes: usize,
    /// Lobes that see the squeezed direction; they come first.
    pub squeezed: usize,
    /// Lobes that stand for two, M, one on either side of the plane of incidence; they come last.
    pub mirrored: usize,
    /// Whether the last lobe in the plane of incidence is kept wide, so that no direction has a small density.
    pub is_last_wide: bool,
    /// Angles of the knots in radians, from 0 rising to at most pi / 2.
    pub knots: Vec<f64>,
}

/// Bounds of the unknowns of a kind: what a material can store, and no wider than fits need.
const ANGLE: (f64, f64) = (-1.8, 2.2);
const OFF_PLANE: (f64, f64) = (0.0, 1.55);
const LN_SQUEEZE: (f64, f64) = (-4.5, 0.69);
const LN_SHARPNESS: (f64, f64) = (-3.0, 14.0);
const LN_AMPLITUDE: (f64, f64) = (-40.0, 30.0);

/// Bounds of the defensive lobe: nowhere on the hemisphere is it below a fiftieth of its peak. A sharpness of at most 1 would
/// bound it better, but fits garnet red to 1.7 % in place of 1.6 %.
const ANGLE_DEFENSIVE: (f64, f64) = (-0.6, 0.6);
pub(crate) const LN_SHARPNESS_DEFENSIVE: (f64, f64) = (-3.0, 1.0);

impl Layout {
    /// A layout of `lobes` lobes, of which `squeezed` are squeezed and `mirrored` stand for two. One is kept wide if two or more in
    /// the plane of incidence are round.
    pub fn new(lobes: usize, squeezed: usize, mirrored: usize, knots: Vec<f64>) -> Self {
        Self { lobes, squeezed, mirrored, is_last_wide: lobes - mirrored >= squeezed + 2, knots }
    }

    /// Unknowns of a knot.
    pub fn stride(&self) -> usize {
        4 + 5 * self.lobes + self.mirrored
    }
    /// All unknowns.
    pub fn len(&self) -> usize {
        self.stride() * self.knots.len()
    }
    pub fn angle(&self, k: usize) -> usize {
        1 + k
    }
    /// The angle out of the plane of incidence of the `m`-th mirrored lobe.
    pub fn off_plane(&self, m: usize) -> usize {
        1 + self.lobes + m
    }
    pub fn sharpness(&self, k: usize) -> usize {
        self.angles().end + k
    }
    pub fn amplitude(&self, channel: usize, k: usize) -> usize {
        self.angles().end + (1 + channel) * self.lobes + k
    }

    /// All angles of axes.
    pub fn angles(&self) -> std::ops::Range<usize> {
        1..1 + self.lobes + self.mirrored
    }

    /// The first mirrored lobe; K if there is none.
    pub fn first_mirrored(&self) -> usize {
        self.lobes - self.mirrored
    }

    /// Lobes of the mixture that a lobe stands for.
    pub fn copies(&self, k: usize) -> f64 {
        if k < self.first_mirrored() { 1.0 } else { 2.0 }
    }

    /// The logarithm of the albedo of a channel's diffuse term.
    pub fn diffuse(&self, channel: usize) -> usize {
        self.angles().end + 4 * self.lobes + channel
    }

    /// Whether an unknown of a knot is given: at the normal every axis is the normal and nothing is squeezed.
    pub fn fixed(&self, knot: usize, index: usize) -> bool {
        knot == 0 && index < self.angles().end
    }

    /// The lobe that is kept wide.
    pub fn defensive(&self) -> Option<usize> {
        self.is_last_wide.then(|| self.first_mirrored() - 1)
    }

    /// The layout and unknowns with a squeezed lobe given up for a wide and weak one, unless there is one that is kept wide.
    pub fn widened(&self, x: &[f64], given_up: usize) -> Option<(Self, Vec<f64>)> {
        if self.is_last_wide || given_up >= self.squeezed {
            return None;
        }
        let new = Self { squeezed: self.squeezed - 1, is_last_wide: true, ..self.clone() };
        let wide = new.first_mirrored() - 1;
        let mut moved = x.to_vec();
        for q in moved.chunks_exact_mut(self.stride()) {
            for first in
                [self.angle(0), self.sharpness(0)].into_iter().chain((0..3).map(|c| self.amplitude(c, 0)))
            {
                q[first + given_up..=first + wide].rotate_left(1);
            }
            q[self.angle(wide)] = 0.0;
            q[self.sharpness(wide)] = LN_SHARPNESS_DEFENSIVE.1;
            (0..3).for_each(|c| q[self.amplitude(c, wide)] = LN_AMPLITUDE.0);
        }
        Some((new, moved))
    }

    /// Least and greatest value of an unknown.
    pub fn bounds(&self, index: usize) -> (f64, f64) {
        match index {
            0 => LN_SQUEEZE,
            _ if self.defensive().is_some_and(|k| index == self.angle(k)) => ANGLE_DEFENSIVE,
            _ if self.defensive().is_some_and(|k| index == self.sharpness(k)) => LN_SHARPNESS_DEFENSIVE,
            _ if index <= self.lobes => ANGLE,
            _ if index < self.angles().end => OFF_PLANE,
            _ if index < self.amplitude(0, 0) => LN_SHARPNESS,
            _ => LN_AMPLITUDE,
        }
    }

    /// A change of an unknown that counts as one unit of roughness: fitted lobes change by about this from knot to knot.
    pub fn unit(&self, index: usize) -> f64 {
        match index {
            0 => 0.3,
            _ if index < self.angles().end => 0.15,
            _ => 0.7,
        }
    }

    /// The knot before an angle of the outgoing direction, and how far towards the next one it lies, 0 to 1.
    pub fn place(&self, theta: f64) -> (usize, f64) {
        let last = self.knots.len() - 1;
        if last == 0 {
            return (0, 0.0);
        }
        let after = self.knots.partition_point(|&k| k <= theta).clamp(1, last);
        let (from, to) = (self.knots[after - 1], self.knots[after]);
        (after - 1, ((theta - from) / (to - from)).clamp(0.0, 1.0))
    }

    /// Interpolates the unknowns at a place.
    pub fn interpolate(&self, x: &[f64], (knot, blend): (usize, f64), out: &mut [f64]) {
        let p = self.stride();
        let before = &x[knot * p..(knot + 1) * p];
        if blend == 0.0 {
            out.copy_from_slice(before);
            return;
        }
        let after = &x[(knot + 1) * p..(knot + 2) * p];
        for (out, (a, b)) in out.iter_mut().zip(before.iter().zip(after)) {
            *out = a + blend * (b - a);
        }
    }

    /// The unknowns at the knots of another layout of the same lobes.
    pub fn resampled(&self, x: &[f64], other: &Self) -> Vec<f64> {
        let mut new = vec![0.0; other.len()];
        for (q, theta) in new.chunks_exact_mut(other.stride()).zip(&other.knots) {
            self.interpolate(x, self.place(*theta), q);
        }
        new
    }

    /// Albedo of interpolated unknowns, the closed form `sum a I(s)`.
    pub fn albedo(&self, q: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for k in 0..self.lobes {
            let (integral, _) = sphere_integral(q[self.sharpness(k)]);
            for (c, s) in sum.iter_mut().enumerate() {
                *s += libm::exp(q[self.amplitude(c, k)]) * self.copies(k) * integral;
            }
        }
        for (c, s) in sum.iter_mut().enumerate() {
            *s += libm::exp(q[self.diffuse(c)]);
        }
        sum
    }

    /// Knots at the angles of a table's views, at the normal and at the horizon.
    ///
    /// Views closer together than `least`, or than that to either end, share a knot.
    pub fn knots_at(thetas: impl Iterator<Item = f64>, least: f64) -> Vec<f64> {
        let mut knots = vec![0.0];
        for theta in thetas {
            if theta - knots[knots.len() - 1] >= least && FRAC_PI_2 - theta >= least {
                knots.push(theta);
            }
        }
        knots.push(FRAC_PI_2);
        knots
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_between_their_knots() {
        let knots = Layout::knots_at([0.0, 0.02, 0.5, 0.51, 1.56].into_iter(), 0.03);
        let layout = Layout::new(1, 0, 0, knots);
        assert_eq!(layout.knots, [0.0, 0.5, FRAC_PI_2]);
        assert_eq!(layout.place(0.0), (0, 0.0));
        assert_eq!(layout.place(0.25), (0, 0.5));
        assert_eq!(layout.place(0.5), (1, 0.0));
        assert_eq!(layout.place(2.0), (1, 1.0));
    }

    #[test]
    fn a_squeezed_lobe_makes_room_for_a_wide_one() {
        let layout = |lobes, squeezed, mirrored| Layout::new(lobes, squeezed, mirrored, vec![0.0, 1.0]);
        let old = layout(5, 3, 1);
        let x: Vec<f64> = (0..old.len()).map(|i| i as f64).collect();
        let (new, moved) = old.widened(&x, 1).unwrap();
        assert!(old.defensive().is_none() && new == layout(5, 2, 1) && new.defensive() == Some(3));
        let p = old.stride();
        for (from, to) in [(0, 0), (2, 1), (3, 2), (4, 4)] {
            assert_eq!(moved[p + new.angle(to)], x[p + old.angle(from)]);
            assert_eq!(moved[p + new.sharpness(to)], x[p + old.sharpness(from)]);
            assert_eq!(moved[p + new.amplitude(2, to)], x[p + old.amplitude(2, from)]);
        }
        assert_eq!((moved[p + new.angle(3)], moved[p + new.sharpness(3)]), (0.0, 1.0));
        assert_eq!((moved[p], moved[p + new.off_plane(0)]), (x[p], x[p + old.off_plane(0)]));
        // None is left in the plane but the wide one.
        let lonely = layout(2, 1, 1);
        let (new, _) = lonely.widened(&vec![0.0; lonely.len()], 0).unwrap();
        assert!(lonely.defensive().is_none() && new.squeezed == 0 && new.defensive() == Some(0));
        assert!(layout(4, 1, 0).widened(&[], 0).is_none() && layout(4, 0, 4).widened(&[], 0).is_none());
    }

    #[test]
    fn at_other_knots_the_unknowns_are_what_lies_between() {
        let layout = |knots| Layout::new(1, 0, 0, knots);
        let (old, new) = (layout(vec![0.0, 0.4, 1.0]), layout(vec![0.0, 0.2, 0.7, 1.0]));
        let x: Vec<f64> = (0..old.len()).map(|i| (i * i) as f64).collect();
        let at = |x: &[f64], knot: usize, index: usize| x[knot * old.stride() + index];
        let found = old.resampled(&x, &new);
        for i in 0..old.stride() {
            let between = |knot: usize| 0.5 * (at(&x, knot, i) + at(&x, knot + 1, i));
            let expected = [at(&x, 0, i), between(0), between(1), at(&x, 2, i)];
            for (knot, value) in expected.into_iter().enumerate() {
                assert!((at(&found, knot, i) - value).abs() < 1e-9, "{knot} {i}: {found:?}");
            }
        }
    }
}
