//! Where a peak away from the mirror direction lies that no lobe has, view by view.
//!
//! Families of lobes point to the normal, to the mirror direction or beside a lobe. A narrow peak anywhere else is met by none of
//! them. The residual shows it: most of its squares lie close together.

use super::Residual;
use crate::family::objective::Data;
use crate::family::objective::data_term::Point;
use crate::isotropic::line::Line;
use crate::judge::measure::brightness;

/// Least distance of a stray peak from the mirror direction, and largest distance from the plane of incidence, radians.
const APART: f64 = 0.1;
const ASIDE: f64 = 0.05;
/// Distance from the top of a stray peak within which most of its squares lie, radians, and their least share of all.
const NEAR: f64 = 0.1;
const SHARE: f64 = 0.3;

/// The angle of a stray peak in the plane of incidence, by the angle of the outgoing direction; radians, rising.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Track(Vec<(f64, f64)>);

impl Track {
    /// The track of a peak that most of the views have.
    pub fn find(views: &[Data<Line>], residuals: &[Residual]) -> Option<Self> {
        let found = |(view, residual): (&Data<Line>, &Residual)| {
            top(residual.theta, &view.points, &residual.left).map(|angle| (residual.theta, angle))
        };
        let places: Vec<(f64, f64)> = views.iter().zip(residuals).filter_map(found).collect();
        let mut track = Self(places);
        track.0.sort_by(|a, b| a.0.total_cmp(&b.0));
        (2 * track.0.len() > views.len()).then_some(track)
    }

    /// The angle at a view; beyond the ends as far from the mirror direction as there.
    pub fn at(&self, theta: f64) -> f64 {
        let places = &self.0;
        let last = places.len() - 1;
        let after = places.partition_point(|place| place.0 <= theta);
        if after == 0 || last == 0 || after > last {
            let end = places[if after == 0 { 0 } else { last }];
            return theta + end.1 - end.0;
        }
        let (a, b) = (places[after - 1], places[after]);
        a.1 + (b.1 - a.1) * (theta - a.0) / (b.0 - a.0).max(f64::EPSILON)
    }
}

/// The angle of the largest difference away from the mirror direction, if the squares of a view lie about it.
fn top(theta: f64, points: &[Point], left: &[[f64; 3]]) -> Option<f64> {
    let (sin, cos) = libm::sincos(theta);
    let far = libm::cos(APART);
    let is_stray = |d: &[f64; 3]| d[1] < ASIDE && d[0] * sin + d[2] * cos < far;
    let away = points.iter().zip(left).filter(|(point, _)| is_stray(&point.direction));
    let (at, _) = away
        .map(|(point, left)| (point.direction, brightness(*left)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|top| top.1 > 0.0)?;
    let near = libm::cos(NEAR);
    let (mut all, mut about) = (0.0, 0.0);
    for (point, left) in points.iter().zip(left) {
        let square = point.value * left.iter().map(|v| v * v).sum::<f64>();
        let d = point.direction;
        all += square;
        about += if d[0] * at[0] + d[1] * at[1] + d[2] * at[2] > near { square } else { 0.0 };
    }
    (about > SHARE * all).then(|| libm::atan2(at[0], at[2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_track_goes_on_beside_the_mirror_direction() {
        let track = Track(vec![(0.2, 0.5), (0.4, 0.7), (0.8, 0.8)]);
        for (theta, angle) in [(0.1, 0.4), (0.2, 0.5), (0.3, 0.6), (0.6, 0.75), (0.8, 0.8), (1.0, 1.0)] {
            assert!((track.at(theta) - angle).abs() < 1e-12, "{theta}");
        }
    }
}
