//! Cells of half vectors, and how much of `f cos` each of them reflects towards an outgoing direction.
//!
//! Cells are even in the azimuth of the half vector, counted from the plane of incidence. They are even in the root of its angle from
//! the normal too, as in the MERL tables: narrow where highlights are. Of isotropic materials the two sides of the plane of incidence
//! are one.

use super::Reflection;
use super::plain::mirrored;
use super::probe;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Cells along the angle of the half vector.
pub const ANGLES: usize = 90;

/// Numbers for isotropic and for anisotropic materials: angles and azimuths of outgoing directions, and cells along the azimuth of the
/// half vector. The last is that of points along each side of a cell.
const SIZES: [[usize; 4]; 2] = [[45, 1, 32, 2], [16, 16, 48, 1]];

/// Which outgoing directions and cells there are.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    thetas: usize,
    azimuths: usize,
    /// Cells along the azimuth.
    pub turns: usize,
    points: usize,
    is_folded: bool,
}

/// Angle of the half vector, as 1 - cos, where a cell begins; `place` counts cells.
fn one_minus_cos(place: f64) -> f64 {
    let root = place / ANGLES as f64;
    let sin = (0.5 * FRAC_PI_2 * root * root).sin();
    2.0 * sin * sin
}

impl Layout {
    /// The cells for a reflection.
    pub fn new(reflection: &dyn Reflection) -> Self {
        let is_folded = reflection.is_isotropic();
        let [thetas, azimuths, turns, points] = SIZES[usize::from(!is_folded)];
        Self { thetas, azimuths, turns, points, is_folded }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        ANGLES * self.turns
    }

    /// Solid angle of the half vectors of a cell; if it is folded, on both sides.
    fn solid_angle(&self, cell: usize) -> f64 {
        let angle = (cell / self.turns) as f64;
        TAU / self.turns as f64 * (one_minus_cos(angle + 1.0) - one_minus_cos(angle))
    }

    /// The share of each cell in the reflected light, for every outgoing direction; each row sums to 1.
    pub fn tabulate(&self, reflection: &dyn Reflection) -> Vec<Vec<f64>> {
        (0..self.thetas * self.azimuths).into_par_iter().map(|row| self.row(reflection, row)).collect()
    }

    fn row(&self, reflection: &dyn Reflection, row: usize) -> Vec<f64> {
        let azimuth = PI + TAU * (row / self.thetas) as f64 / self.azimuths as f64;
        let wo = probe::outgoing(probe::theta(row % self.thetas, self.thetas), azimuth);
        let outgoing = Outgoing::new(*self, wo);
        let inside = |n: usize| (n as f64 + 0.5) / self.points as f64;
        let mut row: Vec<f64> = (0..self.cells())
            .map(|cell| {
                let points = (0..self.points).flat_map(|i| (0..self.points).map(move |j| [i, j]));
                let sum: f64 = points
                    .map(|[i, j]| {
                        let h = outgoing.half(cell, [inside(i), inside(j)], false);
                        let cosine = wo.dot(h);
                        let wi = mirrored(wo, h);
                        let seen = cosine > 0.0 && wi.z > 0.0;
                        if seen { 4.0 * cosine * reflection.f_cos(wi, wo).abs().element_sum() } else { 0.0 }
                    })
                    .sum();
                sum * self.solid_angle(cell)
            })
            .collect();
        let sum: f64 = row.iter().sum();
        let even = 1.0 / row.len() as f64;
        row.iter_mut().for_each(|mass| *mass = if sum > 0.0 { *mass / sum } else { even });
        row
    }
}

/// An outgoing direction among those of the rows.
#[derive(Clone, Copy, Debug)]
pub struct Outgoing {
    layout: Layout,
    wo: DVec3,
    /// Direction of +x of the frame of the view.
    along: DVec2,
    /// The rows round it, with their shares.
    pub rows: [(usize, f64); 4],
}

impl Outgoing {
    /// Finds its place.
    pub fn new(layout: Layout, wo: DVec3) -> Self {
        let along = DVec2::new(-wo.x, -wo.y).normalize_or(DVec2::X);
        let (theta, part) = probe::place(wo.z, layout.thetas);
        let turns = (wo.y.atan2(wo.x) - PI) / TAU;
        let turned = (turns - turns.floor()) * layout.azimuths as f64;
        let azimuth = (turned as usize).min(layout.azimuths - 1);
        let across = turned - azimuth as f64;
        let row = |i: usize, j: usize| ((azimuth + i) % layout.azimuths) * layout.thetas + theta + j;
        // An isotropic material has one azimuth, and the second pair of rows is the first.
        let rows = [
            (row(0, 0), (1.0 - across) * (1.0 - part)),
            (row(0, 1), (1.0 - across) * part),
            (row(1, 0), across * (1.0 - part)),
            (row(1, 1), across * part),
        ];
        Self { layout, wo, along, rows }
    }

    /// The half vector at a place in a cell.
    fn half(&self, cell: usize, [angle, turn]: [f64; 2], is_mirrored: bool) -> DVec3 {
        let turns = self.layout.turns;
        let first = (cell / turns) as f64;
        let [low, high] = [one_minus_cos(first), one_minus_cos(first + 1.0)];
        let w = low + angle * (high - low);
        let whole = if self.layout.is_folded { PI } else { TAU };
        let (sin, cos) = (whole * ((cell % turns) as f64 + turn) / turns as f64).sin_cos();
        let across = (w * (2.0 - w)).max(0.0).sqrt();
        let [x, y] = [across * cos, if is_mirrored { -across * sin } else { across * sin }];
        let h = self.along * x + self.along.perp() * y;
        DVec3::new(h.x, h.y, 1.0 - w)
    }

    /// The incident direction of a place in a cell, maybe below the horizon; `turn` in [0, 1) over both sides of a folded cell.
    #[inline]
    pub fn direction(&self, cell: usize, [angle, turn]: [f64; 2]) -> DVec3 {
        let (turn, is_mirrored) = match self.layout.is_folded {
            true if turn >= 0.5 => (2.0 * turn - 1.0, true),
            true => (2.0 * turn, false),
            false => (turn, false),
        };
        mirrored(self.wo, self.half(cell, [angle, turn], is_mirrored))
    }

    /// The cell of an incident direction above the horizon, and the density there of directions of that cell; 1/sr.
    #[inline]
    pub fn cell(&self, wi: DVec3) -> (usize, f64) {
        let h = (self.wo + wi).normalize_or(DVec3::Z);
        let across = DVec2::new(h.x, h.y);
        let [x, y] = [self.along.dot(across), self.along.perp().dot(across)];
        let angle = x.hypot(y).atan2(h.z);
        let row = (((angle / FRAC_PI_2).max(0.0).sqrt() * ANGLES as f64) as usize).min(ANGLES - 1);
        let turns = if self.layout.is_folded {
            y.abs().atan2(x) / PI
        } else {
            let turns = y.atan2(x) / TAU;
            turns - turns.floor()
        };
        let column = ((turns * self.layout.turns as f64) as usize).min(self.layout.turns - 1);
        let cell = row * self.layout.turns + column;
        let cosine = self.wo.dot(h).max(f64::MIN_POSITIVE);
        (cell, 1.0 / (self.layout.solid_angle(cell) * 4.0 * cosine))
    }
}

/// Running sums of shares, with which an item is chosen.
pub fn running(shares: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut sum = 0.0;
    let mut running: Vec<f64> = shares
        .into_iter()
        .map(|share| {
            sum += share;
            sum
        })
        .collect();
    if sum > 0.0 {
        running.iter_mut().for_each(|v| *v /= sum);
    }
    running
}

/// The item at a share of the whole, and how far into it, in [0, 1).
#[inline]
pub fn choose(running: &[f64], u: f64) -> (usize, f64) {
    let item = running.partition_point(|&end| end <= u).min(running.len() - 1);
    let start = if item == 0 { 0.0 } else { running[item - 1] };
    let width = running[item] - start;
    (item, if width > 0.0 { ((u - start) / width).clamp(0.0, LARGEST) } else { 0.5 })
}

/// Largest place in an item.
const LARGEST: f64 = 1.0 - f64::EPSILON;
