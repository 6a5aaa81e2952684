//! The scalar back end: one f32 at a time, as `libm` and the language have it.

use super::lanes::{Lanes, NodeCodes, PARTS, Parts, WIDEST, one_vector, part_of};

/// Square root, correctly rounded.
#[inline(always)]
pub(crate) fn sqrt(x: f32) -> f32 {
    #[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
    return super::sse2::sqrt(x);
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    return super::vfp::sqrt(x);
    #[cfg(not(any(
        all(target_arch = "x86_64", target_feature = "sse2"),
        all(target_arch = "arm", target_abi = "eabihf")
    )))]
    libm::sqrtf(x)
}

impl Lanes for f32 {
    const COUNT: usize = 1;
    const FUSED: bool = false;
    type Batch = f32;
    one_vector!();
    type Lobes = Self;
    type Mask = bool;
    type Index = usize;
    type One = f32;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn load_bytes(from: &[u8]) -> Self {
        f32::from_le_bytes(*from.first_chunk().expect("at least 4 bytes"))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[0] = self;
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        b - self * a
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f32::from_bits(self.to_bits() & 0x7fff_ffff)
    }
    #[inline(always)]
    fn copy_sign(self, sign: Self) -> Self {
        f32::from_bits(self.to_bits() & 0x7fff_ffff | sign.to_bits() & 0x8000_0000)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn both(a: bool, b: bool) -> bool {
        a & b
    }
    #[inline(always)]
    fn ge(self, other: Self) -> bool {
        self >= other
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn keep(self, mask: bool) -> Self {
        if mask { self } else { 0.0 }
    }
    #[inline(always)]
    fn add_exponent(self, n: Self) -> Self {
        f32::from_bits(self.to_bits().wrapping_add(n.to_bits() << 23))
    }
    #[inline(always)]
    fn quarter_turns(n: Self, sin: Self, cos: Self) -> (Self, Self) {
        // Odd quarters swap; the sine is negative in 2 and 3, the cosine in 1 and 2.
        let (swap, sine_sign) = (n.to_bits() << 31, n.to_bits() >> 1 << 31);
        let (s, c) = if swap == 0 { (sin, cos) } else { (cos, sin) };
        (f32::from_bits(s.to_bits() ^ sine_sign), f32::from_bits(c.to_bits() ^ (sine_sign ^ swap)))
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        // Bits of sqrt(1/2): the rest above it after whole exponents are taken off is in [sqrt(1/2), sqrt(2)).
        let e = self.to_bits().wrapping_sub(0x3f35_04f3) & 0xff80_0000;
        (f32::from_bits(self.to_bits().wrapping_sub(e)), e as i32 as f32)
    }
    #[inline(always)]
    fn search(self, row: &Parts<'_>, len: usize) -> usize {
        let (mut count, mut p) = (0, 0);
        while p < PARTS && WIDEST * p < len {
            for &t in part_of(row, p, len) {
                count += usize::from(t <= self);
            }
            p += 1;
        }
        count
    }
    #[inline(always)]
    fn bits(mask: bool) -> u64 {
        u64::from(mask)
    }
    #[inline(always)]
    fn index_below(index: usize, limit: usize) -> bool {
        index < limit
    }
    #[inline(always)]
    fn lookup(row: &Parts<'_>, _len: usize, index: usize) -> Self {
        row[index / WIDEST][index % WIDEST]
    }
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
    fn node_pairs(nodes: NodeCodes<'_>, index: Self) -> [[Self; 3]; 2] {
        let pair = nodes.pair(index);
        let mut codes = [[0.0; 3]; 2];
        for node in 0..2 {
            for channel in 0..3 {
                codes[node][channel] = (pair[node] & nodes.mask(channel)) as i32 as f32;
            }
        }
        codes
    }
    #[inline(always)]
    fn first(self) -> f32 {
        self
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        self
    }
    #[inline(always)]
    fn last(self) -> Self {
        self
    }
    #[inline(always)]
    fn iota() -> Self {
        0.0
    }
}

super::routine::entries!(f32);
