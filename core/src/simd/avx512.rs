//! AVX-512 (F, VL, DQ, BW): sixteen lanes in one `__m512`.
//!
//! Every method is inlined into a function that enables `avx512f,avx512vl,avx512dq,avx512bw,fma`, which only
//! runs once [`super::detect`] has seen them all on this processor: that makes each `unsafe` block here sound.
#![allow(unsafe_code)]

use super::avx2;
use super::lane_pair::LanePair;
use super::lanes::{Lanes, NodeCodes, Numbers, PARTS, Parts, WIDEST, one_vector, part_of, scale};
use super::routine::{Draw, One};
use core::arch::x86_64::*;
use core::ops::{Add, Div, Mul, Sub};

/// Sixteen f32 in one register.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(__m512);

macro_rules! operators {
    ($($name:ident $method:ident $intrinsic:ident)*) => { $(
        impl $name for Avx512 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: the processor has AVX-512, see the head of this file.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )* };
}
operators!(Add add _mm512_add_ps Sub sub _mm512_sub_ps Mul mul _mm512_mul_ps Div div _mm512_div_ps);

/// The three channels of nodes, as [`Lanes::node_pairs`] says.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
fn channels(nodes: NodeCodes<'_>, pair: __m512i) -> [Avx512; 3] {
    // SAFETY: the processor has AVX-512, see the head of this file.
    unsafe {
        let mut channels = [Avx512(_mm512_setzero_ps()); 3];
        for i in 0..3 {
            let channel = _mm512_and_si512(pair, _mm512_set1_epi32(nodes.mask(i) as i32));
            channels[i] = Avx512(_mm512_cvtepi32_ps(channel));
        }
        channels
    }
}

/// The even quarters of two vectors plus the odd ones.
#[inline(always)]
fn evens_and_odds(a: __m512, b: __m512) -> __m512 {
    // SAFETY: the processor has AVX-512, see the head of this file.
    unsafe { _mm512_add_ps(_mm512_shuffle_f32x4::<0x88>(a, b), _mm512_shuffle_f32x4::<0xdd>(a, b)) }
}

impl Avx512 {
    /// Both halves, added.
    #[inline(always)]
    fn folded(self) -> avx2::Avx2 {
        // SAFETY: the processor has AVX-512, see the head of this file.
        avx2::Avx2(unsafe {
            _mm256_add_ps(_mm512_castps512_ps256(self.0), _mm512_extractf32x8_ps::<1>(self.0))
        })
    }
}

impl Lanes for Avx512 {
    const COUNT: usize = 16;
    const FUSED: bool = true;
    type Batch = LanePair<Self>;
    one_vector!();
    type Lobes = Self;
    type Mask = __mmask16;
    type Index = __m512i;
    type One = super::fused::Fused;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_set1_ps(value) })
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let from: &[f32; 16] = from.first_chunk().expect("a vector of numbers");
        // SAFETY: 16 f32 are readable; the load has no alignment; the processor as above.
        Self(unsafe { _mm512_loadu_ps(from.as_ptr()) })
    }
    #[inline(always)]
    fn load_bytes(from: &[u8]) -> Self {
        let array: &[u8; 64] = from.first_chunk().expect("at least 64 bytes");
        // SAFETY: 64 bytes are readable; the load has no alignment; AVX-512 as above.
        Self(unsafe { _mm512_loadu_ps(array.as_ptr().cast()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        let array: &mut [f32; 16] = to.first_chunk_mut().expect("a slice of at least 16");
        // SAFETY: 16 f32 are writable; the store has no alignment; AVX-512 as above.
        unsafe { _mm512_storeu_ps(array.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_fmadd_ps(self.0, a.0, b.0) })
    }
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_fnmadd_ps(self.0, a.0, b.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_sqrt_ps(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_abs_ps(self.0) })
    }
    #[inline(always)]
    fn copy_sign(self, sign: Self) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe {
            let bit = _mm512_set1_ps(-0.0);
            _mm512_or_ps(_mm512_andnot_ps(bit, self.0), _mm512_and_ps(bit, sign.0))
        })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> __mmask16 {
        // SAFETY: the processor has AVX-512, see the head of this file.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn both(a: __mmask16, b: __mmask16) -> __mmask16 {
        a & b
    }
    #[inline(always)]
    fn ge(self, other: Self) -> __mmask16 {
        // SAFETY: the processor has AVX-512, see the head of this file.
        unsafe { _mm512_cmp_ps_mask::<_CMP_GE_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __mmask16, yes: Self, no: Self) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_mask_blend_ps(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn keep(self, mask: __mmask16) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_maskz_mov_ps(mask, self.0) })
    }
    #[inline(always)]
    fn add_exponent(self, n: Self) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe {
            let shifted = _mm512_slli_epi32::<23>(_mm512_castps_si512(n.0));
            _mm512_castsi512_ps(_mm512_add_epi32(_mm512_castps_si512(self.0), shifted))
        })
    }
    /// Minimax on [0, 1], 1 at 0; relative error 1.4e-7 with all roundings.
    const EXP2: [f32; 5] = [0.001_867_13, 0.009_017_031, 0.055_799_913, 0.240_164_47, 0.693_151_3];
    #[inline(always)]
    fn split_whole(self) -> (Self, Self) {
        // SAFETY: the processor has AVX-512, see the head of this file.
        let above = unsafe { _mm512_reduce_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0) };
        (Self(above), self)
    }
    #[inline(always)]
    fn times_exp2(self, whole: Self, least: f32) -> Self {
        let is_above = whole.ge(Self::splat(least));
        // The instruction takes the whole number below by itself.
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_maskz_scalef_ps(is_above, self.0, whole.0) })
    }
    #[inline(always)]
    fn quarter_turns(n: Self, sin: Self, cos: Self) -> (Self, Self) {
        // SAFETY: the processor has AVX-512, see the head of this file.
        unsafe {
            // Sign bits: odd quarters swap; the sine is negative in 2 and 3, the cosine in 1 and 2.
            let bits = _mm512_castps_si512(n.0);
            let swap = _mm512_slli_epi32::<31>(bits);
            let sine_sign = _mm512_slli_epi32::<31>(_mm512_srli_epi32::<1>(bits));
            let cosine_sign = _mm512_castsi512_ps(_mm512_xor_si512(sine_sign, swap));
            let odd = _mm512_movepi32_mask(swap);
            let (s, c) = (_mm512_mask_blend_ps(odd, sin.0, cos.0), _mm512_mask_blend_ps(odd, cos.0, sin.0));
            (Self(_mm512_xor_ps(s, _mm512_castsi512_ps(sine_sign))), Self(_mm512_xor_ps(c, cosine_sign)))
        }
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        // SAFETY: the processor has AVX-512, see the head of this file.
        unsafe {
            let bits = _mm512_castps_si512(self.0);
            let e = _mm512_sub_epi32(bits, _mm512_set1_epi32(0x3f35_04f3));
            let e = _mm512_and_si512(e, _mm512_set1_epi32(-0x80_0000));
            (Self(_mm512_castsi512_ps(_mm512_sub_epi32(bits, e))), Self(_mm512_cvtepi32_ps(e)))
        }
    }
    #[inline(always)]
    fn search(self, row: &Parts<'_>, len: usize) -> __m512i {
        // SAFETY: the processor has AVX-512, see the head of this file.
        unsafe {
            let one = _mm512_set1_epi32(1);
            let mut count = _mm512_setzero_si512();
            let mut p = 0;
            while p < PARTS && WIDEST * p < len {
                for &t in part_of(row, p, len) {
                    let mask = _mm512_cmp_ps_mask::<_CMP_GE_OQ>(self.0, _mm512_set1_ps(t));
                    count = _mm512_mask_add_epi32(count, mask, count, one);
                }
                p += 1;
            }
            count
        }
    }
    #[inline(always)]
    fn bits(mask: __mmask16) -> u64 {
        u64::from(mask)
    }
    #[inline(always)]
    fn index_below(index: __m512i, limit: usize) -> __mmask16 {
        // SAFETY: the processor has AVX-512, see the head of this file.
        unsafe { _mm512_cmplt_epi32_mask(index, _mm512_set1_epi32(limit as i32)) }
    }
    #[inline(always)]
    fn lookup(row: &Parts<'_>, len: usize, index: __m512i) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        unsafe {
            // The permutation uses the low four bits of the index; the part that they belong to is blended in.
            let mut value = _mm512_permutexvar_ps(index, Self::load(row[0]).0);
            let mut p = 1;
            while p < PARTS && WIDEST * p < len {
                let inside = _mm512_cmpge_epi32_mask(index, _mm512_set1_epi32((WIDEST * p) as i32));
                value = _mm512_mask_permutexvar_ps(value, inside, index, Self::load(row[p]).0);
                p += 1;
            }
            Self(value)
        }
    }
    #[inline(always)]
    fn node_pairs(nodes: NodeCodes<'_>, index: Self) -> [[Self; 3]; 2] {
        assert!(nodes.bytes.len() >= 8, "a table of at least two nodes");
        // SAFETY: the processor has AVX-512, see the head of this file. An offset is at most `last`, whatever
        // it was made of: the cast makes a large number of a NaN and of a negative number. Eight bytes from
        // there on are within the slice, which has eight and more; a gather has no alignment.
        unsafe {
            let offset = (index * Self::splat(nodes.stride() as f32)).0;
            let at = _mm512_min_epu32(_mm512_cvttps_epi32(offset), _mm512_set1_epi32(nodes.last() as i32));
            let base = nodes.bytes.as_ptr().cast();
            let low = _mm512_i32gather_epi64::<1>(_mm512_castsi512_si256(at), base);
            let high = _mm512_i32gather_epi64::<1>(_mm512_extracti64x4_epi64::<1>(at), base);
            let evens = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
            let to_second = _mm_cvtsi32_si128(8 * nodes.stride() as i32);
            let (low_second, high_second) =
                (_mm512_srl_epi64(low, to_second), _mm512_srl_epi64(high, to_second));
            [
                channels(nodes, _mm512_permutex2var_epi32(low, evens, high)),
                channels(nodes, _mm512_permutex2var_epi32(low_second, evens, high_second)),
            ]
        }
    }
    #[inline(always)]
    fn first(self) -> f32 {
        // SAFETY: the processor has AVX-512, see the head of this file.
        unsafe { _mm512_cvtss_f32(self.0) }
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        // SAFETY: the processor has AVX-512, see the head of this file.
        unsafe { _mm512_reduce_add_ps(self.0) }
    }
    #[inline(always)]
    fn first_lanes(count: usize) -> __mmask16 {
        ((1u32 << count.min(16)) - 1) as u16
    }
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
    fn sums_of_rows(rows: &[Numbers; WIDEST]) -> Numbers {
        let mut sums = [0.0; WIDEST];
        let mut fours = [Self::splat(0.0).0; 4];
        // SAFETY: the processor has AVX-512, see the head of this file.
        unsafe {
            // Four rows at a time, within quarters of a vector.
            for i in 0..4 {
                let [a, b] = [Self::load(&rows[4 * i]).0, Self::load(&rows[4 * i + 1]).0];
                let [c, d] = [Self::load(&rows[4 * i + 2]).0, Self::load(&rows[4 * i + 3]).0];
                let ab = _mm512_add_ps(_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
                let cd = _mm512_add_ps(_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
                let (ab, cd) = (_mm512_castps_pd(ab), _mm512_castps_pd(cd));
                let (low, high) = (_mm512_unpacklo_pd(ab, cd), _mm512_unpackhi_pd(ab, cd));
                fours[i] = _mm512_add_ps(_mm512_castpd_ps(low), _mm512_castpd_ps(high));
            }
            // Then even quarters and odd ones, twice.
            let [a, b] = [evens_and_odds(fours[0], fours[1]), evens_and_odds(fours[2], fours[3])];
            Self(evens_and_odds(a, b)).store(&mut sums);
        }
        sums
    }
    #[inline(always)]
    fn running_sum(self) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        unsafe {
            // Within quarters, then the last lane of a quarter to the next, then that of a half to the other.
            let one = _mm512_bslli_epi128::<4>(_mm512_castps_si512(self.0));
            let sum = _mm512_add_ps(self.0, _mm512_castsi512_ps(one));
            let two = _mm512_bslli_epi128::<8>(_mm512_castps_si512(sum));
            let sum = _mm512_add_ps(sum, _mm512_castsi512_ps(two));
            let quarter = _mm512_setr_epi32(0, 0, 0, 0, 3, 3, 3, 3, 0, 0, 0, 0, 11, 11, 11, 11);
            let sum = _mm512_add_ps(sum, _mm512_maskz_permutexvar_ps(0xf0f0, quarter, sum));
            Self(_mm512_add_ps(sum, _mm512_maskz_permutexvar_ps(0xff00, _mm512_set1_epi32(7), sum)))
        }
    }
    #[inline(always)]
    fn last(self) -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_permutexvar_ps(_mm512_set1_epi32(15), self.0) })
    }
    #[inline(always)]
    fn three_sums([a, b, c]: [Self; 3]) -> [f32; 3] {
        avx2::Avx2::three_sums([a.folded(), b.folded(), c.folded()])
    }
    #[inline(always)]
    fn iota() -> Self {
        // SAFETY: the processor has AVX-512, see the head of this file.
        Self(unsafe { _mm512_setr_ps(0., 1., 2., 3., 4., 5., 6., 7., 8., 9., 10., 11., 12., 13., 14., 15.) })
    }
}

super::routine::entries!(
    Avx512,
    #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,fma,avx2,popcnt,bmi1,bmi2")] without draw
);

/// Draws a direction, without vectors of 512 bits, as [`One::IS_WIDE`] says why, and runs a routine for it,
/// which is a call of its own: in one function, both have too few registers.
#[inline(never)]
#[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2")]
pub(super) fn draw<S: Copy, D: Draw<S>, R: One<S>>(
    state: S,
    a: f32,
    b: f32,
    c: f32,
) -> ([f32; 3], R::Output) {
    let (d, inverse) = D::run::<avx2::Avx2>(state, [a, b, c]);
    // SAFETY: `Level::draw_one` comes here for a level that has it.
    let then = unsafe { one::<S, R>(state, d[0], d[1], d[2]) };
    (scale(d, inverse), then)
}
