//! Inputs: levels, a generator of random numbers, lobes and mixtures, and the numbers where things go wrong.

use glam::Vec3;
use rand_core::TryRng;
use srbf_core::{Domain, Level, Lobe, Mixture};
use std::convert::Infallible;

/// The levels that a test runs at, slowest first: those of this machine, up to the one that the variable `SRBF_LEVEL` names. With
/// `SRBF_LEVEL_ALONE` that one alone, where the others have been tried.
///
/// # Panics
/// If the library has others than the standard library finds: no test passes at fewer.
pub fn levels() -> Vec<Level> {
    let levels: Vec<Level> = Level::ALL.into_iter().filter(|level| level.is_available()).collect();
    let cap = std::env::var("SRBF_LEVEL").map_or(Level::Avx512, |name| Level::from_name(&name).expect(&name));
    let wanted: Vec<Level> = Level::ALL.into_iter().filter(|&level| level <= cap && is_here(level)).collect();
    assert_eq!(levels, wanted, "left: levels of the library; right: those of this machine up to SRBF_LEVEL");
    let tried = if std::env::var_os("SRBF_LEVEL_ALONE").is_some() { levels.len() - 1 } else { 0 };
    levels[tried..].to_vec()
}

#[cfg(target_arch = "x86_64")]
fn is_here(level: Level) -> bool {
    use std::arch::is_x86_feature_detected as has;
    let avx2 = || has!("avx2") && has!("fma") && has!("bmi1") && has!("bmi2") && has!("popcnt");
    let avx512 = || has!("avx512f") && has!("avx512vl") && has!("avx512dq") && has!("avx512bw");
    match level {
        Level::Scalar | Level::Portable => true,
        Level::Avx2 => avx2(),
        Level::Avx512 => avx2() && avx512(),
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn is_here(level: Level) -> bool {
    level <= Level::Portable
}

/// A small deterministic generator (SplitMix64).
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl TryRng for Random {
    type Error = Infallible;
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Ok(z ^ (z >> 31))
    }
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.try_next_u64().map(|x| (x >> 32) as u32)
    }
    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            chunk.copy_from_slice(&self.try_next_u64()?.to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}

impl Random {
    /// Uniform in [0, 1), 24 bits.
    pub fn uniform(&mut self) -> f32 {
        let Ok(x) = self.try_next_u32();
        (x >> 8) as f32 / 16_777_216.0
    }
    /// Uniform in [low, high).
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.uniform()
    }
    /// Uniform among `limit` numbers from 0 on.
    pub fn below(&mut self, limit: usize) -> usize {
        ((f64::from(self.uniform()) * limit as f64) as usize).min(limit.saturating_sub(1))
    }

    /// A number from `low` to `high`: mostly an end, its neighbour, 0, or a number as good as 0.
    pub fn end(&mut self, low: f32, high: f32) -> f32 {
        let choice = match self.below(8) {
            0 => low,
            1 => high,
            2 => low.next_up(),
            3 => high.next_down(),
            4 => 0.0,
            5 => f32::from_bits(1),
            6 => -1e-30,
            _ => self.between(low, high),
        };
        choice.clamp(low, high)
    }
    /// Two uniform numbers.
    pub fn two(&mut self) -> [f32; 2] {
        [self.uniform(), self.uniform()]
    }
    /// Three uniform numbers.
    pub fn three(&mut self) -> [f32; 3] {
        [self.uniform(), self.uniform(), self.uniform()]
    }
    /// A uniform direction.
    pub fn direction(&mut self) -> Vec3 {
        let (z, phi) = (self.between(-1.0, 1.0), self.between(0.0, core::f32::consts::TAU));
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * phi.cos(), r * phi.sin(), z).normalize()
    }
    /// A lobe whose sharpness is between two powers of ten.
    pub fn lobe(&mut self, low: f32, high: f32) -> Lobe {
        let rgb = Vec3::new(self.uniform(), self.uniform(), self.uniform() + 0.01);
        let sharpness = 10f32.powf(self.between(low, high));
        // Amplitudes that give every lobe a like share of the whole.
        Lobe::new(self.direction(), sharpness, rgb * sharpness.max(0.1)).expect("a valid lobe")
    }
    /// A mixture of random lobes, the first half squeezed unless `squeeze` is 1.
    pub fn mixture(&mut self, domain: Domain, count: usize, squeeze: f32) -> Mixture<'static, 64> {
        let lobes: Vec<Lobe> = (0..count).map(|_| self.lobe(-1.0, 4.0)).collect();
        let squeezed = if squeeze == 1.0 { 0 } else { count.div_ceil(2) };
        Mixture::new(domain, squeeze, &lobes[..squeezed], &lobes[squeezed..]).expect("a valid mixture")
    }
}

/// Sharpness from 0 to the largest, a decade apart, with the extremes that issue reports name.
pub const SHARPNESS: [f32; 15] =
    [0.0, 1e-30, 1e-8, 1e-4, 1e-2, 0.3, 1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8];

/// Uniform numbers at both ends and round the changes of formula.
pub const UNIFORM: [f32; 14] = [
    0.0,
    1e-38,
    1e-30,
    1e-12,
    5.960_464_5e-8,
    1e-6,
    1e-3,
    0.25,
    0.499_999_97,
    0.5,
    0.9,
    1.0 - 1e-6,
    1.0 - f32::EPSILON,
    1.0 - f32::EPSILON / 2.0,
];

/// Axes at the poles, on the horizon, next to both, and oblique.
pub fn axes() -> Vec<Vec3> {
    [
        (0.0, 0.0, 1.0),
        (0.0, 0.0, -1.0),
        (1.0, 0.0, 0.0),
        (0.0, -1.0, 0.0),
        (0.6, 0.8, 1e-20),
        (0.6, 0.8, -1e-7),
        (1e-7, 0.0, -1.0),
        (1e-20, 1e-3, 1.0),
        (0.36, 0.48, 0.8),
        (-0.5, 0.3, -0.4),
    ]
    .map(|(x, y, z)| Vec3::new(x, y, z).normalize())
    .to_vec()
}
