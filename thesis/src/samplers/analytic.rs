//! One analytic lobe beside a cosine: what most renderers have for a measured material, fitted to it.
//!
//! The width of the lobe is one number for all outgoing directions, from a grid; the share of the lobe depends on the angle, as a
//! Fresnel term would have it, and is the one with the least variance. The width is the one with the least mean logarithm of the
//! relative second moment over the angles: fitted is the density, not the value.

use super::Reflection;
use super::ggx;
use super::plain::{around, cosine, cosine_density, mirrored};
use super::probe::{self, THETAS};
use super::views::{Look, look};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// Widths that are tried.
const WIDTHS: usize = 48;

/// Widest and narrowest, as the roughness of GGX and Ward; Phong's exponent is `2 / roughness^2`.
const ROUGHNESS: [f64; 2] = [1.0, 0.002];

/// Least share of the cosine while the fit looks at a variance: without it one direction that a lobe misses decides.
const LEAST_COSINE: f64 = 0.05;

/// The shape of a lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// `cos^n` round the mirror direction (Lafortune and Willems 1994).
    Phong {
        /// Exponent of the cosine.
        exponent: f64,
    },
    /// Half vectors by a Gaussian of their slope (Ward 1992; Walter 2005, "Notes on the Ward BRDF").
    Ward {
        /// Roughness.
        alpha: f64,
    },
    /// Visible normals.
    Ggx {
        /// Roughness.
        alpha: f64,
    },
}

impl Lobe {
    /// Phong's lobe of the width that a roughness has.
    pub fn phong(roughness: f64) -> Self {
        Self::Phong { exponent: 2.0 / (roughness * roughness) }
    }

    /// Ward's lobe of a roughness.
    pub fn ward(alpha: f64) -> Self {
        Self::Ward { alpha }
    }

    /// Visible normals of a roughness.
    pub fn ggx(alpha: f64) -> Self {
        Self::Ggx { alpha }
    }

    /// Draws a direction, maybe below the horizon.
    #[inline]
    pub fn sample(self, wo: DVec3, u: f64, v: f64) -> DVec3 {
        match self {
            Self::Phong { exponent } => {
                let one_minus_cos = -((-v).ln_1p() / (exponent + 1.0)).exp_m1();
                around(DVec3::new(-wo.x, -wo.y, wo.z), one_minus_cos, u)
            }
            Self::Ward { alpha } => {
                let tangent = alpha * (-(-v).ln_1p()).sqrt();
                let (sin, cos) = (TAU * u).sin_cos();
                mirrored(wo, DVec3::new(tangent * cos, tangent * sin, 1.0).normalize())
            }
            Self::Ggx { alpha } => ggx::reflect(wo, alpha, u, v),
        }
    }

    /// Density of [`sample`](Self::sample); 1/sr.
    #[inline]
    pub fn density(self, wo: DVec3, wi: DVec3) -> f64 {
        match self {
            Self::Phong { exponent } => {
                let chord = (wi - DVec3::new(-wo.x, -wo.y, wo.z)).length_squared();
                if chord >= 2.0 {
                    return 0.0;
                }
                (exponent + 1.0) / TAU * (exponent * (-0.5 * chord).ln_1p()).exp()
            }
            Self::Ward { alpha } => {
                let h = (wo + wi).normalize_or(DVec3::Z);
                let cosine = wo.dot(h);
                if h.z <= 0.0 || cosine <= 0.0 {
                    return 0.0;
                }
                let slope = (h.x * h.x + h.y * h.y) / (h.z * h.z * alpha * alpha);
                (-slope).exp() / (4.0 * PI * alpha * alpha * h.z * h.z * h.z * cosine)
            }
            Self::Ggx { alpha } => ggx::density(ggx::half_squared(wo, wi), alpha, ggx::scale(wo, alpha)),
        }
    }
}

/// A lobe, and its share over the angle of the outgoing direction.
#[derive(Clone, Debug)]
pub struct Analytic {
    /// The lobe.
    pub lobe: Lobe,
    shares: [f64; THETAS],
}

impl Analytic {
    /// Fits a lobe: the best of those that a function makes of a roughness.
    pub fn fit(lobe: fn(f64) -> Lobe, reflection: &dyn Reflection) -> Self {
        let views = look(reflection);
        let width =
            |n: usize| ROUGHNESS[0] * (ROUGHNESS[1] / ROUGHNESS[0]).powf(n as f64 / (WIDTHS - 1) as f64);
        let tried = (0..WIDTHS).into_par_iter().map(|n| at_width(lobe(width(n)), &views));
        let tried: Vec<(f64, Self)> = tried.collect();
        tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).expect("there are widths").1
    }

    /// Gets ready for an outgoing direction.
    #[inline]
    pub fn proposal(&self, wo: DVec3) -> AnalyticProposal {
        let (before, along) = probe::place(wo.z, THETAS);
        let share = self.shares[before] + along * (self.shares[before + 1] - self.shares[before]);
        AnalyticProposal { lobe: self.lobe, wo, share }
    }
}

/// The shares of a lobe, and how well it then does.
fn at_width(lobe: Lobe, views: &[Look]) -> (f64, Analytic) {
    let (mut cost, mut shares) = (0.0, [0.0; THETAS]);
    for (share, view) in shares.iter_mut().zip(views) {
        let all = || view.azimuths.iter().flat_map(|(wo, seen)| seen.iter().map(move |s| (*wo, s)));
        let moments: Vec<(f64, [f64; 2])> = all()
            .map(|(wo, s)| {
                (s.value * s.value * s.weight, [lobe.density(wo, s.wi), s.wi.z.max(0.0) * FRAC_1_PI])
            })
            .collect();
        *share = probe::least_variance(&moments)[0].min(1.0 - LEAST_COSINE);
        let mean: f64 = all().map(|(_, s)| s.value * s.weight).sum();
        let second: f64 = moments.iter().map(|(m, [a, b])| m / (*share * a + (1.0 - *share) * b)).sum();
        if mean > 0.0 {
            cost += (second / (mean * mean)).ln();
        }
    }
    (cost, Analytic { lobe, shares })
}

/// The two parts for one outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct AnalyticProposal {
    lobe: Lobe,
    wo: DVec3,
    share: f64,
}

impl AnalyticProposal {
    /// Draws a direction, maybe below the horizon.
    #[inline]
    pub fn sample(&self, [part, u, v]: [f64; 3]) -> DVec3 {
        if part < self.share { self.lobe.sample(self.wo, u, v) } else { cosine(u, v) }
    }

    /// Density of [`sample`](Self::sample); 1/sr.
    #[inline]
    pub fn density(&self, wi: DVec3) -> f64 {
        self.share * self.lobe.density(self.wo, wi) + (1.0 - self.share) * cosine_density(wi)
    }
}
