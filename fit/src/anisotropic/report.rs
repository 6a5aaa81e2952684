//! How good an anisotropic material is, as the run-time library evaluates the bytes that were written.

use super::table::View;
use crate::FitError;
use crate::report::ViewReport;
use srbf_core::{MAX_LOBES, Material, Mixture, Vec3};
use std::f64::consts::PI;

/// Compares a material with views of a table.
pub(super) fn judge(bytes: &[u8], views: &[View]) -> Result<Vec<ViewReport>, FitError> {
    let material = Material::from_bytes(bytes)?;
    let mut mixture = Mixture::<MAX_LOBES>::empty();
    views.iter().map(|view| judge_view(&material, view, &mut mixture)).collect()
}

fn judge_view(
    material: &Material<'_>,
    view: &View,
    mixture: &mut Mixture<MAX_LOBES>,
) -> Result<ViewReport, FitError> {
    let wo = crate::table::direction(view.theta, view.phi);
    material.prepare(Vec3::from(wo.map(|v| v as f32)), mixture)?;
    let (sin, cos) = libm::sincos(view.phi + PI);
    let (mut difference, mut norm) = (0.0, 0.0);
    let (mut second, mut first, mut largest) = (0.0, 0.0, 0.0f64);
    for s in &view.samples {
        let d = s.direction;
        let turned = [d[0] * cos - d[1] * sin, d[0] * sin + d[1] * cos, d[2]];
        let (value, pdf) = mixture.evaluate_and_pdf(Vec3::from(turned.map(|v| v as f32)));
        let value = value.to_array().map(f64::from);
        let data = s.rgb.map(|v| v * d[2]);
        for c in 0..3 {
            difference += s.weight * (value[c] - data[c]) * (value[c] - data[c]);
            norm += s.weight * data[c] * data[c];
        }
        let luminance = 0.2126 * data[0] + 0.7152 * data[1] + 0.0722 * data[2];
        first += s.weight * luminance;
        if luminance > 0.0 {
            second += s.weight * luminance * luminance / f64::from(pdf);
            largest = largest.max(luminance / f64::from(pdf));
        }
    }
    Ok(ViewReport {
        theta: view.theta,
        azimuth: view.phi,
        error: if norm > 0.0 { libm::sqrt(difference / norm) } else { libm::sqrt(difference) },
        albedo: mixture.albedo().to_array().map(f64::from),
        data_albedo: view.albedo,
        largest_weight: if first > 0.0 { largest / first } else { 0.0 },
        variance: if first > 0.0 { second / (first * first) - 1.0 } else { 0.0 },
    })
}
