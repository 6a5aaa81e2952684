//! The objective as the solver sees it: with weights, within bounds, and a step by factoring a band matrix.

use super::linearize::Linearized;
use super::{Objective, Weights};
use crate::isotropic::tuning::solver::{COLOR_STEP, LONGEST_STEP};
use crate::numeric::levenberg::{LeastSquares, Linear};

/// The sum of squares with weights, as the solver sees it.
pub(crate) struct Weighted<'a> {
    pub objective: &'a Objective,
    pub weights: Weights,
}

impl Weighted<'_> {
    fn is_color(&self, unknown: usize) -> bool {
        self.objective.layout.is_color(unknown % self.objective.layout.stride())
    }
}

impl LeastSquares for Weighted<'_> {
    const LONGEST_STEP: f64 = LONGEST_STEP;
    type Linear = Linearized;

    fn bounds(&self, unknown: usize) -> (f64, f64) {
        self.objective.bounds(unknown)
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
    fn linearize(&self, x: &[f64]) -> Linearized {
        self.objective.linearize(x, self.weights)
    }
    fn linearize_in(&self, x: &[f64], memory: Linearized) -> Linearized {
        self.objective.linearize_onto(x, self.weights, memory.cleared())
    }
}

impl Linear for Linearized {
    fn cost(&self) -> f64 {
        self.cost
    }
    fn gradient(&self) -> &[f64] {
        &self.gradient
    }
    fn scale(&self) -> Vec<f64> {
        self.scale.clone()
    }
    fn step(&mut self, added: &[f64], free: &[bool]) -> Option<Vec<f64>> {
        let matrix = match &mut self.damped {
            Some(room) => {
                room.clone_from(&self.matrix);
                room
            }
            none => none.insert(self.matrix.clone()),
        };
        let mut step: Vec<f64> = self.gradient.iter().map(|g| -g).collect();
        for i in 0..step.len() {
            if free[i] {
                matrix.add(i, i, added[i]);
            } else {
                matrix.isolate(i);
                step[i] = 0.0;
            }
        }
        matrix.factor().then(|| {
            matrix.solve(&mut step);
            step
        })
    }
}
