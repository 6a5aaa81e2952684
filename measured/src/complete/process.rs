//! A Gaussian process through points (Rasmussen and Williams 2006, "Gaussian Processes for Machine Learning").
//!
//! Predictions of left-out points need no new solution, of one and of a group (their section 5.4.2): with the
//! inverse `P` of the matrix, `y - P_gg^-1 (P y)_g`.

use super::kernel::Kernel;
use super::pair::{COORDINATES, ISOTROPIC, OF_SIDES};
use super::points::Point;
use crate::numeric::cholesky::Square;
use crate::numeric::vector;

/// Deviation of a normal distribution over the median of sizes.
const NORMAL_DEVIATION: f64 = 1.4826;

/// Least number on the diagonal of an inverse, below which arithmetic has nothing left.
const LEAST_DIAGONAL: f64 = 1e-12;

/// Points that all others contradict.
pub(super) struct SpokenAgainst {
    /// Each with what all others that are left say of it.
    pub gone: Vec<(usize, [f64; 3])>,
    /// Of every point that is left, its distance above the prediction by the others that are left.
    pub rest: Vec<Option<f64>>,
}

/// The prediction of a point by all others.
pub(super) struct LeftOut {
    /// Distance of the point above it.
    pub above: [f64; 3],
    /// The variance that this is expected to have.
    pub variance: f64,
    /// Usual size of a difference over its deviation, of all points.
    pub usual: f64,
}

/// The part of its points that a process is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    /// How far they are above the model.
    Values,
    /// How far their channels are apart in that; it varies as much as [`Point::hue`] says.
    Hues,
}

impl Of {
    fn weight(self, point: &Point) -> f64 {
        if self == Self::Hues { point.hue } else { 1.0 }
    }

    fn value(self, point: &Point, channel: usize) -> f64 {
        let mean = if self == Self::Hues { point.above.iter().sum::<f64>() / 3.0 } else { 0.0 };
        point.above[channel] - mean
    }
}

/// Factor of the matrix of points with the variance of noise of each; `None` where that is too little for the arithmetic.
pub(super) fn factor(points: &[Point], kernel: Kernel, noise: &[f64], of: Of) -> Option<Square> {
    let at = columns(points);
    let weights: Vec<f64> = points.iter().map(|p| of.weight(p)).collect();
    let mut matrix = Square::zeros(points.len());
    for (i, point) in points.iter().enumerate() {
        let row = &mut matrix.row_mut(i)[..=i];
        kernel.row(&at, &point.at, row);
        row.iter_mut().zip(&weights).for_each(|(v, weight)| *v *= weight * weights[i]);
        row[i] += noise[i];
    }
    matrix.cholesky()
}

/// Coordinates of points, one after the other: those of an isotropic surface, of sides that differ, or all where a turn changes some.
fn columns(points: &[Point]) -> Vec<Vec<f64>> {
    let varies = |from: usize| points.iter().any(|p| p.at[from..].iter().any(|v| *v != 0.0));
    let more = [(OF_SIDES, COORDINATES), (ISOTROPIC, OF_SIDES)];
    let count = more.into_iter().find(|(from, _)| varies(*from)).map_or(ISOTROPIC, |(_, count)| count);
    (0..count).map(|k| points.iter().map(|p| p.at[k]).collect()).collect()
}

/// A process that has seen its points.
pub(super) struct Process {
    kernel: Kernel,
    /// Coordinates of the points.
    at: Vec<Vec<f64>>,
    /// Of every channel, the solution of the points' values.
    solution: [Vec<f64>; 3],
    /// The same times how much each point varies.
    weighed: [Vec<f64>; 3],
    /// The inverse of the factor by columns; empty where nothing is to be left out.
    columns: Square,
}

impl Process {
    /// As [`factor`].
    pub fn new(points: &[Point], kernel: Kernel, noise: &[f64], of: Of) -> Option<Self> {
        Self::with(points, kernel, noise, of, Square::inverse_of_lower)
    }

    /// The same, which says nothing of points that are left out.
    pub fn of_all(points: &[Point], kernel: Kernel, noise: &[f64], of: Of) -> Option<Self> {
        Self::with(points, kernel, noise, of, |_| Square::zeros(0))
    }

    fn with(
        points: &[Point],
        kernel: Kernel,
        noise: &[f64],
        of: Of,
        columns: impl Fn(&Square) -> Square,
    ) -> Option<Self> {
        let factor = factor(points, kernel, noise, of)?;
        let values = |c: usize| points.iter().map(|p| of.value(p, c)).collect::<Vec<f64>>();
        let solution = [0, 1, 2].map(|c| factor.solve(&values(c)));
        let weigh = |c: &Vec<f64>| c.iter().zip(points).map(|(v, p)| v * of.weight(p)).collect();
        let weighed = solution.each_ref().map(weigh);
        Some(Self { kernel, at: self::columns(points), solution, weighed, columns: columns(&factor) })
    }

    /// The prediction at coordinates, with all terms.
    pub fn at(&self, to: &[f64; COORDINATES]) -> [f64; 3] {
        let mut row = vec![0.0; self.at[0].len()];
        self.kernel.row(&self.at, to, &mut row);
        [0, 1, 2].map(|c| vector::dot(&row, &self.weighed[c]))
    }

    /// The distance of every point from the prediction by the others, and its variance.
    pub fn left_out_alone(&self) -> Vec<([f64; 3], f64)> {
        let of = |i: usize| {
            let squared = self.columns.squared(i);
            ([0, 1, 2].map(|c| self.solution[c][i] / squared), 1.0 / squared)
        };
        (0..self.columns.size()).map(of).collect()
    }

    /// Points that all others contradict, one after the other.
    ///
    /// `score` says how strongly, or `None`; the strongest is taken, and the rest is looked at without it, so that one wrong point does
    /// not speak against its neighbours. At most `most` are taken.
    pub fn spoken_against(
        &self,
        most: usize,
        score: impl Fn(usize, &LeftOut) -> Option<f64>,
    ) -> SpokenAgainst {
        let n = self.columns.size();
        let mut solution = self.solution.clone();
        let mut diagonal: Vec<f64> = (0..n).map(|i| self.columns.squared(i)).collect();
        let mut is_out = vec![false; n];
        let mut gone = Vec::new();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        while gone.len() < most {
            let above = |i: usize| [0, 1, 2].map(|c| solution[c][i] / diagonal[i]);
            let mean = |i: usize| above(i).iter().sum::<f64>() / 3.0;
            let left = || (0..n).filter(|&i| !is_out[i]);
            let mut sizes: Vec<f64> = left().map(|i| mean(i).abs() * libm::sqrt(diagonal[i])).collect();
            if sizes.is_empty() {
                break;
            }
            sizes.sort_by(f64::total_cmp);
            let usual = NORMAL_DEVIATION * sizes[sizes.len() / 2];
            let scored = left().filter_map(|i| {
                let out = LeftOut { above: above(i), variance: 1.0 / diagonal[i], usual };
                Some((score(i, &out)?, i))
            });
            let Some((_, i)) = scored.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            gone.push((i, above(i)));
            is_out[i] = true;
            // The row of the inverse of the rest, and its products with all others.
            let mut row = self.columns.row_of_gram(i);
            for other in &rows {
                let share = other[i];
                row.iter_mut().zip(other).for_each(|(v, o)| *v -= share * o);
            }
            let root = libm::sqrt(row[i].max(f64::MIN_POSITIVE));
            row.iter_mut().for_each(|v| *v /= root);
            for channel in &mut solution {
                let share = channel[i] / row[i];
                channel.iter_mut().zip(&row).for_each(|(s, r)| *s -= share * r);
            }
            diagonal.iter_mut().zip(&row).for_each(|(d, r)| *d = (*d - r * r).max(LEAST_DIAGONAL));
            rows.push(row);
        }
        let mean = |i: usize| solution.iter().map(|channel| channel[i]).sum::<f64>() / (3.0 * diagonal[i]);
        let rest = (0..n).map(|i| (!is_out[i]).then(|| mean(i))).collect();
        SpokenAgainst { gone, rest }
    }

    /// How far the points of a group are above what all others say of them; `None` as of [`new`](Self::new).
    pub fn left_out(&self, group: &[usize]) -> Option<Vec<[f64; 3]>> {
        let factor = self.columns.gram(group).cholesky()?;
        let channels = [0, 1, 2]
            .map(|c| factor.solve(&group.iter().map(|&i| self.solution[c][i]).collect::<Vec<f64>>()));
        Some((0..group.len()).map(|n| [channels[0][n], channels[1][n], channels[2][n]]).collect())
    }
}
