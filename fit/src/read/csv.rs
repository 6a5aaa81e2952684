//! Reader of our own `.csv`: anybody's isotropic measurement, a sample a line.
//!
//! The first line is `wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b`; then a row a sample: unit vectors towards the incident and the
//! outgoing direction, +z the normal, and the BRDF in linear sRGB, 1/sr, not multiplied by the cosine. Lines that begin with `#` are
//! comments. Any number of samples is enough, in any pattern: see `scatter` for how they are grouped.
//!
//! Refused are numbers above 1e9 in size, directions whose squared length is off 1 by more than 1e-3, directions below the horizon,
//! and samples of an anisotropic surface, as far as they tell: pairs of directions that differ by a turn about the normal alone, and
//! have other values.

use super::Scatter;
use super::rows::{row, text};
use crate::ReadError;
use crate::table::Scattered;

const HEADER: &str = "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b";

/// Parses the bytes to the samples of each view, theta rising.
///
/// # Errors
/// [`ReadError`], with the line of the fault.
pub fn parse(bytes: &[u8]) -> Result<Vec<(f64, Scattered)>, ReadError> {
    let mut lines =
        text(bytes)?.lines().enumerate().filter(|(_, l)| !l.trim().is_empty() && !l.starts_with('#'));
    if lines.next().is_none_or(|(_, line)| line.trim() != HEADER) {
        return Err(ReadError::Content(format!("the first line has to be {HEADER}")));
    }
    let mut scatter = Scatter::default();
    for (n, line) in lines {
        let mut v = [0.0; 9];
        row(n + 1, line, &mut v)?;
        let place = |reason| ReadError::Content(format!("line {}: {reason}", n + 1));
        let (wi, wo) = ([v[0], v[1], v[2]], [v[3], v[4], v[5]]);
        for d in [wi, wo] {
            let squared: f64 = d.iter().map(|x| x * x).sum();
            if (squared - 1.0).abs() > 1e-3 || d[2] < 0.0 {
                return Err(place(format!("{d:?} is not a unit vector above the horizon")));
            }
        }
        // Into the frame of the view: wo at -x.
        let across = libm::hypot(wo[0], wo[1]);
        let (c, s) = if across > 0.0 { (-wo[0] / across, -wo[1] / across) } else { (1.0, 0.0) };
        let turned = [wi[0] * c + wi[1] * s, wi[1] * c - wi[0] * s, wi[2]];
        let rgb = [v[6], v[7], v[8]];
        let angles = [libm::atan2(across, wo[2]), libm::atan2(wo[1], wo[0])];
        scatter.push(angles, turned, libm::acos(wi[2].min(1.0)), rgb).map_err(place)?;
    }
    scatter.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mirror_direction_is_at_plus_x_whatever_the_azimuth() {
        for azimuth in [0.0f64, 1.0, 2.5, -2.0] {
            let (s, c) = azimuth.sin_cos();
            let text = format!("{HEADER}\n{},{},0.8,{},{},0.8,1,2,3\n", -0.6 * c, -0.6 * s, 0.6 * c, 0.6 * s);
            let views = parse(text.as_bytes()).unwrap();
            let (d, rgb) = views[0].1[0];
            assert!((d[0] - 0.6).abs() < 1e-9 && d[1].abs() < 1e-9 && rgb == [1.0, 2.0, 3.0], "{d:?}");
        }
    }

    #[test]
    fn damage_is_an_error() {
        for text in [
            "",
            "x",
            HEADER,
            &format!("{HEADER}\n1,2,3\n"),
            &format!("{HEADER}\n0,0,1,0,0,1,NaN,0,0\n"),
            &format!("{HEADER}\n0,0,-1,0,0,1,0,0,0\n"),
            &format!("{HEADER}\n0,0,2,0,0,1,0,0,0\n"),
        ] {
            assert!(parse(text.as_bytes()).is_err(), "{text}");
        }
    }
}
