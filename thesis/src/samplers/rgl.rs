//! The sampling that a `.bsdf` file brings along (Dupuy and Jakob 2018): its warps by brightness and by visible normals. Value and
//! density of a draw come with it.

use glam::Vec3;
use srbf_fit::table::{Draws, Known};

/// The warps for one outgoing direction.
#[derive(Clone, Copy)]
pub struct RglProposal<'a> {
    draws: &'a dyn Draws,
    wo: Vec3,
}

impl<'a> RglProposal<'a> {
    /// Gets ready for an outgoing direction.
    pub fn new(draws: &'a dyn Draws, wo: Vec3) -> Self {
        Self { draws, wo }
    }

    /// Draws a direction, maybe below the horizon; with its value and density, 1/sr.
    #[inline]
    pub fn draw(&self, [_, u, v]: [f32; 3]) -> (Vec3, Known) {
        let (direction, known) = self.draws.draw([u, v], self.wo.to_array());
        (Vec3::from(direction).normalize_or(Vec3::Z), known)
    }

    /// Value and density of a direction; 1/sr.
    #[inline]
    pub fn look_up(&self, wi: Vec3) -> Known {
        self.draws.look_up(wi.to_array(), self.wo.to_array())
    }
}
