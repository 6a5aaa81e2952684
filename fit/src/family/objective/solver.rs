//! The objective as the solver sees it: with weights, and within bounds.

use super::linearize::Linearized;
use super::{Objective, Weights};
use crate::family::layout::Views;
use crate::family::matrix::Matrix;
use crate::family::tuning::solver::COLOR_STEP;
use crate::numeric::levenberg::{LeastSquares, Linear};

/// The sum of squares with weights, as the solver sees it.
pub(crate) struct Weighted<'a, V: Views> {
    pub objective: &'a Objective<V>,
    pub weights: Weights,
}

impl<V: Views> Weighted<'_, V> {
    fn is_color(&self, unknown: usize) -> bool {
        self.objective.layout.is_color(unknown % self.objective.layout.stride())
    }
}

impl<V: Views> LeastSquares for Weighted<'_, V> {
    const LONGEST_STEP: f64 = V::LONGEST_STEP;
    type Linear = Linearized<V>;

    fn bounds(&self, unknown: usize) -> (f64, f64) {
        self.objective.bounds[unknown]
    }
    fn unit(&self, unknown: usize) -> f64 {
        if self.is_color(unknown) { COLOR_STEP } else { 1.0 }
    }
    fn faint(&self, unknown: usize) -> f64 {
        if self.is_color(unknown) { self.weights.faint_color } else { 1e-10 }
    }
    fn cost(&self, x: &[f64]) -> f64 {
        self.objective.cost(x, self.weights)
    }
    fn linearize(&self, x: &[f64]) -> Linearized<V> {
        self.objective.linearize(x, self.weights)
    }
    fn linearize_in(&self, x: &[f64], memory: Linearized<V>) -> Linearized<V> {
        self.objective.linearize_onto(x, self.weights, memory.cleared(&self.objective.layout))
    }
}

impl<V: Views> Linear for Linearized<V> {
    fn cost(&self) -> f64 {
        self.cost
    }
    fn gradient(&self) -> &[f64] {
        &self.gradient
    }
    fn scale(&self) -> Vec<f64> {
        self.matrix.scale()
    }
    fn step(&mut self, added: &[f64], free: &[bool]) -> Option<Vec<f64>> {
        self.matrix.step(added, free, self.gradient.iter().map(|g| -g).collect())
    }
}
