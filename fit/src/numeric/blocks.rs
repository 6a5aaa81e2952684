//! Symmetric matrices of dense blocks, most of them absent, and conjugate gradients on them.
//!
//! A view of an anisotropic material depends on four stored views, so the normal equations couple each stored view with the eight
//! round it: 65 stored views of 78 unknowns have a band of 1400 in any order, and its factors would fill it (5 billion
//! multiply-adds a step). Conjugate gradients touch only the stored numbers, 3 million a step. A few dozen steps do, because the
//! blocks on the diagonal, factored as preconditioner, hold the stiff part: the couplings of overlapping lobes within a view.

use crate::numeric::vector::dot;
use std::collections::BTreeMap;

/// A symmetric matrix of square blocks.
pub(crate) struct Blocks {
    /// Rows of a block.
    size: usize,
    count: usize,
    /// Row and column of the blocks on and below the diagonal.
    blocks: BTreeMap<(usize, usize), Vec<f64>>,
    /// Added to it: rows of terms (unknown, factor), each times its transpose.
    rows: Vec<Vec<(usize, f64)>>,
}

impl Blocks {
    /// The zero matrix of `count` x `count` blocks of `size` rows.
    pub fn new(size: usize, count: usize) -> Self {
        Self { size, count, blocks: BTreeMap::new(), rows: Vec::new() }
    }

    /// The block at a row and a column, on or below the diagonal; row-major.
    pub fn block(&mut self, row: usize, column: usize) -> &mut [f64] {
        debug_assert!(row >= column && row < self.count);
        self.blocks.entry((row, column)).or_insert_with(|| vec![0.0; self.size * self.size])
    }

    /// Adds `r r^T` of a sparse row.
    pub fn add_row(&mut self, row: Vec<(usize, f64)>) {
        self.rows.push(row);
    }

    /// The diagonal.
    pub fn diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.size * self.count];
        for ((row, _), block) in self.blocks.iter().filter(|((r, c), _)| r == c) {
            for i in 0..self.size {
                diagonal[row * self.size + i] += block[i * (self.size + 1)];
            }
        }
        for &(i, factor) in self.rows.iter().flatten() {
            diagonal[i] += factor * factor;
        }
        diagonal
    }

    /// `out = A x`.
    pub fn times(&self, x: &[f64], out: &mut [f64]) {
        let n = self.size;
        out.fill(0.0);
        for (&(row, column), block) in &self.blocks {
            for i in 0..n {
                let line = &block[i * n..(i + 1) * n];
                let from = &x[column * n..(column + 1) * n];
                out[row * n + i] += dot(line, from);
            }
            if row != column {
                for i in 0..n {
                    let xi = x[row * n + i];
                    let line = &block[i * n..(i + 1) * n];
                    let to = &mut out[column * n..(column + 1) * n];
                    to.iter_mut().zip(line).for_each(|(o, b)| *o += xi * b);
                }
            }
        }
        for row in &self.rows {
            let sum: f64 = row.iter().map(|&(i, factor)| factor * x[i]).sum();
            row.iter().for_each(|&(i, factor)| out[i] += factor * sum);
        }
    }

    /// Solves `(A + diag(added)) x = b` over the unknowns that are free; the others stay 0.
    ///
    /// Conjugate gradients, preconditioned by the blocks on the diagonal. They end after `most` steps, or when the residual in the
    /// preconditioner's norm has fallen to `tolerance` of the first. `None` if a block is not positive definite.
    pub fn solve(
        &self,
        added: &[f64],
        free: &[bool],
        b: &[f64],
        tolerance: f64,
        most: usize,
    ) -> Option<Vec<f64>> {
        let factors = self.factor_diagonal(added, free)?;
        let mask = |v: &mut [f64]| v.iter_mut().zip(free).filter(|f| !f.1).for_each(|(v, _)| *v = 0.0);
        let mut x = vec![0.0; b.len()];
        let mut residual = b.to_vec();
        mask(&mut residual);
        let mut z = residual.clone();
        solve_blocks(&factors, self.size, &mut z);
        let mut direction = z.clone();
        let mut product = vec![0.0; b.len()];
        let mut norm = dot(&residual, &z);
        let goal = tolerance * tolerance * norm;
        for _ in 0..most {
            if norm <= goal || norm <= 0.0 {
                break;
            }
            self.times(&direction, &mut product);
            product.iter_mut().zip(added.iter().zip(&direction)).for_each(|(p, (a, d))| *p += a * d);
            mask(&mut product);
            let curvature = dot(&direction, &product);
            if curvature.is_nan() || curvature <= 0.0 {
                return None;
            }
            let step = norm / curvature;
            x.iter_mut().zip(&direction).for_each(|(x, d)| *x += step * d);
            residual.iter_mut().zip(&product).for_each(|(r, p)| *r -= step * p);
            z.copy_from_slice(&residual);
            solve_blocks(&factors, self.size, &mut z);
            let next = dot(&residual, &z);
            let share = next / norm;
            norm = next;
            direction.iter_mut().zip(&z).for_each(|(d, z)| *d = z + share * *d);
        }
        Some(x)
    }

    /// Cholesky factors of the blocks on the diagonal, fixed unknowns replaced by the unit matrix.
    fn factor_diagonal(&self, added: &[f64], free: &[bool]) -> Option<Vec<Vec<f64>>> {
        let n = self.size;
        let mut extra = added.to_vec();
        for &(i, factor) in self.rows.iter().flatten() {
            extra[i] += factor * factor;
        }
        let zero = vec![0.0; n * n];
        (0..self.count)
            .map(|k| {
                let mut block = self.blocks.get(&(k, k)).unwrap_or(&zero).clone();
                for i in 0..n {
                    block[i * (n + 1)] += extra[k * n + i];
                    if !free[k * n + i] {
                        (0..n).for_each(|j| {
                            block[i * n + j] = 0.0;
                            block[j * n + i] = 0.0;
                        });
                        block[i * (n + 1)] = 1.0;
                    }
                }
                factor(&mut block, n).then_some(block)
            })
            .collect()
    }
}

/// Cholesky factor in the lower half, in place; false if the matrix is not positive definite.
fn factor(a: &mut [f64], n: usize) -> bool {
    for i in 0..n {
        let (before, row) = a.split_at_mut(i * n);
        for j in 0..i {
            let other = &before[j * n..(j + 1) * n];
            row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
        }
        let rest = row[i] - dot(&row[..i], &row[..i]);
        // False for NaN too.
        if !(rest > 0.0 && rest.is_finite()) {
            return false;
        }
        row[i] = libm::sqrt(rest);
    }
    true
}

/// Solves with the factors, block by block, in place.
fn solve_blocks(factors: &[Vec<f64>], n: usize, x: &mut [f64]) {
    for (l, x) in factors.iter().zip(x.chunks_exact_mut(n)) {
        for i in 0..n {
            x[i] = (x[i] - dot(&l[i * n..i * n + i], &x[..i])) / l[i * (n + 1)];
        }
        for i in (0..n).rev() {
            x[i] /= l[i * (n + 1)];
            let xi = x[i];
            x[..i].iter_mut().zip(&l[i * n..i * n + i]).for_each(|(v, l)| *v -= l * xi);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::Random;

    #[test]
    fn the_solution_solves_and_what_is_not_free_stays() {
        let mut random = Random::new(1);
        let (size, count) = (5, 4);
        let n = size * count;
        let mut m = Blocks::new(size, count);
        for (row, column) in [(0, 0), (1, 0), (1, 1), (2, 1), (2, 2), (3, 0), (3, 3)] {
            let block = m.block(row, column);
            for i in 0..size {
                for j in 0..size {
                    let v = random.uniform() - 0.5;
                    if row != column {
                        block[i * size + j] = v;
                    } else if j <= i {
                        block[i * size + j] = if i == j { 12.0 } else { v };
                        block[j * size + i] = block[i * size + j];
                    }
                }
            }
        }
        m.add_row(vec![(0, 1.0), (7, -2.0), (19, 1.0)]);
        let added: Vec<f64> = (0..n).map(|i| 0.1 * i as f64).collect();
        let free: Vec<bool> = (0..n).map(|i| i != 3 && i != 11).collect();
        let b: Vec<f64> = (0..n).map(|_| random.uniform()).collect();
        let x = m.solve(&added, &free, &b, 1e-13, 200).unwrap();
        let mut product = vec![0.0; n];
        m.times(&x, &mut product);
        for i in 0..n {
            if free[i] {
                assert!((product[i] + added[i] * x[i] - b[i]).abs() < 1e-10, "{i}");
            } else {
                assert_eq!(x[i], 0.0);
            }
        }
        // The diagonal is that of the product with unit vectors.
        for (i, d) in m.diagonal().into_iter().enumerate() {
            let unit: Vec<f64> = (0..n).map(|j| f64::from(u8::from(i == j))).collect();
            m.times(&unit, &mut product);
            assert!((product[i] - d).abs() < 1e-12);
        }
    }

    #[test]
    fn refuses_what_is_not_positive_definite() {
        for bad in [-1.0, 0.0, f64::NAN] {
            let mut m = Blocks::new(1, 1);
            m.block(0, 0)[0] = bad;
            assert!(m.solve(&[0.0], &[true], &[1.0], 1e-3, 5).is_none(), "{bad}");
        }
    }
}
