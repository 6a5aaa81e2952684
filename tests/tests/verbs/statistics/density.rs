//! Densities as the oracle sees them: parts, and the place of a direction within each.

use glam::DVec3;
use srbf_core::{AnyMixture, Domain};
use srbf_tests::oracle::{gaussian, luminance, mirrored, share_within, sphere_integral, squeezed, turned};
use std::f64::consts::{PI, TAU};

/// A lobe or a diffuse term, as the oracle sees it.
pub struct Part {
    /// Of the draws.
    pub share: f64,
    /// Axis and sharpness; `None` for the diffuse term.
    lobe: Option<(DVec3, f64)>,
    is_squeezed: bool,
}

/// A mixture within a density.
pub struct Seen {
    /// Lobes, then the diffuse term.
    pub parts: Vec<Part>,
    domain: Domain,
    is_below: bool,
    azimuth: [f64; 2],
    squeeze: [f64; 2],
}

/// A part of the density at a direction: its place among all, the density, and the direction as the lobe sees it.
pub type Image = (usize, f64, DVec3);

impl Seen {
    /// A mixture that has a share of the draws, above the horizon or below.
    pub fn new(m: &AnyMixture<'_>, share: f64, is_below: bool) -> Self {
        let lobe = |k: usize| {
            let lobe = m.lobe(k).expect("lobe");
            let s = f64::from(lobe.gaussian.sharpness);
            let share = luminance(lobe.amplitude.as_dvec3()) * sphere_integral(s);
            let axis = lobe.gaussian.axis.as_dvec3().normalize();
            Part { share, lobe: Some((axis, s)), is_squeezed: k < m.squeezed_len() }
        };
        let diffuse = Part { share: luminance(m.diffuse().as_dvec3()), lobe: None, is_squeezed: false };
        let mut parts: Vec<Part> = (0..m.len()).map(lobe).chain([diffuse]).collect();
        let power: f64 = parts.iter().map(|part| part.share).sum();
        parts.iter_mut().for_each(|part| part.share *= if power > 0.0 { share / power } else { 0.0 });
        Self {
            parts,
            domain: m.domain(),
            is_below,
            azimuth: m.azimuth_cos_sin().map(f64::from),
            squeeze: [m.squeeze_along(), m.squeeze()].map(f64::from),
        }
    }

    /// Appends its parts of the density at a direction; `first` is the place of its first part.
    pub fn images(&self, d: DVec3, first: usize, images: &mut Vec<Image>) {
        let is_folded = self.domain == Domain::Hemisphere;
        if is_folded && self.is_below != (d.z < 0.0) {
            return;
        }
        let height = if is_folded { d.z.abs() } else { d.z };
        let turned = turned(self.azimuth, d.with_z(height));
        let (narrow, squeezed) = squeezed(self.squeeze, turned);
        for (place, part) in self.parts.iter().enumerate() {
            let Some((axis, sharpness)) = part.lobe else {
                images.push((first + place, part.share * height / PI, turned));
                continue;
            };
            let (u, scale) = if part.is_squeezed { (narrow, squeezed) } else { (turned, 1.0) };
            let height = part.share * scale / sphere_integral(sharpness);
            for u in [u, mirrored(u)].into_iter().take(1 + usize::from(is_folded)) {
                images.push((first + place, height * gaussian(axis, sharpness, u), u));
            }
        }
    }
}

impl Part {
    /// The uniform numbers that a direction comes from.
    pub fn coordinates(&self, u: DVec3) -> [f64; 2] {
        let u = u.normalize();
        let (within, [x, y]) = match self.lobe {
            None => (u.x * u.x + u.y * u.y, [u.x, u.y]),
            Some((axis, s)) => {
                let (t, b) = axis.any_orthonormal_pair();
                (share_within(s, 0.5 * (u - axis).length_squared()), [u.dot(t), u.dot(b)])
            }
        };
        [within, (y.atan2(x) / TAU).rem_euclid(1.0)]
    }
}
