//! Levenberg-Marquardt with bounds.
//!
//! Marquardt's scaling: the damping is relative to the diagonal, so that unknowns of different kinds need no common unit.
//! The damping follows the ratio of achieved to predicted decrease (Nielsen 1999). Unknowns at a bound, with the descent
//! pointing outwards, are left out of a step. A step that is too long is made shorter as a whole: cutting single unknowns
//! breaks the compensation between overlapping lobes (garnet red then ends at 1.9 % in place of 1.6 %).
//!
//! Tried without gain: geodesic acceleration (Transtrum and Sethna 2012).

/// Damping of the first step.
const FIRST_DAMPING: f64 = 0.1;

/// Damping at which no step helps any more.
const MOST_DAMPING: f64 = 1e12;

/// Accepted steps over which a gain is looked for.
const LOOKED_BACK: usize = 5;

/// A sum of squares of which the minimum within bounds is sought.
pub trait LeastSquares {
    /// Largest change of an unknown in one step, in its unit: beyond it the linearisation of an exponential says nothing.
    const LONGEST_STEP: f64;
    /// The sum linearised at a point.
    type Linear: Linear;

    /// Least and greatest value of an unknown, the same for one that is given; the least is never above the greatest.
    fn bounds(&self, unknown: usize) -> (f64, f64);
    /// A change of an unknown that is as long as one of 1 of most.
    fn unit(&self, _unknown: usize) -> f64 {
        1.0
    }
    /// Damping of an unknown that nothing depends on (a lobe that has faded), over the cost.
    fn faint(&self, _unknown: usize) -> f64 {
        1e-10
    }
    fn cost(&self, x: &[f64]) -> f64;
    fn linearize(&self, x: &[f64]) -> Self::Linear;
    /// [`linearize`](Self::linearize) in the memory of one that is not needed any more.
    fn linearize_in(&self, x: &[f64], memory: Self::Linear) -> Self::Linear {
        drop(memory);
        self.linearize(x)
    }
}

/// A sum of squares linearised at a point.
pub trait Linear {
    /// The sum itself.
    fn cost(&self) -> f64;
    /// Half of the gradient.
    fn gradient(&self) -> &[f64];
    /// The diagonal that damping is relative to.
    fn scale(&self) -> Vec<f64>;
    /// Solves `(matrix + diagonal added) step = -gradient` for the unknowns that are free, others staying; `None` if it cannot be solved.
    fn step(&mut self, added: &[f64], free: &[bool]) -> Option<Vec<f64>>;
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Steps tried.
    pub steps: usize,
    /// Relative decrease of the cost over five accepted steps below which the minimum counts as reached.
    pub improvement: f64,
}

/// Why a solver ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It gained too little.
    Converged,
    /// It had made all its steps.
    Steps,
}

/// Moves `x` downhill; returns the cost reached and why it ended. Calls `tick` after every step tried.
pub fn minimize<P: LeastSquares>(
    problem: &P,
    x: &mut Vec<f64>,
    limits: Limits,
    mut tick: impl FnMut(),
) -> (f64, Ending) {
    let clamp = |x: &mut [f64]| {
        for (i, v) in x.iter_mut().enumerate() {
            let (low, high) = problem.bounds(i);
            debug_assert!(low <= high, "{i}: {low} {high}");
            // Not `clamp`: NaN becomes the least.
            *v = v.max(low).min(high);
        }
    };
    clamp(x);

    let (mut damping, mut growth) = (FIRST_DAMPING, 2.0);
    let mut at = problem.linearize(x);
    let mut history = vec![at.cost()];
    for _ in 0..limits.steps {
        tick();
        let free: Vec<bool> = (0..x.len())
            .map(|i| {
                let ((low, high), g) = (problem.bounds(i), at.gradient()[i]);
                !((x[i] <= low && g > 0.0) || (x[i] >= high && g < 0.0) || low >= high)
            })
            .collect();
        let least = at.cost().max(1e-12);
        let added: Vec<f64> =
            at.scale().iter().enumerate().map(|(i, d)| damping * d + problem.faint(i) * least).collect();
        let mut tried = None;
        if let Some(mut delta) = at.step(&added, &free) {
            let length = |(i, d): (usize, &f64)| d.abs() / problem.unit(i);
            let longest = delta.iter().enumerate().map(length).fold(0.0, f64::max);
            if longest > P::LONGEST_STEP {
                delta.iter_mut().for_each(|d| *d *= P::LONGEST_STEP / longest);
            }
            let mut moved: Vec<f64> = x.iter().zip(&delta).map(|(x, d)| x + d).collect();
            clamp(&mut moved);
            let cost = problem.cost(&moved);
            // Decrease that the damped model promises for the step as solved.
            let promise = |i: usize| delta[i] * (added[i] * delta[i] - at.gradient()[i]);
            let promised = (0..x.len()).map(promise).sum::<f64>().max(f64::MIN_POSITIVE);
            if cost < at.cost() {
                tried = Some((moved, ((at.cost() - cost) / promised).min(1.0)));
            }
        }
        if let Some((moved, ratio)) = tried {
            let cube = 2.0 * ratio - 1.0;
            damping = (damping * (1.0 - cube * cube * cube).max(1.0 / 3.0)).max(1e-9);
            growth = 2.0;
            *x = moved;
            at = problem.linearize_in(x, at);
            history.push(at.cost());
            let n = history.len();
            if n > LOOKED_BACK && history[n - 1 - LOOKED_BACK] - at.cost() < limits.improvement * at.cost() {
                return (at.cost(), Ending::Converged);
            }
        } else {
            damping *= growth;
            growth *= 2.0;
            if damping > MOST_DAMPING {
                return (at.cost(), Ending::Converged);
            }
        }
    }
    (at.cost(), Ending::Steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley, as two squares.
    struct Valley {
        most: f64,
    }

    struct At {
        residuals: [f64; 2],
        rows: [[f64; 2]; 2],
        gradient: [f64; 2],
    }

    impl Linear for At {
        fn cost(&self) -> f64 {
            self.residuals.iter().map(|r| r * r).sum()
        }
        fn gradient(&self) -> &[f64] {
            &self.gradient
        }
        fn scale(&self) -> Vec<f64> {
            (0..2).map(|i| self.rows.iter().map(|row| row[i] * row[i]).sum()).collect()
        }
        fn step(&mut self, added: &[f64], free: &[bool]) -> Option<Vec<f64>> {
            let at = |i: usize, j: usize| self.rows.iter().map(|row| row[i] * row[j]).sum::<f64>();
            let (a, b, d) = (at(0, 0) + added[0], at(0, 1), at(1, 1) + added[1]);
            let g = self.gradient;
            Some(match (free[0], free[1]) {
                (true, true) => {
                    let det = a * d - b * b;
                    vec![(b * g[1] - d * g[0]) / det, (b * g[0] - a * g[1]) / det]
                }
                (first, second) => {
                    vec![if first { -g[0] / a } else { 0.0 }, if second { -g[1] / d } else { 0.0 }]
                }
            })
        }
    }

    impl LeastSquares for Valley {
        const LONGEST_STEP: f64 = 3.0;
        type Linear = At;
        fn bounds(&self, unknown: usize) -> (f64, f64) {
            (-5.0, if unknown == 1 { self.most } else { 5.0 })
        }
        fn cost(&self, x: &[f64]) -> f64 {
            self.linearize(x).cost()
        }
        fn linearize(&self, x: &[f64]) -> At {
            let residuals = [10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]];
            let rows = [[-20.0 * x[0], 10.0], [-1.0, 0.0]];
            let gradient = [0, 1].map(|i| (0..2).map(|r| rows[r][i] * residuals[r]).sum());
            At { residuals, rows, gradient }
        }
    }

    #[test]
    fn a_bent_valley_is_followed_to_its_end_or_to_the_bound() {
        let limits = Limits { steps: 200, improvement: 1e-12 };
        let mut x = vec![-1.2, 1.0];
        let (cost, _) = minimize(&Valley { most: 5.0 }, &mut x, limits, || {});
        assert!(cost < 1e-12 && (x[0] - 1.0).abs() < 1e-5 && (x[1] - 1.0).abs() < 1e-5, "{x:?} {cost}");
        let mut x = vec![-1.2, 0.3];
        minimize(&Valley { most: 0.5 }, &mut x, limits, || {});
        assert!(x[1] == 0.5 && (x[0] - 0.708_56).abs() < 1e-4, "{x:?}");
        let mut x = vec![0.0, 0.0];
        assert_eq!(
            minimize(&Valley { most: 5.0 }, &mut x, Limits { steps: 1, improvement: 0.0 }, || {}).1,
            Ending::Steps
        );
    }
}
