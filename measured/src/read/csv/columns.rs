//! Which columns hold the two directions and the value.

use super::super::wavelengths::{Wavelengths, rgb_of_xyz};
use super::names::{Role, Side, Unit, role, unit};
use crate::ReadError;
use crate::file::decode::shortened;
use std::collections::HashSet;

/// Where a number stands: in a column, or once above all rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    Column(usize),
    Constant(f64),
}

/// How directions are written.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Directions {
    /// Unit vectors, incident and outgoing.
    Vectors([[usize; 3]; 2]),
    /// Angles from the normal and azimuths.
    Angles { thetas: [Place; 2], azimuths: Azimuths },
}

/// How azimuths are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Azimuths {
    Both([Place; 2]),
    /// Of the outgoing direction, or the difference of both: the incident one is at 0.
    Outgoing(Place),
    /// Of the incident direction alone.
    Incident(Place),
    /// None: all is in the plane of incidence, and angles have a sign.
    InPlane,
}

/// How values are written; places of the columns.
#[derive(Debug)]
pub(super) enum Values {
    Rgb([usize; 3]),
    Xyz([usize; 3]),
    One(usize),
    Spectrum(Vec<usize>, Wavelengths),
    /// A row for each wavelength: places of wavelength and value.
    Long([usize; 2]),
}

/// The columns of a file.
#[derive(Debug)]
pub(super) struct Columns {
    pub names: Vec<String>,
    pub directions: Directions,
    pub values: Values,
    /// Units that the names of angles and values carry.
    pub angle_unit: Option<Unit>,
    pub value_unit: Option<Unit>,
    /// Names of columns that are not read.
    pub ignored: Vec<String>,
    /// Assumptions.
    pub notes: Vec<String>,
}

/// Why a line does not name the columns.
#[derive(Debug)]
pub(super) struct NoColumns {
    /// How many of its names are known.
    pub known: usize,
    pub reason: String,
}

/// Numbers that stand above all rows, by their kind.
pub(super) type Constants = Vec<(Role, f64)>;

impl Columns {
    /// From the names, and from what stands above them.
    pub fn find(names: &[String], constants: &Constants) -> Result<Self, NoColumns> {
        let roles: Vec<Role> = names.iter().map(|name| role(name)).collect();
        let known = roles
            .iter()
            .filter(|r| !matches!(r, Role::Other | Role::At(_) | Role::NoWavelength | Role::Value))
            .count();
        let fail = |reason: String| Err(NoColumns { known, reason });
        let is_named = |n: usize| !names[n].trim().is_empty();
        let mut seen = HashSet::new();
        if let Some(twice) =
            (0..names.len()).find(|&n| is_named(n) && !seen.insert(names[n].trim().to_lowercase()))
        {
            return fail(format!("column `{}` stands there twice", shortened(&names[twice])));
        }
        if let Some(odd) = roles.iter().position(|r| *r == Role::NoWavelength) {
            return fail(format!("column `{}` is named by no wavelength", shortened(&names[odd])));
        }
        let sides = Sides { names, roles: &roles, constants };
        let mut notes = Vec::new();
        let directions = match sides.directions(&mut notes) {
            Ok(directions) => directions,
            Err(missing) => return fail(missing),
        };
        let values = match values(names, &roles) {
            Ok(values) => values,
            Err(missing) => return fail(missing),
        };
        let mut is_value = vec![false; names.len()];
        values.places().into_iter().for_each(|n| is_value[n] = true);
        let ignored: Vec<String> = (0..names.len())
            .filter(|&n| !directions.has(n) && !is_value[n] && is_named(n))
            .map(|n| names[n].trim().to_owned())
            .collect();
        let unit_of =
            |of: &dyn Fn(usize) -> bool| (0..names.len()).filter(|&n| of(n)).find_map(|n| unit(&names[n]));
        let angle_unit = unit_of(&|n| directions.has(n));
        let value_unit = unit_of(&|n| is_value[n]);
        let names = names.iter().map(|name| name.trim().to_owned()).collect();
        Ok(Self { names, directions, values, angle_unit, value_unit, ignored, notes })
    }
}

/// The columns and constants by their kind.
struct Sides<'a> {
    names: &'a [String],
    roles: &'a [Role],
    constants: &'a Constants,
}

impl Sides<'_> {
    fn place(&self, wanted: &Role) -> Option<Place> {
        let column = self.roles.iter().position(|r| r == wanted).map(Place::Column);
        let constant = self.constants.iter().find(|(role, _)| role == wanted);
        column.or(constant.map(|(_, value)| Place::Constant(*value)))
    }

    /// Of a direction, by a role that names its side; `s` is whichever side has no other name.
    fn of(&self, side: Side, role: fn(Side) -> Role) -> Option<Place> {
        let other = if side == Side::Incident { Side::Outgoing } else { Side::Incident };
        self.place(&role(side)).or_else(|| {
            let either = self.place(&role(Side::Either))?;
            self.place(&role(other)).map(|_| either)
        })
    }

    /// The column of an azimuth whose direction has no known name.
    fn odd_azimuth(&self) -> Option<usize> {
        self.roles.iter().position(|role| *role == Role::OddPhi)
    }

    fn vector(&self, side: Side) -> Option<[usize; 3]> {
        let column = |axis: usize| self.roles.iter().position(|r| *r == Role::Vector(side, axis));
        Some([column(0)?, column(1)?, column(2)?])
    }

    fn directions(&self, notes: &mut Vec<String>) -> Result<Directions, String> {
        if let (Some(i), Some(o)) = (self.vector(Side::Incident), self.vector(Side::Outgoing)) {
            return Ok(Directions::Vectors([i, o]));
        }
        if self.roles.contains(&Role::Half) {
            return Err("half and difference angles are not read; give the angles of both directions".into());
        }
        let [mut i, mut o] = [Side::Incident, Side::Outgoing].map(|side| self.of(side, Role::Theta));
        if i.is_some() != o.is_some() {
            let missing = if i.is_some() { &mut o } else { &mut i };
            *missing = self.place(&Role::ThetaAlone);
        }
        let example = "such as theta_o, theta_r or view zenith";
        let missing = |which: &str, example: &str| {
            format!("no column is the angle of the {which} direction, {example}")
        };
        if (i.is_none() || o.is_none()) && self.roles.contains(&Role::Cosine) {
            return Err("cosines of angles are not read; give the angles of both directions".into());
        }
        let i = i.ok_or_else(|| missing("incident", "such as theta_i, AOI or light zenith"))?;
        let o = o.ok_or_else(|| missing("outgoing", example))?;
        let phis = [Side::Incident, Side::Outgoing].map(|side| self.of(side, Role::Phi));
        let azimuths = match (phis, self.place(&Role::DeltaPhi)) {
            ([Some(i), Some(o)], _) => Azimuths::Both([i, o]),
            (_, Some(delta)) => Azimuths::Outgoing(delta),
            ([None, Some(o)], None) => Azimuths::Outgoing(o),
            ([Some(i), None], None) => Azimuths::Incident(i),
            ([None, None], None) => Azimuths::InPlane,
        };
        if let (false, Some(odd)) = (matches!(azimuths, Azimuths::Both(_)), self.odd_azimuth()) {
            // To take it for 0 would turn every sample.
            return Err(format!(
                "column `{}` is an azimuth, of which direction is not known: name it phi_i, phi_o or delta_phi",
                shortened(&self.names[odd])
            ));
        }
        if matches!(azimuths, Azimuths::Outgoing(_) | Azimuths::Incident(_)) {
            notes.push("there is one azimuth; that of the other direction is taken as 0".into());
        }
        for place in [i, o] {
            if let Place::Constant(angle) = place {
                notes.push(format!("one direction is the same in all rows: {angle}, from above the columns"));
            }
        }
        Ok(Directions::Angles { thetas: [i, o], azimuths })
    }
}

/// What holds the value.
fn values(names: &[String], roles: &[Role]) -> Result<Values, String> {
    let column = |wanted: Role| roles.iter().position(|r| *r == wanted);
    let three = |of: fn(usize) -> Role| Some([column(of(0))?, column(of(1))?, column(of(2))?]);
    if let Some(rgb) = three(Role::Rgb) {
        return Ok(Values::Rgb(rgb));
    }
    if let Some(xyz) = three(Role::Xyz) {
        return Ok(Values::Xyz(xyz));
    }
    let at = |(place, role): (usize, &Role)| match role {
        Role::At(wavelength) => Some((place, *wavelength)),
        _ => None,
    };
    let (places, numbers): (Vec<usize>, Vec<f64>) = roles.iter().enumerate().filter_map(at).unzip();
    if !places.is_empty() {
        let wavelengths = Wavelengths::new(&numbers).map_err(|error| error.to_string())?;
        return Ok(Values::Spectrum(places, wavelengths));
    }
    let one = column(Role::Value).or(column(Role::Xyz(1)));
    match (one, column(Role::Wavelength)) {
        (Some(value), Some(wavelength)) => Ok(Values::Long([wavelength, value])),
        (Some(value), None) => Ok(Values::One(value)),
        (None, _) => {
            let unknown =
                names.iter().zip(roles).find(|(name, r)| **r == Role::Other && !name.trim().is_empty());
            let hint = unknown.map_or_else(String::new, |(name, _)| {
                format!("; if `{}` is the value, name it so", shortened(name))
            });
            Err(format!(
                "no column is the value: r,g,b, or X,Y,Z, or value, or wavelengths such as 400nm{hint}"
            ))
        }
    }
}

impl Directions {
    fn has(&self, n: usize) -> bool {
        let is = |place: &Place| *place == Place::Column(n);
        match self {
            Self::Vectors(places) => places.as_flattened().contains(&n),
            Self::Angles { thetas, azimuths } => {
                thetas.iter().any(is)
                    || match azimuths {
                        Azimuths::Both(places) => places.iter().any(is),
                        Azimuths::Outgoing(place) | Azimuths::Incident(place) => is(place),
                        Azimuths::InPlane => false,
                    }
            }
        }
    }
}

impl Values {
    /// The columns that hold the value, in the order in which [`rgb`](Self::rgb) takes their numbers.
    pub fn places(&self) -> Vec<usize> {
        match self {
            Self::Rgb(places) | Self::Xyz(places) => places.to_vec(),
            Self::One(one) => vec![*one],
            Self::Spectrum(places, _) => places.clone(),
            Self::Long(places) => places.to_vec(),
        }
    }

    /// Linear sRGB of the numbers of a row; of a row of one wavelength grey.
    pub fn rgb(&self, numbers: &[f64]) -> [f64; 3] {
        match self {
            Self::Rgb(_) => [numbers[0], numbers[1], numbers[2]],
            Self::Xyz(_) => rgb_of_xyz([numbers[0], numbers[1], numbers[2]]),
            Self::One(_) => [numbers[0]; 3],
            Self::Spectrum(_, wavelengths) => wavelengths.rgb(numbers),
            Self::Long(_) => [numbers[1]; 3],
        }
    }
}

/// An error with the line of the names.
pub(super) fn fault(line: usize, reason: &str) -> ReadError {
    ReadError::Content(format!("line {line} names the columns: {reason}"))
}
