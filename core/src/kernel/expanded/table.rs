//! How an expanded material lies in memory, and where in it an outgoing direction is.
//!
//! Chunks of sixteen numbers, the first at a multiple of 64 bytes:
//!
//! ```text
//! knots    angles of the views, angles of those after them, rows per radian between the two
//! rows     per row: a head, then for each sixteen lobes x, z, sharpness, red, green, blue,
//!          and y if lobes are mirrored
//! head     1 / squeeze, albedo of the diffuse term in red, green, blue and its luminance,
//!          power of the lobes, their albedo
//! ```
//!
//! Every view has a row, and between two views rows are evenly spaced in the angle of the outgoing direction:
//! at a view the stored numbers have a kink, and a row on either side of one would cut it off. So the error
//! falls with the square of the number of rows.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use crate::material::borrowed::{Material, MaterialRef};
use crate::material::layout::Header;
use crate::simd::lanes::{Lanes, Numbers, ROUND, WIDEST};

/// Places in the head of a row.
pub(crate) const INVERSE_SQUEEZE: usize = 0;
pub(crate) const DIFFUSE: usize = 1;
pub(crate) const DIFFUSE_POWER: usize = 4;
pub(crate) const LOBES_POWER: usize = 5;
/// How many of them hits of a block need.
pub(crate) const HIT_HEAD: usize = 6;
pub(crate) const LOBES_ALBEDO: usize = 6;
/// How many there are.
pub(crate) const HEAD: usize = 9;

/// Chunks of sixteen lobes: x, z, sharpness and three powers; and y if lobes are mirrored.
pub(crate) const IN_PLANE: usize = 6;
pub(crate) const MIRRORED: usize = 7;

/// An isotropic material made ready for speed: the lobes for many angles of the outgoing direction, in linear
/// numbers that are interpolated linearly, in memory of the caller.
///
/// [`Material::prepare`] works out powers of two, sines and normalisers at each hit; an expanded material has
/// done so once, for each of its rows. Between rows it interpolates axes (made unit vectors again),
/// sharpness, and the power of each lobe: its integral, in each colour. Value and density are both computed from these, so the
/// density integrates to 1 as exactly as that of a [`Mixture`](crate::Mixture). Everything is continuous in both directions.
///
/// It costs memory: 448 bytes a row for up to sixteen lobes, 512 if some are mirrored. Its values differ from
/// those of [`Material::prepare`] by an error that falls with the square of the number of rows; at
/// [`DEFAULT_ROWS`](Self::DEFAULT_ROWS) it is below 1e-3 of the largest value, see `docs/hits.md`.
/// Factors stay in the bytes of the material, which it borrows.
///
/// Anisotropic materials are not expanded: their rows would lie over two angles, and take the square of the
/// memory.
///
/// ```
/// # use srbf_core::{Draws, Expanded, Line, Material, Mixture, PlaneLobe, View};
/// # let color_differences = [0.0; 2];
/// # let lobe = |angle| PlaneLobe {
/// #     angle, off_plane: 0.0, log2_sharpness: 5.0, log2_luminance: -1.0, color_differences,
/// # };
/// # let view = |theta, lobes| View {
/// #     theta, log2_squeeze: 0.0, log2_diffuse: -3.0, diffuse_color_differences: color_differences, lobes,
/// # };
/// # let (normal, tilted) = ([lobe(0.0)], [lobe(1.2)]);
/// # let views = [view(0.0, &normal[..]), view(1.3, &tilted[..])];
/// # let line = Line { views: &views, squeezed: 0, mirrored: 0, factors: None };
/// # let mut bytes = [0; 256];
/// # let length = line.encode("an example", &mut bytes)?;
/// # let material = Material::from_bytes(&bytes[..length])?;
/// // Once, when a scene is loaded.
/// let mut memory = vec![0.0; material.expanded_len(Expanded::DEFAULT_ROWS)];
/// let expanded = Expanded::new(&material, Expanded::DEFAULT_ROWS, &mut memory)?;
///
/// // At many hits, each with an outgoing direction of its own: where the paths go on.
/// let (wo, u) = ([[0.6, 0.0], [0.0, 0.28], [0.8, 0.96]], [[0.3, 0.7], [0.6, 0.2], [0.1, 0.9]]);
/// let (mut direction, mut pdf, mut weight) = ([[0.0; 2]; 3], [0.0; 2], [[0.0; 2]; 3]);
/// let draws = Draws {
///     u: u.each_ref().map(|s| &s[..]),
///     direction: direction.each_mut().map(|s| &mut s[..]),
///     pdf: Some(&mut pdf),
///     weight: Some(weight.each_mut().map(|s| &mut s[..])),
/// };
/// expanded.ask(wo.each_ref().map(|s| &s[..]), draws.into())?;
/// assert!(pdf[0] > 0.0 && weight[0][0] < 1.0);
///
/// // At one hit: a mixture, which has all other methods.
/// let mut mixture = Mixture::<16>::empty();
/// expanded.prepare([0.6, 0.0, 0.8], &mut mixture)?;
/// assert!((mixture.pdf(direction.map(|d| d[0])) / pdf[0] - 1.0).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Expanded<'m> {
    pub(super) material: Material<&'m [u8]>,
    /// For each view but the last its angle, that of the next, and how many rows a radian has between them;
    /// then zeros.
    pub(super) knots: [&'m [f32]; 3],
    pub(super) knot_count: usize,
    pub(super) chunks: &'m [Numbers],
    pub(super) rows: usize,
    /// Chunks of a row.
    pub(super) stride: usize,
    /// No axis turns so far from a row to the next that its length between them needs a root. No lobe is so wide that its
    /// normaliser needs a series.
    pub(super) is_plain: bool,
    /// Some row has a diffuse term.
    pub(super) any_diffuse: bool,
}

/// The whole number, up to 32767, that was added to [`ROUND`]: in its low bits, without a conversion.
#[inline(always)]
pub(super) fn whole(number: f32) -> usize {
    (number.to_bits() & 0x7fff) as usize
}

/// Where everything lies, in chunks.
#[derive(Clone, Copy)]
pub(super) struct Shape {
    /// Knots: one for each view, or, where there are more views than rows, the first and the last.
    pub knots: usize,
    /// Chunks of one number of all knots.
    pub knot_chunks: usize,
    /// Chunks of a group.
    pub width: usize,
    /// Chunks of a row.
    pub stride: usize,
}

impl Shape {
    #[inline(always)]
    pub fn new(header: &Header, rows: usize) -> Self {
        let views = header.views;
        let knots = if views <= rows { views } else { 2 };
        let groups = header.lobe_count().div_ceil(WIDEST); // of up to sixteen lobes
        let width = if header.mirrored > 0 { MIRRORED } else { IN_PLANE };
        let stride = 1 + groups * width;
        Self { knots, knot_chunks: knots.div_ceil(WIDEST), width, stride }
    }
}

impl<B: AsRef<[u8]>> Material<B> {
    /// The number of f32 that [`Expanded::new`] takes for a number of rows: up to 15 more than are used, for rows to begin
    /// at multiples of 64 bytes wherever the memory begins.
    pub fn expanded_len(&self, rows: usize) -> usize {
        expanded_len(self.borrowed().header, rows)
    }
}

pub(super) fn expanded_len(header: &Header, rows: usize) -> usize {
    let shape = Shape::new(header, rows);
    rows.saturating_mul(shape.stride)
        .saturating_add(3 * shape.knot_chunks)
        .saturating_mul(WIDEST)
        .saturating_add(WIDEST - 1)
}

/// Places that are closer to a row than this share of themselves are at the row.
const SLACK: f32 = 2.4e-7;

impl<'m> Expanded<'m> {
    /// Rows at which the error is below 1e-3 of the largest value on every material that was tried.
    pub const DEFAULT_ROWS: usize = 1024;

    /// Most rows.
    pub const MAX_ROWS: usize = 16_384;

    /// The material that was expanded.
    pub fn material(&self) -> &Material<&'m [u8]> {
        &self.material
    }

    /// The places of outgoing directions among the rows, by their angle from the normal: the row before, which
    /// [`whole`] reads, and how far beyond it, in [0, 1]. Anything for a NaN.
    #[inline(always)]
    pub(super) fn places<L: Lanes>(&self, theta: L) -> [L; 2] {
        let mut place = L::splat(0.0);
        let [from, to, per_radian] = self.knots;
        for k in 0..from.len().min(to.len()).min(per_radian.len()).min(self.knot_count) {
            let within = theta.max(L::splat(from[k])).min(L::splat(to[k])) - L::splat(from[k]);
            place = within.mul_add(L::splat(per_radian[k]), place);
        }
        self.split(place)
    }

    /// The place of one outgoing direction: lanes are views.
    #[inline(always)]
    pub(super) fn place<L: Lanes>(&self, theta: f32) -> [f32; 2] {
        let (theta, mut places) = (L::splat(theta), L::splat(0.0));
        let [from, to, per_radian] = self.knots;
        let mut k = 0;
        while k < self.knot_count && k + L::COUNT <= from.len() {
            let from = L::load(&from[k..]);
            let within = theta.max(from).min(L::load(&to[k..])) - from;
            places = within.mul_add(L::load(&per_radian[k..]), places);
            k += L::COUNT;
        }
        let [whole, beyond] = self.split(L::One::splat(places.sum()));
        [whole.first(), beyond.first()]
    }

    /// A place as the row before it and the distance from that row.
    #[inline(always)]
    fn split<L: Lanes>(&self, place: L) -> [L; 2] {
        // The row below, or at a row perhaps the one before that, and 1.
        let before = (place - L::splat(0.5)).max(L::splat(0.0)).min(L::splat((self.rows - 2) as f32));
        let whole = before + L::splat(ROUND);
        let before = whole - L::splat(ROUND);
        // A row is met exactly where its angle is, and beyond the last view: a place is a sum, off by its rounding, and the
        // smaller of two numbers would be off by that share of the larger one.
        let beyond = (place - before).max(L::splat(0.0)).min(L::splat(1.0));
        let slack = place * L::splat(SLACK);
        let beyond = L::select(beyond.lt(slack), L::splat(0.0), beyond);
        [whole, L::select((L::splat(1.0) - slack).lt(beyond), L::splat(1.0), beyond)]
    }

    /// The chunks of a row and of the next, which there is whatever the number.
    #[inline(always)]
    pub(super) fn two_rows(&self, row: usize) -> [&'m [Numbers]; 2] {
        let both = &self.chunks[row.min(self.rows - 2) * self.stride..][..2 * self.stride];
        both.split_at(self.stride).into()
    }
}

/// Angle of the first and of the last view.
pub(super) fn angles(material: MaterialRef<'_>) -> [f32; 2] {
    [0, material.header.views - 1].map(|view| material.header.angle(material.bytes, view))
}
