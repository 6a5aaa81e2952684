//! Whether the values of a table can be a BRDF: other units show in the albedo.

use crate::judge::report::ViewReport;
use crate::table::albedo_bounds::{LEAST, MOST, NOTHING, albedos, is_off};
use std::f64::consts::PI;

/// A sentence if the largest albedo says that values are not f in 1/sr.
pub(super) fn fault(views: &[ViewReport]) -> Option<String> {
    let bright = views.iter().filter(|v| !v.is_black).map(|v| (v.theta, v.data_albedo));
    let most = albedos(bright).into_iter().reduce(f64::max);
    let most = most.filter(|most| !most.is_nan() && is_off(*most) && *most > NOTHING)?;
    let cause = if most < LEAST {
        format!(
            "as little as a light trap or the blackest coatings do; if it is none of these, values have to be multiplied by 10^{:.0} or so",
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
