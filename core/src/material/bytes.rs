//! Numbers at places of a material's bytes, and where its lobes begin.

use crate::simd::ONE_TEXT;
use core::ops::Range;

/// Byte offset of the content of the first block; in older versions the length of the header.
pub(crate) const HEADER: usize = 48;

/// Numbers in the head of a view: squeeze, diffuse albedo in three numbers.
pub(crate) const HEAD: usize = 4;

/// The same of an anisotropic material: squeeze matrix, diffuse albedo; and its rows of K numbers of a view.
pub(crate) const GRID_HEAD: usize = 6;
pub(crate) const GRID_ROWS: usize = 6;

/// A range of bytes, which are there: places are checked before. A program for a small processor needs no code for a panic
/// then: there bytes that are missing would be none.
#[inline(always)]
pub(crate) fn part(bytes: &[u8], range: Range<usize>) -> &[u8] {
    if ONE_TEXT {
        debug_assert!(range.start <= range.end && range.end <= bytes.len());
        return bytes.get(range).unwrap_or_default();
    }
    &bytes[range]
}

/// The same of a known length.
#[inline(always)]
fn chunk<const N: usize>(bytes: &[u8], offset: usize) -> [u8; N] {
    part(bytes, offset..offset + N).first_chunk().copied().unwrap_or([0; N])
}

#[inline(always)]
pub(crate) fn u32_at(bytes: &[u8], offset: usize) -> u32 {
    if ONE_TEXT {
        return u32::from_le_bytes(chunk(bytes, offset));
    }
    bytemuck::pod_read_unaligned::<u32>(&bytes[offset..offset + 4]).to_le()
}

#[inline(always)]
pub(crate) fn u16_at(bytes: &[u8], offset: usize) -> u16 {
    if ONE_TEXT {
        return u16::from_le_bytes(chunk(bytes, offset));
    }
    bytemuck::pod_read_unaligned::<u16>(&bytes[offset..offset + 2]).to_le()
}

#[inline(always)]
pub(crate) fn f32_at(bytes: &[u8], offset: usize) -> f32 {
    f32::from_bits(u32_at(bytes, offset))
}
