//! The inverse of the cumulative distribution of a table, tabulated for every outgoing direction: exact but for the size of its
//! cells, and as large as the table.
//!
//! Source: Matusik, Pfister, Brand and McMillan 2003, "Efficient Isotropic BRDF Measurement"; differs: over half vectors, so that
//! highlights of any outgoing direction have fine cells.

use super::Reflection;
use super::half_angles::{ANGLES, Layout, Outgoing, choose, running};
use glam::DVec3;

/// The tables of all outgoing directions.
pub struct Tabulated {
    layout: Layout,
    rows: Vec<RunningRow>,
}

struct RunningRow {
    /// Share of each cell.
    shares: Vec<f32>,
    /// Running share over the angle, and in each angle over the azimuth.
    angles: Vec<f64>,
    turns: Vec<Vec<f64>>,
}

impl Tabulated {
    /// Tabulates a reflection.
    pub fn new(reflection: &dyn Reflection) -> Self {
        let layout = Layout::new(reflection);
        let row = |shares: Vec<f64>| RunningRow {
            angles: running(shares.chunks_exact(layout.turns).map(|turns| turns.iter().sum())),
            turns: shares.chunks_exact(layout.turns).map(|turns| running(turns.iter().copied())).collect(),
            shares: shares.iter().map(|&share| share as f32).collect(),
        };
        Self { layout, rows: layout.tabulate(reflection).into_iter().map(row).collect() }
    }

    /// Bytes of the shares and the running sums as single-precision numbers.
    pub fn bytes(&self) -> usize {
        4 * self.rows.len() * (2 * self.layout.cells() + ANGLES)
    }

    /// Gets ready for an outgoing direction.
    #[inline]
    pub fn proposal(&self, wo: DVec3) -> TabulatedProposal<'_> {
        TabulatedProposal { table: self, outgoing: Outgoing::new(self.layout, wo) }
    }
}

/// The rows round one outgoing direction.
#[derive(Clone, Copy)]
pub struct TabulatedProposal<'a> {
    table: &'a Tabulated,
    outgoing: Outgoing,
}

impl TabulatedProposal<'_> {
    /// Draws a direction, maybe below the horizon.
    #[inline]
    pub fn sample(&self, [mut left, u, v]: [f64; 3]) -> DVec3 {
        let mut row = self.outgoing.rows[0].0;
        for (n, share) in self.outgoing.rows {
            row = n;
            if left < share {
                break;
            }
            left -= share;
        }
        let row = &self.table.rows[row];
        let (angle, along) = choose(&row.angles, u);
        let (turn, across) = choose(&row.turns[angle], v);
        self.outgoing.direction(angle * self.table.layout.turns + turn, [along, across])
    }

    /// Density of [`sample`](Self::sample); 1/sr.
    #[inline]
    pub fn density(&self, wi: DVec3) -> f64 {
        let (cell, in_cell) = self.outgoing.cell(wi);
        let share = self
            .outgoing
            .rows
            .iter()
            .map(|&(row, share)| share * f64::from(self.table.rows[row].shares[cell]));
        in_cell * share.sum::<f64>()
    }
}
