//! The interface of all methods of fitting, so that one judge can compare them: our tracked lobes, the thesis's, Lafortune's.

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
    /// The fit at an outgoing direction; `theta` is its angle from the normal, radians.
    ///
    /// # Errors
    /// [`FitError`] for bytes that are no fit, and an angle outside [0, pi / 2].
    fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError>;

    /// The same at an azimuth round the normal, radians, for a fit to which it matters. Directions stay in the frame of the view,
    /// where the outgoing one is at -x.
    ///
    /// # Errors
    /// As [`view`](Self::view).
    fn view_at(&self, theta: f64, _azimuth: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
        self.view(theta)
    }
}

/// A fit at one outgoing direction. Directions are unit vectors with z > 0, in the frame of the view.
pub trait FittedView {
    /// `f cos`, linear sRGB; 1/sr.
    fn f_cos(&self, direction: [f64; 3]) -> [f64; 3];

    /// Density of sampling the lobes, 1/sr; `None` for a method that does not sample.
    fn pdf(&self, _direction: [f64; 3]) -> Option<f64> {
        None
    }

    /// Integral of the density over the hemisphere: less than 1 where samples are lost below the horizon.
    fn share_above_horizon(&self) -> f64 {
        1.0
    }

    /// Directional albedo in closed form; `None` where there is none.
    fn albedo(&self) -> Option<[f64; 3]> {
        None
    }
}
