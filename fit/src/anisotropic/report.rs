//! How good an anisotropic material is, as the run-time library evaluates the bytes that were written.

use crate::FitError;
use crate::anisotropic::table::TurnedView;
use crate::judge::fitted_material::TrackedView;
use crate::judge::report::ViewReport;
use srbf_core::Material;
use std::f64::consts::PI;

/// Compares a material with views of a table.
pub(super) fn judge(bytes: &[u8], views: &[TurnedView]) -> Result<Vec<ViewReport>, FitError> {
    let material = Material::from_bytes(bytes)?;
    let judge = |TurnedView { phi, view }: &TurnedView| {
        let fitted = TrackedView::new(&material, view.theta, phi + PI)?;
        Ok(ViewReport { azimuth: *phi, ..ViewReport::of(&fitted, view) })
    };
    views.iter().map(judge).collect()
}
