//! The `.srbf` bytes of anisotropic materials: views over the hemisphere, on rings round the normal.
//!
//! ```text
//! 12  u32       kind, 1
//! 20  u32       angles from the normal T, 1 to 1024; the first view is the normal itself, each further angle a ring of views
//! 36  u32       views of a ring P, 1 to 64, at the azimuths 2 pi j / (turns P) of the outgoing direction
//! 40  u32       turns, 1 or 2: how often a ring is repeated over the full turn; 2 says that half a turn changes nothing
//! 44  u32       nodes of the table of factors, as in isotropic materials
//! 48  T f32     angles of the outgoing directions from the normal, radians, the first 0, rising, at most pi / 2
//!     V heads, V = 1 + (T - 1) P at most 4096, the normal first, then ring by ring; each 6 f32:
//!       log2 of the squeeze matrix, xx, xy, yy; its eigenvalues in [-5, 6.64]
//!       log2 of the luminance of the diffuse albedo, and its two colour differences
//!     V views, each 6 K f32:
//!       K angles of the axes from the normal along the plane of incidence, K across it; radians, together at most pi
//!       K log2 of the sharpness
//!       K log2 of the luminance of the amplitude, K of the one colour difference, K of the other
//! ```
//!
//! The rest is as in isotropic materials. `core/src/anisotropic.rs` says what the numbers mean between the views.

use super::{FactorTable, HEADER, Header, Kind, Writer, check, color_bounds, f32_at, u32_at};
use crate::{FormatError, float};
use core::f32::consts::PI;

/// Numbers in the head of a view: squeeze matrix, diffuse albedo in three numbers.
pub(crate) const HEAD: usize = 6;
/// Rows of K numbers of a view.
pub(crate) const ROWS: usize = 6;
const MAX_AZIMUTHS: usize = 64;
const MAX_VIEWS: usize = 4096;
/// Bounds of the eigenvalues of the logarithm of the squeeze matrix. Matrices within form a convex set that turning keeps, so
/// what is interpolated and turned lies within too.
const SQUEEZE: (f32, f32) = (-5.0, 6.64);

/// How the views lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    pub thetas: usize,
    pub azimuths: usize,
    pub turns: usize,
}

impl Shape {
    const fn views(&self) -> usize {
        1 + (self.thetas - 1) * self.azimuths
    }
    /// Byte offset of the head of a view.
    #[inline(always)]
    pub const fn head(&self, view: usize) -> usize {
        HEADER + 4 * (self.thetas + HEAD * view)
    }
    /// Byte offset of a row of K numbers of a view: axes along and across, sharpness, red, green, blue.
    #[inline(always)]
    pub const fn row(&self, header: &Header, view: usize, row: usize) -> usize {
        self.head(header.views) + 4 * (ROWS * view + row) * header.lobes
    }
}

/// One lobe at one view of an anisotropic material, as it is stored: its axis anywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltedLobe {
    /// The axis: its angle from the normal, radians, as a vector: first along the plane of incidence, positive towards the
    /// mirror direction, then across it. At the normal, along x and y of the surface. Of length at most pi.
    pub tilt: [f32; 2],
    /// Base-2 logarithm of the sharpness; [-100, 26.5].
    pub log2_sharpness: f32,
    /// Base-2 logarithm of the luminance Y of the amplitude; [-126, 60], -126 for none.
    pub log2_luminance: f32,
    /// Relative colour differences of the amplitude, `(R - Y) / Y` and `(B - Y) / Y`; [-16, 16].
    pub color_differences: [f32; 2],
}

/// One view of an anisotropic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridView<'a> {
    /// Base-2 logarithm of the squeeze matrix, a symmetric 2 x 2 one: xx, xy, yy; x along the plane of incidence, at the
    /// normal along x of the surface. Eigenvalues in [-5, 6.64]. `(0, 0, -log2 c)` is the squeeze c of an isotropic material.
    pub log2_squeeze: [f32; 3],
    /// Base-2 logarithm of the luminance Y of the albedo of the diffuse term; [-126, 2], -126 for none.
    pub log2_diffuse: f32,
    /// Relative colour differences of that albedo, `(R - Y) / Y` and `(B - Y) / Y`; [-16, 16].
    pub diffuse_color_differences: [f32; 2],
    /// The lobes, squeezed ones first; the same number, in the same order, at every view.
    pub lobes: &'a [TiltedLobe],
}

/// The views of an anisotropic material.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// Angles of the rings from the normal, radians; the first is 0, the normal itself.
    pub thetas: &'a [f32],
    /// Views of a ring, at the azimuths `2 pi j / (turns azimuths)` of the outgoing direction.
    pub azimuths: usize,
    /// How often a ring is repeated over the full turn, 1 or 2.
    pub turns: usize,
    /// The normal, then ring by ring.
    pub views: &'a [GridView<'a>],
    /// Number of lobes that see the squeezed direction; they come first.
    pub squeezed: usize,
    /// What values are multiplied by, if anything.
    pub factors: Option<FactorTable<'a>>,
}

impl Grid<'_> {
    fn header(&self, provenance: &str) -> Header {
        let shape = Shape { thetas: self.thetas.len(), azimuths: self.azimuths, turns: self.turns };
        Header {
            kind: Kind::Grid(shape),
            views: self.views.len(),
            lobes: self.views.first().map_or(0, |v| v.lobes.len()),
            squeezed: self.squeezed,
            mirrored: 0,
            provenance: provenance.len(),
            has_luminance: true,
            factors: FactorTable::shape(self.factors.as_ref()),
        }
    }

    /// Bytes that [`encode`](Self::encode) writes.
    pub fn encoded_len(&self, provenance: &str) -> usize {
        self.header(provenance).len()
    }

    /// Writes an anisotropic material as `.srbf` bytes and checks them as a reader would.
    ///
    /// Shapes: `out` [[`encoded_len`](Self::encoded_len)], overwritten. Returns: the bytes written.
    ///
    /// # Errors
    /// [`FormatError::Buffer`] if `out` is too small; [`FormatError::Field`] for a value that has no place in a material.
    pub fn encode(&self, provenance: &str, out: &mut [u8]) -> Result<usize, FormatError> {
        let header = self.header(provenance);
        let needed = header.len();
        self.factors.map_or(Ok(()), |table| table.check(self.views.len()))?;
        if out.len() < needed {
            return Err(FormatError::Buffer { needed, available: out.len() });
        }
        let field = |name, offset| Err(FormatError::Field { name, offset });
        let (thetas, lobes) = (self.thetas.len(), header.lobes);
        let expected = self.azimuths.checked_mul(thetas.saturating_sub(1)).and_then(|n| n.checked_add(1));
        if thetas == 0 || expected != Some(self.views.len()) {
            return field("number of views", 20);
        }
        if self.views.iter().any(|view| view.lobes.len() != lobes) {
            return field("number of lobes of a view", 24);
        }
        let fields = [thetas, lobes, self.squeezed, provenance.len(), self.azimuths, self.turns];
        let mut writer = Writer::new(out, 1, fields, header.factors, needed);
        self.thetas.iter().for_each(|theta| writer.number(*theta));
        for view in self.views {
            let diffuse = [view.log2_diffuse].into_iter().chain(view.diffuse_color_differences);
            view.log2_squeeze.into_iter().chain(diffuse).for_each(|n| writer.number(n));
        }
        for view in self.views {
            for i in 0..2 {
                view.lobes.iter().for_each(|l| writer.number(l.tilt[i]));
            }
            view.lobes.iter().for_each(|l| writer.number(l.log2_sharpness));
            view.lobes.iter().for_each(|l| writer.number(l.log2_luminance));
            for i in 0..2 {
                view.lobes.iter().for_each(|l| writer.number(l.color_differences[i]));
            }
        }
        writer.finish(self.factors, provenance)
    }
}

/// Reads how the views lie, and how many there are; the number of angles has been checked.
pub(super) fn read_shape(bytes: &[u8]) -> Result<(Kind, usize), FormatError> {
    let count = |offset| u32_at(bytes, offset) as usize;
    let shape = Shape { thetas: count(20), azimuths: count(36), turns: count(40) };
    if !(1..=MAX_AZIMUTHS).contains(&shape.azimuths) || shape.views() > MAX_VIEWS {
        return Err(FormatError::Field { name: "number of views of a ring", offset: 36 });
    }
    if !(1..=2).contains(&shape.turns) {
        return Err(FormatError::Field { name: "turns", offset: 40 });
    }
    Ok((Kind::Grid(shape), shape.views()))
}

/// Checks heads and lobes of every view.
pub(super) fn validate(bytes: &[u8], header: &Header, shape: Shape) -> Result<(), FormatError> {
    debug_assert!(header.len() == bytes.len());
    for view in 0..header.views {
        let head = shape.head(view);
        let [xx, xy, yy] = [0, 1, 2].map(|i| f32_at(bytes, head + 4 * i));
        let (middle, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let reach = float::sqrt(half * half + xy * xy);
        // False for NaN too.
        if !(middle - reach >= SQUEEZE.0 && middle + reach <= SQUEEZE.1) {
            return Err(FormatError::Field { name: "squeeze matrix", offset: head });
        }
        for number in 0..3 {
            let (low, high) = color_bounds(header, number, 2.0);
            check(bytes, "diffuse albedo", head + 4 * (3 + number), low, high)?;
        }
        for lobe in 0..header.lobes {
            let at = |row| shape.row(header, view, row) + 4 * lobe;
            let [along, across] = [f32_at(bytes, at(0)), f32_at(bytes, at(1))];
            // False for NaN too.
            let inside = along * along + across * across <= PI * PI;
            if !inside {
                return Err(FormatError::Field { name: "angle of an axis", offset: at(0) });
            }
            check(bytes, "sharpness", at(2), -100.0, 26.5)?;
            for number in 0..3 {
                let (low, high) = color_bounds(header, number, 60.0);
                check(bytes, "amplitude", at(3 + number), low, high)?;
            }
        }
    }
    Ok(())
}
