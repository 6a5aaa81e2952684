//! Gradient and matrix against differences of the cost, for stored views on a line and on a grid.

use super::data_term::Panels;
use super::{Emphasis, Objective, Weights};
use crate::anisotropic::tests::{Grid, grid_layout};
use crate::family::layout::{Layout, Views};
use crate::family::lobes::Lobes;
use crate::family::matrix::Matrix;
use crate::isotropic::line;
use crate::numeric::random::Random;
use crate::table::{Sample, View, direction};

/// A sum of squares over random views at some places, and random unknowns.
fn problem<V: Views>(
    layout: Layout<V>,
    places: &[(f64, f64)],
    place: impl Fn(&Layout<V>, f64, f64) -> V::Place,
) -> (Objective<V>, Vec<f64>) {
    let mut random = Random::new(3);
    let mut view = |theta: f64| {
        let mut sample = || {
            let direction = direction(1.5 * random.uniform(), 3.1 * random.uniform());
            let rgb = [0.1 + random.uniform(), random.uniform(), 0.3 * random.uniform()];
            Sample { direction, rgb, weight: 0.2 }
        };
        let samples = (0..40).map(|_| sample()).collect();
        View { theta, samples, albedo: [0.5, 0.3, 0.1], uncut_albedo: [0.5, 0.3, 0.1], floor: 0.0 }
    };
    let views: Vec<View> = places.iter().map(|&(theta, _)| view(theta)).collect();
    let placed: Vec<_> =
        places.iter().zip(&views).map(|(&(theta, phi), view)| (place(&layout, theta, phi), view)).collect();
    let mut x: Vec<f64> = (0..layout.len()).map(|_| 1.4 * random.uniform() - 0.6).collect();
    let p = layout.stride();
    (0..x.len()).filter(|i| V::fixed(&layout, i / p, i % p)).for_each(|i| x[i] = 0.0);
    let emphasis = Emphasis { tail: 0.03, measure: 1.0, energy: 1.0, is_dense: true };
    (Objective::over(&placed, layout, emphasis, None).unwrap(), x)
}

fn check_gradient<V: Views>((objective, x): (Objective<V>, Vec<f64>)) {
    let weights = Weights { smoothness: 0.1, energy: 2.0, faint_color: 0.0 };
    let linearized = objective.linearize(&x, weights);
    let cost = objective.cost(&x, weights);
    // Values are f32.
    assert!((linearized.cost - cost).abs() < 1e-6 * cost, "{} {cost}", linearized.cost);
    for i in 0..x.len() {
        let at = |h: f64| {
            let mut x = x.clone();
            x[i] += h;
            objective.cost(&x, weights)
        };
        // Wide enough for a difference of f32.
        let h = 3e-3;
        // `gradient` is that of half the cost.
        let difference = (at(h) - at(-h)) / (4.0 * h);
        let g = linearized.gradient[i];
        assert!((difference - g).abs() < 2e-4 * (g.abs() + cost), "{i}: {difference} {g}");
    }
}

/// Gauss-Newton is exact where residuals vanish: the targets are the values themselves.
fn check_matrix<V: Views>((mut objective, x): (Objective<V>, Vec<f64>)) {
    let layout = objective.layout.clone();
    objective.watched.clear();
    for view in &mut objective.views {
        let mut q = vec![0.0; layout.stride()];
        layout.interpolate(&x, view.place, &mut q);
        view.albedo = layout.albedo(&q, None);
        let (lobes, a) = (Lobes::new(&layout, &q), layout.amplitudes(&q));
        let mut unit = vec![0.0; layout.lobes + 1];
        for point in &mut view.points {
            lobes.values(&point.direction, &mut unit);
            point.target = [0, 1, 2].map(|c| a[c].iter().zip(&unit).map(|(a, u)| a * u).sum());
            point.weigh(point.base, 0.0);
        }
        view.panels = Panels::new(&view.points);
    }
    let none = Weights { smoothness: 0.0, energy: 1.0, faint_color: 0.0 };
    // A step along each unknown in turn has the diagonal, and some random ones the rest: the solution of `A s = b` is known.
    let mut random = Random::new(5);
    let all = vec![true; x.len()];
    for _ in 0..5 {
        let mut linearized = objective.linearize(&x, none);
        let downhill: Vec<f64> = x.iter().map(|_| random.uniform() - 0.5).collect();
        // No unknown is so free that its change of the cost is lost in the rounding of f32.
        let diagonal = linearized.matrix.scale();
        let free = 1e-3 * diagonal.iter().fold(0.0, |most: f64, d| most.max(*d));
        let added: Vec<f64> = diagonal.iter().map(|d| 0.3 * d + free).collect();
        let step = linearized.matrix.step(&added, &all, downhill.clone()).unwrap();
        // Of `s (A + D) s / 2 - b s` the solution is the minimum, which is `-b s / 2`.
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let scale = 1e-3 / step.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
        let moved: Vec<f64> = x.iter().zip(&step).map(|(x, s)| x + scale * s).collect();
        let quadratic = objective.cost(&moved, none) / (scale * scale)
            + step.iter().zip(&added).map(|(s, d)| s * s * d).sum::<f64>();
        let expected = dot(&downhill, &step);
        assert!((quadratic - expected).abs() < 2e-3 * expected, "{quadratic} {expected}");
    }
}

/// Stored views on a line, and on grids of which one has rings of one view.
const PLACES: [(f64, f64); 6] = [(0.0, 0.0), (0.3, 1.0), (0.4, 5.0), (0.6, 2.0), (0.9, 3.0), (1.3, 0.4)];

fn on_line() -> (Objective<line::Line>, Vec<f64>) {
    let layout = line::Layout::new(4, 2, 1, vec![0.0, 0.5, 1.0, 1.5]);
    problem(layout, &PLACES, |layout, theta, _| layout.place(theta))
}

#[test]
fn gradient_and_cost_agree_with_differences() {
    check_gradient(on_line());
    for (azimuths, turns) in [(4, 1), (3, 2), (1, 1), (4, 4), (2, 4)] {
        let place = |layout: &Layout<Grid>, theta, phi| layout.views.place(theta, phi);
        check_gradient(problem(grid_layout(azimuths, turns), &PLACES, place));
    }
}

#[test]
fn the_matrix_is_the_second_derivative_where_the_data_are_met() {
    check_matrix(on_line());
    for (azimuths, turns) in [(4, 1), (3, 2), (1, 1), (4, 4), (2, 4)] {
        let place = |layout: &Layout<Grid>, theta, phi| layout.views.place(theta, phi);
        check_matrix(problem(grid_layout(azimuths, turns), &PLACES, place));
    }
}

#[test]
fn a_channel_that_is_falsely_below_0_weighs_more_and_no_other() {
    use super::{by_sign, grazing};
    use crate::family::tuning::objective::{FALSELY_NEGATIVE, MOST_GRAZING};
    assert!(by_sign(0.5, 1.0) == 1.0 && by_sign(-1.0, -1.0) == 1.0 && by_sign(1.0, -1.0) == 1.0);
    assert!(by_sign(-1.0, 1.0) == FALSELY_NEGATIVE && by_sign(-1e-9, 1e-9) == FALSELY_NEGATIVE);
    let [a, b] = [0.1, -0.1].map(|value| by_sign(value, 1.0));
    assert!(1.0 < a && a < b && b < FALSELY_NEGATIVE, "{a} {b}");
    assert!(grazing(1.0) == 1.0 && grazing(0.0) == MOST_GRAZING && grazing(0.2) > 1.5);
}
