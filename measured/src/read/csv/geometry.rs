//! From the numbers of a row to two unit vectors.

use super::super::alta::from_half;
use super::super::conventions::{Angles, Conventions, Mirror};
use super::super::intake::Reading;
use super::columns::{Azimuths, Columns, Directions, Place};
use super::names::Unit;
use super::{Numbers, Unknown};
use crate::ReadError;
use std::f64::consts::{FRAC_PI_2, PI};

/// How far a squared length may be from 1.
const UNIT: f64 = 1e-3;

/// What rounding adds to the largest angles.
const ROUNDING: f64 = 1e-3;

/// What rounding makes of the cosine of a phase angle.
const PHASE: f64 = 0.02;

/// Largest azimuth that is believed, degrees.
const TURNS: f64 = 36000.0;

/// Number of samples of a plane that show the side of the mirror direction, and factor by which they are brighter.
const SHOWN: usize = 4;
const BRIGHTER: f64 = 1.5;

/// How the directions of a file are meant.
pub(super) struct Geometry {
    is_vectors: bool,
    /// Whether angles are of the half vector, and from it.
    is_half: bool,
    /// Radians of a unit of the file.
    radians: f64,
    azimuths: Option<Azimuths>,
    /// In a plane: the meaning of the azimuth of the outgoing direction.
    plane: f64,
}

/// Places of the numbers of a row: of vectors six; of angles both thetas and both azimuths.
pub(super) fn places(directions: &Directions) -> [Option<Place>; 6] {
    match directions {
        Directions::Vectors([i, o]) => [i[0], i[1], i[2], o[0], o[1], o[2]].map(|n| Some(Place::Column(n))),
        Directions::Half([half, theta, phi]) => {
            let column = |n: &usize| Some(Place::Column(*n));
            [column(half), column(theta), None, column(phi), None, None]
        }
        Directions::Angles { thetas: [i, o], azimuths } => {
            let [phi_i, phi_o] = match azimuths {
                Azimuths::Both([i, o]) => [Some(*i), Some(*o)],
                Azimuths::Outgoing(o) | Azimuths::Phase(o) => [None, Some(*o)],
                Azimuths::Incident(i) => [Some(*i), None],
                Azimuths::InPlane => [None, None],
            };
            [Some(*i), Some(*o), phi_i, phi_o, None, None]
        }
    }
}

/// The last column that a direction needs.
pub(super) fn last_column(directions: &Directions) -> usize {
    let column = |place: &Place| match place {
        Place::Column(n) => *n,
        Place::Constant(_) => 0,
    };
    places(directions).iter().flatten().map(column).max().unwrap_or(0)
}

impl Geometry {
    /// Finds out what angles mean.
    pub fn new(
        columns: &Columns,
        rows: &[Numbers],
        (said, unknown): (Option<Unit>, Unknown),
        conventions: &Conventions,
        reading: &mut Reading,
    ) -> Result<Self, ReadError> {
        let azimuths = match &columns.directions {
            Directions::Vectors(_) | Directions::Half(_) => None,
            Directions::Angles { azimuths, .. } => Some(*azimuths),
        };
        let (is_vectors, is_half) = match &columns.directions {
            Directions::Vectors(_) => (true, false),
            Directions::Half(_) => (false, true),
            Directions::Angles { .. } => (false, false),
        };
        let mut geometry = Self { is_vectors, is_half, radians: 1.0, azimuths, plane: PI };
        if geometry.is_vectors {
            return Ok(geometry);
        }
        let angles = match (conventions.angles, columns.angle_unit.or(said)) {
            (Some(angles), _) => angles,
            (None, Some(Unit::Degrees)) => Angles::Degrees,
            (None, Some(Unit::Radians)) => Angles::Radians,
            _ => found_angles(rows, unknown, reading)?,
        };
        geometry.radians = if angles == Angles::Degrees { PI / 180.0 } else { 1.0 };
        let signed = rows.iter().filter(|row| row.directions[..2].iter().any(|theta| *theta < 0.0)).count();
        if azimuths == Some(Azimuths::InPlane) {
            geometry.plane = plane(rows, geometry.radians, conventions.mirror, reading);
        } else if signed > 0 {
            reading.note(format!(
                "{signed} rows have an angle below 0: it is taken as one above 0 on the other side of the normal"
            ));
        }
        Ok(geometry)
    }

    /// Unit vectors towards the incident and the outgoing direction.
    pub fn directions(&self, row: &Numbers) -> Result<[[f64; 3]; 2], ReadError> {
        let d = row.directions;
        if self.is_vectors {
            let found = [[d[0], d[1], d[2]], [d[3], d[4], d[5]]];
            for v in &found {
                let squared: f64 = v.iter().map(|x| x * x).sum();
                if (squared - 1.0).abs() > UNIT {
                    return Err(ReadError::Content(format!("line {}: {v:?} is not a unit vector", row.line)));
                }
            }
            return Ok(found);
        }
        let [phi_i, phi_o] = match self.azimuths {
            Some(Azimuths::InPlane) => [0.0, self.plane / self.radians],
            _ => [d[2], d[3]],
        };
        for (name, angle, most) in
            [("theta", d[0], PI), ("theta", d[1], PI), ("phi", phi_i, TURNS), ("phi", phi_o, TURNS)]
        {
            let radians = angle * self.radians;
            if radians.abs() > most + ROUNDING {
                let text = format!(
                    "line {}: {name} {angle} is no angle: 180 degrees is the most from the normal",
                    row.line
                );
                return Err(ReadError::Content(text));
            }
        }
        if let Some(Azimuths::Phase(_)) = self.azimuths {
            let [i, o] = [d[0] * self.radians, d[1] * self.radians];
            let both = libm::sin(i) * libm::sin(o);
            let across = libm::cos(phi_o * self.radians) - libm::cos(i) * libm::cos(o);
            if across.abs() > both.abs() + PHASE {
                return Err(ReadError::Content(format!(
                    "line {}: no azimuth makes the phase angle {phi_o} of these two directions",
                    row.line
                )));
            }
            let turn = if both.abs() > PHASE { libm::acos((across / both).clamp(-1.0, 1.0)) } else { 0.0 };
            return Ok([self.vector(d[0], 0.0), self.vector(d[1], turn / self.radians)]);
        }
        if self.is_half {
            return Ok(from_half(d[0] * self.radians, d[1] * self.radians, phi_o * self.radians));
        }
        Ok([self.vector(d[0], phi_i), self.vector(d[1], phi_o)])
    }

    fn vector(&self, theta: f64, phi: f64) -> [f64; 3] {
        let (st, ct) = libm::sincos(theta * self.radians);
        let (sp, cp) = libm::sincos(phi * self.radians);
        [st * cp, st * sp, ct]
    }
}

/// The unit of angles, by the numbers alone.
fn found_angles(rows: &[Numbers], unknown: Unknown, reading: &mut Reading) -> Result<Angles, ReadError> {
    let most = |places: &[usize]| {
        rows.iter().flat_map(|row| places.iter().map(|&n| row.directions[n].abs())).fold(0.0, f64::max)
    };
    let (theta, phi) = (most(&[0, 1]), most(&[2, 3]));
    let may_be_radians = theta <= FRAC_PI_2 + ROUNDING && phi <= 2.0 * PI + ROUNDING;
    if unknown == Unknown::IsRadians {
        if may_be_radians || theta <= PI + ROUNDING {
            return Ok(Angles::Radians);
        }
        reading.note_option(format!("angles up to {theta} are taken as degrees"), "--angles");
        return Ok(Angles::Degrees);
    }
    if may_be_radians && theta > 0.0 {
        return Err(ReadError::Content(format!(
            "no angle from the normal is above {theta:.4}: are they radians? Say it by --angles radians (or degrees), or in the names: \
             theta_i [rad]"
        )));
    }
    Ok(Angles::Degrees)
}

/// Of samples in a plane: the azimuth of an outgoing direction with an angle above 0, the incident one being at 0.
fn plane(rows: &[Numbers], radians: f64, mirror: Option<Mirror>, reading: &mut Reading) -> f64 {
    // The azimuth at which equal angles are a mirror pair. `Reading` turns it where the caller says that mirrors have equal azimuths.
    if mirror.is_some() {
        return 0.0;
    }
    let near = |sign: f64| {
        let close = |row: &&Numbers| {
            let [i, o] = [row.directions[0], row.directions[1]].map(|theta| theta * radians);
            i.abs() > 0.1 && (o - sign * i).abs() < 0.06
        };
        let mut found: Vec<f64> = rows
            .iter()
            .filter(close)
            .map(|row| row.values.iter().sum::<f64>() / row.values.len() as f64)
            .collect();
        found.sort_by(f64::total_cmp);
        (found.len() >= SHOWN).then(|| found[found.len() * 3 / 4])
    };
    let sides = if let (Some(equal), Some(opposite)) = (near(1.0), near(-1.0)) {
        opposite > BRIGHTER * equal
    } else {
        false
    };
    if sides {
        reading.note_option(
            "there is no azimuth: all is in the plane of incidence, and as the brightest samples show, angles of opposite signs \
             are on the two sides of the normal",
            "--mirror equal",
        );
        return 0.0;
    }
    reading.note_option(
        "there is no azimuth: all is in the plane of incidence, and equal angles are taken as the mirror direction",
        "--mirror opposite",
    );
    PI
}
