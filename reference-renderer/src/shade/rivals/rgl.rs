//! The sampling that a `.bsdf` file brings along (Dupuy and Jakob 2018): its warps by brightness and by visible normals.

use glam::DVec3;
use srbf_fit::table::Draws;

/// The warps for one outgoing direction.
#[derive(Clone, Copy)]
pub struct RglProposal<'a> {
    draws: &'a dyn Draws,
    wo: DVec3,
}

impl<'a> RglProposal<'a> {
    /// Gets ready for an outgoing direction.
    pub fn new(draws: &'a dyn Draws, wo: DVec3) -> Self {
        Self { draws, wo }
    }

    /// Draws a direction, maybe below the horizon.
    pub fn sample(&self, [_, u, v]: [f64; 3]) -> DVec3 {
        DVec3::from(self.draws.draw([u, v], self.wo.to_array())).normalize_or(DVec3::Z)
    }

    /// Density of [`sample`](Self::sample); 1/sr.
    pub fn density(&self, wi: DVec3) -> f64 {
        self.draws.density(wi.to_array(), self.wo.to_array()).max(0.0)
    }
}
