//! Shared by the benches: inputs, and the baselines that every figure is a ratio to.

pub mod baseline;
#[cfg(target_arch = "x86_64")]
pub mod clock;
pub mod device;
pub mod ggx;
pub mod harness;
pub mod work;

use srbf_core::{
    Domain, Draws, FactorTable, Grid, GridView, Groups, Level, Line, Lobe, Material, Mixture, PackOptions,
    PlaneLobe, Request, Room, TiltedLobe, Towards, Vec3, View,
};
use std::ops::Range;
use std::sync::OnceLock;

/// Lobe counts that every batch operation is measured at.
pub const LOBES: [usize; 7] = [1, 4, 8, 12, 16, 32, 64];

/// Batch sizes that every batch operation is measured at.
pub const DIRECTIONS: [usize; 5] = [1, 7, 64, 1024, 65536];

/// The garnet red preset, as the renderer embeds it.
pub const GARNET_RED: &[u8] = include_bytes!("../../presets/garnet_red.srbf");

/// The levels that this machine has.
pub fn levels() -> impl Iterator<Item = Level> {
    Level::ALL.into_iter().filter(|level| level.is_available())
}

/// A small deterministic generator (SplitMix64).
#[derive(Debug)]
pub struct Random(pub u64);

impl Random {
    /// The next uniform number in [0, 1).
    pub fn uniform(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 40) as f32 / (1u64 << 24) as f32
    }

    /// A uniform direction of the upper hemisphere.
    pub fn direction(&mut self) -> Vec3 {
        let (z, phi) = (self.uniform(), self.uniform() * core::f32::consts::TAU);
        let across = (1.0 - z * z).sqrt();
        Vec3::new(across * phi.cos(), across * phi.sin(), z)
    }
}

/// `n` directions of the upper hemisphere, or `n` triples of uniform numbers, as structure of arrays.
#[derive(Debug)]
pub struct Triples(pub [Vec<f32>; 3]);

impl Triples {
    /// Directions.
    pub fn directions(n: usize, seed: u64) -> Self {
        let mut random = Random(seed);
        let all: Vec<Vec3> = (0..n).map(|_| random.direction()).collect();
        Self([0, 1, 2].map(|i| all.iter().map(|d| d[i]).collect()))
    }

    /// Uniform numbers.
    pub fn uniforms(n: usize, seed: u64) -> Self {
        let mut random = Random(seed);
        Self([0, 1, 2].map(|_| (0..n).map(|_| random.uniform()).collect()))
    }

    /// Borrowed, as the library takes them.
    pub fn slices(&self) -> [&[f32]; 3] {
        [&self.0[0], &self.0[1], &self.0[2]]
    }

    /// A part of them.
    pub fn part(&self, range: Range<usize>) -> [&[f32]; 3] {
        self.0.each_ref().map(|row| &row[range.clone()])
    }

    /// The `i`-th triple.
    pub fn at(&self, i: usize) -> Vec3 {
        Vec3::new(self.0[0][i], self.0[1][i], self.0[2][i])
    }
}

/// A request for all of some hits: a draw, and the light from `wi`.
///
/// Its eleven rows are direction, density and weight of the draw, then value and density of `wi`.
pub fn whole_request<'a>(
    u: &'a Triples,
    wi: &'a Triples,
    out: &'a mut [Vec<f32>; 11],
    hits: Range<usize>,
) -> Request<'a> {
    let [a, b, c, d, e, f, g, h, i, j, k] = out.each_mut().map(|row| &mut row[hits.clone()]);
    let draw = Draws { u: u.part(hits.clone()), direction: [a, b, c], pdf: Some(d), weight: Some([e, f, g]) };
    let evaluate = Towards { wi: wi.part(hits), value: Some([h, i, j]), pdf: Some(k) };
    Request { draw: Some(draw), evaluate: Some(evaluate) }
}

/// `count` lobes with axes far above the horizon: none needs its fold, to compare with those who have none.
pub fn general_lobes(count: usize) -> Vec<Lobe> {
    let mut random = Random(42);
    (0..count)
        .map(|_| {
            let axis = random.direction().with_z(1.5).normalize();
            let sharpness = 50.0 * 2f32.powf(6.0 * random.uniform());
            let rgb = Vec3::new(random.uniform(), random.uniform(), random.uniform());
            Lobe::new(axis, sharpness, rgb).expect("a valid lobe")
        })
        .collect()
}

/// A mixture of [`general_lobes`], round and without folds, at the current level.
pub fn general_mixture(count: usize) -> Mixture<'static, 64> {
    Mixture::sphere(&general_lobes(count)).expect("a valid mixture")
}

/// Twelve lobes so wide (sharpness 1 to 32) that no exponential underflows: where it does, `expf` and the vector `expf` of
/// GNU's C library take a path several times slower than the usual one.
pub fn mild_lobes() -> Vec<Lobe> {
    let wide = |lobe: &Lobe| {
        let sharpness = (lobe.gaussian.sharpness / 50.0).powf(5.0 / 6.0);
        Lobe::new(lobe.gaussian.axis, sharpness, lobe.amplitude).expect("a valid lobe")
    };
    general_lobes(12).iter().map(wide).collect()
}

/// Mixtures of twelve lobes by name, at the current level: each form of lobe switched on alone, and the preset with all of them.
pub fn named_mixtures() -> Vec<(&'static str, Mixture<'static, 64>)> {
    let general = general_lobes(12);
    let with_axis = |axis: fn(Vec3) -> Vec3| -> Vec<Lobe> {
        let moved =
            |l: &Lobe| Lobe::new(axis(l.gaussian.axis).normalize(), l.gaussian.sharpness, l.amplitude);
        general.iter().map(|l| moved(l).expect("a valid lobe")).collect()
    };
    let mixture = |domain, squeeze, squeezed: &[Lobe], round: &[Lobe]| {
        Mixture::new(domain, squeeze, squeezed, round).expect("a valid mixture")
    };
    vec![
        ("mild", mixture(Domain::Sphere, 1.0, &[], &mild_lobes())),
        ("plane", mixture(Domain::Sphere, 1.0, &[], &with_axis(|a| a.with_y(0.0)))),
        ("folded", mixture(Domain::Hemisphere, 1.0, &[], &with_axis(|a| a.with_z(0.02)))),
        ("squeezed", mixture(Domain::Sphere, 0.5, &general, &[])),
        ("garnet", garnet_mixture()),
    ]
}

/// The garnet red preset.
pub fn garnet_red() -> &'static Material {
    static MATERIAL: OnceLock<Material> = OnceLock::new();
    MATERIAL.get_or_init(|| Material::from_bytes(GARNET_RED).expect("the preset is valid"))
}

/// The garnet red preset at 50 degrees, folded where needed, squeezed, with its diffuse term, at the current level.
pub fn garnet_mixture() -> Mixture<'static, 64> {
    mixture_at_50_degrees(garnet_red())
}

/// The mixture of a material for an outgoing direction at 50 degrees, at the current level.
pub fn mixture_at_50_degrees<const N: usize>(material: &'static Material) -> Mixture<'static, N>
where
    Room<N>: Groups,
{
    let mut mixture = Mixture::empty();
    material.prepare(Vec3::new(-0.6, 0.4, 0.65).normalize(), &mut mixture).expect("a valid direction");
    mixture
}

/// A material in codes of 8 bits, without its provenance.
pub fn packed(material: &Material<impl AsRef<[u8]>>) -> Vec<u8> {
    let options = PackOptions::default();
    let mut bytes = vec![0; material.packed_len(options, "")];
    material.pack(options, "", &mut bytes).expect("a material that can be packed");
    bytes
}

/// The garnet red preset in codes of 8 bits, which is made once.
pub fn packed_material() -> &'static Material {
    static MATERIAL: OnceLock<Material> = OnceLock::new();
    MATERIAL.get_or_init(|| Material::from_bytes(&*packed(garnet_red()).leak()).expect("a valid material"))
}

/// The garnet red preset as a brushed surface, which is made once: its angles, by as many lobes, the images of mirrored ones stored, at five
/// views over a quarter of the turn. Along the brush lobes are wider.
pub fn brushed_material() -> &'static Material {
    static MATERIAL: OnceLock<Material> = OnceLock::new();
    MATERIAL.get_or_init(|| Material::from_bytes(&*brushed_bytes().leak()).expect("a valid material"))
}

fn brushed_bytes() -> Vec<u8> {
    const AZIMUTHS: usize = 5;
    let material = garnet_red();
    let thetas: Vec<f32> =
        (0..material.view_count()).map(|v| material.view_theta(v).expect("a view by angle")).collect();
    let (stored, mirrored) = (material.view_lobe_count(), material.mirrored_count());
    let places: Vec<(usize, f32)> = (0..thetas.len())
        .flat_map(|v| {
            let turn = |j| std::f32::consts::FRAC_PI_2 * j as f32 / (AZIMUTHS - 1) as f32;
            (0..if v == 0 { 1 } else { AZIMUTHS }).map(move |j| (v, turn(j)))
        })
        .collect();
    let lobes_at = |&(v, turn): &(usize, f32)| -> Vec<TiltedLobe> {
        let lobe = |k: usize| {
            let (k, side) = if k < stored { (k, 1.0) } else { (k - mirrored, -1.0) };
            let lobe = material.view_lobe(v, k).expect("a lobe of the plane");
            let ((sin, cos), (off, on)) = (lobe.angle.sin_cos(), (side * lobe.off_plane).sin_cos());
            let (along, up) = (sin * on, cos * on);
            let scale = up.acos() / along.hypot(off).max(1e-9);
            TiltedLobe {
                tilt: [along * scale, off * scale],
                log2_sharpness: lobe.log2_sharpness + 0.4 * (2.0 * turn).cos(),
                log2_luminance: lobe.log2_luminance,
                color_differences: lobe.color_differences,
            }
        };
        (0..stored + mirrored).map(lobe).collect()
    };
    let lobes: Vec<_> = places.iter().map(lobes_at).collect();
    let view = |(&(v, turn), lobes): (&(usize, f32), &'static [TiltedLobe])| {
        let (sin, cos) = (2.0 * turn).sin_cos();
        Some(GridView {
            log2_squeeze: [-0.6 * cos, 0.6 * sin, 0.6 * cos - material.view_log2_squeeze(v)?],
            log2_diffuse: material.view_log2_diffuse(v)?,
            diffuse_color_differences: material.view_diffuse_color_differences(v)?,
            lobes,
        })
    };
    let lobes: Vec<&'static [TiltedLobe]> = lobes.into_iter().map(|lobes| &*lobes.leak()).collect();
    let views: Vec<_> =
        places.iter().zip(lobes).map(|place| view(place).expect("a view of an isotropic material")).collect();
    let grid = Grid {
        thetas: &thetas,
        azimuths: AZIMUTHS,
        turns: 4,
        axis: 0.4,
        views: &views,
        squeezed: material.squeezed_count(),
        factors: None,
    };
    let mut bytes = vec![0; grid.encoded_len("")];
    grid.encode("", &mut bytes).expect("a valid material");
    bytes
}

/// The garnet red preset with a table of 24 by 6 by 3 factors, which is made once.
pub fn factored_material() -> &'static Material {
    static MATERIAL: OnceLock<Material> = OnceLock::new();
    MATERIAL.get_or_init(|| Material::from_bytes(&*factored_bytes().leak()).expect("a valid material"))
}

fn factored_bytes() -> Vec<u8> {
    const NODES: [usize; 3] = [24, 6, 3];
    let material = garnet_red();
    let every = 0..material.view_count();
    let lobes: Vec<Vec<_>> = every
        .clone()
        .map(|v| (0..material.view_lobe_count()).filter_map(|k| material.view_lobe(v, k)).collect())
        .collect();
    let view = |v: usize| {
        Some(View {
            theta: material.view_theta(v)?,
            log2_squeeze: material.view_log2_squeeze(v)?,
            log2_diffuse: material.view_log2_diffuse(v)?,
            diffuse_color_differences: material.view_diffuse_color_differences(v)?,
            lobes: &lobes[v],
        })
    };
    let views: Vec<View<'_>> = every.map(|v| view(v).expect("a view of an isotropic material")).collect();
    let [half, difference, azimuth] = NODES;
    let factor = |n: usize| {
        let (i, j, k) = (n / difference % half, n % difference, n / (half * difference));
        // Where either angle is 0 there is no azimuth.
        let turned = if i > 0 && j > 0 { 0.1 * k as f32 } else { 0.0 };
        [0.7, 1.0, 1.3].map(|f| f + turned + 0.5 * (i as f32 * 0.4 + j as f32).sin())
    };
    let factors: Vec<[f32; 3]> = (0..half * difference * azimuth).map(factor).collect();
    let albedo_differences = vec![[-0.1; 3]; views.len()];
    let factors = FactorTable {
        half,
        difference,
        azimuth,
        is_signed: false,
        factors: &factors,
        albedo_differences: &albedo_differences,
    };
    let line = Line {
        views: &views,
        squeezed: material.squeezed_count(),
        mirrored: material.mirrored_count(),
        factors: Some(factors),
    };
    let mut bytes = vec![0; line.encoded_len("")];
    line.encode("", &mut bytes).expect("a valid material");
    bytes
}

/// Bytes of a number of materials, no two alike: the presets in turn, the lobes of each made brighter or darker, sharper or wider
/// and of other colours.
pub fn different_materials(count: usize) -> Vec<Vec<u8>> {
    let presets: [&[u8]; 3] = [
        GARNET_RED,
        include_bytes!("../../presets/cayman.srbf"),
        include_bytes!("../../presets/krylon_blue.srbf"),
    ];
    let mut random = Random(11);
    (0..count).map(|i| varied(presets[i % 3], &mut random)).collect()
}

fn varied(preset: &[u8], random: &mut Random) -> Vec<u8> {
    let material = Material::from_bytes(preset).expect("the preset is valid");
    let change = [(); 4].map(|()| 0.5 * (random.uniform() - 0.5));
    let every = 0..material.view_count();
    let lobes: Vec<Vec<PlaneLobe>> = every
        .clone()
        .map(|v| {
            let of = |k| {
                let mut lobe: PlaneLobe = material.view_lobe(v, k)?;
                lobe.log2_sharpness += change[0];
                // -126 stands for none.
                lobe.log2_luminance = (lobe.log2_luminance + change[0] + change[1]).max(-126.0);
                lobe.color_differences = lobe.color_differences.map(|d| d * (0.75 + change[2]));
                Some(lobe)
            };
            (0..material.view_lobe_count()).filter_map(of).collect()
        })
        .collect();
    let view = |v: usize| {
        Some(View {
            theta: material.view_theta(v)?,
            log2_squeeze: material.view_log2_squeeze(v)?,
            log2_diffuse: (material.view_log2_diffuse(v)? + change[3]).max(-126.0),
            diffuse_color_differences: material.view_diffuse_color_differences(v)?,
            lobes: &lobes[v],
        })
    };
    let views: Vec<View<'_>> = every.map(|v| view(v).expect("a view of an isotropic material")).collect();
    let line = Line {
        views: &views,
        squeezed: material.squeezed_count(),
        mirrored: material.mirrored_count(),
        factors: None,
    };
    let provenance = material.provenance();
    let mut bytes = vec![0; line.encoded_len(provenance)];
    line.encode(provenance, &mut bytes).expect("a valid material");
    bytes
}

/// Bytes of a material like a mirror: ten lobes of sharpness 8 to 6e5 and a mirrored pair of 1e5 at fifteen views, along the mirror
/// direction but for less than the width of each.
pub fn mirror_like() -> Vec<u8> {
    const VIEWS: usize = 15;
    const LOBES: usize = 11;
    let mut random = Random(6);
    let views: Vec<(f32, Vec<PlaneLobe>)> = (0..VIEWS)
        .map(|v| {
            let theta = 1.5 * (v as f32 / (VIEWS - 1) as f32).powf(0.7);
            let lobes = (0..LOBES).map(|k| {
                let log2_sharpness = if k + 1 == LOBES { 16.6 } else { 3.0 + 1.8 * k as f32 };
                let width = (-0.5 * log2_sharpness).exp2();
                let color_differences = [random.uniform() - 0.5, random.uniform() - 0.5];
                PlaneLobe {
                    angle: if v == 0 { 0.0 } else { theta + (random.uniform() - 0.5) * width },
                    off_plane: if v > 0 && k + 1 == LOBES { width } else { 0.0 },
                    log2_sharpness: log2_sharpness + 0.5 * random.uniform(),
                    log2_luminance: log2_sharpness - 6.5 + random.uniform(),
                    color_differences,
                }
            });
            (theta, lobes.collect())
        })
        .collect();
    let views: Vec<View<'_>> = views
        .iter()
        .map(|(theta, lobes)| View {
            theta: *theta,
            log2_squeeze: -theta,
            log2_diffuse: -6.0,
            diffuse_color_differences: [0.0; 2],
            lobes,
        })
        .collect();
    let line = Line { views: &views, squeezed: 5, mirrored: 1, factors: None };
    let mut bytes = vec![0; line.encoded_len("")];
    line.encode("", &mut bytes).expect("a valid material");
    bytes
}
