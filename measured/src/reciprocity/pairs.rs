//! Samples that should agree: those of swapped directions, and those on the two sides of the plane of incidence.

use crate::row::Row;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Angles that are as close as this are one, radians.
const CLOSE: f64 = 0.5 * PI / 180.0;

/// Most samples that a sample is compared with.
const MOST_OTHERS: usize = 4;

/// Angles of a sample, radians: incident, outgoing, and the difference of the azimuths, -pi to pi; of a surface that a turn changes the
/// azimuth of the incident direction too, 0 to 2 pi, which is 0 otherwise.
type Angles = [f64; 4];

/// A sample by its angles.
#[derive(Clone, Copy, Debug)]
struct Placed {
    angles: Angles,
    level: f64,
}

/// Samples by where they are.
pub(crate) struct Places {
    placed: Vec<Placed>,
    cells: HashMap<[i32; 4], Vec<usize>>,
    is_turned: bool,
    /// Angles that are as close as this are one, radians.
    close: f64,
}

/// Two samples that should agree: logarithm of the ratio of the first to the second, the angles of both, incident and outgoing,
/// radians, and the cosines of the first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compared {
    pub log_ratio: f64,
    pub angles: [[f64; 2]; 2],
    pub cosines: [f64; 2],
}

/// An azimuth from 0 to 2 pi; a whole turn, but for less than half of `close`, is 0.
fn round(azimuth: f64, close: f64) -> f64 {
    let round = libm::fmod(libm::fmod(azimuth, 2.0 * PI) + 2.0 * PI, 2.0 * PI);
    if round > 2.0 * PI - 0.5 * close { 0.0 } else { round }
}

fn cell(angles: Angles, close: f64) -> [i32; 4] {
    angles.map(|angle| libm::floor(angle / close) as i32)
}

impl Places {
    /// `is_turned`: a turn of the sample changes its values.
    pub fn of(rows: &[Row], is_turned: bool) -> Self {
        Self::within(CLOSE, rows, is_turned)
    }

    /// The same with angles that are one within `close`, radians.
    pub fn within(close: f64, rows: &[Row], is_turned: bool) -> Self {
        let place = |row: &Row| {
            let ([i, o], turn) = row.angles();
            let azimuth = if is_turned { round(libm::atan2(row.wi[1], row.wi[0]), close) } else { 0.0 };
            Placed { angles: [i, o, turn.unwrap_or(0.0), azimuth], level: row.rgb.iter().sum::<f64>() / 3.0 }
        };
        let placed: Vec<Placed> = rows.iter().map(place).collect();
        let mut cells: HashMap<[i32; 4], Vec<usize>> = HashMap::new();
        for (n, p) in placed.iter().enumerate().filter(|(_, p)| p.level > 0.0) {
            cells.entry(cell(p.angles, close)).or_default().push(n);
        }
        Self { placed, cells, is_turned, close }
    }

    /// The samples whose angles are close to these, a few at most.
    fn near(&self, angles: Angles) -> Vec<&Placed> {
        let at = cell(angles, self.close);
        let mut found = Vec::new();
        for step in 0..if self.is_turned { 81 } else { 27 } {
            let last = if self.is_turned { step / 27 - 1 } else { 0 };
            let around =
                [at[0] + step % 3 - 1, at[1] + step / 3 % 3 - 1, at[2] + step / 9 % 3 - 1, at[3] + last];
            let Some(members) = self.cells.get(&around) else { continue };
            let close = |p: &&Placed| (0..4).all(|k| (p.angles[k] - angles[k]).abs() < self.close);
            found.extend(members.iter().map(|&n| &self.placed[n]).filter(close));
            if found.len() >= MOST_OTHERS {
                found.truncate(MOST_OTHERS);
                break;
            }
        }
        found
    }

    fn compared(&self, other: impl Fn(Angles) -> Option<Angles>) -> Vec<Compared> {
        let mut found = Vec::new();
        for p in self.placed.iter().filter(|p| p.level > 0.0) {
            let Some(angles) = other(p.angles) else { continue };
            found.extend(self.near(angles).into_iter().map(|q| Compared {
                log_ratio: libm::log(p.level / q.level),
                angles: [p, q].map(|sample| [sample.angles[0], sample.angles[1]]),
                cosines: [libm::cos(p.angles[0]), libm::cos(p.angles[1])],
            }));
        }
        found
    }

    /// Each sample with those of the same directions swapped, once.
    pub fn swapped(&self) -> Vec<Compared> {
        let close = self.close;
        if self.is_turned {
            // The outgoing direction becomes the incident one, at its own azimuth.
            return self.compared(|[i, o, turn, azimuth]| {
                (i < o - close).then_some([o, i, -turn, round(azimuth + turn, close)])
            });
        }
        let both = |turn: f64| move |[i, o, ..]: Angles| (i < o - close).then_some([o, i, turn, 0.0]);
        // A swap changes the sign of the difference of azimuths; the other side of the plane of incidence is the same surface.
        let with_sign = |sign: f64| self.compared(|a| both(sign * a[2])(a));
        let mut found = with_sign(1.0);
        found.extend(with_sign(-1.0));
        found
    }

    /// Each sample on one side of the plane of incidence with those on the other; none of a surface that a turn changes.
    pub fn sides(&self) -> Vec<Compared> {
        let least = 4.0 * self.close;
        self.compared(|[i, o, turn, _]| {
            let is_aside = turn > least && turn < PI - least;
            (is_aside && !self.is_turned).then_some([i, o, -turn, 0.0])
        })
    }
}
