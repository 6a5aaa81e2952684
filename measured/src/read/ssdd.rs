//! Reader of SSDD files (surface scattering distribution data, of libbsdf): the BRDF block of a text.
//!
//! Keys name the lists of angles, in degrees; then there is a line for each pair of directions, the first parameter fastest.

use super::alta::from_half;
use super::conventions::Conventions;
use super::intake::{Intake, Reading};
use super::reason::Reason;
use super::scatter_tables::about_mirror;
use super::spectrum::rgb_of_xyz;
use super::wavelengths::Wavelengths;
use crate::ReadError;
use crate::file::decode::{decode, shortened};
use crate::file::rows::numbers;
use crate::row::turned_back;
use crate::table::direction;
use std::f64::consts::PI;

/// How directions are written.
#[derive(Clone, Copy, PartialEq)]
enum Parameters {
    Spherical,
    Specular,
    Half,
}

/// One block.
#[derive(Default)]
struct SsddBlock {
    colour: String,
    wavelengths: Vec<f64>,
    parameters: Option<Parameters>,
    lists: [Vec<f64>; 4],
}

fn fail<T>(text: impl Into<String>) -> Result<T, ReadError> {
    Err(ReadError::Content(text.into()))
}

/// Parses the bytes of a file.
///
/// # Errors
/// [`ReadError`], with the line of the fault, and for binary tables.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    if bytes.windows(11).any(|w| w == b"DATA binary") {
        return fail("SSDD with a binary table: only text is read; save it with DATA ascii");
    }
    let text = decode(bytes)?;
    let mut reading = Reading::new("SSDD", conventions);
    let mut lines =
        text.lines().enumerate().map(|(n, line)| (n + 1, line.split("# ").next().unwrap_or("").trim()));
    let mut block = SsddBlock::default();
    let mut kind = String::new();
    let mut found = false;
    while let Some((n, line)) = lines.next() {
        let (key, value) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let value = value.trim();
        let list = || -> Result<Vec<f64>, ReadError> {
            let mut list = vec![0.0; value.split_whitespace().count()];
            numbers(n, value, &mut list)?;
            Ok(list)
        };
        match key {
            "DATA_TYPE" => (kind, block) = (value.to_owned(), SsddBlock::default()),
            "COLOR_MODEL" => block.colour = value.to_owned(),
            "WAVELENGTH_LIST" => block.wavelengths = list()?,
            "PARAM_TYPE" => {
                block.parameters = Some(match value {
                    "spherical_coordinate_system" => Parameters::Spherical,
                    "specular_coordinate_system" => Parameters::Specular,
                    "half_difference_coordinate_system" => Parameters::Half,
                    other => {
                        return fail(format!("line {n}: PARAM_TYPE `{}` is not known", shortened(other)));
                    }
                });
            }
            "PARAM0_LIST" => block.lists[0] = list()?,
            "PARAM1_LIST" => block.lists[1] = list()?,
            "PARAM2_LIST" => block.lists[2] = list()?,
            "PARAM3_LIST" => block.lists[3] = list()?,
            "DATA" => {
                let rows = block.rows()?;
                if kind == "brdf" {
                    found = true;
                    block.read(&mut lines, &mut reading)?;
                } else {
                    for _ in 0..rows {
                        let line = lines.by_ref().find(|(_, line)| !line.is_empty()).map_or(n, |line| line.0);
                        match kind.as_str() {
                            "btdf" | "specular_transmittance" => {
                                reading.leave_out(Reason::Transmission, line)
                            }
                            _ => {}
                        }
                    }
                    if kind == "specular_reflectance" {
                        reading.note(
                            "a reflectance of the mirror direction alone, without a width, is not read",
                        );
                    }
                }
            }
            _ => {}
        }
    }
    if found { reading.finish() } else { fail("SSDD without a block DATA_TYPE brdf") }
}

impl SsddBlock {
    /// How many lines its table has.
    fn rows(&self) -> Result<usize, ReadError> {
        let count = self.lists.iter().fold(1usize, |n, list| n.saturating_mul(list.len().max(1)));
        if count > 10_000_000 { fail(format!("SSDD table of {count} lines")) } else { Ok(count) }
    }

    fn read<'a>(
        &self,
        lines: &mut impl Iterator<Item = (usize, &'a str)>,
        reading: &mut Reading,
    ) -> Result<(), ReadError> {
        let Some(parameters) = self.parameters else { return fail("SSDD of a BRDF without PARAM_TYPE") };
        let spectrum = match self.colour.as_str() {
            "spectrum" => Some(reading.wavelengths_are(Wavelengths::new(&self.wavelengths)?, 1.0)?),
            "monochrome" | "rgb" | "xyz" => None,
            other => return fail(format!("SSDD of COLOR_MODEL `{}`", shortened(other))),
        };
        let channels = match self.colour.as_str() {
            "spectrum" => self.wavelengths.len(),
            "monochrome" => 1,
            _ => 3,
        };
        if self.lists[1].len() > 1 {
            let planes = self.lists[1].len();
            reading.note(format!("{planes} azimuths of incidence: outgoing azimuths are taken as counted from that of incidence"));
        }
        let mut cells = vec![0.0; channels];
        let mut filled = lines.filter(|(_, line)| !line.is_empty());
        for at in 0..self.rows()? {
            let Some((n, line)) = filled.next() else {
                return fail(format!(
                    "SSDD ends after {at} lines of its table; {} are expected",
                    self.rows()?
                ));
            };
            numbers(n, line, &mut cells)?;
            let sizes = self.lists.each_ref().map(|list| list.len().max(1));
            let index =
                [at % sizes[0], at / sizes[0] / sizes[1] % sizes[2], at / sizes[0] / sizes[1] / sizes[2]];
            let of_plane = at / sizes[0] % sizes[1];
            let of =
                |list: usize, index: usize| self.lists[list].get(index).copied().unwrap_or(0.0).to_radians();
            let (a, b, c) = (of(0, index[0]), of(2, index[1]), of(3, index[2]));
            let pair = match parameters {
                Parameters::Spherical => [direction(a, 0.0), direction(b, c)],
                Parameters::Specular => [direction(a, PI), about_mirror(a, b.to_degrees(), c.to_degrees())],
                Parameters::Half => from_half(a, b, c),
            };
            // The azimuth of incidence turns both directions, which are counted from its plane.
            let plane = if sizes[1] > 1 { of(1, of_plane) } else { 0.0 };
            let pair = if plane == 0.0 { pair } else { pair.map(|d| turned_back(d, -plane)) };
            let rgb = match (&spectrum, self.colour.as_str()) {
                (Some(spectrum), _) => spectrum.rgb(&cells),
                (None, "xyz") => rgb_of_xyz([cells[0], cells[1], cells[2]]),
                (None, "rgb") => [cells[0], cells[1], cells[2]],
                _ => [cells[0]; 3],
            };
            // A grid has cells behind the surface, which are no transmission.
            if pair.iter().all(|d| d[2] > 0.0) {
                reading.push(n, pair, rgb, &cells);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_parameter_is_fastest_and_other_blocks_are_passed_over() {
        let text = "VERSION 0.2\n\nDATA_TYPE btdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\nPARAM0_LIST 0\n\
                    PARAM2_LIST 0\nPARAM3_LIST 0\nDATA ascii\n0.1\n\nDATA_TYPE brdf\nCOLOR_MODEL rgb\nPARAM_TYPE specular_coordinate_system\n\
                    PARAM0_LIST 20 60\nPARAM2_LIST 0 40\nPARAM3_LIST 0 180\nDATA ascii\n# PARAM3: 0\n1 2 3\n4 5 6\n7 8 9\n1 1 1\n\
                    2 2 2\n3 3 3\n4 4 4\n5 5 5\n";
        let intake = parse(text.as_bytes(), &Conventions::default()).unwrap();
        assert_eq!((intake.rows.len(), intake.left_out_count()), (7, 1));
        let first = intake.rows[0];
        assert!((first.wo[0] + first.wi[0]).abs() < 1e-12 && first.rgb == [1.0, 2.0, 3.0], "{first:?}");
        assert!((intake.rows[1].wi[2] - 0.5).abs() < 1e-12 && intake.rows[1].rgb[0] == 4.0);
        for (from, to, word) in [
            ("PARAM3_LIST 0 180", "PARAM3_LIST 0 x", "x"),
            ("5 5 5\n", "", "ends after 7"),
            ("brdf", "brtf", "brdf"),
        ] {
            let error = parse(text.replacen(from, to, 1).as_bytes(), &Conventions::default())
                .unwrap_err()
                .to_string();
            assert!(error.contains(word), "{to}: {error}");
        }
    }
}
