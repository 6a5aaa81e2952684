//! The matrix of a step of an anisotropic fit: each stored view is coupled with those round it, and conjugate gradients solve it.

use crate::anisotropic::grid::{CellPlace, Layout};
use crate::anisotropic::tuning::objective::{INNER_STEPS, TOLERANCE};
use crate::family::matrix::{Block, Matrix};
use crate::numeric::blocks::Blocks;

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
        // By the unknowns of the normal, where it is one of the corners: turned gradient, H R, R^T H R.
        let is_turned = corners.iter().any(|c| c.0 == 0);
        let (mut half, mut both) = (Vec::new(), Vec::new());
        if is_turned {
            half.clone_from(&block.matrix);
            half.chunks_exact_mut(p).for_each(|row| layout.turn_transposed(row, azimuth));
            both = vec![0.0; p * p];
            let mut column = vec![0.0; p];
            for j in 0..p {
                (0..p).for_each(|i| column[i] = half[i * p + j]);
                layout.turn_transposed(&mut column, azimuth);
                (0..p).for_each(|i| both[i * p + j] = column[i]);
            }
        }
        for (n, &(a, share_a)) in corners.iter().enumerate() {
            let mut turned = block.gradient.clone();
            if a == 0 {
                layout.turn_transposed(&mut turned, azimuth);
            }
            let to = &mut gradient[a * p..(a + 1) * p];
            to.iter_mut().zip(&turned).for_each(|(t, g)| *t += share_a * g);
            for &(b, share_b) in &corners[..=n] {
                let (row, column) = (a.max(b), a.min(b));
                let from = match (row, column) {
                    (0, 0) => &both,
                    (_, 0) => &half,
                    _ => &block.matrix,
                };
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
