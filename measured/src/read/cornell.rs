//! Reader of `.brdf` files: Cornell's gonioreflectometer measurements as pbrt-v2 distributes them.
//!
//! `#` starts a comment to the end of the line; the rest are whitespace-separated numbers: the number of wavelengths, the
//! wavelengths in nm, then for each sample `theta_i phi_i theta_s phi_s` in radians and one value of the BRDF (1/sr, not
//! multiplied by the cosine) per wavelength.
//!
//! The samples are grouped by `theta_i`, of which a file has few; by reciprocity it is taken as the outgoing direction and
//! the scattered direction as the incident one. The mirror direction is at azimuths that are pi apart.

use super::conventions::Conventions;
use super::intake::{Intake, Reading};
use super::numbers::Numbers;
use super::wavelengths::Wavelengths;
use crate::ReadError;
use crate::table::direction;
use std::f64::consts::{FRAC_PI_2, PI};

/// Most wavelengths that a file may have.
const MAX_WAVELENGTHS: f64 = 4096.0;

/// Largest value of a BRDF that is believed, 1/sr.
const MAX_VALUE: f64 = 1e9;

/// Parses the bytes of a `.brdf` file.
///
/// # Errors
/// [`ReadError`], with the line and number of the fault.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let mut numbers = Numbers::new(bytes)?;
    let expected = format!("the number of wavelengths, a whole number from 1 to {MAX_WAVELENGTHS}");
    let count = numbers.next(&expected, |v| (1.0..=MAX_WAVELENGTHS).contains(&v) && v.fract() == 0.0)?;
    let mut wavelengths = Vec::new();
    for _ in 0..count as usize {
        wavelengths
            .push(numbers.next("a wavelength in nm, from 100 to 10000", |v| (100.0..=1e4).contains(&v))?);
    }
    let mut reading = Reading::new("Cornell .brdf", conventions);
    let to_rgb = reading.wavelengths_are(Wavelengths::new(&wavelengths)?, 1.0)?;

    let theta = |v: f64| (0.0..=FRAC_PI_2 + 1e-5).contains(&v);
    let phi = |v: f64| v.abs() <= 2.0 * PI + 1e-5;
    let mut any = false;
    let mut spectrum = vec![0.0; wavelengths.len()];
    while let Some(theta_i) =
        numbers.next_if_any("theta_i in radians, at least 0 and less than pi / 2", theta)?
    {
        let phi_i = numbers.next("phi_i in radians, within 2 pi of 0", phi)?;
        let theta_s = numbers.next("theta_s in radians, from 0 to pi / 2", theta)?;
        let phi_s = numbers.next("phi_s in radians, within 2 pi of 0", phi)?;
        for value in &mut spectrum {
            *value = numbers.next("a BRDF value, at most 1e9 in size", |v| v.abs() <= MAX_VALUE)?;
        }
        let pair = [direction(theta_i, phi_i), direction(theta_s, phi_s)];
        reading.push(numbers.line(), pair, to_rgb.rgb(&spectrum), &spectrum);
        any = true;
    }
    if !any {
        // One more number is missing at least; say so with its place.
        numbers.next("theta_i of a first sample", |_| true)?;
    }
    reading.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{Scattered, Table};

    fn parse(bytes: &[u8]) -> Result<Vec<(f64, Scattered)>, ReadError> {
        super::parse(bytes, &Conventions::default()).map(|intake| intake.views())
    }

    fn small() -> String {
        let mut text = "# test\n4 # wavelengths\n400 500\n600 700\n".to_owned();
        for theta_i in ["0.2", "0.9"] {
            for theta_s in ["0.1", "0.7", "1.2"] {
                for phi_s in ["0", "-1.5", "3.14159"] {
                    text += &format!("{theta_i} 0 {theta_s} {phi_s} 0.25 0.25 0.25 0.25\n");
                }
            }
        }
        text
    }

    #[test]
    fn a_small_file_gives_views_in_order_and_the_mirror_direction_at_plus_x() {
        let views = parse(small().as_bytes()).unwrap();
        assert_eq!(views.len(), 2);
        assert!((views[1].0 - 0.9).abs() < 1e-12);
        let (d, rgb) = views[1].1[8];
        assert!(d[0] > 0.9 && d[1].abs() < 1e-5 && (d[2] - libm::cos(1.2)).abs() < 1e-12, "{d:?}");
        assert!(rgb.iter().all(|v| (v - 0.25).abs() < 1e-6), "{rgb:?}");
        Table::from_scattered(views).unwrap();
    }

    #[test]
    fn every_truncation_is_an_error_or_ends_between_samples() {
        let text = small();
        let numbers = |t: &str| {
            t.lines().map(|l| l.split('#').next().unwrap().split_whitespace().count()).sum::<usize>()
        };
        for cut in 0..text.len() {
            let part = &text[..cut];
            let n = numbers(part);
            let whole = n > 5 && (n - 5) % 8 == 0;
            assert_eq!(parse(part.as_bytes()).is_ok(), whole, "cut at {cut}: {:?}", parse(part.as_bytes()));
        }
    }

    #[test]
    fn damage_names_its_place() {
        let fault =
            |from: &str, to: &str| parse(small().replacen(from, to, 1).as_bytes()).unwrap_err().to_string();
        assert!(fault("0.25 ", "NaN ").starts_with("line 5, number 10: `NaN`"), "{}", fault("0.25 ", "NaN "));
        assert!(fault("0.25 ", "inf ").contains("`inf`"));
        assert!(fault("0.25 ", "-2e9 ").contains("`-2e9`"));
        assert!(fault("0.2 0 0.1", "-0.2 0 0.1").contains("theta_i"));
        assert!(fault("0.2 0 0.1", "0.2 0 -0.1").contains("theta_s"));
        assert!(fault("0.2 0 0.1", "0.2 9 0.1").contains("phi_i"));
        for count in ["1e12", "-4", "0", "3.5", "99999999999999999999", "x"] {
            assert!(fault("4 #", &format!("{count} #")).contains("number of wavelengths"), "{count}");
        }
        assert!(fault("400 500", "500 500").contains("twice"));
    }

    #[test]
    fn what_is_not_a_file_of_this_kind_is_an_error() {
        for bytes in [
            &b""[..],
            b"   \n\n",
            b"# only a comment",
            b"\x89SRBF\r\n\x1a\0\0\0",
            &[0xff; 64],
            &[0; 64],
            b"hello",
        ] {
            assert!(parse(bytes).is_err(), "{bytes:?}");
        }
    }
}
