//! Tables of anisotropic BRDFs: views over the hemisphere, samples over the whole of it.
//!
//! As for isotropic ones (`table/evaluable.rs`), the directions of a view are drawn from a mixture of a uniform hemisphere and
//! caps round the peak, ever narrower; but the peak is looked for in two dimensions, and nothing is mirrored. Lobes that are fitted draw
//! others: there the error of a lobe shows that the data do not have, and a highlight that is long and narrow is met all along.

use crate::FitError;
use crate::anisotropic::shape::frame;
use crate::anisotropic::tuning::table::{ALBEDO, ALBEDO_DRAWN, DRAWN, NARROWER, NARROWEST, WIDEST};
use crate::judge::fitted_material::TrackedView;
use crate::judge::method::FittedView;
use crate::numeric::GOLDEN_ANGLE;
use crate::table::{Brdf, Density, Sample, View};
use rayon::prelude::*;
use srbf_core::Material;
use std::f64::consts::PI;

/// A view at an azimuth. Its samples are in the frame of the view: +x in the plane of incidence, away from the outgoing direction.
#[derive(Clone, Debug)]
pub(crate) struct TurnedView {
    /// Azimuth of the outgoing direction, radians.
    pub phi: f64,
    pub view: View,
}

/// Tabulates a BRDF at outgoing directions, angle and azimuth.
pub(super) fn tabulate(brdf: &dyn Brdf, directions: &[(f64, f64)], density: Density) -> Vec<TurnedView> {
    directions.par_iter().map(|&(theta, phi)| tabulate_view(brdf, (theta, phi), density, None)).collect()
}

/// The same, with directions that the lobes of a material draw beside the others; other ones in every `round`.
pub(super) fn resample(
    brdf: &dyn Brdf,
    directions: &[(f64, f64)],
    density: Density,
    (bytes, round): (&[u8], usize),
) -> Result<Vec<TurnedView>, FitError> {
    let material = Material::from_bytes(bytes)?;
    let view = |&(theta, phi): &(f64, f64)| {
        let lobes = TrackedView::new(&material, theta, phi + PI)?;
        Ok(tabulate_view(brdf, (theta, phi), density, Some((&lobes, round))))
    };
    directions.par_iter().map(view).collect()
}

fn tabulate_view(
    brdf: &dyn Brdf,
    (theta, phi): (f64, f64),
    density: Density,
    lobes: Option<(&TrackedView<'_>, usize)>,
) -> TurnedView {
    let wo = crate::table::direction(theta, phi);
    let (sin, cos) = libm::sincos(phi + PI);
    let value = |d: [f64; 3]| {
        let wi = [d[0] * cos - d[1] * sin, d[0] * sin + d[1] * cos, d[2]];
        brdf.evaluate(wi, wo).map(|v| if v.is_finite() { v } else { 0.0 })
    };
    let bright = |d: [f64; 3]| if d[2] > 1e-4 { value(d).iter().sum::<f64>() * d[2] } else { 0.0 };
    let (axis, width) = find_peak(&bright, theta);
    let sharpest = (1.0 / (width * width)).clamp(WIDEST, NARROWEST);
    let mut caps = vec![WIDEST];
    while caps[caps.len() - 1] < sharpest {
        caps.push(caps[caps.len() - 1] * NARROWER);
    }

    let sample = |(d, weight): ([f64; 3], f64)| Sample { direction: d, rgb: value(d), weight };
    let drawn = |count| lobes.map(|(lobes, round)| Drawn { lobes, count, round });
    let samples: Vec<Sample> = weighed(axis, &caps, density, drawn(DRAWN).as_ref()).map(sample).collect();
    // Errors of an albedo of 1 % count: those of so few samples are as large.
    let mut albedo = [0.0; 3];
    for (d, weight) in weighed(axis, &caps, ALBEDO, drawn(ALBEDO_DRAWN).as_ref()) {
        let rgb = value(d);
        (0..3).for_each(|c| albedo[c] += weight * rgb[c] * d[2]);
    }
    TurnedView { phi, view: View { theta, samples, albedo, uncut_albedo: albedo, floor: 0.0 } }
}

/// Directions that lobes draw.
struct Drawn<'a> {
    lobes: &'a TrackedView<'a>,
    count: usize,
    round: usize,
}

impl Drawn<'_> {
    fn directions(&self) -> impl Iterator<Item = [f64; 3]> {
        (0..self.count).filter_map(|i| {
            // The R2 sequence (Roberts 2018) beside even steps; another part of it in every round.
            let n = (i + self.round * self.count) as f64;
            let even = (i as f64 + 0.5) / self.count as f64;
            self.lobes.draw([even, R2[0] * n, R2[1] * n].map(|u| u.fract() as f32))
        })
    }

    fn density(&self, d: [f64; 3]) -> f64 {
        self.count as f64 * self.lobes.pdf(d).unwrap_or(0.0)
    }
}

/// Steps of the R2 sequence.
const R2: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];

/// Directions over the hemisphere, in caps round an axis and of lobes, with their weights.
fn weighed(
    axis: [f64; 3],
    caps: &[f64],
    density: Density,
    drawn: Option<&Drawn<'_>>,
) -> impl Iterator<Item = ([f64; 3], f64)> {
    let mut directions: Vec<[f64; 3]> = Vec::new();
    for i in 0..density.hemisphere {
        let z = (i as f64 + 0.5) / density.hemisphere as f64;
        let (s, c) = libm::sincos(GOLDEN_ANGLE * i as f64);
        let r = libm::sqrt(1.0 - z * z);
        directions.push([r * c, r * s, z]);
    }
    for (n, s) in caps.iter().enumerate() {
        for i in 0..density.cap {
            let u = (i as f64 + 0.5) / density.cap as f64;
            let w = -libm::log1p(u * libm::expm1(-2.0 * s)) / s;
            directions.push(around(axis, w, GOLDEN_ANGLE * i as f64 + n as f64));
        }
    }
    directions.extend(drawn.iter().flat_map(|drawn| drawn.directions()));
    let probability = move |d: &[f64; 3]| {
        let chord: f64 = (0..3).map(|k| (d[k] - axis[k]) * (d[k] - axis[k])).sum();
        let cap = |s: &f64| {
            density.cap as f64 * s / (-2.0 * PI * libm::expm1(-2.0 * s)) * libm::exp(-0.5 * s * chord)
        };
        let lobes = drawn.map_or(0.0, |drawn| drawn.density(*d));
        density.hemisphere as f64 / (2.0 * PI) + caps.iter().map(cap).sum::<f64>() + lobes
    };
    directions.into_iter().filter(|d| d[2] > 1e-4).map(move |d| (d, 1.0 / probability(&d)))
}

/// The direction at `w = 1 - cos` from an axis, at an angle round it.
fn around(axis: [f64; 3], w: f64, angle: f64) -> [f64; 3] {
    let [_, tangent, bitangent] = frame(axis);
    let r = libm::sqrt(w * (2.0 - w));
    let (sin, cos) = libm::sincos(angle);
    [0, 1, 2].map(|k| axis[k] * (1.0 - w) + r * (tangent[k] * cos + bitangent[k] * sin))
}

/// Direction of the highest value, and the least distance from it at which it has fallen to half; radians.
fn find_peak(value: &dyn Fn([f64; 3]) -> f64, theta: f64) -> ([f64; 3], f64) {
    let mirror = crate::table::direction(theta.min(1.55), 0.0);
    let (mut peak, mut highest) = (mirror, value(mirror));
    let mut look = |d: [f64; 3]| {
        let v = value(d);
        if v > highest {
            (peak, highest) = (d, v);
        }
    };
    // All over, then round the mirror direction at every scale.
    for i in 0..2000 {
        let z = (f64::from(i) + 0.5) / 2000.0;
        let (s, c) = libm::sincos(GOLDEN_ANGLE * f64::from(i));
        let r = libm::sqrt(1.0 - z * z);
        look([r * c, r * s, z]);
    }
    for i in 0..400 {
        let distance = 1e-4 * libm::pow(5e3, f64::from(i) / 400.0);
        look(around(mirror, 1.0 - libm::cos(distance), GOLDEN_ANGLE * f64::from(i)));
    }
    // Downhill on ever smaller circles.
    let mut step = 0.03;
    while step > 1e-4 {
        let (start, before) = (peak, highest);
        for i in 0..8 {
            let d = around(start, 1.0 - libm::cos(step), f64::from(i) * PI / 4.0);
            let v = value(d);
            if v > highest {
                (peak, highest) = (d, v);
            }
        }
        if highest == before {
            step *= 0.5;
        }
    }
    let mut width = 1e-4;
    let half = |width: f64| {
        (0..8).any(|i| value(around(peak, 1.0 - libm::cos(width), f64::from(i) * PI / 4.0)) < 0.5 * highest)
    };
    while width < 0.5 && !half(width) {
        width *= 1.25;
    }
    (peak, width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::ward::Ward;

    /// Ward's albedo does not change when `wo` and the material turn together, and is that of the other axis a quarter on.
    #[test]
    fn albedo_and_mirror_images_are_those_of_the_model() {
        let ward = |x, y| Ward { diffuse: [0.1; 3], specular: [0.5; 3], alpha: [x, y] };
        let at = |w: &Ward, phi: f64| {
            tabulate(w, &[(0.9, phi)], Density { hemisphere: 3000, cap: 3000 })[0].view.albedo[0]
        };
        let (a, b) = (ward(0.1, 0.4), ward(0.4, 0.1));
        assert!((at(&a, 0.3) - at(&a, -0.3)).abs() < 2e-3);
        assert!((at(&a, 0.3) - at(&b, 0.3 + PI / 2.0)).abs() < 2e-3);
        assert!((at(&a, 0.0) - at(&b, 0.0)).abs() > 5e-3, "the test needs a difference");
        // And coarse quadrature is as good as the fit needs.
        let coarse = tabulate(&a, &[(0.9, 0.3)], Density { hemisphere: 500, cap: 120 })[0].view.albedo[0];
        assert!((coarse / at(&a, 0.3) - 1.0).abs() < 0.01, "{coarse}");
    }
}
