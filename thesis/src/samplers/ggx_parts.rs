//! A cosine and GGX lobes of fixed roughness, for one outgoing direction: together they meet a highlight of any width.

use super::ggx;
use super::plain::{cosine, cosine_density};
use glam::DVec3;

/// Roughness of the lobes. A step of 2.3 costs little: the density between two of them is a mixture of both.
pub const ROUGHNESS: [f64; 8] = [1.0, 0.44, 0.19, 0.083, 0.036, 0.016, 0.007, 0.003];

/// The lobes, and the cosine as the last.
pub const PARTS: usize = ROUGHNESS.len() + 1;
/// Number of the cosine among them.
pub const COSINE: usize = ROUGHNESS.len();

/// Weights of the parts.
pub type Weights = [f64; PARTS];

/// The mixture for one outgoing direction.
#[derive(Clone, Debug)]
pub struct GgxProposal {
    wo: DVec3,
    /// Weight of each part.
    pub weights: Weights,
    /// The constant part of the density of each lobe.
    scale: [f64; ROUGHNESS.len()],
}

impl GgxProposal {
    /// The mixture with weights.
    pub fn new(wo: DVec3, weights: Weights) -> Self {
        Self { wo, weights, scale: ROUGHNESS.map(|alpha| ggx::scale(wo, alpha)) }
    }

    /// All parts alike: together they meet a highlight of any width.
    pub fn even(wo: DVec3) -> Self {
        Self::new(wo, [1.0 / PARTS as f64; PARTS])
    }

    /// Density of each part at an incident direction; 1/sr.
    #[inline]
    pub fn densities(&self, wi: DVec3) -> Weights {
        let mut densities = [0.0; PARTS];
        if wi.z > 0.0 {
            let half = ggx::half_squared(self.wo, wi);
            for k in 0..ROUGHNESS.len() {
                densities[k] = ggx::density(half, ROUGHNESS[k], self.scale[k]);
            }
            densities[COSINE] = cosine_density(wi);
        }
        densities
    }

    /// Density of the mixture; 1/sr. Its integral is less than 1: of a lobe, some directions lie below the horizon.
    #[inline]
    pub fn density(&self, wi: DVec3) -> f64 {
        self.densities(wi).iter().zip(&self.weights).map(|(density, weight)| density * weight).sum()
    }

    /// Draws a direction, maybe below the horizon.
    #[inline]
    pub fn sample(&self, [part, u, v]: [f64; 3]) -> DVec3 {
        let mut left = part;
        for (alpha, weight) in ROUGHNESS.into_iter().zip(self.weights) {
            if left < weight {
                return ggx::reflect(self.wo, alpha, u, v);
            }
            left -= weight;
        }
        cosine(u, v)
    }

    /// Draws a direction of one part, maybe below the horizon.
    #[inline]
    pub fn draw(&self, part: usize, u: f64, v: f64) -> DVec3 {
        if part == COSINE { cosine(u, v) } else { ggx::reflect(self.wo, ROUGHNESS[part], u, v) }
    }
}
