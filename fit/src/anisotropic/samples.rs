//! Samples of an anisotropic surface as views of a table: those of one outgoing direction, at its azimuth.

use crate::anisotropic::table::{self, TurnedView};
use crate::read::Row;
use crate::table::{Brdf, Density, Sample, Table};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Outgoing directions as close as this are one view, radians.
const SAME: f64 = 0.004;

/// Least number of samples of a view, and most views.
const FEWEST: usize = 8;
const MOST: usize = 1000;

/// Directions by which the albedo of the completion is found.
const WHOLE: Density = Density { hemisphere: 600, cap: 150 };

/// Incident and outgoing direction, the latter the one that was held, and f.
type Seen = ([f64; 3], [f64; 3], [f64; 3]);

/// The views; `None` where outgoing directions have no pattern. Albedos are those of the completion.
pub(super) fn views(brdf: &dyn Brdf, rows: &[Row], is_light_fixed: bool) -> Option<Vec<TurnedView>> {
    let mut groups: BTreeMap<[i64; 2], Vec<Seen>> = BTreeMap::new();
    for row in rows {
        let (wi, wo) = if is_light_fixed { (row.wo, row.wi) } else { (row.wi, row.wo) };
        let key = [wo[0], wo[1]].map(|v| libm::round(v / SAME) as i64);
        groups.entry(key).or_default().push((wi, wo, row.rgb));
    }
    groups.retain(|_, group| group.len() >= FEWEST);
    if groups.is_empty() || groups.len() > MOST {
        return None;
    }
    let mut views = Vec::with_capacity(groups.len());
    for group in groups.values() {
        let wo = group[0].1;
        let (theta, phi) = (libm::atan2(libm::hypot(wo[0], wo[1]), wo[2]), libm::atan2(wo[1], wo[0]));
        let (sin, cos) = libm::sincos(phi + PI);
        let in_view = |d: [f64; 3]| [d[0] * cos + d[1] * sin, d[1] * cos - d[0] * sin, d[2]];
        let own: Vec<([f64; 3], [f64; 3])> = group.iter().map(|(wi, _, rgb)| (in_view(*wi), *rgb)).collect();
        // Weights are those of an isotropic view: both sides of the plane of incidence are one there.
        let Ok(table) = Table::from_scattered(vec![(theta, own.clone())]) else { continue };
        let Some(view) = table.views.into_iter().next().filter(|view| view.samples.len() == own.len()) else {
            continue;
        };
        let samples =
            view.samples.iter().zip(&own).map(|(s, own)| Sample { direction: own.0, ..*s }).collect();
        views.push((phi, crate::table::View { samples, ..view }));
    }
    views.sort_by(|a, b| a.1.theta.total_cmp(&b.1.theta).then(a.0.total_cmp(&b.0)));
    let at: Vec<(f64, f64)> = views.iter().map(|(phi, view)| (view.theta, *phi)).collect();
    let whole = table::tabulate(brdf, &at, WHOLE);
    let with_albedo = |((phi, view), whole): ((f64, crate::table::View), &TurnedView)| {
        let albedo = whole.view.albedo;
        TurnedView { phi, view: crate::table::View { albedo, uncut_albedo: albedo, ..view } }
    };
    let views: Vec<TurnedView> = views.into_iter().zip(&whole).map(with_albedo).collect();
    (!views.is_empty()).then_some(views)
}
