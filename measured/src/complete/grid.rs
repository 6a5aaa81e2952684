//! The predictions of a process on a grid, because a fit needs a million.

use super::pair::{COORDINATES, Pair};
use crate::complete::tuning::grid::NODES;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// Values over pairs of directions, linear between nodes.
pub(super) struct Grid {
    width: f64,
    /// Spread angle of the half vector at the last node.
    most: f64,
    values: Vec<[f64; 3]>,
}

impl Grid {
    /// Of a function of a pair that is smooth in its coordinates.
    pub fn new(width: f64, value: impl Fn(&Pair, &[f64; COORDINATES]) -> [f64; 3] + Sync) -> Self {
        let most = libm::asinh(1.0 / width);
        let [halves, differences, shares] = NODES;
        let part = |n: usize, of: usize| n as f64 / (of - 1) as f64;
        let node = |n: usize| {
            let spread = most * part(n / (differences * shares), halves);
            let half = libm::asin((width * libm::sinh(spread)).min(1.0));
            let difference = FRAC_PI_2 * part(n / shares % differences, differences);
            let pair = Pair::from_angles(half, difference, part(n % shares, shares));
            value(&pair, &pair.coordinates(width))
        };
        let values = (0..halves * differences * shares).into_par_iter().map(node).collect();
        Self { width, most, values }
    }

    /// At a pair.
    pub fn at(&self, pair: &Pair) -> [f64; 3] {
        let places =
            [pair.spread_half(self.width) / self.most, pair.difference() / FRAC_PI_2, pair.share_sideways()];
        let mut first = 0;
        let mut parts = [0.0; 3];
        let mut steps = [0; 3];
        for k in 0..3 {
            let last = NODES[k] - 1;
            let place = (places[k] * last as f64).clamp(0.0, last as f64);
            let node = (place as usize).min(last - 1);
            parts[k] = place - node as f64;
            steps[k] = NODES[k + 1..].iter().product::<usize>();
            first += node * steps[k];
        }
        let mut sum = [0.0; 3];
        for corner in 0..8 {
            let side = |k: usize| corner >> k & 1;
            let weight: f64 = (0..3).map(|k| if side(k) == 1 { parts[k] } else { 1.0 - parts[k] }).product();
            let value = &self.values[first + (0..3).map(|k| side(k) * steps[k]).sum::<usize>()];
            (0..3).for_each(|c| sum[c] += weight * value[c]);
        }
        sum
    }
}
