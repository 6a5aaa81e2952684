//! Levenberg-Marquardt with bounds, on banded normal equations.
//!
//! Marquardt's scaling: the damping is relative to the diagonal, so that unknowns of different kinds need no common unit.
//! The damping follows the ratio of achieved to predicted decrease (Nielsen 1999). Unknowns at a bound, with the descent
//! pointing outwards, are left out of a step. A step that is too long is made shorter as a whole: cutting single unknowns
//! breaks the compensation between overlapping lobes (garnet red then ends at 1.9 % in place of 1.6 %).
//!
//! Tried without gain: geodesic acceleration (Transtrum and Sethna 2012).

use crate::isotropic::objective::{Objective, Weights};
use crate::judge::report::Ending;

/// Largest change of an unknown in one step: beyond it the linearisation of an exponential says nothing. Half of it finds
/// better minima of mirror-like materials, but takes twice the steps to leave a bad start.
const LONGEST_STEP: f64 = 3.0;

/// Damping of an unknown that nothing depends on, over the cost; and of a colour, which faint lobes would else change by large steps
/// that shorten all others.
const FAINT: f64 = 1e-10;
const FAINT_COLOR: f64 = 1e-3;

/// Damping of the first step.
const FIRST_DAMPING: f64 = 0.1;

/// Damping at which no step helps any more.
const MOST_DAMPING: f64 = 1e12;

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Steps tried.
    pub steps: usize,
    /// Relative decrease of the cost over five accepted steps below which the minimum counts as reached.
    pub improvement: f64,
    /// Weights of the terms.
    pub weights: Weights,
}

/// Moves `x` downhill; returns the cost reached and why it ended. Calls `tick` after every step tried.
pub(crate) fn minimize(
    objective: &Objective,
    x: &mut Vec<f64>,
    limits: Limits,
    mut tick: impl FnMut(),
) -> (f64, Ending) {
    let layout = &objective.layout;
    let p = layout.stride();
    let clamp = |x: &mut [f64]| {
        for (i, v) in x.iter_mut().enumerate() {
            let (low, high) = objective.bounds(i);
            *v = if layout.fixed(i / p, i % p) { 0.0 } else { v.clamp(low, high) };
        }
    };
    clamp(x);

    let (mut damping, mut growth) = (FIRST_DAMPING, 2.0);
    let mut at = objective.linearize(x, limits.weights);
    let mut history = vec![at.cost];
    let mut ending = Ending::Steps;
    for _ in 0..limits.steps {
        tick();
        let free = |i: usize| {
            let (low, high) = objective.bounds(i);
            let outward = (x[i] <= low && at.gradient[i] > 0.0) || (x[i] >= high && at.gradient[i] < 0.0);
            !layout.fixed(i / p, i % p) && !outward
        };
        let mut matrix = at.matrix.clone();
        let mut delta: Vec<f64> = at.gradient.iter().map(|g| -g).collect();
        // An unknown that nothing depends on (a lobe that has faded) is damped as if it mattered a little.
        let least = |i: usize| at.cost.max(1e-12) * if layout.is_color(i % p) { FAINT_COLOR } else { FAINT };
        for (i, d) in delta.iter_mut().enumerate() {
            if free(i) {
                matrix.add(i, i, damping * at.scale[i] + least(i));
            } else {
                matrix.isolate(i);
                *d = 0.0;
            }
        }
        let mut cost = f64::INFINITY;
        let mut moved = Vec::new();
        let mut promised = f64::MIN_POSITIVE;
        if matrix.factor() {
            matrix.solve(&mut delta);
            let length = |(i, d): (usize, &f64)| if layout.is_color(i % p) { d.abs() / 4.0 } else { d.abs() };
            let longest = delta.iter().enumerate().map(length).fold(0.0, f64::max);
            if longest > LONGEST_STEP {
                delta.iter_mut().for_each(|d| *d *= LONGEST_STEP / longest);
            }
            moved = x.iter().zip(&delta).map(|(x, d)| x + d).collect();
            clamp(&mut moved);
            cost = objective.cost(&moved, limits.weights);
            // Decrease that the damped model promises for the step as solved.
            let promise = |i: usize| delta[i] * (damping * at.scale[i] * delta[i] - at.gradient[i]);
            promised = (0..x.len()).map(promise).sum::<f64>().max(f64::MIN_POSITIVE);
        }
        if cost < at.cost {
            let ratio = ((at.cost - cost) / promised).min(1.0);
            let cube = 2.0 * ratio - 1.0;
            damping = (damping * (1.0 - cube * cube * cube).max(1.0 / 3.0)).max(1e-9);
            growth = 2.0;
            *x = moved;
            at = objective.linearize(x, limits.weights);
            history.push(at.cost);
            let n = history.len();
            if n > 5 && history[n - 6] - at.cost < limits.improvement * at.cost {
                ending = Ending::Converged;
                break;
            }
        } else {
            damping *= growth;
            growth *= 2.0;
            if damping > MOST_DAMPING {
                ending = Ending::Converged;
                break;
            }
        }
    }
    (at.cost, ending)
}
