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
use crate::row::turned_back;
use crate::table::{direction, luminance};
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

    /// Reads one of reflection.
    fn read_front(words: &mut Words<'_>) -> Result<Self, ReadError> {
        let grid = Self::read(words)?;
        if grid.is_behind() {
            return fail(format!(
                "line {}: a table of theta from 90 degrees on, behind the surface, stands where reflection is due",
                grid.thetas[0].1
            ));
        }
        Ok(grid)
    }

    /// Whether all of it is behind the surface.
    fn is_behind(&self) -> bool {
        self.thetas.iter().all(|theta| theta.0 >= 90.0)
    }

    /// Whether another has the same angles and values, but for rounding.
    fn is_same(&self, other: &Self) -> bool {
        let most = self.values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let is_close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-4 * most;
        self.phis == other.phis
            && self.thetas.iter().map(|t| t.0).eq(other.thetas.iter().map(|t| t.0))
            && self.values.iter().zip(&other.values).all(is_close)
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

/// Parses the bytes of an `.anisotropicbsdf` file.
///
/// # Errors
/// [`ReadError`] with the fault.
pub fn anisotropic(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let text = decode(bytes)?;
    let (head, mut words) = Head::split(&text, true)?;
    let mut reading = Reading::new("SPEOS .anisotropicbsdf", conventions);
    if !head.has[0] {
        return fail("SPEOS .anisotropicbsdf of transmission alone: only reflection is read");
    }
    let turns = words.count("how many angles of anisotropy there are", MOST)?;
    let angles = words.numbers(turns, "an angle of anisotropy")?;
    // Each angle of the sample has a list, and the tables follow in the same order.
    let mut lists = Vec::new();
    for _ in 0..turns {
        let count = words.count("how many angles of incidence there are", MOST)?;
        lists.push(words.numbers(count, "an angle of incidence in degrees")?);
    }
    let reference = words.numbers(2, "the direction of the spectrum")?[0];
    let lines = words.count("how many wavelengths there are", MOST)?;
    let spectrum: Vec<[f64; 2]> = (0..lines)
        .map(|_| Ok([words.number("a wavelength in nm")?, words.number("a reflectance in per cent")?]))
        .collect::<Result<_, ReadError>>()?;
    let mut tables: Vec<Vec<Grid>> = Vec::new();
    for list in &lists {
        tables.push(list.iter().map(|_| Grid::read_front(&mut words)).collect::<Result<_, ReadError>>()?);
    }
    let is_again = |n: usize, m: usize| libm::remainder(angles[n] - angles[m], 360.0).abs() < 1e-6;
    let is_same = |n: usize| {
        lists[n] == lists[0]
            && (is_again(n, 0) || tables[n].iter().zip(&tables[0]).all(|(a, b)| a.is_same(b)))
    };
    let is_turned = !(1..turns).all(is_same);
    if is_turned {
        reading.note(format!(
            "{turns} angles of the sample, taken as azimuths of the plane of incidence: azimuths are counted from the sample"
        ));
    } else if turns > 1 {
        reading.note(format!("the {turns} angles of the sample are one: their tables are the same, or they are a whole turn apart"));
    }
    let used: Vec<usize> = match is_turned {
        true => (0..turns).filter(|n| !(0..*n).any(|m| is_again(*n, m))).collect(),
        false => (0..turns.min(1)).collect(),
    };
    if used.is_empty() {
        return fail("SPEOS .anisotropicbsdf without an angle of the sample");
    }
    let (colour, values) = colour(&spectrum, &mut reading)?;
    if !head.is_bsdf {
        tables.iter_mut().flatten().for_each(Grid::divide_by_cosine);
    }
    let (incidence, grids) = (&lists[0], &tables[0]);
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
    reading.state(incidence[of], luminance(colour));
    reading.note(format!(
        "values are scaled to reflect {mean:.3} of the light at {} degrees, as the file says",
        incidence[of]
    ));
    for n in used {
        let turn = if is_turned { angles[n].to_radians() } else { 0.0 };
        for (theta_i, grid) in lists[n].iter().zip(&tables[n]) {
            push(&mut reading, (*theta_i, turn), grid, &mut |v| {
                let spectrum = values.iter().map(|share| share * v / integral).collect();
                (colour.map(|c| c * v / integral), v, spectrum)
            });
        }
    }
    reading.finish()
}

/// Linear sRGB of a spectrum in per cent, and its values.
fn colour(spectrum: &[[f64; 2]], reading: &mut Reading) -> Result<([f64; 3], Vec<f64>), ReadError> {
    let values: Vec<f64> = spectrum.iter().map(|pair| 0.01 * pair[1]).collect();
    let [first, rest @ ..] = values.as_slice() else { return fail("a spectrum without a wavelength") };
    // The same at several wavelengths is grey, whatever these are.
    if !rest.is_empty() && rest.iter().all(|v| v == first) {
        return Ok(([*first; 3], values));
    }
    let wavelengths = Wavelengths::new(&spectrum.iter().map(|pair| pair[0]).collect::<Vec<_>>())?;
    let wavelengths = reading.wavelengths_are(wavelengths, 1.0)?;
    Ok((wavelengths.rgb(&values), values))
}

/// Adds the samples of a table, but those of the horizon and behind.
fn push(
    reading: &mut Reading,
    (theta_i, turn): (f64, f64),
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
            let pair = if turn == 0.0 { pair } else { pair.map(|d| turned_back(d, -turn)) };
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
    let count = incidence.len().saturating_mul(lines);
    let (tables, transmission) = of_reflection(&mut words, head.has[1], count, &mut reading)?;
    let mut tables = tables.into_iter();
    for theta_i in incidence {
        let mut grids = Vec::with_capacity(lines.min(1000));
        let mut totals = Vec::new();
        for (total, mut grid) in tables.by_ref().take(lines) {
            if !head.is_bsdf {
                grid.divide_by_cosine();
            }
            let integral = grid.integral();
            let scale = if total > 0.0 && integral > 0.0 { total / integral } else { 1.0 };
            grid.values.iter_mut().for_each(|v| *v *= scale);
            totals.push(total);
            grids.push(grid);
        }
        let Some(first) = grids.first() else { return fail("SPEOS .brdf without a wavelength") };
        if grids.iter().any(|grid| grid.thetas.len() != first.thetas.len() || grid.phis != first.phis) {
            return fail(format!(
                "tables of {theta_i} degrees differ in their angles from one wavelength to the next"
            ));
        }
        reading.state(theta_i, luminance(wavelengths.rgb(&totals)));
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
    for line in transmission {
        reading.leave_out(Reason::Transmission, line);
    }
    reading.finish()
}

/// Tables of reflection, each with its total, and lines of values of transmission.
type Sides = (Vec<(f64, Grid)>, Vec<usize>);

/// The tables of reflection, each with its total, and the lines of the values of transmission.
///
/// Tables behind the surface have theta from 90 degrees on, wherever they stand. Where all angles are below, those of reflection are first.
fn of_reflection(
    words: &mut Words<'_>,
    has_both: bool,
    count: usize,
    reading: &mut Reading,
) -> Result<Sides, ReadError> {
    let (mut front, mut behind) = (Vec::new(), Vec::new());
    for n in 0..count.saturating_mul(1 + usize::from(has_both)) {
        let total = 0.01 * words.number("a share of the light in per cent")?;
        let grid = if has_both { Grid::read(words)? } else { Grid::read_front(words)? };
        if grid.is_behind() || (n >= count && behind.is_empty()) || front.len() == count {
            behind.push(grid);
        } else {
            front.push((total, grid));
        }
    }
    if front.len() != count {
        return fail(format!(
            "{} of the tables are behind the surface, with theta from 90 degrees on, where {count} are expected",
            behind.len()
        ));
    }
    if has_both && behind.iter().any(|grid| !grid.is_behind()) {
        reading.note(
            "the tables of transmission have angles below 90 degrees: those of reflection are taken to be the first half of all",
        );
    }
    let lines = behind.iter().flat_map(|grid| grid.thetas.iter().flat_map(|t| grid.phis.iter().map(|_| t.1)));
    Ok((front, lines.collect()))
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
        // One wavelength is known; of others the map is kept.
        let spectrum = |lines: &str| {
            let text = text.replace("2\n350 50\n850 50\n", lines);
            anisotropic(text.as_bytes(), &Conventions::default()).unwrap().spectra
        };
        assert_eq!(spectrum("2\n350 50\n850 50\n"), None);
        assert_eq!(spectrum("1\n905 50\n").unwrap().text(), "905 nm");
        let found = spectrum("3\n450 20\n550 40\n650 60\n").unwrap();
        assert!(!found.is_grey && found.errors.error < 1e-3, "{:?}", found.errors);
        // Two angles of the sample: tables that differ are turned, a whole turn and equal tables are one.
        let both = |angles: &str, second: &str| {
            head("Anisotropic BSDF surface file v8.0")
                + &format!("0 1 0\n1 0\n1\n2\n{angles}\n1\n20\n1\n20\n20 0\n\n2\n350 50\n850 50\n")
                + &grid(7.0)
                + second
        };
        let parse = |text: &str| anisotropic(text.as_bytes(), &Conventions::default());
        let other = grid(7.0).replace("30\t7", "30\t9");
        let turned = parse(&both("0 90", &other)).unwrap().rows;
        assert_eq!(turned.len(), 14);
        for (a, b) in turned[..7].iter().zip(&turned[7..]) {
            assert!((a.wi[0] - b.wi[1]).abs() < 1e-12 && (a.wi[1] + b.wi[0]).abs() < 1e-12, "{a:?} {b:?}");
        }
        assert_eq!(parse(&both("0 90", &grid(7.0))).unwrap().rows.len(), 7);
        assert_eq!(parse(&both("0 360", &other)).unwrap().rows.len(), 7);
        let behind =
            text.replace("\n60\t", "\n160\t").replace("\n30\t", "\n130\t").replace("\n0\t7", "\n100\t7");
        assert!(parse(&behind).unwrap_err().to_string().contains("reflection is due"));
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
    fn the_azimuth_of_a_whole_turn_is_the_first_again() {
        let of = |last: &str| {
            let text = head("brdf surface file v9.0")
                + "1 0\n1\n1 1\n30\n550\n50\n"
                + &grid(1.0).replace("180", last);
            spectral(text.as_bytes(), &Conventions::default()).unwrap().rows.len()
        };
        // The normal is one sample, and those of theta 90 are left out.
        assert_eq!([of("180"), of("360")], [1 + 2 * 3, 1 + 2 * 2]);
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
