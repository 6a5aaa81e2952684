//! Materials of many kinds, and what tests of pairs need: structures of arrays, and every level in turn.

use crate::inputs::{Random, levels};
use crate::seeds::{same_without_azimuth, with_spectra};
use glam::Vec3;
use srbf_core::{
    FactorTable, Grid, GridView, Level, Line, Material, PackOptions, PlaneLobe, Sheet, TiltedLobe, View,
};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Bytes of a material of a kind, in views at uneven angles.
///
/// Lobes follow the mirror direction but for their own width, `sharpness` is the range of log2. Of `lobes` stored ones the first
/// `squeezed` are squeezed, the last `mirrored` stand for two.
pub struct Kind {
    /// What messages call it.
    pub name: &'static str,
    /// Number of views.
    pub views: usize,
    /// Lobes that are stored.
    pub lobes: usize,
    /// How many of them are squeezed.
    pub squeezed: usize,
    /// How many stand for two.
    pub mirrored: usize,
    /// Range of the logarithm.
    pub sharpness: [f32; 2],
    /// Whether it has a table of factors.
    pub factors: bool,
}

/// One of each.
pub const KINDS: [Kind; 7] = [
    Kind {
        name: "plain",
        views: 9,
        lobes: 6,
        squeezed: 0,
        mirrored: 0,
        sharpness: [-3.0, 8.0],
        factors: false,
    },
    Kind {
        name: "mirror-like",
        views: 15,
        lobes: 12,
        squeezed: 6,
        mirrored: 0,
        sharpness: [3.0, 20.0],
        factors: false,
    },
    Kind {
        name: "squeezed",
        views: 12,
        lobes: 12,
        squeezed: 12,
        mirrored: 0,
        sharpness: [1.0, 10.0],
        factors: false,
    },
    Kind {
        name: "mirrored pairs",
        views: 12,
        lobes: 9,
        squeezed: 3,
        mirrored: 4,
        sharpness: [1.0, 12.0],
        factors: false,
    },
    Kind {
        name: "one view",
        views: 1,
        lobes: 5,
        squeezed: 0,
        mirrored: 0,
        sharpness: [0.0, 12.0],
        factors: false,
    },
    Kind {
        name: "64 lobes",
        views: 10,
        lobes: 52,
        squeezed: 20,
        mirrored: 12,
        sharpness: [-1.0, 12.0],
        factors: false,
    },
    Kind {
        name: "factors",
        views: 8,
        lobes: 10,
        squeezed: 4,
        mirrored: 0,
        sharpness: [1.0, 9.0],
        factors: true,
    },
];

impl Kind {
    /// The bytes of its file.
    pub fn bytes(&self) -> Vec<u8> {
        self.bytes_by(&mut Random(self.lobes as u64))
    }

    /// The same by the caller's random numbers.
    pub fn bytes_by(&self, random: &mut Random) -> Vec<u8> {
        let views: Vec<(f32, Vec<PlaneLobe>)> = (0..self.views)
            .map(|v| {
                let theta = if v == 0 { 0.0 } else { 1.53 * (v as f32 / (self.views - 1) as f32).powf(0.7) };
                let mut lobe = |k: usize| {
                    let [low, high] = self.sharpness;
                    let log2_sharpness = low + (high - low) * (k as f32 + 0.5) / self.lobes as f32;
                    let width = (-0.5 * log2_sharpness).exp2().min(0.3);
                    let is_mirrored = k + self.mirrored >= self.lobes;
                    let off_plane = if v > 0 && is_mirrored { 0.8 * width } else { 0.0 };
                    PlaneLobe {
                        angle: if v == 0 { 0.0 } else { theta + width * random.between(-0.5, 0.5) },
                        off_plane,
                        log2_sharpness: log2_sharpness + random.between(-0.3, 0.3),
                        log2_luminance: log2_sharpness - 7.0 + random.between(-0.5, 0.5),
                        color_differences: [random.between(-0.4, 0.4), random.between(-0.4, 0.4)],
                    }
                };
                (theta, (0..self.lobes).map(&mut lobe).collect())
            })
            .collect();
        let view = |(theta, lobes): &'_ (f32, Vec<PlaneLobe>)| (*theta, lobes.clone());
        let owned: Vec<(f32, Vec<PlaneLobe>)> = views.iter().map(view).collect();
        let views: Vec<View<'_>> = owned
            .iter()
            .map(|(theta, lobes)| View {
                theta: *theta,
                log2_squeeze: if self.squeezed > 0 { -2.0 * theta } else { 0.0 },
                log2_diffuse: -5.0 + theta,
                diffuse_color_differences: [0.3, -0.2],
                lobes,
            })
            .collect();
        const NODES: usize = 8;
        let mut factors: Vec<[f32; 3]> = (0..3 * NODES * NODES)
            .map(|n| [0.8, 1.0, 1.2].map(|f| f + 0.3 * ((n / NODES) as f32 * 0.7 + (n % NODES) as f32).sin()))
            .collect();
        same_without_azimuth(&mut factors, NODES, NODES);
        let albedo_differences = vec![[0.1; 3]; views.len()];
        let table = FactorTable {
            half: NODES,
            difference: NODES,
            azimuth: 3,
            is_signed: true,
            factors: &factors,
            albedo_differences: &albedo_differences,
        };
        let factors = self.factors.then_some(table);
        let line = Line { views: &views, squeezed: self.squeezed, mirrored: self.mirrored, factors };
        let mut bytes = vec![0; line.encoded_len("")];
        line.encode("", &mut bytes).expect("a valid material");
        bytes
    }
}

/// The generated materials and the presets.
pub fn materials() -> Vec<(&'static str, Vec<u8>)> {
    let mut all: Vec<_> = KINDS.iter().map(|kind| (kind.name, kind.bytes())).collect();
    all.push(("cayman", include_bytes!("../../presets/cayman.srbf").to_vec()));
    all.push(("garnet red", include_bytes!("../../presets/garnet_red.srbf").to_vec()));
    all.push(("krylon blue", include_bytes!("../../presets/krylon_blue.srbf").to_vec()));
    let of = |kind: usize, options| packed(&KINDS[kind].bytes(), options);
    all.push(("mirrored pairs in codes", of(3, PackOptions::default())));
    all.push(("64 lobes in long codes", of(5, PackOptions { bits: 16, channels: 3 })));
    all.push(("grey factors in codes", of(6, PackOptions { bits: 8, channels: 1 })));
    all
}

/// An anisotropic material.
///
/// Lobes follow the mirror direction but for their own width; with `turns` 4 those in the planes of mirrors lie in them. The logarithms
/// of their sharpness go from 1 to `sharpest`.
fn turned_by(
    random: &mut Random,
    [lobes, squeezed]: [usize; 2],
    [azimuths, turns]: [usize; 2],
    sharpest: f32,
    has_factors: bool,
) -> Vec<u8> {
    const THETAS: [f32; 4] = [0.0, 0.4, 0.9, 1.4];
    let (axis, phase) = if turns == 4 { (0.4, 0.0) } else { (0.0, 0.3) };
    let places = (0..1 + 3 * azimuths).map(|view| {
        let step =
            if turns == 4 { FRAC_PI_2 / (azimuths - 1) as f32 } else { TAU / (turns * azimuths) as f32 };
        let (ring, along) = (view + azimuths - 1, (view + azimuths - 1) % azimuths);
        if view == 0 {
            (0.0, 0.0, false)
        } else {
            (THETAS[ring / azimuths], step * along as f32, along > 0 && along < azimuths - 1)
        }
    });
    let mut view = |(theta, turn, is_between): (f32, f32, bool)| {
        let aside = if turns == 4 && !is_between { 0.0 } else { 1.0 };
        let mut lobe = |k: usize| {
            let log2_sharpness = 1.0 + (sharpest - 1.0) * (k as f32 + 0.5) / lobes as f32;
            let width = (-0.5 * log2_sharpness).exp2().min(0.3);
            TiltedLobe {
                tilt: [theta + width * random.between(-0.5, 0.5), aside * width * random.between(-1.0, 1.0)],
                log2_sharpness: log2_sharpness + 0.5 * (2.0 * (turn - phase)).cos(),
                log2_luminance: log2_sharpness - 7.0 + random.between(-0.5, 0.5),
                color_differences: [random.between(-0.4, 0.4), random.between(-0.4, 0.4)],
            }
        };
        let lobes: Vec<TiltedLobe> = (0..lobes).map(&mut lobe).collect();
        let (sin, cos) = (2.0 * (turn - phase)).sin_cos();
        ([-cos, sin, cos + theta], lobes)
    };
    let views: Vec<([f32; 3], Vec<TiltedLobe>)> = places.map(&mut view).collect();
    let views: Vec<GridView<'_>> = views
        .iter()
        .map(|(log2_squeeze, lobes)| GridView {
            log2_squeeze: *log2_squeeze,
            log2_diffuse: -4.0,
            diffuse_color_differences: [0.3, -0.2],
            lobes,
        })
        .collect();
    const NODES: usize = 6;
    let factors: Vec<[f32; 3]> =
        (0..NODES * NODES).map(|n| [0.8, 1.0, 1.2].map(|f| f + 0.3 * (n as f32 * 0.7).sin())).collect();
    let albedo_differences = vec![[0.1; 3]; views.len()];
    let table = FactorTable {
        half: NODES,
        difference: NODES,
        azimuth: 1,
        is_signed: false,
        factors: &factors,
        albedo_differences: &albedo_differences,
    };
    let factors = has_factors.then_some(table);
    let grid = Grid { thetas: &THETAS, azimuths, turns, axis, views: &views, squeezed, factors };
    let mut bytes = vec![0; grid.encoded_len("")];
    grid.encode("", &mut bytes).expect("a valid material");
    bytes
}

/// Anisotropic materials: with mirrors, with factors, of more lobes than a group has, each in numbers and in codes.
pub fn turned_materials() -> Vec<(&'static str, Vec<u8>)> {
    let turned = |lobes: usize, squeezed, azimuths, turns, has_factors| {
        let mut random = Random(62 + lobes as u64);
        turned_by(&mut random, [lobes, squeezed], [azimuths, turns], 10.0, has_factors)
    };
    let plain = [turned(12, 7, 4, 4, false), turned(5, 5, 5, 1, true), turned(40, 11, 3, 2, false)];
    let codes = [(8, 3), (8, 1), (16, 3)];
    let of = |k: usize| packed(&plain[k], PackOptions { bits: codes[k].0, channels: codes[k].1 });
    let in_codes = [of(0), of(1), of(2)];
    let names = ["mirrors", "turned factors", "40 turned lobes"];
    let names_in_codes =
        ["mirrors in codes", "grey turned factors in codes", "40 turned lobes in long codes"];
    names.into_iter().chain(names_in_codes).zip(plain.into_iter().chain(in_codes)).collect()
}

/// The names that [`any`] takes. A blend is kept as a sheet, whose reflection and transmission are its parts.
pub const ANY: [&str; 13] = [
    "line",
    "sharp",
    "squeezed",
    "mirrored",
    "factors",
    "grid",
    "grid-mirrors",
    "grid-factors",
    "codes-8",
    "codes-16",
    "spectra",
    "sheet",
    "blend",
];

/// A random material of a kind: of 1 to 64 lobes, with sharpness up to 2^12, sharp ones 2^20.
pub fn any(name: &str, random: &mut Random) -> Vec<u8> {
    let other = |random: &mut Random, limit| ANY[random.below(limit)];
    match name {
        "grid" | "grid-mirrors" | "grid-factors" => {
            let lobes = 1 + random.below(64);
            let (squeezed, sharpest) = (random.below(lobes + 1), random.between(3.0, 12.0));
            let azimuths = 2 + random.below(4);
            let turns = if name == "grid-mirrors" { 4 } else { 1 + random.below(2) };
            turned_by(random, [lobes, squeezed], [azimuths, turns], sharpest, name == "grid-factors")
        }
        "codes-8" | "codes-16" => {
            let plain = any(other(random, 8), random);
            let options = PackOptions {
                bits: if name == "codes-8" { 8 } else { 16 },
                channels: [1, 3][random.below(2)],
            };
            packed(&plain, options)
        }
        "spectra" => with_spectra(&any(other(random, 8), random)),
        "sheet" => {
            // All but the first may be black.
            let mut quarter =
                |is_first| (is_first || random.below(5) > 0).then(|| any(other(random, 8), random));
            sheet([true, false, false, false].map(&mut quarter), false)
        }
        "blend" => {
            let mut part = || Some(any(other(random, 8), random));
            sheet([part(), part(), None, None], true)
        }
        _ => {
            let all = 1 + random.below(64);
            let mirrored = if name == "mirrored" { random.below(all / 2 + 1) } else { 0 };
            let lobes = all - mirrored;
            let rest = lobes - mirrored;
            let sharpest = if name == "sharp" { 20.0 } else { random.between(3.0, 12.0) };
            Kind {
                name: "any",
                views: 1 + random.below(16),
                lobes,
                squeezed: if name == "squeezed" { rest } else { random.below(rest + 1) },
                mirrored,
                sharpness: [random.between(-3.0, 3.0), sharpest],
                factors: name == "factors",
            }
            .bytes_by(random)
        }
    }
}

/// A sheet of quarters.
fn sheet(quarters: [Option<Vec<u8>>; 4], is_symmetric: bool) -> Vec<u8> {
    let made = quarters.map(|bytes| bytes.map(|bytes| Material::from_bytes(bytes).expect("a material")));
    let quarters = made.each_ref().map(Option::as_ref);
    let mut bytes = vec![0; Sheet::encoded_len(quarters, "")];
    Sheet::encode(quarters, is_symmetric, "", &mut bytes).expect("a valid sheet");
    bytes
}

/// A material in codes.
pub fn packed(bytes: &[u8], options: PackOptions) -> Vec<u8> {
    let material = Material::from_bytes(bytes).expect("a valid material");
    let mut out = vec![0; material.packed_len(options, material.provenance())];
    material.pack(options, material.provenance(), &mut out).expect("a material that can be packed");
    out
}

/// A direction of the upper hemisphere.
pub fn upper(random: &mut Random) -> Vec3 {
    let d = random.direction();
    d.with_z(d.z.abs())
}

/// Structure of arrays.
pub struct Soa(pub [Vec<f32>; 3]);

impl Soa {
    /// Of vectors.
    pub fn new(all: &[Vec3]) -> Self {
        Self([0, 1, 2].map(|i| all.iter().map(|d| d[i]).collect()))
    }
    /// With room for more.
    pub fn empty(n: usize) -> Self {
        Self([0, 1, 2].map(|_| vec![f32::NAN; n]))
    }
    /// As the library reads them.
    pub fn slices(&self) -> [&[f32]; 3] {
        self.0.each_ref().map(|s| &s[..])
    }
    /// As the library writes them.
    pub fn slices_mut(&mut self) -> [&mut [f32]; 3] {
        self.0.each_mut().map(|s| &mut s[..])
    }
    /// One of them.
    pub fn at(&self, i: usize) -> Vec3 {
        Vec3::new(self.0[0][i], self.0[1][i], self.0[2][i])
    }
}

/// One test at a time, as the level is that of the process.
pub fn for_each_level(mut each: impl FnMut(Level)) {
    let _guard = ONE.lock();
    let before = Level::current();
    for level in levels() {
        level.set().expect("an available level");
        each(level);
    }
    before.set().unwrap();
}

static ONE: std::sync::Mutex<()> = std::sync::Mutex::new(());
