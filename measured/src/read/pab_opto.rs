//! Reader of the text files of the pgII gonio-photometer (pab advanced technologies): rows of theta, phi and value for one incidence.
//!
//! Lines that begin with `#` are the head: `#intheta` and `#inphi` are the incident direction, `#format: theta phi DSF` says what rows
//! hold. `DSF` is the BSDF times the cosine of the outgoing direction. Angles are in degrees; behind the surface theta is above 90.

use super::conventions::{Conventions, Values};
use super::intake::{Intake, Reading};
use super::spectrum::rgb_of_xyz;
use crate::ReadError;
use crate::file::decode::{decode, shortened};
use crate::file::rows::numbers;
use crate::table::direction;

/// Parses the bytes of a file.
///
/// # Errors
/// [`ReadError`], with the line of the fault, or the line that the head lacks.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let fail = |text: String| Err(ReadError::Content(text));
    let text = decode(bytes)?;
    let mut reading = Reading::new("pgII text", conventions);
    let said = |keys: &[&str]| {
        text.lines().filter(|line| line.starts_with('#')).find_map(|line| {
            let rest = keys.iter().find_map(|key| line.strip_prefix(key))?;
            Some(rest.trim_start_matches([':', ' ', '\t', '"', '=']).trim_end_matches(['"', ' ', '\r']))
        })
    };
    let number = |keys: &[&str], at: usize| said(keys)?.split_whitespace().nth(at)?.parse::<f64>().ok();
    let incident = ["#incident_angle"];
    let theta_i = number(&["#intheta"], 0).or_else(|| number(&incident, 0));
    let phi_i = number(&["#inphi", "#i_phi"], 0).or_else(|| number(&incident, 1)).unwrap_or(0.0);
    let Some(theta_i) = theta_i.filter(|theta| (0.0..180.0).contains(theta)) else {
        return fail("pgII text without #intheta: the angle of incidence, 0 to 180 degrees".into());
    };
    if !phi_i.is_finite() {
        return fail("pgII text whose #inphi is no number: the azimuth of incidence, in degrees".into());
    }
    let format = said(&["#format"]).unwrap_or("theta phi BSDF");
    let Some(name) = format.split_whitespace().nth(2) else {
        return fail(format!("pgII #format `{}`: theta, phi and a value are expected", shortened(format)));
    };
    if name.eq_ignore_ascii_case("DSF") {
        reading.values_are(Values::CosineOutgoing);
    }
    let is_xyz = said(&["#colorimetry"]).is_some_and(|colours| colours.contains("CIE-XYZ"));
    let mut row = vec![0.0; if is_xyz { 5 } else { 3 }];
    // Behind the surface is above, for light that comes from behind.
    let side = if theta_i > 90.0 { -1.0 } else { 1.0 };
    for (n, line) in
        text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'))
    {
        numbers(n + 1, line, &mut row)?;
        let up = |theta: f64, phi: f64| {
            let [x, y, z] = direction(theta.to_radians(), phi.to_radians());
            [x, y, side * z]
        };
        let rgb = if is_xyz { rgb_of_xyz([row[2], row[3], row[4]]) } else { [row[2]; 3] };
        reading.push(n + 1, [up(theta_i, phi_i), up(row[0], row[1])], rgb, &row[2..]);
    }
    reading.note("one file holds one angle of incidence: put the rows of all into one table of text, with a column theta_i");
    reading.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::Reason;

    #[test]
    fn rows_are_of_one_incidence_and_dsf_is_divided() {
        let text = "#sample_name x\n#intheta 30\n#inphi 0\n#format: theta phi DSF\n30 180 0.5\n60 90 0.1\n150 180 0.2\n";
        let intake = parse(text.as_bytes(), &Conventions::default()).unwrap();
        assert_eq!((intake.rows.len(), intake.left_out[0].reason), (2, Reason::Transmission));
        assert!(
            (intake.rows[1].rgb[0] - 0.2).abs() < 1e-9 && intake.rows[0].wo[0] < 0.0,
            "{:?}",
            intake.rows
        );
        let error =
            parse(text.replace("#intheta", "#theta").as_bytes(), &Conventions::default()).unwrap_err();
        assert!(error.to_string().contains("#intheta"), "{error}");
        assert!(parse(text.replace("60 90", "60 x").as_bytes(), &Conventions::default()).is_err());
    }
}
