//! The unknowns of a fit: lobes at the stored views, and interpolation between them.
//!
//! A stored view has `Q + 3 + 5 K + M` unknowns: Q numbers of the squeeze; K angles of the axes in the plane of incidence, radians; M
//! angles of axes out of that plane; K `ln sharpness`; K logarithms of the luminance of the amplitude, K relative red differences and
//! K blue ones; and the same three numbers of the diffuse term. Lobe k of one stored view is lobe k of the next. Between stored
//! views the unknowns are interpolated as `srbf_core` does it with the same numbers, logarithms to base 2.
//!
//! A colour of luminance Y is `Y (1 + red difference)`, `Y (1 + blue difference)`, and the green that makes the luminance Y. So
//! channels may be negative, as those of measured colours outside the gamut of sRGB are, and the luminance never is.
//!
//! [`Views`] is what an isotropic fit and an anisotropic one do not have in common: where stored views stand.

use crate::family::matrix::Matrix;
use crate::family::tuning::layout::{COLORS, LN_AMPLITUDE, LN_SHARPNESS};
use crate::family::unit::{Unit, ViewSqueeze};
use crate::numeric::special::sphere_integral;
use crate::table::{View, luminance};
use std::f64::consts::LOG2_E;
use std::fmt::Debug;

/// Where the stored views of a fit stand: places, bounds, differences and shapes depend on it.
pub(crate) trait Views: Clone + Debug + PartialEq + Send + Sync {
    /// Where an outgoing direction lies among the stored views.
    type Place: Copy + Send + Sync;
    /// The matrix of a step: its blocks are where views lie beside each other.
    type Matrix: Matrix<Layout<Self>, Self::Place>;

    /// Bounds of the numbers of the squeeze, Q of them.
    const SQUEEZE: &'static [(f64, f64)];
    /// Bounds of the angles of axes in the plane of incidence, and out of it; radians.
    const ANGLE: (f64, f64);
    const OFF_PLANE: (f64, f64);
    /// Lobes of the mixture that a lobe with an angle out of the plane stands for.
    const COPIES: f64;
    /// Longest step of the solver.
    const LONGEST_STEP: f64;

    /// Stored views.
    fn count(&self) -> usize;
    /// The angle of the outgoing direction at a place.
    fn theta(&self, place: Self::Place) -> f64;
    /// Whether an unknown of a stored view is given, as 0.
    fn fixed(layout: &Layout<Self>, stored: usize, index: usize) -> bool;
    /// Bounds of single unknowns that a table makes closer. `bounds`: of all unknowns.
    fn narrow(_layout: &Layout<Self>, _table: &[(Self::Place, &View)], _bounds: &mut [(f64, f64)]) {}
    /// The value at a cosine, over the mean of a view, a share of which is noise to the tail.
    fn tail_floor(cos: f64) -> f64;
    /// Places at which an albedo is kept below a ceiling.
    fn watched(&self) -> Vec<Self::Place>;
    /// Interpolates the unknowns at a place.
    fn interpolate(layout: &Layout<Self>, x: &[f64], place: Self::Place, out: &mut [f64]);
    /// Calls with the terms (unknown, factor) of each residual of the roughness.
    fn differences(layout: &Layout<Self>, smoothness: f64, each: impl FnMut(&[(usize, f64)]));

    /// The squeeze of a view.
    fn squeeze(q: &[f64]) -> ViewSqueeze;
    /// The inverse of its matrix: xx, xy, yy.
    fn stretch(q: &[f64]) -> [f64; 3];
    /// A lobe of a view.
    fn unit(layout: &Layout<Self>, q: &[f64], k: usize, squeeze: &ViewSqueeze) -> Unit;
    /// The axis of a lobe, as the lobe sees directions, and two directions perpendicular to it and to each other.
    fn frame(layout: &Layout<Self>, q: &[f64], k: usize) -> [[f64; 3]; 3];
}

/// How many lobes there are, and where the stored views stand.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout<V> {
    /// Lobes, K, each counted once whatever it stands for.
    pub lobes: usize,
    /// Lobes that see the squeezed direction; they come first.
    pub squeezed: usize,
    /// Lobes with an angle out of the plane of incidence, M; they come last.
    pub aside: usize,
    pub views: V,
}

impl<V: Views> Layout<V> {
    /// Unknowns of a stored view.
    pub fn stride(&self) -> usize {
        self.squeezes() + 3 + 5 * self.lobes + self.aside
    }
    pub fn stored_views(&self) -> usize {
        self.views.count()
    }
    /// All unknowns.
    pub fn len(&self) -> usize {
        self.stride() * self.stored_views()
    }
    /// Numbers of the squeeze, which come first.
    pub const fn squeezes(&self) -> usize {
        V::SQUEEZE.len()
    }
    pub fn angle(&self, k: usize) -> usize {
        self.squeezes() + k
    }
    /// The angle out of the plane of incidence of the `m`-th lobe that has one.
    pub fn off_plane(&self, m: usize) -> usize {
        self.squeezes() + self.lobes + m
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
        self.angle(0)..self.off_plane(self.aside)
    }

    /// The first lobe with an angle out of the plane of incidence; K if there is none.
    pub fn first_aside(&self) -> usize {
        self.lobes - self.aside
    }

    /// Lobes of the mixture that a lobe stands for.
    pub fn copies(&self, k: usize) -> f64 {
        if k < self.first_aside() { 1.0 } else { V::COPIES }
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

    /// Multiplies lobes and diffuse term of a view by `exp(-less)`.
    pub fn darken(&self, q: &mut [f64], less: f64) {
        self.luminances().for_each(|i| q[i] -= less);
    }

    /// All unknowns with the channels that are kept scaled at every stored view, by the exponentials of factors of at most `most`.
    pub fn scaled(&self, x: &[f64], factors: &[Vec<f64>; 3], is_kept: [bool; 3], most: f64) -> Vec<f64> {
        let mut x = x.to_vec();
        for (stored, q) in x.chunks_exact_mut(self.stride()).enumerate() {
            let by = [0, 1, 2]
                .map(|c| if is_kept[c] { libm::exp(factors[c][stored].clamp(-most, most)) } else { 1.0 });
            for k in 0..=self.lobes {
                let color = rgb(self.tint(k).map(|i| q[i]));
                let scaled = [0, 1, 2].map(|c| color[c] * by[c]);
                // A lobe that would lose all luminance stays unchanged.
                if luminance(scaled) > 0.0 {
                    self.set_tint(q, k, scaled, 0.0);
                }
            }
        }
        x
    }

    /// The logarithm to base 2 of the luminance of lobe k, or the diffuse term, and its colour differences, as they are stored.
    pub fn stored_tint(&self, q: &[f64], k: usize) -> (f32, [f32; 2]) {
        let [luminance, red, blue] = self.tint(k).map(|i| q[i]);
        (stored_log2(luminance), [red as f32, blue as f32])
    }

    /// Least and greatest value of an unknown of any stored view.
    pub fn bounds(&self, index: usize) -> (f64, f64) {
        match index {
            _ if index < self.squeezes() => V::SQUEEZE[index],
            _ if index < self.off_plane(0) => V::ANGLE,
            _ if index < self.sharpness(0) => V::OFF_PLANE,
            _ if index < self.luminance(0) => LN_SHARPNESS,
            _ if self.is_color(index) => COLORS[self.color_difference(index)],
            _ => LN_AMPLITUDE,
        }
    }

    /// A change of an unknown that counts as one unit of roughness: fitted lobes change by about this from stored view to stored
    /// view.
    pub fn unit(&self, index: usize) -> f64 {
        match index {
            _ if index < self.squeezes() => 0.3,
            _ if index < self.angles().end => 0.15,
            _ if self.is_color(index) => 0.5,
            _ => 0.7,
        }
    }

    /// The angle of the outgoing direction at a place.
    pub fn theta(&self, place: V::Place) -> f64 {
        self.views.theta(place)
    }

    /// Interpolates the unknowns at a place.
    pub fn interpolate(&self, x: &[f64], place: V::Place, out: &mut [f64]) {
        V::interpolate(self, x, place, out);
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

/// A natural logarithm as it is stored, to base 2. A lobe of amplitude 0 has none.
pub(crate) fn stored_log2(ln: f64) -> f32 {
    ((ln * LOG2_E) as f32).max(-126.0)
}
