//! The unknowns of a fit: lobes at the stored views, and interpolation between them.
//!
//! A stored view has `4 + 5 K + M` unknowns: `ln c`; K angles of the axes in radians; M angles of the axes of mirrored lobes out
//! of the plane of incidence; K `ln sharpness`; K logarithms of the luminance of the amplitude, K relative red differences and K
//! blue ones; and the same three numbers of the diffuse term. Lobe k of one stored view is lobe k of the next; between stored
//! views everything is interpolated linearly in the angle of the outgoing direction, as `srbf_core` does it with the same numbers,
//! logarithms to base 2.
//!
//! A colour of luminance Y is `Y (1 + red difference)`, `Y (1 + blue difference)`, and the green that makes the luminance Y. So
//! channels may be negative, as those of measured colours outside the gamut of sRGB are, and the luminance never is.

use crate::isotropic::tuning::parameters::{
    ANGLE, ANGLE_DEFENSIVE, COLORS, LN_AMPLITUDE, LN_SHARPNESS, LN_SHARPNESS_DEFENSIVE, LN_SQUEEZE, OFF_PLANE,
};
use crate::isotropic::tuning::stored_views::NEAR_NORMAL;
use crate::numeric::special::sphere_integral;
use crate::table::luminance;

/// How many lobes there are, and where the stored views lie.
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
    /// Angles of the stored views in radians, from 0 rising to at most pi / 2.
    pub view_angles: Vec<f64>,
}

impl Layout {
    /// A layout of `lobes` lobes, of which `squeezed` are squeezed and `mirrored` stand for two. One is kept wide if two or more in
    /// the plane of incidence are round.
    pub fn new(lobes: usize, squeezed: usize, mirrored: usize, view_angles: Vec<f64>) -> Self {
        Self { lobes, squeezed, mirrored, is_last_wide: lobes - mirrored >= squeezed + 2, view_angles }
    }

    /// Unknowns of a stored view.
    pub fn stride(&self) -> usize {
        4 + 5 * self.lobes + self.mirrored
    }
    /// All unknowns.
    pub fn len(&self) -> usize {
        self.stride() * self.view_angles.len()
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
    /// The logarithm of the luminance of a lobe's amplitude.
    pub fn luminance(&self, k: usize) -> usize {
        self.angles().end + self.lobes + k
    }
    /// A lobe's relative red (0) or blue (1) difference.
    pub fn color(&self, difference: usize, k: usize) -> usize {
        self.angles().end + (2 + difference) * self.lobes + k
    }
    /// Which of the two a colour difference is, red or blue.
    pub fn color_difference(&self, index: usize) -> usize {
        if index > self.diffuse() {
            index - self.diffuse() - 1
        } else {
            usize::from(index >= self.color(1, 0))
        }
    }

    /// The colour differences of lobes and diffuse term.
    pub fn is_color(&self, index: usize) -> bool {
        index >= self.color(0, 0) && index != self.diffuse()
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

    /// The logarithm of the luminance of the albedo of the diffuse term; its colour differences follow.
    pub fn diffuse(&self) -> usize {
        self.angles().end + 4 * self.lobes
    }

    /// Luminance and colour differences of lobe k, or, for K, of the diffuse term.
    pub fn tint(&self, k: usize) -> [usize; 3] {
        if k == self.lobes {
            [0, 1, 2].map(|i| self.diffuse() + i)
        } else {
            [self.luminance(k), self.color(0, k), self.color(1, k)]
        }
    }

    /// All logarithms of luminances at a stored view.
    pub fn luminances(&self) -> impl Iterator<Item = usize> {
        (0..=self.lobes).map(|k| self.tint(k)[0])
    }

    /// Amplitudes of the lobes and of the diffuse term, per channel.
    pub fn amplitudes(&self, q: &[f64]) -> [Vec<f64>; 3] {
        let mut amplitudes = [(); 3].map(|()| Vec::with_capacity(self.lobes + 1));
        for k in 0..=self.lobes {
            let rgb = rgb(self.tint(k).map(|i| q[i]));
            (0..3).for_each(|c| amplitudes[c].push(rgb[c]));
        }
        amplitudes
    }

    /// Sets luminance and colour of lobe k, or the diffuse term, to a colour; to `least` if its luminance is less.
    pub fn set_tint(&self, q: &mut [f64], k: usize, color: [f64; 3], least: f64) {
        let luminance = luminance(color);
        let [y, red, blue] = self.tint(k);
        q[y] = libm::log(luminance.max(least));
        if luminance > 0.0 {
            q[red] = (color[0] / luminance - 1.0).clamp(COLORS[0].0, COLORS[0].1);
            q[blue] = (color[2] / luminance - 1.0).clamp(COLORS[1].0, COLORS[1].1);
        }
    }

    /// Whether an unknown of a stored view is given: at the normal every axis is the normal and nothing is squeezed.
    pub fn fixed(&self, stored: usize, index: usize) -> bool {
        stored == 0 && index < self.angles().end
    }

    /// The stored view from which on unknowns change slowly: not the normal itself, if the next is close to it.
    pub fn first_smooth(&self) -> usize {
        let is_close = self.view_angles.len() > 2 && self.view_angles[1] < 1.5 * NEAR_NORMAL.to_radians();
        usize::from(is_close)
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
            let rows =
                [self.angle(0), self.sharpness(0), self.luminance(0), self.color(0, 0), self.color(1, 0)];
            for first in rows {
                q[first + given_up..=first + wide].rotate_left(1);
            }
            q[self.angle(wide)] = 0.0;
            q[self.sharpness(wide)] = LN_SHARPNESS_DEFENSIVE.1;
            let [luminance, red, blue] = self.tint(wide);
            (q[luminance], q[red], q[blue]) = (LN_AMPLITUDE.0, 0.0, 0.0);
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
            _ if index < self.luminance(0) => LN_SHARPNESS,
            _ if self.is_color(index) => COLORS[self.color_difference(index)],
            _ => LN_AMPLITUDE,
        }
    }

    /// A change of an unknown that counts as one unit of roughness: fitted lobes change by about this from stored view to stored
    /// view.
    pub fn unit(&self, index: usize) -> f64 {
        match index {
            0 => 0.3,
            _ if index < self.angles().end => 0.15,
            _ if self.is_color(index) => 0.5,
            _ => 0.7,
        }
    }

    /// The stored view before an angle of the outgoing direction, and how far towards the next one it lies, 0 to 1.
    pub fn place(&self, theta: f64) -> (usize, f64) {
        let last = self.view_angles.len() - 1;
        if last == 0 {
            return (0, 0.0);
        }
        let after = self.view_angles.partition_point(|&k| k <= theta).clamp(1, last);
        let (from, to) = (self.view_angles[after - 1], self.view_angles[after]);
        (after - 1, ((theta - from) / (to - from)).clamp(0.0, 1.0))
    }

    /// The angle of the outgoing direction at a place.
    pub fn theta(&self, (stored, blend): (usize, f64)) -> f64 {
        let after = self.view_angles[(stored + 1).min(self.view_angles.len() - 1)];
        self.view_angles[stored] + blend * (after - self.view_angles[stored])
    }

    /// Interpolates the unknowns at a place.
    pub fn interpolate(&self, x: &[f64], (stored, blend): (usize, f64), out: &mut [f64]) {
        let p = self.stride();
        let before = &x[stored * p..(stored + 1) * p];
        if blend == 0.0 {
            out.copy_from_slice(before);
            return;
        }
        let after = &x[(stored + 1) * p..(stored + 2) * p];
        for (out, (a, b)) in out.iter_mut().zip(before.iter().zip(after)) {
            *out = a + blend * (b - a);
        }
    }

    /// The unknowns at the stored views of another layout of the same lobes.
    pub fn resampled(&self, x: &[f64], other: &Self) -> Vec<f64> {
        let mut new = vec![0.0; other.len()];
        for (q, theta) in new.chunks_exact_mut(other.stride()).zip(&other.view_angles) {
            self.interpolate(x, self.place(*theta), q);
        }
        new
    }

    /// Albedo of interpolated unknowns: `sum a I(s)` in closed form, each lobe, and last the diffuse term, times the mean of the
    /// factors that it sees, if there are any.
    pub fn albedo(&self, q: &[f64], factors: Option<&[[f64; 3]]>) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for k in 0..=self.lobes {
            let integral =
                if k < self.lobes { self.copies(k) * sphere_integral(q[self.sharpness(k)]).0 } else { 1.0 };
            let rgb = rgb(self.tint(k).map(|i| q[i]));
            let factor = factors.map_or([1.0; 3], |factors| factors[k]);
            (0..3).for_each(|c| sum[c] += rgb[c] * integral * factor[c]);
        }
        sum
    }
}

/// What red, green and blue of a colour of luminance 1 change by with its red and its blue difference.
pub(crate) const COLOR_SLOPES: [[f64; 3]; 2] = [[1.0, -0.2126 / 0.7152, 0.0], [0.0, -0.0722 / 0.7152, 1.0]];

/// The colour of a logarithm of the luminance and two relative colour differences.
pub(crate) fn rgb([ln_luminance, red, blue]: [f64; 3]) -> [f64; 3] {
    let [by_red, by_blue] = COLOR_SLOPES;
    let y = libm::exp(ln_luminance);
    [0, 1, 2].map(|c| y * (1.0 + red * by_red[c] + blue * by_blue[c]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn places_are_between_their_stored_views() {
        let layout = Layout::new(1, 0, 0, vec![0.0, 0.5, FRAC_PI_2]);
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
            assert_eq!(moved[p + new.color(1, to)], x[p + old.color(1, from)]);
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
    fn at_other_views_the_unknowns_are_interpolated() {
        let layout = |view_angles| Layout::new(1, 0, 0, view_angles);
        let (old, new) = (layout(vec![0.0, 0.4, 1.0]), layout(vec![0.0, 0.2, 0.7, 1.0]));
        let x: Vec<f64> = (0..old.len()).map(|i| (i * i) as f64).collect();
        let at = |x: &[f64], stored: usize, index: usize| x[stored * old.stride() + index];
        let found = old.resampled(&x, &new);
        for i in 0..old.stride() {
            let between = |stored: usize| 0.5 * (at(&x, stored, i) + at(&x, stored + 1, i));
            let expected = [at(&x, 0, i), between(0), between(1), at(&x, 2, i)];
            for (stored, value) in expected.into_iter().enumerate() {
                assert!((at(&found, stored, i) - value).abs() < 1e-9, "{stored} {i}: {found:?}");
            }
        }
    }
}
