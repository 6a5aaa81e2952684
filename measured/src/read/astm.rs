//! Reader of `.astm` files: measurements in the form of ASTM E1392, as Cornell and other laboratories write them.
//!
//! `KEY value` lines, of which `NUM_POINTS` and `VARS` matter; then a row of numbers for each sample, in the columns that `VARS` names:
//! both directions, and a value, in any spelling that a table of text may have. Angles are in radians, unless they are too large to be.
//! Cornell's own RGB files are scaled by their phosphors' sums, which is undone.

use super::conventions::Conventions;
use super::csv;
use super::intake::Intake;
use crate::ReadError;
use crate::file::decode::{decode, shortened};

/// Value of a reflectance of 1 in Cornell's files of "RGB for Trinitron phosphors": recovered from spectral files.
const TRINITRON: [f64; 3] = [0.3575, 0.3587, 0.3575];

/// Parses the bytes of an `.astm` file.
///
/// # Errors
/// [`ReadError`], with the line of the fault; fewer or more rows than `NUM_POINTS` are one.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let content = |text: String| ReadError::Content(text);
    let text = decode(bytes)?;
    let mut points = None;
    let mut scale = [1.0; 3];
    let mut at = 0;
    for (n, line) in text.split_inclusive('\n').enumerate() {
        at += line.len();
        let line = line.trim();
        let (key, value) = line.split_once([' ', '\t']).unwrap_or((line, ""));
        let value = value.trim();
        match key {
            "NUM_POINTS" => {
                let parsed = value.parse::<usize>();
                points = Some(
                    parsed
                        .map_err(|_| content(format!("line {}: NUM_POINTS {}", n + 1, shortened(value))))?,
                );
            }
            "LAB_COMMENTS" if value.contains("RGB for Trinitron phosphors") => scale = TRINITRON,
            "VARS" => {
                let intake = csv::parse_named("ASTM E1392", value, (&text[at..], n + 2), conventions, scale)?;
                let rows = intake.rows.len() + intake.left_out_count();
                return match points.filter(|points| *points != rows) {
                    Some(points) => Err(content(format!("{rows} rows, but NUM_POINTS is {points}"))),
                    None => Ok(intake),
                };
            }
            _ => {}
        }
    }
    Err(content("ends before a line VARS that names the columns".into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "LAB_NAME x\nNUM_POINTS 2\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B\n\n0.5,0,0.3,1,0.1,0.2,0.3\n0.5,0,0.4,3.1,0.1,-0.2,0.3\n";

    fn parse(bytes: &[u8]) -> Result<Intake, ReadError> {
        super::parse(bytes, &Conventions::default())
    }

    #[test]
    fn reads_rows_and_counts_them() {
        let intake = parse(SMALL.as_bytes()).unwrap();
        assert_eq!((intake.rows.len(), intake.views().len(), intake.rows[0].line), (2, 1, 5));
        assert_eq!(intake.rows[1].rgb, [0.1, -0.2, 0.3]);
        let whole = SMALL.len();
        // A cut inside the very last number leaves a number.
        for cut in (0..whole - 4).chain([whole - 2]) {
            assert!(parse(&SMALL.as_bytes()[..cut]).is_err() || cut >= whole - 3, "{cut}");
        }
    }

    #[test]
    fn other_columns_and_units_are_read() {
        let rows = "0.5,0,0.3,1,0.1,0.2,0.3\n0.5,0,0.4,3.1,0.1,-0.2,0.3\n";
        for vars in ["theta_i,phi_i,theta_r,phi_r,X,Y,Z", "theta_i,phi_i,theta_s,phi_s,400nm,550nm,700nm"] {
            assert_eq!(parse(format!("VARS {vars}\n\n{rows}").as_bytes()).unwrap().rows.len(), 2, "{vars}");
        }
        let degrees = "VARS theta_i,phi_i,theta_s,phi_s,550nm\n30,0,40,180,0.1\n";
        let found = parse(degrees.as_bytes()).unwrap();
        assert!((found.rows[0].wi[2] - 30f64.to_radians().cos()).abs() < 1e-12);
        assert!(found.notes.iter().any(|note| note.option == Some("--angles")), "{:?}", found.notes);
    }

    #[test]
    fn damage_is_an_error() {
        for (from, to) in
            [("0.2,0.3", "x,0.3"), ("0.2,0.3", "0.2"), ("POINTS 2", "POINTS 3"), ("R,G,B", "R,G")]
        {
            assert!(parse(SMALL.replacen(from, to, 1).as_bytes()).is_err(), "{from} {to}");
        }
        assert!(parse(&[0xff; 9]).is_err() && parse(b"").is_err());
    }
}
