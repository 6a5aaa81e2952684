//! Symmetric positive definite band matrices, and their Cholesky factorisation.
//!
//! Own code because the linear algebra crates have no band matrices: 640 unknowns with 128 off the diagonal on either
//! side, the normal equations of 10 knots with 12 lobes, are 5 million multiply-adds, a ninth of the dense ones.

use crate::vector;

/// Upper half of a symmetric band matrix.
///
/// Shapes: `n` rows of `band + 1` numbers, from the diagonal on; what lies past column `n` is 0.
#[derive(Clone, Debug)]
pub(crate) struct Banded {
    n: usize,
    band: usize,
    rows: Vec<f64>,
}

/// Pivots that are taken at a time.
const BLOCK: usize = 4;

impl Banded {
    /// The zero matrix of `n` rows with `band` numbers off the diagonal on either side.
    pub fn zeros(n: usize, band: usize) -> Self {
        Self { n, band, rows: vec![0.0; n * (band + 1)] }
    }

    /// Adds to the element in row `i`, column `j`, and to its mirror image, which is the same number. `i >= j`.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        debug_assert!(i >= j && i - j <= self.band);
        self.rows[j * (self.band + 1) + i - j] += value;
    }

    /// [`add`](Self::add) of a factor times numbers to those in column `j` from row `i` on.
    #[inline]
    pub fn add_run(&mut self, i: usize, j: usize, factor: f64, values: &[f64]) {
        debug_assert!(i >= j && i - j + values.len() <= self.band + 1);
        let first = j * (self.band + 1) + i - j;
        self.rows[first..first + values.len()].iter_mut().zip(values).for_each(|(v, add)| *v += factor * add);
    }

    /// The diagonal, for tests.
    #[cfg(test)]
    pub fn diagonal(&self, i: usize) -> f64 {
        self.rows[i * (self.band + 1)]
    }

    /// Replaces row and column `i` by those of the unit matrix.
    pub fn isolate(&mut self, i: usize) {
        let stride = self.band + 1;
        self.rows[i * stride..(i + 1) * stride].fill(0.0);
        self.rows[i * stride] = 1.0;
        for row in i.saturating_sub(self.band)..i {
            self.rows[row * stride + i - row] = 0.0;
        }
    }

    /// `v^T A v`, for tests.
    #[cfg(test)]
    pub fn quadratic(&self, v: &[f64]) -> f64 {
        let mut sum = 0.0;
        for i in 0..self.n {
            for j in i.saturating_sub(self.band)..=i {
                let share = if i == j { 1.0 } else { 2.0 };
                sum += share * self.rows[j * (self.band + 1) + i - j] * v[i] * v[j];
            }
        }
        sum
    }

    /// Factors into `U^T U` in place; false if the matrix is not positive definite.
    pub fn factor(&mut self) -> bool {
        vector::run(Factor(self))
    }

    /// Takes a few pivots at a time, so that a number of the rest is read and written once for all of them.
    #[inline(always)]
    fn factor_in_place(&mut self) -> bool {
        let (n, stride) = (self.n, self.band + 1);
        for start in (0..n).step_by(BLOCK) {
            let end = (start + BLOCK).min(n);
            for k in start..end {
                let (before, after) = self.rows.split_at_mut(k * stride);
                let row = &mut after[..stride];
                for pivot in start.max((k + 1).saturating_sub(stride))..k {
                    let part = &before[pivot * stride + k - pivot..(pivot + 1) * stride];
                    let factor = part[0];
                    row.iter_mut().zip(part).for_each(|(v, u)| *v = (-factor).mul_add(*u, *v));
                }
                // False for NaN too.
                if !(row[0] > 0.0 && row[0].is_finite()) {
                    return false;
                }
                let root = libm::sqrt(row[0]);
                let inverse = 1.0 / root;
                row[0] = root;
                row[1..].iter_mut().for_each(|v| *v *= inverse);
            }
            let (before, after) = self.rows.split_at_mut(end * stride);
            for (i, row) in after.chunks_exact_mut(stride).enumerate().take(self.band) {
                // Column end + i of every pivot's row, and what is right of it.
                let mut parts: [&[f64]; BLOCK] = [&[]; BLOCK];
                for (pivot, part) in (start..end).zip(&mut parts) {
                    let from = (end + i - pivot).min(stride);
                    *part = &before[pivot * stride + from..(pivot + 1) * stride];
                }
                let [a, b, c, d] = parts;
                let [fa, fb, fc, fd] = parts.map(|part| part.first().copied().unwrap_or(0.0));
                let common = a.len();
                if common > 0 && end - start == BLOCK {
                    let all = a.iter().zip(&b[..common]).zip(&c[..common]).zip(&d[..common]);
                    for (v, (((a, b), c), d)) in row[..common].iter_mut().zip(all) {
                        *v = (-fa).mul_add(*a, (-fb).mul_add(*b, (-fc).mul_add(*c, (-fd).mul_add(*d, *v))));
                    }
                    for (part, factor) in [(b, fb), (c, fc), (d, fd)] {
                        let rest = row[common..].iter_mut().zip(&part[common..]);
                        rest.for_each(|(v, u)| *v -= factor * u);
                    }
                } else {
                    for (part, factor) in [(a, fa), (b, fb), (c, fc), (d, fd)] {
                        row.iter_mut().zip(part).for_each(|(v, u)| *v -= factor * u);
                    }
                }
            }
        }
        true
    }

    /// Solves `U^T U x = b` in place, after [`factor`](Self::factor).
    pub fn solve(&self, x: &mut [f64]) {
        let rows = || self.rows.chunks_exact(self.band + 1).enumerate();
        for (i, row) in rows() {
            x[i] /= row[0];
            let xi = x[i];
            x[i + 1..].iter_mut().zip(&row[1..]).for_each(|(v, u)| *v -= u * xi);
        }
        for (i, row) in rows().rev() {
            let len = self.band.min(self.n - 1 - i);
            x[i] = (x[i] - dot(&row[1..=len], &x[i + 1..=i + len])) / row[0];
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
