//! The `.srbf` bytes: little endian, fixed header, views, provenance, checksum.
//!
//! ```text
//!  0  8 bytes   magic 89 53 52 42 46 0D 0A 1A
//!  8  u32       version, 1
//! 12  u32       kind, 0 = isotropic with all axes in the plane of incidence
//! 16  u32       length of the whole file in bytes
//! 20  u32       views V, 1 to 1024
//! 24  u32       lobes K of every view, 1 to 64
//! 28  u32       squeezed lobes, the first of the K
//! 32  u32       bytes of the provenance text
//! 36  u32 x 3   0
//! 48  V f32     angles of the outgoing directions from the normal, radians, the first 0, rising, at most pi / 2
//!     V heads, each 4 f32:
//!       log2 of the squeeze c, 0 in the first
//!       log2 of the diffuse albedo, red, green, blue
//!     V views, each 5 K f32:
//!       K angles of the axes from the normal, radians, positive towards the mirror direction, 0 in the first view
//!       K log2 of the sharpness
//!       K log2 of the red amplitude, K of the green, K of the blue
//!     provenance, UTF-8
//!     u32       CRC-32 of everything before
//! ```

use crate::FormatError;
use crate::checksum::crc32;
use core::f32::consts::{FRAC_PI_2, PI};

/// Version of the `.srbf` bytes that this library reads and writes.
pub const FORMAT_VERSION: u32 = 1;

const MAGIC: [u8; 8] = [0x89, b'S', b'R', b'B', b'F', b'\r', b'\n', 0x1a];
pub(crate) const HEADER: usize = 48;
const CHECKSUM: usize = 4;
/// Numbers in the head of a view: squeeze, diffuse albedo in three channels.
pub(crate) const HEAD: usize = 4;
const MAX_VIEWS: usize = 1024;

/// One lobe at one view, as it is stored: its axis in the plane of incidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneLobe {
    /// Angle of the axis from the normal, radians, positive towards the mirror direction; [-pi, pi].
    pub angle: f32,
    /// Base-2 logarithm of the sharpness; [-100, 26.5].
    pub log2_sharpness: f32,
    /// Base-2 logarithm of the amplitude per channel; [-126, 60].
    pub log2_amplitude: [f32; 3],
}

/// One view: the outgoing direction at which a material stores a mixture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View<'a> {
    /// Angle of the outgoing direction from the normal, radians.
    pub theta: f32,
    /// Base-2 logarithm of the squeeze; [-6.64, 1].
    pub log2_squeeze: f32,
    /// Base-2 logarithm of the albedo of the diffuse term, per channel; [-126, 2], -126 for none.
    pub log2_diffuse: [f32; 3],
    /// The lobes, squeezed ones first; the same number, in the same order, at every view.
    pub lobes: &'a [PlaneLobe],
}

/// What the header says, once it has been checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Header {
    pub views: usize,
    pub lobes: usize,
    pub squeezed: usize,
    pub provenance: usize,
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
    /// Byte offset of a row of K numbers of a view: axes, sharpness, red, green, blue.
    #[inline(always)]
    pub const fn row(&self, view: usize, row: usize) -> usize {
        HEADER + 4 * ((1 + HEAD) * self.views + (5 * view + row) * self.lobes)
    }
    const fn len(&self) -> usize {
        self.row(self.views, 0) + self.provenance + CHECKSUM
    }
}

/// Bytes that [`encode`] writes.
pub const fn encoded_len(views: usize, lobes: usize, provenance: &str) -> usize {
    Header { views, lobes, squeezed: 0, provenance: provenance.len() }.len()
}

#[inline(always)]
pub(crate) fn u32_at(bytes: &[u8], offset: usize) -> u32 {
    bytemuck::pod_read_unaligned::<u32>(&bytes[offset..offset + 4]).to_le()
}

#[inline(always)]
pub(crate) fn f32_at(bytes: &[u8], offset: usize) -> f32 {
    f32::from_bits(u32_at(bytes, offset))
}

/// Writes a material as `.srbf` bytes and checks them as a reader would.
///
/// Shapes: `out` [[`encoded_len`]], overwritten. Returns: the bytes written.
///
/// # Errors
/// [`FormatError::Buffer`] if `out` is too small; [`FormatError::Field`] for a value that has no place in a material.
pub fn encode(
    views: &[View<'_>],
    squeezed: usize,
    provenance: &str,
    out: &mut [u8],
) -> Result<usize, FormatError> {
    let lobes = views.first().map_or(0, |v| v.lobes.len());
    let needed = encoded_len(views.len(), lobes, provenance);
    if out.len() < needed {
        return Err(FormatError::Buffer { needed, available: out.len() });
    }
    let mut at = 0;
    let mut put = |bytes: &[u8]| {
        out[at..at + bytes.len()].copy_from_slice(bytes);
        at += bytes.len();
    };
    put(&MAGIC);
    for n in [FORMAT_VERSION as usize, 0, needed, views.len(), lobes, squeezed, provenance.len(), 0, 0, 0] {
        put(&u32::try_from(n).unwrap_or(u32::MAX).to_le_bytes());
    }
    if let Some(v) = views.iter().position(|view| view.lobes.len() != lobes) {
        let header = Header { views: views.len(), lobes, squeezed, provenance: 0 };
        return Err(FormatError::Field { name: "number of lobes of a view", offset: header.row(v, 0) });
    }
    views.iter().for_each(|view| put(&view.theta.to_le_bytes()));
    for view in views {
        put(&view.log2_squeeze.to_le_bytes());
        view.log2_diffuse.iter().for_each(|n| put(&n.to_le_bytes()));
    }
    for view in views {
        view.lobes.iter().for_each(|l| put(&l.angle.to_le_bytes()));
        view.lobes.iter().for_each(|l| put(&l.log2_sharpness.to_le_bytes()));
        for channel in 0..3 {
            view.lobes.iter().for_each(|l| put(&l.log2_amplitude[channel].to_le_bytes()));
        }
    }
    put(provenance.as_bytes());
    let checksum = crc32(&out[..needed - CHECKSUM]);
    out[needed - CHECKSUM..needed].copy_from_slice(&checksum.to_le_bytes());
    validate(&out[..needed])?;
    Ok(needed)
}

/// Checks every field once; what passes can be read without a further check.
pub(crate) fn validate(bytes: &[u8]) -> Result<Header, FormatError> {
    let length = |expected| FormatError::Length { expected, actual: bytes.len() };
    if bytes.len() < MAGIC.len() || bytes[..MAGIC.len()] != MAGIC {
        return Err(FormatError::Magic);
    }
    if bytes.len() < HEADER + CHECKSUM {
        return Err(length(HEADER + CHECKSUM));
    }
    let version = u32_at(bytes, 8);
    if version != FORMAT_VERSION {
        return Err(FormatError::Version(version));
    }
    let field = |name, offset| Err(FormatError::Field { name, offset });
    let count = |offset| u32_at(bytes, offset) as usize;
    if count(12) != 0 {
        return field("kind", 12);
    }
    if count(16) != bytes.len() {
        return Err(length(count(16)));
    }
    let header = Header { views: count(20), lobes: count(24), squeezed: count(28), provenance: count(32) };
    if !(1..=MAX_VIEWS).contains(&header.views) {
        return field("number of views", 20);
    }
    if !(1..=crate::MAX_LOBES).contains(&header.lobes) {
        return field("number of lobes", 24);
    }
    if header.squeezed > header.lobes {
        return field("number of squeezed lobes", 28);
    }
    // The counts are small by now, and the text is no longer than the file: the sum cannot overflow.
    if header.provenance > bytes.len() || header.len() != bytes.len() {
        return field("length of the provenance", 32);
    }
    if (36..HEADER).step_by(4).any(|offset| count(offset) != 0) {
        return field("reserved field", 36);
    }
    if crc32(&bytes[..bytes.len() - CHECKSUM]) != u32_at(bytes, bytes.len() - CHECKSUM) {
        return Err(FormatError::Checksum);
    }
    let text = bytes.len() - CHECKSUM - header.provenance;
    if core::str::from_utf8(&bytes[text..text + header.provenance]).is_err() {
        return field("provenance (not UTF-8)", text);
    }
    validate_views(bytes, &header)?;
    Ok(header)
}

fn validate_views(bytes: &[u8], header: &Header) -> Result<(), FormatError> {
    let mut previous = -1.0;
    for view in 0..header.views {
        let check = |name, offset: usize, low: f32, high: f32| {
            // False for NaN too.
            let inside = (low..=high).contains(&f32_at(bytes, offset));
            if inside { Ok(()) } else { Err(FormatError::Field { name, offset }) }
        };
        // The first view is the normal, where nothing may depend on the azimuth of the outgoing direction.
        let limit = |free: f32| if view == 0 { 0.0 } else { free };
        let theta = header.theta(view);
        check("angle of a view", theta, 0.0, limit(FRAC_PI_2))?;
        if f32_at(bytes, theta) <= previous {
            return Err(FormatError::Field { name: "angle of a view (must rise)", offset: theta });
        }
        previous = f32_at(bytes, theta);
        check("squeeze", header.head(view), limit(-6.64), limit(1.0))?;
        for channel in 1..HEAD {
            check("diffuse albedo", header.head(view) + 4 * channel, -126.0, 2.0)?;
        }
        for lobe in 0..header.lobes {
            check("angle of an axis", header.row(view, 0) + 4 * lobe, limit(-PI), limit(PI))?;
            check("sharpness", header.row(view, 1) + 4 * lobe, -100.0, 26.5)?;
            for channel in 2..5 {
                check("amplitude", header.row(view, channel) + 4 * lobe, -126.0, 60.0)?;
            }
        }
    }
    Ok(())
}
