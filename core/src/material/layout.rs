//! The `.srbf` bytes: little endian, a fixed head, blocks, checksum. Two kinds: views along one angle, for isotropic
//! materials; and views over the hemisphere, for anisotropic ones.
//!
//! ```text
//!  0  8 bytes   magic 89 53 52 42 46 0D 0A 1A
//!  8  u32       version, 3
//! 12  u32       kind, 0 = isotropic, symmetric about the plane of incidence; 1 = anisotropic
//! 16  u32       length of the whole file in bytes
//! 20  u32       views V, 1 to 1024; of an anisotropic material angles from the normal T, 1 to 1024
//! 24  u32       lobes K of every view, 1 to 64
//! 28  u32       squeezed lobes, the first of the K
//! 32  u32       mirrored lobes M, the last of the K, each of which stands for two; K + M is at most 64. Of an
//!               anisotropic material views of a ring P, 1 to 64
//! 36  u32       0; of an anisotropic material u16 turns, 1, 2 or 4; u16 axis
//! 40  blocks, the first of which is LOBE or PACK; each:
//!       4 bytes tag, letters
//!       u32     length of the content in bytes
//!       content, then zeros up to a multiple of 4
//!     u32       CRC-32 of everything before
//! ```
//!
//! A reader skips a block whose tag it does not know and begins with a small letter: the material is the same without.
//! It refuses one that begins with a capital letter. Of the blocks below there is one each at most.
//!
//! # `LOBE`, isotropic
//!
//! ```text
//!     V f32     angles of the outgoing directions from the normal, radians, the first 0, rising, at most pi / 2
//!     V heads, each 4 f32:
//!       log2 of the squeeze c, 0 in the first
//!       log2 of the luminance Y of the diffuse albedo; its relative colour differences (R - Y) / Y and (B - Y) / Y
//!     V views, each 5 K + M f32:
//!       K angles of the axes from the normal, radians, positive towards the mirror direction, 0 in the first view
//!       K log2 of the sharpness
//!       K log2 of the luminance of the amplitude, K of the one colour difference, K of the other
//!       M angles of the axes out of the plane of incidence, radians, 0 in the first view
//! ```
//!
//! # `LOBE`, anisotropic
//! Views over the hemisphere, on rings round the normal: the first view is the normal itself, each further angle a ring
//! of P views, at the azimuths 2 pi j / (turns P) of the outgoing direction. Turns say how often a ring is repeated
//! over the full turn: 2 says that half a turn changes nothing. 4 says that two mirrors change nothing either, along azimuth 0 and
//! across it. Then a ring goes from azimuth 0 to a quarter of the turn, at 2 pi j / (4 (P - 1)), P at least 2. Outgoing directions elsewhere
//! have the mirror images of its mixtures. At both ends lobes are their own images or those of each other; else the mixture
//! jumps there.
//!
//! Azimuths count from the axis, which lies at that number of 65536ths of pi in the frame of the surface; the view of the normal is
//! written along it too.
//!
//! ```text
//!     T f32     angles of the outgoing directions from the normal, radians, the first 0, rising, at most pi / 2
//!     V heads, V = 1 + (T - 1) P at most 4096, the normal first, then ring by ring; each 6 f32:
//!       log2 of the squeeze matrix, xx, xy, yy; its eigenvalues in [-5, 6.64]
//!       log2 of the luminance of the diffuse albedo, and its two colour differences
//!     V views, each 6 K f32:
//!       K angles of the axes from the normal along the plane of incidence, K across it; radians, together at most pi
//!       K log2 of the sharpness
//!       K log2 of the luminance of the amplitude, K of the one colour difference, K of the other
//! ```
//!
//! `kernel/prepare_anisotropic.rs` has the meaning of the numbers between the views.
//!
//! # `PACK`: the lobes in codes, in place of `LOBE`
//!
//! A code q of 8 or 16 bits is the number `low + q step`. Low and step are a scale, the same for all views.
//! Each is two bytes, the upper half of an f32 whose lower half is 0. Where the sign of a step is negative, its magnitude
//! counts, and the angle of the view is added to the number.
//!
//! ```text
//!     u8        bits of a code in the views, 8 or 16
//!     u8        channels, 3; or 1 of a grey material, whose colour differences are 0 and not stored
//!     u16       0
//!     V u16     angles of the outgoing directions in units of (pi / 2) / 65535; T of an anisotropic material
//!     scales of the numbers of a head, each 2 of two bytes: low, step
//!     V heads, each a u16 for every number of a head
//!     scales of the numbers of a view
//!     V views, each a code for every number of a view
//! ```
//!
//! The numbers of head and view are those of `LOBE`, in the same order. Numbers that have to be 0 in the first view are 0
//! whatever their code; of an anisotropic material there are none.
//!
//! # `FACT`: a table of factors
//!
//! ```text
//!     u8        nodes along the half angle H, 2 to 32
//!     u8        nodes along the difference angle D, 2 to 32
//!     u8        nodes along the azimuth P, 1 to 8
//!     u8        0, or 1 if the azimuth has its sign: then its nodes are at the same steps from -1 to 1
//!     V differences of the albedo with factors from the lobes' own A, in red, green and blue, over the luminance
//!       of A, each 3 f32; between views interpolated like the lobes
//!     f32       factor of the code 255, which no factor exceeds: 0, or at least 1e-20
//!     P H D nodes of 3 bytes, node (i, j, k) at (k H + i) D + j: red, green, blue, each a code q, of the factor
//!               (q / 255)^2 times that number
//! ```
//!
//! # `text`
//! Provenance, UTF-8.
//!
//! # `spec`: the spectra of the colours
//! A linear map from the colours of values to values at wavelengths; draws and densities are those of the colours.
//!
//! ```text
//!     u8        kind: 0, a column for each of red, green, blue; 1, one column, for the luminance
//!     u8        bits of a code, 8 or 16
//!     u16       wavelengths N, 1 to 1024
//!     f32       error: relative L2 distance of the measured spectra from those of their colours
//!     N u16     wavelengths in tenths of nm, rising, not 0
//!     scale     low and step, as in `PACK`, without a sign of the step
//!     N times   a code for every column; numbers are in [-1e6, 1e6]
//! ```
//!
//! The value at a wavelength is the larger of 0 and the columns' numbers times red, green and blue, or times the luminance. Numbers are
//! linear between wavelengths and constant beyond.
//!
//! # Older versions, which are read but not written
//! Version 2 has no blocks: the content of `LOBE` stands at 48, in the same place; behind it that of `FACT` from the
//! albedo differences on, the provenance, and the checksum. At 32 it has the length of the provenance, at 36 M or P,
//! at 40 0 or the turns, at 44 H and 2^16 times D, or 0 for no table. Of its table there is one azimuth; the number
//! before the nodes is the largest of their factors; and nodes are u32: red, green, blue in bits 0-9, 10-19, 20-29, each
//! (q / 360)^2, the upper two bits 0.
//!
//! Version 1 has the log2 of red, green and blue in place of luminance and colour differences, and no table: 0 at 44.

pub(crate) use super::bytes::{GRID_HEAD, GRID_ROWS, HEAD, HEADER, f32_at, part, u32_at};
use super::codes::{self, Codes, Counts, TwoViews};

/// Most lobes that a mixture can hold, and that a material can make.
pub const MAX_LOBES: usize = 64;

pub(crate) const MAGIC: [u8; 8] = [0x89, b'S', b'R', b'B', b'F', b'\r', b'\n', 0x1a];

/// Byte offset of the first block.
pub(crate) const BLOCKS: usize = 40;

/// Bytes of a block before its content.
pub(crate) const BLOCK_HEAD: usize = 8;

/// Byte offset of the number of mirrored lobes, or of the views of a ring.
pub(crate) const MIRRORED: usize = 32;

pub(crate) const CHECKSUM: usize = 4;

/// Bytes that every file has.
pub(crate) const SMALLEST: usize = HEADER + CHECKSUM;

/// Tags of blocks: lobes, lobes in codes, factors, provenance, spectra of colours.
pub(crate) const PACK: [u8; 4] = *b"PACK";
pub(crate) const LOBE: [u8; 4] = *b"LOBE";
pub(crate) const FACT: [u8; 4] = *b"FACT";
pub(crate) const TEXT: [u8; 4] = *b"text";
pub(crate) const SPEC: [u8; 4] = *b"spec";

/// Bytes of the content of the block of factors before the albedo differences.
pub(crate) const TABLE_HEAD: usize = 4;

/// The header, once it has been checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Header {
    pub kind: Kind,
    /// The codes that the lobes are stored by; `None` for f32.
    pub codes: Option<Codes>,
    pub views: usize,
    pub lobes: usize,
    pub squeezed: usize,
    /// Lobes that stand for two, the last ones; 0 in an anisotropic material.
    pub mirrored: usize,
    /// Byte offset of the provenance, and its length.
    pub text: usize,
    pub provenance: u32,
    /// Byte offset of the content of the block of spectra; 0 without one.
    pub spectrum: u32,
    /// Luminance and colour differences in place of red, green and blue: not version 1.
    pub has_luminance: bool,
    /// Nodes of the table of factors along half angle, difference angle and azimuth; all 0 without one.
    pub factors: [u8; 3],
    /// Whether nodes along the azimuth know its sign.
    pub has_signed_factors: bool,
    /// Bits of a channel of a node: 8, in version 2 10.
    pub bits: u8,
    /// Byte offset of the albedo differences, behind which the table stands.
    pub table: usize,
}

/// Where the views of a material lie, and with it the numbers that are stored at each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Along the angle from the normal; the material is isotropic.
    Line,
    /// Over the hemisphere.
    Grid(Shape),
}

impl Header {
    /// Of a material that is to be written, without anything in it.
    pub const EMPTY: Self = Self {
        kind: Kind::Line,
        codes: None,
        views: 0,
        lobes: 0,
        squeezed: 0,
        mirrored: 0,
        text: 0,
        provenance: 0,
        spectrum: 0,
        has_luminance: true,
        factors: [0; 3],
        has_signed_factors: false,
        bits: 8,
        table: 0,
    };
    /// Lobes of a mixture: the stored ones, and the images of the mirrored ones.
    #[inline(always)]
    pub const fn lobe_count(&self) -> usize {
        self.lobes + self.mirrored
    }
    #[inline(always)]
    pub fn is_isotropic(&self) -> bool {
        self.kind == Kind::Line
    }
    #[inline(always)]
    pub const fn has_factors(&self) -> bool {
        self.factors[0] > 0
    }
    /// The angle of a view from the normal, radians.
    #[inline(always)]
    pub fn angle(&self, bytes: &[u8], view: usize) -> f32 {
        if self.codes.is_some() { codes::angle(bytes, view) } else { f32_at(bytes, self.theta(view)) }
    }
    #[inline(always)]
    const fn counts(&self) -> Counts {
        Counts {
            angles: self.views,
            azimuths: 1,
            views: self.views,
            lobes: self.lobes,
            mirrored: self.mirrored,
        }
    }
    /// The same of views over the hemisphere.
    #[inline(always)]
    pub const fn grid_counts(&self, shape: Shape) -> Counts {
        let Shape { thetas, azimuths, .. } = shape;
        Counts { angles: thetas, azimuths, views: self.views, lobes: self.lobes, mirrored: 0 }
    }
    /// Two views of a material in codes; `None` of f32.
    #[inline(always)]
    pub fn two_views<'a>(&self, bytes: &'a [u8], views: [usize; 2]) -> Option<TwoViews<'a>> {
        self.codes.map(|codes| codes.two_views(self.counts(), bytes, views))
    }
    /// The numbers of the heads of two views of a material in codes; `None` of f32.
    #[inline(always)]
    pub fn two_heads(&self, bytes: &[u8], views: [usize; 2]) -> Option<[[f32; HEAD]; 2]> {
        self.codes.map(|codes| codes.two_heads(self.counts(), bytes, views))
    }
    /// Byte offsets of what stands for a view's angle, its head, and a number of a lobe: the places of errors.
    pub const fn angle_offset(&self, view: usize) -> usize {
        if self.codes.is_some() { codes::angle_offset(view) } else { self.theta(view) }
    }
    pub const fn head_offset(&self, view: usize, number: usize) -> usize {
        match self.codes {
            None => self.head(view) + 4 * number,
            Some(codes) => codes.head_offset(self.counts(), view) + 2 * number,
        }
    }
    pub const fn number_offset(&self, view: usize, row: usize, lobe: usize) -> usize {
        match self.codes {
            None => self.row(view, row) + 4 * lobe,
            Some(codes) => codes.number_offset(self.counts(), view, row, lobe),
        }
    }
    /// A number of the head of a view of an isotropic material.
    #[inline(always)]
    pub fn head_number(&self, bytes: &[u8], view: usize, number: usize) -> f32 {
        match self.codes {
            None => f32_at(bytes, self.head(view) + 4 * number),
            Some(codes) => codes.head_number(self.counts(), bytes, view, number),
        }
    }
    /// A number of the head of a view over the hemisphere, and its byte offset.
    pub fn grid_head(&self, shape: Shape, bytes: &[u8], view: usize, number: usize) -> (f32, usize) {
        let (counts, at) = (self.grid_counts(shape), shape.head(view) + 4 * number);
        match self.codes.map(Codes::of_grid) {
            None => (f32_at(bytes, at), at),
            Some(codes) => {
                (codes.head_number(counts, bytes, view, number), codes.head_offset(counts, view) + 2 * number)
            }
        }
    }
    /// A number of a lobe at a view over the hemisphere, and its byte offset.
    pub fn grid_number(
        &self,
        shape: Shape,
        bytes: &[u8],
        view: usize,
        row: usize,
        lobe: usize,
    ) -> (f32, usize) {
        let (counts, at) = (self.grid_counts(shape), shape.row(self, view, row) + 4 * lobe);
        match self.codes.map(Codes::of_grid) {
            None => (f32_at(bytes, at), at),
            Some(codes) => {
                (codes.number(counts, bytes, view, row, lobe), codes.number_offset(counts, view, row, lobe))
            }
        }
    }
    /// A number of a lobe at a view of an isotropic material; of row 5 that of a mirrored lobe.
    #[inline(always)]
    pub fn number(&self, bytes: &[u8], view: usize, row: usize, lobe: usize) -> f32 {
        match self.codes {
            None => f32_at(bytes, self.row(view, row) + 4 * lobe),
            Some(codes) => codes.number(self.counts(), bytes, view, row, lobe),
        }
    }
    /// Byte offset of the angle of a view.
    #[inline(always)]
    pub const fn theta(&self, view: usize) -> usize {
        HEADER + 4 * view
    }
    /// Byte offset of the head of a view: squeeze, diffuse albedo.
    #[inline(always)]
    pub const fn head(&self, view: usize) -> usize {
        HEADER + 4 * (self.views + HEAD * view)
    }
    /// Byte offset of a row of K numbers of a view: axes, sharpness, red, green, blue; and of the M angles
    /// out of the plane.
    #[inline(always)]
    pub const fn row(&self, view: usize, row: usize) -> usize {
        HEADER + 4 * ((1 + HEAD) * self.views + (5 * view + row) * self.lobes + view * self.mirrored)
    }
    /// Byte offset of the blocks behind the lobes of all views.
    pub const fn lobes_end(&self) -> usize {
        match (self.kind, self.codes) {
            (Kind::Line, Some(codes)) => codes.end(self.counts()),
            (Kind::Line, None) => self.row(self.views, 0),
            (Kind::Grid(shape), Some(codes)) => codes.of_grid().end(self.grid_counts(shape)),
            (Kind::Grid(shape), None) => shape.row(self, self.views, 0),
        }
    }
    /// Byte offset of the albedo difference of a view, of a material that has factors.
    #[inline(always)]
    pub const fn albedo_difference(&self, view: usize) -> usize {
        self.table + 12 * view
    }
    /// Byte offset of the nodes of the table of factors; the largest factor stands before.
    #[inline(always)]
    pub const fn nodes(&self) -> usize {
        self.albedo_difference(self.views) + 4
    }
    /// Byte offset behind the nodes.
    pub const fn nodes_end(&self) -> usize {
        let [half, difference, azimuth] = self.factors;
        self.nodes() + self.node_len() * half as usize * difference as usize * azimuth as usize
    }
    /// Bytes of a node.
    #[inline(always)]
    pub const fn node_len(&self) -> usize {
        (3 * self.bits as usize).div_ceil(8)
    }
    /// Finds places for the blocks behind the lobes, and the bytes of the whole without spectra, which come last.
    pub const fn placed(mut self) -> (Self, usize) {
        let mut end = padded(self.lobes_end());
        if self.has_factors() {
            self.table = end + BLOCK_HEAD + TABLE_HEAD;
            end = padded(self.nodes_end());
        }
        self.text = end + BLOCK_HEAD;
        if self.provenance > 0 {
            end = padded(self.text + self.provenance as usize);
        }
        (self, end + CHECKSUM)
    }
}

/// The next multiple of 4.
pub(crate) const fn padded(offset: usize) -> usize {
    offset.next_multiple_of(4)
}

/// How the views lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    pub thetas: usize,
    pub azimuths: usize,
    pub turns: u16,
    /// Azimuth from which those of views count, in units of [`AXIS_UNIT`].
    pub axis: u16,
}

/// The unit of the axis of a grid, radians.
pub(crate) const AXIS_UNIT: f32 = core::f32::consts::PI / 65_536.0;

/// The turns of a grid that has two mirrors.
pub(crate) const MIRRORS: u16 = 4;

impl Shape {
    /// Whether views stand over a quarter of the turn, and have mirror images elsewhere.
    #[inline(always)]
    pub const fn is_mirrored(&self) -> bool {
        self.turns == MIRRORS
    }
    /// Turns and axis as they are stored.
    pub const fn turns_and_axis(&self) -> usize {
        self.turns as usize | (self.axis as usize) << 16
    }
    /// Steps from view to view over the full turn.
    #[inline(always)]
    pub const fn steps(&self) -> usize {
        self.turns as usize * if self.is_mirrored() { self.azimuths - 1 } else { self.azimuths }
    }
    pub const fn views(&self) -> usize {
        1 + (self.thetas - 1) * self.azimuths
    }
    /// Byte offset of the head of a view.
    #[inline(always)]
    pub const fn head(&self, view: usize) -> usize {
        HEADER + 4 * (self.thetas + GRID_HEAD * view)
    }
    /// Byte offset of a row of K numbers of a view: axes along and across, sharpness, red, green, blue.
    #[inline(always)]
    pub const fn row(&self, header: &Header, view: usize, row: usize) -> usize {
        self.head(header.views) + 4 * (GRID_ROWS * view + row) * header.lobes
    }
}
