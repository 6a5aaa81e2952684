//! Numbers at places of a material's bytes, and where its lobes begin.

/// Byte offset of the content of the first block; in older versions the length of the header.
pub(crate) const HEADER: usize = 48;

/// Numbers in the head of a view: squeeze, diffuse albedo in three numbers.
pub(crate) const HEAD: usize = 4;

#[inline(always)]
pub(crate) fn u32_at(bytes: &[u8], offset: usize) -> u32 {
    bytemuck::pod_read_unaligned::<u32>(&bytes[offset..offset + 4]).to_le()
}

#[inline(always)]
pub(crate) fn u16_at(bytes: &[u8], offset: usize) -> u16 {
    bytemuck::pod_read_unaligned::<u16>(&bytes[offset..offset + 2]).to_le()
}

#[inline(always)]
pub(crate) fn f32_at(bytes: &[u8], offset: usize) -> f32 {
    f32::from_bits(u32_at(bytes, offset))
}
