//! Factors that the lobes are multiplied by: a small table over half angle, difference angle and azimuth, one for all views.
//!
//! No sum of lobes makes a function that is not monotone in the half angle, such as a ring of an iridescent paint. A table does.
//! It costs no exponential, and is the same for (wi, wo) and (wo, wi) unless it is signed. The lobes keep the peak and the density; the table has the
//! rest. With the lobes as they are, the best table is a linear problem.

mod means;
mod problem;
pub(crate) mod size;

use crate::family::layout::{Layout, Views};
use crate::family::tuning::factors::{
    LEFT_OUT, MORE_NODES, NEARLY_STILL, NODES, SMOOTH, SMOOTHER, SMOOTHER_GAIN, STILL,
};
use crate::numeric::vector;
use crate::table::luminance;
use problem::Problem;
use rayon::prelude::*;
pub(crate) use size::{Asked, Size};
use srbf_core::FactorTable;

/// Code of the largest factor of a table: factors are stored as the squares of codes.
const MOST_CODE: f64 = 255.0;

/// The table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Factors {
    size: Size,
    /// Weight of squared second differences over that of squared errors.
    smoothness: f64,
    /// Linear sRGB, the difference angle fastest, then the half angle.
    nodes: Vec<[f64; 3]>,
}

/// The smallest size.
const ONE: Size = Size::reciprocal([2, 2, 1]);

/// Corners of a cell of nodes.
const CORNERS: usize = 8;

/// A cell of nodes, by the node of its least indices, and the shares of its corners.
struct NodeShares {
    cell: [usize; 3],
    shares: [f64; CORNERS],
}

/// The change of an albedo by factors, relative to the luminance of that of the lobes alone.
pub(crate) fn albedo_difference(lobes: [f64; 3], factored: [f64; 3]) -> [f64; 3] {
    let luminance = luminance(lobes);
    let over = |d: f64| if luminance > 0.0 { d / luminance } else { 0.0 };
    [0, 1, 2].map(|c| over(factored[c] - lobes[c]))
}

/// The target of a table at one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Demand {
    pub wi: [f64; 3],
    pub wo: [f64; 3],
    /// Of the lobes alone.
    pub lobes: [f64; 3],
    pub target: [f64; 3],
    /// Weights of the squared difference of every channel: in the fit, and in the measure away from the peak.
    pub weight: f64,
    pub measure: f64,
    /// The number of its view, rising, and the derivative of the view's weighed error of the albedo by `f cos`, per channel.
    pub view: usize,
    pub by_energy: [f64; 3],
}

/// The node of the same factor that has the least number: where half angle or difference angle are 0 there is no azimuth.
fn node(size: Size, [i, j, k]: [usize; 3]) -> usize {
    let [half, difference, _] = size.nodes;
    let plane = if i == 0 || j == 0 { 0 } else { k };
    (plane * half + i) * difference + j
}

/// The node that stands for the one of a number.
fn own(size: Size, n: usize) -> usize {
    let [half, difference, _] = size.nodes;
    node(size, [n / difference % half, n % difference, n / (half * difference)])
}

/// Place of two directions among the nodes, in nodes. These are even in the fourth root of `1 - cos` of the half angle and in the square
/// root of that of the difference angle; also in the squared cosine of the azimuth, with its sign or without; as `srbf_core` has it.
#[inline(always)]
fn place(size: Size, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
    let s = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]];
    let d = [wi[0] - wo[0], wi[1] - wo[1], wi[2] - wo[2]];
    let across = s[0] * s[0] + s[1] * s[1];
    let square = (across + s[2] * s[2]).max(1e-30);
    let length = square.sqrt();
    let a = across / square / (1.0 + s[2] / length);
    let b = 1.0 - (0.5 * length).min(1.0);
    let distance = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    let c = d[2] * d[2].abs() * square / (distance * across).max(1e-30);
    let c = if size.is_signed { 0.5 + 0.5 * c } else { c.abs() };
    let at = |v: f64, count: usize| v.clamp(0.0, 1.0) * (count - 1) as f64;
    [at(a.sqrt().sqrt(), size.nodes[0]), at(b.sqrt(), size.nodes[1]), at(c, size.nodes[2])]
}

/// The cell of a place.
#[inline(always)]
fn cell(size: Size, place: [f64; 3]) -> NodeShares {
    let cell: [usize; 3] =
        std::array::from_fn(|axis| (place[axis] as usize).min(size.nodes[axis].saturating_sub(2)));
    let inside: [f64; 3] = std::array::from_fn(|axis| place[axis] - cell[axis] as f64);
    let shares = std::array::from_fn(|corner| {
        let share = |axis: usize| if corner >> axis & 1 == 1 { inside[axis] } else { 1.0 - inside[axis] };
        share(0) * share(1) * share(2)
    });
    NodeShares { cell, shares }
}

/// The nodes at the corners of a cell.
fn corners(size: Size, [i, j, k]: [usize; 3]) -> [usize; CORNERS] {
    std::array::from_fn(|corner| {
        let [x_on, y_on, z_on] = [corner & 1, corner >> 1 & 1, corner >> 2];
        node(size, [i + x_on, j + y_on, (k + z_on).min(size.nodes[2] - 1)])
    })
}

impl Factors {
    /// The size of the table.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The best of its size and smoothness for other demands.
    pub fn refitted(&self, demands: &[Demand]) -> Self {
        Self::fit(self.size, self.smoothness, demands)
    }

    /// The nodes, the difference angle fastest, then the half angle.
    pub fn nodes(&self) -> Vec<[f32; 3]> {
        self.nodes.iter().map(|n| n.map(|v| v as f32)).collect()
    }

    /// As a material stores them. `nodes`: these, `albedo_differences`: those of its views.
    pub fn table<'a>(&self, nodes: &'a [[f32; 3]], albedo_differences: &'a [[f32; 3]]) -> FactorTable<'a> {
        let ([half, difference, azimuth], is_signed) = (self.size.nodes, self.size.is_signed);
        FactorTable { half, difference, azimuth, is_signed, factors: nodes, albedo_differences }
    }

    /// The factors of two directions.
    pub fn at(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        self.of(place(self.size, wi, wo), |node| self.nodes[node])
    }

    /// The factors of a place, by the numbers of a node.
    #[inline(always)]
    fn of<const N: usize>(&self, place: [f64; 3], numbers: impl Fn(usize) -> [f64; N]) -> [f64; N] {
        let NodeShares { cell: [i, j, k], shares } = cell(self.size, place);
        // Nodes that stand for others have their factors too, so that none has to be looked up.
        let [half, difference, azimuth] = self.size.nodes;
        let plane = half * difference;
        let start = k * plane + i * difference + j;
        let z_on = if k + 1 < azimuth { plane } else { 0 };
        let mut sum = [0.0; N];
        for (corner, share) in shares.into_iter().enumerate() {
            let node = numbers(start + (corner & 1) * difference + (corner >> 1 & 1) + (corner >> 2) * z_on);
            (0..N).for_each(|c| sum[c] += share * node[c]);
        }
        sum
    }

    /// Means over each lobe of the interpolated unknowns `q` of a view, and over the diffuse term, of `averaged` directions each.
    pub fn means<V: Views>(
        &self,
        layout: &Layout<V>,
        q: &[f64],
        theta: f64,
        averaged: usize,
    ) -> Vec<[f64; 3]> {
        let (sin, cos) = libm::sincos(theta);
        vector::run(means::Means { factors: self, layout, q, wo: [-sin, 0.0, cos], averaged })
    }

    /// The best factors for the demands, rounded as they are stored.
    pub fn fit(size: Size, smoothness: f64, demands: &[Demand]) -> Self {
        Self::fit_until(STILL, size, smoothness, demands)
    }

    /// The same, solved until no node moves further than `still`.
    fn fit_until(still: f64, size: Size, smoothness: f64, demands: &[Demand]) -> Self {
        let solved = Problem::new(size, smoothness, demands).solve(still);
        let nodes = (0..solved.len()).map(|n| solved[own(size, n)]).collect();
        let mut factors = Self { size, smoothness, nodes };
        factors.round();
        factors
    }

    /// Rounds to stored codes.
    fn round(&mut self) {
        let most = self.nodes.iter().flatten().fold(0.0, |most: f64, f| most.max(*f)).max(1e-6);
        let rounded = |f: f64| (libm::round(MOST_CODE * libm::sqrt(f / most)) / MOST_CODE).powi(2) * most;
        self.nodes.iter_mut().for_each(|n| *n = n.map(rounded));
    }

    /// The squared error away from the peak that remains, over all demands.
    pub fn cost(&self, demands: &[Demand]) -> f64 {
        let square = |d: &Demand| {
            let factor = self.at(d.wi, d.wo);
            d.measure * (0..3).map(|c| (factor[c] * d.lobes[c] - d.target[c]).powi(2)).sum::<f64>()
        };
        demands.iter().map(square).sum()
    }

    /// The smallest table of those sizes that is worth its bytes: one with more nodes has to leave less of the error in directions that it has
    /// not seen, the more nodes it has. Then the smoothness is chosen in the same way. Also every size that was `tried`, with the share of the
    /// error that it leaves there.
    pub fn worthwhile(
        tried: &[Size],
        is_small_enough: impl Fn(Size) -> bool + Sync,
        demands: &[Demand],
    ) -> Option<(Self, Vec<(Size, f64)>)> {
        let (mut left_out, mut kept) = (Vec::new(), Vec::new());
        for (number, demand) in demands.iter().enumerate() {
            if number % LEFT_OUT == 1 { &mut left_out } else { &mut kept }.push(*demand);
        }
        // Tables that are too large are in the curve alone, and take most of the time.
        let cost = |size: Size, smoothness: f64| {
            let still = if is_small_enough(size) { STILL } else { NEARLY_STILL };
            Self::fit_until(still, size, smoothness, &kept).cost(&left_out)
        };
        let costs: Vec<f64> = tried.par_iter().map(|size| cost(*size, SMOOTH)).collect();
        let mut best: Option<(f64, Size)> = None;
        for (cost, size) in costs.iter().zip(tried).filter(|tried| is_small_enough(*tried.1)) {
            let is_better = |(least, before): &(f64, Size)| {
                let more = (size.count() as f64 - before.count() as f64) / NODES;
                *cost < libm::pow(MORE_NODES, 2.0 * more) * least
            };
            if best.as_ref().is_none_or(is_better) {
                best = Some((*cost, *size));
            }
        }
        let (least, size) = best?;
        let without =
            Self { size: ONE, smoothness: SMOOTH, nodes: vec![[1.0; 3]; ONE.count()] }.cost(&left_out);
        let left = |cost: f64| libm::sqrt(cost / without.max(1e-300));
        let curve = tried.iter().zip(&costs).map(|(size, cost)| (*size, left(*cost))).collect();
        let smoother = SMOOTHER.map(|times| times * SMOOTH);
        let costs: Vec<f64> = smoother.par_iter().map(|smoothness| cost(size, *smoothness)).collect();
        let mut best = (least, SMOOTH);
        for tried in costs.into_iter().zip(smoother) {
            best = if tried.0 < SMOOTHER_GAIN * best.0 { tried } else { best };
        }
        Some((Self::fit(size, best.1, demands), curve))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anisotropic::tests::grid_layout;
    use crate::family::lobes::Lobes;
    use crate::family::tuning::factors::AVERAGED;
    use crate::isotropic::line;
    use crate::numeric::GOLDEN_ANGLE;
    use crate::table::direction;

    /// Directions of some views with the factors of a function of half angle, difference angle and the squared cosine of the
    /// azimuth.
    fn demands(factor: impl Fn(f64, f64, f64) -> [f64; 3]) -> Vec<Demand> {
        let mut demands = Vec::new();
        for (view, theta) in [0.05, 0.3, 0.6, 0.9, 1.2, 1.4].into_iter().enumerate() {
            let wo = direction(theta, std::f64::consts::PI);
            for i in 0..600 {
                let z = (f64::from(i) + 0.5) / 600.0;
                let wi = direction(libm::acos(z), GOLDEN_ANGLE * f64::from(i));
                let h = [0, 1, 2].map(|k| wi[k] + wo[k]);
                let length = libm::sqrt(h.iter().map(|v| v * v).sum());
                let h = h.map(|v| v / length);
                // The parts of wo and of the normal that are perpendicular to h, and the angle between them.
                let cos = libm::fmin(0.5 * length, 1.0);
                let aside = [0, 1, 2].map(|k| wo[k] - h[k] * cos);
                let normal = [-h[0] * h[2], -h[1] * h[2], 1.0 - h[2] * h[2]];
                let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
                let azimuth = dot(aside, normal).powi(2) / (dot(aside, aside) * dot(normal, normal));
                let factor = factor(libm::acos(h[2]), libm::acos(cos), azimuth);
                let lobes = [0.3, 0.2, 0.1];
                let target = [0, 1, 2].map(|c| lobes[c] * factor[c]);
                let (weight, by_energy) = (1.0, [1e-4; 3]);
                demands.push(Demand { wi, wo, lobes, target, weight, measure: 1.0, view, by_energy });
            }
        }
        demands
    }

    #[test]
    fn smooth_factors_are_found_again() {
        for size in [[24, 10, 1], [24, 10, 3]] {
            let has_azimuth = size[2] > 1;
            let truth = |half: f64, difference: f64, azimuth: f64| {
                let share = if has_azimuth { azimuth * half * difference } else { 0.0 };
                [1.0 + 0.5 * libm::sin(4.0 * half), 1.0 + 0.3 * difference + 0.3 * share, 0.5 + 0.5 * share]
            };
            let demands = demands(truth);
            let factors = Factors::fit(Size::reciprocal(size), SMOOTH, &demands);
            for d in &demands {
                let found = factors.at(d.wi, d.wo);
                for c in 0..3 {
                    assert!(
                        (found[c] * d.lobes[c] - d.target[c]).abs() < 0.03 * d.lobes[c],
                        "{found:?} {d:?}"
                    );
                }
                assert_eq!(found, factors.at(d.wo, d.wi));
            }
        }
    }

    /// The whole sum of squares of a channel: of demands, and of the albedo of each view.
    fn whole(factors: &Factors, demands: &[Demand]) -> f64 {
        let mut sum = 0.0;
        for view in demands.chunk_by(|a, b| a.view == b.view) {
            let mut albedo = 0.0;
            for d in view {
                let apart = factors.at(d.wi, d.wo)[1] * d.lobes[1] - d.target[1];
                sum += d.weight * apart * apart;
                albedo += d.by_energy[1] * apart;
            }
            sum += albedo * albedo;
        }
        sum
    }

    #[test]
    fn no_other_node_makes_a_smaller_sum() {
        let mut demands = demands(|half, difference, azimuth| {
            [1.0, 1.0 + 0.4 * libm::sin(9.0 * half) + 0.5 * azimuth * difference, 1.0]
        });
        demands.iter_mut().for_each(|d| d.by_energy = [1e-3; 3]);
        let size = Size::reciprocal([8, 4, 2]);
        let problem = Problem::new(size, SMOOTH, &demands);
        let solved = problem.solve(STILL);
        let factors = Factors {
            size,
            smoothness: SMOOTH,
            nodes: (0..solved.len()).map(|n| solved[own(size, n)]).collect(),
        };
        let least = whole(&factors, &demands);
        assert!(least < 0.5 * whole(&Factors::fit(size, SMOOTH, &[]), &demands));
        for n in (0..solved.len()).filter(|&n| own(size, n) == n) {
            // Within the bounds.
            for by in [-0.01, 0.01].into_iter().filter(|by| factors.nodes[n][1] + by >= 0.0) {
                let mut moved = factors.clone();
                (0..solved.len()).filter(|&m| own(size, m) == n).for_each(|m| moved.nodes[m][1] += by);
                let sum = whole(&moved, &demands);
                assert!(sum > least * (1.0 - 1e-5), "{n} {by}: {sum} {least}");
            }
        }
    }

    #[test]
    fn where_there_are_no_data_the_factor_is_one() {
        let factors = Factors::fit(Size::reciprocal([16, 6, 3]), SMOOTH, &[]);
        // As they are stored, in f32: the solution is 1 but for the rounding of its sums.
        assert!(factors.nodes().iter().flatten().all(|f| *f == 1.0));
    }

    #[test]
    fn the_mean_of_a_diffuse_term_is_by_the_cosine() {
        let layout = line::Layout::new(1, 0, 0, vec![0.0]);
        let mut factors = Factors::fit(Size::reciprocal([16, 6, 3]), SMOOTH, &[]);
        let q = vec![0.0; layout.stride()];
        assert!(factors.means(&layout, &q, 0.5, AVERAGED).iter().flatten().all(|m| (m - 1.0).abs() < 1e-9));
        factors.nodes.iter_mut().for_each(|n| n[1] = 3.0);
        assert!((factors.means(&layout, &q, 0.5, AVERAGED)[1][1] - 3.0).abs() < 1e-9);
    }

    /// The mean over a lobe is that of its values over the hemisphere.
    fn check_means<V: Views>(layout: &Layout<V>, q: &[f64], factors: &Factors) {
        let theta = 0.6;
        let found = factors.means(layout, q, theta, 20_000);
        let lobes = Lobes::new(layout, q);
        let (mut sums, mut unit) = (vec![(0.0, 0.0); layout.lobes], vec![0.0; layout.lobes + 1]);
        for i in 0..200_000 {
            let z = (f64::from(i) + 0.5) / 200_000.0;
            let wi = direction(libm::acos(z), GOLDEN_ANGLE * f64::from(i));
            lobes.values(&wi, &mut unit);
            let factor = factors.at(wi, direction(theta, std::f64::consts::PI))[0];
            for (sum, value) in sums.iter_mut().zip(&unit) {
                *sum = (sum.0 + value * factor, sum.1 + value);
            }
        }
        for (k, (sum, weight)) in sums.into_iter().enumerate() {
            // A lobe that stands for two has the same mean on either side.
            assert!((found[k][0] - sum / weight).abs() < 5e-3, "{k}: {} {}", found[k][0], sum / weight);
        }
    }

    #[test]
    fn means_over_lobes_of_both_kinds_are_by_their_values() {
        let size = Size::reciprocal([16, 6, 3]);
        let mut factors = Factors::fit(size, SMOOTH, &[]);
        let nodes = factors.nodes.len();
        let vary = |n: usize| [1.0 + 0.5 * libm::sin(own(size, n) as f64 / nodes as f64 * 20.0); 3];
        factors.nodes.iter_mut().enumerate().for_each(|(n, node)| *node = vary(n));
        let layout = line::Layout::new(3, 1, 1, vec![0.0]);
        let mut q = vec![0.0; layout.stride()];
        (q[0], q[layout.off_plane(0)]) = (-0.5, 0.4);
        for k in 0..3 {
            (q[layout.angle(k)], q[layout.sharpness(k)]) = (0.5, 3.0);
        }
        check_means(&layout, &q, &factors);
        let layout = grid_layout(1, 1);
        let mut q = vec![0.0; layout.stride()];
        q[..3].copy_from_slice(&[0.3, -0.4, 0.7]);
        for k in 0..3 {
            (q[layout.angle(k)], q[layout.off_plane(k)], q[layout.sharpness(k)]) = (0.5, -0.2, 3.0);
        }
        check_means(&layout, &q, &factors);
    }
}
