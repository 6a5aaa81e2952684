//! AVX2 and FMA: eight lanes in one `__m256`.
//!
//! Every method is inlined into a function that enables `avx2,fma`, which only runs once [`super::detect`]
//! has seen both on this processor: that makes each `unsafe` block here sound.
#![allow(unsafe_code)]

use super::lane_pair::LanePair;
use super::lanes::{Lanes, NodeCodes, Numbers, PARTS, Parts, WIDEST, one_vector, part_of};
use core::arch::x86_64::*;
use core::ops::{Add, Div, Mul, Sub};

/// Eight f32 in one register.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(pub(super) __m256);

macro_rules! operators {
    ($($name:ident $method:ident $intrinsic:ident)*) => { $(
        impl $name for Avx2 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: the processor has AVX, see the head of this file.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )* };
}
operators!(Add add _mm256_add_ps Sub sub _mm256_sub_ps Mul mul _mm256_mul_ps Div div _mm256_div_ps);

/// The three channels of nodes, as [`Lanes::node_pairs`] says.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
fn channels(nodes: NodeCodes<'_>, pair: __m256i) -> [Avx2; 3] {
    // SAFETY: the processor has AVX2, see the head of this file.
    unsafe {
        let mut channels = [Avx2(_mm256_setzero_ps()); 3];
        for i in 0..3 {
            let channel = _mm256_and_si256(pair, _mm256_set1_epi32(nodes.mask(i) as i32));
            channels[i] = Avx2(_mm256_cvtepi32_ps(channel));
        }
        channels
    }
}

/// The lower halves of eight numbers of 64 bits.
#[inline(always)]
fn low_halves(low: __m256i, high: __m256i) -> __m256i {
    // SAFETY: the processor has AVX2, see the head of this file.
    unsafe {
        // In each half of a register two of `low`, then two of `high`: to be put in order.
        let (low, high) = (_mm256_castsi256_ps(low), _mm256_castsi256_ps(high));
        let halves = _mm256_castps_pd(_mm256_shuffle_ps::<0b10_00_10_00>(low, high));
        _mm256_castpd_si256(_mm256_permute4x64_pd::<0b11_01_10_00>(halves))
    }
}

impl Lanes for Avx2 {
    const COUNT: usize = 8;
    const FUSED: bool = true;
    type Batch = LanePair<LanePair<Self>>;
    one_vector!();
    type Lobes = LanePair<Self>;
    type Mask = __m256;
    type Index = __m256i;
    type One = super::fused::Fused;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: the processor has AVX, see the head of this file.
        Self(unsafe { _mm256_set1_ps(value) })
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let array: &[f32; 8] = from.first_chunk().expect("a slice of at least 8");
        // SAFETY: 8 f32 are readable; the load has no alignment; AVX as above.
        Self(unsafe { _mm256_loadu_ps(array.as_ptr()) })
    }
    #[inline(always)]
    fn load_bytes(from: &[u8]) -> Self {
        let array: &[u8; 32] = from.first_chunk().expect("at least 32 bytes");
        // SAFETY: 32 bytes are readable; the load has no alignment; AVX as above.
        Self(unsafe { _mm256_loadu_ps(array.as_ptr().cast()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        let array: &mut [f32; 8] = to.first_chunk_mut().expect("a slice of at least 8");
        // SAFETY: 8 f32 are writable; the store has no alignment; AVX as above.
        unsafe { _mm256_storeu_ps(array.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        // SAFETY: the processor has FMA, see the head of this file.
        Self(unsafe { _mm256_fmadd_ps(self.0, a.0, b.0) })
    }
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        // SAFETY: the processor has FMA, see the head of this file.
        Self(unsafe { _mm256_fnmadd_ps(self.0, a.0, b.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: the processor has AVX, see the head of this file.
        Self(unsafe { _mm256_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: the processor has AVX, see the head of this file.
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: the processor has AVX, see the head of this file.
        Self(unsafe { _mm256_sqrt_ps(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: the processor has AVX, see the head of this file.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn copy_sign(self, sign: Self) -> Self {
        // SAFETY: the processor has AVX, see the head of this file.
        Self(unsafe {
            let bit = _mm256_set1_ps(-0.0);
            _mm256_or_ps(_mm256_andnot_ps(bit, self.0), _mm256_and_ps(bit, sign.0))
        })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> __m256 {
        // SAFETY: the processor has AVX, see the head of this file.
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn both(a: __m256, b: __m256) -> __m256 {
        // SAFETY: the processor has AVX, see the head of this file.
        unsafe { _mm256_and_ps(a, b) }
    }
    #[inline(always)]
    fn ge(self, other: Self) -> __m256 {
        // SAFETY: the processor has AVX, see the head of this file.
        unsafe { _mm256_cmp_ps::<_CMP_GE_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __m256, yes: Self, no: Self) -> Self {
        // SAFETY: the processor has AVX, see the head of this file.
        Self(unsafe { _mm256_blendv_ps(no.0, yes.0, mask) })
    }
    #[inline(always)]
    fn either(mask: __m256, numbers: &[f32; 2]) -> Self {
        // In each half of the register both numbers, twice; a mask that is set chooses the last of the four. One load and an operation,
        // where a choice between two loads would be an operation that is two or three within an Intel processor.
        // SAFETY: the processor has AVX, see the head of this file.
        Self(unsafe {
            let both = _mm256_castpd_ps(_mm256_set1_pd(bytemuck::cast(*numbers)));
            _mm256_permutevar_ps(both, _mm256_castps_si256(mask))
        })
    }
    #[inline(always)]
    fn keep(self, mask: __m256) -> Self {
        // SAFETY: the processor has AVX2, see the head of this file.
        Self(unsafe { _mm256_and_ps(mask, self.0) })
    }
    #[inline(always)]
    fn add_exponent(self, n: Self) -> Self {
        // SAFETY: the processor has AVX2, see the head of this file.
        Self(unsafe {
            let shifted = _mm256_slli_epi32::<23>(_mm256_castps_si256(n.0));
            _mm256_castsi256_ps(_mm256_add_epi32(_mm256_castps_si256(self.0), shifted))
        })
    }
    #[inline(always)]
    fn quarter_turns(n: Self, sin: Self, cos: Self) -> (Self, Self) {
        // SAFETY: the processor has AVX2, see the head of this file.
        unsafe {
            // Sign bits: odd quarters swap; the sine is negative in 2 and 3, the cosine in 1 and 2.
            let bits = _mm256_castps_si256(n.0);
            let swap = _mm256_castsi256_ps(_mm256_slli_epi32::<31>(bits));
            let sine_sign = _mm256_castsi256_ps(_mm256_slli_epi32::<31>(_mm256_srli_epi32::<1>(bits)));
            let cosine_sign = _mm256_xor_ps(sine_sign, swap);
            let (s, c) = (_mm256_blendv_ps(sin.0, cos.0, swap), _mm256_blendv_ps(cos.0, sin.0, swap));
            (Self(_mm256_xor_ps(s, sine_sign)), Self(_mm256_xor_ps(c, cosine_sign)))
        }
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        // SAFETY: the processor has AVX2, see the head of this file.
        unsafe {
            let bits = _mm256_castps_si256(self.0);
            let e = _mm256_sub_epi32(bits, _mm256_set1_epi32(0x3f35_04f3));
            let e = _mm256_and_si256(e, _mm256_set1_epi32(-0x80_0000));
            (Self(_mm256_castsi256_ps(_mm256_sub_epi32(bits, e))), Self(_mm256_cvtepi32_ps(e)))
        }
    }
    #[inline(always)]
    fn search(self, row: &Parts<'_>, len: usize) -> __m256i {
        // SAFETY: the processor has AVX2, see the head of this file.
        unsafe {
            let mut count = _mm256_setzero_si256();
            let mut p = 0;
            while p < PARTS && WIDEST * p < len {
                for &t in part_of(row, p, len) {
                    // A set mask is -1.
                    let mask = _mm256_cmp_ps::<_CMP_GE_OQ>(self.0, _mm256_set1_ps(t));
                    count = _mm256_sub_epi32(count, _mm256_castps_si256(mask));
                }
                p += 1;
            }
            count
        }
    }
    #[inline(always)]
    fn bits(mask: __m256) -> u64 {
        // SAFETY: the processor has AVX, see the head of this file.
        u64::from(unsafe { _mm256_movemask_ps(mask) } as u8)
    }
    #[inline(always)]
    fn index_below(index: __m256i, limit: usize) -> __m256 {
        // SAFETY: the processor has AVX2, see the head of this file.
        unsafe { _mm256_castsi256_ps(_mm256_cmpgt_epi32(_mm256_set1_epi32(limit as i32), index)) }
    }
    #[inline(always)]
    fn lookup(row: &Parts<'_>, len: usize, index: __m256i) -> Self {
        // SAFETY: the processor has AVX2, see the head of this file.
        unsafe {
            // The permutation uses the low three bits of the index; the half of a part that they belong to is
            // blended in.
            let mut value = _mm256_permutevar8x32_ps(Self::load(row[0]).0, index);
            let mut at = 8;
            while at < len.min(PARTS * WIDEST) {
                let inside = _mm256_cmpgt_epi32(index, _mm256_set1_epi32(at as i32 - 1));
                let half = Self::load(&row[at / WIDEST][at % WIDEST / 8 * 8..]).0;
                let candidate = _mm256_permutevar8x32_ps(half, index);
                value = _mm256_blendv_ps(value, candidate, _mm256_castsi256_ps(inside));
                at += 8;
            }
            Self(value)
        }
    }
    #[inline(always)]
    fn node_pairs(nodes: NodeCodes<'_>, index: Self) -> [[Self; 3]; 2] {
        assert!(nodes.bytes.len() >= 8, "a table of at least two nodes");
        // SAFETY: the processor has AVX2, see the head of this file. An offset is at most `last`, whatever it
        // was made of: the cast makes a large number of a NaN and of a negative number. Eight bytes from there
        // on are within the slice, which has eight and more; a gather has no alignment.
        unsafe {
            let offset = (index * Self::splat(nodes.stride() as f32)).0;
            let at = _mm256_min_epu32(_mm256_cvttps_epi32(offset), _mm256_set1_epi32(nodes.last() as i32));
            let base = nodes.bytes.as_ptr().cast();
            let low = _mm256_i32gather_epi64::<1>(base, _mm256_castsi256_si128(at));
            let high = _mm256_i32gather_epi64::<1>(base, _mm256_extracti128_si256::<1>(at));
            let to_second = _mm_cvtsi32_si128(8 * nodes.stride() as i32);
            let (low_second, high_second) =
                (_mm256_srl_epi64(low, to_second), _mm256_srl_epi64(high, to_second));
            [channels(nodes, low_halves(low, high)), channels(nodes, low_halves(low_second, high_second))]
        }
    }
    #[inline(always)]
    fn first(self) -> f32 {
        // SAFETY: the processor has AVX, see the head of this file.
        unsafe { _mm256_cvtss_f32(self.0) }
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        // SAFETY: the processor has AVX, see the head of this file.
        unsafe {
            let four = _mm_add_ps(_mm256_castps256_ps128(self.0), _mm256_extractf128_ps::<1>(self.0));
            let two = _mm_add_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_add_ss(two, _mm_movehdup_ps(two)))
        }
    }
    #[inline(always)]
    fn sums_of_rows(rows: &[Numbers; WIDEST]) -> Numbers {
        let mut sums = [0.0; WIDEST];
        for half in 0..2 {
            let mut row = [Self::splat(0.0); 8];
            for i in 0..8 {
                let numbers = &rows[8 * half + i];
                row[i] = Self::load(numbers) + Self::load(&numbers[8..]);
            }
            // Neighbours are added, of two rows at a time, and at last the halves.
            // SAFETY: the processor has AVX, see the head of this file.
            let sum = unsafe {
                let [a, b] = [_mm256_hadd_ps(row[0].0, row[1].0), _mm256_hadd_ps(row[2].0, row[3].0)];
                let [c, d] = [_mm256_hadd_ps(row[4].0, row[5].0), _mm256_hadd_ps(row[6].0, row[7].0)];
                let (low, high) = (_mm256_hadd_ps(a, b), _mm256_hadd_ps(c, d));
                let crossed = _mm256_permute2f128_ps::<0x21>(low, high);
                _mm256_add_ps(_mm256_blend_ps::<0xf0>(low, high), crossed)
            };
            Self(sum).store(&mut sums[8 * half..]);
        }
        sums
    }
    #[inline(always)]
    fn running_sum(self) -> Self {
        // SAFETY: the processor has AVX2, see the head of this file.
        unsafe {
            // Within each half, then the last of the lower half to all of the upper.
            let one = _mm256_castsi256_ps(_mm256_slli_si256::<4>(_mm256_castps_si256(self.0)));
            let two = _mm256_add_ps(self.0, one);
            let shifted = _mm256_castsi256_ps(_mm256_slli_si256::<8>(_mm256_castps_si256(two)));
            let four = _mm256_add_ps(two, shifted);
            let lower = _mm256_permute_ps::<0xff>(_mm256_permute2f128_ps::<0x08>(four, four));
            Self(_mm256_add_ps(four, lower))
        }
    }
    #[inline(always)]
    fn last(self) -> Self {
        // SAFETY: the processor has AVX, see the head of this file.
        Self(unsafe { _mm256_permute_ps::<0xff>(_mm256_permute2f128_ps::<0x11>(self.0, self.0)) })
    }
    #[inline(always)]
    fn three_sums([a, b, c]: [Self; 3]) -> [f32; 3] {
        // Neighbours are added, twice, and at last the halves.
        // SAFETY: the processor has AVX, see the head of this file.
        unsafe {
            let four = _mm256_hadd_ps(_mm256_hadd_ps(a.0, b.0), _mm256_hadd_ps(c.0, c.0));
            let sums = _mm_add_ps(_mm256_castps256_ps128(four), _mm256_extractf128_ps::<1>(four));
            let (second, third) = (_mm_movehdup_ps(sums), _mm_movehl_ps(sums, sums));
            [_mm_cvtss_f32(sums), _mm_cvtss_f32(second), _mm_cvtss_f32(third)]
        }
    }
    #[inline(always)]
    fn iota() -> Self {
        // SAFETY: the processor has AVX, see the head of this file.
        Self(unsafe { _mm256_setr_ps(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0) })
    }
}

super::routine::entries!(Avx2, #[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2")]);
