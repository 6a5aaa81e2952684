//! Factors: what a sum of lobes misses of a material, as a table over the half angle and the difference angle
//! (Rusinkiewicz 1998).
//!
//! One table of RGB factors serves all views. The value is that of the lobes times the factor; density and
//! draws are the lobes' alone, so that a sample's weight is that of the lobes times the factor too.
//!
//! # Variables
//! With `s = wi + wo` and `h = s / |s|`, the nodes are evenly spaced in
//!
//! ```text
//! a = (1 - h.z)^(1/4)      nearly the root of the half angle: dense where highlights are
//! b = (1 - h.wo)^(1/2)     nearly the difference angle
//! ```
//!
//! both in [0, 1] for directions of one hemisphere, and neither has a singular direction: at the normal and
//! at `wi = wo` they are 0. In forms that do not cancel: `1 - h.z = (s.x^2 + s.y^2) / (|s|^2 + s.z |s|)`, and
//! `1 - h.wo = |wi - wo|^2 / (4 + 2 |s|)`, as `h.wo = |s| / 2` for unit vectors.
//!
//! Nodes are interpolated bilinearly, after their codes have been squared.

use crate::material::borrowed::{Material, MaterialRef};
use crate::material::factor_table::UNIT;
use crate::material::layout::f32_at;
use crate::simd::lanes::{Lanes, ROUND, dot3, splat3};
use glam::Vec3;

/// The factors of a mixture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factors<'m> {
    /// The nodes, four bytes each, in the bytes of the material; empty for none.
    pub nodes: &'m [u8],
    /// The albedo differences of the views, three numbers each, before them.
    albedo_differences: &'m [u8],
    /// Nodes along a and b.
    shape: [u32; 2],
    /// The outgoing direction.
    pub wo: [f32; 3],
    place: Among,
}

/// Where an outgoing direction lies among four views: what is linear in either share. Two of the views may be
/// the same.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Among {
    /// Within, before and after; beyond, before and after.
    pub views: [[u16; 2]; 2],
    /// The share of those after, and of those beyond.
    pub onward: f32,
    pub outward: f32,
}

impl Among {
    pub const NOWHERE: Self = Self { views: [[0; 2]; 2], onward: 0.0, outward: 0.0 };
}

impl<'m> Factors<'m> {
    /// None: every factor is 1.
    pub const NONE: Self =
        Self { nodes: &[], albedo_differences: &[], shape: [0; 2], wo: [0.0; 3], place: Among::NOWHERE };

    /// Those of a material, if it has some.
    #[inline(always)]
    pub fn new(material: MaterialRef<'m>, wo: Vec3, place: Among) -> Self {
        let header = material.header;
        let [half, difference] = header.factors.map(u32::from);
        let table = &material.bytes[header.albedo_difference(0)..];
        let (albedo_differences, rest) = table.split_at(12 * header.views);
        let nodes = &rest[4..4 + 4 * (half * difference) as usize];
        Self { nodes, albedo_differences, shape: [half, difference], wo: wo.to_array(), place }
    }

    /// What the factors change of the mixture's albedo, over its power: interpolated between the views.
    pub fn albedo_difference(&self) -> Vec3 {
        let Among { views, onward, outward } = self.place;
        let stored = |view: u16, i: usize| f32_at(self.albedo_differences, 12 * usize::from(view) + 4 * i);
        let ring = |[a, b]: [u16; 2], i| stored(a, i) + onward * (stored(b, i) - stored(a, i));
        let between = |i| ring(views[0], i) + outward * (ring(views[1], i) - ring(views[0], i));
        Vec3::new(between(0), between(1), between(2))
    }

    #[inline(always)]
    pub fn is_none(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The factor towards one direction, in scalars; it has what one lane of a vector has, but for rounding.
    #[inline(always)]
    pub fn towards<L: Lanes>(&self, [x, y, z]: [f32; 3]) -> Vec3 {
        let squares = squares::<L>(splat3(self.wo), splat3([x, y, z]));
        let [red, green, blue] = self.between(self.places(squares));
        Vec3::new(red.first(), green.first(), blue.first())
    }

    /// Places among the nodes, from 0 to the last, of what [`squares`] gives.
    #[inline(always)]
    pub fn places<L: Lanes>(&self, [a, b]: [L; 2]) -> [L; 2] {
        let [half, difference] = self.shape.map(|last| L::splat(last as f32 - 1.0));
        let [a, b] = [a.sqrt().sqrt() * half, b.sqrt() * difference];
        [a.min(half), b.min(difference)]
    }

    /// Factors at places among the nodes.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
    pub fn between<L: Lanes>(&self, [a, b]: [L; 2]) -> [L; 3] {
        let [half, difference] = [self.shape[0] as f32, self.shape[1] as f32];
        let (i, toward_half) = cell(a, half);
        let (j, toward_difference) = cell(b, difference);
        let start = i.mul_add(L::splat(difference), j);
        let rows = [L::splat(1.0) - toward_half, toward_half];
        let columns = [L::splat(1.0) - toward_difference, toward_difference];
        let mut factor = [L::splat(0.0); 3];
        for row in 0..2 {
            let pair = L::node_pairs(self.nodes, start + L::splat(row as f32 * difference));
            for column in 0..2 {
                let weight = rows[row] * columns[column];
                for channel in 0..3 {
                    let root = pair[column][channel];
                    factor[channel] = (weight * root).mul_add(root, factor[channel]);
                }
            }
        }
        for channel in 0..3 {
            let unit = 1.0 / (UNIT * (1u32 << (10 * channel)) as f32);
            factor[channel] = factor[channel] * L::splat(unit * unit);
        }
        factor
    }
}

/// `1 - h.z` and `1 - h.wo` of pairs of an outgoing and an incident direction; anything for what is no unit
/// vector.
#[inline(always)]
pub(crate) fn squares<L: Lanes>(wo: [L; 3], wi: [L; 3]) -> [L; 2] {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let sum = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]];
    let apart = [wi[0] - wo[0], wi[1] - wo[1], wi[2] - wo[2]];
    let across = sum[0].mul_add(sum[0], sum[1] * sum[1]);
    let squared = sum[2].mul_add(sum[2], across);
    let length = squared.sqrt();
    // One division for both. Opposite directions at the horizon, to 1e-15, have no half direction: they get
    // that of the normal.
    let a_divisor = sum[2].max(zero).mul_add(length, squared).max(L::splat(1e-30));
    let b_divisor = length.mul_add(L::splat(2.0), L::splat(4.0));
    let inverse = one / (a_divisor * b_divisor);
    [across * (b_divisor * inverse), dot3(apart, apart) * (a_divisor * inverse)]
}

/// The node before a place, which is not the last of `nodes`, and how far beyond it the place lies. At a node
/// that may be the one before, and 1.
#[inline(always)]
fn cell<L: Lanes>(place: L, nodes: f32) -> (L, L) {
    let before = (place - L::splat(0.5)).max(L::splat(0.0)).min(L::splat(nodes - 2.0));
    let before = (before + L::splat(ROUND)) - L::splat(ROUND);
    (before, place - before)
}

impl<B: AsRef<[u8]>> Material<B> {
    /// What the value of the lobes is multiplied by for an outgoing and an incident direction, unit vectors
    /// above the horizon; linear sRGB, 1 without a table.
    ///
    /// The two may be exchanged. Interpolated bilinearly between the nodes, in `(1 - h.z)^(1/4)` and `(1 -
    /// h.wo)^(1/2)` with the half direction `h = (wi + wo) / |wi + wo|`, from 0 at the first node to 1 at the
    /// last. Accuracy: 6e-6 of the largest factor.
    pub fn factor(&self, wo: impl Into<Vec3>, wi: impl Into<Vec3>) -> Vec3 {
        let (wo, wi): (Vec3, Vec3) = (wo.into(), wi.into());
        if self.factor_nodes().is_none() {
            return Vec3::ONE;
        }
        Factors::new(self.borrowed(), wo, Among::NOWHERE).towards::<f32>(wi.to_array())
    }
}
