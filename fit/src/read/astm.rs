//! Reader of `.astm` files: Cornell's gonioreflectometer measurements in the form of ASTM E1392.
//!
//! `KEY value` lines, of which `NUM_POINTS` and `VARS` matter; then a row of comma-separated numbers for each sample, in the
//! columns that `VARS` names: `theta_i,phi_i,theta_s,phi_s` in radians, and either wavelengths as `400nm,410nm,...` or
//! `R,G,B`. Cornell's own RGB files are scaled by their phosphors' sums, which is undone.

use super::Scatter;
use super::rows::{row, text};
use super::spectrum::ToRgb;
use crate::ReadError;
use crate::table::{Scattered, direction};
use std::f64::consts::PI;

/// What a reflectance of 1 gives in Cornell's files of "RGB for Trinitron phosphors": recovered from spectral files.
const TRINITRON: [f64; 3] = [0.3575, 0.3587, 0.3575];

/// Most columns that are read.
const MAX_COLUMNS: usize = 4100;

/// Parses the bytes of an `.astm` file to the samples of each view, theta rising.
///
/// # Errors
/// [`ReadError`], with the line of the fault; fewer or more rows than `NUM_POINTS` are one.
pub fn parse(bytes: &[u8]) -> Result<Vec<(f64, Scattered)>, ReadError> {
    let content = |text: String| ReadError::Content(text);
    let mut lines = text(bytes)?.lines().enumerate();
    let mut points = None;
    let mut scale = [1.0; 3];
    let columns: Vec<&str> = loop {
        let Some((n, line)) = lines.next() else {
            return Err(content("ends before a line VARS that names the columns".into()));
        };
        let (key, value) = line.split_once(' ').unwrap_or((line, ""));
        match key {
            "NUM_POINTS" => {
                let parsed = value.trim().parse::<usize>();
                points = Some(parsed.map_err(|_| content(format!("line {}: NUM_POINTS {value}", n + 1)))?);
            }
            "LAB_COMMENTS" if value.contains("RGB for Trinitron phosphors") => scale = TRINITRON,
            "VARS" => break value.split(',').map(str::trim).collect(),
            _ => {}
        }
    };
    if columns.len() > MAX_COLUMNS || !columns.starts_with(&["theta_i", "phi_i", "theta_s", "phi_s"]) {
        return Err(content("VARS has to begin with theta_i,phi_i,theta_s,phi_s".into()));
    }
    let values = &columns[4..];
    let to_rgb = if values == ["R", "G", "B"] {
        None
    } else {
        let wavelength =
            |c: &&str| c.strip_suffix("nm").and_then(|n| n.parse::<f64>().ok()).filter(|w| w.is_finite());
        let wavelengths: Option<Vec<f64>> = values.iter().map(wavelength).collect();
        Some(ToRgb::new(
            &wavelengths
                .ok_or_else(|| content("VARS: columns after phi_s are R,G,B or wavelengths".into()))?,
        )?)
    };

    let mut scatter = Scatter::default();
    let mut numbers = vec![0.0; columns.len()];
    let mut rows = 0;
    for (n, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        row(n + 1, line, &mut numbers)?;
        rows += 1;
        let [theta_i, phi_i, theta_s, phi_s] = [numbers[0], numbers[1], numbers[2], numbers[3]];
        let rgb = match &to_rgb {
            Some(to_rgb) => to_rgb.convert(&numbers[4..]),
            None => [0, 1, 2].map(|c| numbers[4 + c] / scale[c]),
        };
        let place = |reason| content(format!("line {}: {reason}", n + 1));
        scatter
            .push([theta_i, phi_i], direction(theta_s, phi_s - phi_i - PI), theta_s, rgb)
            .map_err(place)?;
    }
    if points.is_some_and(|n| n != rows) {
        return Err(content(format!("{rows} rows, but NUM_POINTS is {}", points.unwrap_or(0))));
    }
    scatter.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "LAB_NAME x\nNUM_POINTS 2\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B\n\n0.5,0,0.3,1,0.1,0.2,0.3\n0.5,0,0.4,3.1,0.1,-0.2,0.3\n";

    #[test]
    fn reads_rows_and_counts_them() {
        let views = parse(SMALL.as_bytes()).unwrap();
        assert_eq!((views.len(), views[0].1.len()), (1, 2));
        assert_eq!(views[0].1[1].1, [0.1, -0.2, 0.3]);
        let whole = SMALL.len();
        // A cut inside the very last number leaves a number.
        for cut in (0..whole - 4).chain([whole - 2]) {
            assert!(parse(&SMALL.as_bytes()[..cut]).is_err() || cut >= whole - 3, "{cut}");
        }
    }

    #[test]
    fn damage_is_an_error() {
        for (from, to) in [
            ("0.2,0.3", "NaN,0.3"),
            ("0.2,0.3", "0.2"),
            ("0.5,0,", "-0.5,0,"),
            ("POINTS 2", "POINTS 3"),
            ("R,G,B", "R,G"),
            ("0.4,3.1", "4,3.1"),
        ] {
            assert!(parse(SMALL.replacen(from, to, 1).as_bytes()).is_err(), "{from} {to}");
        }
        assert!(parse(&[0xff; 9]).is_err() && parse(b"").is_err());
    }
}
