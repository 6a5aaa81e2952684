//! Reader of the text files of SPEOS: `.anisotropicbsdf`, and the spectral `.brdf`.
//!
//! Both have tables of theta by phi for each angle of incidence. Tables are proportional to the BSDF, or to the intensity, which is the
//! BSDF times the cosine; how bright they are follows from the reflectance that stands beside them. In the first, one spectrum of the
//! reflectance at one direction colours all tables; in the second, there is a table for each wavelength.
//! Phi is 0 on the side of the mirror direction, and 180 degrees where the light comes from.

use super::conventions::Conventions;
use super::intake::{Intake, Reading};
use super::reason::Reason;
use super::wavelengths::Wavelengths;
use super::words::Words;
use crate::ReadError;
use crate::file::decode::{decode, shortened};
use crate::table::direction;
use std::f64::consts::PI;

/// Most numbers of one list.
const MOST: usize = 100_000;

/// One table: angles in degrees, values by rows of theta, and the line of each row.
struct Grid {
    thetas: Vec<(f64, usize)>,
    phis: Vec<f64>,
    values: Vec<f64>,
}

fn fail<T>(text: impl Into<String>) -> Result<T, ReadError> {
    Err(ReadError::Content(text.into()))
}

impl Grid {
    fn read(words: &mut Words<'_>) -> Result<Self, ReadError> {
        let [rows, columns] =
            [words.count("how many theta there are", MOST)?, words.count("how many phi there are", MOST)?];
        if rows.saturating_mul(columns) > 10_000_000 || rows == 0 || columns == 0 {
            return fail(format!("line {}: a table of {rows} by {columns}", words.line()));
        }
        let phis = words.numbers(columns, "phi in degrees")?;
        let (mut thetas, mut values) = (Vec::new(), Vec::new());
        for _ in 0..rows {
            let theta = words.number("theta in degrees")?;
            thetas.push((theta, words.line()));
            values.extend(words.numbers(columns, "a value of the table")?);
        }
        Ok(Self { thetas, phis, values })
    }

    /// Integral of the values times the cosine over the hemisphere, linear between angles.
    fn integral(&self) -> f64 {
        let mut sum = 0.0;
        for (t, theta) in self.thetas.windows(2).enumerate() {
            let [a, b] = [theta[0].0, theta[1].0].map(f64::to_radians);
            for (p, phi) in self.phis.windows(2).enumerate() {
                let at = |i: usize, j: usize| self.values[(t + i) * self.phis.len() + p + j];
                // Two points of Gauss in theta, the mean in phi.
                for node in [0.5 - 0.5 / 3f64.sqrt(), 0.5 + 0.5 / 3f64.sqrt()] {
                    let theta = a + node * (b - a);
                    let low = 0.5 * (at(0, 0) + at(0, 1));
                    let high = 0.5 * (at(1, 0) + at(1, 1));
                    let value = low + node * (high - low);
                    let cosine = libm::cos(theta).max(0.0) * libm::sin(theta);
                    sum += 0.5 * (b - a) * (phi[1] - phi[0]).to_radians() * value * cosine;
                }
            }
        }
        // Tables of half a turn are the same on the other side.
        let turn = self.phis[self.phis.len() - 1] - self.phis[0];
        if turn > 0.0 { sum * 360.0 / turn } else { sum * 2.0 * PI }
    }

    /// Divides an intensity by the cosine; 0 at the horizon.
    fn divide_by_cosine(&mut self) {
        for (t, (theta, _)) in self.thetas.iter().enumerate() {
            let cos = libm::cos(theta.to_radians());
            let row = &mut self.values[t * self.phis.len()..(t + 1) * self.phis.len()];
            row.iter_mut().for_each(|v| *v = if cos > 1e-6 { *v / cos } else { 0.0 });
        }
    }
}

/// The head of both formats: whether there is reflection and transmission, and whether values are the BSDF.
struct Head {
    has: [bool; 2],
    is_bsdf: bool,
}

impl Head {
    /// Passes over name, comment and description, which are text, and an axis, of the first format; gives the rest.
    fn split<'a>(text: &'a str, has_axis: bool) -> Result<(Self, Words<'a>), ReadError> {
        let mut lines = text.lines();
        lines.next();
        let mode = lines.next().unwrap_or("").trim();
        if mode != "0" {
            return fail(format!(
                "line 2: `{}`; only text is read, whose mode is 0: save it as text in SPEOS",
                shortened(mode)
            ));
        }
        lines.next();
        let length = lines.next().unwrap_or("").trim();
        let Ok(length) = length.parse::<usize>() else {
            return fail(format!(
                "line 4: `{}` where the length of the description was expected",
                shortened(length)
            ));
        };
        // The description is a number of characters, which may hold ends of lines.
        let at = text.match_indices('\n').nth(3).map_or(text.len(), |m| m.0 + 1);
        let rest = text[at..].char_indices().nth(length).map_or("", |(end, _)| &text[at + end..]);
        let mut words = Words::new(rest, &[]);
        if has_axis {
            words.numbers(3, "the axis of anisotropy")?;
        }
        let has = [words.count("1 for reflection", 1)? == 1, words.count("1 for transmission", 1)? == 1];
        let is_bsdf = words.count("1 for values of the BSDF", 1)? == 1;
        Ok((Self { has, is_bsdf }, words))
    }
}

/// Parses the bytes of an `.anisotropicbsdf` file of an isotropic surface.
///
/// # Errors
/// [`ReadError`] with the fault, and for more than one angle of anisotropy.
pub fn anisotropic(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let text = decode(bytes)?;
    let (head, mut words) = Head::split(&text, true)?;
    let mut reading = Reading::new("SPEOS .anisotropicbsdf", conventions);
    if !head.has[0] {
        return fail("SPEOS .anisotropicbsdf of transmission alone: only reflection is read");
    }
    let turns = words.count("how many angles of anisotropy there are", MOST)?;
    words.numbers(turns, "an angle of anisotropy")?;
    if turns != 1 {
        return fail(format!(
            "SPEOS .anisotropicbsdf of {turns} angles of the sample: only one is read, an isotropic surface"
        ));
    }
    let count = words.count("how many angles of incidence there are", MOST)?;
    let incidence = words.numbers(count, "an angle of incidence in degrees")?;
    let reference = words.numbers(2, "the direction of the spectrum")?[0];
    let lines = words.count("how many wavelengths there are", MOST)?;
    let spectrum: Vec<[f64; 2]> = (0..lines)
        .map(|_| Ok([words.number("a wavelength in nm")?, words.number("a reflectance in per cent")?]))
        .collect::<Result<_, ReadError>>()?;
    let tables: Vec<Grid> =
        incidence.iter().map(|_| Grid::read(&mut words)).collect::<Result<_, ReadError>>()?;
    let (colour, values) = colour(&spectrum, &mut reading)?;
    let grids: Vec<Grid> = tables
        .into_iter()
        .map(|mut grid| {
            if !head.is_bsdf {
                grid.divide_by_cosine();
            }
            grid
        })
        .collect();
    // All tables share one scale, with which the one of the reference reflects as the spectrum says.
    let near = |n: &usize| (incidence[*n] - reference).abs();
    let Some(of) = (0..grids.len()).min_by(|a, b| near(a).total_cmp(&near(b))) else {
        return fail("SPEOS .anisotropicbsdf without an angle of incidence");
    };
    let integral = grids[of].integral();
    if !(integral > 0.0 && integral.is_finite()) {
        return fail("the table whose reflectance is known is black");
    }
    let mean = colour.iter().sum::<f64>() / 3.0;
    reading.state(incidence[of], mean);
    reading.note(format!(
        "values are scaled to reflect {mean:.3} of the light at {} degrees, as the file says",
        incidence[of]
    ));
    for (theta_i, grid) in incidence.iter().zip(&grids) {
        push(&mut reading, *theta_i, grid, &mut |v| {
            let spectrum = values.iter().map(|share| share * v / integral).collect();
            (colour.map(|c| c * v / integral), v, spectrum)
        });
    }
    reading.finish()
}

/// Linear sRGB of a spectrum in per cent, and its values.
fn colour(spectrum: &[[f64; 2]], reading: &mut Reading) -> Result<([f64; 3], Vec<f64>), ReadError> {
    let values: Vec<f64> = spectrum.iter().map(|pair| 0.01 * pair[1]).collect();
    let [first, rest @ ..] = values.as_slice() else { return fail("a spectrum without a wavelength") };
    // The same at all wavelengths is grey, however few there are.
    if rest.iter().all(|v| v == first) {
        return Ok(([*first; 3], values));
    }
    let wavelengths = Wavelengths::new(&spectrum.iter().map(|pair| pair[0]).collect::<Vec<_>>())?;
    let wavelengths = reading.wavelengths_are(wavelengths, 1.0)?;
    Ok((wavelengths.rgb(&values), values))
}

/// Adds the samples of a table, but those of the horizon and behind.
fn push(
    reading: &mut Reading,
    theta_i: f64,
    grid: &Grid,
    value: &mut dyn FnMut(f64) -> ([f64; 3], f64, Vec<f64>),
) {
    let count = grid.phis.len();
    let turned = (grid.phis[count - 1] - grid.phis[0] - 360.0).abs() < 1e-6;
    for (t, (theta, line)) in grid.thetas.iter().enumerate() {
        // The normal is one sample, and the last azimuth the first again.
        let used = if *theta == 0.0 { 1 } else { count - usize::from(turned && count > 1) };
        for (p, phi) in grid.phis.iter().take(used).enumerate() {
            let (rgb, cell, spectrum) = value(grid.values[t * count + p]);
            let pair =
                [direction(theta_i.to_radians(), 0.0), direction(theta.to_radians(), phi.to_radians() + PI)];
            reading.push_spectrum(*line, pair, rgb, [&[cell], &spectrum]);
        }
    }
}

/// Parses the bytes of a spectral `.brdf` file.
///
/// # Errors
/// [`ReadError`] with the fault.
pub fn spectral(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let text = decode(bytes)?;
    let (head, mut words) = Head::split(&text, false)?;
    let mut reading = Reading::new("SPEOS .brdf", conventions);
    if !head.has[0] {
        return fail("SPEOS .brdf of transmission alone: only reflection is read");
    }
    let [angles, lines] = [
        words.count("how many angles of incidence there are", MOST)?,
        words.count("how many wavelengths there are", MOST)?,
    ];
    let incidence = words.numbers(angles, "an angle of incidence in degrees")?;
    let wavelengths = Wavelengths::new(&words.numbers(lines, "a wavelength in nm")?)?;
    let wavelengths = reading.wavelengths_are(wavelengths, 1.0)?;
    let mut transmission = 0;
    for theta_i in incidence {
        let mut grids = Vec::with_capacity(lines.min(1000));
        let mut totals = Vec::new();
        for _ in 0..lines {
            let total = 0.01 * words.number("a reflectance in per cent")?;
            let mut grid = Grid::read(&mut words)?;
            if !head.is_bsdf {
                grid.divide_by_cosine();
            }
            let integral = grid.integral();
            let scale = if total > 0.0 && integral > 0.0 { total / integral } else { 1.0 };
            grid.values.iter_mut().for_each(|v| *v *= scale);
            totals.push(total);
            grids.push(grid);
        }
        if head.has[1] {
            for _ in 0..lines {
                words.number("a transmittance in per cent")?;
                transmission += Grid::read(&mut words)?.values.len();
            }
        }
        let Some(first) = grids.first() else { return fail("SPEOS .brdf without a wavelength") };
        if grids.iter().any(|grid| grid.thetas.len() != first.thetas.len() || grid.phis != first.phis) {
            return fail(format!(
                "tables of {theta_i} degrees differ in their angles from one wavelength to the next"
            ));
        }
        reading.state(theta_i, totals.iter().sum::<f64>() / totals.len() as f64);
        let mut at = 0;
        let count = first.phis.len();
        let turned = (first.phis[count - 1] - first.phis[0] - 360.0).abs() < 1e-6;
        for (theta, line) in &first.thetas {
            for (p, phi) in first.phis.iter().enumerate() {
                let cells: Vec<f64> = grids.iter().map(|grid| grid.values[at]).collect();
                at += 1;
                if p > 0 && (*theta == 0.0 || (turned && p + 1 == count)) {
                    continue;
                }
                let pair = [
                    direction(theta_i.to_radians(), 0.0),
                    direction(theta.to_radians(), phi.to_radians() + PI),
                ];
                reading.push(*line, pair, wavelengths.rgb(&cells), &cells);
            }
        }
    }
    for _ in 0..transmission {
        reading.leave_out(Reason::Transmission, words.line());
    }
    reading.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(value: f64) -> String {
        let mut text = "4 3\n\t0 90 180\n".to_owned();
        for theta in [0, 30, 60, 90] {
            text += &format!("{theta}\t{value}\t{value}\t{value}\n");
        }
        text
    }

    fn head(name: &str) -> String {
        format!("OPTIS - {name}\n0\nComment\n11\nmade\nby us.\n")
    }

    #[test]
    fn a_grey_surface_reflects_what_the_file_says() {
        let text = head("Anisotropic BSDF surface file v8.0")
            + "0 1 0\n1 0\n1\n1\n0\n2\n20 50\n20 0\n\n2\n350 50\n850 50\n"
            + &grid(7.0)
            + &grid(7.0)
            + "End of file\n";
        let intake = anisotropic(text.as_bytes(), &Conventions::default()).unwrap();
        // A constant f reflects pi f.
        assert!(intake.rows.iter().all(|row| (row.rgb[1] - 0.5 / PI).abs() < 0.01), "{:?}", intake.rows[0]);
        assert_eq!((intake.rows.len(), intake.left_out_count()), (14, 6));
        let turned = text.replacen("1\n1\n0\n2\n", "1\n2\n0 90\n2\n", 1);
        assert!(
            anisotropic(turned.as_bytes(), &Conventions::default())
                .unwrap_err()
                .to_string()
                .contains("isotropic")
        );
        for cut in (0..text.len() - 40).step_by(3) {
            assert!(anisotropic(&text.as_bytes()[..cut], &Conventions::default()).is_err(), "{cut}");
        }
    }

    /// The tables are brightest at theta 30, phi 0: that is the mirror direction.
    #[test]
    fn the_mirror_direction_has_phi_0() {
        let bright = grid(1.0).replace("30\t1\t", "30\t9\t");
        let text = head("Anisotropic BSDF surface file v8.0")
            + "0 1 0\n1 0\n1\n1\n0\n1\n30\n30 0\n\n2\n350 50\n850 50\n"
            + &bright
            + "End of file\n";
        let table = grid(1.0).replace("30\t1\t", "30\t9\t");
        let of_wavelengths = head("brdf surface file v9.0") + "1 0\n1\n1 1\n30\n550\n50\n" + &table;
        for intake in [
            anisotropic(text.as_bytes(), &Conventions::default()).unwrap(),
            spectral(of_wavelengths.as_bytes(), &Conventions::default()).unwrap(),
        ] {
            let best = intake.rows.iter().max_by(|a, b| a.rgb[1].total_cmp(&b.rgb[1])).unwrap();
            let off =
                (0..3).map(|k| (best.wi[k] * [-1.0, -1.0, 1.0][k] - best.wo[k]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{:?} {:?}", best.wi, best.wo);
        }
    }

    #[test]
    fn a_table_for_each_wavelength_is_a_colour() {
        let table = |percent: f64| format!("{percent}\n{}", grid(1.0));
        let lines = [400, 450, 500, 550, 600, 650, 700];
        let text = head("brdf surface file v9.0")
            + &format!("1 0\n1\n1 {}\n30\n{}\n", lines.len(), lines.map(|l| l.to_string()).join("\t"))
            + &lines.map(|_| table(50.0)).concat();
        let intake = spectral(text.as_bytes(), &Conventions::default()).unwrap();
        for row in &intake.rows {
            assert!(row.rgb.iter().all(|v| (v - 0.5 / PI).abs() < 0.01), "{row:?}");
        }
        let binary = text.replacen("\n0\n", "\n1\n", 1);
        assert!(
            spectral(binary.as_bytes(), &Conventions::default()).unwrap_err().to_string().contains("text")
        );
    }
}
