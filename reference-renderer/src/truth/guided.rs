//! Directions for a table: a mixture of a cosine and of GGX lobes of fixed roughness, whose weights depend on the outgoing
//! direction and are found from the table itself.
//!
//! The weights have the least variance among all mixtures of these parts. They are tabulated over the outgoing direction and
//! interpolated; whatever they are, the density is exact, and the estimate unbiased.

use glam::DVec3;
use rayon::prelude::*;
use srbf_thesis::samplers::ggx_parts::{COSINE, GgxProposal, PARTS, Weights};
use srbf_thesis::samplers::probe;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Share of the cosine that is always there, whatever the weights: it bounds `f cos / pdf` where the table has a highlight that
/// its tabulation did not see.
const DEFENSIVE: f64 = 0.1;

/// Angles of the outgoing direction at which weights are tabulated, and azimuths of anisotropic materials.
const THETAS: usize = 48;
const AZIMUTHS: usize = 32;

/// Directions that each part draws to find the weights, of isotropic and of anisotropic materials.
const DRAWN: [usize; 2] = [320, 96];

/// The weights over the outgoing direction.
#[derive(Clone, Debug)]
pub struct Guide {
    azimuths: usize,
    /// Theta fastest.
    weights: Vec<Weights>,
}

impl Guide {
    /// Finds the weights for `f cos` of incident and outgoing direction.
    pub fn new(f_cos: &(dyn Fn(DVec3, DVec3) -> DVec3 + Sync), is_isotropic: bool) -> Self {
        let azimuths = if is_isotropic { 1 } else { AZIMUTHS };
        let at = |n: usize| {
            let (sin, cos) = (FRAC_PI_2 * (n % THETAS) as f64 / (THETAS - 1) as f64).min(1.57).sin_cos();
            let azimuth = PI + TAU * (n / THETAS) as f64 / azimuths as f64;
            let wo = DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos);
            least_variance(&|wi| f_cos(wi, wo), wo, DRAWN[usize::from(!is_isotropic)])
        };
        Self { azimuths, weights: (0..THETAS * azimuths).into_par_iter().map(at).collect() }
    }

    /// The mixture for an outgoing direction.
    pub fn proposal(&self, wo: DVec3) -> GgxProposal {
        let place = wo.z.clamp(0.0, 1.0).acos() / FRAC_PI_2 * (THETAS - 1) as f64;
        let theta = (place as usize).min(THETAS - 2);
        let along = place - theta as f64;
        let turns = (wo.y.atan2(wo.x) - PI) / TAU;
        let turned = (turns - turns.floor()) * self.azimuths as f64;
        let azimuth = (turned as usize).min(self.azimuths - 1);
        let across = turned - azimuth as f64;
        let mut weights = [0.0; PARTS];
        for (azimuth, share) in [(azimuth, 1.0 - across), ((azimuth + 1) % self.azimuths, across)] {
            let row = azimuth * THETAS + theta;
            let [low, high] = [&self.weights[row], &self.weights[row + 1]];
            for (k, weight) in weights.iter_mut().enumerate() {
                *weight += share * (low[k] + along * (high[k] - low[k]));
            }
        }
        GgxProposal::new(wo, weights)
    }
}

/// The weights for which samples of the mixture have the least variance, the cosine's raised to its least share.
fn least_variance(f_cos: &dyn Fn(DVec3) -> DVec3, wo: DVec3, drawn: usize) -> Weights {
    let proposal = GgxProposal::even(wo);
    let seen = probe::directions(wo, drawn, f_cos);
    let moments: Vec<(f64, Weights)> =
        seen.iter().map(|s| (s.value * s.value * s.weight, proposal.densities(s.wi))).collect();
    let mut weights = probe::least_variance(&moments);
    weights.iter_mut().for_each(|weight| *weight *= 1.0 - DEFENSIVE);
    weights[COSINE] += DEFENSIVE;
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::random::Random;
    use srbf_thesis::samplers::ggx_parts::ROUGHNESS;

    fn direction(degrees: f64, azimuth: f64) -> DVec3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos)
    }

    #[test]
    fn samples_of_every_part_have_its_density() {
        // Moments of the direction, by samples of the part and by the density at directions of the cosine or of a rougher lobe.
        for (degrees, azimuth) in [(0.0, 0.0), (40.0, 1.0), (80.0, -2.0)] {
            let wo = direction(degrees, azimuth);
            for part in 0..PARTS {
                let wide = if part == COSINE { 0 } else { part.checked_sub(1).unwrap_or(COSINE) };
                let (n, mut random) = (200_000, Random::new(part as u64, 1, 2));
                let proposal = GgxProposal::new(wo, [1.0 / PARTS as f64; PARTS]);
                let mirror = DVec3::new(-wo.x, -wo.y, wo.z);
                let of = |wi: DVec3| {
                    let near = (wi - mirror).length_squared() / ROUGHNESS.get(part).map_or(1.0, |a| a * a);
                    [1.0, (-near).exp(), wi.y].map(|v| if wi.z > 0.0 { v } else { 0.0 })
                };
                let (mut ours, mut theirs, mut squares) = ([0.0; 3], [0.0; 3], [0.0; 3]);
                for _ in 0..n {
                    let mut unit = || f64::from(random.unit());
                    let direct = of(proposal.draw(part, unit(), unit()));
                    let other = proposal.draw(wide, unit(), unit());
                    let densities = proposal.densities(other);
                    let ratio = if other.z > 0.0 { densities[part] / densities[wide] } else { 0.0 };
                    let weighed = of(other).map(|v| v * ratio);
                    for k in 0..3 {
                        ours[k] += direct[k] / f64::from(n);
                        theirs[k] += weighed[k] / f64::from(n);
                        squares[k] += (direct[k] * direct[k] + weighed[k] * weighed[k]) / f64::from(n);
                    }
                }
                for k in 0..3 {
                    let error = (squares[k] / f64::from(n)).sqrt();
                    let deviation = (ours[k] - theirs[k]).abs();
                    assert!(deviation < 4.5 * error, "{degrees} {part} {k}: {ours:?} {theirs:?} +- {error}");
                    assert!(error < 0.02, "{degrees} {part} {k}: +- {error}");
                }
            }
        }
    }

    #[test]
    fn weights_find_the_roughness() {
        let guide = Guide::new(
            &|wi, wo| {
                DVec3::splat(
                    GgxProposal::new(wo, {
                        let mut weights = [0.0; PARTS];
                        weights[6] = 1.0;
                        weights
                    })
                    .density(wi),
                )
            },
            true,
        );
        for degrees in [0.0, 30.0, 60.0, 80.0] {
            let proposal = guide.proposal(direction(degrees, 0.7));
            assert!(proposal.weights[6] > 0.8, "{degrees}: {:?}", proposal.weights);
            assert!((proposal.weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        }
        // A black material is sampled too.
        let guide = Guide::new(&|_, _| DVec3::ZERO, false);
        let weights = guide.proposal(direction(40.0, 3.0)).weights;
        assert!(
            weights[COSINE] >= DEFENSIVE && (weights.iter().sum::<f64>() - 1.0).abs() < 1e-9,
            "{weights:?}"
        );
    }
}
