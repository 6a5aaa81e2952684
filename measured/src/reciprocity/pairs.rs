//! Samples that should agree: those of swapped directions, and those on the two sides of the plane of incidence.

use crate::row::Row;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Angles that are as close as this are one, radians.
const CLOSE: f64 = 0.5 * PI / 180.0;

/// Most samples that a sample is compared with.
const MOST_OTHERS: usize = 4;

/// A sample by its three angles, radians: incident, outgoing, and the difference of the azimuths, -pi to pi.
#[derive(Clone, Copy, Debug)]
struct Placed {
    angles: [f64; 3],
    level: f64,
}

/// Samples by where they are.
pub(crate) struct Places {
    placed: Vec<Placed>,
    cells: HashMap<[i32; 3], Vec<usize>>,
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

fn cell(angles: [f64; 3], close: f64) -> [i32; 3] {
    angles.map(|angle| libm::floor(angle / close) as i32)
}

impl Places {
    pub fn of(rows: &[Row]) -> Self {
        Self::within(CLOSE, rows)
    }

    /// The same with angles that are one within `close`, radians.
    pub fn within(close: f64, rows: &[Row]) -> Self {
        let place = |row: &Row| {
            let ([i, o], turn) = row.angles();
            Placed { angles: [i, o, turn.unwrap_or(0.0)], level: row.rgb.iter().sum::<f64>() / 3.0 }
        };
        let placed: Vec<Placed> = rows.iter().map(place).collect();
        let mut cells: HashMap<[i32; 3], Vec<usize>> = HashMap::new();
        for (n, p) in placed.iter().enumerate().filter(|(_, p)| p.level > 0.0) {
            cells.entry(cell(p.angles, close)).or_default().push(n);
        }
        Self { placed, cells, close }
    }

    /// The samples whose angles are close to these, a few at most.
    fn near(&self, angles: [f64; 3]) -> Vec<&Placed> {
        let at = cell(angles, self.close);
        let mut found = Vec::new();
        for step in 0..27 {
            let around = [at[0] + step % 3 - 1, at[1] + step / 3 % 3 - 1, at[2] + step / 9 - 1];
            let Some(members) = self.cells.get(&around) else { continue };
            let close = |p: &&Placed| (0..3).all(|k| (p.angles[k] - angles[k]).abs() < self.close);
            found.extend(members.iter().map(|&n| &self.placed[n]).filter(close));
            if found.len() >= MOST_OTHERS {
                found.truncate(MOST_OTHERS);
                break;
            }
        }
        found
    }

    fn compared(&self, other: impl Fn([f64; 3]) -> Option<[f64; 3]>) -> Vec<Compared> {
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
        let both = |turn: f64| move |[i, o, _]: [f64; 3]| (i < o - close).then_some([o, i, turn]);
        // A swap changes the sign of the difference of azimuths; the other side of the plane of incidence is the same surface.
        let with_sign = |sign: f64| self.compared(|a| both(sign * a[2])(a));
        let mut found = with_sign(1.0);
        found.extend(with_sign(-1.0));
        found
    }

    /// Each sample on one side of the plane of incidence with those on the other.
    pub fn sides(&self) -> Vec<Compared> {
        let least = 4.0 * self.close;
        self.compared(|[i, o, turn]| (turn > least && turn < PI - least).then_some([i, o, -turn]))
    }
}
