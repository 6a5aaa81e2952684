//! A small network that is trained on a BRDF, as in "Neural BRDF Representation and Importance Sampling" (Sztrajman et al. 2021).

use srbf_fit::read::neural::{self, Neural};
use srbf_fit::table::Brdf;
use srbf_reference_renderer::numbers::random::Random;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Inputs, two layers of neurons, channels.
const LAYERS: [usize; 4] = [6, 21, 21, 3];
const WIDTH: usize = 21;
/// Pairs of directions, and how many of them a step sees.
const PAIRS: usize = 800_000;
const BATCH: usize = 512;
/// Length of the first step; the last is a hundredth.
const RATE: f32 = 3e-3;
/// Adam's constants.
const MEMORY: (f32, f32) = (0.9, 0.999);
/// Largest logarithm of a value.
const LARGEST: f32 = 20.0;

/// A pair: half vector and difference vector, the cosine of the incident direction, and the values.
struct Pair {
    input: [f32; 6],
    cosine: f32,
    value: [f32; 3],
}

/// Trains a network on a BRDF, and tells its number of weights.
///
/// # Errors
/// Weights that are not finite.
pub fn train(brdf: &dyn Brdf, batches: usize) -> anyhow::Result<(Neural, usize)> {
    let mut random = Random::new(7, 0, 0);
    let pairs: Vec<Pair> = std::iter::repeat_with(|| pair(brdf, &mut random)).flatten().take(PAIRS).collect();
    let mut weights = Vec::new();
    for sides in LAYERS.windows(2) {
        let range = (6.0 / (sides[0] + sides[1]) as f32).sqrt();
        weights.extend((0..sides[0] * sides[1]).map(|_| range * (2.0 * random.unit() - 1.0)));
        weights.extend(std::iter::repeat_n(0.0, sides[1]));
    }
    let mut mean = vec![0.0f32; weights.len()];
    let mut square = mean.clone();
    for step in 0..batches {
        let mut slope = vec![0.0f32; weights.len()];
        for _ in 0..BATCH {
            add_slope(&weights, &pairs[(random.unit() * PAIRS as f32) as usize % PAIRS], &mut slope);
        }
        let rate = RATE * 0.01f32.powf(step as f32 / batches as f32);
        let unbiased = |memory: f32| 1.0 - memory.powi(step as i32 + 1);
        for (n, weight) in weights.iter_mut().enumerate() {
            let slope = slope[n] / BATCH as f32;
            mean[n] += (1.0 - MEMORY.0) * (slope - mean[n]);
            square[n] += (1.0 - MEMORY.1) * (slope * slope - square[n]);
            let size = (square[n] / unbiased(MEMORY.1)).sqrt() + 1e-8;
            *weight -= rate * mean[n] / unbiased(MEMORY.0) / size;
        }
    }
    let bytes: Vec<u8> = weights.iter().flat_map(|weight| weight.to_le_bytes()).collect();
    Ok((neural::parse(&bytes)?.remove(0), weights.len()))
}

/// A random pair above the horizon, denser about the mirror direction as MERL's tables are.
fn pair(brdf: &dyn Brdf, random: &mut Random) -> Option<Pair> {
    let half = FRAC_PI_2 * random.unit().powi(2);
    let (difference, azimuth) = (FRAC_PI_2 * random.unit(), TAU * random.unit() - PI);
    let d = [difference.sin() * azimuth.cos(), difference.sin() * azimuth.sin(), difference.cos()];
    let turned = |d: [f32; 3]| {
        let (sin, cos) = half.sin_cos();
        [d[0] * cos + d[2] * sin, d[1], d[2] * cos - d[0] * sin]
    };
    let (wi, wo) = (turned(d), turned([-d[0], -d[1], d[2]]));
    if wi[2] < 0.02 || wo[2] < 0.02 {
        return None;
    }
    let value = brdf.evaluate(wi.map(f64::from), wo.map(f64::from)).map(|v| v.max(0.0) as f32);
    let is_known = value.iter().all(|v| v.is_finite());
    let input = [half.sin(), 0.0, half.cos(), d[0], d[1], d[2]];
    is_known.then_some(Pair { input, cosine: wi[2], value })
}

/// Adds the slope of the mean absolute difference of `ln(1 + f cos)` at one pair.
fn add_slope(weights: &[f32], pair: &Pair, slope: &mut [f32]) {
    let (first, rest) = weights.split_at(7 * WIDTH);
    let (second, third) = rest.split_at((WIDTH + 1) * WIDTH);
    let (mut a, mut b, mut out) = ([0.0f32; WIDTH], [0.0f32; WIDTH], [0.0f32; 3]);
    forward(first, &pair.input, &mut a);
    a.iter_mut().for_each(|v| *v = v.max(0.0));
    forward(second, &a, &mut b);
    b.iter_mut().for_each(|v| *v = v.max(0.0));
    forward(third, &b, &mut out);
    let mut back = [0.0f32; 3];
    for c in 0..3 {
        let exponential = out[c].min(LARGEST).exp();
        // A value below 0 counts as it is here, so that a dark channel still has a slope.
        let value = (exponential - 1.0) * pair.cosine;
        let apart = (1.0 + value.max(-0.99)).ln() - (1.0 + pair.value[c] * pair.cosine).ln();
        back[c] = apart.signum() * exponential * pair.cosine / (1.0 + value.max(-0.99)) / 3.0;
    }
    let (slope_first, rest) = slope.split_at_mut(7 * WIDTH);
    let (slope_second, slope_third) = rest.split_at_mut((WIDTH + 1) * WIDTH);
    let mut back_b = [0.0f32; WIDTH];
    backward(third, &b, &back, slope_third, &mut back_b);
    let mut back_a = [0.0f32; WIDTH];
    backward(second, &a, &back_b, slope_second, &mut back_a);
    backward(first, &pair.input, &back_a, slope_first, &mut [0.0; 6]);
}

/// `out = input W + b`, rows of W by input.
fn forward<const N: usize, const M: usize>(weights: &[f32], input: &[f32; N], out: &mut [f32; M]) {
    out.copy_from_slice(&weights[N * M..]);
    for (row, v) in weights.chunks_exact(M).zip(input) {
        out.iter_mut().zip(row).for_each(|(o, w)| *o += v * w);
    }
}

/// The slopes of a layer and of its input; an input of 0 was cut off there, and has none.
fn backward<const N: usize, const M: usize>(
    weights: &[f32],
    input: &[f32; N],
    back: &[f32; M],
    slope: &mut [f32],
    back_input: &mut [f32; N],
) {
    for (n, v) in input.iter().enumerate() {
        if *v != 0.0 {
            let row = &weights[n * M..(n + 1) * M];
            slope[n * M..(n + 1) * M].iter_mut().zip(back).for_each(|(s, b)| *s += v * b);
            back_input[n] = row.iter().zip(back).map(|(w, b)| w * b).sum();
        }
    }
    slope[N * M..].iter_mut().zip(back).for_each(|(s, b)| *s += b);
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Matte;

    impl Brdf for Matte {
        fn evaluate(&self, _wi: [f64; 3], _wo: [f64; 3]) -> [f64; 3] {
            [0.2, 0.1, 0.05]
        }
    }

    #[test]
    fn a_matte_surface_is_learnt() {
        let (network, weights) = train(&Matte, 600).unwrap();
        assert_eq!(weights, 675);
        for wi in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, -0.6, 0.8]] {
            let value = network.evaluate(wi, [-0.6, 0.0, 0.8]);
            let true_value = Matte.evaluate(wi, wi);
            assert!((0..3).all(|c| (value[c] - true_value[c]).abs() < 0.02), "{wi:?} {value:?}");
        }
    }
}
