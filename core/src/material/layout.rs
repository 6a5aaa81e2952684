//! The `.srbf` bytes: little endian, fixed header, views, table of factors, provenance, checksum. Two kinds:
//! views along one angle, for isotropic materials, described here; and views over the hemisphere, for
//! anisotropic ones, described below.
//!
//! ```text
//!  0  8 bytes   magic 89 53 52 42 46 0D 0A 1A
//!  8  u32       version, 2
//! 12  u32       kind, 0 = isotropic, symmetric about the plane of incidence; 1 = anisotropic
//! 16  u32       length of the whole file in bytes
//! 20  u32       views V, 1 to 1024
//! 24  u32       lobes K of every view, 1 to 64
//! 28  u32       squeezed lobes, the first of the K
//! 32  u32       bytes of the provenance text
//! 36  u32       mirrored lobes M, the last of the K, each of which stands for two; K + M is at most 64
//! 40  u32       0
//! 44  u32       nodes of the table of factors along the half angle H, and 2^16 times those along the difference
//!               angle D, each 2 to 32; 0 for no table
//! 48  V f32     angles of the outgoing directions from the normal, radians, the first 0, rising, at most pi / 2
//!     V heads, each 4 f32:
//!       log2 of the squeeze c, 0 in the first
//!       log2 of the luminance Y of the diffuse albedo; its relative colour differences (R - Y) / Y and (B - Y) / Y
//!     V views, each 5 K + M f32:
//!       K angles of the axes from the normal, radians, positive towards the mirror direction, 0 in the first view
//!       K log2 of the sharpness
//!       K log2 of the luminance of the amplitude, K of the one colour difference, K of the other
//!       M angles of the axes out of the plane of incidence, radians, 0 in the first view
//!     with a table of factors:
//!       V differences of the albedo with factors from the lobes' own A, in red, green and blue, over the luminance
//!       of A, each 3 f32; between views interpolated like the lobes
//!       f32     largest factor of any node and channel
//!       H D u32 nodes, node (i, j) at i D + j: red, green, blue in bits 0-9, 10-19, 20-29, each (q / 360)^2;
//!               the upper two bits 0
//!     provenance, UTF-8
//!     u32       CRC-32 of everything before
//! ```
//!
//! Version 1, which is read but not written, has the log2 of red, green and blue in place of luminance and
//! colour differences, in heads and views, and no table: 0 at 44.
//!
//! # Anisotropic materials
//! Views over the hemisphere, on rings round the normal.
//!
//! ```text
//! 12  u32       kind, 1
//! 20  u32       angles from the normal T, 1 to 1024; the first view is the normal itself, each further angle a
//!               ring of views
//! 36  u32       views of a ring P, 1 to 64, at the azimuths 2 pi j / (turns P) of the outgoing direction
//! 40  u32       turns, 1 or 2: how often a ring is repeated over the full turn; 2 says that half a turn changes
//!               nothing
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
//! The rest is as in isotropic materials. `kernel/prepare_anisotropic.rs` says what the numbers mean between
//! the views.

/// Most lobes that a mixture can hold, and that a material can make.
pub const MAX_LOBES: usize = 64;

pub(crate) const MAGIC: [u8; 8] = [0x89, b'S', b'R', b'B', b'F', b'\r', b'\n', 0x1a];

pub(crate) const HEADER: usize = 48;

pub(crate) const CHECKSUM: usize = 4;

/// Bytes that every file has.
pub(crate) const SMALLEST: usize = HEADER + CHECKSUM;

/// Byte offset of the number of mirrored lobes.
pub(crate) const MIRRORED: usize = 36;

/// Byte offset of the numbers of nodes of the table of factors.
pub(crate) const NODES: usize = 44;

/// Numbers in the head of a view: squeeze, diffuse albedo in three numbers.
pub(crate) const HEAD: usize = 4;

/// Numbers in the head of a view: squeeze matrix, diffuse albedo in three numbers.
pub(crate) const GRID_HEAD: usize = 6;

/// Rows of K numbers of a view.
pub(crate) const GRID_ROWS: usize = 6;

/// What the header says, once it has been checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Header {
    pub kind: Kind,
    pub views: usize,
    pub lobes: usize,
    pub squeezed: usize,
    /// Lobes that stand for two, the last ones; 0 in an anisotropic material.
    pub mirrored: usize,
    pub provenance: usize,
    /// Luminance and colour differences in place of red, green and blue: version 2.
    pub has_luminance: bool,
    /// Nodes of the table of factors along the half angle and the difference angle; both 0 without one.
    pub factors: [u8; 2],
}

/// Where the views of a material lie, and with it what is stored at each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Along the angle from the normal; the material is isotropic.
    Line,
    /// Over the hemisphere.
    Grid(Shape),
}

impl Header {
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
    /// Byte offset of the albedo difference of a view, of a material that has factors.
    #[inline(always)]
    pub const fn albedo_difference(&self, view: usize) -> usize {
        let end = match self.kind {
            Kind::Line => self.row(self.views, 0),
            Kind::Grid(shape) => shape.row(self, self.views, 0),
        };
        end + 12 * view
    }
    /// Byte offset of the nodes of the table of factors; the largest factor stands before.
    #[inline(always)]
    pub const fn nodes(&self) -> usize {
        self.albedo_difference(self.views) + 4
    }
    /// Bytes of the whole.
    pub const fn len(&self) -> usize {
        let nodes = self.factors[0] as usize * self.factors[1] as usize;
        let end = if nodes > 0 { self.nodes() + 4 * nodes } else { self.albedo_difference(0) };
        end + self.provenance + CHECKSUM
    }
}

/// How the views lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    pub thetas: usize,
    pub azimuths: usize,
    pub turns: usize,
}

impl Shape {
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

#[inline(always)]
pub(crate) fn u32_at(bytes: &[u8], offset: usize) -> u32 {
    bytemuck::pod_read_unaligned::<u32>(&bytes[offset..offset + 4]).to_le()
}

#[inline(always)]
pub(crate) fn f32_at(bytes: &[u8], offset: usize) -> f32 {
    f32::from_bits(u32_at(bytes, offset))
}
