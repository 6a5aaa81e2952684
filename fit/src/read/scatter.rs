//! Scattered samples grouped by the angle of the outgoing direction.
//!
//! Instruments measure many directions for each of a few outgoing ones: those are views. Where there are many outgoing directions with a few
//! samples each, neighbours are taken together: the incident direction is turned with the outgoing one, in the plane of
//! incidence, so that its place beside the mirror direction stays what it was.

use crate::ReadError;
use crate::table::Scattered;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

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

/// Samples whose directions are as close as this, radians, but for a turn by more than that, are compared: an isotropic surface has one
/// value for them. So many have to differ by so much of the logarithm in the median to tell that it is none.
const CLOSE: f64 = 1.0 * PI / 180.0;
const TURNED: f64 = 20.0 * PI / 180.0;
const COMPARED: usize = 20;
const DIFFERENT: f64 = 0.25;

struct Row {
    theta: f64,
    azimuth: f64,
    wi: [f64; 3],
    rgb: [f64; 3],
}

/// Samples on their way to views.
#[derive(Default)]
pub(crate) struct Scatter {
    rows: Vec<Row>,
}

impl Scatter {
    /// Adds a sample: angle of the outgoing direction and its azimuth, incident direction in the frame of the view and its angle from
    /// the normal, f. The error says what is out of range.
    pub fn push(
        &mut self,
        [theta, azimuth]: [f64; 2],
        wi: [f64; 3],
        theta_i: f64,
        rgb: [f64; 3],
    ) -> Result<(), String> {
        if !(0.0..FRAC_PI_2).contains(&theta) {
            return Err(format!(
                "outgoing direction {theta} radians from the normal; at least 0, less than pi / 2"
            ));
        }
        if !(0.0..=FRAC_PI_2 + 1e-5).contains(&theta_i) {
            return Err(format!("incident direction {theta_i} radians from the normal; from 0 to pi / 2"));
        }
        self.rows.push(Row { theta, azimuth, wi, rgb });
        Ok(())
    }

    /// The views, theta rising.
    ///
    /// # Errors
    /// [`ReadError`] for no sample, and for samples of an anisotropic surface.
    pub fn finish(mut self) -> Result<Vec<(f64, Scattered)>, ReadError> {
        if self.rows.is_empty() {
            return Err(ReadError::Content("no samples".into()));
        }
        if let Some(apart) = self.apart_by_turning() {
            return Err(ReadError::Content(format!(
                "samples of an anisotropic surface: values of directions that differ by a turn about the normal alone differ by {:.0} % \
                 in the median. Samples have to be of an isotropic surface; a table of an anisotropic one is read from .bsdf",
                100.0 * libm::expm1(apart)
            )));
        }
        self.rows.sort_by(|a, b| a.theta.total_cmp(&b.theta));
        let views = self.views(SAME_VIEW);
        let few = self.rows.len() < FEW_SAMPLES * views.len();
        let dense = views[views.len() - 1].0 - views[0].0 < DENSE * views.len() as f64;
        if views.len() > MANY_VIEWS && (few || dense) {
            return Ok(self.views(WIDTH));
        }
        Ok(views)
    }

    /// Rows of angles within a width as views, at their mean angle.
    fn views(&self, width: f64) -> Vec<(f64, Scattered)> {
        let mut views = Vec::new();
        let mut rest = &self.rows[..];
        while let Some(first) = rest.first() {
            let (group, others) = rest.split_at(rest.partition_point(|row| row.theta - first.theta < width));
            let theta = if width > SAME_VIEW {
                group.iter().map(|row| row.theta).sum::<f64>() / group.len() as f64
            } else {
                first.theta
            };
            let turned = |row: &Row| (turned(row.wi, theta - row.theta), row.rgb);
            views.push((theta, group.iter().map(turned).collect()));
            rest = others;
        }
        views
    }

    /// Median difference of the logarithms of samples that differ by a turn, if there are enough of them and it is large.
    fn apart_by_turning(&self) -> Option<f64> {
        let mut groups: BTreeMap<[i64; 3], Vec<&Row>> = BTreeMap::new();
        for row in &self.rows {
            let cell = |v: f64| (v / CLOSE) as i64;
            let azimuth = libm::atan2(row.wi[1].abs(), row.wi[0]);
            groups
                .entry([cell(row.theta), cell(libm::acos(row.wi[2].min(1.0))), cell(azimuth)])
                .or_default()
                .push(row);
        }
        let level = |row: &Row| row.rgb.iter().sum::<f64>();
        let mut apart: Vec<f64> = Vec::new();
        for group in groups.values() {
            let Some((first, others)) = group.split_first() else { continue };
            for other in others {
                let turn = libm::remainder(other.azimuth - first.azimuth, 2.0 * PI).abs();
                if turn > TURNED && level(first) > 0.0 && level(other) > 0.0 && first.theta > CLOSE {
                    apart.push(libm::log(level(first) / level(other)).abs());
                }
            }
        }
        if apart.len() < COMPARED {
            return None;
        }
        apart.sort_by(f64::total_cmp);
        Some(apart[apart.len() / 2]).filter(|apart| *apart > DIFFERENT)
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

    fn scatter(count: u32, value: impl Fn(f64, f64, [f64; 3]) -> f64) -> Scatter {
        let mut scatter = Scatter::default();
        for i in 0..count {
            let n = f64::from(i);
            let (theta, azimuth) = (1.4 * (0.618 * n).fract(), 7.0 * (0.37 * n).fract());
            let wi = direction(1.4 * (0.755 * n).fract(), 3.0 * (0.57 * n).fract());
            let theta_i = libm::acos(wi[2]);
            scatter.push([theta, azimuth], wi, theta_i, [value(theta, azimuth, wi); 3]).unwrap();
        }
        scatter
    }

    #[test]
    fn outgoing_directions_without_a_pattern_are_taken_together_beside_the_mirror_direction() {
        let from_mirror = |theta: f64, wi: [f64; 3]| libm::sin(theta) * wi[0] + libm::cos(theta) * wi[2];
        for count in [3000, 100_000] {
            let views = scatter(count, |theta, _, wi| from_mirror(theta, wi)).finish().unwrap();
            assert!(views.len() < 50, "{}", views.len());
            for (theta, samples) in &views {
                for (wi, rgb) in samples.iter().filter(|s| s.0[2] > 0.1) {
                    assert!((from_mirror(*theta, *wi) - rgb[0]).abs() < 1e-9, "{theta} {wi:?} {rgb:?}");
                }
            }
        }
    }

    #[test]
    fn a_surface_on_which_a_turn_matters_is_refused() {
        let grid = |value: &dyn Fn(f64) -> f64| {
            let mut scatter = Scatter::default();
            for i in 0..400u32 {
                let azimuth = f64::from(i % 4);
                let wi = direction(0.02 + 0.01 * f64::from(i / 4), 0.3);
                scatter.push([0.5, azimuth], wi, libm::acos(wi[2]), [value(azimuth); 3]).unwrap();
            }
            scatter.finish()
        };
        assert!(grid(&|_| 0.3).is_ok());
        let refused = grid(&|azimuth| 0.3 + 0.25 * libm::cos(2.0 * azimuth)).unwrap_err().to_string();
        assert!(refused.contains("anisotropic"), "{refused}");
    }
}
