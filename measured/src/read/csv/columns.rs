//! Which columns hold the two directions and the value.

use super::super::spectrum::rgb_of_xyz;
use super::super::wavelengths::Wavelengths;
use super::names::{Beside, Role, Side, Unit, beside, role, unit};
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
    /// Angles from the normal, or their cosines, and azimuths.
    Angles { thetas: [Place; 2], are_cosines: [bool; 2], azimuths: Azimuths },
    /// Angle of the half vector from the normal, angle of a direction from it, and azimuth about it.
    Half([usize; 3]),
}

/// How azimuths are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Azimuths {
    Both([Place; 2]),
    /// Of the outgoing direction, or the difference of both: the incident one is at 0.
    Outgoing(Place),
    /// Of the incident direction alone.
    Incident(Place),
    /// The angle between both directions tells it, but for its sign.
    Phase(Place),
    /// None: all is in the plane of incidence, and angles have a sign.
    InPlane,
}

/// How values are written; places of the columns.
#[derive(Debug)]
pub(super) enum Values {
    Rgb([usize; 3]),
    Xyz([usize; 3]),
    One(usize),
    /// The mean of several.
    Mean(Vec<usize>),
    Spectrum(Vec<usize>, Wavelengths),
    /// A row for each wavelength: places of wavelength and value.
    Long([usize; 2]),
}

/// The columns of a file.
#[derive(Debug)]
pub(super) struct Columns {
    pub names: Vec<String>,
    pub directions: Directions,
    /// The angle by which the sample is turned, and whether its name has a unit of its own.
    pub turn: Option<(usize, Option<Unit>)>,
    pub values: Values,
    /// Units that the names of angles and values carry.
    pub angle_unit: Option<Unit>,
    pub value_unit: Option<Unit>,
    /// What values are, where they are not f, and the name that says it.
    pub beside: Option<(Beside, String)>,
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
    /// Whether one is that of a value, or three are of wavelengths.
    pub has_values: bool,
    pub reason: String,
}

/// Numbers that stand above all rows, by their kind.
pub(super) type Constants = Vec<(Role, f64)>;

impl Columns {
    /// From the names, and from what stands above them.
    pub fn find(names: &[String], constants: &Constants) -> Result<Self, NoColumns> {
        let mut roles: Vec<Role> = names.iter().map(|name| role(name)).collect();
        settle(names, &mut roles);
        let is_known = |r: &&Role| r.words().is_some() && !matches!(r, Role::At(_) | Role::Value);
        let known = roles.iter().filter(is_known).count();
        // A row of numbers has none of these.
        let is_line = |(role, name): (&Role, &String)| {
            matches!(role, Role::At(_)) && name.trim().parse::<f64>().is_err()
        };
        let lines = roles.iter().zip(names).filter(|both| is_line(*both)).count();
        let has_values = lines >= SERIES || roles.contains(&Role::Value);
        let fail =
            |reason: String| Err(NoColumns { known, has_values, reason: with_names(reason, names, &roles) });
        let is_named = |n: usize| !names[n].trim().is_empty();
        if let Some(odd) = roles.iter().position(|r| *r == Role::NoWavelength) {
            return fail(format!("column `{}` is named by no wavelength", shortened(&names[odd])));
        }
        let sides = Sides { names, roles: &roles, constants };
        let mut notes = Vec::new();
        let directions = match sides.directions(&mut notes) {
            Ok(directions) => directions,
            Err(missing) => return fail(missing),
        };
        let mut seen = HashSet::new();
        let is_twice =
            |n: &usize| roles[*n].words().is_some() && !seen.insert(names[*n].trim().to_lowercase());
        if let Some(twice) = (0..names.len()).find(is_twice) {
            return fail(format!("column `{}` stands there twice", shortened(&names[twice])));
        }
        let values = match values(names, &roles, &mut notes) {
            Ok(values) => values,
            Err(missing) => return fail(missing),
        };
        let turn = roles.iter().position(|r| *r == Role::Turn);
        let mut is_value = vec![false; names.len()];
        values.places().into_iter().for_each(|n| is_value[n] = true);
        let ignored: Vec<String> = (0..names.len())
            .filter(|&n| !directions.has(n) && turn != Some(n) && !is_value[n] && is_named(n))
            .map(|n| names[n].trim().to_owned())
            .collect();
        let unit_of =
            |of: &dyn Fn(usize) -> bool| (0..names.len()).filter(|&n| of(n)).find_map(|n| unit(&names[n]));
        let angle_unit = unit_of(&|n| directions.has(n));
        let value_unit = unit_of(&|n| is_value[n]);
        let beside = (0..names.len())
            .filter(|&n| is_value[n])
            .find_map(|n| Some((beside(&names[n])?, shortened(names[n].trim()))));
        let turn = turn.map(|n| (n, unit(&names[n]).filter(|unit| *unit != Unit::Percent)));
        let names = names.iter().map(|name| name.trim().to_owned()).collect();
        Ok(Self { names, directions, turn, values, angle_unit, value_unit, beside, ignored, notes })
    }
}

/// A reason, and the known meaning of the names.
fn with_names(reason: String, names: &[String], roles: &[Role]) -> String {
    let short = |name: &String| name.trim().chars().take(LONGEST).collect::<String>();
    let (mut known, mut unknown) = (Vec::new(), Vec::new());
    for (name, role) in names.iter().zip(roles).filter(|(name, _)| !name.trim().is_empty()) {
        match role.words() {
            Some(words) => known.push(format!("`{}` {words}", short(name))),
            None => unknown.push(format!("`{}`", short(name))),
        }
    }
    let list = |words: &[String]| {
        let more = if words.len() > NAMED { ", ..." } else { "" };
        words[..words.len().min(NAMED)].join(", ") + more
    };
    let parts = [("known: ", &known), ("not known: ", &unknown)];
    let parts: Vec<String> = parts
        .iter()
        .filter(|part| !part.1.is_empty())
        .map(|(what, names)| what.to_string() + &list(names))
        .collect();
    if known.is_empty() { reason } else { format!("{reason} ({})", parts.join("; ")) }
}

/// Gives roles that one name alone does not have: of a series, of half and difference angles, of zenith and azimuth by one letter.
fn settle(names: &[String], roles: &mut [Role]) {
    for side in [Side::Incident, Side::Outgoing] {
        let has = |roles: &[Role], role: Role| roles.contains(&role);
        let is_vector = has(roles, Role::Vector(side, 0)) || has(roles, Role::Vector(side, 1));
        if is_vector || !has(roles, Role::Phi(side)) {
            continue;
        }
        // `src_z`, `src_a`; but `wi_z` is a cosine.
        for (name, role) in names.iter().zip(roles.iter_mut()) {
            if *role == Role::Vector(side, 2) && !name.trim().to_lowercase().starts_with(['w', 'o']) {
                *role = Role::Theta(side);
            }
        }
    }
    if roles.contains(&Role::ThetaHalf) {
        for (name, role) in names.iter().zip(roles.iter_mut()) {
            match name.to_lowercase().replace(|c: char| !c.is_alphanumeric(), "").as_str() {
                n if n.starts_with("thetad") => *role = Role::ThetaDifference,
                n if n.starts_with("phid") => *role = Role::PhiDifference,
                _ => {}
            }
        }
    }
    let number = |role: &Role| match role {
        Role::At(w) | Role::Numbered(w) => Some(*w),
        _ => None,
    };
    let series: Vec<f64> = roles.iter().filter_map(number).collect();
    let is_steady = series.windows(2).all(|w| w[1] > w[0]) || series.windows(2).all(|w| w[1] < w[0]);
    // Whole numbers below 100 count something else.
    let is_fine = series.iter().any(|w| *w >= 100.0 || (w.fract() != 0.0 && *w > 0.1 && *w < 20.0));
    let is_series = series.len() >= SERIES && is_steady && is_fine && !roles.contains(&Role::Wavelength);
    for role in roles.iter_mut() {
        if let (Role::Numbered(w), true) = (&*role, is_series) {
            *role = Role::At(*w);
        }
    }
}

/// Names that are listed in a message, their characters, and numbers that make a series.
const NAMED: usize = 6;
const LONGEST: usize = 16;
const SERIES: usize = 3;

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
        let column = |role: Role| self.roles.iter().position(|r| *r == role);
        if let Some(half) = column(Role::ThetaHalf) {
            let difference = [Role::ThetaDifference, Role::PhiDifference].map(column);
            return match difference {
                [Some(theta), Some(phi)] => Ok(Directions::Half([half, theta, phi])),
                _ => {
                    Err("half and difference angles are theta_h, theta_d and phi_d: three columns are needed"
                        .into())
                }
            };
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
        let are_cosines = [Side::Incident, Side::Outgoing].map(|side| {
            let missing = if side == Side::Incident { &mut i } else { &mut o };
            let cosine = self.place(&Role::Cosine(side)).filter(|_| missing.is_none());
            *missing = missing.or(cosine);
            cosine.is_some()
        });
        let is_missing = i.is_none() || o.is_none();
        if is_missing && self.roles.contains(&Role::Elevation) {
            return Err("an elevation is counted from the horizon, or from the normal: give angles from the normal, such as theta_i or \
                        light zenith"
                .into());
        }
        let is_of_mirror = |n: &usize| {
            let lower = self.names[*n].to_lowercase();
            let mut words = lower.split(|c: char| !c.is_alphanumeric());
            self.roles[*n] == Role::Other && words.any(|word| matches!(word, "spec" | "specular" | "mirror"))
        };
        if is_missing && let Some(n) = (0..self.names.len()).find(is_of_mirror) {
            return Err(format!(
                "`{}` is counted from the mirror direction, it seems: give angles from the normal",
                shortened(&self.names[n])
            ));
        }
        let i = i.ok_or_else(|| missing("incident", "such as theta_i, AOI or light zenith"))?;
        let o = o.ok_or_else(|| missing("outgoing", example))?;
        let phis = [Side::Incident, Side::Outgoing].map(|side| self.of(side, Role::Phi));
        let azimuths = match (phis, self.place(&Role::DeltaPhi)) {
            ([Some(i), Some(o)], _) => Azimuths::Both([i, o]),
            (_, Some(delta)) => Azimuths::Outgoing(delta),
            ([None, Some(o)], None) => Azimuths::Outgoing(o),
            ([Some(i), None], None) => Azimuths::Incident(i),
            ([None, None], None) => match self.place(&Role::Phase) {
                Some(phase) => Azimuths::Phase(phase),
                None => Azimuths::InPlane,
            },
        };
        if let (false, Some(odd)) = (matches!(azimuths, Azimuths::Both(_)), self.odd_azimuth()) {
            // To take it for 0 would turn every sample.
            return Err(format!(
                "column `{}` is an azimuth, of which direction is not known: name it phi_i, phi_o or delta_phi",
                shortened(&self.names[odd])
            ));
        }
        if matches!(azimuths, Azimuths::Outgoing(_) | Azimuths::Incident(_)) {
            notes.push(
                "there is one azimuth: it is taken as the difference between those of both directions".into(),
            );
        }
        if matches!(azimuths, Azimuths::Phase(_)) {
            notes.push("azimuths follow from the phase angle, which is between both directions".into());
        }
        if are_cosines.contains(&true) && azimuths == Azimuths::InPlane {
            return Err(
                "cosines do not tell the sides of the normal: an azimuth is needed, such as dphi".into()
            );
        }
        Ok(Directions::Angles { thetas: [i, o], are_cosines, azimuths })
    }
}

/// What holds the value.
fn values(names: &[String], roles: &[Role], notes: &mut Vec<String>) -> Result<Values, String> {
    let column = |wanted: Role| roles.iter().position(|r| *r == wanted);
    let three = |of: fn(usize) -> Role| Some([column(of(0))?, column(of(1))?, column(of(2))?]);
    if let Some(rgb) = three(Role::Rgb) {
        return Ok(Values::Rgb(rgb));
    }
    if let Some(xyz) = three(Role::Xyz) {
        return Ok(Values::Xyz(xyz));
    }
    let one = one_value(names, roles, notes)?.or(column(Role::Xyz(1)));
    let wavelength = column(Role::Wavelength);
    if let (Some(wavelength), Some(value)) = (wavelength, one) {
        return Ok(Values::Long([wavelength, value]));
    }
    let at = |(place, role): (usize, &Role)| match role {
        Role::At(wavelength) => Some((place, *wavelength)),
        _ => None,
    };
    let (places, numbers): (Vec<usize>, Vec<f64>) = roles.iter().enumerate().filter_map(at).unzip();
    match (places.first(), wavelength) {
        (Some(at), Some(wavelength)) => {
            return Err(format!(
                "`{}` is a column of wavelengths, and `{}` is named by one",
                shortened(&names[wavelength]),
                shortened(&names[*at])
            ));
        }
        (Some(_), None) => {
            let wavelengths = Wavelengths::new(&numbers).map_err(|error| error.to_string())?;
            return Ok(Values::Spectrum(places, wavelengths));
        }
        (None, _) => {}
    }
    if let Some(one) = one {
        return Ok(Values::One(one));
    }
    if let Some(mean) = mean_of(names, roles, notes) {
        return Ok(mean);
    }
    if let Some(log) = column(Role::Logarithm) {
        return Err(format!(
            "column `{}` holds logarithms or decibels: give the values themselves, in a column named value",
            shortened(&names[log])
        ));
    }
    let mut unknown =
        names.iter().zip(roles).filter(|(name, r)| **r == Role::Other && !name.trim().is_empty());
    // Of several, any may be it.
    let hint = match (unknown.next(), unknown.next()) {
        (Some((name, _)), None) => format!("; if `{}` is the value, name it so", shortened(name)),
        _ => String::new(),
    };
    Err(format!("no column is the value: r,g,b, or X,Y,Z, or value, or wavelengths such as 400nm{hint}"))
}

/// Two polarisations, or several measurements of the value, whose mean it is.
fn mean_of(names: &[String], roles: &[Role], notes: &mut Vec<String>) -> Option<Values> {
    let of =
        |is: &dyn Fn(&Role) -> bool| -> Vec<usize> { (0..roles.len()).filter(|&n| is(&roles[n])).collect() };
    let listed = |places: &[usize]| {
        places.iter().map(|&n| format!("`{}`", shortened(names[n].trim()))).collect::<Vec<_>>().join(" and ")
    };
    let [s, p] = [0, 1].map(|which| of(&|role| *role == Role::Polarised(which)));
    let repeated = of(&|role| *role == Role::Repeated);
    let (places, text) = match (s.as_slice(), p.as_slice(), repeated.as_slice()) {
        ([s], [p], _) => {
            (vec![*s, *p], "are two polarisations: their mean is read, that of light that is not polarised")
        }
        ([one], [], _) | ([], [one], _) => {
            (vec![*one], "is one polarisation alone: it is taken as that of light that is not polarised")
        }
        ([], [], [_]) => (repeated, "is one measurement of the value: it is read"),
        ([], [], [_, ..]) => (repeated, "are measurements of one value: their mean is read"),
        _ => return None,
    };
    notes.push(format!("{} {text}", listed(&places)));
    Some(Values::Mean(places))
}

/// The column of one value. Of several, that of a name of the BRDF; the first of a matrix of Mueller.
fn one_value(names: &[String], roles: &[Role], notes: &mut Vec<String>) -> Result<Option<usize>, String> {
    let of =
        |is: &dyn Fn(&Role) -> bool| -> Vec<usize> { (0..roles.len()).filter(|&n| is(&roles[n])).collect() };
    let listed = |places: &[usize]| {
        places.iter().map(|&n| format!("`{}`", shortened(names[n].trim()))).collect::<Vec<_>>().join(" and ")
    };
    let plain = of(&|r| *r == Role::Value);
    if !plain.is_empty() {
        let is_brdf = |n: &&usize| {
            let name = names[**n].trim().to_lowercase();
            ["brdf", "bsdf", "value", "fr", "f_r", "f"].iter().any(|known| name.starts_with(known))
        };
        let found = plain.iter().find(is_brdf).unwrap_or(&plain[0]);
        if plain.len() > 1 {
            notes.push(format!("{} may each be the value; {} is read", listed(&plain), listed(&[*found])));
        }
        return Ok(Some(*found));
    }
    if roles.iter().any(|r| matches!(r, Role::At(_))) {
        return Ok(None);
    }
    let is_value = |n: &usize| names[*n].trim().chars().next().is_some_and(char::is_alphabetic);
    let numbered: Vec<usize> = of(&|r| matches!(r, Role::Numbered(_))).into_iter().filter(is_value).collect();
    let first = numbered.iter().copied().find(|&n| roles[n] == Role::Numbered(11.0));
    let found = match numbered.as_slice() {
        [] => return Ok(None),
        [one] => *one,
        many => first.ok_or_else(|| format!("{} may each be the value: name one value", listed(many)))?,
    };
    notes.push(format!("{} is taken as the value", listed(&[found])));
    Ok(Some(found))
}

impl Directions {
    /// Changes an angle that stands above the rows; false where there is none of that role.
    pub fn set(&mut self, role: &Role, angle: f64) -> bool {
        let Self::Angles { thetas, azimuths, .. } = self else { return false };
        let places: &mut [Place] = match (role, azimuths) {
            (Role::Theta(Side::Incident), _) => &mut thetas[..1],
            (Role::Theta(Side::Outgoing), _) => &mut thetas[1..],
            (Role::Theta(Side::Either) | Role::ThetaAlone, _) => thetas,
            (Role::Phi(Side::Incident), Azimuths::Both(phis)) => &mut phis[..1],
            (Role::Phi(Side::Outgoing), Azimuths::Both(phis)) => &mut phis[1..],
            (Role::Phi(_) | Role::DeltaPhi, Azimuths::Outgoing(phi) | Azimuths::Incident(phi)) => {
                std::slice::from_mut(phi)
            }
            _ => return false,
        };
        let Some(place) = places.iter_mut().find(|place| matches!(place, Place::Constant(_))) else {
            return false;
        };
        *place = Place::Constant(angle);
        true
    }

    /// The angles from the normal that stand above the rows.
    pub fn constants(&self) -> Vec<f64> {
        let Self::Angles { thetas, .. } = self else { return Vec::new() };
        let angle = |place: &Place| match place {
            Place::Constant(angle) => Some(*angle),
            Place::Column(_) => None,
        };
        thetas.iter().filter_map(angle).collect()
    }

    fn has(&self, n: usize) -> bool {
        let is = |place: &Place| *place == Place::Column(n);
        match self {
            Self::Vectors(places) => places.as_flattened().contains(&n),
            Self::Half(places) => places.contains(&n),
            Self::Angles { thetas, azimuths, .. } => {
                thetas.iter().any(is)
                    || match azimuths {
                        Azimuths::Both(places) => places.iter().any(is),
                        Azimuths::Outgoing(place) | Azimuths::Incident(place) | Azimuths::Phase(place) => {
                            is(place)
                        }
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
            Self::Mean(places) | Self::Spectrum(places, _) => places.clone(),
            Self::Long(places) => places.to_vec(),
        }
    }

    /// Linear sRGB of the numbers of a row; of a row of one wavelength grey.
    pub fn rgb(&self, numbers: &[f64]) -> [f64; 3] {
        match self {
            Self::Rgb(_) => [numbers[0], numbers[1], numbers[2]],
            Self::Xyz(_) => rgb_of_xyz([numbers[0], numbers[1], numbers[2]]),
            Self::One(_) => [numbers[0]; 3],
            Self::Mean(places) => [numbers.iter().sum::<f64>() / places.len() as f64; 3],
            Self::Spectrum(_, wavelengths) => wavelengths.rgb(numbers),
            Self::Long(_) => [numbers[1]; 3],
        }
    }
}

/// An error with the line of the names.
pub(super) fn fault(line: usize, reason: &str) -> ReadError {
    ReadError::Content(format!("line {line} names the columns: {reason}"))
}
