//! Factors: the part of a material that a sum of lobes misses, as a table over half angle, difference angle and azimuth
//! (Rusinkiewicz 1998).
//!
//! One table of RGB factors serves all views. The value is that of the lobes times the factor; density and
//! draws are the lobes' alone, so that a sample's weight is that of the lobes times the factor too.
//!
//! # Variables
//! With `s = wi + wo`, `d = wi - wo` and `h = s / |s|`, the nodes are evenly spaced in
//!
//! ```text
//! a = (1 - h.z)^(1/4)      nearly the root of the half angle: dense where highlights are
//! b = (1 - h.wo)^(1/2)     nearly the difference angle
//! c = cos^2 phi            of the azimuth of wi round h, from the normal: 1 in the plane of incidence
//! ```
//!
//! all in [0, 1] for directions of one hemisphere, and the same where the two are exchanged. A signed table has
//! `cos phi |cos phi|` for c, in [-1, 1], which changes its sign there. It has the part that is not reciprocal. In forms that do not cancel:
//! `1 - h.z = (s.x^2 + s.y^2) / (|s|^2 + s.z |s|)`, and `1 - h.wo = |d|^2 / (4 + 2 |s|)`, as `h.wo = |s| / 2` for
//! unit vectors. As d is perpendicular to h, the azimuth is that of d. With the normal's part perpendicular to h, of length
//! `(s.x^2 + s.y^2)^(1/2) / |s|`, it is `c = d.z^2 |s|^2 / (|d|^2 (s.x^2 + s.y^2))`.
//!
//! At `h = z` and at `wi = wo` there is no azimuth: there a is 0, or b, and the nodes are the same for all azimuths.
//!
//! Nodes are interpolated linearly along each variable, after their codes have been squared.

#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use crate::material::borrowed::{Material, MaterialRef};
use crate::material::factor_table::scale;
use crate::material::layout::{f32_at, part};
use crate::simd::lanes::{Lanes, NodeCodes, ROUND, dot3, splat3};
use glam::Vec3;

/// Added to the bits of a channel of a signed table.
const SIGNED: u8 = 128;

/// A table of factors in the bytes of a material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nodes<'m> {
    /// Their codes; empty for none.
    codes: &'m [u8],
    /// Nodes along a, b and c.
    shape: [u8; 3],
    /// Bits of a channel, and [`SIGNED`] if c has its sign: in one byte, as small processors have little stack.
    code: u8,
    /// The unit of the square of a code.
    scale: f32,
}

/// The factors of a mixture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factors<'m> {
    pub nodes: Nodes<'m>,
    /// The albedo differences of the views, three numbers each.
    albedo_differences: &'m [u8],
    /// The outgoing direction.
    pub wo: [f32; 3],
    place: Among,
}

/// Where an outgoing direction lies among four views: numbers that are linear in either share. Two of the views may be
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

impl<'m> Nodes<'m> {
    /// None: every factor is 1.
    pub const NONE: Self = Self { codes: &[], shape: [0; 3], code: 8, scale: 0.0 };

    /// Those of a material, or none.
    #[inline(always)]
    pub fn new(material: MaterialRef<'m>) -> Self {
        let header = material.header;
        if !header.has_factors() {
            return Self::NONE;
        }
        let start = header.nodes();
        // Two nodes are read as eight bytes, of which the last may lie behind them: there is a checksum at least.
        let end = header.nodes_end() + 8 - 2 * header.node_len();
        let scale = scale(header.bits, f32_at(material.bytes, start - 4));
        Self {
            codes: part(material.bytes, start..end),
            shape: header.factors,
            code: header.bits + if header.has_signed_factors { SIGNED } else { 0 },
            scale,
        }
    }

    #[inline(always)]
    pub fn is_none(&self) -> bool {
        self.codes.is_empty()
    }

    /// Whether they are the same bytes.
    pub fn is(&self, other: &Self) -> bool {
        self.codes.as_ptr() == other.codes.as_ptr() || self.codes.len() + other.codes.len() == 0
    }

    /// The bytes that are read.
    #[inline(always)]
    pub fn bytes(&self) -> &'m [u8] {
        self.codes
    }

    /// The factor of one pair of unit vectors above the horizon; linear sRGB. In scalars: the result
    /// equals that of one lane of a vector, but for rounding. There has to be a table.
    #[inline(always)]
    pub fn towards<L: Lanes>(&self, wo: [f32; 3], wi: [f32; 3]) -> Vec3 {
        let [red, green, blue] = self.of_pairs(splat3::<L>(wo), splat3(wi));
        Vec3::new(red.first(), green.first(), blue.first())
    }

    /// The factors of pairs of unit vectors above the horizon, one a lane; linear sRGB. There has to be a table.
    #[inline(always)]
    pub fn of_pairs<L: Lanes>(&self, wo: [L; 3], wi: [L; 3]) -> [L; 3] {
        self.between(self.places(variables(wo, wi, self.has_azimuth())))
    }

    /// Whether factors depend on the azimuth.
    #[inline(always)]
    pub fn has_azimuth(&self) -> bool {
        self.shape[2] > 1
    }

    /// Places among the nodes, from 0 to the last, of what [`variables`] gives.
    #[inline(always)]
    pub fn places<L: Lanes>(&self, [a, b, c]: [L; 3]) -> [L; 3] {
        let [half, difference, azimuth] = self.last();
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let c = if self.code >= SIGNED { (c + one).max(zero) * L::splat(0.5) } else { c.abs() };
        let [a, b, c] = [a.sqrt().sqrt() * half, b.sqrt() * difference, c * azimuth];
        [a.min(half), b.min(difference), c.min(azimuth)]
    }

    /// The last node along each variable.
    #[inline(always)]
    fn last<L: Lanes>(&self) -> [L; 3] {
        let mut last = [L::splat(0.0); 3];
        for i in 0..3 {
            last[i] = L::splat(f32::from(self.shape[i]) - 1.0);
        }
        last
    }

    /// Factors at places among the nodes.
    #[inline(always)]
    pub fn between<L: Lanes>(&self, [a, b, c]: [L; 3]) -> [L; 3] {
        let [half, difference] = [f32::from(self.shape[0]), f32::from(self.shape[1])];
        let (i, toward_half) = cell(a, half);
        let (j, toward_difference) = cell(b, difference);
        let mut start = i.mul_add(L::splat(difference), j);
        let codes = NodeCodes { bytes: self.codes, bits: u32::from(self.code % SIGNED) };
        let rows = [L::splat(1.0) - toward_half, toward_half];
        let columns = [L::splat(1.0) - toward_difference, toward_difference];
        let mut factor = [L::splat(0.0); 3];
        if self.has_azimuth() {
            let (k, toward_azimuth) = cell(c, f32::from(self.shape[2]));
            start = k.mul_add(L::splat(half * difference), start);
            let before = L::splat(1.0) - toward_azimuth;
            add_plane(codes, start, difference, [rows[0] * before, rows[1] * before], columns, &mut factor);
            start = start + L::splat(half * difference);
            let rows = [rows[0] * toward_azimuth, rows[1] * toward_azimuth];
            add_plane(codes, start, difference, rows, columns, &mut factor);
        } else {
            add_plane(codes, start, difference, rows, columns, &mut factor);
        }
        // A channel stands above the one before by as many bits as it has: here it is squared.
        let shrink = if self.code % SIGNED == 8 { 1.0 / 65_536.0 } else { 1.0 / 1_048_576.0 };
        let mut scale = self.scale;
        for channel in 0..3 {
            factor[channel] = factor[channel] * L::splat(scale);
            scale *= shrink;
        }
        factor
    }
}

/// Adds the nodes of one azimuth, from those at a place on, with weights along the half angle and the difference angle.
#[inline(always)]
fn add_plane<L: Lanes>(
    codes: NodeCodes<'_>,
    start: L,
    difference: f32,
    rows: [L; 2],
    columns: [L; 2],
    factor: &mut [L; 3],
) {
    for row in 0..2 {
        let pair = L::node_pairs(codes, start + L::splat(row as f32 * difference));
        for column in 0..2 {
            let weight = rows[row] * columns[column];
            for channel in 0..3 {
                let root = pair[column][channel];
                factor[channel] = (weight * root).mul_add(root, factor[channel]);
            }
        }
    }
}

impl<'m> Factors<'m> {
    /// None: every factor is 1.
    pub const NONE: Self =
        Self { nodes: Nodes::NONE, albedo_differences: &[], wo: [0.0; 3], place: Among::NOWHERE };

    /// Those of a material that has some.
    #[inline(always)]
    pub fn new(material: MaterialRef<'m>, wo: Vec3, place: Among) -> Self {
        let header = material.header;
        let albedo_differences =
            part(material.bytes, header.albedo_difference(0)..header.albedo_difference(header.views));
        Self { nodes: Nodes::new(material), albedo_differences, wo: wo.to_array(), place }
    }

    /// The change of the mixture's albedo by the factors, over its power: interpolated between the views.
    pub fn albedo_difference(&self) -> Vec3 {
        let Among { views, onward, outward } = self.place;
        let stored = |view: u16, i: usize| f32_at(self.albedo_differences, 12 * usize::from(view) + 4 * i);
        let ring = |[a, b]: [u16; 2], i| stored(a, i) + onward * (stored(b, i) - stored(a, i));
        let between = |i| ring(views[0], i) + outward * (ring(views[1], i) - ring(views[0], i));
        Vec3::new(between(0), between(1), between(2))
    }

    #[inline(always)]
    pub fn is_none(&self) -> bool {
        self.nodes.is_none()
    }
}

/// The variables of pairs of an outgoing and an incident direction: `1 - h.z`, `1 - h.wo` and `cos phi |cos phi|`, the last if it is
/// asked for. Anything for a vector that is no unit vector.
#[inline(always)]
pub(crate) fn variables<L: Lanes>(wo: [L; 3], wi: [L; 3], has_azimuth: bool) -> [L; 3] {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let sum = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]];
    let apart = [wi[0] - wo[0], wi[1] - wo[1], wi[2] - wo[2]];
    let across = sum[0].mul_add(sum[0], sum[1] * sum[1]);
    let squared = sum[2].mul_add(sum[2], across);
    let length = squared.sqrt();
    let distance = dot3(apart, apart);
    // One division for both. Opposite directions at the horizon, to 1e-15, have no half direction: they get
    // that of the normal.
    let a_divisor = sum[2].max(zero).mul_add(length, squared).max(L::splat(1e-30));
    let b_divisor = length.mul_add(L::splat(2.0), L::splat(4.0));
    let inverse = one / (a_divisor * b_divisor);
    let mut azimuth = zero;
    if has_azimuth {
        // Where the divisor is as small there is no azimuth.
        azimuth = apart[2] * apart[2].abs() * squared / (distance * across).max(L::splat(1e-30));
    }
    [across * (b_divisor * inverse), distance * (a_divisor * inverse), azimuth]
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
    /// The factor on the value of the lobes for an outgoing and an incident direction, unit vectors
    /// above the horizon; linear sRGB, 1 without a table.
    ///
    /// The half direction is `h = (wi + wo) / |wi + wo|`. The factor is linear between nodes in `(1 - h.z)^(1/4)`,
    /// `(1 - h.wo)^(1/2)` and the squared cosine of the azimuth of wi round h from the normal. Each goes from 0 at the
    /// first node to 1 at the last, and the two directions may be exchanged. In a signed table
    /// ([`has_signed_factors`](Self::has_signed_factors)) the last has the sign of the cosine, and goes from -1. Accuracy: 6e-6 of the largest factor.
    pub fn factor(&self, wo: impl Into<Vec3>, wi: impl Into<Vec3>) -> Vec3 {
        let (wo, wi): (Vec3, Vec3) = (wo.into(), wi.into());
        let nodes = Nodes::new(self.borrowed());
        if nodes.is_none() { Vec3::ONE } else { nodes.towards::<f32>(wo.to_array(), wi.to_array()) }
    }
}
