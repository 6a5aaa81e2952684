//! Functions that can be evaluated at any pair of directions.

use super::{BLACK, direction};
use std::f64::consts::PI;

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

    /// Azimuth of a mirror of [`Symmetry::Quadrant`], radians.
    fn axis(&self) -> f64 {
        0.0
    }

    /// What its file brings along to draw incident directions by; `None` if it brings nothing.
    fn draws(&self) -> Option<&dyn Draws> {
        None
    }
}

/// A surface of which nothing was measured to be brighter than 0. Lobes need some brightness, and have that of [`BLACK`].
struct Black;

impl Brdf for Black {
    fn evaluate(&self, _: [f64; 3], _: [f64; 3]) -> [f64; 3] {
        [BLACK; 3]
    }
}

/// Angles from the normal, of each direction, and azimuths between both at which a BRDF is looked at; all mirror directions among them.
const ANGLES: i32 = 18;
const AZIMUTHS: i32 = 12;

/// The BRDF, or a black one in its place if it is nowhere above 0.
#[doc(hidden)]
pub fn or_black(brdf: &dyn Brdf) -> &dyn Brdf {
    let angle = |n: i32| f64::from(n) * 5.0 * PI / 180.0;
    let is_bright = |i: i32, o: i32, turn: i32| {
        let azimuth = f64::from(turn) * 2.0 * PI / f64::from(AZIMUTHS);
        // Another azimuth of the surface for each, should it be anisotropic.
        let at = 0.7 * f64::from(i + 3 * o);
        brdf.evaluate(direction(angle(i), at), direction(angle(o), at + azimuth)).iter().any(|v| *v > 0.0)
    };
    let mut all = (0..ANGLES).flat_map(|i| (0..ANGLES).map(move |o| (i, o)));
    if all.any(|(i, o)| (0..AZIMUTHS).any(|turn| is_bright(i, o, turn))) { brdf } else { &Black }
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
    /// Two mirrors that contain the normal: along an [axis](Brdf::axis), x if no other is named, and across it.
    Quadrant,
    /// Half a turn round the normal.
    HalfTurn,
    /// Nothing.
    None,
}
