//! Tables of BRDFs that can be evaluated at any pair of directions: dense files and analytic models.
//!
//! The directions of a view are drawn from a mixture of a uniform hemisphere and caps round peaks. Each cap is six times
//! narrower in solid angle than the one before, down to the width of the peak. Peaks are looked for in the plane of incidence
//! first: the highest, and others that are narrow and stand alone (`peaks`). Caps are folded at the horizon and squeezed across the plane of incidence as a highlight is (`srbf_core` does the same
//! to lobes). So none of their directions is lost, and grazing peaks are seen as well as others. Every part is a spiral of equal
//! shares; a direction weighs one over the density of the whole (the balance heuristic). So the sum is a quadrature over the
//! hemisphere that sees a peak of any width.
//!
//! Where a fit puts a lobe between the directions it costs nothing: so a table can be made again with directions drawn from
//! a material's lobes as one more part of the mixture ([`Drawn`]).
//!
//! The albedo is integrated with `FINER` times as many directions: the fit is held to it more closely than to a sample.

mod peaks;

use super::{Brdf, Sample, Symmetry, Table, View, direction};
use crate::FitError;
use crate::numeric::GOLDEN_ANGLE;
use crate::numeric::special::sphere_integral;
use peaks::Peak;
use rayon::prelude::*;
use srbf_core::{Domain, Level, Lobe, MAX_LOBES, Mixture, Vec3};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::{Arc, Mutex, PoisonError};

/// How densely a BRDF is tabulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    /// Directions spread over the hemisphere.
    pub hemisphere: usize,
    /// Directions in each cap round the peak.
    pub cap: usize,
}

impl Default for Density {
    fn default() -> Self {
        Self { hemisphere: 350, cap: 100 }
    }
}

/// Sharpness of the widest cap, and the factor to the next one.
const WIDEST: f64 = 12.0;
const NARROWER: f64 = 6.0;

/// Sharpness that caps may reach.
const NARROWEST: f64 = 4e6;

/// Exponent below which a cap has no direction: beside those of the hemisphere its density is lost in rounding.
const NOTHING: f64 = -60.0;

/// Directions for the albedo, over those of the samples.
const FINER: usize = 6;

/// Squeeze of the caps at the horizon, where the cosine is 0.
const LEAST_SQUEEZE: f64 = 0.06;

/// Directions at the horizon where the largest weight is looked for too, on one side of the plane of incidence, and radians above.
const HORIZON: usize = 24;
const ABOVE_HORIZON: f64 = 1.5e-3;

/// Directions in a cap over those that a lobe draws.
const CAP_OVER_DRAWN: usize = 5;

/// Steps of the R2 sequence: powers of the inverse of the root of `x^3 = x + 1`.
const R2: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];

/// Angle from the normal below which a view is at the normal, radians, and azimuths over which it is averaged.
const AT_NORMAL: f64 = 1e-6;
const AZIMUTHS: usize = 32;

impl Table {
    /// Tabulates a BRDF at views, angles in radians within [0, pi / 2).
    ///
    /// # Errors
    /// [`FitError::Table`] for no view, too many, angles out of range, and a BRDF that is anisotropic.
    pub fn from_brdf(brdf: &dyn Brdf, thetas: &[f64], density: Density) -> Result<Self, FitError> {
        Tabulation::new(brdf, density).table(thetas, &|_| Ok(None))
    }
}

/// Tables of one BRDF. Peaks and albedo of a view are looked for once, however many tables have it.
pub struct Tabulation<'a> {
    brdf: &'a dyn Brdf,
    density: Density,
    /// By the bits of the angle.
    seen: Mutex<BTreeMap<u64, Arc<Seen>>>,
}

/// The outgoing direction of a view, its peaks and its albedo.
struct Seen {
    wo: [f64; 3],
    caps: Vec<Caps>,
    albedo: [f64; 3],
}

impl<'a> Tabulation<'a> {
    /// Of a BRDF, in directions of that density.
    pub fn new(brdf: &'a dyn Brdf, density: Density) -> Self {
        Self { brdf, density, seen: Mutex::default() }
    }

    /// How densely.
    pub fn density(&self) -> Density {
        self.density
    }

    /// Tabulates it at views, with directions drawn beside the others.
    ///
    /// # Errors
    /// As [`Table::from_brdf`], and those of `drawn`.
    pub fn table(
        &self,
        thetas: &[f64],
        drawn: &(dyn Fn(f64) -> Result<Option<Drawn>, FitError> + Sync),
    ) -> Result<Table, FitError> {
        let Self { brdf, density, .. } = *self;
        if thetas.is_empty() || thetas.len() > super::MAX_VIEWS {
            return Err(FitError::Table(format!("{} views; from 1 to {}", thetas.len(), super::MAX_VIEWS)));
        }
        if let Some(theta) = thetas.iter().find(|t| !(0.0..FRAC_PI_2).contains(*t)) {
            return Err(FitError::Table(format!("view at {} degrees", theta.to_degrees())));
        }
        if brdf.symmetry() != Symmetry::Isotropic {
            return Err(FitError::Table("it is anisotropic: views at one azimuth do not describe it".into()));
        }
        let view = |&theta: &f64| {
            let seen = self.seen(theta);
            let mut samples = draw(brdf, seen.wo, &seen.caps, density, drawn(theta)?.as_ref());
            let floor = if theta < AT_NORMAL { make_round(brdf, &mut samples) } else { 0.0 };
            Ok(View { theta, samples, albedo: seen.albedo, uncut_albedo: seen.albedo, floor })
        };
        let mut views = thetas.par_iter().map(view).collect::<Result<Vec<View>, FitError>>()?;
        views.sort_by(|a, b| a.theta.total_cmp(&b.theta));
        Ok(Table { views })
    }

    fn seen(&self, theta: f64) -> Arc<Seen> {
        // A map is whole whenever somebody has failed.
        let map = || self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(seen) = map().get(&theta.to_bits()) {
            return seen.clone();
        }
        let (wo, caps) = look(self.brdf, theta);
        let finer = Density { hemisphere: FINER * self.density.hemisphere, cap: FINER * self.density.cap };
        let mut albedo = [0.0; 3];
        for s in &draw(self.brdf, wo, &caps, finer, None) {
            (0..3).for_each(|c| albedo[c] += s.weight * s.rgb[c] * s.direction[2]);
        }
        let seen = Arc::new(Seen { wo, caps, albedo });
        map().insert(theta.to_bits(), seen.clone());
        seen
    }
}

/// The value with everything that is no value taken as 0.
fn value(brdf: &dyn Brdf, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
    brdf.evaluate(wi, wo).map(|v| if v.is_finite() { v } else { 0.0 })
}

/// Replaces samples at the normal by their means over the azimuth, and returns the relative L2 norm of the difference.
fn make_round(brdf: &dyn Brdf, samples: &mut [Sample]) -> f64 {
    let (mut difference, mut square) = (0.0, 0.0);
    for s in samples {
        let [x, y, z] = s.direction;
        let (mut mean, mut squares) = ([0.0; 3], 0.0);
        for n in 0..AZIMUTHS {
            let (sin, cos) = libm::sincos(2.0 * PI * n as f64 / AZIMUTHS as f64);
            let rgb = value(brdf, [x * cos - y * sin, x * sin + y * cos, z], [0.0, 0.0, 1.0]);
            (0..3).for_each(|c| mean[c] += rgb[c] / AZIMUTHS as f64);
            squares += rgb.iter().map(|v| v * v).sum::<f64>() / AZIMUTHS as f64;
        }
        let weight = s.weight * z * z;
        square += weight * squares;
        difference += weight * (squares - mean.iter().map(|v| v * v).sum::<f64>()).max(0.0);
        s.rgb = mean;
    }
    if square > 0.0 { libm::sqrt(difference / square) } else { 0.0 }
}

/// The outgoing direction of a view, and caps round each of its peaks.
fn look(brdf: &dyn Brdf, theta: f64) -> ([f64; 3], Vec<Caps>) {
    let (sin, cos) = libm::sincos(theta);
    let wo = [-sin, 0.0, cos];
    let in_plane = |angle: f64| {
        let d = direction(angle.abs(), if angle < 0.0 { PI } else { 0.0 });
        value(brdf, d, wo).iter().sum::<f64>() * d[2]
    };
    (wo, peaks::find(&in_plane, theta).into_iter().map(|peak| Caps::new(peak, cos)).collect())
}

/// Caps round one axis in the plane of incidence.
struct Caps {
    axis: [f64; 3],
    squeeze: f64,
    /// Sharpness of each, rising, and the height of a lobe of it whose integral over the sphere is 1.
    sharpness: Vec<(f64, f64)>,
}

impl Caps {
    /// Caps down to the half width of a peak along the plane of incidence; across it they are squeezed by the cosine.
    fn new(Peak { angle, width }: Peak, cos: f64) -> Self {
        let sharpest = (1.0 / (width * width)).min(NARROWEST);
        let mut all = vec![WIDEST];
        while all[all.len() - 1] < sharpest {
            all.push(NARROWER * all[all.len() - 1]);
        }
        let sharpness = all.into_iter().map(|s| (s, s / (-2.0 * PI * libm::expm1(-2.0 * s)))).collect();
        let axis = direction(angle.abs(), if angle < 0.0 { PI } else { 0.0 });
        Self { axis, squeeze: cos.max(LEAST_SQUEEZE), sharpness }
    }

    /// Direction number `i` of `count` of a cap.
    fn direction(&self, cap: usize, i: usize, count: usize) -> [f64; 3] {
        let (s, _) = self.sharpness[cap];
        let u = (i as f64 + 0.5) / count as f64;
        let w = -libm::log1p(u * libm::expm1(-2.0 * s)) / s;
        let r = libm::sqrt(w * (2.0 - w));
        let (sp, cp) = libm::sincos(GOLDEN_ANGLE * i as f64 + cap as f64);
        let tangent = [self.axis[2], 0.0, -self.axis[0]];
        let mut d = [0.0; 3];
        (0..3).for_each(|k| d[k] = self.axis[k] * (1.0 - w) + tangent[k] * r * cp);
        d[1] = (r * sp).abs() * self.squeeze;
        let length = libm::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        [d[0] / length, d[1] / length, d[2].abs() / length]
    }

    /// Sum of the densities of all caps, each of `count` directions, 1/sr.
    fn density(&self, d: &[f64; 3], count: usize) -> f64 {
        let y = d[1] / self.squeeze;
        let r = libm::sqrt(d[0] * d[0] + y * y + d[2] * d[2]);
        let u = [d[0] / r, y / r, d[2] / r];
        let chord = |z: f64| {
            let at = [u[0] - self.axis[0], u[1] - self.axis[1], z - self.axis[2]];
            at[0] * at[0] + at[1] * at[1] + at[2] * at[2]
        };
        let (above, below) = (chord(u[2]), chord(-u[2]));
        // Most directions are far from most caps.
        let lobe = |t: f64| if t > NOTHING { libm::exp(t) } else { 0.0 };
        let cap = |(s, height): &(f64, f64)| height * (lobe(-0.5 * s * above) + lobe(-0.5 * s * below));
        let sum: f64 = self.sharpness.iter().map(cap).sum();
        count as f64 * sum / (self.squeeze * r * r * r)
    }
}

/// Directions that a material's lobes draw, the same number by each, a part of the mixture of directions.
pub struct Drawn {
    lobes: Mixture<'static, MAX_LOBES>,
    count: usize,
    round: usize,
}

impl Drawn {
    /// Of the lobes of a mixture, as densely as that says; others in every round.
    pub fn new(view: &Mixture<'_, MAX_LOBES>, density: Density, round: usize) -> Result<Self, FitError> {
        let lobe = |k| {
            let Lobe { gaussian, .. } = view.lobe(k)?;
            let (integral, _) = sphere_integral(libm::log(f64::from(gaussian.sharpness)));
            Lobe::new(gaussian.axis, gaussian.sharpness, Vec3::splat((1.0 / integral) as f32)).ok()
        };
        let lobes: Vec<Lobe> = (0..view.len()).filter_map(lobe).collect();
        let (squeezed, round_lobes) = lobes.split_at(view.squeezed_len().min(lobes.len()));
        let lobes = Mixture::new(Domain::Hemisphere, view.squeeze(), squeezed, round_lobes)?;
        let lobes = lobes.with_level(Level::Scalar)?;
        Ok(Self { count: density.cap / CAP_OVER_DRAWN * lobes.len(), lobes, round })
    }

    fn direction(&self, i: usize) -> Option<[f64; 3]> {
        // The R2 sequence (Roberts 2018) beside even steps; another part of it in every round.
        let n = (i + self.round * self.count) as f64;
        let u = [(i as f64 + 0.5) / self.count as f64, R2[0] * n, R2[1] * n].map(|u| u.fract() as f32);
        let d = self.lobes.sample_direction(u)?.to_array().map(f64::from);
        Some([d[0], d[1].abs(), d[2]])
    }

    fn density(&self, d: &[f64; 3]) -> f64 {
        self.count as f64 * f64::from(self.lobes.pdf(Vec3::from(d.map(|v| v as f32))))
    }
}

/// Values at directions spread over the hemisphere, the caps and the lobes.
fn draw(
    brdf: &dyn Brdf,
    wo: [f64; 3],
    peaks: &[Caps],
    density: Density,
    drawn: Option<&Drawn>,
) -> Vec<Sample> {
    let spread = (0..density.hemisphere).map(|i| {
        let z = (i as f64 + 0.5) / density.hemisphere as f64;
        let (sp, cp) = libm::sincos(GOLDEN_ANGLE * i as f64);
        let r = libm::sqrt(1.0 - z * z);
        [r * cp, (r * sp).abs(), z]
    });
    let capped = peaks.iter().flat_map(|caps| {
        (0..caps.sharpness.len())
            .flat_map(move |cap| (0..density.cap).map(move |i| caps.direction(cap, i, density.cap)))
    });
    let by_lobes = drawn.iter().flat_map(|drawn| (0..drawn.count).filter_map(|i| drawn.direction(i)));
    let probability = |d: &[f64; 3]| {
        let lobes = drawn.map_or(0.0, |drawn| drawn.density(d));
        let caps: f64 = peaks.iter().map(|caps| caps.density(d, density.cap)).sum();
        density.hemisphere as f64 / (2.0 * PI) + caps + lobes
    };
    let weighed = spread.chain(capped).chain(by_lobes).filter(|d| d[2] > 1e-4).map(|d| Sample {
        direction: d,
        rgb: value(brdf, d, wo),
        weight: 1.0 / probability(&d),
    });
    // No part of the quadrature, and possibly missing from lobes that draw directions.
    let horizon = (0..HORIZON * usize::from(drawn.is_some())).map(|i| {
        let d = direction(FRAC_PI_2 - ABOVE_HORIZON, PI * (i as f64 + 0.5) / HORIZON as f64);
        Sample { direction: d, rgb: value(brdf, d, wo), weight: 0.0 }
    });
    weighed.chain(horizon).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Gloss(f64);
    impl Brdf for Gloss {
        fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
            let mirror = [-wo[0], -wo[1], wo[2]];
            let chord: f64 = (0..3).map(|k| (wi[k] - mirror[k]) * (wi[k] - mirror[k])).sum();
            let lobe = 0.5 * self.0 / (2.0 * PI) * libm::exp(-0.5 * self.0 * chord);
            [(0.3 / PI) + lobe / wi[2]; 3]
        }
    }

    #[test]
    fn the_albedo_is_that_of_the_peak_whatever_its_width() {
        for s in [30.0, 1e3, 1e5, 1e6] {
            let table = Table::from_brdf(&Gloss(s), &[0.0, 0.5, 1.0], Density::default()).unwrap();
            for view in &table.views {
                assert!((view.albedo[0] - 0.8).abs() < 0.02, "{s} {}: {:?}", view.theta, view.albedo);
            }
        }
    }
}
