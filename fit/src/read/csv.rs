//! Reader of our own `.csv`: anybody's isotropic measurement, a sample a line.
//!
//! The first line names the columns, in any order: the directions as unit vectors, `wi_x,wi_y,wi_z,wo_x,wo_y,wo_z`, +z the normal, or
//! as angles in degrees, `theta_i,phi_i,theta_o,phi_o`; and the BRDF, 1/sr, not multiplied by the cosine, as `r,g,b` in
//! linear sRGB, as one grey `value`, or as a spectrum whose columns are named by wavelengths in nm, `400` or `400nm`. Then there is a row
//! a sample. Spaces round numbers, a byte order mark and empty lines do not matter; lines that begin with `#` are
//! comments. Any number of samples is enough, in any pattern: see `scatter` for how they are grouped.
//!
//! Refused are numbers above 1e9 in size, directions whose squared length is off 1 by more than 1e-3, directions below the horizon,
//! and samples of an anisotropic surface, as far as they tell: pairs of directions that differ by a turn about the normal alone, and
//! have other values.

mod columns;

use super::Scatter;
use super::rows::{row, text};
use crate::ReadError;
use crate::table::Scattered;
use columns::Columns;

/// Parses the bytes to the samples of each view, theta rising.
///
/// # Errors
/// [`ReadError`], with the line of the fault.
pub fn parse(bytes: &[u8]) -> Result<Vec<(f64, Scattered)>, ReadError> {
    let text = text(bytes)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty() && !l.starts_with('#'));
    let (_, names) = lines
        .next()
        .ok_or_else(|| ReadError::Content("the first line, which names the columns, is missing".into()))?;
    let columns = Columns::parse(names)?;
    let mut scatter = Scatter::default();
    let mut v = vec![0.0; columns.count];
    for (n, line) in lines {
        row(n + 1, line, &mut v)?;
        let place = |reason| ReadError::Content(format!("line {}: {reason}", n + 1));
        let [wi, wo] = columns.directions(&v).map_err(place)?;
        // Into the frame of the view: wo at -x.
        let across = libm::hypot(wo[0], wo[1]);
        let (c, s) = if across > 0.0 { (-wo[0] / across, -wo[1] / across) } else { (1.0, 0.0) };
        let turned = [wi[0] * c + wi[1] * s, wi[1] * c - wi[0] * s, wi[2]];
        let rgb = columns.rgb(&v);
        let angles = [libm::atan2(across, wo[2]), libm::atan2(wo[1], wo[0])];
        scatter.push(angles, turned, libm::acos(wi[2].min(1.0)), rgb).map_err(place)?;
    }
    scatter.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b";

    #[test]
    fn columns_have_names_and_any_order() {
        let expected = parse(format!("{HEADER}\n0.6,0,0.8,-0.8,0,0.6,1,2,3\n").as_bytes()).unwrap();
        let (theta_i, theta_o) = (0.6f64.asin().to_degrees(), 0.8f64.asin().to_degrees());
        for text in [
            "\u{feff}b, g, r, wo_z,wo_y,wo_x, wi_x,wi_y,wi_z\n\n# a comment\n 3, 2 ,1,0.6,0,-0.8,0.6,0,0.8\n"
                .to_owned(),
            format!("theta_i,phi_i,theta_o,phi_o,R,G,B\r\n{theta_i},30,{theta_o},210,1,2,3\r\n"),
        ] {
            let found = parse(text.as_bytes()).unwrap();
            assert!((found[0].0 - expected[0].0).abs() < 1e-9, "{text}");
            let ((d, rgb), (e, _)) = (found[0].1[0], expected[0].1[0]);
            assert!((0..3).all(|i| (d[i] - e[i]).abs() < 1e-9) && rgb == [1.0, 2.0, 3.0], "{text}: {d:?}");
        }
    }

    #[test]
    fn one_channel_is_grey_and_a_flat_spectrum_is_white() {
        let wavelengths: Vec<String> = (40..=70).map(|w| format!("{}nm", 10 * w)).collect();
        let flat = vec!["0.5"; wavelengths.len()].join(",");
        for (names, values, tolerance) in
            [("value", "0.5", 0.0), (wavelengths.join(",").as_str(), flat.as_str(), 1e-6)]
        {
            let text = format!("theta_i,phi_i,theta_o,phi_o,{names}\n20,0,30,180,{values}\n");
            let rgb = parse(text.as_bytes()).unwrap()[0].1[0].1;
            assert!(rgb.iter().all(|c| (c - 0.5).abs() <= tolerance), "{rgb:?}");
        }
    }

    #[test]
    fn what_a_column_is_not_is_said() {
        for (names, word) in [
            ("theta_i,phi_i,theta_o,r,g,b", "expected are"),
            ("theta_i,phi_i,theta_o,phi_o,r,g", "expected are"),
            ("theta_i,phi_i,theta_o,phi_o,r,g,b,weight", "weight"),
            ("theta_i,phi_i,theta_o,phi_o,value,value", "twice"),
            ("theta_i,phi_i,theta_o,phi_o,500,600", "nm are needed"),
            ("", "names the columns"),
        ] {
            let error = parse(format!("{names}\n").as_bytes()).unwrap_err().to_string();
            assert!(error.contains(word), "{names}: {error}");
        }
        let error = parse(b"theta_i,phi_i,theta_o,phi_o,value\n20,0,95,180,1\n").unwrap_err().to_string();
        assert!(error.contains("line 2") && error.contains("95"), "{error}");
    }

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
            &format!("{HEADER}\n"),
            &format!("{HEADER}\n1,2,3\n"),
            &format!("{HEADER}\n0,0,1,0,0,1,NaN,0,0\n"),
            &format!("{HEADER}\n0,0,-1,0,0,1,0,0,0\n"),
            &format!("{HEADER}\n0,0,2,0,0,1,0,0,0\n"),
        ] {
            assert!(parse(text.as_bytes()).is_err(), "{text}");
        }
    }
}
