//! The highlight: it is where the brightest samples are, about the mirror direction, between samples, or where the light comes from.

use crate::numeric::median::median;
use crate::row::{Row, polar};
use std::f64::consts::PI;

/// Views between these angles from the normal tell a mirror direction from the back, radians.
const FROM: f64 = 12.0 * PI / 180.0;
const TO: f64 = 80.0 * PI / 180.0;

/// Samples this close to a direction are at it, radians.
const NEAR: f64 = 8.0 * PI / 180.0;

/// Samples whose azimuth is this close to that of the light are on its side, radians.
const BESIDE: f64 = PI / 4.0;

/// The back is brighter than the mirror direction by so much.
const BRIGHTER: f64 = 2.0;

/// Wider highlights than this are seen by any samples, radians of the half vector.
const WIDE: f64 = 8.0 * PI / 180.0;

/// Brightness of the brightest sample over the median, from which on a surface has a highlight.
const CONTRAST: f64 = 3.0;

/// Views that are closer than this are one, radians.
const SAME: f64 = 1e-3;

/// The highlight in the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Highlight {
    /// Views that tell the mirror direction from the back.
    pub telling: usize,
    /// How many of these are brightest at the back.
    pub at_back: usize,
    /// Whether all samples are where the light comes from.
    pub is_back_alone: bool,
    /// Views.
    pub views: usize,
    /// How many of them have no sample within the highlight's width; 0 for a wide one.
    pub unseen: usize,
    /// Width of the highlight: angle of the half vector from the normal at which facets have become few, degrees.
    pub width_degrees: f64,
}

impl Highlight {
    /// `width`: tangent of the angle of the half vector at which facets have become few, if it is known.
    pub(super) fn of(rows: &[Row], is_light_fixed: bool, width: Option<f64>) -> Self {
        let held = |row: &Row| polar(if is_light_fixed { row.wi } else { row.wo });
        let mut sorted: Vec<&Row> = rows.iter().collect();
        sorted.sort_by(|a, b| held(a).total_cmp(&held(b)));
        let levels: Vec<f64> = rows.iter().map(|row| row.rgb.iter().sum::<f64>()).collect();
        let brightest = levels.iter().copied().fold(0.0, f64::max);
        // Without a highlight the width of the model means nothing.
        let has_highlight = median(levels).is_some_and(|middle| brightest > CONTRAST * middle);
        let width = width.map(libm::atan).filter(|_| has_highlight);
        let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
        let is_back = |row: &Row| dot(row.wi, row.wo) > libm::cos(NEAR);
        let is_back_alone = rows.iter().all(is_back) && rows.iter().any(|row| held(row) > FROM);
        let width_degrees = width.unwrap_or(0.0).to_degrees();
        let mut found = Self { is_back_alone, width_degrees, ..Self::default() };
        for view in sorted.chunk_by(|a, b| held(b) - held(a) < SAME) {
            found.views += 1;
            let half = |row: &&Row| {
                let sum = [0, 1, 2].map(|k| row.wi[k] + row.wo[k]);
                polar(sum)
            };
            let nearest = view.iter().map(half).fold(f64::INFINITY, f64::min);
            found.unseen += usize::from(width.is_some_and(|width| width < WIDE && nearest > width));
            let theta = held(view[0]);
            if !(FROM..=TO).contains(&theta) {
                continue;
            }
            let level = |row: &Row| row.rgb.iter().sum::<f64>();
            let brightest = |is: &dyn Fn(&Row) -> bool| {
                view.iter().filter(|row| is(row)).map(|row| level(row)).fold(f64::NAN, f64::max)
            };
            let mirror =
                brightest(&|row| dot([-row.wi[0], -row.wi[1], row.wi[2]], row.wo) > libm::cos(2.0 * NEAR));
            let back = brightest(&is_back);
            // A wide highlight is brightest nearer to the horizon, on its own side.
            let across = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1];
            let is_beside = |row: &Row| {
                let [i, o] = [row.wi, row.wo];
                across(i, o) > libm::cos(BESIDE) * libm::sqrt(across(i, i) * across(o, o))
            };
            let (beside, all) = (brightest(&is_beside), brightest(&|_| true));
            if mirror.is_nan() || back.is_nan() {
                continue;
            }
            found.telling += 1;
            found.at_back += usize::from(beside >= all && back > BRIGHTER * mirror);
        }
        // The width is that of facets about the mirror direction, and means nothing of a highlight elsewhere.
        if found.is_at_back() || found.is_back_alone {
            found.unseen = 0;
        }
        found
    }

    /// Whether the surface is brightest where the light comes from.
    pub fn is_at_back(&self) -> bool {
        self.telling >= 2 && 2 * self.at_back > self.telling
    }
}
