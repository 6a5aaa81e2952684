//! Reader of the text files of ALTA, a library that fits BRDFs: lines of coordinates and values, after lines that name both.
//!
//! `#PARAM_IN` names the coordinates, `#PARAM_OUT` the values, `#DIM` how many there are of each. Angles are in radians; the mirror
//! direction is at azimuths that are pi apart.

use super::conventions::{Conventions, Values};
use super::intake::{Intake, Reading};
use super::spectrum::rgb_of_xyz;
use crate::ReadError;
use crate::file::decode::{decode, shortened};
use crate::file::rows::numbers;
use crate::table::direction;

/// Coordinates that are read, and how many numbers each has.
const COORDINATES: [(&str, usize); 6] = [
    ("ISOTROPIC_TV_TL", 2),
    ("ISOTROPIC_TV_TL_DPHI", 3),
    ("ISOTROPIC_TL_TV_PROJ_DPHI", 3),
    ("SPHERICAL_TL_PL_TV_PV", 4),
    ("CARTESIAN", 6),
    ("RUSIN_TH_TD_PD", 3),
];

/// Parses the bytes of a file.
///
/// # Errors
/// [`ReadError`] with the line of the fault, and for coordinates that are not read.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let fail = |text: String| Err(ReadError::Content(text));
    let text = decode(bytes)?;
    let said = |key: &str| text.lines().find_map(|line| line.trim().strip_prefix(key)).map(str::trim);
    let name = said("#PARAM_IN").unwrap_or("");
    let Some(&(name, count)) = COORDINATES.iter().find(|known| known.0 == name) else {
        let known: Vec<&str> = COORDINATES.iter().map(|known| known.0).collect();
        return fail(format!("ALTA coordinates `{}`; read are {}", shortened(name), known.join(", ")));
    };
    let mut reading = Reading::new("ALTA", conventions);
    let of_values = said("#PARAM_OUT").unwrap_or("INV_STERADIAN");
    if of_values == "INV_STERADIAN_COSINE_FACTOR" {
        reading.values_are(Values::CosineOutgoing);
    }
    let channels = match said("#DIM").map(|dim| dim.split_whitespace().nth(1).map(str::parse::<usize>)) {
        Some(Some(Ok(n))) if n == 1 || n == 3 => n,
        None => 1,
        _ => return fail("ALTA #DIM: one value or three are expected".into()),
    };
    let mut row = vec![0.0; count + channels];
    for (n, line) in
        text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'))
    {
        // Intervals of confidence may follow.
        numbers(n + 1, line, &mut row)?;
        let (at, values) = row.split_at(count);
        let pair = match name {
            "ISOTROPIC_TV_TL" => [direction(at[1], 0.0), direction(at[0], 0.0)],
            "ISOTROPIC_TV_TL_DPHI" => [direction(at[1], 0.0), direction(at[0], at[2])],
            "ISOTROPIC_TL_TV_PROJ_DPHI" => {
                [direction(at[0], 0.0), direction(libm::hypot(at[1], at[2]), libm::atan2(at[2], at[1]))]
            }
            "SPHERICAL_TL_PL_TV_PV" => [direction(at[0], at[1]), direction(at[2], at[3])],
            "RUSIN_TH_TD_PD" => from_half(at[0], at[1], at[2]),
            _ => [[at[3], at[4], at[5]], [at[0], at[1], at[2]]],
        };
        let is_unit = |d: &[f64; 3]| (d.iter().map(|v| v * v).sum::<f64>() - 1.0).abs() < 1e-3;
        if !pair.iter().all(is_unit) {
            return fail(format!("line {}: a direction is no unit vector", n + 1));
        }
        let rgb = match (values, of_values) {
            (&[x, y, z], "XYZ_COLOR") => rgb_of_xyz([x, y, z]),
            (&[r, g, b], _) => [r, g, b],
            _ => [values[0]; 3],
        };
        reading.push(n + 1, pair, rgb, values);
    }
    reading.finish()
}

/// Incident and outgoing direction from half and difference angles, turned so that the incident one is at azimuth 0: none of the turns of
/// the half vector is one of the sample.
pub(super) fn from_half(theta_h: f64, theta_d: f64, phi_d: f64) -> [[f64; 3]; 2] {
    let (sin, cos) = libm::sincos(theta_h);
    let [i, o] = [phi_d, phi_d + std::f64::consts::PI].map(|phi| {
        let [x, y, z] = direction(theta_d, phi);
        [x * cos + z * sin, y, z * cos - x * sin]
    });
    let across = libm::hypot(i[0], i[1]);
    let (c, s) = if across > 0.0 { (i[0] / across, i[1] / across) } else { (1.0, 0.0) };
    [i, o].map(|d| [c * d[0] + s * d[1], c * d[1] - s * d[0], d[2]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_of_all_names_are_the_same_directions() {
        // Light at 0.5, viewer at 0.9, azimuths 2 apart.
        let (l, v) = (direction(0.5, 0.0), direction(0.9, 2.0));
        let (x, y) = (0.9 * libm::cos(2.0), 0.9 * libm::sin(2.0));
        let vectors = format!("{} {} {} {} {} {}", v[0], v[1], v[2], l[0], l[1], l[2]);
        for (name, row) in [
            ("ISOTROPIC_TV_TL_DPHI", "0.9 0.5 2".to_owned()),
            ("ISOTROPIC_TL_TV_PROJ_DPHI", format!("0.5 {x} {y}")),
            ("SPHERICAL_TL_PL_TV_PV", "0.5 1 0.9 3".to_owned()),
            ("CARTESIAN", vectors),
        ] {
            let text = format!("#DIM 3 1\n#PARAM_IN {name}\n#PARAM_OUT INV_STERADIAN\n{row} 0.25\n");
            let intake = parse(text.as_bytes(), &Conventions::default()).unwrap();
            let Intake { rows, .. } = intake;
            let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
            assert!((dot(rows[0].wi, rows[0].wo) - dot(l, v)).abs() < 1e-9, "{name}: {rows:?}");
            assert!((rows[0].wi[2] - l[2]).abs() < 1e-9 && rows[0].rgb == [0.25; 3], "{name}: {rows:?}");
        }
        let cosine = "#DIM 3 1\n#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI\n#PARAM_OUT INV_STERADIAN_COSINE_FACTOR\n0.5 1 0 0.25\n";
        let intake = parse(cosine.as_bytes(), &Conventions::default()).unwrap();
        assert!((intake.rows[0].rgb[0] - 0.25 / libm::cos(1.0)).abs() < 1e-12);
        let odd = cosine.replace("ISOTROPIC_TL_TV_PROJ_DPHI", "STARK_3D");
        assert!(parse(odd.as_bytes(), &Conventions::default()).unwrap_err().to_string().contains("STARK_3D"));
        let short = cosine.replace("0.5 1 0 0.25", "0.5 1 0");
        assert!(parse(short.as_bytes(), &Conventions::default()).unwrap_err().to_string().contains("line 4"));
    }
}
