//! The data term of one view: squared differences between lobes and samples, and what Gauss-Newton needs of them.
//!
//! The derivative of a value by an unknown is that of a unit lobe, the same for all channels, times an amplitude. So only
//! the Gram matrix of the derivatives of unit lobes is summed over the samples, once for the three channels.

use crate::model::Lobes;
use crate::vector;
use pulp::NullaryFnOnce;

/// A sample as the fit sees it.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub direction: [f64; 3],
    /// `f cos`.
    pub target: [f64; 3],
    /// Weight of the squared difference of every channel.
    pub weight: f64,
    /// The part of it that makes the relative L2 error.
    pub base: f64,
    /// What the rest is in inverse proportion to, and what is added to the value in that proportion.
    pub tail: f64,
    pub floor: f64,
}

/// Sums over the samples of a view. Derivatives are in the order of [`Lobes::slopes`].
#[derive(Clone, Debug)]
pub(crate) struct Sums {
    /// Sum of the weighted squared differences.
    pub cost: f64,
    /// Products of derivatives of unit lobes; [width * width], lower half.
    pub gram: Vec<f64>,
    /// Products of derivatives of unit lobes with the difference, per channel; [width].
    pub moment: [Vec<f64>; 3],
}

/// Sum of the weighted squared differences. `amplitudes`: per channel, of the lobes and the diffuse term.
pub(crate) fn cost(lobes: &Lobes, amplitudes: &[Vec<f64>; 3], points: &[Point]) -> f64 {
    vector::run(Cost { lobes, amplitudes, points })
}

/// All sums.
pub(crate) fn sums(lobes: &Lobes, amplitudes: &[Vec<f64>; 3], points: &[Point]) -> Sums {
    vector::run(AllSums { lobes, amplitudes, points })
}

struct Cost<'a> {
    lobes: &'a Lobes,
    amplitudes: &'a [Vec<f64>; 3],
    points: &'a [Point],
}

impl NullaryFnOnce for Cost<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let mut unit = vec![0.0; self.lobes.len() + 1];
        let mut cost = 0.0;
        for point in self.points {
            self.lobes.values(&point.direction, &mut unit);
            let mut value = [0.0; 3];
            for (value, amplitudes) in value.iter_mut().zip(self.amplitudes) {
                for (a, u) in amplitudes.iter().zip(&unit) {
                    *value += a * u;
                }
            }
            for (value, target) in value.iter().zip(&point.target) {
                let difference = value - target;
                cost += point.weight * difference * difference;
            }
        }
        cost
    }
}

/// Samples whose products are added in one pass over the Gram matrix.
const ROWS: usize = 4;

struct AllSums<'a> {
    lobes: &'a Lobes,
    amplitudes: &'a [Vec<f64>; 3],
    points: &'a [Point],
}

impl NullaryFnOnce for AllSums<'_> {
    type Output = Sums;

    #[inline(always)]
    fn call(self) -> Sums {
        let k = self.lobes.len();
        let width = self.lobes.slopes_len();
        let mut gram = vec![0.0; width * width];
        let mut moment = [vec![0.0; width], vec![0.0; width], vec![0.0; width]];
        let mut cost = 0.0;
        let mut rows = vec![0.0; ROWS * width];
        for chunk in self.points.chunks(ROWS) {
            // A chunk that is not full has rows of zeros.
            rows[chunk.len() * width..].fill(0.0);
            for (point, row) in chunk.iter().zip(rows.chunks_exact_mut(width)) {
                let root = point.weight.sqrt();
                self.lobes.slopes(&point.direction, root, row);
                for ((amplitudes, target), moment) in
                    self.amplitudes.iter().zip(&point.target).zip(&mut moment)
                {
                    let mut value = amplitudes[k] * row[width - 1];
                    for (a, u) in amplitudes[..k].iter().zip(&row[2 * k..3 * k]) {
                        value += a * u;
                    }
                    let difference = value - root * target;
                    cost += difference * difference;
                    for (m, v) in moment.iter_mut().zip(&*row) {
                        *m += difference * v;
                    }
                }
            }
            let (first, rest) = rows.split_at(width);
            let (second, rest) = rest.split_at(width);
            let (third, fourth) = rest.split_at(width);
            for i in 0..width {
                let [a, b, c, d] = [first[i], second[i], third[i], fourth[i]];
                if a == 0.0 && b == 0.0 && c == 0.0 && d == 0.0 {
                    continue;
                }
                let end = i + 1;
                let out = &mut gram[i * width..i * width + end];
                let rows = first[..end].iter().zip(&second[..end]).zip(&third[..end]).zip(&fourth[..end]);
                for (out, (((v, w), x), y)) in out.iter_mut().zip(rows) {
                    *out += (a * v + b * w) + (c * x + d * y);
                }
            }
        }
        Sums { cost, gram, moment }
    }
}
