//! Symmetric positive definite band matrices, and their Cholesky factorisation.
//!
//! Own code because the linear algebra crates have no band matrices: 1000 unknowns with 128 off the diagonal on either
//! side, the normal equations of 16 stored views with 12 lobes, are 8 million multiply-adds, a twentieth of the dense ones.

use crate::numeric::vector::{self, Operation, Vectors};

/// Upper half of a symmetric band matrix.
///
/// Shapes: `n` rows, filled up to a multiple of [`WIDE`], of `width` chunks, the first the one with the diagonal; elements past
/// the band or past column `n` are 0.
#[derive(Debug)]
pub(crate) struct Banded {
    n: usize,
    band: usize,
    width: usize,
    rows: Vec<Chunk>,
}

/// Numbers side by side, as in the widest registers, and rows that are taken at a time.
const WIDE: usize = 8;

/// Numbers of a row, the first in a column that is a multiple of [`WIDE`]: what stands in the same columns of two rows can be
/// loaded at once from both.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Chunk([f64; WIDE]);

impl Clone for Banded {
    fn clone(&self) -> Self {
        Self { rows: self.rows.clone(), ..*self }
    }
    /// In the memory that is there.
    fn clone_from(&mut self, source: &Self) {
        (self.n, self.band, self.width) = (source.n, source.band, source.width);
        self.rows.clone_from(&source.rows);
    }
}

impl Banded {
    /// The zero matrix of `n` rows with `band` numbers off the diagonal on either side.
    pub fn zeros(n: usize, band: usize) -> Self {
        let width = band.div_ceil(WIDE) + 1;
        Self { n, band, width, rows: vec![ZERO; n.next_multiple_of(WIDE) * width] }
    }

    /// The zero matrix again.
    pub fn clear(&mut self) {
        self.rows.fill(ZERO);
    }

    /// Chunk of the element in row `i`, column `j`, which is also that in row `j`, column `i`, and its place there. `i >= j`.
    #[inline(always)]
    fn place(&self, i: usize, j: usize) -> (usize, usize) {
        debug_assert!(i >= j && i - j <= self.band && i < self.n);
        (j * self.width + i / WIDE - j / WIDE, i % WIDE)
    }

    /// Adds to the element in row `i`, column `j`, and to its mirror image, which is the same number. `i >= j`.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let (chunk, n) = self.place(i, j);
        self.rows[chunk].0[n] += value;
    }

    /// [`add`](Self::add) of a factor times the numbers of a symmetric square matrix, of which the first is added to row `i`, column `j`;
    /// on the diagonal its lower half.
    pub fn add_block(&mut self, i: usize, j: usize, factor: f64, block: &[f64], size: usize) {
        vector::run(AddBlock { matrix: self, at: (i, j), factor, block, size });
    }

    /// [`add`](Self::add) of a factor times numbers to those in column `j` from row `i` on.
    #[inline(always)]
    fn add_run(&mut self, i: usize, j: usize, factor: f64, values: &[f64]) {
        debug_assert!(i - j + values.len() <= self.band + 1 && i + values.len() <= self.n);
        let (chunk, n) = self.place(i, j);
        let (first, rest) = values.split_at((WIDE - n).min(values.len()));
        let (first_chunk, chunks) = self.rows[chunk..].split_at_mut(1);
        first_chunk[0].0[n..].iter_mut().zip(first).for_each(|(v, add)| *v += factor * add);
        let (whole, last) = rest.as_chunks::<WIDE>();
        for (chunk, values) in chunks.iter_mut().zip(whole) {
            let mut sum = chunk.0;
            (0..WIDE).for_each(|n| sum[n] += factor * values[n]);
            chunk.0 = sum;
        }
        if let Some(chunk) = chunks.get_mut(whole.len()) {
            chunk.0.iter_mut().zip(last).for_each(|(v, add)| *v += factor * add);
        }
    }

    /// Replaces row and column `i` by those of the unit matrix.
    pub fn isolate(&mut self, i: usize) {
        self.rows[i * self.width..(i + 1) * self.width].fill(ZERO);
        for j in i.saturating_sub(self.band)..=i {
            let (chunk, n) = self.place(i, j);
            self.rows[chunk].0[n] = if i == j { 1.0 } else { 0.0 };
        }
    }

    /// Factors into `U^T U` in place, with the inverses of the diagonal of U; false if the matrix is not positive definite.
    pub fn factor(&mut self) -> bool {
        // The rows that fill up are those of the unit matrix.
        for i in self.n..self.rows.len() / self.width {
            self.rows[i * self.width].0[i % WIDE] = 1.0;
        }
        vector::run(Factor(self))
    }

    /// A block of rows after the other. Each first loses its products with the pivots before it, a number of rows at a time whose sums
    /// stay in registers.
    #[inline(always)]
    fn factor_in_place<const AT_A_TIME: usize>(&mut self) -> bool {
        let width = self.width;
        let blocks = self.rows.len() / (WIDE * width);
        for block in 0..blocks {
            let (before, after) = self.rows.split_at_mut(block * WIDE * width);
            let own = &mut after[..WIDE * width];
            let chunks = width.min(blocks - block);
            for chunk in 0..chunks {
                let reach = (width - 1 - chunk).min(block);
                let before = &before[(block - reach) * WIDE * width..];
                for first in (0..WIDE).step_by(AT_A_TIME) {
                    let mut sums = [ZERO; AT_A_TIME];
                    for n in 0..AT_A_TIME {
                        sums[n] = own[(first + n) * width + chunk];
                    }
                    for (done, rows) in before.chunks_exact(WIDE * width).enumerate() {
                        let at = reach - done;
                        for row in rows.chunks_exact(width) {
                            for (sum, factor) in sums.iter_mut().zip(&row[at].0[first..]) {
                                sum.subtract(*factor, &row[at + chunk]);
                            }
                        }
                    }
                    for n in 0..AT_A_TIME {
                        own[(first + n) * width + chunk] = sums[n];
                    }
                }
            }
            if !factor_block(own, width, chunks) {
                return false;
            }
        }
        true
    }

    /// Solves `U^T U x = b` in place, after [`factor`](Self::factor).
    pub fn solve(&self, x: &mut [f64]) {
        vector::run(Solve(self, x));
    }

    #[inline(always)]
    fn solve_in_place(&self, b: &mut [f64]) {
        let mut x = vec![ZERO; self.n.div_ceil(WIDE)];
        for (x, b) in x.iter_mut().zip(b.chunks(WIDE)) {
            x.0[..b.len()].copy_from_slice(b);
        }
        let rows = || self.rows.chunks_exact(self.width).enumerate().take(self.n);
        for (i, row) in rows() {
            let (block, n) = (i / WIDE, i % WIDE);
            let value = x[block].0[n] * row[0].0[n];
            x[block..].iter_mut().zip(row).for_each(|(x, u)| x.subtract(value, u));
            x[block].0[n] = value;
        }
        for (i, row) in rows().rev() {
            let (block, n) = (i / WIDE, i % WIDE);
            let mut sums = ZERO;
            let value = std::mem::take(&mut x[block].0[n]);
            for (x, u) in x[block..].iter().zip(row) {
                (0..WIDE).for_each(|n| sums.0[n] = vector::fused(x.0[n], u.0[n], sums.0[n]));
            }
            let [a, b, c, d, e, f, g, h] = sums.0;
            x[block].0[n] = (value - (((a + e) + (c + g)) + ((b + f) + (d + h)))) * row[0].0[n];
        }
        for (x, b) in x.iter().zip(b.chunks_mut(WIDE)) {
            b.copy_from_slice(&x.0[..b.len()]);
        }
    }
}

const ZERO: Chunk = Chunk([0.0; WIDE]);

impl Chunk {
    /// Less a factor times another.
    #[inline(always)]
    fn subtract(&mut self, factor: f64, other: &Self) {
        for n in 0..WIDE {
            self.0[n] = vector::fused(-factor, other.0[n], self.0[n]);
        }
    }
}

/// Factors rows that only depend on each other any more; false if a pivot is not positive.
#[inline(always)]
fn factor_block(own: &mut [Chunk], width: usize, chunks: usize) -> bool {
    let (mut pivots, mut inverse) = ([ZERO; WIDE], [0.0; WIDE]);
    for k in 0..WIDE {
        let mut row = own[k * width];
        for pivot in &pivots[..k] {
            row.subtract(pivot.0[k], pivot);
        }
        let pivot = row.0[k];
        // False for NaN too.
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        let root = libm::sqrt(pivot);
        inverse[k] = 1.0 / root;
        for n in 0..WIDE {
            row.0[n] = if n > k { row.0[n] * inverse[k] } else { 0.0 };
        }
        // Solutions are divided by the root, and sums leave it out.
        row.0[k] = inverse[k];
        pivots[k] = row;
        own[k * width] = row;
    }
    for chunk in 1..chunks {
        let mut rows = [ZERO; WIDE];
        for k in 0..WIDE {
            let mut row = own[k * width + chunk];
            for (pivot, above) in pivots.iter().zip(&rows[..k]) {
                row.subtract(pivot.0[k], above);
            }
            (0..WIDE).for_each(|n| row.0[n] *= inverse[k]);
            rows[k] = row;
            own[k * width + chunk] = row;
        }
    }
    true
}

struct Factor<'a>(&'a mut Banded);

impl Operation for Factor<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> bool {
        // The sums of eight rows are all the registers that AVX2 has.
        if V::LANES == WIDE { self.0.factor_in_place::<WIDE>() } else { self.0.factor_in_place::<4>() }
    }
}

struct AddBlock<'a> {
    matrix: &'a mut Banded,
    at: (usize, usize),
    factor: f64,
    block: &'a [f64],
    size: usize,
}

impl Operation for AddBlock<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        let Self { matrix, at: (i, j), factor, block, size } = self;
        for (n, row) in block.chunks_exact(size).enumerate() {
            let start = if i == j { n } else { 0 };
            matrix.add_run(i + start, j + n, factor, &row[start..]);
        }
    }
}

struct Solve<'a>(&'a Banded, &'a mut [f64]);

impl Operation for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        self.0.solve_in_place(self.1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::Random;

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
                let v = if i == j { 2.0 * band as f64 + 2.0 } else { random.uniform() - 0.5 };
                banded.add(i, j, v);
                dense[i][j] = v;
                dense[j][i] = v;
            }
            let b: Vec<f64> = (0..n).map(|_| random.uniform()).collect();
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
