//! One sample of a file, on its own, so that what looks at samples needs to know nothing of how they are read.

use srbf_core::Quarter;
use std::f64::consts::PI;

/// Directions this close to the normal have no azimuth, radians.
pub(crate) const NORMAL: f64 = 1.0 * PI / 180.0;

/// The kind of a value, up to a factor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Values {
    /// The BRDF f.
    #[default]
    Brdf,
    /// f times the cosine of the outgoing direction, as detectors that see a fixed patch measure it.
    CosineOutgoing,
    /// f times the cosine of the incident direction.
    CosineIncident,
}

/// One sample as it stands in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Line, or number of the entry in a format without lines, from 1.
    pub line: usize,
    /// Incident direction, towards the light; unit vector, +z the normal.
    pub wi: [f64; 3],
    /// Outgoing direction, towards the viewer; unit vector in the same frame.
    pub wo: [f64; 3],
    /// The BRDF f, linear sRGB; 1/sr.
    pub rgb: [f64; 3],
}

impl Row {
    /// That of light the other way.
    pub(crate) fn exchanged(&self) -> Self {
        Self { wi: self.wo, wo: self.wi, ..*self }
    }

    /// Angles of its incident and outgoing direction from the normal, and the outgoing azimuth less the incident one: radians, the latter
    /// from -pi to pi; `None` where a direction is too close to the normal to have one.
    pub(crate) fn angles(&self) -> ([f64; 2], Option<f64>) {
        let (i, o) = (polar(self.wi), polar(self.wo));
        let azimuth = |d: [f64; 3]| libm::atan2(d[1], d[0]);
        let turn = || libm::remainder(azimuth(self.wo) - azimuth(self.wi), 2.0 * PI);
        ([i, o], (i.min(o) >= NORMAL).then(turn))
    }
}

/// A direction in the frame of a sample that is turned by an angle, radians, anticlockwise as seen from above.
pub(crate) fn turned_back([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = libm::sincos(angle);
    [x * cos + y * sin, y * cos - x * sin, z]
}

/// Angle of a unit vector from the normal, radians.
pub(crate) fn polar(d: [f64; 3]) -> f64 {
    libm::atan2(libm::hypot(d[0], d[1]), d[2])
}

/// At most `most` of the samples, spread evenly over all, the same ones each time.
pub(crate) fn thin(rows: &[Row], most: usize) -> Vec<&Row> {
    let golden = 0.618_033_988_749_894_9_f64;
    let share = most as f64 / rows.len().max(1) as f64;
    let kept =
        rows.iter().enumerate().filter(|(n, _)| rows.len() <= most || (golden * *n as f64).fract() < share);
    kept.map(|(_, row)| row).collect()
}

/// Directions of a sheet, towards the light and the viewer, as one of its quarters has them, both above the horizon; and back.
pub(crate) fn turned_over(quarter: Quarter, [wi, wo]: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    let of = |d: [f64; 3], is_behind: bool| if is_behind { [d[0], d[1], -d[2]] } else { d };
    [of(wi, quarter.is_back() != quarter.is_transmission()), of(wo, quarter.is_back())]
}
