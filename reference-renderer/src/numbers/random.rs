//! Random numbers that depend only on the seed, the pixel and the number of the sample: the same picture whatever the
//! number of threads.

use rand_core::TryRng;
use std::convert::Infallible;

/// A counter-based generator: number `n` of the stream `key` is a hash of `key + n gamma`.
///
/// Source: Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators" (SplitMix64); differs: the
/// starting point is itself hashed from the three coordinates of the stream.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

/// Odd, 2^64 over the golden ratio: consecutive states differ in many bits.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Random {
    /// The stream of one sample of one pixel.
    #[inline]
    pub fn new(seed: u64, pixel: u64, sample: u64) -> Self {
        let mut state = mix(seed.wrapping_add(GAMMA));
        state = mix(state ^ pixel.wrapping_mul(GAMMA));
        state = mix(state.wrapping_add(GAMMA) ^ sample.wrapping_mul(0xd1b5_4a32_d192_ed03));
        Self { state }
    }

    /// The first number of the stream, as random as the others.
    #[inline]
    pub fn key(&self) -> u64 {
        self.state
    }

    /// The next 32 random bits.
    #[inline]
    pub fn bits(&mut self) -> u32 {
        self.state = self.state.wrapping_add(GAMMA);
        (mix(self.state) >> 32) as u32
    }

    /// The next number, uniform in [0, 1), a multiple of 2^-24.
    #[inline]
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// The next number, uniform in 0..n.
    #[cfg(test)]
    pub fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.bits()) * u64::from(n)) >> 32) as u32
    }
}

impl TryRng for Random {
    type Error = Infallible;
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.bits())
    }
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(u64::from(self.bits()) << 32 | u64::from(self.bits()))
    }
    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        bytes.iter_mut().for_each(|byte| *byte = (self.bits() >> 24) as u8);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_uniform_and_uncorrelated() {
        // First number of neighbouring streams: mean 1/2, lag-1 correlation 0, each within 5 standard errors.
        let n = 100_000;
        for (name, stream) in [
            ("pixels", (|i| Random::new(1, i, 0)) as fn(u64) -> Random),
            ("samples", |i| Random::new(1, 77, i)),
            ("seeds", |i| Random::new(i, 77, 3)),
        ] {
            let x: Vec<f64> = (0..n).map(|i| f64::from(stream(i).unit()) - 0.5).collect();
            let mean = x.iter().sum::<f64>() / n as f64;
            assert!(mean.abs() < 5.0 * (1.0 / 12.0 / n as f64).sqrt(), "{name}: mean {mean}");
            let lag = x.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / n as f64;
            assert!(lag.abs() < 5.0 / 12.0 / (n as f64).sqrt(), "{name}: correlation {lag}");
        }
    }

    #[test]
    fn numbers_stay_in_range() {
        let mut random = Random::new(3, 2, 1);
        for _ in 0..100_000 {
            assert!((0.0..1.0).contains(&random.unit()));
            assert!(random.below(7) < 7);
        }
    }
}
