//! What can be evaluated at any pair of directions.

/// A BRDF that can be evaluated.
pub trait Brdf: Sync {
    /// The BRDF f, linear sRGB; 1/sr. Both directions are unit vectors with z > 0, in the frame of the surface.
    ///
    /// Channels of colours outside the gamut are negative. What is not a finite number, where nothing was measured, counts as 0.
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3];

    /// What turning or mirroring both directions leaves as it is.
    fn symmetry(&self) -> Symmetry {
        Symmetry::Isotropic
    }
}

/// What turning or mirroring both directions of a BRDF leaves as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// Every turn round the normal, and every mirror.
    Isotropic,
    /// The mirrors x -> -x and y -> -y.
    Quadrant,
    /// Half a turn round the normal.
    HalfTurn,
    /// Nothing.
    None,
}
