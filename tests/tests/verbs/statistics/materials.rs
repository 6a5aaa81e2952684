//! Random materials of any kind, however sharp.

use srbf_core::{FactorTable, Grid, GridView, Line, Material, PackOptions, PlaneLobe, TiltedLobe, View};
use srbf_tests::inputs::Random;
use srbf_tests::kinds::packed;
use srbf_tests::seeds::same_without_azimuth;

/// A material of any kind.
pub fn material(random: &mut Random) -> Material<Vec<u8>> {
    let bytes = if random.below(2) == 0 { line(random) } else { grid(random) };
    let options = PackOptions { bits: [8, 16][random.below(2)], channels: [1, 3][random.below(2)] };
    Material::from_bytes(if random.below(3) == 0 { packed(&bytes, options) } else { bytes }).unwrap()
}

pub fn lobe_count(random: &mut Random) -> usize {
    [1, 1, 2, 3, 5, 8, 12, 16, 17, 33, 64][random.below(11)]
}

/// Logarithms of sharpness and luminance, so that powers differ by some times, and colour differences.
fn shape(random: &mut Random) -> (f32, f32, [f32; 2]) {
    let log2_sharpness = random.between(-3.0, 24.0);
    let log2_luminance = log2_sharpness.max(0.0) - 6.0 + random.between(-2.0, 2.0);
    (log2_sharpness, log2_luminance, [random.between(-1.0, 2.0), random.between(-1.0, 4.0)])
}

/// The logarithm of a diffuse albedo, or of none.
fn diffuse(random: &mut Random) -> f32 {
    if random.below(3) == 0 { -126.0 } else { random.between(-8.0, 0.0) }
}

fn line(random: &mut Random) -> Vec<u8> {
    let thetas = [0.0, 0.8, 1.3];
    let count = lobe_count(random);
    let mirrored = random.below(count.min(64 - count) + 1);
    let squeezed = random.below(count - mirrored + 1);
    let lobes = thetas.map(|theta| {
        let mut lobe = |k: usize| {
            let (log2_sharpness, log2_luminance, color_differences) = shape(random);
            let free = |limit: f32, is_free| if is_free && theta > 0.0 { limit } else { 0.0 };
            PlaneLobe {
                angle: free(random.between(-1.6, 1.6), true),
                off_plane: free(random.between(-1.5, 1.5), k >= count - mirrored),
                log2_sharpness,
                log2_luminance,
                color_differences,
            }
        };
        (0..count).map(&mut lobe).collect::<Vec<_>>()
    });
    let views = [0, 1, 2].map(|v| View {
        theta: thetas[v],
        log2_squeeze: if v > 0 { random.between(-6.64, 0.5) } else { 0.0 },
        log2_diffuse: diffuse(random),
        diffuse_color_differences: [0.3, -0.2],
        lobes: &lobes[v],
    });
    with_factors(random, views.len(), |factors| {
        let line = Line { views: &views, squeezed, mirrored, factors };
        let mut bytes = vec![0; line.encoded_len("")];
        line.encode("", &mut bytes).unwrap();
        bytes
    })
}

fn grid(random: &mut Random) -> Vec<u8> {
    let (count, azimuths, turns) = (lobe_count(random), 3, 1 + random.below(2));
    let squeezed = random.below(count + 1);
    let lobes: Vec<Vec<TiltedLobe>> = (0..1 + azimuths)
        .map(|_| {
            let mut lobe = |_| {
                let (log2_sharpness, log2_luminance, color_differences) = shape(random);
                let tilt = [random.between(-1.2, 1.2), random.between(-1.2, 1.2)];
                TiltedLobe { tilt, log2_sharpness, log2_luminance, color_differences }
            };
            (0..count).map(&mut lobe).collect()
        })
        .collect();
    let view = |lobes| GridView {
        log2_squeeze: [random.between(-3.9, 5.5), random.between(-1.0, 1.0), random.between(-3.9, 5.5)],
        log2_diffuse: diffuse(random),
        diffuse_color_differences: [0.3, -0.2],
        lobes,
    };
    let views: Vec<GridView<'_>> = lobes.iter().map(Vec::as_slice).map(view).collect();
    with_factors(random, views.len(), |factors| {
        let grid = Grid { thetas: &[0.0, 1.1], azimuths, turns, axis: 0.4, views: &views, squeezed, factors };
        let mut bytes = vec![0; grid.encoded_len("")];
        grid.encode("", &mut bytes).unwrap();
        bytes
    })
}

/// With a table of factors in one of three.
fn with_factors(
    random: &mut Random,
    views: usize,
    encode: impl FnOnce(Option<FactorTable>) -> Vec<u8>,
) -> Vec<u8> {
    let (half, difference, azimuth) = (5, 4, 2);
    let mut factors: Vec<[f32; 3]> = (0..40).map(|_| [(); 3].map(|()| random.between(0.3, 2.0))).collect();
    same_without_azimuth(&mut factors, half, difference);
    let (is_signed, albedo_differences) = (random.below(2) == 0, vec![[0.0; 3]; views]);
    let (factors, albedo_differences) = (&factors[..], &albedo_differences[..]);
    let table = FactorTable { half, difference, azimuth, is_signed, factors, albedo_differences };
    encode((random.below(3) == 0).then_some(table))
}
