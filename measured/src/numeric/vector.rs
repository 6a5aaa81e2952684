//! Loops as vector instructions of the machine that runs them.
//!
//! A loop is compiled for AVX-512 and for AVX2 with FMA beside the baseline, and the processor is asked at run time. The compiler makes
//! the vectors. Additions keep their order, and fused operations are fused everywhere (slowly on an x86 without FMA), so every machine
//! gives the same bits. WebAssembly has no fused operation that is the same on every machine: there products are rounded, and every
//! browser gives the same bits, others than those of processors.

use std::f64::consts::LOG2_E;
use wide::{f32x4, f64x2};

/// Lanes in which inner products are summed: the widest registers hold this number.
pub const WIDEST: usize = 8;

/// A loop over numbers.
pub trait Operation {
    /// The result, the same with any vectors.
    type Output;
    /// Runs it, `inline(always)`, as everything has to be that it calls.
    fn run<V: Vectors>(self, vectors: V) -> Self::Output;
}

/// The vectors of a level. There is a value of such a type only where the processor has them.
pub trait Vectors: Copy {
    /// How many numbers a register holds.
    const LANES: usize;
    /// Inner products of some rows with some others, of whole lanes of [`WIDEST`], in lanes that are still to be added up. Numbers beyond
    /// the shortest row do not count. Registers have room for a `SIDE` of 4 where they hold 8 numbers, of 3 where they hold 4, and of 2.
    fn tile<const SIDE: usize>(self, down: [&[f64]; SIDE], across: [&[f64]; SIDE]) -> Tile<f64, SIDE>;
    /// The same of `f32`, of which a register of eight is wide enough for every level.
    fn tile_f32<const SIDE: usize>(self, down: [&[f32]; SIDE], across: [&[f32]; SIDE]) -> Tile<f32, SIDE>;
}

/// Inner products in lanes.
pub type Tile<T, const SIDE: usize> = [[[T; WIDEST]; SIDE]; SIDE];

/// Loops as the compiler makes them for every processor of a kind.
#[derive(Clone, Copy)]
pub struct Baseline(());

impl Vectors for Baseline {
    const LANES: usize = 1;

    #[inline(always)]
    fn tile<const SIDE: usize>(self, down: [&[f64]; SIDE], across: [&[f64]; SIDE]) -> Tile<f64, SIDE> {
        if cfg!(target_family = "wasm") { in_pairs(down, across) } else { by_loops(down, across, fused) }
    }

    #[inline(always)]
    fn tile_f32<const SIDE: usize>(self, down: [&[f32]; SIDE], across: [&[f32]; SIDE]) -> Tile<f32, SIDE> {
        if cfg!(target_family = "wasm") { in_fours(down, across) } else { by_loops(down, across, fused_f32) }
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "vectors are read and written by their addresses")]
mod x86 {
    use super::{Tile, Vectors, WIDEST, whole_lanes};
    use std::arch::x86_64::*;

    // Explicit vectors: left to itself the compiler sums one product after the other with AVX2, and keeps all rows in memory.
    macro_rules! tile {
        ($name:ident, $features:literal, $number:ty, $lanes:literal, $zero:ident, $load:ident, $fused:ident, $store:ident) => {
            #[target_feature(enable = $features)]
            fn $name<const SIDE: usize>(
                down: [&[$number]; SIDE],
                across: [&[$number]; SIDE],
            ) -> Tile<$number, SIDE> {
                let (down, across) = whole_lanes(down, across);
                let mut out = [[[0.0; WIDEST]; SIDE]; SIDE];
                for first in (0..WIDEST).step_by($lanes) {
                    let mut sums = [[$zero(); SIDE]; SIDE];
                    for n in 0..down[0].len() {
                        // By a loop: a closure would not have the instructions of this function, and be called.
                        let mut right = [$zero(); SIDE];
                        for j in 0..SIDE {
                            // SAFETY: the lanes from `first` on are within the eight.
                            right[j] = unsafe { $load(across[j][n][first..].as_ptr()) };
                        }
                        for i in 0..SIDE {
                            // SAFETY: as above.
                            let left = unsafe { $load(down[i][n][first..].as_ptr()) };
                            for j in 0..SIDE {
                                sums[i][j] = $fused(left, right[j], sums[i][j]);
                            }
                        }
                    }
                    for i in 0..SIDE {
                        for j in 0..SIDE {
                            // SAFETY: as above.
                            unsafe { $store(out[i][j][first..].as_mut_ptr(), sums[i][j]) };
                        }
                    }
                }
                out
            }
        };
    }
    tile!(of_4, "avx2,fma", f64, 4, _mm256_setzero_pd, _mm256_loadu_pd, _mm256_fmadd_pd, _mm256_storeu_pd);
    tile!(of_8, "avx512f", f64, 8, _mm512_setzero_pd, _mm512_loadu_pd, _mm512_fmadd_pd, _mm512_storeu_pd);
    tile!(
        of_8_f32,
        "avx2,fma",
        f32,
        8,
        _mm256_setzero_ps,
        _mm256_loadu_ps,
        _mm256_fmadd_ps,
        _mm256_storeu_ps
    );

    macro_rules! level {
        ($name:ident, $features:literal, $lanes:literal, $tile:ident) => {
            #[doc = concat!("Proof of ", $features, ".")]
            #[derive(Clone, Copy)]
            pub struct $name(());

            impl $name {
                /// # Safety
                /// The processor has these instructions.
                pub(super) unsafe fn new() -> Self {
                    Self(())
                }
            }

            impl Vectors for $name {
                const LANES: usize = $lanes;

                #[inline(always)]
                fn tile<const SIDE: usize>(
                    self,
                    down: [&[f64]; SIDE],
                    across: [&[f64]; SIDE],
                ) -> Tile<f64, SIDE> {
                    // SAFETY: there is a value of this type, so the processor has these instructions.
                    unsafe { $tile(down, across) }
                }

                #[inline(always)]
                fn tile_f32<const SIDE: usize>(
                    self,
                    down: [&[f32]; SIDE],
                    across: [&[f32]; SIDE],
                ) -> Tile<f32, SIDE> {
                    // SAFETY: as above; AVX2 and FMA are among them.
                    unsafe { of_8_f32(down, across) }
                }
            }
        };
    }
    level!(Avx2, "AVX2 and FMA", 4, of_4);
    level!(Avx512, "AVX-512, AVX2 and FMA", 8, of_8);
}

/// Runs an operation with the widest vectors of this processor, and of the level that was chosen.
#[allow(unsafe_code, reason = "no safe call reaches instructions that not every processor has")]
pub fn run<O: Operation>(operation: O) -> O::Output {
    #[cfg(target_arch = "x86_64")]
    {
        use srbf_core::Level;
        use std::arch::is_x86_feature_detected as has;

        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma")]
        fn avx512<O: Operation>(operation: O, vectors: x86::Avx512) -> O::Output {
            operation.run(vectors)
        }
        #[target_feature(enable = "avx2,fma")]
        fn avx2<O: Operation>(operation: O, vectors: x86::Avx2) -> O::Output {
            operation.run(vectors)
        }
        // A core that is built without vectors has no levels to choose among.
        let most = if Level::Portable.is_available() { Level::current() } else { Level::Avx512 };
        if most >= Level::Avx2 && has!("avx2") && has!("fma") {
            let has_avx512 = has!("avx512f") && has!("avx512bw") && has!("avx512dq") && has!("avx512vl");
            if most == Level::Avx512 && has_avx512 {
                // SAFETY: the processor has these instructions.
                return unsafe { avx512(operation, x86::Avx512::new()) };
            }
            // SAFETY: as above.
            return unsafe { avx2(operation, x86::Avx2::new()) };
        }
    }
    operation.run(Baseline(()))
}

/// `a b + c`, rounded once; in WebAssembly twice, where to round once would be a function of a hundred instructions.
#[inline(always)]
pub fn fused(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_family = "wasm") { a * b + c } else { a.mul_add(b, c) }
}

/// The same of `f32`.
#[inline(always)]
pub fn fused_f32(a: f32, b: f32, c: f32) -> f32 {
    if cfg!(target_family = "wasm") { a * b + c } else { a.mul_add(b, c) }
}

/// Below this the exponential is 0: it is under the rounding of anything that it is added to.
const SMALLEST: f64 = -60.0;

/// Adding it rounds a number to the nearest whole one, and leaves that in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// High part of ln 2, with so few bits that whole multiples up to 1000 are exact, and the rest.
const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// One over the factorials, highest first.
const TAYLOR: [f64; 13] = [
    1.0 / 479_001_600.0,
    1.0 / 39_916_800.0,
    1.0 / 3_628_800.0,
    1.0 / 362_880.0,
    1.0 / 40_320.0,
    1.0 / 5040.0,
    1.0 / 720.0,
    1.0 / 120.0,
    1.0 / 24.0,
    1.0 / 6.0,
    0.5,
    1.0,
    1.0,
];

/// The exponential of a number that is at most about 1; 0 below -60. Relative error below 4e-16.
#[inline(always)]
pub fn exp(t: f64) -> f64 {
    let inside = if t > SMALLEST { t } else { SMALLEST };
    let shifted = fused(inside, LOG2_E, ROUND);
    let whole = shifted - ROUND;
    let r = fused(whole, -LN_2_LOW, fused(whole, -LN_2_HIGH, inside));
    let mut p = TAYLOR[0];
    for c in &TAYLOR[1..] {
        p = fused(p, r, *c);
    }
    let scaled = f64::from_bits(p.to_bits().wrapping_add(shifted.to_bits() << 52));
    if t > SMALLEST { scaled } else { 0.0 }
}

/// The same of `f32`.
const SMALLEST_F32: f32 = -30.0;
const ROUND_F32: f32 = 12_582_912.0;
const LN_2_HIGH_F32: f32 = 0.693_145_75;
const LN_2_LOW_F32: f32 = 1.428_606_8e-6;
const TAYLOR_F32: [f32; 8] = [1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0];

/// The exponential of a number that is at most about 1; 0 below -30, so that a product of two of them is no subnormal number. Relative
/// error below 2e-7.
#[inline(always)]
pub fn exp_f32(t: f32) -> f32 {
    let inside = if t > SMALLEST_F32 { t } else { SMALLEST_F32 };
    let shifted = fused_f32(inside, std::f32::consts::LOG2_E, ROUND_F32);
    let whole = shifted - ROUND_F32;
    let r = fused_f32(whole, -LN_2_LOW_F32, fused_f32(whole, -LN_2_HIGH_F32, inside));
    let mut p = TAYLOR_F32[0];
    for c in &TAYLOR_F32[1..] {
        p = fused_f32(p, r, *c);
    }
    let scaled = f32::from_bits(p.to_bits().wrapping_add(shifted.to_bits() << 23));
    if t > SMALLEST_F32 { scaled } else { 0.0 }
}

/// Rows as whole lanes.
type Lanes<'a, T, const SIDE: usize> = [&'a [[T; WIDEST]]; SIDE];

/// Rows as whole lanes, all of them as many as the shortest has, so that no place within them is checked.
#[inline(always)]
fn whole_lanes<'a, T, const SIDE: usize>(
    down: [&'a [T]; SIDE],
    across: [&'a [T]; SIDE],
) -> (Lanes<'a, T, SIDE>, Lanes<'a, T, SIDE>) {
    let count = down.iter().chain(&across).map(|row| row.len() / WIDEST).min().unwrap_or(0);
    // A number that the compiler does not know: unrolled as a whole, the sums of a tile leave the registers.
    let count = std::hint::black_box(count);
    (down.map(|row| &row.as_chunks().0[..count]), across.map(|row| &row.as_chunks().0[..count]))
}

#[inline(always)]
fn by_loops<T: Copy + Default, const SIDE: usize>(
    down: [&[T]; SIDE],
    across: [&[T]; SIDE],
    fused: impl Fn(T, T, T) -> T,
) -> Tile<T, SIDE> {
    let (down, across) = whole_lanes(down, across);
    let mut sums = [[[T::default(); WIDEST]; SIDE]; SIDE];
    for n in 0..down[0].len() {
        for i in 0..SIDE {
            for j in 0..SIDE {
                for lane in 0..WIDEST {
                    sums[i][j][lane] = fused(down[i][n][lane], across[j][n][lane], sums[i][j][lane]);
                }
            }
        }
    }
    sums
}

/// For WebAssembly, whose compiler leaves such a loop in scalars. Half of the lanes at a time fit into the registers of most processors.
#[inline(always)]
fn in_pairs<const SIDE: usize>(down: [&[f64]; SIDE], across: [&[f64]; SIDE]) -> Tile<f64, SIDE> {
    let (down, across) = whole_lanes(down, across);
    let mut out = [[[0.0; WIDEST]; SIDE]; SIDE];
    for half in [0, 4] {
        let pairs = |chunk: &[f64; WIDEST]| {
            [f64x2::from([chunk[half], chunk[half + 1]]), f64x2::from([chunk[half + 2], chunk[half + 3]])]
        };
        let mut sums = [[[f64x2::ZERO; 2]; SIDE]; SIDE];
        for n in 0..down[0].len() {
            let rows = down.map(|row| pairs(&row[n]));
            let columns = across.map(|row| pairs(&row[n]));
            for i in 0..SIDE {
                for j in 0..SIDE {
                    for k in 0..2 {
                        sums[i][j][k] += rows[i][k] * columns[j][k];
                    }
                }
            }
        }
        for i in 0..SIDE {
            for j in 0..SIDE {
                let [[a, b], [c, d]] = sums[i][j].map(f64x2::to_array);
                out[i][j][half..half + 4].copy_from_slice(&[a, b, c, d]);
            }
        }
    }
    out
}

/// The same of `f32`, for which the registers have room at once.
#[inline(always)]
fn in_fours<const SIDE: usize>(down: [&[f32]; SIDE], across: [&[f32]; SIDE]) -> Tile<f32, SIDE> {
    let (down, across) = whole_lanes(down, across);
    let fours =
        |c: &[f32; WIDEST]| [f32x4::from([c[0], c[1], c[2], c[3]]), f32x4::from([c[4], c[5], c[6], c[7]])];
    let mut sums = [[[f32x4::ZERO; 2]; SIDE]; SIDE];
    for n in 0..down[0].len() {
        let rows = down.map(|row| fours(&row[n]));
        let columns = across.map(|row| fours(&row[n]));
        for i in 0..SIDE {
            for j in 0..SIDE {
                for k in 0..2 {
                    sums[i][j][k] += rows[i][k] * columns[j][k];
                }
            }
        }
    }
    sums.map(|row| {
        row.map(|sum| {
            let [[a, b, c, d], [e, f, g, h]] = sum.map(f32x4::to_array);
            [a, b, c, d, e, f, g, h]
        })
    })
}

/// Inner product in eight running sums, which the compiler may turn into lanes; the order is fixed.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a8.remainder().iter().zip(b8.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a8.zip(b8) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7])) + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_inner_products_in_lanes() {
        let row = |seed: usize| (0..24).map(|n| ((seed * 7 + n * 5) % 11) as f64).collect::<Vec<_>>();
        let rows: Vec<Vec<f64>> = (1..7).map(row).collect();
        let rows_f32: Vec<Vec<f32>> =
            rows.iter().map(|row| row.iter().map(|v| *v as f32).collect()).collect();
        let down: [&[f64]; 3] = std::array::from_fn(|i| &rows[i][..]);
        let down_f32: [&[f32]; 3] = std::array::from_fn(|i| &rows_f32[i][..]);
        // Of the last row, a lane that is not whole.
        let across = [&rows[3][..], &rows[4][..], &rows[5][..23]];
        let across_f32 = [&rows_f32[3][..], &rows_f32[4][..], &rows_f32[5][..23]];
        let (found, found_f32) = run(OneTile { down, across, down_f32, across_f32 });
        let sum = |i: usize, j: usize, lane: usize| -> f64 {
            (0..2).map(|n| rows[i][8 * n + lane] * rows[3 + j][8 * n + lane]).sum()
        };
        let all = [found, by_loops(down, across, fused), in_pairs(down, across)];
        let loops = by_loops(down_f32, across_f32, fused_f32);
        let all_f32 = [found_f32, loops, in_fours(down_f32, across_f32)];
        for (i, j, lane) in (0..72).map(|n| (n / 24, n / 8 % 3, n % 8)) {
            let expected = sum(i, j, lane);
            assert_eq!(all.map(|tile| tile[i][j][lane]), [expected; 3]);
            assert_eq!(all_f32.map(|tile| f64::from(tile[i][j][lane])), [expected; 3]);
        }
    }

    struct OneTile<'a> {
        down: [&'a [f64]; 3],
        across: [&'a [f64]; 3],
        down_f32: [&'a [f32]; 3],
        across_f32: [&'a [f32]; 3],
    }

    impl Operation for OneTile<'_> {
        type Output = (Tile<f64, 3>, Tile<f32, 3>);
        #[inline(always)]
        fn run<V: Vectors>(self, vectors: V) -> Self::Output {
            (vectors.tile(self.down, self.across), vectors.tile_f32(self.down_f32, self.across_f32))
        }
    }

    #[test]
    fn the_exponential_agrees_with_libm() {
        for i in 0..200_000 {
            let t = 1.0 - f64::from(i) * 3e-4;
            let (ours, theirs) = (exp(t), libm::exp(t));
            assert!((ours - theirs).abs() <= 4e-16 * theirs, "{t}: {ours} {theirs}");
        }
        for i in 0..100_000 {
            let t = 1.0 - i as f32 * 3e-4;
            let (ours, theirs) = (f64::from(exp_f32(t)), libm::exp(f64::from(t)));
            assert!((ours - theirs).abs() <= 2e-7 * theirs, "{t}: {ours} {theirs}");
        }
        assert_eq!([exp_f32(0.0), exp_f32(-30.1), exp_f32(f32::NEG_INFINITY)], [1.0, 0.0, 0.0]);
        assert!((f64::from(LN_2_HIGH_F32) + f64::from(LN_2_LOW_F32) - std::f64::consts::LN_2).abs() < 1e-12);
        assert_eq!(exp(0.0), 1.0);
        assert_eq!([exp(-60.1), exp(-1e9), exp(f64::NEG_INFINITY)], [0.0; 3]);
        assert!((LN_2_HIGH + LN_2_LOW - std::f64::consts::LN_2).abs() < 1e-17);
    }
}
