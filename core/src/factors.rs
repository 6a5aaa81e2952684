//! Factors: what a sum of lobes misses of a material, as a table over the half angle and the difference angle (Rusinkiewicz 1998).
//!
//! One table of RGB factors serves all views. The value is that of the lobes times the factor; density and draws are the lobes' alone,
//! so that a sample's weight is that of the lobes times the factor too.
//!
//! # Variables
//! With `s = wi + wo` and `h = s / |s|`, the nodes are evenly spaced in
//!
//! ```text
//! a = (1 - h.z)^(1/4)      nearly the root of the half angle: dense where highlights are
//! b = (1 - h.wo)^(1/2)     nearly the difference angle
//! ```
//!
//! both in [0, 1] for directions of one hemisphere, and neither has a singular direction: at the normal and at `wi = wo` they are 0. In
//! forms that do not cancel: `1 - h.z = (s.x^2 + s.y^2) / (|s|^2 + s.z |s|)`, and `1 - h.wo = |wi - wo|^2 / (4 + 2 |s|)`, as
//! `h.wo = |s| / 2` for unit vectors.
//!
//! A factor is stored as `q` in 0..=1023, as `(q / 360)^2`, and interpolated bilinearly after squaring.

use crate::format::f32_at;
use crate::lanes::{Lanes, ROUND, dot3, splat3};
#[cfg(feature = "simd")]
use crate::simd::Level;
use crate::simd::{One, Routine};
use crate::single::value_one;
use crate::{Material, Mixture, luminance};
use glam::Vec3;

/// A code over this, squared, is the factor.
pub(crate) const UNIT: f32 = 360.0;

/// Largest code of a channel.
pub(crate) const MOST_CODE: u32 = 1023;

/// Table sizes that there are, along either variable.
pub(crate) const SIZES: core::ops::RangeInclusive<usize> = 2..=32;

/// The factor of a channel of a node; `place` counts the channels.
pub(crate) fn decoded(node: u32, place: usize) -> f32 {
    let root = f64::from(node >> (10 * place) & MOST_CODE) / f64::from(UNIT);
    (root * root) as f32
}

/// Directions of a batch that are evaluated, and then multiplied while they are near: more of them where the caller has room for their
/// values.
const CHUNK: usize = 512;
const OWN_CHUNK: usize = 128;

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

/// Where an outgoing direction lies among four views: what is linear in either share. Two of the views may be the same.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Among {
    /// Within, before and after; beyond, before and after.
    pub views: [[u16; 2]; 2],
    /// The share of those after, and of those beyond.
    pub onward: f32,
    pub outward: f32,
}

impl Among {
    const NOWHERE: Self = Self { views: [[0; 2]; 2], onward: 0.0, outward: 0.0 };
}

impl<'m> Factors<'m> {
    /// None: every factor is 1.
    pub const NONE: Self =
        Self { nodes: &[], albedo_differences: &[], shape: [0; 2], wo: [0.0; 3], place: Among::NOWHERE };

    /// Those of a material, if it has some.
    #[inline(always)]
    pub fn new(material: &Material<'m>, wo: Vec3, place: Among) -> Self {
        let header = &material.header;
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
    fn towards<L: Lanes>(&self, [x, y, z]: [f32; 3]) -> Vec3 {
        let squares = squares::<L>(splat3(self.wo), splat3([x, y, z]));
        let [red, green, blue] = self.between(self.places(squares));
        Vec3::new(red.first(), green.first(), blue.first())
    }

    /// Places among the nodes, from 0 to the last, of what [`squares`] gives.
    #[inline(always)]
    fn places<L: Lanes>(&self, [a, b]: [L; 2]) -> [L; 2] {
        let [half, difference] = self.shape.map(|last| L::splat(last as f32 - 1.0));
        let [a, b] = [a.sqrt().sqrt() * half, b.sqrt() * difference];
        [a.min(half), b.min(difference)]
    }

    /// Factors at places among the nodes.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see lanes: kernels loop over array indices
    fn between<L: Lanes>(&self, [a, b]: [L; 2]) -> [L; 3] {
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

/// `1 - h.z` and `1 - h.wo` of pairs of an outgoing and an incident direction; anything for what is no unit vector.
#[inline(always)]
fn squares<L: Lanes>(wo: [L; 3], wi: [L; 3]) -> [L; 2] {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let sum = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]];
    let apart = [wi[0] - wo[0], wi[1] - wo[1], wi[2] - wo[2]];
    let across = sum[0].mul_add(sum[0], sum[1] * sum[1]);
    let squared = sum[2].mul_add(sum[2], across);
    let length = squared.sqrt();
    // One division for both. Opposite directions at the horizon, to 1e-15, have no half direction: they get that of the normal.
    let a_divisor = sum[2].max(zero).mul_add(length, squared).max(L::splat(1e-30));
    let b_divisor = length.mul_add(L::splat(2.0), L::splat(4.0));
    let inverse = one / (a_divisor * b_divisor);
    [across * (b_divisor * inverse), dot3(apart, apart) * (a_divisor * inverse)]
}

/// The node before a place, which is not the last of `nodes`, and how far beyond it the place lies. At a node that may be the one
/// before, and 1.
#[inline(always)]
fn cell<L: Lanes>(place: L, nodes: f32) -> (L, L) {
    let before = (place - L::splat(0.5)).max(L::splat(0.0)).min(L::splat(nodes - 2.0));
    let before = (before + L::splat(ROUND)) - L::splat(ROUND);
    (before, place - before)
}

/// Value towards one direction, and the luminance of what the lobes have there, for a mixture with factors.
pub(crate) struct FactoredOne;

impl<const N: usize> One<Mixture<'_, N>> for FactoredOne {
    type Output = (Vec3, f32);
    const IS_WIDE: bool = true;
    #[inline(always)]
    fn run<L: Lanes>(m: &Mixture<'_, N>, direction: [f32; 3]) -> (Vec3, f32) {
        // First, as it is the longer chain of dependent operations: the lobes are summed beside it.
        let factor = m.factors.towards::<L::One>(direction);
        let value = value_one::<L, N, true>(m, direction);
        (value * factor, luminance(value))
    }
}

/// Outgoing directions of a batch.
#[derive(Clone, Copy)]
enum Outgoing<'a> {
    /// The same for all.
    One([f32; 3]),
    /// One for each incident direction: in blocks of pairs, which there are with vectors.
    #[cfg_attr(not(feature = "simd"), allow(dead_code))]
    Each([&'a [f32]; 3]),
}

/// Multiplies values by their factors.
struct Multiply<'a, 'm> {
    factors: &'a Factors<'m>,
    wo: Outgoing<'a>,
    wi: [&'a [f32]; 3],
    value: [&'a mut [f32]; 3],
}

/// Widest vector: what fewer directions than that are padded to.
const WIDEST: usize = 16;

/// Vectors that are taken through a stage of the lookup before the next: the roots are a long chain of operations, each of which waits for
/// the one before, and a processor sees no further than one vector's ahead. In stages it takes 0.7 of the time.
const STAGED: usize = 4;

impl Routine for Multiply<'_, '_> {
    type Output = ();
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see lanes: kernels loop over array indices
    fn run<L: Lanes>(self) {
        let Self { factors, wo, wi, value: [red, green, blue] } = self;
        let n = red.len();
        let mut staged = [[L::splat(0.0); 2]; STAGED];
        let mut from = 0;
        while from < n {
            let vectors = STAGED.min((n - from).div_ceil(L::COUNT));
            for i in 0..vectors {
                let at = from + i * L::COUNT;
                let count = L::COUNT.min(n - at);
                let incident =
                    [some::<L>(&wi[0][at..], count), some(&wi[1][at..], count), some(&wi[2][at..], count)];
                let outgoing = match wo {
                    Outgoing::One(wo) => splat3(wo),
                    Outgoing::Each(wo) => {
                        [some(&wo[0][at..], count), some(&wo[1][at..], count), some(&wo[2][at..], count)]
                    }
                };
                staged[i] = squares(outgoing, incident);
            }
            for i in 0..vectors {
                staged[i] = factors.places(staged[i]);
            }
            for i in 0..vectors {
                let at = from + i * L::COUNT;
                let count = L::COUNT.min(n - at);
                let factor = factors.between(staged[i]);
                times(&mut red[at..], factor[0], count);
                times(&mut green[at..], factor[1], count);
                times(&mut blue[at..], factor[2], count);
            }
            from += vectors * L::COUNT;
        }
    }
}

/// The first `count` numbers of a slice, and harmless ones.
#[inline(always)]
fn some<L: Lanes>(from: &[f32], count: usize) -> L {
    if count == L::COUNT {
        return L::load(from);
    }
    let mut padded = [0.5; WIDEST];
    padded[..count].copy_from_slice(&from[..count]);
    L::load(&padded)
}

/// Multiplies the first `count` numbers of a slice.
#[inline(always)]
fn times<L: Lanes>(numbers: &mut [f32], by: L, count: usize) {
    if count == L::COUNT {
        (L::load(numbers) * by).store(numbers);
        return;
    }
    let mut padded = [0.0; WIDEST];
    by.store(&mut padded);
    for i in 0..count {
        numbers[i] *= padded[i];
    }
}

/// Multiplies the values of a block of mixtures, each towards its own direction.
#[cfg(feature = "simd")]
pub(crate) fn multiply_block<const N: usize, const B: usize>(
    level: Level,
    mixtures: &[Mixture<'_, N>],
    directions: &[[f32; B]; 3],
    value: &mut [[f32; B]; 3],
) {
    // A mixture that reflects nothing has none.
    let Some(factors) = mixtures.iter().map(|m| &m.factors).find(|factors| !factors.is_none()) else {
        return;
    };
    let mut wo = [[0.5; B]; 3];
    for (i, m) in mixtures.iter().take(B).enumerate() {
        [wo[0][i], wo[1][i], wo[2][i]] = m.factors.wo;
    }
    let [wi_x, wi_y, wi_z] = directions;
    let [wo_x, wo_y, wo_z] = &wo;
    let [red, green, blue] = value;
    let wo = Outgoing::Each([wo_x, wo_y, wo_z]);
    level.run(Multiply { factors, wo, wi: [wi_x, wi_y, wi_z], value: [red, green, blue] });
}

impl<'m, const N: usize> Mixture<'m, N> {
    /// Bytes of the material that the mixture reads when it is evaluated: its table of factors, empty for none.
    #[inline]
    pub fn factor_bytes(&self) -> &'m [u8] {
        self.factors.nodes
    }

    /// Whether values are multiplied by factors; see [`Material::factor`].
    #[inline]
    pub fn has_factors(&self) -> bool {
        !self.factors.is_none()
    }

    /// Multiplies values towards n directions by their factors.
    pub(crate) fn multiply(&self, wi: [&[f32]; 3], value: [&mut [f32]; 3]) {
        let wo = Outgoing::One(self.factors.wo);
        self.level.run(Multiply { factors: &self.factors, wo, wi, value });
    }

    /// Luminances of values times factors, all slices of one length.
    pub(crate) fn factored_luminance(&self, wi: [&[f32]; 3], luminances: &mut [f32]) {
        let mut value = [[0.0; OWN_CHUNK]; 3];
        for (chunk, out) in luminances.chunks_mut(OWN_CHUNK).enumerate() {
            let (from, count) = (chunk * OWN_CHUNK, out.len());
            let wi = wi.map(|s| &s[from..from + count]);
            let [red, green, blue] = value.each_mut().map(|s| &mut s[..count]);
            self.lobes_into(wi, [red, green, blue]);
            let [red, green, blue] = value.each_mut().map(|s| &mut s[..count]);
            self.multiply(wi, [red, green, blue]);
            for (i, out) in out.iter_mut().enumerate() {
                *out = luminance(Vec3::new(value[0][i], value[1][i], value[2][i]));
            }
        }
    }

    /// Values times factors, all slices of one length.
    pub(crate) fn factored_into(&self, wi: [&[f32]; 3], value: [&mut [f32]; 3]) {
        let n = value[0].len();
        let [red, green, blue] = value;
        for from in (0..n).step_by(CHUNK) {
            let range = from..n.min(from + CHUNK);
            let wi = wi.map(|s| &s[range.clone()]);
            let value = [&mut *red, &mut *green, &mut *blue];
            self.lobes_into(wi, value.map(|s| &mut s[range.clone()]));
            let value = [&mut *red, &mut *green, &mut *blue];
            self.multiply(wi, value.map(|s| &mut s[range.clone()]));
        }
    }
}

impl<const N: usize> Mixture<'_, N> {
    /// Directions, densities, and weights with factors; all slices of one length.
    pub(crate) fn factored_draws(
        &self,
        u: [&[f32]; 3],
        direction: [&mut [f32]; 3],
        pdf: &mut [f32],
        weight: [&mut [f32]; 3],
    ) {
        let n = pdf.len();
        let ([x, y, z], [red, green, blue]) = (direction, weight);
        for from in (0..n).step_by(CHUNK) {
            let range = from..n.min(from + CHUNK);
            let outputs = [&mut *x, &mut *y, &mut *z, &mut *pdf, &mut *red, &mut *green, &mut *blue];
            self.draws_into(u.map(|s| &s[range.clone()]), outputs.map(|s| &mut s[range.clone()]));
            let weight = [&mut *red, &mut *green, &mut *blue];
            let drawn = [&x[range.clone()], &y[range.clone()], &z[range.clone()]];
            self.multiply(drawn, weight.map(|s| &mut s[range.clone()]));
        }
    }
}

impl Material<'_> {
    /// Nodes of the table of factors along the half angle and along the difference angle; `None` without one.
    pub fn factor_nodes(&self) -> Option<[usize; 2]> {
        let nodes = self.header.factors.map(usize::from);
        (nodes[0] > 0).then_some(nodes)
    }

    /// Largest factor of any node and channel, which no factor exceeds but for rounding; 1 without a table.
    ///
    /// The luminance of a sample's weight is at most the power of its mixture times this, where no channel of a lobe is negative.
    pub fn largest_factor(&self) -> f32 {
        if self.factor_nodes().is_none() { 1.0 } else { f32_at(self.bytes, self.header.nodes() - 4) }
    }

    /// The factor of a node, linear sRGB; `None` past either end, and without a table.
    pub fn factor_node(&self, half: usize, difference: usize) -> Option<[f32; 3]> {
        let [halves, differences] = self.factor_nodes()?;
        let offset = self.header.nodes() + 4 * (half * differences + difference);
        (half < halves && difference < differences)
            .then(|| [0, 1, 2].map(|place| decoded(crate::format::u32_at(self.bytes, offset), place)))
    }

    /// What the factors change of the albedo of a view, relative to the luminance of the lobes' own, linear sRGB, as it is stored; `None`
    /// past the end, and without a table. [`Mixture::albedo`] has it in it.
    pub fn view_albedo_difference(&self, view: usize) -> Option<[f32; 3]> {
        let number = |i: usize| f32_at(self.bytes, self.header.albedo_difference(view) + 4 * i);
        (self.factor_nodes().is_some() && view < self.header.views).then(|| [0, 1, 2].map(number))
    }

    /// What the value of the lobes is multiplied by for an outgoing and an incident direction, unit vectors above the horizon; linear
    /// sRGB, 1 without a table.
    ///
    /// The two may be exchanged. Interpolated bilinearly between the nodes, in `(1 - h.z)^(1/4)` and `(1 - h.wo)^(1/2)` with the half
    /// direction `h = (wi + wo) / |wi + wo|`, from 0 at the first node to 1 at the last. Accuracy: 6e-6 of the largest factor.
    pub fn factor(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        if self.factor_nodes().is_none() {
            return Vec3::ONE;
        }
        Factors::new(self, wo, Among::NOWHERE).towards::<f32>(wi.to_array())
    }
}
