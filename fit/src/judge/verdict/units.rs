//! Whether the values of a table can be a BRDF: other units show in the albedo.

use crate::judge::report::ViewReport;
use crate::table::luminance;
use std::f64::consts::PI;

/// Outgoing directions beyond this, radians, are left out: sums over few samples are coarse there.
const GRAZING: f64 = 75.0 * PI / 180.0;

/// Most that a quadrature makes of a surface that reflects everything.
const MOST: f64 = 1.1;

/// Less than any dry surface reflects: soot has 0.01.
const LEAST: f64 = 1e-3;

/// A sentence if the largest albedo says that values are not f in 1/sr.
pub(super) fn fault(views: &[ViewReport]) -> Option<String> {
    let albedos =
        views.iter().filter(|v| v.theta <= GRAZING && !v.is_black).map(|v| luminance(v.data_albedo));
    let most = albedos.fold(f64::NAN, f64::max);
    if most.is_nan() || (LEAST..=MOST).contains(&most) {
        return None;
    }
    let cause = if most < LEAST {
        format!(
            "less than any surface; values of other units have to be multiplied by 10^{:.0} or so",
            (0.1 / most).log10().round()
        )
    } else if most <= MOST * PI {
        "more than any surface; reflectance factors (pi f) have to be divided by pi".to_owned()
    } else {
        let power = (most / MOST).log10().ceil();
        format!("more than any surface; values of other units have to be divided, by 10^{power:.0} or so")
    };
    Some(format!("units: the data reflect {most:.2e} of the light, {cause}"))
}
