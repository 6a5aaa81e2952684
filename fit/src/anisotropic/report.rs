//! How good an anisotropic material is, as the run-time library evaluates the bytes that were written.

use super::table::View;
use crate::FitError;
use crate::judge::fitted_material::TrackedView;
use crate::judge::report::ViewReport;
use crate::table;
use srbf_core::Material;
use std::f64::consts::PI;

/// Compares a material with views of a table.
pub(super) fn judge(bytes: &[u8], views: &[View]) -> Result<Vec<ViewReport>, FitError> {
    let material = Material::from_bytes(bytes)?;
    views.iter().map(|view| judge_view(&material, view)).collect()
}

fn judge_view(material: &Material<impl AsRef<[u8]>>, view: &View) -> Result<ViewReport, FitError> {
    let fitted = TrackedView::new(material, view.theta, view.phi + PI)?;
    let View { theta, phi, samples, albedo } = view.clone();
    let view = table::View { theta, samples, albedo, uncut_albedo: albedo, floor: 0.0 };
    Ok(ViewReport { azimuth: phi, ..ViewReport::of(&fitted, &view) })
}
