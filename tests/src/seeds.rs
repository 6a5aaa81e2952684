//! Materials to begin with where bytes are damaged: one with factors, and any number at the ends of the format's ranges.

use crate::inputs::Random;
use core::f32::consts::{FRAC_PI_2, PI};
use srbf_core::{
    FactorTable, FormatError, Grid, GridView, Line, Material, PlaneLobe, SpectralColumns, SpectralMap,
    TiltedLobe, View,
};

/// Where the seeds come from, as their provenance says.
const SEED: &str = "made by tests/src/seeds.rs";

/// A material with colours outside the gamut and a table of factors.
pub fn factored() -> Vec<u8> {
    let lobe = |k: usize, angle| PlaneLobe {
        angle,
        off_plane: 0.0,
        log2_sharpness: 2.0 + 3.0 * k as f32,
        log2_luminance: 2.0 * k as f32 - 5.0,
        color_differences: [4.0 * k as f32 - 1.5, 12.0 - 8.0 * k as f32],
    };
    let lobes = [[lobe(0, 0.0), lobe(1, 0.0)], [lobe(0, 0.9), lobe(1, 1.1)]];
    let view = |v: usize| View {
        theta: 1.2 * v as f32,
        log2_squeeze: -(v as f32),
        log2_diffuse: -3.0,
        diffuse_color_differences: [-1.2, 3.0],
        lobes: &lobes[v],
    };
    let plane = (0..12).map(|n| [0.6 * n as f32, 1.0, 0.0]);
    let factors: Vec<[f32; 3]> = plane.clone().chain(plane).collect();
    let albedo_differences = [[0.5, -0.2, 1.0]; 2];
    let (half, difference, azimuth) = (4, 3, 2);
    let table = FactorTable {
        half,
        difference,
        azimuth,
        is_signed: false,
        factors: &factors,
        albedo_differences: &albedo_differences,
    };
    let line = Line { views: &[view(0), view(1)], squeezed: 1, mirrored: 0, factors: Some(table) };
    encoded(line.encoded_len(SEED), |out| line.encode(SEED, out))
}

/// The same with spectra of the colours.
pub fn spectral() -> Vec<u8> {
    with_spectra(&factored())
}

/// A material with spectra of the colours.
pub fn with_spectra(bytes: &[u8]) -> Vec<u8> {
    let material = Material::from_bytes(bytes).expect("a valid material");
    let columns = SpectralColumns::Rgb(&[[0.1, -0.2, 1.5], [0.2, 0.9, 0.1], [2.0, 1.0, -1.0]]);
    let mut map = [0; SpectralMap::encoded_len(3, false)];
    SpectralMap::encode(&[420.0, 550.0, 905.0], columns, 0.1, &mut map).expect("a valid map");
    let map = SpectralMap::from_bytes(&map).expect("just encoded");
    encoded(material.with_spectral_map_len(map), |out| material.with_spectral_map(map, out))
}

/// A material of one kind or the other whose numbers are mostly the ends of the format's ranges.
pub fn extreme(random: &mut Random) -> Vec<u8> {
    if random.below(2) == 0 { extreme_line(random) } else { extreme_grid(random) }
}

fn extreme_line(random: &mut Random) -> Vec<u8> {
    let thetas = thetas(random, 5);
    let count = lobe_count(random);
    let mirrored = random.below(count.min(64 - count) + 1);
    let squeezed = random.below(count - mirrored + 1);
    // At the normal nothing may depend on an azimuth.
    let free = |view: usize, x: f32| if view == 0 { 0.0 } else { x };
    let lobes: Vec<Vec<PlaneLobe>> = (0..thetas.len())
        .map(|v| {
            (0..count)
                .map(|k| PlaneLobe {
                    angle: free(v, random.end(-PI, PI)),
                    off_plane: if k < count - mirrored {
                        0.0
                    } else {
                        free(v, random.end(-FRAC_PI_2, FRAC_PI_2))
                    },
                    log2_sharpness: random.end(-100.0, 26.5),
                    log2_luminance: random.end(-126.0, 60.0),
                    color_differences: [random.end(-16.0, 16.0), random.end(-16.0, 16.0)],
                })
                .collect()
        })
        .collect();
    let views: Vec<View> = (thetas.iter().zip(&lobes).enumerate())
        .map(|(v, (&theta, lobes))| View {
            theta,
            log2_squeeze: free(v, random.end(-6.64, 1.0)),
            log2_diffuse: random.end(-126.0, 2.0),
            diffuse_color_differences: [random.end(-16.0, 16.0), random.end(-16.0, 16.0)],
            lobes,
        })
        .collect();
    let table = Table::extreme(random, views.len());
    let line = Line { views: &views, squeezed, mirrored, factors: table.as_ref().map(Table::borrow) };
    encoded(line.encoded_len(SEED), |out| line.encode(SEED, out))
}

fn extreme_grid(random: &mut Random) -> Vec<u8> {
    let thetas = thetas(random, 3);
    let (count, azimuths, turns) = (lobe_count(random), 1 + random.below(4), 1 + random.below(2));
    let squeezed = random.below(count + 1);
    let view_count = 1 + (thetas.len() - 1) * azimuths;
    let lobes: Vec<Vec<TiltedLobe>> = (0..view_count)
        .map(|_| {
            (0..count)
                .map(|_| {
                    // Together at most pi.
                    let along = random.end(-PI, PI);
                    TiltedLobe {
                        tilt: [along, if along.abs() > 1.0 { 0.0 } else { random.end(-2.9, 2.9) }],
                        log2_sharpness: random.end(-100.0, 26.5),
                        log2_luminance: random.end(-126.0, 60.0),
                        color_differences: [random.end(-16.0, 16.0), random.end(-16.0, 16.0)],
                    }
                })
                .collect()
        })
        .collect();
    let views: Vec<GridView> = (lobes.iter())
        .map(|lobes| GridView {
            // Next to the ends, as eigenvalues are rounded; of the last they are turned by an eighth.
            log2_squeeze: match random.below(3) {
                0 => [0.0; 3],
                1 => [random.end(-4.999, 6.639), 0.0, random.end(-4.999, 6.639)],
                _ => [0.82, random.end(-5.819, 5.819), 0.82],
            },
            log2_diffuse: random.end(-126.0, 2.0),
            diffuse_color_differences: [random.end(-16.0, 16.0), random.end(-16.0, 16.0)],
            lobes,
        })
        .collect();
    let table = Table::extreme(random, view_count);
    let factors = table.as_ref().map(Table::borrow);
    let grid = Grid { thetas: &thetas, azimuths, turns, axis: 0.0, views: &views, squeezed, factors };
    encoded(grid.encoded_len(SEED), |out| grid.encode(SEED, out))
}

/// Angles of one to `most` views or rings: next to each other, or far apart.
fn thetas(random: &mut Random, most: usize) -> Vec<f32> {
    let mut thetas = vec![0.0f32];
    for _ in 0..random.below(most) {
        let last = thetas[thetas.len() - 1];
        let next = match random.below(4) {
            0 => last.next_up(),
            1 => last + 1e-20,
            2 => FRAC_PI_2,
            _ => random.between(last, FRAC_PI_2),
        };
        if last < next && next <= FRAC_PI_2 {
            thetas.push(next);
        }
    }
    thetas
}

/// A few, or as many as there may be, or one more or less than the lanes of a vector.
fn lobe_count(random: &mut Random) -> usize {
    [1, 2, 3, 15, 16, 17, 31, 33, 63, 64][random.below(10)]
}

/// A table of factors.
struct Table {
    half: usize,
    difference: usize,
    azimuth: usize,
    is_signed: bool,
    factors: Vec<[f32; 3]>,
    albedo_differences: Vec<[f32; 3]>,
}

impl Table {
    /// In every other material, of as few nodes as there may be, or of as many.
    fn extreme(random: &mut Random, views: usize) -> Option<Self> {
        if random.below(2) == 0 {
            return None;
        }
        let [half, difference] = [(); 2].map(|()| [2, 3, 32][random.below(3)]);
        let azimuth = [1, 2, 8][random.below(3)];
        let is_signed = azimuth > 1 && random.below(2) == 0;
        let mut three = |low, high| [(); 3].map(|()| random.end(low, high));
        let mut factors: Vec<[f32; 3]> = (0..azimuth * half * difference).map(|_| three(0.0, 8.07)).collect();
        same_without_azimuth(&mut factors, half, difference);
        let albedo_differences = (0..views).map(|_| three(-16.0, 16.0)).collect();
        Some(Self { half, difference, azimuth, is_signed, factors, albedo_differences })
    }

    fn borrow(&self) -> FactorTable<'_> {
        let Self { half, difference, azimuth, is_signed, ref factors, ref albedo_differences } = *self;
        FactorTable { half, difference, azimuth, is_signed, factors, albedo_differences }
    }
}

/// Where half angle or difference angle are 0 there is no azimuth: the nodes of all are those of the first.
pub fn same_without_azimuth(factors: &mut [[f32; 3]], half: usize, difference: usize) {
    for n in 0..factors.len() {
        let (i, j) = (n / difference % half, n % difference);
        if i == 0 || j == 0 {
            factors[n] = factors[i * difference + j];
        }
    }
}

/// The bytes that a writer makes.
fn encoded(len: usize, encode: impl FnOnce(&mut [u8]) -> Result<usize, FormatError>) -> Vec<u8> {
    let mut bytes = vec![0; len];
    encode(&mut bytes).expect("a seed is valid");
    bytes
}
