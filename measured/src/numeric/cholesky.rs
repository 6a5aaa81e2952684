//! The Cholesky factor of a dense matrix, and its inverse, for Gaussian processes.
//!
//! Both are made of inner products of rows, in tiles that stay in registers. Sums have a fixed order and are fused everywhere, so that
//! every processor gives the same bits.

use super::vector::{self, Operation, Vectors, WIDEST};

/// Rows that are worked on at a time.
const BLOCK: usize = 32;

/// A square matrix by rows, each padded with zeros to whole lanes.
pub struct Square {
    size: usize,
    stride: usize,
    values: Vec<f64>,
}

impl Square {
    /// Zeros.
    pub fn zeros(size: usize) -> Self {
        let stride = size.next_multiple_of(WIDEST);
        Self { size, stride, values: vec![0.0; size * stride] }
    }

    /// Some rows of zeros, as long as a matrix of that size is wide: right sides.
    pub fn rows(count: usize, size: usize) -> Self {
        let stride = size.next_multiple_of(WIDEST);
        Self { size, stride, values: vec![0.0; count * stride] }
    }

    /// Rows and columns.
    pub fn size(&self) -> usize {
        self.size
    }

    /// A row, as long as the matrix is wide.
    pub fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.stride..i * self.stride + self.size]
    }

    /// As [`row`](Self::row).
    pub fn row_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.values[i * self.stride..i * self.stride + self.size]
    }

    /// A row from the beginning of the lanes that hold column `from` up to the end of those that hold `to`.
    fn lanes(&self, i: usize, from: usize, to: usize) -> &[f64] {
        let (from, to) = (from / WIDEST * WIDEST, to.next_multiple_of(WIDEST));
        &self.values[i * self.stride + from..i * self.stride + to]
    }

    /// The factor L of the matrix, `L L^T`, of which the lower triangle is read; `None` if it is not positive definite.
    pub fn cholesky(&self) -> Option<Self> {
        let mut factor = Self::zeros(self.size);
        for first in (0..self.size).step_by(BLOCK) {
            let rows = first..(first + BLOCK).min(self.size);
            for left in (0..=first).step_by(BLOCK) {
                let columns = left..(left + BLOCK).min(self.size);
                let products =
                    products(&factor, &factor, (rows.start, rows.len()), (left, columns.len()), 0..left);
                for i in rows.clone() {
                    for j in columns.start..columns.end.min(i + 1) {
                        let inside: f64 = (left..j).map(|k| factor.row(i)[k] * factor.row(j)[k]).sum();
                        let rest = self.row(i)[j] - products[(i - first) * BLOCK + j - left] - inside;
                        factor.row_mut(i)[j] = if i > j {
                            rest / factor.row(j)[j]
                        } else if rest > 0.0 {
                            libm::sqrt(rest)
                        } else {
                            return None;
                        };
                    }
                }
            }
        }
        Some(factor)
    }

    /// Of a factor L, solves `L L^T x = right`.
    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut x = self.solve_lower(right);
        for i in (0..self.size).rev() {
            let row = self.row(i);
            x[i] /= row[i];
            let at = x[i];
            x[..i].iter_mut().zip(row).for_each(|(x, l)| *x -= l * at);
        }
        x
    }

    /// Of a lower triangle, the inverse by columns: row j of the result is column j.
    pub fn inverse_of_lower(&self) -> Self {
        let mut columns = Self::zeros(self.size);
        for left in (0..self.size).step_by(BLOCK) {
            let many = left..(left + BLOCK).min(self.size);
            for first in (left..self.size).step_by(BLOCK) {
                let rows = first..(first + BLOCK).min(self.size);
                let products = products(self, &columns, (first, rows.len()), (left, many.len()), left..first);
                for j in many.clone() {
                    for i in rows.start.max(j)..rows.end {
                        let inside: f64 = (first.max(j)..i).map(|k| self.row(i)[k] * columns.row(j)[k]).sum();
                        let unit = f64::from(u8::from(i == j));
                        let rest = unit - products[(i - first) * BLOCK + j - left] - inside;
                        columns.row_mut(j)[i] = rest / self.row(i)[i];
                    }
                }
            }
        }
        columns
    }

    /// Of a factor L, solves `L x = right`.
    pub fn solve_lower(&self, right: &[f64]) -> Vec<f64> {
        let mut x = right.to_vec();
        for i in 0..self.size {
            let row = self.row(i);
            x[i] = (x[i] - vector::dot(&row[..i], &x[..i])) / row[i];
        }
        x
    }

    /// Of a factor L, solves `L x = right` for every row of the result of [`rows`](Self::rows).
    pub fn solve_lower_all(&self, right: &mut Self) {
        let count = right.values.len() / right.stride.max(1);
        for first in (0..self.size).step_by(BLOCK) {
            let rows = first..(first + BLOCK).min(self.size);
            for left in (0..count).step_by(BLOCK) {
                let many = left..(left + BLOCK).min(count);
                let products = products(self, right, (first, rows.len()), (left, many.len()), 0..first);
                for j in many {
                    for i in rows.clone() {
                        let known = &right.row(j)[first..i];
                        let inside: f64 = self.row(i)[first..i].iter().zip(known).map(|(l, x)| l * x).sum();
                        let rest = right.row(j)[i] - products[(i - first) * BLOCK + j - left] - inside;
                        right.row_mut(j)[i] = rest / self.row(i)[i];
                    }
                }
            }
        }
    }

    /// Of the inverse of a factor by columns, a row of the inverse of the matrix.
    pub fn row_of_gram(&self, i: usize) -> Vec<f64> {
        let product = |j: usize| {
            let from = i.max(j);
            vector::dot(self.lanes(i, from, self.size), self.lanes(j, from, self.size))
        };
        (0..self.size).map(product).collect()
    }

    /// Of the inverse of a factor by columns, the square of some row, an element of the diagonal of the inverse of the matrix.
    pub fn squared(&self, row: usize) -> f64 {
        vector::dot(self.lanes(row, row, self.size), self.lanes(row, row, self.size))
    }

    /// Of the inverse of a factor by columns, the rows and columns of the inverse of the matrix that are named.
    pub fn gram(&self, rows: &[usize]) -> Self {
        let mut gram = Self::zeros(rows.len());
        for (a, &i) in rows.iter().enumerate() {
            for (b, &j) in rows.iter().enumerate().take(a + 1) {
                let from = i.max(j);
                let product = vector::dot(self.lanes(i, from, self.size), self.lanes(j, from, self.size));
                gram.row_mut(a)[b] = product;
                gram.row_mut(b)[a] = product;
            }
        }
        gram
    }
}

/// Inner products of `rows` (first, count) of one matrix with `columns` of another over a range of their columns that is whole blocks;
/// [row * BLOCK + column].
fn products(
    a: &Square,
    b: &Square,
    rows: (usize, usize),
    columns: (usize, usize),
    over: std::ops::Range<usize>,
) -> Vec<f64> {
    vector::run(Products { a, b, rows, columns, over })
}

struct Products<'a> {
    a: &'a Square,
    b: &'a Square,
    rows: (usize, usize),
    columns: (usize, usize),
    over: std::ops::Range<usize>,
}

impl Operation for Products<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) -> Vec<f64> {
        match V::LANES {
            WIDEST => self.tiles::<V, 4>(vectors),
            4 => self.tiles::<V, 3>(vectors),
            _ => self.tiles::<V, 2>(vectors),
        }
    }
}

impl Products<'_> {
    #[inline(always)]
    fn tiles<V: Vectors, const SIDE: usize>(self, vectors: V) -> Vec<f64> {
        let mut out = vec![0.0; BLOCK * BLOCK];
        if self.over.is_empty() {
            return out;
        }
        let (over, last) = (&self.over, |n: usize| n.saturating_sub(1));
        for i in (0..self.rows.1).step_by(SIDE) {
            for j in (0..self.columns.1).step_by(SIDE) {
                // Beyond the last row, that row is repeated.
                let down: [&[f64]; SIDE] = std::array::from_fn(|n| {
                    self.a.lanes(self.rows.0 + (i + n).min(last(self.rows.1)), over.start, over.end)
                });
                let across: [&[f64]; SIDE] = std::array::from_fn(|n| {
                    self.b.lanes(self.columns.0 + (j + n).min(last(self.columns.1)), over.start, over.end)
                });
                let tile = vectors.tile(down, across);
                for (n, row) in tile.iter().enumerate().take(self.rows.1 - i) {
                    for (m, sums) in row.iter().enumerate().take(self.columns.1 - j) {
                        let [a, b, c, d, e, f, g, h] = *sums;
                        out[(i + n) * BLOCK + j + m] = ((a + e) + (b + f)) + ((c + g) + (d + h));
                    }
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(size: usize) -> Square {
        let mut a = Square::zeros(size);
        for i in 0..size {
            for j in 0..size {
                let apart = (i as f64 - j as f64) / 9.0;
                a.row_mut(i)[j] =
                    libm::exp(-0.5 * apart * apart) + if i == j { 0.01 + 1e-4 * i as f64 } else { 0.0 };
            }
        }
        a
    }

    #[test]
    fn the_factor_and_its_inverse_give_the_matrix_and_its_inverse() {
        for size in [1, 7, 32, 33, 150] {
            let a = matrix(size);
            let factor = a.cholesky().unwrap();
            let columns = factor.inverse_of_lower();
            let mut right = Square::rows(35, size);
            (0..35).for_each(|k| (0..size).for_each(|i| right.row_mut(k)[i] = ((3 * i + k) % 7) as f64));
            let one_by_one: Vec<Vec<f64>> = (0..35).map(|k| factor.solve_lower(right.row(k))).collect();
            factor.solve_lower_all(&mut right);
            for (k, one) in one_by_one.iter().enumerate() {
                assert!(right.row(k).iter().zip(one).all(|(a, b)| (a - b).abs() < 1e-9), "{size} {k}");
            }
            let all: Vec<usize> = (0..size).collect();
            let inverse = columns.gram(&all);
            for i in 0..size {
                for j in 0..size {
                    let product: f64 = (0..size).map(|k| factor.row(i)[k] * factor.row(j)[k]).sum();
                    assert!((product - a.row(i)[j]).abs() < 1e-12, "{size} {i} {j}");
                    let one: f64 = (0..size).map(|k| a.row(i)[k] * inverse.row(k)[j]).sum();
                    assert!((one - f64::from(u8::from(i == j))).abs() < 1e-9, "{size} {i} {j}: {one}");
                }
            }
        }
    }

    #[test]
    fn what_is_not_positive_definite_has_none() {
        let mut a = matrix(40);
        a.row_mut(39)[39] = -1.0;
        assert!(a.cholesky().is_none());
    }
}
