//! Estimators: the weights that combine techniques, and a mixture with a defensive component, whose weights are
//! bounded.

use crate::error::Error;
use crate::float;
use crate::kernel::draw::draw_one;
use crate::mixture::rows::{AnyMixture, Domain, Sample, weight_of};
use crate::simd::lanes::scale;
use core::f32::consts::FRAC_1_PI;
use glam::Vec3;

/// Weight of a sample that technique A drew, where A draws `count_a` samples with density `pdf_a` there and B
/// `count_b` with `pdf_b`: `(n_a p_a)^2 / ((n_a p_a)^2 + (n_b p_b)^2)`.
///
/// Returns: in [0, 1]; with the weight of B it sums to 1; 0 where both densities are 0.
/// Lower variance where one technique is much the better one. The square is of the ratio, so that a density
/// of 1e30 does not overflow.
/// Source: Veach and Guibas 1995, beta = 2.
#[inline]
pub fn power_heuristic(count_a: f32, pdf_a: f32, count_b: f32, pdf_b: f32) -> f32 {
    let ratio = weight_ratio(count_a, pdf_a, count_b, pdf_b);
    ratio.map_or(0.0, |r| 1.0 / (1.0 + r * r))
}

/// `n_b p_b / (n_a p_a)`, infinite where A cannot draw the sample; `None` where neither can.
#[inline]
fn weight_ratio(count_a: f32, pdf_a: f32, count_b: f32, pdf_b: f32) -> Option<f32> {
    if count_a > 0.0 && pdf_a > 0.0 {
        Some((count_b / count_a) * (pdf_b / pdf_a)).map(|r| if r.is_nan() { 0.0 } else { r })
    } else {
        (count_b > 0.0 && pdf_b > 0.0).then_some(f32::INFINITY)
    }
}

/// A cosine-weighted direction of the upper hemisphere: heights `z = sqrt(1 - u)`.
fn cosine_weighted(u: [f32; 2]) -> Vec3 {
    let (sin_phi, cos_phi) = float::sin_cos_turns(u[1]);
    let across = float::sqrt(u[0]);
    Vec3::new(across * cos_phi, across * sin_phi, float::sqrt(1.0 - u[0]))
}

/// A mixture with a defensive component: with probability `share` a cosine-weighted direction of the
/// hemisphere (a uniform one of the sphere for a mixture there), else one of the mixture.
///
/// For a renderer that keeps another function as the truth, the measured table for example, and uses the
/// mixture to sample it: where the mixture misses the table, the weight stays bounded. Since
/// `pdf >= share cos / pi`, the weight `f cos / pdf` of a BRDF of at most `m` is at most `pi m / share`; on the sphere,
/// of a function of at most `m`, `4 pi m / share`.
///
/// # Examples
/// ```
/// use srbf_core::{Defensive, Lobe, Mixture};
///
/// let mixture = Mixture::<16>::hemisphere(&[Lobe::new([0.6, 0.0, 0.8], 500.0, [1.0; 3])?])?;
/// let defensive = Defensive::new(&mixture, 0.1)?;
/// // Far from the lobe the mixture has no density, and a tenth of the cosine's is left.
/// let away = [-0.6, 0.0, 0.8];
/// assert_eq!(mixture.pdf(away), 0.0);
/// assert!((defensive.pdf(away) - 0.1 * 0.8 / std::f32::consts::PI).abs() < 1e-5);
/// # Ok::<(), srbf_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Defensive<'a> {
    mixture: &'a AnyMixture<'a>,
    share: f32,
}

impl<'a> Defensive<'a> {
    /// Adds a defensive component of a share in [0, 1]; 0.02 to 0.05 serves well. A black mixture gives it
    /// all.
    ///
    /// # Errors
    /// [`Error::Share`] for a share outside the range.
    pub fn new(mixture: &'a AnyMixture<'a>, share: f32) -> Result<Self, Error> {
        if !(0.0..=1.0).contains(&share) {
            return Err(Error::Share);
        }
        Ok(Self { mixture, share: if mixture.head.power == 0.0 { 1.0 } else { share } })
    }

    /// Evaluates the density; 1/sr.
    #[inline]
    pub fn pdf(&self, direction: impl Into<Vec3>) -> f32 {
        let direction = direction.into();
        self.mix(direction, self.mixture.pdf(direction))
    }

    #[inline]
    fn mix(&self, direction: Vec3, pdf: f32) -> f32 {
        let defensive = match self.mixture.head.domain {
            Domain::Hemisphere => direction.z.max(0.0) * FRAC_1_PI,
            Domain::Sphere => 0.25 * FRAC_1_PI,
        };
        (1.0 - self.share) * pdf + self.share * defensive
    }

    /// Draws a direction, three uniform numbers in [0, 1); `pdf` is the whole density, `weight` the mixture's value over it.
    ///
    #[inline]
    pub fn sample(&self, u: [f32; 3]) -> Sample {
        let direction = if u[0] < self.share {
            match self.mixture.head.domain {
                Domain::Hemisphere => cosine_weighted([u[1], u[2]]),
                Domain::Sphere => {
                    // Heights z = 1 - 2 u are uniform.
                    let (sin_phi, cos_phi) = float::sin_cos_turns(u[2]);
                    let across = 2.0 * float::sqrt(u[1] * (1.0 - u[1]));
                    Vec3::new(across * cos_phi, across * sin_phi, 1.0 - 2.0 * u[1])
                }
            }
        } else {
            let lobe = ((u[0] - self.share) / (1.0 - self.share)).min(float::BELOW_ONE);
            let (d, inverse) = draw_one::<f32, true>(self.mixture, [lobe, u[1], u[2]]);
            Vec3::from_array(scale(d, inverse))
        };
        let (value, pdf) = self.mixture.evaluate_and_pdf(direction);
        let pdf = self.mix(direction, pdf);
        Sample { direction, pdf, weight: weight_of(value, pdf) }
    }
}
