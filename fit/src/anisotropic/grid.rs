//! Where the stored views of an anisotropic fit stand: on a grid over the hemisphere.
//!
//! Where mirrors leave the surface as it is, rings go from one mirror to the other, over a quarter of the turn. In the planes of the mirrors
//! a lobe is its own image, but for *pairs*: there each lobe of a pair is the image of the other, and has no unknowns of its own.
//!
//! Stored view 0 is the normal; then ring by ring, each with the same number of azimuths. A squeeze has three numbers, the logarithm
//! of its matrix (xx, xy, yy). The angles of an axis are its tilts along the plane of incidence and across it; all lobes have both.
//! Between stored views `srbf_core` interpolates the unknowns as is done here; see `core/src/kernel/prepare_anisotropic.rs`, which
//! also says why that is continuous at the normal.

use crate::family::layout::Layout as Family;
use crate::family::objective;
use std::f64::consts::{PI, TAU};

/// The stored views.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    /// Angles of the rings from the normal, radians; the first is 0, the normal itself.
    pub thetas: Vec<f64>,
    /// Stored views of a ring.
    pub azimuths: usize,
    /// How often a ring is repeated over the full turn, 1 or 2; [`MIRRORS`] of a quarter with mirrors on both sides.
    pub turns: usize,
    /// Lobes from `first_pair` on stand in pairs: `pairs` of them, and as many partners behind.
    pub first_pair: usize,
    pub pairs: usize,
}

/// Turns of a grid with mirrors, as [`srbf_core::Grid`] has them.
pub(crate) const MIRRORS: usize = 4;

/// How the unknowns of a view follow from those that are stored.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Stored {
    /// They are these.
    AsTheyAre,
    /// By a turn, of the normal.
    Turned,
    /// In the plane of a mirror, partners are images.
    Images,
}

/// The unknowns.
pub(crate) type Layout = Family<Grid>;
/// The sum of squares.
pub(super) type Objective = objective::Objective<Grid>;

/// Where an outgoing direction lies: up to four stored views with their shares.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellPlace {
    pub corners: [(usize, f64); 4],
    /// Azimuth of the view's +x, cosine and sine: by it the normal's stored view is turned into the frame of the view.
    pub azimuth: [f64; 2],
}

impl CellPlace {
    /// The stored views that have a share, each once.
    pub fn stored(&self) -> Vec<(usize, f64)> {
        // Two corners are one stored view in a ring of one.
        let mut corners: Vec<(usize, f64)> = Vec::new();
        for &(stored, share) in self.corners.iter().filter(|c| c.1 > 0.0) {
            match corners.iter_mut().find(|c| c.0 == stored) {
                Some(corner) => corner.1 += share,
                None => corners.push((stored, share)),
            }
        }
        corners
    }
}

impl Grid {
    /// The stored view at a place of a ring; any integer is an azimuth.
    pub fn stored_view(&self, ring: usize, azimuth: usize) -> usize {
        if ring == 0 { 0 } else { 1 + (ring - 1) * self.azimuths + azimuth % self.azimuths }
    }

    /// Whether a ring goes from mirror to mirror.
    pub fn is_mirrored(&self) -> bool {
        self.turns == MIRRORS
    }

    /// The angle from one azimuth of a ring to the next.
    pub fn step(&self) -> f64 {
        TAU / (self.turns * self.cells()) as f64
    }

    /// Cells between the azimuths of a ring.
    pub fn cells(&self) -> usize {
        if self.is_mirrored() { self.azimuths - 1 } else { self.azimuths }
    }

    /// Whether a stored view stands in the plane of a mirror; the normal is none of them.
    pub fn is_in_mirror(&self, stored: usize) -> bool {
        self.is_mirrored()
            && stored > 0
            && matches!((stored - 1) % self.azimuths, a if a == 0 || a + 1 == self.azimuths)
    }

    /// The lobe whose image a lobe is in the planes of the mirrors.
    pub fn partner(&self, k: usize) -> Option<usize> {
        let place = k.checked_sub(self.first_pair + self.pairs)?;
        (place < self.pairs).then_some(self.first_pair + place)
    }

    /// How the unknowns of a view follow from a stored one.
    pub(super) fn stored(&self, stored: usize) -> Stored {
        match stored {
            0 => Stored::Turned,
            _ if self.pairs > 0 && self.is_in_mirror(stored) => Stored::Images,
            _ => Stored::AsTheyAre,
        }
    }

    /// Angles of a stored view's outgoing direction.
    pub fn angles(&self, stored: usize) -> (f64, f64) {
        if stored == 0 {
            return (0.0, 0.0);
        }
        let (ring, azimuth) = (1 + (stored - 1) / self.azimuths, (stored - 1) % self.azimuths);
        (self.thetas[ring], azimuth as f64 * self.step())
    }

    /// Where an outgoing direction lies; with mirrors, one of the first quarter, or its image.
    pub fn place(&self, theta: f64, phi: f64) -> CellPlace {
        let last = self.thetas.len() - 1;
        let after = self.thetas.partition_point(|&t| t <= theta).clamp(last.min(1), last);
        let before = after.saturating_sub(1);
        let step = self.thetas[after] - self.thetas[before];
        let outward = if step > 0.0 { ((theta - self.thetas[before]) / step).clamp(0.0, 1.0) } else { 0.0 };
        let mut phi = phi.rem_euclid(TAU);
        if self.is_mirrored() {
            let half = phi.rem_euclid(PI);
            phi = half.min(PI - half);
        }
        let scaled = phi / self.step();
        let (whole, onward) = (scaled as usize, scaled.fract());
        let last_of_ring = if self.is_mirrored() { self.azimuths - 1 } else { usize::MAX };
        let corner =
            |ring, add: usize, share| (self.stored_view(ring, (whole + add).min(last_of_ring)), share);
        let corners = [
            corner(before, 0, (1.0 - outward) * if before == 0 { 1.0 } else { 1.0 - onward }),
            corner(before, 1, (1.0 - outward) * if before == 0 { 0.0 } else { onward }),
            corner(after, 0, outward * (1.0 - onward)),
            corner(after, 1, outward * onward),
        ];
        let (sin, cos) = libm::sincos(phi + PI);
        CellPlace { corners, azimuth: [cos, sin] }
    }
}

impl Layout {
    /// Turns the unknowns of a stored view from the frame of the surface into that of a view whose +x is at an azimuth: linear.
    pub fn turn(&self, v: &mut [f64], [c, s]: [f64; 2]) {
        let [xx, xy, yy] = [v[0], v[1], v[2]];
        v[0] = c * c * xx + s * s * yy + 2.0 * c * s * xy;
        v[1] = c * s * (yy - xx) + (c * c - s * s) * xy;
        v[2] = s * s * xx + c * c * yy - 2.0 * c * s * xy;
        for k in 0..self.lobes {
            let (i, j) = (self.angle(k), self.off_plane(k));
            (v[i], v[j]) = (c * v[i] + s * v[j], c * v[j] - s * v[i]);
        }
    }

    /// Writes the images of a stored view in the plane of a mirror: linear.
    pub fn show_images(&self, v: &mut [f64]) {
        self.each_image(|from, to, sign| v[to] = sign * v[from]);
    }

    /// The transpose of [`show_images`](Self::show_images).
    pub fn show_images_transposed(&self, v: &mut [f64]) {
        self.each_image(|from, to, sign| {
            v[from] += sign * v[to];
            v[to] = 0.0;
        });
    }

    /// Calls with an unknown, that of the image, and the sign.
    fn each_image(&self, mut each: impl FnMut(usize, usize, f64)) {
        for k in 0..self.lobes {
            let Some(of) = self.views.partner(k) else { continue };
            for (from, to) in self.unknowns(of).into_iter().zip(self.unknowns(k)) {
                each(from, to, if to == self.off_plane(k) { -1.0 } else { 1.0 });
            }
        }
    }

    /// The unknowns of a lobe.
    pub fn unknowns(&self, k: usize) -> [usize; 6] {
        let [luminance, red, blue] = self.tint(k);
        [self.angle(k), self.off_plane(k), self.sharpness(k), luminance, red, blue]
    }

    /// Gradients by the unknowns of a view as those by a stored one.
    pub(super) fn by_stored(&self, v: &mut [f64], stored: Stored, azimuth: [f64; 2]) {
        match stored {
            Stored::AsTheyAre => {}
            Stored::Turned => self.turn_transposed(v, azimuth),
            Stored::Images => self.show_images_transposed(v),
        }
    }

    /// The transpose of [`turn`](Self::turn): takes gradients the other way.
    pub fn turn_transposed(&self, v: &mut [f64], [c, s]: [f64; 2]) {
        let [xx, xy, yy] = [v[0], v[1], v[2]];
        v[0] = c * c * xx - c * s * xy + s * s * yy;
        v[1] = 2.0 * c * s * (xx - yy) + (c * c - s * s) * xy;
        v[2] = s * s * xx + c * s * xy + c * c * yy;
        for k in 0..self.lobes {
            let (i, j) = (self.angle(k), self.off_plane(k));
            (v[i], v[j]) = (c * v[i] - s * v[j], c * v[j] + s * v[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anisotropic::tests::grid_layout;
    use crate::numeric::random::Random;

    #[test]
    fn places_have_shares_of_one_and_meet_at_stored() {
        for layout in [grid_layout(4, 2), grid_layout(4, MIRRORS)] {
            let mut random = Random::new(1);
            for _ in 0..200 {
                let place = layout.views.place(1.5 * random.uniform(), 10.0 * random.uniform() - 5.0);
                assert!((place.corners.iter().map(|c| c.1).sum::<f64>() - 1.0).abs() < 1e-12);
            }
            for stored in 0..layout.stored_views() {
                let (theta, phi) = layout.views.angles(stored);
                for turn in [0.0, PI, -PI] {
                    let place = layout.views.place(theta, phi + turn + 1e-12);
                    let share: f64 = place.corners.iter().filter(|c| c.0 == stored).map(|c| c.1).sum();
                    assert!(share > 1.0 - 1e-9, "{stored} {place:?}");
                }
            }
        }
    }

    #[test]
    fn images_are_mirrored_and_their_transpose_is_the_transpose() {
        let layout = grid_layout(4, MIRRORS);
        let mut random = Random::new(2);
        let mut vector = || (0..layout.stride()).map(|_| random.uniform() - 0.5).collect::<Vec<f64>>();
        let (a, b) = (vector(), vector());
        let (mut shown, mut back) = (a.clone(), b.clone());
        layout.show_images(&mut shown);
        layout.show_images_transposed(&mut back);
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        assert!((dot(&shown, &b) - dot(&a, &back)).abs() < 1e-12);
        let [own, image] = [0, 1].map(|k| layout.unknowns(k).map(|i| shown[i]));
        assert_eq!(image, [own[0], -own[1], own[2], own[3], own[4], own[5]]);
        assert_eq!(
            (layout.views.partner(0), layout.views.partner(1), layout.views.partner(2)),
            (None, Some(0), None)
        );
    }

    #[test]
    fn transposed_turn_is_the_transpose() {
        let layout = grid_layout(4, 2);
        let mut random = Random::new(2);
        let mut vector = || (0..layout.stride()).map(|_| random.uniform() - 0.5).collect::<Vec<f64>>();
        let (a, b) = (vector(), vector());
        let azimuth = [0.6, -0.8];
        let (mut turned, mut back) = (a.clone(), b.clone());
        layout.turn(&mut turned, azimuth);
        layout.turn_transposed(&mut back, azimuth);
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        assert!((dot(&turned, &b) - dot(&a, &back)).abs() < 1e-12);
    }
}
