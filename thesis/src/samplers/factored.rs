//! The table of [`tabulated`](super::tabulated) as a sum of few products: of a function of the outgoing direction, one of the angle
//! and one of the azimuth of the half vector, none of them negative. A term is drawn, then the angle, then the azimuth.
//!
//! Source: Lawrence, Rusinkiewicz and Ramamoorthi 2004, "Efficient BRDF Importance Sampling Using a Factored Representation"; the
//! factors by the multiplicative updates of Lee and Seung 2000 for the Kullback-Leibler divergence, which keep the sums of rows:
//! shares stay shares. The best product of a function of the angle and one of the azimuth for that divergence is that of the
//! marginals.

use super::Reflection;
use super::half_angles::{ANGLES, Layout, Outgoing, choose, running};
use glam::DVec3;
use rayon::prelude::*;

/// Terms of the sum.
const TERMS: usize = 8;

/// Updates of all factors.
const UPDATES: usize = 80;

/// Least share of a factor: an update cannot bring back a 0.
const LEAST: f64 = 1e-12;

/// A term: shares over the angle and the azimuth of the half vector, with running sums.
struct Term {
    angle: Vec<f64>,
    turn: Vec<f64>,
    angles: Vec<f64>,
    turns: Vec<f64>,
}

/// The factors.
pub struct Factored {
    layout: Layout,
    terms: Vec<Term>,
    /// Shares of the terms for every outgoing direction.
    of_outgoing: Vec<[f64; TERMS]>,
}

impl Factored {
    /// Tabulates a reflection and factors the table, from a start that uniform numbers in [0, 1) disturb.
    pub fn new(reflection: &dyn Reflection, uniform: impl FnMut() -> f32) -> Self {
        let layout = Layout::new(reflection);
        let (of_outgoing, of_half) = factor(&layout.tabulate(reflection), layout.cells(), uniform);
        let term = |shares: &Vec<f64>| {
            let angle: Vec<f64> = shares.chunks_exact(layout.turns).map(|turns| turns.iter().sum()).collect();
            let turn: Vec<f64> = (0..layout.turns)
                .map(|turn| (0..ANGLES).map(|angle| shares[angle * layout.turns + turn]).sum())
                .collect();
            Term { angles: running(angle.iter().copied()), turns: running(turn.iter().copied()), angle, turn }
        };
        Self { layout, terms: of_half.iter().map(term).collect(), of_outgoing }
    }

    /// Bytes of the factors as single-precision numbers.
    pub fn bytes(&self) -> usize {
        4 * TERMS * (self.of_outgoing.len() + ANGLES + self.layout.turns)
    }

    /// Gets ready for an outgoing direction.
    #[inline]
    pub fn proposal(&self, wo: DVec3) -> FactoredProposal<'_> {
        let outgoing = Outgoing::new(self.layout, wo);
        let mut shares = [0.0; TERMS];
        for (row, share) in outgoing.rows {
            shares.iter_mut().zip(&self.of_outgoing[row]).for_each(|(sum, term)| *sum += share * term);
        }
        FactoredProposal { factored: self, outgoing, shares }
    }
}

/// Factors rows that sum to 1: shares of the terms for each row, and shares of the cells for each term, which both sum to 1.
fn factor(
    rows: &[Vec<f64>],
    cells: usize,
    mut uniform: impl FnMut() -> f32,
) -> (Vec<[f64; TERMS]>, Vec<Vec<f64>>) {
    let mut of_row = vec![[1.0 / TERMS as f64; TERMS]; rows.len()];
    // Every term starts as the mean of neighbouring rows, a little disturbed.
    let mut of_cell: Vec<Vec<f64>> = (0..TERMS)
        .map(|term| {
            let near = &rows[rows.len() * term / TERMS
                ..(rows.len() * (term + 1) / TERMS).max(rows.len() * term / TERMS + 1)];
            let mut mean: Vec<f64> = (0..cells)
                .map(|cell| {
                    let sum: f64 = near.iter().map(|row| row[cell]).sum();
                    (sum / near.len() as f64 + 0.02 / cells as f64) * (0.9 + 0.2 * f64::from(uniform()))
                })
                .collect();
            normalize(&mut mean);
            mean
        })
        .collect();
    for _ in 0..UPDATES {
        // The share of each row in its own shares and in each term's cells: the table over the sum, weighted by the parts of the sum.
        let said: Vec<([f64; TERMS], Vec<f64>)> = rows
            .par_iter()
            .zip(&of_row)
            .map(|(row, shares)| {
                let mut own = [0.0; TERMS];
                let ratio: Vec<f64> = row
                    .iter()
                    .enumerate()
                    .map(|(cell, &value)| {
                        let sum: f64 = (0..TERMS).map(|t| shares[t] * of_cell[t][cell]).sum();
                        let ratio = if sum > 0.0 { value / sum } else { 0.0 };
                        (0..TERMS).for_each(|t| own[t] += ratio * of_cell[t][cell]);
                        ratio
                    })
                    .collect();
                (own, ratio)
            })
            .collect();
        of_cell.par_iter_mut().enumerate().for_each(|(t, cells)| {
            for (cell, share) in cells.iter_mut().enumerate() {
                let sum: f64 =
                    said.iter().zip(&of_row).map(|((_, ratio), shares)| shares[t] * ratio[cell]).sum();
                *share = (*share * sum).max(LEAST);
            }
            normalize(cells);
        });
        for (shares, (own, _)) in of_row.iter_mut().zip(&said) {
            (0..TERMS).for_each(|t| shares[t] = (shares[t] * own[t]).max(LEAST));
            normalize(shares);
        }
    }
    (of_row, of_cell)
}

fn normalize(shares: &mut [f64]) {
    let sum: f64 = shares.iter().sum();
    shares.iter_mut().for_each(|share| *share /= sum);
}

/// The terms for one outgoing direction.
#[derive(Clone, Copy)]
pub struct FactoredProposal<'a> {
    factored: &'a Factored,
    outgoing: Outgoing,
    shares: [f64; TERMS],
}

impl FactoredProposal<'_> {
    /// Draws a direction, maybe below the horizon.
    #[inline]
    pub fn sample(&self, [mut left, u, v]: [f64; 3]) -> DVec3 {
        let mut chosen = TERMS - 1;
        for (term, share) in self.shares.iter().enumerate() {
            if left < *share {
                chosen = term;
                break;
            }
            left -= share;
        }
        let term = &self.factored.terms[chosen];
        let (angle, along) = choose(&term.angles, u);
        let (turn, across) = choose(&term.turns, v);
        self.outgoing.direction(angle * self.factored.layout.turns + turn, [along, across])
    }

    /// Density of [`sample`](Self::sample); 1/sr.
    #[inline]
    pub fn density(&self, wi: DVec3) -> f64 {
        let (cell, in_cell) = self.outgoing.cell(wi);
        let (angle, turn) = (cell / self.factored.layout.turns, cell % self.factored.layout.turns);
        let terms = self.factored.terms.iter().zip(&self.shares);
        in_cell * terms.map(|(term, share)| share * term.angle[angle] * term.turn[turn]).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_of_few_products_is_found_again() {
        let shape =
            |term: usize, cell: usize| if cell / 25 == term { 1.0 + ((cell * 7) % 5) as f64 } else { 0.0 };
        let rows: Vec<Vec<f64>> = (0..24)
            .map(|row| {
                let mut cells: Vec<f64> = (0..100)
                    .map(|cell| {
                        (0..4).map(|t| f64::from((row + 3 * t as u32) % 7) * shape(t, cell)).sum::<f64>()
                    })
                    .collect();
                normalize(&mut cells);
                cells
            })
            .collect();
        let mut random = srbf_measured::numeric::random::Random::new(2004);
        let (of_row, of_cell) = factor(&rows, 100, || random.uniform() as f32);
        let mut worst = 0f64;
        for (row, shares) in rows.iter().zip(&of_row) {
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            for (cell, value) in row.iter().enumerate() {
                let sum: f64 = (0..TERMS).map(|t| shares[t] * of_cell[t][cell]).sum();
                worst = worst.max((sum - value).abs());
            }
        }
        assert!(worst < 2e-3, "{worst}");
    }
}
