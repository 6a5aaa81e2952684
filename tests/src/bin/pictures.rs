//! Compares two renderings of one scene: `pictures A.mean.pfm A.variance.pfm B.exr SPP_A SPP_B`.
//!
//! In blocks of 16 x 16 pixels, by luminance: `z = (mean A - mean B) / sigma`, where `sigma^2` is A's measured variance of
//! the block's mean times `1 + SPP_A / SPP_B`: both use the same estimator, so that a sample of B varies as one of A does.
//! If the renderers agree, the sum of `z^2` over n blocks is chi-square of n degrees of freedom: the test refuses a sum
//! above `n + 5 sqrt(2 n)`, a single `|z|` above 5, and a mean of the whole picture that is 4 sigma off.

use std::process::ExitCode;

const BLOCK: usize = 16;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, mean, variance, other, spp, other_spp] = &arguments[..] else {
        eprintln!("usage: pictures A.mean.pfm A.variance.pfm B.exr SPP_A SPP_B");
        return ExitCode::from(2);
    };
    let (width, mean) = read_pfm(mean);
    let (_, variance) = read_pfm(variance);
    let other = read_exr(other);
    assert!(mean.len() == other.len() && mean.len() == variance.len(), "the pictures have different sizes");
    let samples = |text: &str| text.parse::<f64>().expect("a number of samples");
    let scale = 1.0 + samples(spp) / samples(other_spp);

    let blocks_wide = width.div_ceil(BLOCK);
    let blocks = blocks_wide * (mean.len() / width).div_ceil(BLOCK);
    // Difference, variance, pixels of each block.
    let mut sums = vec![[0.0f64; 3]; blocks];
    for (i, (a, b)) in mean.iter().zip(&other).enumerate() {
        let block = i / width / BLOCK * blocks_wide + i % width / BLOCK;
        let sum = &mut sums[block];
        sum[0] += luminance(*a) - luminance(*b);
        // Channels of one sample go together: the standard deviations add up, at most.
        sum[1] += luminance(variance[i].map(|v| v.max(0.0).sqrt())).powi(2) * scale;
        sum[2] += 1.0;
    }
    // A block that sees only the environment through a pixel's filter still varies; one of constant value would not.
    let z: Vec<f64> = sums.iter().map(|[d, v, _]| d / v.sqrt().max(1e-4)).collect();
    let total: [f64; 3] = std::array::from_fn(|k| sums.iter().map(|sum| sum[k]).sum());
    let (whole, n) = (total[0] / total[1].sqrt(), z.len() as f64);
    let (chi_square, largest) =
        (z.iter().map(|z| z * z).sum::<f64>(), z.iter().fold(0.0, |m: f64, z| m.max(z.abs())));
    let brightness = mean.iter().map(|a| luminance(*a)).sum::<f64>() / total[2];
    println!("mean luminance {brightness:.5}, difference {:.5} = {whole:.2} sigma", total[0] / total[2]);
    println!(
        "{n} blocks: chi-square {chi_square:.1}, limit {:.1}; largest |z| {largest:.2}",
        n + 5.0 * (2.0 * n).sqrt()
    );
    if chi_square <= n + 5.0 * (2.0 * n).sqrt() && largest <= 5.0 && whole.abs() <= 4.0 {
        ExitCode::SUCCESS
    } else {
        eprintln!("the pictures differ by more than the Monte Carlo error");
        ExitCode::FAILURE
    }
}

fn luminance(rgb: [f32; 3]) -> f64 {
    rgb.iter().zip([0.2126, 0.7152, 0.0722]).map(|(&c, weight)| f64::from(c) * weight).sum()
}

/// Reads a colour picture in little-endian PFM; rows from the top.
fn read_pfm(path: &str) -> (usize, Vec<[f32; 3]>) {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let mut lines = bytes.splitn(4, |&byte| byte == b'\n');
    assert_eq!(lines.next(), Some(&b"PF"[..]), "{path}: no colour PFM");
    let size = String::from_utf8_lossy(lines.next().unwrap_or_default()).into_owned();
    let width: usize = size.split(' ').next().and_then(|n| n.parse().ok()).expect("the width of the picture");
    let numbers: Vec<f32> = lines
        .nth(1)
        .unwrap_or_default()
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect();
    let pixels: Vec<[f32; 3]> = numbers.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    (width, pixels.chunks_exact(width).rev().flatten().copied().collect())
}

fn read_exr(path: &str) -> Vec<[f32; 3]> {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| vec![vec![[0f32; 3]; size.width()]; size.height()],
        |rows, at, (r, g, b, _): (f32, f32, f32, f32)| rows[at.y()][at.x()] = [r, g, b],
    );
    image.unwrap_or_else(|error| panic!("{path}: {error}")).layer_data.channel_data.pixels.concat()
}
