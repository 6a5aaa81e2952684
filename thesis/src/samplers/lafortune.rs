//! Lafortune's generalised cosine lobes, sampled as Weng and Shih 2006 do: a lobe by its integral, a direction by `cos^n` round the axis
//! that the coefficients make of the outgoing direction. What falls below the horizon is lost.

use super::plain::{around, cosine, cosine_density};
use crate::lafortune::{Lafortune, LafortuneSettings};
use glam::DVec3;
use srbf_core::LUMINANCE;
use srbf_fit::FitError;
use srbf_fit::table::Brdf;
use srbf_fit::table::evaluation_views::even_views;
use srbf_fit::table::{Density, Table};
use std::f64::consts::TAU;

/// Lobes, as in the thesis; its hundred starts take most of a minute and end where these do.
const SETTINGS: LafortuneSettings = LafortuneSettings { lobes: 3, starts: 30, steps: 120 };

/// Outgoing directions of the table that is fitted, and its incident ones.
const VIEWS: usize = 8;
const DENSITY: Density = Density { hemisphere: 200, cap: 40 };

/// Most lobes: three of each channel.
const MOST: usize = 9;

/// Least height of an axis that a lobe's integral is reckoned with.
const LEAST_HEIGHT: f64 = 0.05;

/// Exponents above are sharper than any double tells apart.
const MOST_EXPONENT: f64 = 1e9;

/// Fits the model.
///
/// # Errors
/// An anisotropic reflection, and a black one.
pub fn fit(reflection: &dyn Brdf) -> Result<Lafortune, FitError> {
    let table = Table::from_brdf(reflection, &even_views(VIEWS), DENSITY)?;
    Lafortune::fit(&table, &SETTINGS)
}

/// The lobes for one outgoing direction.
#[derive(Clone, Debug)]
pub struct LafortuneProposal {
    count: usize,
    /// Share of a lobe, its axis and exponent.
    lobes: [(f64, DVec3, f64); MOST],
    cosine: f64,
}

impl LafortuneProposal {
    /// Gets ready. Coefficients of which powers overflow, or are no numbers, do no harm: shares are made of logarithms.
    pub fn new(model: &Lafortune, wo: DVec3) -> Self {
        let mut lobes = [(0.0, DVec3::Z, 1.0); MOST];
        let (mut logs, mut count, mut diffuse) = ([f64::NEG_INFINITY; MOST], 0, 0.0);
        for (channel, share) in model.channels.iter().zip(LUMINANCE) {
            diffuse += f64::from(share) * channel.diffuse.max(0.0);
            for lobe in &channel.lobes {
                let axis = DVec3::new(lobe.cxy * wo.x, lobe.cxy * wo.y, lobe.cz * wo.z);
                let length = axis.length();
                let n = lobe.n.clamp(0.0, MOST_EXPONENT);
                // Below the horizon only the rim of a lobe is seen.
                let is_drawn = length > 0.0 && length.is_finite() && lobe.n.is_finite() && axis.z > 0.0;
                if !is_drawn || count == MOST {
                    continue;
                }
                let axis = axis / length;
                let integral = f64::from(share) * TAU / (n + 1.0) * axis.z.max(LEAST_HEIGHT);
                lobes[count] = (0.0, axis, n);
                logs[count] = n * length.ln() + integral.ln();
                count += 1;
            }
        }
        let largest = logs.iter().copied().fold(diffuse.ln(), f64::max);
        if !largest.is_finite() {
            return Self { count: 0, lobes, cosine: 1.0 };
        }
        (0..count).for_each(|k| lobes[k].0 = (logs[k] - largest).exp());
        let cosine = (diffuse.ln() - largest).exp();
        let sum = cosine + lobes.iter().map(|lobe| lobe.0).sum::<f64>();
        lobes.iter_mut().for_each(|lobe| lobe.0 /= sum);
        Self { count, lobes, cosine: cosine / sum }
    }

    /// Draws a direction, maybe below the horizon.
    #[inline]
    pub fn sample(&self, [part, u, v]: [f64; 3]) -> DVec3 {
        let mut left = part;
        for &(share, axis, n) in &self.lobes[..self.count] {
            if left < share {
                return around(axis, -((-v).ln_1p() / (n + 1.0)).exp_m1(), u);
            }
            left -= share;
        }
        cosine(u, v)
    }

    /// Density of [`sample`](Self::sample); 1/sr.
    #[inline]
    pub fn density(&self, wi: DVec3) -> f64 {
        let mut sum = self.cosine * cosine_density(wi);
        for &(share, axis, n) in &self.lobes[..self.count] {
            let half_chord = 0.5 * (wi - axis).length_squared();
            if half_chord < 1.0 {
                sum += share * (n + 1.0) / TAU * (n * (-half_chord).ln_1p()).exp();
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lafortune::{Channel, CosineLobe};

    #[test]
    fn coefficients_that_explode_do_no_harm() {
        for (cxy, cz, n) in [
            (-1.6, 1.7, 5e4),
            (-1e300, 1e300, 3.0),
            (f64::NAN, 1.0, 3.0),
            (-1.0, 1.0, f64::INFINITY),
            (0.0, 0.0, 1.0),
            (0.5, -0.5, 20.0),
        ] {
            let channel = Channel { diffuse: 0.1, lobes: vec![CosineLobe { cxy, cz, n }; 3] };
            let model = Lafortune { channels: [channel.clone(), channel.clone(), channel], evaluations: 0 };
            let wo = DVec3::new(-0.6, 0.0, 0.8);
            let proposal = LafortuneProposal::new(&model, wo);
            for part in [0.0, 0.4, 0.999] {
                let wi = proposal.sample([part, 0.3, 0.7]);
                assert!(wi.is_normalized(), "{cxy} {cz} {n}: {wi}");
                let density = proposal.density(wi);
                assert!(density >= 0.0 && density.is_finite(), "{cxy} {cz} {n}: {density}");
            }
        }
        let black = LafortuneProposal::new(&Lafortune::default(), DVec3::Z);
        assert_eq!(black.cosine, 1.0);
    }
}
