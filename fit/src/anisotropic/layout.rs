//! The unknowns of an anisotropic fit: lobes at stored views over the hemisphere, and interpolation between them.
//!
//! Stored view 0 is the normal; then ring by ring, each with the same number of azimuths. A stored view has `6 + 6 K` unknowns:
//! the logarithm of the squeeze matrix (xx, xy, yy), logarithm of the luminance and two relative colour differences of the diffuse
//! albedo; K tilts of the axes along the plane of incidence, K across it; K `ln sharpness`; of the amplitudes K logarithms of the
//! luminance, K red and K blue differences. Between stored views `srbf_core` interpolates them as is done here; see
//! `core/src/kernel/prepare_anisotropic.rs`, which also says why that is continuous at the normal.

use crate::anisotropic::tuning::layout::{LN_AMPLITUDE, LN_SHARPNESS, SHEAR, SQUEEZE, TILT};
use crate::family::layout::rgb;
use crate::isotropic::tuning::parameters::COLORS;
use crate::numeric::special::sphere_integral;
use crate::table::luminance;
use std::f64::consts::{PI, TAU};

/// How many lobes there are, and where the stored views lie.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// Lobes, K.
    pub lobes: usize,
    /// Lobes that see the squeezed direction; they come first.
    pub squeezed: usize,
    /// Angles of the rings from the normal, radians; the first is 0, the normal itself.
    pub thetas: Vec<f64>,
    /// Stored views of a ring.
    pub azimuths: usize,
    /// How often a ring is repeated over the full turn, 1 or 2.
    pub turns: usize,
}

/// Where an outgoing direction lies: up to four stored views with their shares.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellPlace {
    pub corners: [(usize, f64); 4],
    /// Azimuth of the view's +x, cosine and sine: by it the normal's stored view is turned into the frame of the view.
    pub azimuth: [f64; 2],
}

impl Layout {
    /// Unknowns of a stored view.
    pub fn stride(&self) -> usize {
        6 + 6 * self.lobes
    }
    pub fn stored_views(&self) -> usize {
        1 + (self.thetas.len() - 1) * self.azimuths
    }
    /// All unknowns.
    pub fn len(&self) -> usize {
        self.stride() * self.stored_views()
    }
    pub fn along(&self, k: usize) -> usize {
        6 + k
    }
    pub fn across(&self, k: usize) -> usize {
        6 + self.lobes + k
    }
    pub fn sharpness(&self, k: usize) -> usize {
        6 + 2 * self.lobes + k
    }
    /// The logarithm of the luminance of a lobe's amplitude.
    pub fn luminance(&self, k: usize) -> usize {
        6 + 3 * self.lobes + k
    }
    /// Logarithm of the luminance and both colour differences of lobe k, or of the diffuse term as lobe K.
    pub fn tint(&self, k: usize) -> [usize; 3] {
        if k == self.lobes {
            return [3, 4, 5];
        }
        [0, 1, 2].map(|number| self.luminance(k) + number * self.lobes)
    }
    /// The colour differences of lobes and diffuse term.
    pub fn is_color(&self, index: usize) -> bool {
        index >= self.luminance(self.lobes) || (4..6).contains(&index)
    }
    /// Sets luminance and colour of lobe k, or of the diffuse term, to a colour; to `least` if its luminance is less.
    pub fn set_tint(&self, q: &mut [f64], k: usize, color: [f64; 3], least: f64) {
        let ([y, red, blue], bright) = (self.tint(k), luminance(color));
        q[y] = libm::log(bright.max(least));
        if bright > 0.0 {
            q[red] = (color[0] / bright - 1.0).clamp(COLORS[0].0, COLORS[0].1);
            q[blue] = (color[2] / bright - 1.0).clamp(COLORS[1].0, COLORS[1].1);
        }
    }
    /// Multiplies lobes and diffuse term by `exp(-less)`.
    pub fn darken(&self, q: &mut [f64], less: f64) {
        (0..=self.lobes).for_each(|k| q[self.tint(k)[0]] -= less);
    }

    /// The stored view at a place of a ring; any integer is an azimuth.
    pub fn stored_view(&self, ring: usize, azimuth: usize) -> usize {
        if ring == 0 { 0 } else { 1 + (ring - 1) * self.azimuths + azimuth % self.azimuths }
    }

    /// Angles of a stored view's outgoing direction.
    pub fn angles(&self, stored: usize) -> (f64, f64) {
        if stored == 0 {
            return (0.0, 0.0);
        }
        let (ring, azimuth) = (1 + (stored - 1) / self.azimuths, (stored - 1) % self.azimuths);
        (self.thetas[ring], azimuth as f64 * TAU / (self.turns * self.azimuths) as f64)
    }

    /// Whether an unknown is given: where half a turn changes nothing, axes at the normal can only be the normal, which a
    /// turn leaves as it is.
    pub fn fixed(&self, stored: usize, index: usize) -> bool {
        stored == 0 && self.turns == 2 && (self.along(0)..self.sharpness(0)).contains(&index)
    }

    /// Least and greatest value of an unknown.
    pub fn bounds(&self, index: usize) -> (f64, f64) {
        match index {
            1 => SHEAR,
            0..3 => SQUEEZE,
            3 => LN_AMPLITUDE,
            _ if self.is_color(index) => COLORS[0],
            _ if index < self.sharpness(0) => TILT,
            _ if index < self.luminance(0) => LN_SHARPNESS,
            _ => LN_AMPLITUDE,
        }
    }

    /// A change of an unknown that counts as one unit of roughness.
    pub fn unit(&self, index: usize) -> f64 {
        match index {
            0..3 => 0.3,
            _ if (6..self.sharpness(0)).contains(&index) => 0.15,
            _ if self.is_color(index) => 0.5,
            _ => 0.7,
        }
    }

    /// Where an outgoing direction lies.
    pub fn place(&self, theta: f64, phi: f64) -> CellPlace {
        let last = self.thetas.len() - 1;
        let after = self.thetas.partition_point(|&t| t <= theta).clamp(last.min(1), last);
        let before = after.saturating_sub(1);
        let step = self.thetas[after] - self.thetas[before];
        let outward = if step > 0.0 { ((theta - self.thetas[before]) / step).clamp(0.0, 1.0) } else { 0.0 };
        let scaled = phi.rem_euclid(TAU) / TAU * (self.turns * self.azimuths) as f64;
        let (whole, onward) = (scaled as usize, scaled.fract());
        let corner = |ring, add, share| (self.stored_view(ring, whole + add), share);
        let corners = [
            corner(before, 0, (1.0 - outward) * if before == 0 { 1.0 } else { 1.0 - onward }),
            corner(before, 1, (1.0 - outward) * if before == 0 { 0.0 } else { onward }),
            corner(after, 0, outward * (1.0 - onward)),
            corner(after, 1, outward * onward),
        ];
        let (sin, cos) = libm::sincos(phi + PI);
        CellPlace { corners, azimuth: [cos, sin] }
    }

    /// Interpolates the unknowns at a place, in the frame of its view.
    pub fn interpolate(&self, x: &[f64], place: &CellPlace, out: &mut [f64]) {
        let p = self.stride();
        out.fill(0.0);
        let mut turned = vec![0.0; p];
        for &(stored, share) in place.corners.iter().filter(|c| c.1 > 0.0) {
            let mut from = &x[stored * p..(stored + 1) * p];
            if stored == 0 {
                turned.copy_from_slice(from);
                self.turn(&mut turned, place.azimuth);
                from = &turned;
            }
            out.iter_mut().zip(from).for_each(|(o, v)| *o += share * v);
        }
    }

    /// Turns the unknowns of a stored view from the frame of the surface into that of a view whose +x is at an azimuth: linear.
    pub fn turn(&self, v: &mut [f64], [c, s]: [f64; 2]) {
        let [xx, xy, yy] = [v[0], v[1], v[2]];
        v[0] = c * c * xx + s * s * yy + 2.0 * c * s * xy;
        v[1] = c * s * (yy - xx) + (c * c - s * s) * xy;
        v[2] = s * s * xx + c * c * yy - 2.0 * c * s * xy;
        for k in 0..self.lobes {
            let (i, j) = (self.along(k), self.across(k));
            (v[i], v[j]) = (c * v[i] + s * v[j], c * v[j] - s * v[i]);
        }
    }

    /// The transpose of [`turn`](Self::turn): takes gradients the other way.
    pub fn turn_transposed(&self, v: &mut [f64], [c, s]: [f64; 2]) {
        let [xx, xy, yy] = [v[0], v[1], v[2]];
        v[0] = c * c * xx - c * s * xy + s * s * yy;
        v[1] = 2.0 * c * s * (xx - yy) + (c * c - s * s) * xy;
        v[2] = s * s * xx + c * s * xy + c * c * yy;
        for k in 0..self.lobes {
            let (i, j) = (self.along(k), self.across(k));
            (v[i], v[j]) = (c * v[i] - s * v[j], c * v[j] + s * v[i]);
        }
    }

    /// Albedo of interpolated unknowns, the closed form `diffuse + sum a I(s)`.
    pub fn albedo(&self, q: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for k in 0..=self.lobes {
            let integral = if k < self.lobes { sphere_integral(q[self.sharpness(k)]).0 } else { 1.0 };
            let color = rgb(self.tint(k).map(|i| q[i]));
            (0..3).for_each(|c| sum[c] += color[c] * integral);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::Random;

    fn layout() -> Layout {
        Layout { lobes: 2, squeezed: 1, thetas: vec![0.0, 0.5, 1.0], azimuths: 4, turns: 2 }
    }

    #[test]
    fn places_have_shares_of_one_and_meet_at_stored() {
        let layout = layout();
        let mut random = Random::new(1);
        for _ in 0..200 {
            let place = layout.place(1.5 * random.next(), 10.0 * random.next() - 5.0);
            assert!((place.corners.iter().map(|c| c.1).sum::<f64>() - 1.0).abs() < 1e-12);
        }
        for stored in 0..layout.stored_views() {
            let (theta, phi) = layout.angles(stored);
            for turn in [0.0, PI, -PI] {
                let place = layout.place(theta, phi + turn + 1e-12);
                let share: f64 = place.corners.iter().filter(|c| c.0 == stored).map(|c| c.1).sum();
                assert!(share > 1.0 - 1e-9, "{stored} {place:?}");
            }
        }
    }

    #[test]
    fn transposed_turn_is_the_transpose() {
        let layout = layout();
        let mut random = Random::new(2);
        let mut vector = || (0..layout.stride()).map(|_| random.next() - 0.5).collect::<Vec<f64>>();
        let (a, b) = (vector(), vector());
        let azimuth = [0.6, -0.8];
        let (mut turned, mut back) = (a.clone(), b.clone());
        layout.turn(&mut turned, azimuth);
        layout.turn_transposed(&mut back, azimuth);
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        assert!((dot(&turned, &b) - dot(&a, &back)).abs() < 1e-12);
    }
}
