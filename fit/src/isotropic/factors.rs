//! Factors that the lobes are multiplied by: a small table over half angle and difference angle, one for all views.
//!
//! What is not monotone in the half angle, a ring of an iridescent paint for example, no sum of lobes makes. A table does that is the
//! same for (wi, wo) and (wo, wi), and that costs no exponential. The lobes keep the peak and the density; the table has what is
//! left. With the lobes as they are, the best table is a linear problem.

use crate::isotropic::model::parameters::Layout;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Numbers of nodes that are tried: over the half angle, and over the difference angle.
pub(crate) const SIZES: [[usize; 2]; 3] = [[16, 6], [24, 10], [32, 16]];

/// Code of the factor 1, of which the factor is the square, and the largest code.
const ONE: f64 = 360.0;
const LARGEST: f64 = 1023.0;

/// Weight of the squared second differences of factors, and of their squared distance from 1, beside the squared errors: without data a
/// factor goes on as its neighbours, and ends at 1.
const SMOOTH: f64 = 3e-7;
const PULL: f64 = 1e-7;

/// Share of the error that a larger table may leave at most.
const MORE_NODES: f64 = 0.93;

/// Sweeps of the coordinate descent.
const SWEEPS: usize = 400;

/// Directions of a lobe over which the factors are averaged.
const AVERAGED: usize = 200;

/// Golden angle, of spirals.
const GOLDEN: f64 = 2.399_963_229_728_653;

/// The table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Factors {
    size: [usize; 2],
    /// Linear sRGB, the difference angle fastest.
    nodes: Vec<[f64; 3]>,
}

/// Four nodes and their shares.
type Place = [(usize, f64); 4];

/// What a table is to account for at one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Demand {
    pub wi: [f64; 3],
    pub wo: [f64; 3],
    /// Of the lobes alone.
    pub lobes: [f64; 3],
    pub target: [f64; 3],
    /// Of the squared difference of every channel.
    pub weight: f64,
}

/// Place of two directions among the nodes, which are even in the fourth root of `1 - cos` of the half angle and in the root of that of
/// the difference angle; as `srbf_core` has it.
fn place([half, difference]: [usize; 2], wi: [f64; 3], wo: [f64; 3]) -> Place {
    let s = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]];
    let square = (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]).max(1e-30);
    let length = libm::sqrt(square);
    let a = (s[0] * s[0] + s[1] * s[1]) / square / (1.0 + s[2] / length);
    let b = 1.0 - (0.5 * length).min(1.0);
    let at = |v: f64, count: usize| {
        let x = v.clamp(0.0, 1.0) * (count - 1) as f64;
        let i = (x as usize).min(count - 2);
        (i, x - i as f64)
    };
    let (i, x) = at(libm::sqrt(libm::sqrt(a)), half);
    let (j, y) = at(libm::sqrt(b), difference);
    let node = i * difference + j;
    [
        (node, (1.0 - x) * (1.0 - y)),
        (node + 1, (1.0 - x) * y),
        (node + difference, x * (1.0 - y)),
        (node + difference + 1, x * y),
    ]
}

impl Factors {
    /// Nodes over the half angle, and over the difference angle.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The nodes, the difference angle fastest.
    pub fn nodes(&self) -> Vec<[f32; 3]> {
        self.nodes.iter().map(|n| n.map(|v| v as f32)).collect()
    }

    /// The factors of two directions.
    pub fn at(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (node, share) in place(self.size, wi, wo) {
            (0..3).for_each(|c| sum[c] += share * self.nodes[node][c]);
        }
        sum
    }

    /// Means over each lobe of the interpolated unknowns `q` of a view, and over the diffuse term.
    pub fn means(&self, layout: &Layout, q: &[f64], theta: f64) -> Vec<[f64; 3]> {
        let (sin, cos) = libm::sincos(theta);
        let wo = [-sin, 0.0, cos];
        let mean = |direction: &dyn Fn(f64, f64) -> [f64; 3]| {
            let mut sum = [0.0; 3];
            for i in 0..AVERAGED {
                let u = (i as f64 + 0.5) / AVERAGED as f64;
                let factor = self.at(direction(u, (GOLDEN * i as f64) % TAU), wo);
                (0..3).for_each(|c| sum[c] += factor[c] / AVERAGED as f64);
            }
            sum
        };
        let lobe = |k: usize| {
            let s = libm::exp(q[layout.sharpness(k)]);
            let (sin_a, cos_a) = libm::sincos(q[layout.angle(k)]);
            let mirrored = k.checked_sub(layout.first_mirrored());
            let (sin_b, cos_b) = libm::sincos(mirrored.map_or(0.0, |m| q[layout.off_plane(m)]));
            let axis = [sin_a * cos_b, sin_b, cos_a * cos_b];
            let along = [cos_a, 0.0, -sin_a];
            let across = [-sin_a * sin_b, cos_b, -cos_a * sin_b];
            let squeeze = if k < layout.squeezed { libm::exp(q[0]) } else { 1.0 };
            mean(&|u, phi| {
                let w = (-libm::log1p(u * libm::expm1(-2.0 * s)) / s).min(2.0);
                let (r, (sp, cp)) = (libm::sqrt(w * (2.0 - w)), libm::sincos(phi));
                let mut d = [0, 1, 2].map(|i| axis[i] * (1.0 - w) + r * (along[i] * cp + across[i] * sp));
                d[1] *= squeeze;
                let length = libm::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
                [d[0] / length, d[1] / length, d[2].abs() / length]
            })
        };
        let mut means: Vec<[f64; 3]> = (0..layout.lobes).map(lobe).collect();
        means.push(mean(&|u, phi| {
            let (sp, cp) = libm::sincos(phi);
            let r = libm::sqrt(u);
            [r * cp, r * sp, libm::sqrt(1.0 - u)]
        }));
        means
    }

    /// The best factors for what is demanded; as they are stored.
    pub fn fit(size: [usize; 2], demands: &[Demand]) -> Self {
        let count = size[0] * size[1];
        let mut nodes = vec![[1.0; 3]; count];
        for channel in 0..3 {
            let mut problem = Problem::new(size);
            for d in demands {
                let place = place(size, d.wi, d.wo);
                problem.add(&place, d.weight, d.lobes[channel], d.target[channel]);
            }
            for (node, factor) in nodes.iter_mut().zip(problem.solve()) {
                node[channel] = factor;
            }
        }
        Self { size, nodes }
    }

    /// What is left of the squared error, of all that is demanded.
    pub fn cost(&self, demands: &[Demand]) -> f64 {
        let square = |d: &Demand| {
            let factor = self.at(d.wi, d.wo);
            d.weight * (0..3).map(|c| (factor[c] * d.lobes[c] - d.target[c]).powi(2)).sum::<f64>()
        };
        demands.iter().map(square).sum()
    }

    /// The smallest table that is worth its bytes, for what is demanded: one with more nodes has to leave less than this share of the
    /// error of one with fewer.
    pub fn worthwhile(sizes: &[[usize; 2]], demands: &[Demand]) -> Option<Self> {
        let fit = |size: &[usize; 2]| {
            let factors = Self::fit(*size, demands);
            (factors.cost(demands), factors)
        };
        let tables: Vec<(f64, Self)> = sizes.par_iter().map(fit).collect();
        let mut best: Option<(f64, Self)> = None;
        for (cost, table) in tables {
            if best.as_ref().is_none_or(|(least, _)| cost < MORE_NODES * MORE_NODES * least) {
                best = Some((cost, table));
            }
        }
        best.map(|(_, table)| table)
    }
}

/// Normal equations of the factors of one channel.
struct Problem {
    count: usize,
    matrix: Vec<f64>,
    moment: Vec<f64>,
}

impl Problem {
    fn new([half, difference]: [usize; 2]) -> Self {
        let count = half * difference;
        let mut problem = Self { count, matrix: vec![0.0; count * count], moment: vec![0.0; count] };
        let at = |i: usize, j: usize| i * difference + j;
        for i in 0..half {
            for j in 0..difference {
                problem.add_row(&[(at(i, j), 1.0)], PULL, 1.0);
                if i > 0 && i + 1 < half {
                    problem.add_row(
                        &[(at(i - 1, j), 1.0), (at(i, j), -2.0), (at(i + 1, j), 1.0)],
                        SMOOTH,
                        0.0,
                    );
                }
                if j > 0 && j + 1 < difference {
                    problem.add_row(
                        &[(at(i, j - 1), 1.0), (at(i, j), -2.0), (at(i, j + 1), 1.0)],
                        SMOOTH,
                        0.0,
                    );
                }
            }
        }
        problem
    }

    /// Adds the square of `sum of terms - target`, times a weight.
    fn add_row(&mut self, terms: &[(usize, f64)], weight: f64, target: f64) {
        for &(i, a) in terms {
            self.moment[i] += weight * a * target;
            for &(j, b) in terms {
                self.matrix[i * self.count + j] += weight * a * b;
            }
        }
    }

    fn add(&mut self, place: &Place, weight: f64, lobes: f64, target: f64) {
        let terms = place.map(|(node, share)| (node, share * lobes));
        self.add_row(&terms, weight, target);
    }

    /// Coordinate descent from 1 within the bounds, rounded to what is stored.
    fn solve(&self) -> Vec<f64> {
        let most = (LARGEST / ONE) * (LARGEST / ONE);
        let mut x = vec![1.0; self.count];
        let rows: Vec<Vec<(usize, f64)>> = (0..self.count)
            .map(|i| {
                let row = self.matrix[i * self.count..(i + 1) * self.count].iter().copied().enumerate();
                row.filter(|e| e.1 != 0.0).collect()
            })
            .collect();
        for _ in 0..SWEEPS {
            for i in 0..self.count {
                let product: f64 = rows[i].iter().map(|&(j, m)| m * x[j]).sum();
                let step = (self.moment[i] - product) / self.matrix[i * self.count + i];
                x[i] = (x[i] + step).clamp(0.0, most);
            }
        }
        x.into_iter().map(|f| (libm::round(ONE * libm::sqrt(f)) / ONE).powi(2)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::direction;

    /// Directions of some views with the factors of a function of half angle and difference angle.
    fn demands(factor: impl Fn(f64, f64) -> [f64; 3]) -> Vec<Demand> {
        let mut demands = Vec::new();
        for theta in [0.05, 0.3, 0.6, 0.9, 1.2, 1.4] {
            let wo = direction(theta, std::f64::consts::PI);
            for i in 0..600 {
                let z = (f64::from(i) + 0.5) / 600.0;
                let wi = direction(libm::acos(z), GOLDEN * f64::from(i));
                let h = [0, 1, 2].map(|k| wi[k] + wo[k]);
                let length = libm::sqrt(h.iter().map(|v| v * v).sum());
                let factor = factor(libm::acos(h[2] / length), libm::acos((0.5 * length).min(1.0)));
                let lobes = [0.3, 0.2, 0.1];
                let target = [0, 1, 2].map(|c| lobes[c] * factor[c]);
                demands.push(Demand { wi, wo, lobes, target, weight: 1.0 });
            }
        }
        demands
    }

    #[test]
    fn smooth_factors_are_found_again() {
        let truth =
            |half: f64, difference: f64| [1.0 + 0.5 * libm::sin(4.0 * half), 1.0 + 0.3 * difference, 0.5];
        let demands = demands(truth);
        let factors = Factors::fit([24, 10], &demands);
        for d in &demands {
            let found = factors.at(d.wi, d.wo);
            for c in 0..3 {
                assert!((found[c] * d.lobes[c] - d.target[c]).abs() < 0.02 * d.lobes[c], "{found:?} {d:?}");
            }
            assert_eq!(found, factors.at(d.wo, d.wi));
        }
    }

    #[test]
    fn where_there_are_no_data_the_factor_is_one() {
        let factors = Factors::fit([16, 6], &[]);
        assert!(factors.nodes.iter().flatten().all(|f| *f == 1.0));
    }

    #[test]
    fn the_mean_of_a_diffuse_term_is_by_the_cosine() {
        let layout = Layout::new(1, 0, 0, vec![0.0]);
        let mut factors = Factors::fit([16, 6], &[]);
        let q = vec![0.0; layout.stride()];
        assert!(factors.means(&layout, &q, 0.5).iter().flatten().all(|m| (m - 1.0).abs() < 1e-9));
        factors.nodes.iter_mut().for_each(|n| n[1] = 3.0);
        assert!((factors.means(&layout, &q, 0.5)[1][1] - 3.0).abs() < 1e-9);
    }
}
