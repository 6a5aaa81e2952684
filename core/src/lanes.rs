//! The text of every kernel is generic over [`Lanes`]: one f32 for the scalar path, SIMD vectors for the back ends.
//!
//! Everything here is `#[inline(always)]`: a vector method must be compiled inside the `#[target_feature]` function that
//! uses it, or it becomes a call that passes vectors through memory. Closures and `array::map` cannot be marked so:
//! kernels use neither, but small functions and loops over array indices.
#![allow(clippy::needless_range_loop)]

use core::ops::{Add, Div, Mul, Sub};

/// A vector of f32, or one f32.
///
/// Comparisons with NaN are false. `min` and `max` give any of the two operands if one is NaN.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Number of f32.
    const COUNT: usize;
    /// Whether [`mul_add`](Self::mul_add) rounds once.
    const FUSED: bool;
    /// What batches of directions take at a time: a broadcast of a lobe's number then serves several vectors. The lobes are taken in stages
    /// if those are more than [`TOGETHER`], see `batch.rs`.
    type Batch: Lanes;
    /// How many vectors it is.
    const VECTORS: usize = 1;
    /// Half of the vectors; of one vector, that one.
    type Half: Lanes;
    /// Both halves.
    fn halves(self) -> [Self::Half; 2];
    /// Of both halves.
    fn of_halves(halves: [Self::Half; 2]) -> Self;
    /// Whether lobes are taken two vectors at a time where lanes are lobes: most mixtures need two, and constants are then loaded once.
    const LOBES_PAIRED: bool;
    /// Result of a comparison.
    type Mask: Copy;
    /// One small whole number a lane.
    type Index: Copy;
    /// One lane, with the fused operations if the processor has them: for what is computed once.
    type One: Lanes<Index = usize>;

    /// The same number in every lane.
    fn splat(value: f32) -> Self;
    /// The first `COUNT` numbers of a slice; panics if there are fewer.
    fn load(from: &[f32]) -> Self;
    /// `COUNT` numbers from little-endian bytes of any alignment; panics if there are fewer.
    fn load_bytes(from: &[u8]) -> Self;
    /// To the first `COUNT` places of a slice; panics if there are fewer.
    fn store(self, to: &mut [f32]);
    /// `self a + b`.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// `b - self a`.
    fn neg_mul_add(self, a: Self, b: Self) -> Self;
    /// Smaller of two.
    fn min(self, other: Self) -> Self;
    /// Larger of two.
    fn max(self, other: Self) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Magnitude of `self`, sign of `sign`.
    fn copy_sign(self, sign: Self) -> Self;
    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether both are set.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// `self >= other`.
    fn ge(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is set, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// `self` where the mask is set, else 0.
    fn keep(self, mask: Self::Mask) -> Self;
    /// Adds a whole number to the exponent of `self`: `n` is the float `n + 1.5 2^23`, whose low bits hold it.
    fn add_exponent(self, n: Self) -> Self;
    /// Coefficients of a polynomial that is `2^f` for what [`split_whole`](Self::split_whole) leaves, the highest first, without the
    /// last, which is 1.
    const EXP2: [f32; 5] = [0.001_327_647_1, 0.009_675_541, 0.055_507_133, 0.240_221_2, 0.693_146_97];
    /// What is left of a number when the nearest whole one, or the one below, is taken off; and what
    /// [`times_exp2`](Self::times_exp2) wants to know of that. Anything of a NaN or what is infinite.
    #[inline(always)]
    fn split_whole(self) -> (Self, Self) {
        let whole = self + Self::splat(ROUND);
        (self - (whole - Self::splat(ROUND)), whole)
    }
    /// `self` times 2 to the power of a whole number; exactly 0 where that is less than `least`, to a half, or of a NaN.
    #[inline(always)]
    fn times_exp2(self, whole: Self, least: f32) -> Self {
        self.add_exponent(whole).keep(whole.ge(Self::splat(ROUND + least)))
    }
    /// Sine and cosine of `2 pi self`, `self` in `[0, 1]`; absolute error below 1.2e-7. The turn is reduced exactly.
    #[inline(always)]
    fn sin_cos_turns(self) -> (Self, Self) {
        let quarters = self * Self::splat(4.0);
        let n = quarters + Self::splat(ROUND);
        let q = n - Self::splat(ROUND);
        quadrant((quarters - q) * Self::splat(core::f32::consts::FRAC_PI_2), n)
    }
    /// Sine and cosine after `q` quarter turns, from those before; `n` is the float `q + 1.5 2^23`, whose low bits hold q.
    fn quarter_turns(n: Self, sin: Self, cos: Self) -> (Self, Self);
    /// Splits a positive normal number into a mantissa in [sqrt(1/2), sqrt(2)), and 2^23 times a whole exponent: that is where it stands.
    fn split_exponent(self) -> (Self, Self);
    /// Number of thresholds that are `<= self`.
    fn search(self, thresholds: &[f32]) -> Self::Index;
    /// One bit a lane, the first lane lowest.
    fn bits(mask: Self::Mask) -> u64;
    /// `index < limit`.
    fn index_below(index: Self::Index, limit: usize) -> Self::Mask;
    /// `table[index]`; every index is within the first `len` entries. `table` has a multiple of 16 entries.
    fn lookup(table: &[f32], len: usize, index: Self::Index) -> Self;
    /// Red, green and blue, the latter two times 2^10 and 2^20, of the codes of two nodes that lie one behind the other, from whole numbers
    /// `index` on: `nodes` holds four bytes a node. Whatever `index` is, nothing outside is read.
    #[inline(always)]
    fn node_pairs(nodes: &[u8], index: Self) -> [[Self; 3]; 2] {
        let last = (nodes.len() / 4).saturating_sub(2);
        let (mut at, mut codes) = ([0.0; 16], [[[0.0; 16]; 3]; 2]);
        index.store(&mut at);
        for lane in 0..Self::COUNT {
            // The cast makes 0 of a NaN and of what is negative.
            let from = 4 * (at[lane] as usize).min(last);
            let pair = &nodes[from..from + 8];
            for node in 0..2 {
                let bytes = &pair[4 * node..4 * node + 4];
                let code = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
                for channel in 0..3 {
                    codes[node][channel][lane] = (code & 1023 << (10 * channel)) as f32;
                }
            }
        }
        let mut pairs = [[index; 3]; 2];
        for node in 0..2 {
            for channel in 0..3 {
                pairs[node][channel] = Self::load(&codes[node][channel]);
            }
        }
        pairs
    }
    /// The first lane.
    fn first(self) -> f32;
    /// Sum over the lanes.
    fn sum(self) -> f32;
    /// 0, 1, 2, ...
    fn iota() -> Self;
    /// The first `count` lanes.
    #[inline(always)]
    fn first_lanes(count: usize) -> Self::Mask {
        Self::iota().lt(Self::splat(count as f32))
    }
}

/// How [`Lanes`] that are one vector have halves: both are that one.
macro_rules! one_vector {
    () => {
        type Half = Self;
        #[inline(always)]
        fn halves(self) -> [Self; 2] {
            [self, self]
        }
        #[inline(always)]
        fn of_halves([half, _]: [Self; 2]) -> Self {
            half
        }
    };
}
#[cfg(feature = "simd")]
pub(crate) use one_vector;

/// A long formula of each lane is worked out for so many vectors at a time: registers hold no more.
pub const TOGETHER: usize = 2;

/// Both halves of several numbers.
#[inline(always)]
pub fn halves<L: Lanes, const I: usize>(v: [L; I]) -> [[L::Half; I]; 2] {
    let mut halves = [[L::Half::splat(0.0); I]; 2];
    for i in 0..I {
        [halves[0][i], halves[1][i]] = v[i].halves();
    }
    halves
}

/// Several numbers of both halves.
#[inline(always)]
pub fn of_halves<L: Lanes, const I: usize>([low, high]: [[L::Half; I]; 2]) -> [L; I] {
    let mut v = [L::splat(0.0); I];
    for i in 0..I {
        v[i] = L::of_halves([low[i], high[i]]);
    }
    v
}

/// Three numbers, each in every lane.
#[inline(always)]
pub fn splat3<L: Lanes>(v: [f32; 3]) -> [L; 3] {
    [L::splat(v[0]), L::splat(v[1]), L::splat(v[2])]
}

/// Dot product.
#[inline(always)]
pub fn dot3<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// Every component times a number.
#[inline(always)]
pub fn scale<L: Lanes, const C: usize>(mut a: [L; C], by: L) -> [L; C] {
    for i in 0..C {
        a[i] = a[i] * by;
    }
    a
}

/// `2^t`, exactly 0 below 2^-125. Relative error below 2.5e-7; `t` at most 127.
#[inline(always)]
pub fn exp2<L: Lanes>(t: L) -> L {
    exp2_above::<L, false>(t, -125.0)
}

/// `2^t`, exactly 0 below 2^-100: what a lobe falls to. Relative error below 2.5e-7; `t` at most 127.
///
/// Neither the result nor its product with an amplitude above 2^-25 is a subnormal: one subnormal in a vector makes an Intel
/// processor take 150 cycles for that instruction, and among sixteen directions there is often one whose exponent is near -127.
#[inline(always)]
pub fn falloff<L: Lanes>(t: L) -> L {
    exp2_above::<L, false>(t, -100.0)
}

/// [`falloff`] by a shorter chain of more operations, for one direction, which waits for it; other digits.
#[inline(always)]
pub fn falloff_soon<L: Lanes>(t: L) -> L {
    exp2_above::<L, true>(t, -100.0)
}

/// `2^t`, exactly 0 where `t` is less than `least`, to a half, or a NaN. `least` is -125 or more: no subnormal. `SOON`: the polynomial
/// by pairs of terms (Estrin 1960).
#[inline(always)]
fn exp2_above<L: Lanes, const SOON: bool>(t: L, least: f32) -> L {
    let (f, whole) = t.split_whole();
    // Minimax on [-1/2, 1/2], relative error 2.4e-7 with all roundings, or as the level says.
    if SOON {
        let [a, b, c, d, e] = L::EXP2;
        let ff = f * f;
        let high = ff.mul_add(f.mul_add(L::splat(a), L::splat(b)), f.mul_add(L::splat(c), L::splat(d)));
        return ff.mul_add(high, f.mul_add(L::splat(e), L::splat(1.0))).times_exp2(whole, least);
    }
    // Without fused operations 1 + f c (f^2 + a f + b) (f^2 + d f + e) is as many operations as Horner's form in half the latency; relative
    // error 2.0e-7 with all roundings. One lane keeps the digits that fits have seen.
    if !L::FUSED && L::COUNT > 1 {
        let factor = |a, b| (f + L::splat(a)) * f + L::splat(b);
        let product = factor(7.802_083_5, 21.231_173) * factor(-0.514_329_14, 24.590_559);
        let small = product * (f * L::splat(0.001_327_648));
        return (small + L::splat(1.0)).times_exp2(whole, least);
    }
    let mut p = L::splat(L::EXP2[0]);
    for i in 1..5 {
        p = p.mul_add(f, L::splat(L::EXP2[i]));
    }
    p.mul_add(f, L::splat(1.0)).times_exp2(whole, least)
}

/// `(ln x + rest) factor` of a positive normal number and a small one; relative error of the logarithm below 2e-7 away from 1, absolute
/// 1e-7 times `|x - 1|` near it. And that plus 2.
#[inline(always)]
pub fn ln_plus_times<L: Lanes>(x: L, rest: L, factor: L) -> [L; 2] {
    let (m, e) = x.split_exponent();
    let f = m - L::splat(1.0);
    // ln(1 + f) = f - f^2 / 2 + f^3 p(f); Cephes logf, Moshier 1992.
    // Pairs, fours and eights of terms (Estrin 1960): half the latency of Horner's form, for one multiplication.
    let ff = f * f;
    let ffff = ff * ff;
    let p0 = f.mul_add(L::splat(-2.499_999_4e-1), L::splat(0.333_333_3));
    let p2 = f.mul_add(L::splat(-1.666_805_7e-1), L::splat(2.000_071_5e-1));
    let p4 = f.mul_add(L::splat(-1.242_014_1e-1), L::splat(1.424_932_3e-1));
    let p6 = f.mul_add(L::splat(-1.151_461e-1), L::splat(1.167_699_84e-1));
    let p4 = ffff.mul_add(L::splat(7.037_683_6e-2), ff.mul_add(p6, p4));
    let p = ffff.mul_add(p4, ff.mul_add(p2, p0));
    // All that does not wait for the polynomial is done beside it: two operations are left, also of the sum with 2 where one number is
    // waited for. Without fused operations its digits would be others than those that fits have seen.
    const PLACE: f32 = 1.0 / 8_388_608.0;
    let low = ff.neg_mul_add(L::splat(0.5), e.mul_add(L::splat(-2.121_944_4e-4 * PLACE), rest));
    let (small, large) = (p.mul_add(f * ff, low), e.mul_add(L::splat(0.693_359_4 * PLACE), f) * factor);
    let (product, two) = (small.mul_add(factor, large), L::splat(2.0));
    [product, if L::FUSED && L::COUNT == 1 { small.mul_add(factor, large + two) } else { product + two }]
}

/// 1.5 2^23: added to a small number it leaves the nearest whole number in the low bits.
pub const ROUND: f32 = 12_582_912.0;

/// Sine and cosine of an angle in `[-8, 8]`; absolute error below 1.2e-7.
#[inline(always)]
pub fn sin_cos<L: Lanes>(angle: L) -> (L, L) {
    let n = angle.mul_add(L::splat(core::f32::consts::FRAC_2_PI), L::splat(ROUND));
    let q = n - L::splat(ROUND);
    // pi/2 in three parts, the first with few enough bits that the product with q is exact.
    let r = q.neg_mul_add(L::splat(1.570_312_5), angle);
    let r = q.neg_mul_add(L::splat(4.837_513e-4), r);
    let r = q.neg_mul_add(L::splat(7.549_79e-8), r);
    quadrant(r, n)
}

/// Sine and cosine of `2 pi u`, `u` in `[0, 1]`; absolute error below 1.2e-7.
#[inline(always)]
pub fn sin_cos_turns<L: Lanes>(u: L) -> (L, L) {
    u.sin_cos_turns()
}

/// Sine and cosine of `r + q pi / 2`, `r` in [-pi/4, pi/4], `n = q + ROUND`.
#[inline(always)]
fn quadrant<L: Lanes>(r: L, n: L) -> (L, L) {
    let rr = r * r;
    // Cephes sinf and cosf, Moshier 1992.
    let mut s = L::splat(-1.951_529_6e-4);
    s = s.mul_add(rr, L::splat(8.332_161e-3));
    s = s.mul_add(rr, L::splat(-1.666_665_5e-1));
    s = (s * rr).mul_add(r, r);
    let mut c = L::splat(2.443_315_7e-5);
    c = c.mul_add(rr, L::splat(-1.388_731_6e-3));
    c = c.mul_add(rr, L::splat(4.166_664_6e-2));
    c = (c * rr).mul_add(rr, rr.neg_mul_add(L::splat(0.5), L::splat(1.0)));
    L::quarter_turns(n, s, c)
}

/// Angle of the vector (x, y), both not negative and not both 0, from the x axis; relative error below 3e-7.
#[inline(always)]
pub fn atan2_positive<L: Lanes>(y: L, x: L) -> L {
    let a = y.min(x) / y.max(x);
    let aa = a * a;
    // Minimax of atan(a) / a in a^2 on [0, 1], relative error 1.6e-8.
    let mut p = L::splat(0.002_849_886_4);
    p = p.mul_add(aa, L::splat(-0.016_068_615));
    p = p.mul_add(aa, L::splat(0.042_691_5));
    p = p.mul_add(aa, L::splat(-0.075_042_926));
    p = p.mul_add(aa, L::splat(0.106_409_33));
    p = p.mul_add(aa, L::splat(-0.142_036_44));
    p = p.mul_add(aa, L::splat(0.199_926_2));
    p = p.mul_add(aa, L::splat(-0.333_330_72));
    let angle = (p * aa).mul_add(a, a);
    L::select(x.lt(y), L::splat(core::f32::consts::FRAC_PI_2) - angle, angle)
}

/// `a + b` and its rounding error (Knuth 1969).
#[inline(always)]
pub fn two_sum<L: Lanes>(a: L, b: L) -> (L, L) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// `a b` and its rounding error: one fused operation, or Dekker's 17 (1971), exact while nothing under- or overflows.
#[inline(always)]
pub fn two_product<L: Lanes>(a: L, b: L) -> (L, L) {
    let product = a * b;
    if L::FUSED {
        return (product, a.mul_add(b, L::splat(0.0) - product));
    }
    let halves = |v: L| {
        let t = L::splat(4097.0) * v; // 2^12 + 1: halves of 12 bits
        let high = t - (t - v);
        (high, v - high)
    };
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

/// `a b + c d` as a sum of two.
#[inline(always)]
pub fn sum_of_products<L: Lanes>(a: L, b: L, c: L, d: L) -> (L, L) {
    let (p, p_error) = two_product(a, b);
    let (q, q_error) = two_product(c, d);
    let (sum, error) = two_sum(p, q);
    (sum, error + (p_error + q_error))
}

/// `|v|^2 - 1` of a vector that f32 takes for a unit vector, without losing its digits.
#[inline(always)]
pub fn length_squared_minus_one<L: Lanes>([x, y, z]: [L; 3]) -> L {
    let (xx, x_error) = two_product(x, x);
    let (yy, y_error) = two_product(y, y);
    let (zz, z_error) = two_product(z, z);
    let (sum, xy_error) = two_sum(xx, yy);
    let (sum, error) = two_sum(sum, zz);
    (sum - L::splat(1.0)) + ((x_error + y_error) + (z_error + (xy_error + error)))
}

impl Lanes for f32 {
    const COUNT: usize = 1;
    const FUSED: bool = false;
    type Batch = f32;
    one_vector!();
    const LOBES_PAIRED: bool = false;
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
        crate::float::sqrt(self)
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
        // Bits of sqrt(1/2): what is left above it after whole exponents are taken off is in [sqrt(1/2), sqrt(2)).
        let e = self.to_bits().wrapping_sub(0x3f35_04f3) & 0xff80_0000;
        (f32::from_bits(self.to_bits().wrapping_sub(e)), e as i32 as f32)
    }
    #[inline(always)]
    fn search(self, thresholds: &[f32]) -> usize {
        thresholds.iter().filter(|&&t| t <= self).count()
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
    fn lookup(table: &[f32], _len: usize, index: usize) -> Self {
        table[index]
    }
    #[inline(always)]
    fn node_pairs(nodes: &[u8], index: Self) -> [[Self; 3]; 2] {
        // The cast makes 0 of a NaN and of what is negative.
        let from = 4 * (index as usize).min((nodes.len() / 4).saturating_sub(2));
        let pair: &[u8; 8] = nodes[from..].first_chunk().expect("a table of at least two nodes");
        let pair = u64::from_le_bytes(*pair);
        [pair as u32, (pair >> 32) as u32].map(|node| {
            [
                (node & 1023) as i32 as f32,
                (node & 1023 << 10) as i32 as f32,
                (node & 1023 << 20) as i32 as f32,
            ]
        })
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
    fn iota() -> Self {
        0.0
    }
}
