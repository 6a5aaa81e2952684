//! The portable back end: `wide`, four lanes, whatever the target offers (SSE2, NEON, wasm simd128, or plain
//! code).

use super::lane_pair::LanePair;
use super::lanes::{Lanes, PARTS, Parts, WIDEST, one_vector, part_of};
use core::ops::{Add, Div, Mul, Sub};
use wide::{f32x4, i32x4};

/// Four f32 of `wide`: a register of most targets.
#[derive(Clone, Copy)]
pub(crate) struct Wide(f32x4);

impl Wide {
    #[inline(always)]
    fn bits(self) -> i32x4 {
        bytemuck::cast(self.0)
    }
    #[inline(always)]
    fn of_bits(bits: i32x4) -> Self {
        Self(bytemuck::cast(bits))
    }
}

macro_rules! operators {
    ($($name:ident $method:ident)*) => { $(
        impl $name for Wide {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
    )* };
}
operators!(Add add Sub sub Mul mul Div div);

impl Lanes for Wide {
    const COUNT: usize = 4;
    const FUSED: bool = cfg!(target_feature = "fma") || cfg!(target_arch = "aarch64");
    type Batch = LanePair<LanePair<Self>>;
    one_vector!();
    type Lobes = Self;
    type Mask = f32x4;
    type Index = [u32; 4];
    type One = f32;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(f32x4::splat(value))
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let array: [f32; 4] = *from.first_chunk().expect("a slice of at least 4");
        Self(f32x4::new(array))
    }
    #[inline(always)]
    fn load_bytes(from: &[u8]) -> Self {
        let array: [u32; 4] = bytemuck::pod_read_unaligned(&from[..16]);
        Self(f32x4::new(array.map(|bits| f32::from_bits(u32::from_le(bits)))))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        *to.first_chunk_mut().expect("a slice of at least 4") = self.0.to_array();
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(self.0.mul_add(a.0, b.0))
    }
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        Self(self.0.mul_neg_add(a.0, b.0))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.fast_min(other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.fast_max(other.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self::of_bits(self.bits() & i32x4::splat(0x7fff_ffff))
    }
    #[inline(always)]
    fn copy_sign(self, sign: Self) -> Self {
        let sign_bit = i32x4::splat(i32::MIN);
        Self::of_bits(self.bits() & i32x4::splat(0x7fff_ffff) | sign.bits() & sign_bit)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> f32x4 {
        self.0.simd_lt(other.0)
    }
    #[inline(always)]
    fn both(a: f32x4, b: f32x4) -> f32x4 {
        a & b
    }
    #[inline(always)]
    fn ge(self, other: Self) -> f32x4 {
        self.0.simd_ge(other.0)
    }
    #[inline(always)]
    fn select(mask: f32x4, yes: Self, no: Self) -> Self {
        Self(mask.bitselect(yes.0, no.0))
    }
    #[inline(always)]
    fn keep(self, mask: f32x4) -> Self {
        Self(self.0 & mask)
    }
    #[inline(always)]
    fn add_exponent(self, n: Self) -> Self {
        let shifted: i32x4 = n.bits() << 23;
        Self::of_bits(self.bits() + shifted)
    }
    #[inline(always)]
    fn quarter_turns(n: Self, sin: Self, cos: Self) -> (Self, Self) {
        // Sign bits: odd quarters swap; the sine is negative in 2 and 3, the cosine in 1 and 2.
        let (swap, sine_sign): (i32x4, i32x4) = (n.bits() << 31, n.bits() << 30 & i32x4::splat(i32::MIN));
        let odd: f32x4 = bytemuck::cast(swap >> 31);
        let (s, c) = (Self(odd.bitselect(cos.0, sin.0)), Self(odd.bitselect(sin.0, cos.0)));
        (Self::of_bits(s.bits() ^ sine_sign), Self::of_bits(c.bits() ^ (sine_sign ^ swap)))
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        let e = (self.bits() - i32x4::splat(0x3f35_04f3)) & i32x4::splat(-0x80_0000);
        (Self::of_bits(self.bits() - e), Self(f32x4::from_i32x4(e)))
    }
    #[inline(always)]
    fn search(self, row: &Parts<'_>, len: usize) -> [u32; 4] {
        let mut count = i32x4::splat(0);
        let mut p = 0;
        while p < PARTS && WIDEST * p < len {
            for &t in part_of(row, p, len) {
                // A set mask is -1.
                let mask: i32x4 = bytemuck::cast(self.0.simd_ge(f32x4::splat(t)));
                count -= mask;
            }
            p += 1;
        }
        bytemuck::cast(count)
    }
    #[inline(always)]
    fn bits(mask: f32x4) -> u64 {
        u64::from(mask.to_bitmask())
    }
    #[inline(always)]
    fn index_below(index: [u32; 4], limit: usize) -> f32x4 {
        let limit = f32x4::splat(limit as f32);
        let index: i32x4 = bytemuck::cast(index);
        f32x4::from_i32x4(index).simd_lt(limit)
    }
    #[inline(always)]
    fn lookup(row: &Parts<'_>, len: usize, index: [u32; 4]) -> Self {
        let [a, b, c, d] = [index[0] as usize, index[1] as usize, index[2] as usize, index[3] as usize];
        if len <= WIDEST {
            let part = row[0];
            return Self(f32x4::new([
                part[a % WIDEST],
                part[b % WIDEST],
                part[c % WIDEST],
                part[d % WIDEST],
            ]));
        }
        let [a, b, c, d] = [
            f32::lookup(row, len, a),
            f32::lookup(row, len, b),
            f32::lookup(row, len, c),
            f32::lookup(row, len, d),
        ];
        Self(f32x4::new([a, b, c, d]))
    }
    #[inline(always)]
    fn first(self) -> f32 {
        self.0.to_array()[0]
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        self.0.reduce_add()
    }
    #[inline(always)]
    fn iota() -> Self {
        Self(f32x4::new([0.0, 1.0, 2.0, 3.0]))
    }
}

super::routine::entries!(Wide);
