//! The predictions of a process on a grid, because a fit needs a million.

use super::changes::Changes;
use super::pair::{COORDINATES, Pair};
use super::turn::Turn;
use crate::complete::tuning::grid::{NODES, OF_SIDES, TURNED};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Values over pairs of directions, linear between nodes.
pub(super) struct Grid {
    width: f64,
    /// Spread angle of the half vector at the last node.
    most: f64,
    changes: Changes,
    values: Vec<[f64; 3]>,
}

fn part(n: usize, of: usize) -> f64 {
    n as f64 / (of - 1) as f64
}

/// The turn of the way between both directions after which values are the same, radians: half of it exchanges them.
fn round(sides: bool) -> f64 {
    if sides { 2.0 * PI } else { PI }
}

/// Nodes where a turn changes values.
fn turned(sides: bool) -> [usize; 4] {
    let [halves, differences, ways, azimuths] = TURNED;
    [halves, differences, if sides { 2 * ways } else { ways }, azimuths]
}

impl Grid {
    /// Of a function of a pair that is smooth in its coordinates.
    pub fn new(
        width: f64,
        changes: Changes,
        value: impl Fn(&Pair, &[f64; COORDINATES]) -> [f64; 3] + Sync,
    ) -> Self {
        let Changes { turn, sides } = changes;
        let farthest = turn.map_or(1.0, |turn| turn.along);
        let most = libm::asinh(farthest / width);
        let lean = |n: usize, of: usize| width * libm::sinh(most * part(n, of));
        let isotropic = |n: usize| {
            let [halves, differences, shares] = if sides { OF_SIDES } else { NODES };
            let half = libm::asin(lean(n / (differences * shares), halves).min(1.0));
            let difference = FRAC_PI_2 * part(n / shares % differences, differences);
            let part = part(n % shares, shares);
            if sides {
                Pair::from_angles(half, difference, 2.0 * part - 1.0).told_apart()
            } else {
                Pair::from_share(half, difference, part)
            }
        };
        let of_turn = |n: usize, turn: &Turn| {
            let [halves, differences, ways, azimuths] = turned(sides);
            let (half, rest) = (n / (differences * ways * azimuths), n % (differences * ways * azimuths));
            let difference = FRAC_PI_2 * part(rest / (ways * azimuths), differences);
            let way = round(sides) * (rest / azimuths % ways) as f64 / ways as f64;
            let azimuth = turn.period() * (n % azimuths) as f64 / azimuths as f64;
            let [wi, wo] = turn.directions(lean(half, halves), azimuth, difference, way);
            changes.pair(wi, wo)
        };
        let count: usize = match (turn, sides) {
            (Some(_), _) => turned(sides).iter().product(),
            (None, true) => OF_SIDES.iter().product(),
            (None, false) => NODES.iter().product(),
        };
        let node = |n: usize| {
            let pair = turn.map_or_else(|| isotropic(n), |turn| of_turn(n, &turn));
            value(&pair, &pair.coordinates(width))
        };
        Self { width, most, changes, values: (0..count).into_par_iter().map(node).collect() }
    }

    /// At a pair of directions.
    pub fn at(&self, pair: &Pair, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let places = [pair.spread_half(self.width) / self.most, pair.difference() / FRAC_PI_2];
        let Changes { turn, sides } = self.changes;
        match turn {
            None if sides => self.between(OF_SIDES, [places[0], places[1], 0.5 + 0.5 * pair.cos_toward()], 3),
            None => self.between(NODES, [places[0], places[1], pair.share_sideways()], 3),
            Some(turn) => {
                let [way, azimuth] = turn.angles(wi, wo);
                let round = [way / round(sides), azimuth / turn.period()].map(|v| v - libm::floor(v));
                self.between(turned(sides), [places[0], places[1], round[0], round[1]], 2)
            }
        }
    }

    /// Linear between nodes; dimensions from `round` on go round.
    fn between<const OF: usize>(&self, nodes: [usize; OF], places: [f64; OF], round: usize) -> [f64; 3] {
        let mut parts = [0.0; OF];
        let mut ends = [[0; 2]; OF];
        for k in 0..OF {
            let step: usize = nodes[k + 1..].iter().product();
            let last = if k < round { nodes[k] - 1 } else { nodes[k] };
            let place = (places[k] * last as f64).clamp(0.0, last as f64);
            let node = (place as usize).min(last - 1);
            parts[k] = place - node as f64;
            ends[k] = [node * step, (node + 1) % nodes[k] * step];
        }
        let mut sum = [0.0; 3];
        for corner in 0..1 << OF {
            let side = |k: usize| corner >> k & 1;
            let weight: f64 = (0..OF).map(|k| if side(k) == 1 { parts[k] } else { 1.0 - parts[k] }).product();
            let value = &self.values[(0..OF).map(|k| ends[k][side(k)]).sum::<usize>()];
            (0..3).for_each(|c| sum[c] += weight * value[c]);
        }
        sum
    }
}
