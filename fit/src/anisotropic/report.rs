//! How good an anisotropic material is, as the run-time library evaluates the bytes that were written.

use crate::FitError;
use crate::anisotropic::table::TurnedView;
use crate::judge::fitted_material::TrackedView;
use crate::judge::report::ViewReport;
use srbf_core::Material;
use std::f64::consts::PI;

/// Compares a material with views of a table, whose azimuths count from an axis, radians.
pub(crate) fn judge(bytes: &[u8], views: &[TurnedView], axis: f64) -> Result<Vec<ViewReport>, FitError> {
    let material = Material::from_bytes(bytes)?;
    let judge = |TurnedView { phi, view }: &TurnedView| {
        let azimuth = phi + axis;
        let fitted = TrackedView::new(&material, view.theta, azimuth + PI)?;
        Ok(ViewReport { azimuth, ..ViewReport::of(&fitted, view) })
    };
    views.iter().map(judge).collect()
}
