//! From the numbers of a row to two unit vectors.

use super::super::alta::from_half;
use super::super::conventions::{Angles, Conventions, Mirror};
use super::super::intake::Reading;
use super::columns::{Azimuths, Columns, Directions, Place};
use super::names::Unit;
use super::{Numbers, Unknown};
use crate::ReadError;
use crate::file::decode::shortened;
use crate::row::turned_back;
use crate::table::direction;
use std::f64::consts::{FRAC_PI_2, PI};

/// How far a squared length may be from 1.
const UNIT: f64 = 1e-3;

/// What rounding adds to the largest angles.
const ROUNDING: f64 = 1e-3;

/// What rounding makes of the cosine of a phase angle.
const PHASE: f64 = 0.02;

/// Product of the sines of two directions below which one is the normal, and has no azimuth.
const AT_NORMAL: f64 = 1e-9;

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
    /// Whether cosines stand in place of angles from the normal.
    are_cosines: [bool; 2],
    azimuths: Option<Azimuths>,
    /// Radians of a unit of the turn of the sample; 0 where all have the same.
    turn: f64,
    /// In a plane: the meaning of the azimuth of the outgoing direction.
    plane: f64,
}

/// Numbers of a row that say its directions.
pub(super) const NUMBERS: usize = 7;

/// The number that is the turn of the sample.
const TURN: usize = 6;

/// Places of the numbers of a row: of vectors six; of angles both thetas and both azimuths; and that of the turn of the sample.
pub(super) fn places(directions: &Directions, turn: Option<usize>) -> [Option<Place>; NUMBERS] {
    let [a, b, c, d, e, f] = match directions {
        Directions::Vectors([i, o]) => [i[0], i[1], i[2], o[0], o[1], o[2]].map(|n| Some(Place::Column(n))),
        Directions::Half([half, theta, phi]) => {
            let column = |n: &usize| Some(Place::Column(*n));
            [column(half), column(theta), None, column(phi), None, None]
        }
        Directions::Angles { thetas: [i, o], azimuths, .. } => {
            let [phi_i, phi_o] = match azimuths {
                Azimuths::Both([i, o]) => [Some(*i), Some(*o)],
                Azimuths::Outgoing(o) | Azimuths::Phase(o) => [None, Some(*o)],
                Azimuths::Incident(i) => [Some(*i), None],
                Azimuths::InPlane => [None, None],
            };
            [Some(*i), Some(*o), phi_i, phi_o, None, None]
        }
    };
    [a, b, c, d, e, f, turn.map(Place::Column)]
}

/// The last column that a direction needs.
pub(super) fn last_column(directions: &Directions) -> usize {
    let column = |place: &Place| match place {
        Place::Column(n) => *n,
        Place::Constant(_) => 0,
    };
    places(directions, None).iter().flatten().map(column).max().unwrap_or(0)
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
        let (azimuths, are_cosines) = match &columns.directions {
            Directions::Vectors(_) | Directions::Half(_) => (None, [false; 2]),
            Directions::Angles { azimuths, are_cosines, .. } => (Some(*azimuths), *are_cosines),
        };
        let (is_vectors, is_half) = match &columns.directions {
            Directions::Vectors(_) => (true, false),
            Directions::Half(_) => (false, true),
            Directions::Angles { .. } => (false, false),
        };
        let mut geometry =
            Self { is_vectors, is_half, radians: 1.0, are_cosines, azimuths, turn: 0.0, plane: PI };
        let radians_of = |angles| if angles == Angles::Degrees { PI / 180.0 } else { 1.0 };
        if geometry.is_vectors {
            let angles = conventions.angles.unwrap_or(Angles::Degrees);
            geometry.turn = turn(columns, rows, radians_of(angles), reading);
            return Ok(geometry);
        }
        geometry.radians = match (conventions.angles, columns.angle_unit.or(said)) {
            (Some(angles), _) => radians_of(angles),
            (None, Some(Unit::Degrees)) => radians_of(Angles::Degrees),
            (None, Some(Unit::Radians)) => radians_of(Angles::Radians),
            (None, Some(Unit::Gon)) => PI / 200.0,
            _ => radians_of(found_angles(rows, are_cosines, unknown, reading)?),
        };
        geometry.turn = turn(columns, rows, geometry.radians, reading);
        let is_signed = |row: &&Numbers| (0..2).any(|k| !are_cosines[k] && row.directions[k] < 0.0);
        let signed = rows.iter().filter(is_signed).count();
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
        let both = self.untouched(row)?;
        if self.turn == 0.0 {
            return Ok(both);
        }
        let angle = row.directions[TURN] * self.turn;
        if angle.abs() > TURNS {
            return Err(ReadError::Content(format!(
                "line {}: {} is no turn",
                row.line, row.directions[TURN]
            )));
        }
        Ok(both.map(|d| turned_back(d, angle)))
    }

    /// The same before the turn of the sample.
    fn untouched(&self, row: &Numbers) -> Result<[[f64; 3]; 2], ReadError> {
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
        let thetas = [0, 1].map(|k| match self.are_cosines[k] && d[k].abs() <= 1.0 + ROUNDING {
            true => libm::acos(d[k].clamp(-1.0, 1.0)),
            false => d[k] * self.radians,
        });
        if let Some(k) = (0..2).find(|&k| self.are_cosines[k] && d[k].abs() > 1.0 + ROUNDING) {
            return Err(ReadError::Content(format!("line {}: {} is no cosine", row.line, d[k])));
        }
        let [phi_i_radians, phi_o_radians] = [phi_i, phi_o].map(|phi| phi * self.radians);
        for (name, angle, radians, most) in [
            ("theta", d[0], thetas[0], PI),
            ("theta", d[1], thetas[1], PI),
            ("phi", phi_i, phi_i_radians, TURNS),
            ("phi", phi_o, phi_o_radians, TURNS),
        ] {
            if radians.abs() > most + ROUNDING {
                let text = format!(
                    "line {}: {name} {angle} is no angle: 180 degrees is the most from the normal",
                    row.line
                );
                return Err(ReadError::Content(text));
            }
        }
        if let Some(Azimuths::Phase(_)) = self.azimuths {
            let [i, o] = thetas;
            let both = libm::sin(i) * libm::sin(o);
            let across = libm::cos(phi_o * self.radians) - libm::cos(i) * libm::cos(o);
            if across.abs() > both.abs() + PHASE {
                return Err(ReadError::Content(format!(
                    "line {}: no azimuth makes the phase angle {phi_o} of these two directions",
                    row.line
                )));
            }
            let turn =
                if both.abs() > AT_NORMAL { libm::acos((across / both).clamp(-1.0, 1.0)) } else { 0.0 };
            return Ok([direction(i, 0.0), direction(o, turn)]);
        }
        if self.is_half {
            return Ok(from_half(thetas[0], thetas[1], phi_o_radians));
        }
        Ok([direction(thetas[0], phi_i_radians), direction(thetas[1], phi_o_radians)])
    }
}

/// Radians of a unit of the turn of the sample; 0 where there is none, or one alone.
fn turn(columns: &Columns, rows: &[Numbers], radians: f64, reading: &mut Reading) -> f64 {
    let (Some((column, unit)), Some(first)) = (columns.turn, rows.first()) else { return 0.0 };
    let name = shortened(&columns.names[column]);
    if rows.iter().all(|row| row.directions[TURN] == first.directions[TURN]) {
        reading.note(format!("`{name}` is the same in all rows: the sample was not turned"));
        return 0.0;
    }
    reading.note(format!(
        "`{name}` is taken as the turn of the sample, anticlockwise as seen from above: azimuths are counted from the sample"
    ));
    match unit {
        Some(Unit::Degrees) => PI / 180.0,
        Some(Unit::Radians) => 1.0,
        Some(Unit::Gon) => PI / 200.0,
        Some(Unit::Percent) | None => radians,
    }
}

/// The unit of angles, by the numbers alone.
fn found_angles(
    rows: &[Numbers],
    are_cosines: [bool; 2],
    unknown: Unknown,
    reading: &mut Reading,
) -> Result<Angles, ReadError> {
    let most = |places: &[usize]| {
        rows.iter().flat_map(|row| places.iter().map(|&n| row.directions[n].abs())).fold(0.0, f64::max)
    };
    let thetas: Vec<usize> = (0..2).filter(|&k| !are_cosines[k]).collect();
    let (theta, phi) = (most(&thetas), most(&[2, 3]));
    if thetas.is_empty() && phi > 0.0 && phi <= 2.0 * PI + ROUNDING {
        return Err(ReadError::Content(format!(
            "no azimuth is above {phi:.4}: are they radians? Say it by --angles radians (or degrees), or in the names: dphi [rad]"
        )));
    }
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
    let both = near(1.0).zip(near(-1.0));
    let sides = both.is_some_and(|(equal, opposite)| opposite > BRIGHTER * equal);
    let is_equal = both.is_some_and(|(equal, opposite)| equal > BRIGHTER * opposite);
    // Who writes every angle of the light below 0 counts angles along the plane.
    let below = |row: &Numbers| row.directions[0] <= 0.0;
    if !sides && !is_equal && rows.iter().all(below) && rows.iter().any(|row| row.directions[0] < 0.0) {
        reading.note_option(
            "there is no azimuth: all is in the plane of incidence, and as incident angles are below 0, angles of opposite signs are on \
             the two sides of the normal",
            "--mirror equal",
        );
        return 0.0;
    }
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
