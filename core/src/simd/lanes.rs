//! The text of every kernel is generic over [`Lanes`]: one f32 for the scalar path, SIMD vectors for the back
//! ends.
//!
//! Everything here is `#[inline(always)]`: a vector method must be compiled inside the `#[target_feature]`
//! function that uses it, or it becomes a call that passes vectors through memory. Closures and `array::map`
//! cannot be marked so: kernels use neither, but small functions and loops over array indices.
#![allow(clippy::needless_range_loop)]

use core::ops::{Add, Div, Mul, Sub};

/// Lanes of the widest vector: numbers of a part of a row, hits of a block.
pub const WIDEST: usize = 16;

/// Lanes of a pair of the widest vectors, which some kernels take as one.
pub const WIDEST_PAIR: usize = 2 * WIDEST;

/// Most parts of a row.
pub const PARTS: usize = 4;

/// A part of a row, or one number for each hit of a block.
pub type Numbers = [f32; WIDEST];

/// A row of numbers in parts, so that what reads it need not know how long it is.
pub type Parts<'a> = [&'a Numbers; PARTS];

/// The numbers of part `p` among the first `len` of a row.
#[inline(always)]
pub fn part_of<'a>(row: &Parts<'a>, p: usize, len: usize) -> &'a [f32] {
    &row[p][..len.saturating_sub(WIDEST * p).min(WIDEST)]
}

/// The codes of nodes of three channels, in bytes of any alignment.
#[derive(Clone, Copy)]
pub struct NodeCodes<'a> {
    /// All that may be read, of which two nodes are eight bytes: at least as many.
    pub bytes: &'a [u8],
    /// Bits of a channel, 8 or 10; a node takes three bytes, or four.
    pub bits: u32,
}

impl NodeCodes<'_> {
    /// Bytes from one node to the next.
    #[inline(always)]
    pub fn stride(&self) -> usize {
        if self.bits == 8 { 3 } else { 4 }
    }

    /// The bits of a channel.
    #[inline(always)]
    pub fn mask(&self, channel: usize) -> u32 {
        ((1 << self.bits) - 1) << (self.bits * channel as u32)
    }

    /// Byte offset of the last two nodes.
    #[inline(always)]
    pub fn last(&self) -> usize {
        self.bytes.len().saturating_sub(8)
    }

    /// Two nodes one behind the other; the upper bits of the first may be of the second.
    #[inline(always)]
    pub fn pair(&self, index: f32) -> [u32; 2] {
        // The cast makes 0 of a NaN and of a negative number.
        let from = (index as u32 as usize * self.stride()).min(self.last());
        let pair = u64::from_le_bytes(
            self.bytes.get(from..).and_then(<[u8]>::first_chunk).copied().unwrap_or([0; 8]),
        );
        [pair as u32, (pair >> (8 * self.stride())) as u32]
    }
}

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
    /// What batches of directions take at a time: a broadcast of a lobe's number then serves several vectors.
    /// The lobes are taken in stages if those are more than [`TOGETHER`], see `in_stages` in
    /// `kernel/lobe_sums.rs`.
    type Batch: Lanes;
    /// How many vectors it is.
    const VECTORS: usize = 1;
    /// Half of the vectors; of one vector, that one.
    type Half: Lanes;
    /// Both halves.
    fn halves(self) -> [Self::Half; 2];
    /// Of both halves.
    fn of_halves(halves: [Self::Half; 2]) -> Self;
    /// What lobes are taken by where lanes are lobes: where most mixtures need two vectors, two, so that
    /// constants are loaded once.
    type Lobes: Lanes;
    /// Result of a comparison.
    type Mask: Copy;
    /// One small whole number a lane.
    type Index: Copy;
    /// One lane, with the fused operations if the processor has them: for numbers that are computed once.
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
    /// The second of two numbers where the mask is set, else the first.
    #[inline(always)]
    fn either(mask: Self::Mask, numbers: &[f32; 2]) -> Self {
        Self::select(mask, Self::splat(numbers[1]), Self::splat(numbers[0]))
    }
    /// `self` where the mask is set, else 0.
    fn keep(self, mask: Self::Mask) -> Self;
    /// Adds a whole number to the exponent of `self`: `n` is the float `n + 1.5 2^23`, whose low bits hold
    /// it.
    fn add_exponent(self, n: Self) -> Self;
    /// Coefficients of a polynomial that is `2^f` for what [`split_whole`](Self::split_whole) leaves, the
    /// highest first, without the last, which is 1.
    const EXP2: [f32; 5] = [0.001_327_647_1, 0.009_675_541, 0.055_507_133, 0.240_221_2, 0.693_146_97];
    /// The rest of a number when the nearest whole one, or the one below, is taken off; and the number that
    /// [`times_exp2`](Self::times_exp2) wants to know of that. Anything of a NaN or an infinite number.
    #[inline(always)]
    fn split_whole(self) -> (Self, Self) {
        let whole = self + Self::splat(ROUND);
        (self - (whole - Self::splat(ROUND)), whole)
    }
    /// `self` times 2 to the power of a whole number; exactly 0 where that is less than `least`, to a half,
    /// or of a NaN.
    #[inline(always)]
    fn times_exp2(self, whole: Self, least: f32) -> Self {
        self.add_exponent(whole).keep(whole.ge(Self::splat(ROUND + least)))
    }
    /// Sine and cosine of `2 pi self`, `self` in `[0, 1]`; absolute error below 1.2e-7. The turn is reduced
    /// exactly.
    #[inline(always)]
    fn sin_cos_turns(self) -> (Self, Self) {
        let quarters = self * Self::splat(4.0);
        let n = quarters + Self::splat(ROUND);
        let q = n - Self::splat(ROUND);
        quadrant((quarters - q) * Self::splat(core::f32::consts::FRAC_PI_2), n)
    }
    /// Sine and cosine after `q` quarter turns, from those before; `n` is the float `q + 1.5 2^23`, whose low
    /// bits hold q.
    fn quarter_turns(n: Self, sin: Self, cos: Self) -> (Self, Self);
    /// Splits a positive normal number into a mantissa in [sqrt(1/2), sqrt(2)), and 2^23 times a whole
    /// exponent: that is where it stands.
    fn split_exponent(self) -> (Self, Self);
    /// How many of the first `len` numbers of a row are `<= self`.
    fn search(self, row: &Parts<'_>, len: usize) -> Self::Index;
    /// One bit a lane, the first lane lowest.
    fn bits(mask: Self::Mask) -> u64;
    /// `index < limit`.
    fn index_below(index: Self::Index, limit: usize) -> Self::Mask;
    /// `row[index]`; every index is within the first `len` numbers.
    fn lookup(row: &Parts<'_>, len: usize, index: Self::Index) -> Self;
    /// Red, green and blue of the codes of two nodes that lie one behind the other, from whole numbers `index` on. Green is times
    /// 2 to the power of the bits, blue of twice as many. Whatever `index` is, nothing outside is read.
    #[inline(always)]
    fn node_pairs(nodes: NodeCodes<'_>, index: Self) -> [[Self; 3]; 2] {
        let (mut at, mut codes) = ([0.0; WIDEST], [[[0.0; WIDEST]; 3]; 2]);
        index.store(&mut at);
        for lane in 0..Self::COUNT {
            let pair = nodes.pair(at[lane]);
            for node in 0..2 {
                for channel in 0..3 {
                    codes[node][channel][lane] = (pair[node] & nodes.mask(channel)) as i32 as f32;
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
    /// The sum of each of as many rows as a part has numbers.
    #[inline(always)]
    fn sums_of_rows(rows: &[Numbers; WIDEST]) -> Numbers {
        let mut sums = [0.0; WIDEST];
        for i in 0..WIDEST {
            let mut sum = Self::load(&rows[i]);
            let mut j = Self::COUNT;
            while j + Self::COUNT <= WIDEST {
                sum = sum + Self::load(&rows[i][j..]);
                j += Self::COUNT;
            }
            sums[i] = sum.sum();
        }
        sums
    }
    /// Each lane plus all before it; which are added first is the level's.
    #[inline(always)]
    fn running_sum(self) -> Self {
        let mut numbers = [0.0; 32];
        self.store(&mut numbers);
        for lane in 1..Self::COUNT {
            numbers[lane] += numbers[lane - 1];
        }
        Self::load(&numbers)
    }
    /// The last lane, in every lane.
    #[cfg_attr(not(feature = "simd"), allow(dead_code))]
    #[inline(always)]
    fn last(self) -> Self {
        let mut numbers = [0.0; 32];
        self.store(&mut numbers);
        Self::splat(numbers[Self::COUNT - 1])
    }
    /// The sum over the lanes of each of three vectors.
    #[cfg_attr(not(feature = "simd"), allow(dead_code))]
    #[inline(always)]
    fn three_sums(vectors: [Self; 3]) -> [f32; 3] {
        [vectors[0].sum(), vectors[1].sum(), vectors[2].sum()]
    }
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

pub(crate) use one_vector;

/// 1.5 2^23: added to a small number it leaves the nearest whole number in the low bits.
pub const ROUND: f32 = 12_582_912.0;

/// Sine and cosine of `r + q pi / 2`, `r` in [-pi/4, pi/4], `n = q + ROUND`.
#[inline(always)]
pub fn quadrant<L: Lanes>(r: L, n: L) -> (L, L) {
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

/// A long formula of each lane is worked out for this number of vectors at a time: registers hold no more.
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
