//! One f32 with the fused operations of AVX2 and AVX-512: for what such a level computes once and not in
//! every lane.
//!
//! Every method is inlined into a function that enables `avx2,fma`, as those of [`super::avx2`] are, which makes each `unsafe`
//! block here sound. Choices are blends and never branches: they depend on random numbers.
#![allow(unsafe_code)]

use super::lanes::{Lanes, NodeCodes, Parts, ROUND, one_vector};
use core::arch::x86_64::*;
use core::ops::{Add, Div, Mul, Sub};

/// One f32, whose [`mul_add`](Lanes::mul_add) rounds once.
#[derive(Clone, Copy)]
pub(crate) struct Fused(f32);

macro_rules! operators {
    ($($name:ident $method:ident)*) => { $(
        impl $name for Fused {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
    )* };
}
operators!(Add add Sub sub Mul mul Div div);

/// A coefficient for an angle, and beside it the one for twice that, smaller by a power of two.
#[inline(always)]
fn doubled(coefficient: f32, by: f32) -> __m128 {
    // SAFETY: the processor has SSE.
    unsafe { _mm_setr_ps(coefficient, coefficient / by, 0.0, 0.0) }
}

impl Fused {
    /// In the lowest lane of a register.
    #[inline(always)]
    fn wide(self) -> __m128 {
        // SAFETY: the processor has SSE.
        unsafe { _mm_set_ss(self.0) }
    }
    #[inline(always)]
    fn of(wide: __m128) -> Self {
        // SAFETY: the processor has SSE.
        Self(unsafe { _mm_cvtss_f32(wide) })
    }
    #[inline(always)]
    fn bits(self) -> __m128i {
        // SAFETY: the processor has SSE2.
        unsafe { _mm_castps_si128(self.wide()) }
    }
    #[inline(always)]
    fn of_bits(bits: __m128i) -> Self {
        // SAFETY: the processor has SSE2.
        Self::of(unsafe { _mm_castsi128_ps(bits) })
    }
}

impl Lanes for Fused {
    const COUNT: usize = 1;
    const FUSED: bool = true;
    type Batch = Self;
    one_vector!();
    type Lobes = Self;
    type Mask = __m128;
    type Index = usize;
    type One = Self;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(value)
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        Self(from[0])
    }
    #[inline(always)]
    fn load_bytes(from: &[u8]) -> Self {
        Self(f32::load_bytes(from))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[0] = self.0;
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        // SAFETY: the processor has FMA, see the head of this file.
        Self::of(unsafe { _mm_fmadd_ss(self.wide(), a.wide(), b.wide()) })
    }
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        // SAFETY: the processor has FMA, see the head of this file.
        Self::of(unsafe { _mm_fnmadd_ss(self.wide(), a.wide(), b.wide()) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(Lanes::min(self.0, other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(Lanes::max(self.0, other.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(Lanes::sqrt(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: the processor has SSE.
        Self::of(unsafe { _mm_andnot_ps(_mm_set1_ps(-0.0), self.wide()) })
    }
    #[inline(always)]
    fn copy_sign(self, sign: Self) -> Self {
        // SAFETY: the processor has SSE.
        Self::of(unsafe {
            let bit = _mm_set1_ps(-0.0);
            _mm_or_ps(_mm_andnot_ps(bit, self.wide()), _mm_and_ps(bit, sign.wide()))
        })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> __m128 {
        // SAFETY: the processor has SSE.
        unsafe { _mm_cmplt_ss(self.wide(), other.wide()) }
    }
    #[inline(always)]
    fn both(a: __m128, b: __m128) -> __m128 {
        // SAFETY: the processor has SSE.
        unsafe { _mm_and_ps(a, b) }
    }
    #[inline(always)]
    fn ge(self, other: Self) -> __m128 {
        // SAFETY: the processor has SSE.
        unsafe { _mm_cmpge_ss(self.wide(), other.wide()) }
    }
    #[inline(always)]
    fn select(mask: __m128, yes: Self, no: Self) -> Self {
        // SAFETY: the processor has SSE4.1, see the head of this file.
        Self::of(unsafe { _mm_blendv_ps(no.wide(), yes.wide(), mask) })
    }
    #[inline(always)]
    fn keep(self, mask: __m128) -> Self {
        // SAFETY: the processor has SSE.
        Self::of(unsafe { _mm_and_ps(mask, self.wide()) })
    }
    #[inline(always)]
    fn add_exponent(self, n: Self) -> Self {
        // SAFETY: the processor has SSE2.
        Self::of_bits(unsafe { _mm_add_epi32(self.bits(), _mm_slli_epi32::<23>(n.bits())) })
    }
    /// The turn is reduced to halves, where the cosine is the sine of the rest of a quarter: two lanes
    /// take one polynomial.
    #[inline(always)]
    fn sin_cos_turns(self) -> (Self, Self) {
        let halves = self + self;
        let n = halves + Self(ROUND);
        let r = halves - (n - Self(ROUND));
        // SAFETY: the processor has SSE3 and FMA, see the head of this file.
        unsafe {
            // The second lane holds twice its angle, so that no constant is the same in both: they are loaded
            // whole by the operation.
            let x = _mm_unpacklo_ps(r.wide(), (Self(1.0) - (r + r).abs()).wide());
            let x = _mm_mul_ps(x, _mm_set1_ps(core::f32::consts::PI));
            // Minimax of (sin x - x) / x^3 in x^2 on [0, pi / 2], relative to the sine 6e-9.
            let xx = _mm_mul_ps(x, x);
            let high = _mm_fmadd_ps(xx, doubled(2.605_781e-6, 256.0), doubled(-1.980_960_3e-4, 64.0));
            let low = _mm_fmadd_ps(xx, doubled(8.333_066_3e-3, 16.0), doubled(-1.666_666e-1, 4.0));
            let p = _mm_fmadd_ps(_mm_mul_ps(xx, xx), high, low);
            // Odd halves change both signs.
            let sign = _mm_slli_epi32::<31>(n.bits());
            let sign = _mm_castsi128_ps(_mm_unpacklo_epi32(sign, sign));
            let x = _mm_mul_ps(x, _mm_xor_ps(_mm_setr_ps(1.0, 0.5, 0.0, 0.0), sign));
            let sines = _mm_fmadd_ps(_mm_mul_ps(xx, x), p, x);
            (Self::of(sines), Self::of(_mm_movehdup_ps(sines)))
        }
    }
    #[inline(always)]
    fn quarter_turns(n: Self, sin: Self, cos: Self) -> (Self, Self) {
        // SAFETY: the processor has SSE4.1, see the head of this file.
        unsafe {
            // Odd quarters swap; the sine is negative in 2 and 3, the cosine in 1 and 2.
            let odd = _mm_slli_epi32::<31>(n.bits());
            let sine_sign = _mm_slli_epi32::<31>(_mm_srli_epi32::<1>(n.bits()));
            let cosine_sign = _mm_xor_si128(sine_sign, odd);
            let swap = _mm_srai_epi32::<31>(odd);
            let (s, c) = (sin.bits(), cos.bits());
            let change = _mm_and_si128(_mm_xor_si128(s, c), swap);
            let (s, c) = (_mm_xor_si128(s, change), _mm_xor_si128(c, change));
            (Self::of_bits(_mm_xor_si128(s, sine_sign)), Self::of_bits(_mm_xor_si128(c, cosine_sign)))
        }
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        // SAFETY: the processor has SSE2.
        unsafe {
            let e = _mm_sub_epi32(self.bits(), _mm_set1_epi32(0x3f35_04f3));
            let e = _mm_and_si128(e, _mm_set1_epi32(-0x80_0000));
            (Self::of_bits(_mm_sub_epi32(self.bits(), e)), Self::of(_mm_cvtepi32_ps(e)))
        }
    }
    #[inline(always)]
    fn search(self, row: &Parts<'_>, len: usize) -> usize {
        self.0.search(row, len)
    }
    #[inline(always)]
    fn bits(mask: __m128) -> u64 {
        // SAFETY: the processor has SSE.
        (unsafe { _mm_movemask_ps(mask) } & 1) as u64
    }
    #[inline(always)]
    fn index_below(index: usize, limit: usize) -> __m128 {
        // SAFETY: the processor has SSE2.
        unsafe { _mm_castsi128_ps(_mm_cvtsi32_si128(-i32::from(index < limit))) }
    }
    #[inline(always)]
    fn lookup(row: &Parts<'_>, len: usize, index: usize) -> Self {
        Self(f32::lookup(row, len, index))
    }
    #[inline(always)]
    fn node_pairs(nodes: NodeCodes<'_>, index: Self) -> [[Self; 3]; 2] {
        let [[a, b, c], [d, e, f]] = f32::node_pairs(nodes, index.0);
        [[Self(a), Self(b), Self(c)], [Self(d), Self(e), Self(f)]]
    }
    #[inline(always)]
    fn first(self) -> f32 {
        self.0
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        self.0
    }
    #[inline(always)]
    fn iota() -> Self {
        Self(0.0)
    }
}
