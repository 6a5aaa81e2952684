//! What every way of fitting has in common, so that one judge can compare them: our tracked lobes, the thesis's, Lafortune's.

use crate::FitError;
use crate::table::Table;

/// A way of fitting a table.
pub trait Method: Sync {
    /// Fits a table.
    ///
    /// # Errors
    /// [`FitError`], as the method says.
    fn fit(&self, table: &Table) -> Result<Box<dyn Fitted>, FitError>;
}

/// A BRDF as a fit knows it.
pub trait Fitted: Sync {
    /// Makes what the fit says of an angle of the outgoing direction from the normal, radians.
    ///
    /// # Errors
    /// [`FitError`] for a fit that is none, and an angle outside [0, pi / 2].
    fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError>;
}

/// What a fit says of one outgoing direction. Directions are unit vectors with z > 0, in the frame of the view.
pub trait FittedView {
    /// `f cos`, linear sRGB; 1/sr.
    fn f_cos(&self, direction: [f64; 3]) -> [f64; 3];

    /// Density of sampling the lobes, 1/sr; `None` for a method that does not sample.
    fn pdf(&self, _direction: [f64; 3]) -> Option<f64> {
        None
    }

    /// Directional albedo in closed form; `None` where there is none.
    fn albedo(&self) -> Option<[f64; 3]> {
        None
    }
}
