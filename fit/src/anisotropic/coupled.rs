//! The matrix of a step of an anisotropic fit: each stored view is coupled with those round it, and conjugate gradients solve it.

use crate::anisotropic::grid::{CellPlace, Layout, Stored};
use crate::anisotropic::tuning::objective::{INNER_STEPS, TOLERANCE};
use crate::family::matrix::{Block, Matrix};
use crate::numeric::blocks::Blocks;

/// A block between two stored views, by the unknowns of both.
fn mapped(layout: &Layout, block: &[f64], (row, column): (Stored, Stored), azimuth: [f64; 2]) -> Vec<f64> {
    let p = layout.stride();
    let mut matrix = block.to_vec();
    matrix.chunks_exact_mut(p).for_each(|line| layout.by_stored(line, column, azimuth));
    let mut line = vec![0.0; p];
    for j in (0..p).filter(|_| row != Stored::AsTheyAre) {
        (0..p).for_each(|i| line[i] = matrix[i * p + j]);
        layout.by_stored(&mut line, row, azimuth);
        (0..p).for_each(|i| matrix[i * p + j] = line[i]);
    }
    matrix
}

/// The matrix.
pub(crate) struct Coupled(Blocks);

impl Matrix<Layout, CellPlace> for Coupled {
    fn zeros(layout: &Layout) -> Self {
        Self(Blocks::new(layout.stride(), layout.stored_views()))
    }

    fn cleared(self, layout: &Layout) -> Self {
        drop(self);
        Self::zeros(layout)
    }

    /// By the chain rule of the interpolation.
    fn add_view(&mut self, layout: &Layout, block: &Block<CellPlace>, gradient: &mut [f64]) {
        let (p, azimuth) = (layout.stride(), block.place.azimuth);
        let corners = block.place.stored();
        // By the unknowns of stored views whose own follow by a linear map: L^T g, and M^T H L of two.
        let way = |stored: usize| layout.views.stored(stored);
        let mut known: Vec<((Stored, Stored), Vec<f64>)> = Vec::new();
        for (n, &(a, share_a)) in corners.iter().enumerate() {
            let mut own = block.gradient.clone();
            layout.by_stored(&mut own, way(a), azimuth);
            let to = &mut gradient[a * p..(a + 1) * p];
            to.iter_mut().zip(&own).for_each(|(t, g)| *t += share_a * g);
            for &(b, share_b) in &corners[..=n] {
                let (row, column) = (a.max(b), a.min(b));
                let ways = (way(row), way(column));
                if ways != (Stored::AsTheyAre, Stored::AsTheyAre) && known.iter().all(|k| k.0 != ways) {
                    known.push((ways, mapped(layout, &block.matrix, ways, azimuth)));
                }
                let from = known.iter().find(|k| k.0 == ways).map_or(&block.matrix, |k| &k.1);
                let share = share_a * share_b;
                let sums = self.0.block(row, column);
                sums.iter_mut().zip(from).for_each(|(b, v)| *b += share * v);
            }
        }
    }

    fn add_row(&mut self, terms: &[(usize, f64)]) {
        self.0.add_row(terms.to_vec());
    }

    fn scale(&self) -> Vec<f64> {
        self.0.diagonal()
    }

    /// By conjugate gradients.
    fn step(&mut self, added: &[f64], free: &[bool], downhill: Vec<f64>) -> Option<Vec<f64>> {
        self.0.solve(added, free, &downhill, TOLERANCE, INNER_STEPS)
    }
}
