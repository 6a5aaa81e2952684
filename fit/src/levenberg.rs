//! Levenberg-Marquardt with bounds, on banded normal equations.
//!
//! Marquardt's scaling: the damping is relative to the diagonal, so that unknowns of different kinds need no common unit.
//! The damping follows the ratio of achieved to predicted decrease (Nielsen 1999). Unknowns at a bound, with the descent
//! pointing outwards, are left out of a step.

use crate::objective::Objective;

/// Largest change of an unknown in one step: beyond it the linearisation of an exponential says nothing.
const LONGEST_STEP: f64 = 1.5;

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Steps tried.
    pub steps: usize,
    /// Relative decrease of the cost over five accepted steps below which the minimum counts as reached.
    pub improvement: f64,
    /// Weight of the roughness.
    pub smoothness: f64,
}

/// What was reached.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reached {
    pub cost: f64,
    pub steps: usize,
}

/// Moves `x` downhill.
pub(crate) fn minimize(objective: &Objective, x: &mut Vec<f64>, limits: Limits) -> Reached {
    let layout = &objective.layout;
    let p = layout.stride();
    let clamp = |x: &mut [f64]| {
        for (i, v) in x.iter_mut().enumerate() {
            let (low, high) = layout.bounds(i % p);
            *v = if layout.fixed(i / p, i % p) { 0.0 } else { v.clamp(low, high) };
        }
    };
    clamp(x);

    let (mut damping, mut growth) = (1e-3, 2.0);
    let mut at = objective.linearize(x, limits.smoothness);
    let mut history = vec![at.cost];
    for step in 0..limits.steps {
        let free = |i: usize| {
            let (low, high) = layout.bounds(i % p);
            let outward = (x[i] <= low && at.gradient[i] > 0.0) || (x[i] >= high && at.gradient[i] < 0.0);
            !layout.fixed(i / p, i % p) && !outward
        };
        let mut matrix = at.matrix.clone();
        let mut delta: Vec<f64> = at.gradient.iter().map(|g| -g).collect();
        // An unknown that nothing depends on (a lobe that has faded) is damped as if it mattered a little.
        let least = 1e-10 * at.cost.max(1e-12);
        for i in 0..x.len() {
            if free(i) {
                matrix.add(i, i, damping * matrix.diagonal(i) + least);
            } else {
                matrix.isolate(i);
                delta[i] = 0.0;
            }
        }
        if !matrix.factor() {
            damping = (damping * 10.0).max(1e-6);
            if damping > 1e12 {
                return Reached { cost: at.cost, steps: step };
            }
            continue;
        }
        matrix.solve(&mut delta);
        delta.iter_mut().for_each(|d| *d = d.clamp(-LONGEST_STEP, LONGEST_STEP));

        let mut moved: Vec<f64> = x.iter().zip(&delta).map(|(x, d)| x + d).collect();
        clamp(&mut moved);
        let cost = objective.cost(&moved, limits.smoothness);
        // Decrease that the damped model promises for the step as solved.
        let promised: f64 = (0..x.len())
            .map(|i| delta[i] * (damping * at.matrix.diagonal(i) * delta[i] - at.gradient[i]))
            .sum::<f64>()
            .max(f64::MIN_POSITIVE);
        if cost < at.cost {
            let ratio = ((at.cost - cost) / promised).min(1.0);
            let cube = 2.0 * ratio - 1.0;
            damping = (damping * (1.0 - cube * cube * cube).max(1.0 / 3.0)).max(1e-9);
            growth = 2.0;
            *x = moved;
            at = objective.linearize(x, limits.smoothness);
            history.push(at.cost);
            let n = history.len();
            if n > 5 && history[n - 6] - at.cost < limits.improvement * at.cost {
                return Reached { cost: at.cost, steps: step + 1 };
            }
        } else {
            damping *= growth;
            growth *= 2.0;
            if !(damping < 1e12) {
                return Reached { cost: at.cost, steps: step + 1 };
            }
        }
    }
    Reached { cost: at.cost, steps: limits.steps }
}
