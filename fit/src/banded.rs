//! Symmetric positive definite band matrices, and their Cholesky factorisation.
//!
//! Own code because the linear algebra crates have no band matrices: 610 unknowns with 122 off the diagonal on either
//! side, the normal equations of 10 knots with 12 lobes, are 5 million multiply-adds, a twentieth of the dense ones.

use crate::vector;

/// Lower half of a symmetric band matrix.
///
/// Shapes: `n` rows of `band + 1` numbers, the diagonal last.
#[derive(Clone, Debug)]
pub(crate) struct Banded {
    n: usize,
    band: usize,
    rows: Vec<f64>,
}

impl Banded {
    /// The zero matrix of `n` rows with `band` numbers off the diagonal on either side.
    pub fn zeros(n: usize, band: usize) -> Self {
        Self { n, band, rows: vec![0.0; n * (band + 1)] }
    }

    /// Adds to the element in row `i`, column `j`, and to its mirror image, which is the same number. `i >= j`.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        debug_assert!(i >= j && i - j <= self.band);
        self.rows[i * (self.band + 1) + j + self.band - i] += value;
    }

    /// The diagonal, for tests.
    #[cfg(test)]
    pub fn diagonal(&self, i: usize) -> f64 {
        self.rows[i * (self.band + 1) + self.band]
    }

    /// Replaces row and column `i` by those of the unit matrix.
    pub fn isolate(&mut self, i: usize) {
        let stride = self.band + 1;
        self.rows[i * stride..(i + 1) * stride].fill(0.0);
        self.rows[i * stride + self.band] = 1.0;
        for row in i + 1..self.n.min(i + stride) {
            self.rows[row * stride + i + self.band - row] = 0.0;
        }
    }

    /// `v^T A v`, for tests.
    #[cfg(test)]
    pub fn quadratic(&self, v: &[f64]) -> f64 {
        let mut sum = 0.0;
        for i in 0..self.n {
            for j in i.saturating_sub(self.band)..=i {
                let share = if i == j { 1.0 } else { 2.0 };
                sum += share * self.rows[i * (self.band + 1) + j + self.band - i] * v[i] * v[j];
            }
        }
        sum
    }

    /// Factors into `L L^T` in place; false if the matrix is not positive definite.
    pub fn factor(&mut self) -> bool {
        vector::run(Factor(self))
    }

    #[inline(always)]
    fn factor_in_place(&mut self) -> bool {
        let (band, stride) = (self.band, self.band + 1);
        for i in 0..self.n {
            let first = i.saturating_sub(band);
            let (before, row) = self.rows.split_at_mut(i * stride);
            let row = &mut row[..stride];
            for j in first..i {
                let other = &before[j * stride..(j + 1) * stride];
                let from = first.max(j.saturating_sub(band));
                // Columns from..j of rows i and j.
                let a = &row[from + band - i..j + band - i];
                let b = &other[from + band - j..band];
                row[j + band - i] = (row[j + band - i] - dot(a, b)) / other[band];
            }
            let part = &row[first + band - i..band];
            let rest = row[band] - dot(part, part);
            // False for NaN too.
            if !(rest > 0.0 && rest.is_finite()) {
                return false;
            }
            row[band] = libm::sqrt(rest);
        }
        true
    }

    /// Solves `L L^T x = b` in place, after [`factor`](Self::factor).
    pub fn solve(&self, x: &mut [f64]) {
        let (band, stride) = (self.band, self.band + 1);
        for i in 0..self.n {
            let first = i.saturating_sub(band);
            let row = &self.rows[i * stride..(i + 1) * stride];
            x[i] = (x[i] - dot(&row[first + band - i..band], &x[first..i])) / row[band];
        }
        for i in (0..self.n).rev() {
            let first = i.saturating_sub(band);
            let row = &self.rows[i * stride..(i + 1) * stride];
            x[i] /= row[band];
            let xi = x[i];
            for (v, l) in x[first..i].iter_mut().zip(&row[first + band - i..band]) {
                *v -= l * xi;
            }
        }
    }
}

struct Factor<'a>(&'a mut Banded);

impl pulp::NullaryFnOnce for Factor<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        self.0.factor_in_place()
    }
}

/// Inner product in eight running sums, which the compiler may turn into lanes; the order is fixed.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a8.remainder().iter().zip(b8.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a8.zip(b8) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7])) + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Dense Gauss elimination without pivoting: fine for positive definite matrices.
    fn dense_solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
        let n = b.len();
        for k in 0..n {
            let pivot = a[k].clone();
            for i in k + 1..n {
                let f = a[i][k] / pivot[k];
                a[i].iter_mut().zip(&pivot).for_each(|(v, p)| *v -= f * p);
                b[i] -= f * b[k];
            }
        }
        for k in (0..n).rev() {
            b[k] = (b[k] - (k + 1..n).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
        }
        b
    }

    #[test]
    fn agrees_with_a_dense_solver() {
        let mut random = Random::new(1);
        for (n, band) in [(1, 0), (1, 3), (5, 0), (7, 2), (20, 6), (33, 17), (12, 30)] {
            let mut banded = Banded::zeros(n, band);
            let mut dense = vec![vec![0.0; n]; n];
            let inside = |&(i, j): &(usize, usize)| j <= i && i - j <= band;
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(inside) {
                let v = if i == j { 2.0 * band as f64 + 2.0 } else { random.next() - 0.5 };
                banded.add(i, j, v);
                dense[i][j] = v;
                dense[j][i] = v;
            }
            let b: Vec<f64> = (0..n).map(|_| random.next()).collect();
            let mut x = b.clone();
            assert!(banded.factor());
            banded.solve(&mut x);
            for (x, y) in x.iter().zip(dense_solve(dense, b)) {
                assert!((x - y).abs() < 1e-12, "n {n} band {band}: {x} {y}");
            }
        }
    }

    #[test]
    fn refuses_what_is_not_positive_definite() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut m = Banded::zeros(3, 1);
            m.add(0, 0, 1.0);
            m.add(1, 1, bad);
            m.add(2, 2, 1.0);
            assert!(!m.factor(), "{bad}");
        }
    }

    #[test]
    fn an_isolated_unknown_stays_as_it_is() {
        let mut m = Banded::zeros(3, 2);
        for (i, j, v) in [(0, 0, 4.0), (1, 0, 1.0), (1, 1, 3.0), (2, 0, 0.5), (2, 1, 1.0), (2, 2, 5.0)] {
            m.add(i, j, v);
        }
        m.isolate(1);
        assert!(m.factor());
        let mut x = vec![4.5, 7.0, 5.5];
        m.solve(&mut x);
        assert!((x[0] - 1.0).abs() < 1e-12 && x[1] == 7.0 && (x[2] - 1.0).abs() < 1e-12, "{x:?}");
    }
}
