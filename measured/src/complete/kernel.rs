//! The covariance of a Gaussian process.

use super::pair::{COORDINATES, ISOTROPIC, OF_SIDES};
use crate::numeric::vector::{self, Operation, Vectors};

/// How alike points are at a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kernel {
    /// Variance and length of a term of each of the first three coordinates alone.
    pub alone: [(f64, f64); 3],
    /// Variance and lengths of a term of all, Matern's of 5/2.
    pub joint: f64,
    pub lengths: [f64; COORDINATES],
}

impl Kernel {
    /// Of points at `from` with one at `to`, coordinate by coordinate: those of an isotropic surface, or all.
    pub fn row(&self, from: &[Vec<f64>], to: &[f64; COORDINATES], out: &mut [f64]) {
        vector::run(Row { kernel: self, from, to, out });
    }
}

struct Row<'a> {
    kernel: &'a Kernel,
    from: &'a [Vec<f64>],
    to: &'a [f64; COORDINATES],
    out: &'a mut [f64],
}

impl Operation for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        match self.from.len() {
            ISOTROPIC => self.of::<ISOTROPIC>(),
            OF_SIDES => self.of::<OF_SIDES>(),
            _ => self.of::<COORDINATES>(),
        }
    }
}

impl Row<'_> {
    /// With the first coordinates, that number of them.
    #[inline(always)]
    fn of<const OF: usize>(self) {
        let Self { kernel, from, to, out } = self;
        let weights = kernel.lengths.map(|l| 5.0 / (l * l));
        let len = out.len();
        let from: [&[f64]; OF] = std::array::from_fn(|k| &from[k][..len]);
        for n in 0..len {
            let mut r2 = 0.0f64;
            for k in 0..OF {
                let d = from[k][n] - to[k];
                r2 = vector::fused(weights[k] * d, d, r2);
            }
            let r = r2.sqrt();
            out[n] = kernel.joint * vector::fused(r2, 1.0 / 3.0, 1.0 + r) * vector::exp(-r);
        }
        for k in 0..3 {
            let (variance, length) = kernel.alone[k];
            if variance > 0.0 {
                let weight = -0.5 / (length * length);
                for n in 0..len {
                    let d = from[k][n] - to[k];
                    out[n] = vector::fused(variance, vector::exp(weight * d * d), out[n]);
                }
            }
        }
    }
}
