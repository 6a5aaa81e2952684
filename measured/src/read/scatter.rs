//! Samples grouped by the angle of the direction that an instrument holds while it moves the other: the view.
//!
//! Some instruments hold the light, some the detector. By reciprocity either is an outgoing direction; the one of which there are
//! fewer angles is taken. Where there are many with a few samples each, neighbours are taken together: the incident direction is turned
//! with the outgoing one, in the plane of incidence, so that its place beside the mirror direction stays the same.

use crate::row::{Row, polar};
use crate::table::Scattered;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Angles of the outgoing direction closer than this are one view, radians; files print six decimals.
const SAME_VIEW: f64 = 1e-3;

/// More views than this, with fewer samples each, are taken together.
const MANY_VIEWS: usize = 64;
const FEW_SAMPLES: usize = 24;

/// More views than [`MANY_VIEWS`] that are closer than this in the mean, radians, are taken together however many samples each has: no
/// instrument steps so finely, and 100 000 samples anywhere come as close.
const DENSE: f64 = 4.0 * SAME_VIEW;

/// Width of a view into which they are, radians: 2 degrees.
const WIDTH: f64 = 2.0 * PI / 180.0;

/// Samples nearer to the normal than this sine have no azimuth; a sector of the view at the normal without samples is wide from here on,
/// radians.
const ACROSS: f64 = 0.03;
const SECTOR: f64 = PI / 3.0;

/// The golden ratio, less 1.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A sample in the frame of its view.
struct Placed {
    row: usize,
    theta: f64,
    wi: [f64; 3],
    rgb: [f64; 3],
}

/// The samples of one view.
pub(super) struct Group {
    pub theta: f64,
    pub samples: Scattered,
    /// Which of the rows they are.
    pub rows: Vec<usize>,
}

/// The incident direction in the frame of the outgoing one, which is at -x there.
pub(crate) fn in_frame(wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
    let across = libm::hypot(wo[0], wo[1]);
    let (c, s) = if across > 0.0 { (-wo[0] / across, -wo[1] / across) } else { (1.0, 0.0) };
    [wi[0] * c + wi[1] * s, wi[1] * c - wi[0] * s, wi[2]]
}

/// Whether the light has fewer angles than the viewer.
pub(super) fn is_light_fixed(rows: &[Row]) -> bool {
    let count = |of: fn(&Row) -> [f64; 3]| {
        let mut angles: Vec<f64> = rows.iter().map(|row| polar(of(row))).collect();
        angles.sort_by(f64::total_cmp);
        let (mut views, mut last) = (0, f64::NEG_INFINITY);
        for angle in angles {
            if angle - last >= SAME_VIEW {
                (views, last) = (views + 1, angle);
            }
        }
        views
    };
    count(|row| row.wi) < count(|row| row.wo)
}

/// The views, theta rising.
pub(super) fn views(rows: &[Row], is_light_fixed: bool) -> Vec<Group> {
    let place = |(n, row): (usize, &Row)| {
        let (wi, wo) = if is_light_fixed { (row.wo, row.wi) } else { (row.wi, row.wo) };
        Placed { row: n, theta: polar(wo), wi: in_frame(wi, wo), rgb: row.rgb }
    };
    let mut placed: Vec<Placed> = rows.iter().enumerate().map(place).collect();
    placed.sort_by(|a, b| a.theta.total_cmp(&b.theta));
    let views = grouped(&placed, SAME_VIEW);
    let Some((first, last)) = views.first().zip(views.last()) else { return views };
    let few = placed.len() < FEW_SAMPLES * views.len();
    let dense = last.theta - first.theta < DENSE * views.len() as f64;
    if views.len() > MANY_VIEWS && (few || dense) { grouped(&placed, WIDTH) } else { views }
}

/// Samples of angles within a width as views, at their mean angle.
fn grouped(placed: &[Placed], width: f64) -> Vec<Group> {
    let mut views = Vec::new();
    let mut rest = placed;
    while let Some(first) = rest.first() {
        let (group, others) = rest.split_at(rest.partition_point(|p| p.theta - first.theta < width));
        let theta = if width > SAME_VIEW {
            group.iter().map(|p| p.theta).sum::<f64>() / group.len() as f64
        } else {
            first.theta
        };
        let mut samples: Scattered = group.iter().map(|p| (turned(p.wi, theta - p.theta), p.rgb)).collect();
        if theta < SAME_VIEW {
            spread_about_normal(&mut samples);
        }
        views.push(Group { theta, samples, rows: group.iter().map(|p| p.row).collect() });
        rest = others;
    }
    views
}

/// Spreads samples of the view at the normal over all azimuths, if they leave a sector empty: there an azimuth means nothing, and a sample
/// stands for all. Samples of one half-line would be taken for a fan that the rest of the hemisphere knows nothing of. Samples of one
/// direction stay together: spread over a circle, a million of them would take a minute.
fn spread_about_normal(samples: &mut Scattered) {
    let across = |d: &[f64; 3]| libm::hypot(d[0], d[1]);
    let folded = |d: &[f64; 3]| libm::atan2(d[1].abs(), d[0]);
    let mut azimuths: Vec<f64> =
        samples.iter().map(|s| &s.0).filter(|d| across(d) > ACROSS).map(folded).collect();
    azimuths.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (azimuths.first(), azimuths.last()) else { return };
    // Both sides of the plane are one, so that the sectors at its ends are twice as wide.
    let ends = (2.0 * first).max(2.0 * (PI - last));
    let widest = azimuths.windows(2).map(|w| w[1] - w[0]).fold(ends, f64::max);
    if widest < SECTOR {
        return;
    }
    let mut seen = HashMap::new();
    for (d, _) in samples {
        let count = seen.len();
        let n = *seen.entry(d.map(f64::to_bits)).or_insert(count);
        let (sin, cos) = libm::sincos(PI * (GOLDEN * n as f64).fract());
        *d = [across(d) * cos, across(d) * sin, d[2]];
    }
}

/// A direction turned in the plane of incidence, from the normal to the mirror direction; as it was where it would sink below the horizon.
fn turned(d: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = libm::sincos(angle);
    let turned = [d[0] * cos + d[2] * sin, d[1], d[2] * cos - d[0] * sin];
    if angle != 0.0 && turned[2] > 1e-3 { turned } else { d }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::direction;
    use std::collections::HashSet;

    #[test]
    fn outgoing_directions_without_a_pattern_are_taken_together_beside_the_mirror_direction() {
        let from_mirror = |theta: f64, wi: [f64; 3]| libm::sin(theta) * wi[0] + libm::cos(theta) * wi[2];
        for count in [3000, 100_000] {
            let row = |i: u32| {
                let n = f64::from(i);
                let wo = direction(1.4 * (0.618 * n).fract(), 7.0 * (0.37 * n).fract());
                let wi = direction(1.4 * (0.755 * n).fract(), 3.0 * (0.57 * n).fract());
                let value = from_mirror(polar(wo), in_frame(wi, wo));
                Row { line: 1, wi, wo, rgb: [value; 3] }
            };
            let rows: Vec<Row> = (0..count).map(row).collect();
            let views = views(&rows, false);
            assert!(views.len() < 50, "{}", views.len());
            for Group { theta, samples, .. } in &views {
                for (wi, rgb) in samples.iter().filter(|s| s.0[2] > 0.1) {
                    assert!((from_mirror(*theta, *wi) - rgb[0]).abs() < 1e-9, "{theta} {wi:?} {rgb:?}");
                }
            }
        }
    }

    /// A view at the normal of samples on one half-line has the albedo of the same all round.
    #[test]
    fn at_the_normal_a_sample_stands_for_all_azimuths() {
        let f = |theta: f64| 0.1 + 0.5 * libm::exp(-10.0 * theta * theta);
        let albedo = |azimuths: &[f64]| {
            let mut rows = Vec::new();
            for theta in (0..17).map(|n| 0.085 * f64::from(n)) {
                rows.extend(azimuths.iter().map(|phi| Row {
                    line: 1,
                    wi: direction(theta, *phi),
                    wo: [0.0, 0.0, 1.0],
                    rgb: [f(theta); 3],
                }));
            }
            let groups = views(&rows, false).into_iter().map(|group| (group.theta, group.samples)).collect();
            crate::table::Table::from_scattered(groups).unwrap().views[0].uncut_albedo[0]
        };
        let round: Vec<f64> = (0..24).map(|n| 0.26 * f64::from(n)).collect();
        for line in [0.0, 1.0, 3.1] {
            assert!(
                (albedo(&[line]) / albedo(&round) - 1.0).abs() < 0.05,
                "{} {}",
                albedo(&[line]),
                albedo(&round)
            );
        }
    }

    /// Each was spread over a circle of its own places.
    #[test]
    fn at_the_normal_repeated_samples_stay_together() {
        let row = |n: u32| Row {
            line: 1,
            wi: direction(0.014 * f64::from(n % 100), 0.0),
            wo: [0.0, 0.0, 1.0],
            rgb: [0.1; 3],
        };
        let rows: Vec<Row> = (0..5000).map(row).collect();
        let groups = views(&rows, false);
        let directions: HashSet<_> = groups[0].samples.iter().map(|s| s.0.map(f64::to_bits)).collect();
        assert_eq!((groups.len(), groups[0].samples.len(), directions.len()), (1, 5000, 100));
        assert!(groups[0].samples.iter().any(|s| s.0[1].abs() > 0.1), "they are spread");
    }

    #[test]
    fn the_direction_of_fewer_angles_is_the_view_whatever_it_is_called() {
        let rows = |swap: bool| -> Vec<Row> {
            let pair = |i: u32| {
                let held = direction(0.2 + 0.4 * f64::from(i % 3), 0.0);
                [held, direction(0.1 * f64::from(i % 14), 0.4 * f64::from(i))]
            };
            let row = |i| {
                let [wi, wo] = pair(i);
                let (wi, wo) = if swap { (wo, wi) } else { (wi, wo) };
                Row { line: 1, wi, wo, rgb: [0.1; 3] }
            };
            (0..210).map(row).collect()
        };
        assert!(is_light_fixed(&rows(false)) && !is_light_fixed(&rows(true)));
        let samples = |rows: &[Row], fixed| -> Vec<Scattered> {
            views(rows, fixed).into_iter().map(|group| group.samples).collect()
        };
        assert_eq!(samples(&rows(false), true), samples(&rows(true), false));
    }
}
