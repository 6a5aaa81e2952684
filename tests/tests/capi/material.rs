//! The materials that the C programs work with.

use srbf_core::{
    FactorTable, Grid, GridView, Line, Material, PackOptions, PlaneLobe, SpectralColumns, SpectralMap,
    TiltedLobe, View, encoded_len,
};
use srbf_tests::kinds::packed;
use std::path::PathBuf;
use std::sync::OnceLock;

/// Views, lobes, squeezed lobes and mirrored pairs; the C programs know these numbers, and the provenance, "made by tests".
const VIEWS: usize = 8;
const LOBES: usize = 12;
const SQUEEZED: usize = 5;
const MIRRORED: usize = 1;

/// A `.srbf` file of a material with lobes of every width, folds and a squeeze.
pub fn file() -> PathBuf {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    FILE.get_or_init(|| write("capi.srbf", &bytes())).clone()
}

/// A `.srbf` file of a brushed metal: 4 angles, 8 azimuths over half a turn, 5 lobes of which 3 are squeezed. The surface has one
/// squeeze matrix, written in the frame of every view.
pub fn anisotropic_file() -> PathBuf {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    FILE.get_or_init(|| write("anisotropic.srbf", &anisotropic_bytes())).clone()
}

/// The same in codes of 8 bits.
pub fn packed_anisotropic_file() -> PathBuf {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    FILE.get_or_init(|| {
        write("packed_anisotropic.srbf", &packed(&anisotropic_bytes(), PackOptions::default()))
    })
    .clone()
}

/// A `.srbf` file of two views of three grey lobes, with a table of 5 by 4 by 2 factors: see `tests/c/factors.c`.
pub fn factored_file() -> PathBuf {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    FILE.get_or_init(|| write("factored.srbf", &factored_bytes())).clone()
}

/// The same as [`file`] with a map to three wavelengths, and with one of a lidar: see `tests/c/spectrum.c`.
pub fn spectral_file() -> PathBuf {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    let columns = [[0.25, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]];
    let map = SpectralColumns::Rgb(&columns);
    FILE.get_or_init(|| write("spectral.srbf", &with_map(&[450.0, 550.0, 950.0], map, 0.125))).clone()
}

pub fn lidar_file() -> PathBuf {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    let map = SpectralColumns::Luminance(&[1.0]);
    FILE.get_or_init(|| write("lidar.srbf", &with_map(&[905.0], map, 0.0))).clone()
}

fn with_map(wavelengths: &[f32], columns: SpectralColumns<'_>, error: f32) -> Vec<u8> {
    let material = Material::from_bytes(bytes()).expect("the material is valid");
    let mut map = [0; 64];
    let length = SpectralMap::encode(wavelengths, columns, error, &mut map).expect("the map is valid");
    let map = SpectralMap::from_bytes(&map[..length]).expect("just encoded");
    let mut out = vec![0; material.with_spectral_map_len(map)];
    material.with_spectral_map(map, &mut out).expect("room for it");
    out
}

fn factored_bytes() -> Vec<u8> {
    let lobes = |theta: f32| {
        let lobe = |k: usize| PlaneLobe {
            angle: theta,
            off_plane: 0.0,
            log2_sharpness: 1.0 + 3.0 * k as f32,
            log2_luminance: -4.0 + 2.0 * k as f32,
            color_differences: [0.0; 2],
        };
        (0..3).map(lobe).collect::<Vec<_>>()
    };
    let stored = [(0.0, lobes(0.0)), (1.2, lobes(1.1))];
    let views = [0, 1].map(|v| View {
        theta: stored[v].0,
        log2_squeeze: -stored[v].0,
        log2_diffuse: -4.0,
        diffuse_color_differences: [0.0; 2],
        lobes: &stored[v].1,
    });
    let (half, difference, azimuth) = (5, 4, 2);
    let factor = |n: usize| {
        let (i, j) = (n / difference % half, n % difference);
        let is_twice = n / difference >= half && i > 0 && j > 0;
        [0.25 * (1 + i) as f32, 1.0, if is_twice { 0.5 } else { 0.25 } * (1 + j) as f32]
    };
    let factors: Vec<[f32; 3]> = (0..azimuth * half * difference).map(factor).collect();
    let albedo_differences = [[-0.25, 0.5, -0.125], [-0.25, 0.5, 0.25]];
    let factors = FactorTable {
        half,
        difference,
        azimuth,
        is_signed: true,
        factors: &factors,
        albedo_differences: &albedo_differences,
    };
    let line = Line { views: &views, squeezed: 1, mirrored: 0, factors: Some(factors) };
    // Eight letters leave the numbers where a program may read them as such.
    let mut bytes = vec![0; line.encoded_len("by tests")];
    line.encode("by tests", &mut bytes).expect("the material is valid");
    bytes
}

fn write(name: &str, bytes: &[u8]) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, bytes).expect("the target folder can be written");
    path
}

fn anisotropic_bytes() -> Vec<u8> {
    const ALONG: f32 = 1.0;
    const ACROSS: f32 = -1.0;
    let (thetas, azimuths) = ([0.0, 0.5, 1.0, 1.4], 8);
    let places = (0..1 + (thetas.len() - 1) * azimuths).map(|view| match view {
        0 => (0.0, 0.0),
        _ => {
            let turn = std::f32::consts::PI * ((view - 1) % azimuths) as f32 / azimuths as f32;
            (thetas[1 + (view - 1) / azimuths], turn)
        }
    });
    let lobes_of = |theta: f32| {
        let lobe = |k: usize| TiltedLobe {
            tilt: [theta * (0.8 + 0.1 * k as f32), 0.0],
            log2_sharpness: 8.0 - k as f32,
            log2_luminance: -0.9 - k as f32,
            color_differences: [-0.1, -0.3],
        };
        (0..5).map(lobe).collect::<Vec<_>>()
    };
    let views: Vec<([f32; 3], Vec<TiltedLobe>)> = places
        .map(|(theta, azimuth)| {
            let (s, c) = azimuth.sin_cos();
            let (xx, yy) = (c * c * ALONG + s * s * ACROSS, s * s * ALONG + c * c * ACROSS);
            ([xx, c * s * (ACROSS - ALONG), yy], lobes_of(theta))
        })
        .collect();
    let views: Vec<GridView<'_>> = views
        .iter()
        .map(|(log2_squeeze, lobes)| GridView {
            log2_squeeze: *log2_squeeze,
            log2_diffuse: -4.3,
            diffuse_color_differences: [-0.4, -0.7],
            lobes,
        })
        .collect();
    let grid =
        Grid { thetas: &thetas, azimuths, turns: 2, axis: 0.0, views: &views, squeezed: 3, factors: None };
    let mut bytes = vec![0; grid.encoded_len("made by tests")];
    let written = grid.encode("made by tests", &mut bytes).expect("the material is valid");
    bytes.truncate(written);
    bytes
}

/// Its bytes.
pub fn bytes() -> Vec<u8> {
    let lobes: Vec<Vec<PlaneLobe>> = (0..VIEWS)
        .map(|view| {
            let theta = 0.2 * view as f32;
            (0..LOBES - MIRRORED)
                .map(|lobe| PlaneLobe {
                    // Towards the mirror direction and, the wide ones, below the horizon.
                    angle: theta * (1.0 + 0.06 * (lobe as f32 - 6.0)),
                    off_plane: if lobe < LOBES - 2 * MIRRORED { 0.0 } else { 0.5 * theta },
                    log2_sharpness: 0.5 + 0.6 * lobe as f32,
                    log2_luminance: -6.9 + 0.4 * lobe as f32,
                    color_differences: [-0.1, -0.3],
                })
                .collect()
        })
        .collect();
    let views: Vec<View<'_>> = lobes
        .iter()
        .enumerate()
        .map(|(view, lobes)| View {
            theta: 0.2 * view as f32,
            log2_squeeze: -0.3 * view as f32,
            log2_diffuse: -4.3,
            diffuse_color_differences: [-0.4, -0.7],
            lobes,
        })
        .collect();
    let provenance = "made by tests";
    let mut bytes = vec![0; encoded_len(VIEWS, LOBES - MIRRORED, MIRRORED, provenance)];
    let line = Line { views: &views, squeezed: SQUEEZED, mirrored: MIRRORED, factors: None };
    let written = line.encode(provenance, &mut bytes).expect("the material is valid");
    bytes.truncate(written);
    bytes
}
