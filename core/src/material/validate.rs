//! Checks every field of a material's bytes once: what passes is read without a further check.

use super::checksum::crc32;
use super::codes::{Codes, PACK_HEAD};
use super::factor_table::{AZIMUTHS, LEAST_LARGEST, MOST_FACTOR, SIZES, largest_2};
use super::format_error::{FORMAT_VERSION, FormatError};
use super::layout::{
    BLOCK_HEAD, BLOCKS, CHECKSUM, FACT, Header, Kind, LOBE, MAGIC, MAX_LOBES, MIRRORED, MIRRORS, PACK,
    SMALLEST, SPEC, Shape, TABLE_HEAD, TEXT, f32_at, padded, part, u32_at,
};
use super::spectral_map::SpectralMap;
use crate::color::MOST_DIFFERENCE;
use crate::float;
use core::f32::consts::{FRAC_PI_2, PI};

/// Largest magnitude of a stored difference of albedos, relative to the luminance.
const MOST_ALBEDO_DIFFERENCE: f32 = 16.0;

const MAX_VIEWS: usize = 1024;

const MAX_AZIMUTHS: usize = 64;

/// Views of an anisotropic material.
const MAX_GRID_VIEWS: usize = 4096;

/// Byte offsets of version and kind.
pub(crate) const VERSION: usize = 8;
pub(crate) const KIND: usize = 12;

/// Bounds of the eigenvalues of the logarithm of the squeeze matrix. Matrices within form a convex set that
/// turning keeps, so interpolated and turned numbers lie within too.
const SQUEEZE: (f32, f32) = (-5.0, 6.64);

/// Checks how bytes start, of which [`SMALLEST`] are enough, and returns the length that they announce.
pub(crate) fn announced_len(bytes: &[u8]) -> Result<usize, FormatError> {
    if !bytes.starts_with(&MAGIC) {
        return Err(FormatError::Magic);
    }
    if bytes.len() < SMALLEST {
        return Err(FormatError::Length { expected: SMALLEST, actual: bytes.len() });
    }
    let version = u32_at(bytes, VERSION);
    if !(1..=FORMAT_VERSION).contains(&version) {
        return Err(FormatError::Version(version));
    }
    if u32_at(bytes, KIND) > 2 {
        return Err(FormatError::Field { name: "kind", offset: KIND });
    }
    Ok(u32_at(bytes, 16) as usize)
}

/// Checks every field once; what passes can be read without a further check.
pub(crate) fn validate(bytes: &[u8]) -> Result<Header, FormatError> {
    let announced = announced_len(bytes)?;
    if announced != bytes.len() {
        return Err(FormatError::Length { expected: announced, actual: bytes.len() });
    }
    if u32_at(bytes, KIND) > 1 {
        return Err(FormatError::Kind { is_sheet: true });
    }
    let version = u32_at(bytes, VERSION);
    let header = read_counts(bytes, version)?;
    let header = if version < 3 { read_places(bytes, header, version)? } else { read_blocks(bytes, header)? };
    if crc32(part(bytes, 0..bytes.len() - CHECKSUM)) != u32_at(bytes, bytes.len() - CHECKSUM) {
        return Err(FormatError::Checksum);
    }
    let text = header.text;
    if core::str::from_utf8(part(bytes, text..text + header.provenance as usize)).is_err() {
        return Err(FormatError::Field { name: "provenance (not UTF-8)", offset: text });
    }
    match header.kind {
        Kind::Line => {
            validate_thetas(bytes, &header, header.views)?;
            validate_views(bytes, &header)?;
        }
        Kind::Grid(shape) => {
            validate_thetas(bytes, &header, shape.thetas)?;
            validate_grid(bytes, &header, shape)?;
        }
    }
    if header.has_factors() {
        validate_table(bytes, &header)?;
    }
    Ok(header)
}

/// Reads the kind and the counts of views and lobes.
fn read_counts(bytes: &[u8], version: u32) -> Result<Header, FormatError> {
    let field = |name, offset| Err(FormatError::Field { name, offset });
    let count = |offset| u32_at(bytes, offset) as usize;
    // Older versions have the length of the provenance before mirrored lobes, or the views of a ring.
    let mirrored = if version < 3 { MIRRORED + 4 } else { MIRRORED };
    let mut header = Header {
        views: count(20),
        lobes: count(24),
        squeezed: count(28),
        has_luminance: version > 1,
        bits: if version < 3 { 10 } else { 8 },
        ..Header::EMPTY
    };
    if !(1..=MAX_VIEWS).contains(&header.views) {
        return field("number of views", 20);
    }
    if count(KIND) == 1 {
        (header.kind, header.views) = read_shape(bytes, mirrored)?;
    } else {
        header.mirrored = count(mirrored);
        if count(mirrored + 4) != 0 {
            return field("reserved field", mirrored + 4);
        }
    }
    if !(1..=MAX_LOBES).contains(&header.lobes) {
        return field("number of lobes", 24);
    }
    if header.squeezed > header.lobes {
        return field("number of squeezed lobes", 28);
    }
    if header.mirrored > header.lobes - header.squeezed || header.lobes + header.mirrored > MAX_LOBES {
        return field("number of mirrored lobes", mirrored);
    }
    Ok(header)
}

/// Places of what stands in a file of version 1 or 2; the counts have been checked.
fn read_places(bytes: &[u8], mut header: Header, version: u32) -> Result<Header, FormatError> {
    const PROVENANCE: usize = 32;
    const NODES: usize = 44;
    let count = |offset| u32_at(bytes, offset) as usize;
    let both = count(NODES);
    if version == 1 && both != 0 {
        return Err(FormatError::Field { name: "reserved field", offset: NODES });
    }
    if both != 0 {
        header.factors = table_shape([both & 0xffff, both >> 16, 1], NODES)?;
    }
    header.table = header.lobes_end();
    header.text = if header.has_factors() { header.nodes_end() } else { header.table };
    let provenance = count(PROVENANCE);
    header.provenance = provenance as u32;
    // The counts are small here, and the text is at most as long as the file: the sum cannot overflow.
    if provenance > bytes.len() || header.text + provenance + CHECKSUM != bytes.len() {
        return Err(FormatError::Field { name: "length of the provenance", offset: PROVENANCE });
    }
    Ok(header)
}

/// A block, whose bytes are there.
pub(crate) struct FoundBlock {
    pub tag: [u8; 4],
    pub length: usize,
    /// Where the next one begins.
    pub next: usize,
}

/// Looks at the block that begins at a place, of blocks that end at one.
pub(crate) fn block_at(bytes: &[u8], at: usize, end: usize) -> Result<FoundBlock, FormatError> {
    let field = |name, offset| Err(FormatError::Field { name, offset });
    if end - at < BLOCK_HEAD {
        return field("block (cut off)", at);
    }
    let tag = u32_at(bytes, at).to_le_bytes();
    let (start, length) = (at + BLOCK_HEAD, u32_at(bytes, at + 4) as usize);
    if length > end - start {
        return field("length of a block", at + 4);
    }
    let next = padded(start + length);
    if next > end || part(bytes, start + length..next).iter().any(|b| *b != 0) {
        return field("bytes between blocks (must be 0)", start + length);
    }
    Ok(FoundBlock { tag, length, next })
}

/// Walks through the blocks, and finds the places of those that are known; the counts have been checked.
fn read_blocks(bytes: &[u8], mut header: Header) -> Result<Header, FormatError> {
    let field = |name, offset| Err(FormatError::Field { name, offset });
    let end = bytes.len() - CHECKSUM;
    let mut at = BLOCKS;
    while at < end {
        let FoundBlock { tag, length, next } = block_at(bytes, at, end)?;
        let start = at + BLOCK_HEAD;
        if matches!(tag, LOBE | PACK) != (at == BLOCKS) {
            return field("tag of a block (lobes come first, once)", at);
        }
        match tag {
            LOBE if start + length != header.lobes_end() => {
                return field("length of the block of lobes", at + 4);
            }
            LOBE => {}
            PACK => {
                header.codes = Some(read_codes(part(bytes, start..start + length), start)?);
                if start + length != header.lobes_end() {
                    return field("length of the block of lobes", at + 4);
                }
            }
            FACT if header.has_factors() => return field("tag of a block (a second table of factors)", at),
            FACT => {
                let table = u32_at(bytes, start).to_le_bytes();
                if length < TABLE_HEAD || table[3] > 1 || table[3] == 1 && table[2] < 2 {
                    return field("head of the table of factors", start);
                }
                let shape = [table[0], table[1], table[2]].map(usize::from);
                (header.factors, header.table) = (table_shape(shape, start)?, start + TABLE_HEAD);
                header.has_signed_factors = table[3] == 1;
                if start + length != header.nodes_end() {
                    return field("length of the block of factors", at + 4);
                }
            }
            TEXT if header.text > 0 => return field("tag of a block (a second provenance)", at),
            TEXT => (header.text, header.provenance) = (start, length as u32),
            SPEC if header.spectrum > 0 => return field("tag of a block (a second one of spectra)", at),
            SPEC => {
                SpectralMap::from_bytes(part(bytes, start..start + length)).map_err(|e| e.moved(start))?;
                header.spectrum = start as u32;
            }
            // What begins with a small letter may be skipped.
            [b'a'..=b'z', ..] => {}
            _ => return field("tag of a block (unknown, and not to be skipped)", at),
        }
        at = next;
    }
    Ok(header)
}

/// How the codes are stored of a block that starts at an offset.
fn read_codes(block: &[u8], offset: usize) -> Result<Codes, FormatError> {
    let field = |name, at| Err(FormatError::Field { name, offset: offset + at });
    let [bits, channels, rest @ ..] = block else { return field("bits of a code (cut off)", 0) };
    if ![8, 16].contains(bits) {
        return field("bits of a code (8 or 16)", 0);
    }
    if ![1, 3].contains(channels) {
        return field("channels (1 or 3)", 1);
    }
    if rest.first_chunk() != Some(&[0; PACK_HEAD - 2]) {
        return field("reserved field", 2);
    }
    Ok(Codes { bytes: bits / 8, is_grey: *channels == 1 })
}

/// The numbers of nodes of a table of factors, which stand at an offset.
fn table_shape(nodes: [usize; 3], offset: usize) -> Result<[u8; 3], FormatError> {
    if !nodes[..2].iter().all(|n| SIZES.contains(n)) || !AZIMUTHS.contains(&nodes[2]) {
        return Err(FormatError::Field { name: "size of the table of factors", offset });
    }
    Ok(nodes.map(|n| n as u8))
}

/// Checks the table of factors, and what stands with it.
fn validate_table(bytes: &[u8], header: &Header) -> Result<(), FormatError> {
    for offset in (header.albedo_difference(0)..header.albedo_difference(header.views)).step_by(4) {
        check(bytes, "albedo difference", offset, -MOST_ALBEDO_DIFFERENCE, MOST_ALBEDO_DIFFERENCE)?;
    }
    let start = header.nodes();
    if header.bits == 8 {
        let least = if f32_at(bytes, start - 4) == 0.0 { 0.0 } else { LEAST_LARGEST };
        return check(bytes, "largest factor", start - 4, least, MOST_FACTOR);
    }
    let mut most = 0f32;
    for offset in (start..header.nodes_end()).step_by(4) {
        let node = u32_at(bytes, offset);
        if node >> 30 != 0 {
            return Err(FormatError::Field { name: "node of the table of factors", offset });
        }
        most = most.max(largest_2(node));
    }
    // Another writer may round it otherwise.
    check(bytes, "largest factor", start - 4, most * (1.0 - 1e-6), most * (1.0 + 1e-6))
}

/// Whether a number, which stands at an offset, is within a range.
fn is_inside(name: &'static str, number: f32, offset: usize, low: f32, high: f32) -> Result<(), FormatError> {
    // False for NaN too.
    if (low..=high).contains(&number) { Ok(()) } else { Err(FormatError::Field { name, offset }) }
}

/// Whether the number at an offset is within a range.
fn check(bytes: &[u8], name: &'static str, offset: usize, low: f32, high: f32) -> Result<(), FormatError> {
    is_inside(name, f32_at(bytes, offset), offset, low, high)
}

/// Bounds of the three numbers that say an amplitude or albedo, of which the logarithms are at most `most`.
fn color_bounds(header: &Header, number: usize, most: f32) -> (f32, f32) {
    if header.has_luminance && number > 0 { (-MOST_DIFFERENCE, MOST_DIFFERENCE) } else { (-126.0, most) }
}

/// The first angle is the normal, the others rise from it.
fn validate_thetas(bytes: &[u8], header: &Header, count: usize) -> Result<(), FormatError> {
    let mut previous = -1.0;
    for n in 0..count {
        let (angle, offset) = (header.angle(bytes, n), header.angle_offset(n));
        is_inside("angle of a view", angle, offset, 0.0, if n == 0 { 0.0 } else { FRAC_PI_2 })?;
        if angle <= previous {
            return Err(FormatError::Field { name: "angle of a view (must rise)", offset });
        }
        previous = angle;
    }
    Ok(())
}

fn validate_views(bytes: &[u8], header: &Header) -> Result<(), FormatError> {
    for view in 0..header.views {
        let check = |name, number: usize, low: f32, high: f32| {
            is_inside(
                name,
                header.head_number(bytes, view, number),
                header.head_offset(view, number),
                low,
                high,
            )
        };
        // The first view is the normal, where nothing may depend on the azimuth of the outgoing direction.
        let limit = |free: f32| if view == 0 { 0.0 } else { free };
        check("squeeze", 0, limit(-6.64), limit(1.0))?;
        for number in 0..3 {
            let (low, high) = color_bounds(header, number, 2.0);
            check("diffuse albedo", 1 + number, low, high)?;
        }
        let check = |name, row: usize, lobe: usize, low: f32, high: f32| {
            let offset = header.number_offset(view, row, lobe);
            is_inside(name, header.number(bytes, view, row, lobe), offset, low, high)
        };
        for lobe in 0..header.lobes {
            check("angle of an axis", 0, lobe, limit(-PI), limit(PI))?;
            check("sharpness", 1, lobe, -100.0, 26.5)?;
            for number in 0..3 {
                let (low, high) = color_bounds(header, number, 60.0);
                check("amplitude", 2 + number, lobe, low, high)?;
            }
        }
        for lobe in 0..header.mirrored {
            check("angle out of the plane of incidence", 5, lobe, limit(-FRAC_PI_2), limit(FRAC_PI_2))?;
        }
    }
    Ok(())
}

/// Reads how the views lie, from the numbers at an offset on, and how many there are; the number of angles has been
/// checked.
fn read_shape(bytes: &[u8], ring: usize) -> Result<(Kind, usize), FormatError> {
    let count = |offset| u32_at(bytes, offset) as usize;
    let (turns, axis) = (count(ring + 4) as u16, (count(ring + 4) >> 16) as u16);
    let shape = Shape { thetas: count(20), azimuths: count(ring), turns, axis };
    if !matches!(turns, 1 | 2 | MIRRORS) {
        return Err(FormatError::Field { name: "turns", offset: ring + 4 });
    }
    let fewest = if shape.is_mirrored() { 2 } else { 1 };
    if !(fewest..=MAX_AZIMUTHS).contains(&shape.azimuths) || shape.views() > MAX_GRID_VIEWS {
        return Err(FormatError::Field { name: "number of views of a ring", offset: ring });
    }
    Ok((Kind::Grid(shape), shape.views()))
}

/// Checks heads and lobes of every view.
fn validate_grid(bytes: &[u8], header: &Header, shape: Shape) -> Result<(), FormatError> {
    for view in 0..header.views {
        let head = |i| header.grid_head(shape, bytes, view, i);
        let [(xx, offset), (xy, _), (yy, _)] = [0, 1, 2].map(head);
        let (middle, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let reach = float::sqrt(half * half + xy * xy);
        // False for NaN too.
        if !(middle - reach >= SQUEEZE.0 && middle + reach <= SQUEEZE.1) {
            return Err(FormatError::Field { name: "squeeze matrix", offset });
        }
        for number in 0..3 {
            let (low, high) = color_bounds(header, number, 2.0);
            let (found, offset) = head(3 + number);
            is_inside("diffuse albedo", found, offset, low, high)?;
        }
        for lobe in 0..header.lobes {
            let at = |row| header.grid_number(shape, bytes, view, row, lobe);
            let [(along, offset), (across, _)] = [at(0), at(1)];
            // False for NaN too.
            let inside = along * along + across * across <= PI * PI;
            if !inside {
                return Err(FormatError::Field { name: "angle of an axis", offset });
            }
            let check = |name, row, low, high| is_inside(name, at(row).0, at(row).1, low, high);
            check("sharpness", 2, -100.0, 26.5)?;
            for number in 0..3 {
                let (low, high) = color_bounds(header, number, 60.0);
                check("amplitude", 3 + number, low, high)?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::{Line, Material, PlaneLobe, View};
    use std::vec;
    use std::vec::Vec;

    /// The bytes of a material with views at these angles, each of `count` equal lobes.
    fn material(
        thetas: &[f32],
        count: usize,
        squeezed: usize,
        mirrored: usize,
    ) -> Result<Vec<u8>, FormatError> {
        let lobe = PlaneLobe {
            angle: 0.0,
            off_plane: 0.0,
            log2_sharpness: 3.0,
            log2_luminance: -1.0,
            color_differences: [0.0; 2],
        };
        let lobes = vec![lobe; count];
        let view = |&theta: &f32| View {
            theta,
            log2_squeeze: 0.0,
            log2_diffuse: -3.0,
            diffuse_color_differences: [0.0; 2],
            lobes: &lobes,
        };
        let views: Vec<View<'_>> = thetas.iter().map(view).collect();
        let line = Line { views: &views, squeezed, mirrored, factors: None };
        let mut bytes = vec![0; line.encoded_len("test")];
        line.encode("test", &mut bytes).map(|_| bytes)
    }

    fn field(name: &'static str, offset: usize) -> Result<Vec<u8>, FormatError> {
        Err(FormatError::Field { name, offset })
    }

    /// As far as the room of a mixture and the bounds of the format go, and one further.
    #[test]
    fn counts_beyond_the_format_are_refused_with_their_place() {
        for [count, squeezed, mirrored] in [[64, 64, 0], [63, 0, 1], [32, 0, 32], [1, 1, 0]] {
            let bytes = material(&[0.0], count, squeezed, mirrored).unwrap();
            assert_eq!(Material::from_bytes(bytes).unwrap().lobe_count(), count + mirrored);
        }
        for count in [0, 65] {
            assert_eq!(material(&[0.0], count, 0, 0), field("number of lobes", 24));
        }
        assert_eq!(material(&[0.0], 3, 4, 0), field("number of squeezed lobes", 28));
        for [count, squeezed, mirrored] in [[64, 0, 1], [33, 0, 32], [64, 0, 64], [3, 2, 2], [3, 0, 4]] {
            let refused = material(&[0.0], count, squeezed, mirrored);
            assert_eq!(refused, field("number of mirrored lobes", MIRRORED), "{count} {squeezed} {mirrored}");
        }
        let rising: Vec<f32> = (0..=MAX_VIEWS).map(|n| 1e-3 * n as f32).collect();
        assert!(material(&rising[1..], 1, 0, 0).is_err() && material(&rising[..MAX_VIEWS], 1, 0, 0).is_ok());
        assert_eq!(material(&rising, 1, 0, 0), field("number of views", 20));
    }

    #[test]
    fn angles_of_views_rise_from_the_normal_or_are_refused_with_their_place() {
        let (rise, angle) = ("angle of a view (must rise)", "angle of a view");
        for (thetas, name, view) in [
            ([0.0, 0.5, 0.5], rise, 2),
            ([0.0, 0.5, 0.4], rise, 2),
            ([0.0, 0.0, 0.4], rise, 1),
            ([0.1, 0.2, 0.3], angle, 0),
            ([0.0, -0.2, 0.3], angle, 1),
            ([0.0, 0.2, 1.6], angle, 2),
            ([0.0, f32::NAN, 0.3], angle, 1),
        ] {
            assert_eq!(material(&thetas, 1, 0, 0), field(name, 48 + 4 * view), "{thetas:?}");
        }
    }

    /// Bytes of a material with some others at an offset, and the checksum that fits.
    fn with(bytes: &[u8], offset: usize, put: &[u8]) -> Vec<u8> {
        let mut changed = bytes.to_vec();
        changed[offset..offset + put.len()].copy_from_slice(put);
        let end = changed.len() - CHECKSUM;
        let sum = crc32(&changed[..end]);
        changed[end..].copy_from_slice(&sum.to_le_bytes());
        changed
    }

    #[test]
    fn no_number_may_be_nan_and_provenance_is_utf_8() {
        let bytes = material(&[0.0, 0.7], 3, 1, 1).unwrap();
        let Header { text, .. } = validate(&bytes).unwrap();
        assert_eq!(with(&bytes, 40, b"LOBE"), bytes);
        for offset in (48..text - BLOCK_HEAD).step_by(4) {
            let refused = validate(&with(&bytes, offset, &f32::NAN.to_le_bytes())).err();
            assert!(
                matches!(refused, Some(FormatError::Field { offset: at, .. }) if at == offset),
                "{offset}"
            );
        }
        let refused = validate(&with(&bytes, text, &[0xff])).err();
        assert_eq!(refused, field("provenance (not UTF-8)", text).err());
    }

    #[test]
    fn every_flipped_bit_is_refused() {
        let bytes = material(&[0.0, 0.7], 3, 1, 1).unwrap();
        for at in 0..8 * bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at / 8] ^= 1 << (at % 8);
            assert!(validate(&damaged).is_err(), "bit {at}");
        }
    }
}
