//! L-BFGS-B of the crate `basin`, a port of Nocedal's (the thesis's reference 23), on a function with its gradient.

use basin::{BoxBounds, ConstraintDescription, ConstraintSet, Constraints};
use basin::{CostFunction, Executor, FirstOrderState, Gradient, Lbfgsb};
use std::cell::Cell;
use std::convert::Infallible;

/// Relative decrease in one step below which a minimum counts as reached.
const REACHED: f64 = 1e-7;

struct Problem<'a, F> {
    lower: Vec<f64>,
    upper: Vec<f64>,
    function: F,
    evaluations: &'a Cell<usize>,
}

/// Moves `x` to a smaller value of a function within bounds, in at most `steps` steps; returns the evaluations.
///
/// The function takes a point and writes its gradient. Where it has no finite value, `x` stays.
pub(crate) fn minimize(
    x: &mut Vec<f64>,
    lower: &[f64],
    upper: &[f64],
    steps: u64,
    function: impl Fn(&[f64], &mut [f64]) -> f64,
) -> usize {
    let evaluations = Cell::new(0);
    let problem =
        Problem { lower: lower.to_vec(), upper: upper.to_vec(), function, evaluations: &evaluations };
    let solver = Lbfgsb::new().with_relative_cost_reduction_tolerance(REACHED);
    let start = FirstOrderState::new(x.clone());
    // Bounds that contradict each other are an error; where no value is a finite number there is no best point. The start stays.
    let found = Executor::new(problem, solver, start).max_iter(steps).run();
    if let Some(result) = found.ok().filter(|result| result.best_cost().is_finite()) {
        x.clone_from(result.best_param());
    }
    // Rounding may leave a bound by an ulp.
    x.iter_mut().zip(lower.iter().zip(upper)).for_each(|(x, (l, u))| *x = x.clamp(*l, *u));
    evaluations.get()
}

impl<F> Constraints for Problem<'_, F> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;
    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
    }
}

impl<F: Fn(&[f64], &mut [f64]) -> f64> CostFunction for Problem<'_, F> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Infallible;
    fn cost(&self, x: &Vec<f64>) -> Result<f64, Infallible> {
        self.cost_and_gradient(x).map(|both| both.0)
    }
}

impl<F: Fn(&[f64], &mut [f64]) -> f64> Gradient for Problem<'_, F> {
    type Gradient = Vec<f64>;
    fn gradient(&self, x: &Vec<f64>) -> Result<Vec<f64>, Infallible> {
        self.cost_and_gradient(x).map(|both| both.1)
    }
    fn cost_and_gradient(&self, x: &Vec<f64>) -> Result<(f64, Vec<f64>), Infallible> {
        self.evaluations.set(self.evaluations.get() + 1);
        let mut gradient = vec![0.0; x.len()];
        let cost = (self.function)(x, &mut gradient);
        Ok((cost, gradient))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rosenbrock_in_a_box_ends_at_its_edge() {
        let function = |x: &[f64], g: &mut [f64]| {
            let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
            g[0] = -2.0 * a - 400.0 * x[0] * b;
            g[1] = 200.0 * b;
            a * a + 100.0 * b * b
        };
        let mut x = vec![-1.2, 1.0];
        let evaluations = minimize(&mut x, &[-2.0; 2], &[2.0; 2], 500, function);
        assert!(
            (x[0] - 1.0).abs() < 1e-3 && (x[1] - 1.0).abs() < 2e-3 && evaluations > 10,
            "{x:?} {evaluations}"
        );
        let mut x = vec![-1.2, 0.4];
        minimize(&mut x, &[-2.0; 2], &[0.5; 2], 500, function);
        assert!((x[0] - 0.5).abs() < 1e-3 && (x[1] - 0.25).abs() < 1e-3, "{x:?}");
    }

    #[test]
    fn the_start_stays_where_no_value_is_finite() {
        for value in [f64::NAN, f64::INFINITY] {
            let mut x = vec![0.3, 0.4];
            minimize(&mut x, &[0.0; 2], &[1.0; 2], 10, |_, gradient| {
                gradient.fill(value);
                value
            });
            assert_eq!(x, [0.3, 0.4]);
        }
    }
}
