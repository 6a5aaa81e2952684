//! What the columns of a `.csv` hold, by their names in its first line.

use super::super::spectrum::ToRgb;
use crate::ReadError;

/// Names of the columns of the incident and the outgoing direction, as unit vectors and as angles.
const VECTORS: [[&str; 3]; 2] = [["wi_x", "wi_y", "wi_z"], ["wo_x", "wo_y", "wo_z"]];
const ANGLES: [[&str; 2]; 2] = [["theta_i", "phi_i"], ["theta_o", "phi_o"]];

const RGB: [&str; 3] = ["r", "g", "b"];
const ONE: [&str; 2] = ["value", "y"];

/// What is expected, for errors.
const EXPECTED: &str = "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z (unit vectors) or theta_i,phi_i,theta_o,phi_o (degrees), and r,g,b, or value, or \
                        wavelengths in nm";

/// How directions are written; places of the columns of the incident and the outgoing one.
#[derive(Debug)]
enum Directions {
    Vectors([[usize; 3]; 2]),
    /// Angle from the normal and azimuth, degrees.
    Angles([[usize; 2]; 2]),
}

/// How values are written; places of the columns.
#[derive(Debug)]
enum Values {
    Rgb([usize; 3]),
    One(usize),
    Spectrum(Vec<usize>, ToRgb),
}

/// The columns of a file.
#[derive(Debug)]
pub(super) struct Columns {
    /// How many there are.
    pub count: usize,
    directions: Directions,
    values: Values,
}

impl Columns {
    /// From the first line.
    pub fn parse(line: &str) -> Result<Self, ReadError> {
        let names: Vec<String> = line.split(',').map(|name| name.trim().to_ascii_lowercase()).collect();
        let content =
            |text: String| Err(ReadError::Content(format!("the first line names the columns: {text}")));
        if let Some(twice) = (1..names.len()).find(|&i| names[..i].contains(&names[i])) {
            return content(format!("{:?} stands there twice", shortened(&names[twice])));
        }
        let (directions, values) = (directions(&names), values(&names)?);
        let (Some(directions), Some(values)) = (directions, values) else {
            return content(format!("expected are {EXPECTED}, found is {:?}", shortened(line)));
        };
        let is_known = |place: usize| directions.has(place) || values.has(place);
        if let Some(unknown) = (0..names.len()).find(|&place| !is_known(place)) {
            return content(format!("{:?} is none of {EXPECTED}", shortened(&names[unknown])));
        }
        Ok(Self { count: names.len(), directions, values })
    }

    /// Unit vectors towards the incident and the outgoing direction; the error says which is none above the horizon.
    pub fn directions(&self, row: &[f64]) -> Result<[[f64; 3]; 2], String> {
        let found = match &self.directions {
            Directions::Vectors(places) => places.map(|places| places.map(|place| row[place])),
            Directions::Angles(places) => {
                for [theta, _] in *places {
                    if !(0.0..=90.0).contains(&row[theta]) {
                        return Err(format!(
                            "{} is no angle from the normal above the horizon: 0 to 90 degrees",
                            row[theta]
                        ));
                    }
                }
                places.map(|[theta, phi]| from_angles(row[theta], row[phi]))
            }
        };
        for d in &found {
            let squared: f64 = d.iter().map(|x| x * x).sum();
            if (squared - 1.0).abs() > 1e-3 || d[2] < 0.0 {
                return Err(format!("{d:?} is not a unit vector above the horizon"));
            }
        }
        Ok(found)
    }

    /// Linear sRGB.
    pub fn rgb(&self, row: &[f64]) -> [f64; 3] {
        match &self.values {
            Values::Rgb(places) => places.map(|place| row[place]),
            Values::One(place) => [row[*place]; 3],
            Values::Spectrum(places, to_rgb) => {
                to_rgb.convert(&places.iter().map(|&place| row[place]).collect::<Vec<_>>())
            }
        }
    }
}

impl Directions {
    fn has(&self, place: usize) -> bool {
        match self {
            Self::Vectors(places) => places.as_flattened().contains(&place),
            Self::Angles(places) => places.as_flattened().contains(&place),
        }
    }
}

impl Values {
    fn has(&self, place: usize) -> bool {
        match self {
            Self::Rgb(places) => places.contains(&place),
            Self::One(one) => *one == place,
            Self::Spectrum(places, _) => places.contains(&place),
        }
    }
}

/// A unit vector from its angle from the normal and its azimuth, degrees.
fn from_angles(theta: f64, phi: f64) -> [f64; 3] {
    let ((st, ct), (sp, cp)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    // 90 degrees are the horizon, not what the rounded cosine makes of them.
    [st * cp, st * sp, ct.max(0.0)]
}

/// Places of names, if all are there.
fn places<const C: usize>(names: &[String], wanted: [&str; C]) -> Option<[usize; C]> {
    let found = wanted.map(|wanted| names.iter().position(|name| name == wanted));
    found.iter().all(Option::is_some).then(|| found.map(|place| place.unwrap_or_default()))
}

fn directions(names: &[String]) -> Option<Directions> {
    if let (Some(i), Some(o)) = (places(names, VECTORS[0]), places(names, VECTORS[1])) {
        return Some(Directions::Vectors([i, o]));
    }
    Some(Directions::Angles([places(names, ANGLES[0])?, places(names, ANGLES[1])?]))
}

fn values(names: &[String]) -> Result<Option<Values>, ReadError> {
    if let Some(rgb) = places(names, RGB) {
        return Ok(Some(Values::Rgb(rgb)));
    }
    if let Some(one) = names.iter().position(|name| ONE.contains(&name.as_str())) {
        return Ok(Some(Values::One(one)));
    }
    let wavelength = |name: &String| name.strip_suffix("nm").unwrap_or(name).trim().parse::<f64>().ok();
    let (places, wavelengths): (Vec<usize>, Vec<f64>) =
        names.iter().enumerate().filter_map(|(place, name)| Some((place, wavelength(name)?))).unzip();
    if wavelengths.is_empty() {
        return Ok(None);
    }
    Ok(Some(Values::Spectrum(places, ToRgb::new(&wavelengths)?)))
}

/// What an error shows of what a file holds.
fn shortened(text: &str) -> String {
    text.chars().take(60).collect()
}
