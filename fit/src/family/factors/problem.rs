//! Normal equations of the factors, of all channels in one pass over the demands.
//!
//! A demand sees the eight corners of its cell alone. So its products are summed cell by cell, and a row of the matrix has the
//! neighbours of its node. The squared error of an albedo couples all nodes, but is a square of one sum for each view. These
//! sums are kept as they are, and the solver carries them along.

use super::{CORNERS, Demand, NodeShares, Size, cell, corners, node, place};
use crate::family::tuning::factors::{LARGEST, PULL, SWEEPS};
use rayon::prelude::*;

/// Pairs of corners, the second not before the first.
const PAIRS: usize = CORNERS * (CORNERS + 1) / 2;

/// Sums over the demands of a cell.
#[derive(Clone)]
struct CellSums {
    /// Products of the shares of two corners, per channel.
    products: [[f64; 3]; PAIRS],
    /// Products of a share and the target.
    moments: [[f64; 3]; CORNERS],
}

impl CellSums {
    const EMPTY: Self = Self { products: [[0.0; 3]; PAIRS], moments: [[0.0; 3]; CORNERS] };

    fn add(&mut self, shares: &[f64; CORNERS], d: &Demand) {
        let square = d.lobes.map(|lobes| d.weight * lobes * lobes);
        let moment = [0, 1, 2].map(|c| d.weight * d.lobes[c] * d.target[c]);
        let mut pair = 0;
        for a in 0..CORNERS {
            (0..3).for_each(|c| self.moments[a][c] += shares[a] * moment[c]);
            for b in a..CORNERS {
                let product = shares[a] * shares[b];
                (0..3).for_each(|c| self.products[pair][c] += product * square[c]);
                pair += 1;
            }
        }
    }
}

/// The normal equations.
pub(super) struct Problem {
    /// Of each node, the nodes that it is coupled with, itself among them, and the products per channel.
    rows: Vec<Vec<(usize, [f64; 3])>>,
    moments: Vec<[f64; 3]>,
    /// Of each view, the derivatives of its weighed albedo by the nodes, and its target.
    albedos: Vec<(Vec<[f64; 3]>, [f64; 3])>,
}

impl Problem {
    /// Of a table of that size, with that weight of squared second differences.
    pub fn new(size: Size, smoothness: f64, demands: &[Demand]) -> Self {
        let count = size.count();
        let mut problem =
            Self { rows: vec![Vec::new(); count], moments: vec![[0.0; 3]; count], albedos: Vec::new() };
        problem.add_smoothness(size, smoothness);
        problem.add_demands(size, demands);
        problem
    }

    fn add_smoothness(&mut self, size: Size, smoothness: f64) {
        let [half, difference, azimuth] = size.nodes;
        for n in 0..self.rows.len() {
            let at = [n / difference % half, n % difference, n / (half * difference)];
            self.add_row(&[(node(size, at), 1.0)], PULL / azimuth as f64, 1.0);
            for along in 0..3 {
                if at[along] > 0 && at[along] + 1 < size.nodes[along] {
                    let beside = |by: usize| {
                        let mut beside = at;
                        beside[along] = at[along] + by - 1;
                        node(size, beside)
                    };
                    let bend = [(beside(0), 1.0), (beside(1), -2.0), (beside(2), 1.0)];
                    self.add_row(&bend, smoothness / azimuth as f64, 0.0);
                }
            }
            // Along the azimuth a first difference too, which is all that there is of two.
            if at[2] > 0 {
                let before = node(size, [at[0], at[1], at[2] - 1]);
                self.add_row(&[(node(size, at), 1.0), (before, -1.0)], PULL, 0.0);
            }
        }
    }

    /// Adds the square of `sum of terms - target`, times a weight, to all channels.
    fn add_row(&mut self, terms: &[(usize, f64)], weight: f64, target: f64) {
        for &(i, a) in terms {
            self.moments[i].iter_mut().for_each(|moment| *moment += weight * a * target);
            for &(j, b) in terms {
                self.add(i, j, [weight * a * b; 3]);
            }
        }
    }

    fn add(&mut self, i: usize, j: usize, values: [f64; 3]) {
        let row = &mut self.rows[i];
        let place = row.iter().position(|term| term.0 == j).unwrap_or_else(|| {
            row.push((j, [0.0; 3]));
            row.len() - 1
        });
        (0..3).for_each(|c| row[place].1[c] += values[c]);
    }

    /// Adds the squared errors of the demands, and of the albedo of each view: without it the albedo falls, and the balance of
    /// channels that follows would change colours everywhere.
    fn add_demands(&mut self, size: Size, demands: &[Demand]) {
        // One cell more than there are intervals where there is one node.
        let cells = size.nodes.map(|nodes| (nodes - 1).max(1));
        let mut sums = vec![CellSums::EMPTY; cells.iter().product()];
        for view in demands.chunk_by(|a, b| a.view == b.view) {
            let (mut slopes, mut target) = (vec![[0.0; 3]; self.rows.len()], [0.0; 3]);
            for d in view {
                let NodeShares { cell: [i, j, k], shares } = cell(size, place(size, d.wi, d.wo));
                sums[(k * cells[1] + j) * cells[0] + i].add(&shares, d);
                for (node, share) in corners(size, [i, j, k]).into_iter().zip(shares) {
                    (0..3).for_each(|c| slopes[node][c] += share * d.by_energy[c] * d.lobes[c]);
                }
                (0..3).for_each(|c| target[c] += d.by_energy[c] * d.target[c]);
            }
            self.albedos.push((slopes, target));
        }
        for (n, sum) in sums.iter().enumerate() {
            let cell = [n % cells[0], n / cells[0] % cells[1], n / (cells[0] * cells[1])];
            let nodes = corners(size, cell);
            let mut pair = 0;
            for a in 0..CORNERS {
                (0..3).for_each(|c| self.moments[nodes[a]][c] += sum.moments[a][c]);
                for b in a..CORNERS {
                    self.add(nodes[a], nodes[b], sum.products[pair]);
                    if a != b {
                        self.add(nodes[b], nodes[a], sum.products[pair]);
                    }
                    pair += 1;
                }
            }
        }
    }

    /// Coordinate descent from 1 within the bounds, channel by channel. It ends where no node moves further than `still`.
    pub fn solve(&self, still: f64) -> Vec<[f64; 3]> {
        let channels: Vec<Vec<f64>> = (0..3).into_par_iter().map(|c| self.solve_channel(c, still)).collect();
        (0..self.rows.len()).map(|n| [0, 1, 2].map(|c| channels[c][n])).collect()
    }

    fn solve_channel(&self, c: usize, still: f64) -> Vec<f64> {
        let (count, views) = (self.rows.len(), self.albedos.len());
        // The derivatives of all albedos by a node stand side by side.
        let mut slopes = vec![0.0; count * views];
        for (view, (of_view, _)) in self.albedos.iter().enumerate() {
            of_view.iter().enumerate().for_each(|(n, slope)| slopes[n * views + view] = slope[c]);
        }
        let rows: Vec<Vec<(usize, f64)>> =
            self.rows.iter().map(|row| row.iter().map(|(j, v)| (*j, v[c])).collect()).collect();
        let of_node = |n: usize| &slopes[n * views..(n + 1) * views];
        let diagonal: Vec<f64> = (0..count)
            .map(|n| {
                let own: f64 = rows[n].iter().filter(|term| term.0 == n).map(|term| term.1).sum();
                (own + of_node(n).iter().map(|a| a * a).sum::<f64>()).max(1e-300)
            })
            .collect();
        let mut x = vec![1.0; count];
        for _ in 0..SWEEPS {
            // Anew in every sweep, so that rounding does not add up.
            let mut errors: Vec<f64> = self.albedos.iter().map(|(_, target)| -target[c]).collect();
            for (n, x) in x.iter().enumerate() {
                errors.iter_mut().zip(of_node(n)).for_each(|(error, slope)| *error += slope * x);
            }
            let mut farthest: f64 = 0.0;
            for n in 0..count {
                let coupled: f64 = rows[n].iter().map(|&(j, v)| v * x[j]).sum();
                let step = (self.moments[n][c] - coupled - product(of_node(n), &errors)) / diagonal[n];
                let moved = (x[n] + step).clamp(0.0, LARGEST) - x[n];
                if moved != 0.0 {
                    farthest = farthest.max(moved.abs());
                    x[n] += moved;
                    errors.iter_mut().zip(of_node(n)).for_each(|(error, slope)| *error += slope * moved);
                }
            }
            if farthest < still {
                break;
            }
        }
        x
    }
}

/// Inner product. Its order is fixed, and in lanes.
fn product(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let (whole, others) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = whole.remainder().iter().zip(others.remainder()).map(|(a, b)| a * b).sum::<f64>();
    let mut sums = [0.0; LANES];
    for (a, b) in whole.zip(others) {
        (0..LANES).for_each(|n| sums[n] += a[n] * b[n]);
    }
    sums.iter().sum::<f64>() + rest
}
