//! Functions that can be evaluated at any pair of directions.

/// A BRDF that can be evaluated.
///
/// # Examples
/// ```
/// use srbf_measured::table::{Brdf, evaluation_views};
///
/// struct Lambert;
///
/// impl Brdf for Lambert {
///     fn evaluate(&self, _wi: [f64; 3], _wo: [f64; 3]) -> [f64; 3] {
///         [0.5 / std::f64::consts::PI; 3]
///     }
/// }
///
/// let table = evaluation_views::judging_table(&Lambert, &[0.0, 0.5])?;
/// assert!((table.views[1].albedo[0] - 0.5).abs() < 1e-3);
/// # Ok::<(), srbf_measured::FitError>(())
/// ```
pub trait Brdf: Sync {
    /// The BRDF f, linear sRGB; 1/sr. Both directions are unit vectors with z > 0, in the frame of the surface.
    ///
    /// Channels of colours outside the gamut are negative. A value that is not finite, where nothing was measured, counts as 0.
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3];

    /// Share of the value that was measured, 0 to 1; the rest is by a completion.
    fn measured(&self, _wi: [f64; 3], _wo: [f64; 3]) -> f64 {
        1.0
    }

    /// What turning or mirroring both directions leaves as it is.
    fn symmetry(&self) -> Symmetry {
        Symmetry::Isotropic
    }

    /// What its file brings along to draw incident directions by; `None` if it brings nothing.
    fn draws(&self) -> Option<&dyn Draws> {
        None
    }
}

/// Draws incident directions with a density that is about proportional to `f cos`, in f32, as renderers do. Directions are those of
/// [`Brdf::evaluate`].
pub trait Draws: Sync {
    /// Takes two uniform numbers in [0, 1) to an incident direction, a unit vector, which may lie below the horizon; and the value and
    /// density that the draw brings along.
    fn draw(&self, u: [f32; 2], wo: [f32; 3]) -> ([f32; 3], Known);

    /// Value and density of an incident direction; 0 below the horizon.
    fn look_up(&self, wi: [f32; 3], wo: [f32; 3]) -> Known;
}

/// Of an incident direction, its value and the density of drawing it; finite numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Known {
    /// `f cos`, linear sRGB; 1/sr.
    pub value: [f32; 3],
    /// Density; 1/sr.
    pub density: f32,
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
