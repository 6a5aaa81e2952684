//! The `.srbf` bytes of a sheet: the head of a file, shares of draws, and up to four materials, each with head and checksum of its own.
//!
//! ```text
//!  0  8 bytes   magic, as of a material
//!  8  u32       version, 3
//! 12  u32       kind, 2
//! 16  u32       length of the whole file in bytes
//! 20  u32       1 if the back is like the front: then quarters of the back are not stored; else 0
//! 24  16 bytes  0
//! 40  blocks, tag, length, content, zeros, as of a material; the first is SHAR
//!     u32       CRC-32 of everything before
//! ```
//!
//! | block | content |
//! |---|---|
//! | `SHAR` | 16 bytes for viewers in front, 16 for those behind: the share of draws that are reflected, q / 255, at the heights n / 15 of `wo`, linear between. Not 0 or 255 where the side has both quarters |
//! | `FREF`, `FTRA`, `BREF`, `BTRA` | the `.srbf` bytes of a material: reflection and transmission seen from the front, and from the back; at least one. A quarter that is missing is black |
//! | `text` | provenance, UTF-8 |
//!
//! A block that is not known is skipped if its tag begins with a small letter, and refused otherwise.

use super::quarter::{Quarter, Seen, upward};
use crate::float::{sin_cos_turns, sqrt};
use crate::kernel::prepare::prepare;
use crate::material::borrowed::MaterialRef;
use crate::material::bytes::{part, u32_at};
use crate::material::checksum::crc32;
use crate::material::encode::Writer;
use crate::material::format_error::FormatError;
use crate::material::layout::{BLOCK_HEAD, BLOCKS, CHECKSUM, Header, MAX_LOBES, TEXT, padded};
use crate::material::validate;
use crate::mixture::leave_out::LeaveOut;
use crate::mixture::rows::Mixture;
use crate::simd::detect::Level;
use glam::Vec3;

/// The number of a file that says that it is a sheet.
pub(crate) const KIND: u32 = 2;

const SYMMETRIC: usize = 20;
const RESERVED: usize = 24;

/// Heights of `wo` for which the share is stored.
const HEIGHTS: usize = 16;

const SHAR: [u8; 4] = *b"SHAR";
/// Tags of the quarters, in the order of [`Quarter::ALL`].
const QUARTERS: [[u8; 4]; 4] = [*b"FREF", *b"FTRA", *b"BREF", *b"BTRA"];

/// Azimuths of `wo` over which the power of an anisotropic material is averaged.
const AZIMUTHS: usize = 8;

/// Where everything stands in a sheet, once it has been checked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Head {
    pub is_symmetric: bool,
    shares: usize,
    quarters: [Option<Part>; 4],
    text: (usize, usize),
}

/// A material within the bytes of a sheet.
#[derive(Clone, Copy, Debug)]
struct Part {
    start: usize,
    length: usize,
    header: Header,
}

impl Head {
    /// The side whose quarters and shares are stored for a viewer: 0 in front, 1 behind.
    #[inline(always)]
    fn side(&self, is_back: bool) -> usize {
        usize::from(is_back && !self.is_symmetric)
    }

    /// The material of a quarter.
    #[inline(always)]
    pub fn material<'a>(&'a self, bytes: &'a [u8], quarter: Quarter) -> Option<MaterialRef<'a>> {
        let place = 2 * self.side(quarter.is_back()) + usize::from(quarter.is_transmission());
        let Part { start, length, header } = self.quarters[place].as_ref()?;
        Some(MaterialRef { bytes: part(bytes, *start..start + length), header })
    }

    /// Any material that there is.
    pub fn any<'a>(&'a self, bytes: &'a [u8]) -> Option<MaterialRef<'a>> {
        Quarter::ALL.into_iter().find_map(|quarter| self.material(bytes, quarter))
    }

    pub fn provenance<'a>(&self, bytes: &'a [u8]) -> &'a str {
        let (start, length) = self.text;
        core::str::from_utf8(part(bytes, start..start + length)).unwrap_or_default()
    }

    /// Share of the draws that are reflected.
    #[inline(always)]
    pub fn reflected_share(&self, bytes: &[u8], wo: Vec3) -> f32 {
        let side = self.side(wo.z < 0.0);
        match [0, 1].map(|transmission| self.quarters[2 * side + transmission].is_some()) {
            [true, true] => {
                // A height that is no number counts as 0.
                let place = (upward(wo).z * (HEIGHTS - 1) as f32).clamp(0.0, (HEIGHTS - 1) as f32);
                let below = (place as usize).min(HEIGHTS - 2);
                let [low, high] =
                    [below, below + 1].map(|n| f32::from(bytes[self.shares + HEIGHTS * side + n]));
                let between = place - below as f32;
                let share = low + (high - low) * if between > 0.0 { between } else { 0.0 };
                share * (1.0 / 255.0)
            }
            [false, true] => 0.0,
            _ => 1.0,
        }
    }

    /// The quarter that a viewer sees by reflected light, or by light that comes through; `None` where it is black. `reflected`: the
    /// [share](Self::reflected_share) of `wo`.
    #[inline(always)]
    pub fn seen<'a>(
        &'a self,
        bytes: &'a [u8],
        wo: Vec3,
        is_transmission: bool,
        reflected: f32,
    ) -> Option<Seen<'a>> {
        let material = self.material(bytes, Quarter::of(wo.z < 0.0, is_transmission))?;
        let share = if is_transmission { 1.0 - reflected } else { reflected };
        Some(Seen { material, wo: upward(wo), share })
    }
}

/// Checks every field once; what passes can be read without a further check.
pub(super) fn validate(bytes: &[u8]) -> Result<Head, FormatError> {
    let field = |name, offset| Err(FormatError::Field { name, offset });
    let announced = validate::announced_len(bytes)?;
    if announced != bytes.len() {
        return Err(FormatError::Length { expected: announced, actual: bytes.len() });
    }
    if u32_at(bytes, validate::KIND) != KIND {
        return Err(FormatError::Kind { is_sheet: false });
    }
    if u32_at(bytes, validate::VERSION) != 3 {
        return field("version (a sheet is of version 3)", validate::VERSION);
    }
    let symmetric = u32_at(bytes, SYMMETRIC);
    if symmetric > 1 {
        return field("whether the back is like the front", SYMMETRIC);
    }
    if part(bytes, RESERVED..BLOCKS).iter().any(|b| *b != 0) {
        return field("reserved field", RESERVED);
    }
    let mut head = Head { is_symmetric: symmetric == 1, shares: 0, quarters: [None; 4], text: (BLOCKS, 0) };
    let end = bytes.len() - CHECKSUM;
    let mut at = BLOCKS;
    while at < end {
        let block = validate::block_at(bytes, at, end)?;
        let (start, length) = (at + BLOCK_HEAD, block.length);
        if (block.tag == SHAR) != (at == BLOCKS) {
            return field("tag of a block (shares come first, once)", at);
        }
        if let Some(place) = QUARTERS.iter().position(|tag| *tag == block.tag) {
            if head.quarters[place].is_some() || head.is_symmetric && place > 1 {
                return field("tag of a block (a quarter that is there already)", at);
            }
            let header =
                validate::validate(part(bytes, start..start + length)).map_err(|e| e.moved(start))?;
            head.quarters[place] = Some(Part { start, length, header });
        } else {
            match block.tag {
                SHAR if length != 2 * HEIGHTS => return field("length of the block of shares", at + 4),
                SHAR => head.shares = start,
                TEXT if head.text.1 > 0 => return field("tag of a block (a second provenance)", at),
                TEXT => {
                    if core::str::from_utf8(part(bytes, start..start + length)).is_err() {
                        return field("provenance (not UTF-8)", start);
                    }
                    head.text = (start, length);
                }
                [b'a'..=b'z', ..] => {}
                _ => return field("tag of a block (unknown, and not to be skipped)", at),
            }
        }
        at = block.next;
    }
    if crc32(part(bytes, 0..end)) != u32_at(bytes, end) {
        return Err(FormatError::Checksum);
    }
    if head.quarters.iter().all(Option::is_none) {
        return field("quarters (none)", BLOCKS);
    }
    for side in 0..if head.is_symmetric { 1 } else { 2 } {
        let start = head.shares + HEIGHTS * side;
        let has_both = head.quarters[2 * side..2 * side + 2].iter().all(Option::is_some);
        if has_both && part(bytes, start..start + HEIGHTS).iter().any(|code| [0, 255].contains(code)) {
            return field("share of reflected draws (1 to 254 where there are both)", start);
        }
    }
    Ok(head)
}

/// Mean power of a material at a height of `wo`.
fn power_at(material: MaterialRef<'_>, height: f32) -> f32 {
    let across = sqrt((1.0 - height * height).max(0.0));
    let azimuths = if material.header.is_isotropic() { 1 } else { AZIMUTHS };
    let mut sum = 0.0;
    for n in 0..azimuths {
        let (sin, cos) = sin_cos_turns(n as f32 / azimuths as f32);
        let wo = Vec3::new(across * cos, across * sin, height);
        let mut mixture = Mixture::<MAX_LOBES>::empty();
        // Of a mixture with room for all lobes: it cannot fail.
        let _ = prepare(material, wo, LeaveOut::default(), Level::current(), &mut mixture);
        sum += mixture.power();
    }
    sum / azimuths as f32
}

/// Bytes of a sheet of some materials.
pub(super) fn encoded_len(quarters: [Option<MaterialRef<'_>>; 4], provenance: &str) -> usize {
    let block = |length: usize| BLOCK_HEAD + padded(length);
    let quarters: usize = quarters.iter().flatten().map(|material| block(material.bytes.len())).sum();
    let text = if provenance.is_empty() { 0 } else { block(provenance.len()) };
    BLOCKS + block(2 * HEIGHTS) + quarters + text + CHECKSUM
}

/// Writes a sheet, and checks it as a reader would; returns the bytes written.
pub(super) fn encode(
    quarters: [Option<MaterialRef<'_>>; 4],
    is_symmetric: bool,
    provenance: &str,
    out: &mut [u8],
) -> Result<usize, FormatError> {
    let needed = encoded_len(quarters, provenance);
    if out.len() < needed {
        return Err(FormatError::Buffer { needed, available: out.len() });
    }
    let fields = [usize::from(is_symmetric), 0, 0, 0, 0];
    let mut writer = Writer::of_kind(out, KIND as usize, fields, needed);
    let start = writer.begin(SHAR);
    for side in quarters.chunks_exact(2) {
        for n in 0..HEIGHTS {
            let height = n as f32 / (HEIGHTS - 1) as f32;
            let [reflected, transmitted] = [0, 1].map(|k| side[k].map_or(0.0, |m| power_at(m, height)));
            let share = 255.0 * reflected / (reflected + transmitted);
            // Not of two black ones, which have none.
            writer.put(&[if share > 0.0 { share + 0.5 } else { 128.0 }.clamp(1.0, 254.0) as u8]);
        }
    }
    writer.end(start);
    for (tag, material) in QUARTERS.into_iter().zip(quarters) {
        if let Some(material) = material {
            let start = writer.begin(tag);
            writer.put(material.bytes);
            writer.end(start);
        }
    }
    writer.seal(provenance, None);
    validate(&out[..needed])?;
    Ok(needed)
}
