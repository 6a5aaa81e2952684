//! Means of factors over lobes: of directions that a lobe draws, on a spiral about its axis.

use super::{Factors, place};
use crate::family::layout::{Layout, Views};
use crate::family::unit::PANEL;
use crate::numeric::GOLDEN_ANGLE;
use crate::numeric::vector::{Operation, Vectors};
use std::f64::consts::TAU;

/// The means of one view.
pub(super) struct Means<'a, V: Views> {
    pub factors: &'a Factors,
    pub layout: &'a Layout<V>,
    pub q: &'a [f64],
    pub wo: [f64; 3],
    /// Directions of each mean.
    pub averaged: usize,
}

/// A number for every direction of a panel.
type Column = [f64; PANEL];

/// Points of the spiral: the share of a lobe that is within each, and the sine and the cosine of its angle about the axis.
struct Spiral {
    share: Column,
    sin: Column,
    cos: Column,
    /// `-ln(1 - share)`.
    depth: Column,
    /// How many of them count.
    count: usize,
}

/// Sharpness from which on nothing of a lobe is left at the direction opposite to its axis.
const WITHOUT_BACK: f64 = 20.0;

impl Spiral {
    fn panels(averaged: usize) -> Vec<Self> {
        let panel = |first: usize| {
            let zero = [0.0; PANEL];
            let count = PANEL.min(averaged - first);
            let mut panel = Self { share: zero, sin: zero, cos: zero, depth: zero, count };
            for n in 0..count {
                let i = (first + n) as f64;
                panel.share[n] = (i + 0.5) / averaged as f64;
                (panel.sin[n], panel.cos[n]) = libm::sincos((GOLDEN_ANGLE * i) % TAU);
                panel.depth[n] = -libm::log1p(-panel.share[n]);
            }
            panel
        };
        (0..averaged).step_by(PANEL).map(panel).collect()
    }
}

impl<V: Views> Operation for Means<'_, V> {
    type Output = Vec<[f64; 3]>;

    #[inline(always)]
    fn run<W: Vectors>(self, _: W) -> Vec<[f64; 3]> {
        let Self { layout, q, averaged, .. } = self;
        let spiral = Spiral::panels(averaged);
        // A node is a whole register.
        let nodes: Vec<[f64; 4]> = self.factors.nodes.iter().map(|[r, g, b]| [*r, *g, *b, 0.0]).collect();
        let mut means = Vec::with_capacity(layout.lobes + 1);
        for k in 0..layout.lobes {
            let s = libm::exp(q[layout.sharpness(k)]);
            let [axis, along, across] = V::frame(layout, q, k);
            let [xx, xy, yy] = if k < layout.squeezed { V::stretch(q) } else { [1.0, 0.0, 1.0] };
            let outside = libm::expm1(-2.0 * s);
            let mut sum = [0.0; 4];
            for panel in &spiral {
                let mut depth = panel.depth;
                if s < WITHOUT_BACK {
                    depth = panel.share.map(|u| -libm::log1p(u * outside));
                }
                let mut at = [[0.0; PANEL]; 3];
                for n in 0..PANEL {
                    let w = (depth[n] / s).min(2.0);
                    let r = (w * (2.0 - w)).sqrt();
                    let [x, y, z] = [0, 1, 2].map(|i| {
                        axis[i] * (1.0 - w) + r * (along[i] * panel.cos[n] + across[i] * panel.sin[n])
                    });
                    let (x, y) = (xx * x + xy * y, xy * x + yy * y);
                    let inverse = 1.0 / (x * x + y * y + z * z).sqrt();
                    (at[0][n], at[1][n], at[2][n]) = (x * inverse, y * inverse, z.abs() * inverse);
                }
                self.add(panel.count, &at, &nodes, &mut sum);
            }
            means.push([0, 1, 2].map(|c| sum[c] / averaged as f64));
        }
        let mut sum = [0.0; 4];
        for panel in &spiral {
            let r = panel.share.map(f64::sqrt);
            let times = |column: &Column| std::array::from_fn(|n| r[n] * column[n]);
            let at = [times(&panel.cos), times(&panel.sin), panel.share.map(|u| (1.0 - u).sqrt())];
            self.add(panel.count, &at, &nodes, &mut sum);
        }
        means.push([0, 1, 2].map(|c| sum[c] / averaged as f64));
        means
    }
}

impl<V: Views> Means<'_, V> {
    /// Adds the factors of some incident directions.
    #[inline(always)]
    fn add(&self, count: usize, at: &[Column; 3], nodes: &[[f64; 4]], sum: &mut [f64; 4]) {
        let mut places = [[0.0; PANEL]; 3];
        for n in 0..PANEL {
            let [x, y, z] = place(self.factors.size, [at[0][n], at[1][n], at[2][n]], self.wo);
            (places[0][n], places[1][n], places[2][n]) = (x, y, z);
        }
        let [x, y, z] = &places;
        for ((x, y), z) in x.iter().zip(y).zip(z).take(count) {
            let factor = self.factors.of([*x, *y, *z], |node| nodes[node]);
            (0..4).for_each(|c| sum[c] += factor[c]);
        }
    }
}
