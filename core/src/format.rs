//! The `.srbf` bytes: little endian, fixed header, views, table of factors, provenance, checksum. Two kinds: views along one angle, for
//! isotropic materials, described here; and views over the hemisphere, for anisotropic ones, described in `format/grid.rs`.
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
//! 44  u32       nodes of the table of factors along the half angle H, and 2^16 times those along the difference angle D, each 2 to 32;
//!               0 for no table
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
//!       V differences of the albedo with factors from the lobes' own A, in red, green and blue, over the luminance of A, each 3 f32;
//!       between views interpolated like the lobes
//!       f32     largest factor of any node and channel
//!       H D u32 nodes, node (i, j) at i D + j: red, green, blue in bits 0-9, 10-19, 20-29, each (q / 360)^2; the upper two bits 0
//!     provenance, UTF-8
//!     u32       CRC-32 of everything before
//! ```
//!
//! Version 1, which is read but not written, has the log2 of red, green and blue in place of luminance and colour differences, in heads and
//! views, and no table: 0 at 44.

pub(crate) mod grid;

use crate::checksum::crc32;
use crate::color::MOST_DIFFERENCE;
use crate::{FormatError, factors};
use core::f32::consts::{FRAC_PI_2, PI};

/// Version of the `.srbf` bytes that this library writes; it reads this one and version 1.
pub const FORMAT_VERSION: u32 = 2;

const MAGIC: [u8; 8] = [0x89, b'S', b'R', b'B', b'F', b'\r', b'\n', 0x1a];
pub(crate) const HEADER: usize = 48;
const CHECKSUM: usize = 4;
/// Bytes that every file has.
pub(crate) const SMALLEST: usize = HEADER + CHECKSUM;
/// Byte offset of the number of mirrored lobes.
const MIRRORED: usize = 36;
/// Byte offset of the numbers of nodes of the table of factors.
const NODES: usize = 44;
/// Largest magnitude of a stored difference of albedos, relative to the luminance.
const MOST_ALBEDO_DIFFERENCE: f32 = 16.0;
/// Numbers in the head of a view: squeeze, diffuse albedo in three numbers.
pub(crate) const HEAD: usize = 4;
const MAX_VIEWS: usize = 1024;

/// One lobe of an isotropic material at one view, as it is stored: its axis in the plane of incidence, or, if it is a mirrored one,
/// off it and standing for a second one on the other side.
///
/// The axis is `(sin angle cos off_plane, sin off_plane, cos angle cos off_plane)` in the frame of the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneLobe {
    /// Angle of the axis from the normal, within the plane of incidence, radians, positive towards the mirror direction; [-pi, pi].
    pub angle: f32,
    /// Angle of the axis out of the plane of incidence, radians; [-pi/2, pi/2] for a mirrored lobe, 0 for any other.
    pub off_plane: f32,
    /// Base-2 logarithm of the sharpness; [-100, 26.5].
    pub log2_sharpness: f32,
    /// Base-2 logarithm of the luminance Y of the amplitude; [-126, 60], -126 for none.
    pub log2_luminance: f32,
    /// Relative colour differences of the amplitude, `(R - Y) / Y` and `(B - Y) / Y`; [-16, 16].
    pub color_differences: [f32; 2],
}

/// One view: the outgoing direction at which a material stores a mixture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View<'a> {
    /// Angle of the outgoing direction from the normal, radians.
    pub theta: f32,
    /// Base-2 logarithm of the squeeze; [-6.64, 1].
    pub log2_squeeze: f32,
    /// Base-2 logarithm of the luminance Y of the albedo of the diffuse term; [-126, 2], -126 for none.
    pub log2_diffuse: f32,
    /// Relative colour differences of that albedo, `(R - Y) / Y` and `(B - Y) / Y`; [-16, 16].
    pub diffuse_color_differences: [f32; 2],
    /// The lobes, squeezed ones first, mirrored ones last; the same number, in the same order, at every view.
    pub lobes: &'a [PlaneLobe],
}

/// The views of an isotropic material.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// By their angle, the normal first.
    pub views: &'a [View<'a>],
    /// Number of lobes that see the squeezed direction; they come first.
    pub squeezed: usize,
    /// Number of lobes that stand for two, one on either side of the plane of incidence; they come last.
    pub mirrored: usize,
    /// What values are multiplied by, if anything.
    pub factors: Option<FactorTable<'a>>,
}

/// Factors over the half angle and the difference angle, for all views of a material; see
/// [`Material::factor`](crate::Material::factor).
#[derive(Clone, Copy, Debug)]
pub struct FactorTable<'a> {
    /// Nodes along the half angle, in `(1 - h.z)^(1/4)`; 2 to 32.
    pub half: usize,
    /// Nodes along the difference angle, in `(1 - h.wo)^(1/2)`; 2 to 32.
    pub difference: usize,
    /// Factors, linear sRGB, [half * difference], those of one half angle together; [0, 8.07]. Their roots are rounded to 1/360.
    pub factors: &'a [[f32; 3]],
    /// What the factors change of the albedo, `(B - A) / Y`: B is the albedo with factors, A that of lobes and diffuse term without, Y the
    /// luminance of A; linear sRGB, one a view, in the order of the views; [-16, 16].
    pub albedo_differences: &'a [[f32; 3]],
}

impl FactorTable<'_> {
    /// Its sizes as the header has them.
    fn shape(table: Option<&Self>) -> [u8; 2] {
        // What is too large stays too large.
        table.map_or([0; 2], |t| [t.half, t.difference].map(|n| n.min(255) as u8))
    }

    /// Refuses what has no place in a file.
    fn check(&self, views: usize) -> Result<(), FormatError> {
        let field = |name| Err(FormatError::Field { name, offset: NODES });
        if ![self.half, self.difference].iter().all(|n| factors::SIZES.contains(n)) {
            return field("size of the table of factors");
        }
        if self.factors.len() != self.half * self.difference {
            return field("number of factors");
        }
        if self.albedo_differences.len() != views {
            return field("number of albedo differences");
        }
        let most = (factors::MOST_CODE as f32 + 0.5) / factors::UNIT;
        // False for NaN too.
        if !self.factors.iter().flatten().all(|f| (0.0..most * most).contains(f)) {
            return field("factor");
        }
        Ok(())
    }

    /// A node's three codes.
    fn node(factor: &[f32; 3]) -> u32 {
        let code = |f: &f32| (f64::from(factors::UNIT) * libm::sqrt(f64::from(*f)) + 0.5) as u32;
        let [red, green, blue] = [code(&factor[0]), code(&factor[1]), code(&factor[2])];
        red.min(factors::MOST_CODE) | green.min(factors::MOST_CODE) << 10 | blue.min(factors::MOST_CODE) << 20
    }
}

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
    Grid(grid::Shape),
}

impl Header {
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
    /// Byte offset of a row of K numbers of a view: axes, sharpness, red, green, blue; and of the M angles out of the plane.
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
    const fn len(&self) -> usize {
        let nodes = self.factors[0] as usize * self.factors[1] as usize;
        let end = if nodes > 0 { self.nodes() + 4 * nodes } else { self.albedo_difference(0) };
        end + self.provenance + CHECKSUM
    }
}

/// Bytes that [`Line::encode`] writes without factors, for so many views of so many lobes, the last `mirrored` of which stand for two; of
/// 1024 views and 64 lobes at most.
pub const fn encoded_len(views: usize, lobes: usize, mirrored: usize, provenance: &str) -> usize {
    let provenance = provenance.len();
    let (kind, has_luminance, factors) = (Kind::Line, true, [0; 2]);
    Header { kind, views, lobes, squeezed: 0, mirrored, provenance, has_luminance, factors }.len()
}

#[inline(always)]
pub(crate) fn u32_at(bytes: &[u8], offset: usize) -> u32 {
    bytemuck::pod_read_unaligned::<u32>(&bytes[offset..offset + 4]).to_le()
}

#[inline(always)]
pub(crate) fn f32_at(bytes: &[u8], offset: usize) -> f32 {
    f32::from_bits(u32_at(bytes, offset))
}

impl Line<'_> {
    fn header(&self, provenance: &str) -> Header {
        Header {
            kind: Kind::Line,
            views: self.views.len(),
            lobes: self.views.first().map_or(0, |v| v.lobes.len()),
            squeezed: self.squeezed,
            mirrored: self.mirrored,
            provenance: provenance.len(),
            has_luminance: true,
            factors: FactorTable::shape(self.factors.as_ref()),
        }
    }

    /// Bytes that [`encode`](Self::encode) writes.
    pub fn encoded_len(&self, provenance: &str) -> usize {
        self.header(provenance).len()
    }

    /// Writes a material as `.srbf` bytes and checks them as a reader would.
    ///
    /// Of the lobes of every view the first `squeezed` see the squeezed direction, and each of the last `mirrored` stands for two, one
    /// on either side of the plane of incidence; none is both. Shapes: `out` [[`encoded_len`](Self::encoded_len)], overwritten. Returns:
    /// the bytes written.
    ///
    /// # Errors
    /// [`FormatError::Buffer`] if `out` is too small; [`FormatError::Field`] for a value that has no place in a material.
    pub fn encode(&self, provenance: &str, out: &mut [u8]) -> Result<usize, FormatError> {
        let Self { views, squeezed, mirrored, factors } = *self;
        let header = self.header(provenance);
        let lobes = header.lobes;
        if mirrored > lobes {
            return Err(FormatError::Field { name: "number of mirrored lobes", offset: MIRRORED });
        }
        factors.map_or(Ok(()), |table| table.check(views.len()))?;
        let needed = header.len();
        if out.len() < needed {
            return Err(FormatError::Buffer { needed, available: out.len() });
        }
        for (v, view) in views.iter().enumerate() {
            let field = |name, row| Err(FormatError::Field { name, offset: header.row(v, row) });
            if view.lobes.len() != lobes {
                return field("number of lobes of a view", 0);
            }
            if view.lobes[..lobes - mirrored].iter().any(|l| l.off_plane != 0.0) {
                return field("angle out of the plane of incidence", 5);
            }
        }
        let counts = [views.len(), lobes, squeezed, provenance.len(), mirrored, 0];
        let mut writer = Writer::new(out, 0, counts, header.factors, needed);
        views.iter().for_each(|view| writer.number(view.theta));
        for view in views {
            writer.number(view.log2_squeeze);
            writer.number(view.log2_diffuse);
            view.diffuse_color_differences.iter().for_each(|n| writer.number(*n));
        }
        for view in views {
            view.lobes.iter().for_each(|l| writer.number(l.angle));
            view.lobes.iter().for_each(|l| writer.number(l.log2_sharpness));
            view.lobes.iter().for_each(|l| writer.number(l.log2_luminance));
            for i in 0..2 {
                view.lobes.iter().for_each(|l| writer.number(l.color_differences[i]));
            }
            view.lobes[lobes - mirrored..].iter().for_each(|l| writer.number(l.off_plane));
        }
        writer.finish(factors, provenance)
    }
}

/// Puts bytes one behind the other into a buffer that is long enough.
struct Writer<'a> {
    out: &'a mut [u8],
    at: usize,
}

impl<'a> Writer<'a> {
    /// Begins with the header: kind, length of the whole, the fields that follow it, and the sizes of the table of factors.
    fn new(
        out: &'a mut [u8],
        kind: usize,
        fields: [usize; 6],
        [half, difference]: [u8; 2],
        length: usize,
    ) -> Self {
        let mut writer = Self { out: &mut out[..length], at: 0 };
        writer.put(&MAGIC);
        let nodes = usize::from(half) | usize::from(difference) << 16;
        for n in [FORMAT_VERSION as usize, kind, length].into_iter().chain(fields).chain([nodes]) {
            writer.put(&u32::try_from(n).unwrap_or(u32::MAX).to_le_bytes());
        }
        writer
    }

    fn put(&mut self, bytes: &[u8]) {
        self.out[self.at..self.at + bytes.len()].copy_from_slice(bytes);
        self.at += bytes.len();
    }

    fn number(&mut self, n: f32) {
        self.put(&n.to_le_bytes());
    }

    /// Ends with the factors, provenance and checksum, and checks the whole; returns its length.
    fn finish(mut self, factors: Option<FactorTable<'_>>, provenance: &str) -> Result<usize, FormatError> {
        if let Some(table) = factors {
            table.albedo_differences.iter().flatten().for_each(|n| self.number(*n));
            let nodes = || table.factors.iter().map(FactorTable::node);
            self.number(nodes().fold(0.0, |most, node| most.max(largest(node))));
            nodes().for_each(|node| self.put(&node.to_le_bytes()));
        }
        self.put(provenance.as_bytes());
        let checksum = crc32(&self.out[..self.at]);
        self.put(&checksum.to_le_bytes());
        validate(self.out)?;
        Ok(self.at)
    }
}

/// The largest factor of a node.
fn largest(node: u32) -> f32 {
    (0..3).map(|place| factors::decoded(node, place)).fold(0.0, f32::max)
}

/// Checks how bytes start, of which [`SMALLEST`] are enough, and returns the length that they announce.
pub(crate) fn announced_len(bytes: &[u8]) -> Result<usize, FormatError> {
    if bytes.len() < MAGIC.len() || bytes[..MAGIC.len()] != MAGIC {
        return Err(FormatError::Magic);
    }
    if bytes.len() < SMALLEST {
        return Err(FormatError::Length { expected: SMALLEST, actual: bytes.len() });
    }
    let version = u32_at(bytes, 8);
    if !(1..=FORMAT_VERSION).contains(&version) {
        return Err(FormatError::Version(version));
    }
    if u32_at(bytes, 12) > 1 {
        return Err(FormatError::Field { name: "kind", offset: 12 });
    }
    Ok(u32_at(bytes, 16) as usize)
}

/// Checks every field once; what passes can be read without a further check.
pub(crate) fn validate(bytes: &[u8]) -> Result<Header, FormatError> {
    let announced = announced_len(bytes)?;
    if announced != bytes.len() {
        return Err(FormatError::Length { expected: announced, actual: bytes.len() });
    }
    let field = |name, offset| Err(FormatError::Field { name, offset });
    let count = |offset| u32_at(bytes, offset) as usize;
    let mut header = Header {
        kind: Kind::Line,
        views: count(20),
        lobes: count(24),
        squeezed: count(28),
        mirrored: 0,
        provenance: count(32),
        has_luminance: count(8) > 1,
        factors: [0; 2],
    };
    if !(1..=MAX_VIEWS).contains(&header.views) {
        return field("number of views", 20);
    }
    let mut reserved = 40;
    if count(12) == 1 {
        (header.kind, header.views) = grid::read_shape(bytes)?;
        reserved = 44;
    } else {
        header.mirrored = count(MIRRORED);
    }
    let mut free = HEADER;
    if header.has_luminance {
        header.factors = read_table_shape(count(NODES))?;
        free = NODES;
    }
    if !(1..=crate::MAX_LOBES).contains(&header.lobes) {
        return field("number of lobes", 24);
    }
    if header.squeezed > header.lobes {
        return field("number of squeezed lobes", 28);
    }
    if header.mirrored > header.lobes - header.squeezed || header.lobes + header.mirrored > crate::MAX_LOBES {
        return field("number of mirrored lobes", MIRRORED);
    }
    // The counts are small by now, and the text is no longer than the file: the sum cannot overflow.
    if header.provenance > bytes.len() || header.len() != bytes.len() {
        return field("length of the provenance", 32);
    }
    if (reserved..free).step_by(4).any(|offset| count(offset) != 0) {
        return field("reserved field", reserved);
    }
    if crc32(&bytes[..bytes.len() - CHECKSUM]) != u32_at(bytes, bytes.len() - CHECKSUM) {
        return Err(FormatError::Checksum);
    }
    let text = bytes.len() - CHECKSUM - header.provenance;
    if core::str::from_utf8(&bytes[text..text + header.provenance]).is_err() {
        return field("provenance (not UTF-8)", text);
    }
    match header.kind {
        Kind::Line => {
            validate_thetas(bytes, &header, header.views)?;
            validate_views(bytes, &header)?;
        }
        Kind::Grid(shape) => {
            validate_thetas(bytes, &header, shape.thetas)?;
            grid::validate(bytes, &header, shape)?;
        }
    }
    if header.factors[0] > 0 {
        validate_table(bytes, &header)?;
    }
    Ok(header)
}

/// Reads the numbers of nodes of a table of factors; two of 0 for none.
fn read_table_shape(both: usize) -> Result<[u8; 2], FormatError> {
    let nodes = [both & 0xffff, both >> 16];
    if both != 0 && !nodes.iter().all(|n| factors::SIZES.contains(n)) {
        return Err(FormatError::Field { name: "size of the table of factors", offset: NODES });
    }
    Ok(nodes.map(|n| n as u8))
}

/// Checks the table of factors, and what stands with it.
fn validate_table(bytes: &[u8], header: &Header) -> Result<(), FormatError> {
    for offset in (header.albedo_difference(0)..header.albedo_difference(header.views)).step_by(4) {
        check(bytes, "albedo difference", offset, -MOST_ALBEDO_DIFFERENCE, MOST_ALBEDO_DIFFERENCE)?;
    }
    let start = header.nodes();
    let mut most = 0f32;
    for offset in (start..bytes.len() - CHECKSUM - header.provenance).step_by(4) {
        let node = u32_at(bytes, offset);
        if node >> 30 != 0 {
            return Err(FormatError::Field { name: "node of the table of factors", offset });
        }
        most = most.max(largest(node));
    }
    // Another writer may round it otherwise.
    check(bytes, "largest factor", start - 4, most * (1.0 - 1e-6), most * (1.0 + 1e-6))
}

/// Whether the number at an offset is within a range.
fn check(bytes: &[u8], name: &'static str, offset: usize, low: f32, high: f32) -> Result<(), FormatError> {
    // False for NaN too.
    let inside = (low..=high).contains(&f32_at(bytes, offset));
    if inside { Ok(()) } else { Err(FormatError::Field { name, offset }) }
}

/// Bounds of the three numbers that say an amplitude or albedo, of which the logarithms are at most `most`.
fn color_bounds(header: &Header, number: usize, most: f32) -> (f32, f32) {
    if header.has_luminance && number > 0 { (-MOST_DIFFERENCE, MOST_DIFFERENCE) } else { (-126.0, most) }
}

/// The first angle is the normal, the others rise from it.
fn validate_thetas(bytes: &[u8], header: &Header, count: usize) -> Result<(), FormatError> {
    let mut previous = -1.0;
    for n in 0..count {
        let theta = header.theta(n);
        check(bytes, "angle of a view", theta, 0.0, if n == 0 { 0.0 } else { FRAC_PI_2 })?;
        if f32_at(bytes, theta) <= previous {
            return Err(FormatError::Field { name: "angle of a view (must rise)", offset: theta });
        }
        previous = f32_at(bytes, theta);
    }
    Ok(())
}

fn validate_views(bytes: &[u8], header: &Header) -> Result<(), FormatError> {
    for view in 0..header.views {
        let check = |name, offset: usize, low: f32, high: f32| check(bytes, name, offset, low, high);
        // The first view is the normal, where nothing may depend on the azimuth of the outgoing direction.
        let limit = |free: f32| if view == 0 { 0.0 } else { free };
        check("squeeze", header.head(view), limit(-6.64), limit(1.0))?;
        for number in 0..3 {
            let (low, high) = color_bounds(header, number, 2.0);
            check("diffuse albedo", header.head(view) + 4 * (1 + number), low, high)?;
        }
        for lobe in 0..header.lobes {
            check("angle of an axis", header.row(view, 0) + 4 * lobe, limit(-PI), limit(PI))?;
            check("sharpness", header.row(view, 1) + 4 * lobe, -100.0, 26.5)?;
            for number in 0..3 {
                let (low, high) = color_bounds(header, number, 60.0);
                check("amplitude", header.row(view, 2 + number) + 4 * lobe, low, high)?;
            }
        }
        for lobe in 0..header.mirrored {
            let offset = header.row(view, 5) + 4 * lobe;
            check("angle out of the plane of incidence", offset, limit(-FRAC_PI_2), limit(FRAC_PI_2))?;
        }
    }
    Ok(())
}
