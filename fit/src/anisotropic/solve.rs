//! Levenberg-Marquardt with bounds, each step by conjugate gradients.
//!
//! As `levenberg.rs`, which has the reasons: Marquardt's scaling, Nielsen's damping, unknowns at a bound left out of a step that
//! would take them outwards, long steps shortened as a whole.

use super::objective::Objective;
use crate::judge::report::Ending;

const LONGEST_STEP: f64 = 2.0;
const FIRST_DAMPING: f64 = 0.1;
const MOST_DAMPING: f64 = 1e12;

/// How exactly a step is solved, relative to its right side, and in how many inner steps at most: ten times as exact changes the
/// cost reached by less than another starting point does, and takes three times as long.
const TOLERANCE: f64 = 0.02;
const INNER_STEPS: usize = 150;

/// Moves `x` downhill in at most `steps` steps, or until five of them lower the cost by less than `improvement` of it; returns the
/// cost reached and why it ended. Calls `tick` after every step tried.
pub(super) fn minimize(
    objective: &Objective,
    x: &mut Vec<f64>,
    steps: usize,
    improvement: f64,
    mut tick: impl FnMut(),
) -> (f64, Ending) {
    let layout = &objective.layout;
    let p = layout.stride();
    let clamp = |x: &mut [f64]| {
        for (i, v) in x.iter_mut().enumerate() {
            let (low, high) = layout.bounds(i % p);
            *v = if layout.fixed(i / p, i % p) { 0.0 } else { v.clamp(low, high) };
        }
    };
    clamp(x);

    let (mut damping, mut growth) = (FIRST_DAMPING, 2.0);
    let mut at = objective.linearize(x);
    let mut history = vec![at.cost];
    let mut ending = Ending::Steps;
    for _ in 0..steps {
        tick();
        let free: Vec<bool> = (0..x.len())
            .map(|i| {
                let (low, high) = layout.bounds(i % p);
                let g = at.gradient[i];
                let outward = (x[i] <= low && g > 0.0) || (x[i] >= high && g < 0.0);
                !layout.fixed(i / p, i % p) && !outward
            })
            .collect();
        // An unknown that nothing depends on (a lobe that has faded) is damped as if it mattered a little.
        let least = 1e-10 * at.cost.max(1e-12);
        let added: Vec<f64> = at.matrix.diagonal().iter().map(|d| damping * d + least).collect();
        let downhill: Vec<f64> = at.gradient.iter().map(|g| -g).collect();
        let mut cost = f64::INFINITY;
        let mut moved = Vec::new();
        let mut promised = f64::MIN_POSITIVE;
        if let Some(mut delta) = at.matrix.solve(&added, &free, &downhill, TOLERANCE, INNER_STEPS) {
            let longest = delta.iter().fold(0.0f64, |a, d| a.max(d.abs()));
            if longest > LONGEST_STEP {
                delta.iter_mut().for_each(|d| *d *= LONGEST_STEP / longest);
            }
            moved = x.iter().zip(&delta).map(|(x, d)| x + d).collect();
            clamp(&mut moved);
            cost = objective.cost(&moved);
            // What the damped model promises for its own step: conjugate gradients make it exact along the step, too.
            let promise = |i: usize| delta[i] * (added[i] * delta[i] - at.gradient[i]);
            promised = (0..x.len()).map(promise).sum::<f64>().max(f64::MIN_POSITIVE);
        }
        if cost < at.cost {
            let ratio = ((at.cost - cost) / promised).min(1.0);
            let cube = 2.0 * ratio - 1.0;
            damping = (damping * (1.0 - cube * cube * cube).max(1.0 / 3.0)).max(1e-9);
            growth = 2.0;
            *x = moved;
            at = objective.linearize(x);
            history.push(at.cost);
            let n = history.len();
            if n > 5 && history[n - 6] - at.cost < improvement * at.cost {
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
