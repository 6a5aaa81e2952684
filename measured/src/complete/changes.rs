//! What changes the values of a surface, beside the angles that an isotropic one is a function of.

use super::pair::Pair;
use super::turn::Turn;
use crate::table::Symmetry;

/// A turn of the surface, and an exchange of both directions.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Changes {
    /// The axis, if a turn changes values.
    pub turn: Option<Turn>,
    /// Whether an exchange of both directions does: that of the transmission of a sheet whose sides differ.
    pub sides: bool,
}

impl From<Turn> for Changes {
    fn from(turn: Turn) -> Self {
        Self { turn: Some(turn), sides: false }
    }
}

impl Changes {
    /// A pair of directions as such a surface sees it.
    pub fn pair(&self, wi: [f64; 3], wo: [f64; 3]) -> Pair {
        let pair = self.turn.map_or_else(|| Pair::new(wi, wo), |turn| Pair::turned(wi, wo, &turn));
        if self.sides { pair.told_apart() } else { pair }
    }

    /// The symmetry that is left.
    pub fn symmetry(&self) -> Symmetry {
        self.turn.map_or(Symmetry::Isotropic, |turn| turn.symmetry())
    }

    /// Azimuth of the axis, radians; 0 without one.
    pub fn axis(&self) -> f64 {
        self.turn.map_or(0.0, |turn| turn.axis)
    }
}
