//! Mixtures and a material of every kind, from a generator with a seed.

use alloc::format;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use srbf_core::{Domain, FactorTable, Line, Lobe, Mixture, PlaneLobe, Vec3, View};

/// A small deterministic generator (SplitMix64).
pub struct Random(pub u64);

impl Random {
    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 40) as f32 / (1u64 << 24) as f32
    }
    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.uniform()
    }
    /// Uniform on the sphere.
    pub fn direction(&mut self) -> Vec3 {
        let (z, phi) = (self.between(-1.0, 1.0), self.between(0.0, core::f32::consts::TAU));
        let (sin, cos) = libm::sincosf(phi);
        let r = libm::sqrtf(1.0 - z * z);
        Vec3::new(r * cos, r * sin, z).normalize()
    }
}

/// A mixture to check.
pub struct Case {
    /// What messages call it.
    pub name: String,
    /// The mixture.
    pub mixture: Mixture<'static, 64>,
}

impl Case {
    /// Every combination of sphere and hemisphere, axes in the plane or anywhere, squeezed or not, diffuse or not.
    pub fn new(n: usize, random: &mut Random) -> Self {
        let in_plane = n.is_multiple_of(2);
        let domain = if n.is_multiple_of(3) { Domain::Sphere } else { Domain::Hemisphere };
        let count = 1 + (n * 7) % 64;
        let squeezed = if n.is_multiple_of(5) { 0 } else { count / 2 };
        let lobes: Vec<Lobe> = (0..count).map(|_| lobe(random, in_plane)).collect();
        let squeeze = random.between(0.05, 1.5);
        let (first, then) = lobes.split_at(squeezed);
        let mut mixture = Mixture::new(domain, squeeze, first, then).expect("a valid mixture");
        if domain == Domain::Hemisphere && n % 4 < 2 {
            mixture = mixture.with_diffuse(Vec3::new(0.3, 0.2, 0.1)).expect("a valid albedo");
        }
        let name =
            format!("mixture {n}: {domain:?}, {count} lobes, {squeezed} squeezed, in the plane: {in_plane}");
        Self { name, mixture }
    }
}

fn lobe(random: &mut Random, in_plane: bool) -> Lobe {
    let mut axis = random.direction();
    if in_plane {
        axis = Vec3::new(axis.x, 0.0, axis.z).normalize();
    }
    let sharpness = libm::powf(10.0, random.between(-2.0, 5.0));
    let rgb = Vec3::new(random.uniform(), random.uniform(), random.uniform());
    Lobe::new(axis, sharpness, rgb).expect("a valid lobe")
}

/// A material of nine views and twelve lobes, of which a number of pairs lie beside the plane of incidence.
pub fn material(random: &mut Random, mirrored: usize) -> Vec<u8> {
    made(random, mirrored, &[None]).remove(0)
}

/// Such a material with a table of factors, with a signed one, with one over half and difference angle alone, and without.
pub fn factored(random: &mut Random) -> [Vec<u8>; 4] {
    let (half, difference, azimuth) = (32, 19, 5);
    let mut factors: Vec<[f32; 3]> =
        (0..azimuth * half * difference).map(|_| [0.0; 3].map(|_: f32| 8.0 * random.uniform())).collect();
    for n in 0..factors.len() {
        let (i, j) = (n / difference % half, n % difference);
        if i == 0 || j == 0 {
            factors[n] = factors[i * difference + j];
        }
    }
    let albedo_differences = &[[-0.5; 3]; 9];
    let table =
        FactorTable { half, difference, azimuth, is_signed: false, factors: &factors, albedo_differences };
    let signed = FactorTable { is_signed: true, ..table };
    let flat = FactorTable { azimuth: 1, factors: &factors[..half * difference], ..table };
    let all = made(random, 1, &[Some(table), Some(signed), Some(flat), None]);
    all.try_into().expect("four of them")
}

/// Materials that are the same but for their factors.
fn made(random: &mut Random, mirrored: usize, factors: &[Option<FactorTable<'_>>]) -> Vec<Vec<u8>> {
    let stored = 12 - mirrored;
    let knots = 9;
    let views: Vec<(f32, f32, Vec<PlaneLobe>)> = (0..knots)
        .map(|v| {
            let theta = v as f32 / (knots - 1) as f32 * core::f32::consts::FRAC_PI_2;
            let lobes = (0..stored)
                .map(|k| PlaneLobe {
                    angle: if v == 0 { 0.0 } else { theta * k as f32 / 11.0 },
                    off_plane: if v == 0 || k < stored - mirrored { 0.0 } else { theta * random.uniform() },
                    log2_sharpness: k as f32 + 0.3 * random.uniform(),
                    log2_luminance: -3.0 - random.uniform() + 0.2 * k as f32,
                    color_differences: [random.between(-1.5, 2.0), random.between(-1.0, 5.0)],
                })
                .collect();
            (theta, libm::log2f(libm::cosf(theta).max(0.1)) * f32::from(v > 0), lobes)
        })
        .collect();
    let views: Vec<View<'_>> = views
        .iter()
        .map(|(theta, squeeze, lobes)| View {
            theta: *theta,
            log2_squeeze: *squeeze,
            log2_diffuse: -3.0,
            diffuse_color_differences: [-0.4, 0.9],
            lobes,
        })
        .collect();
    let encoded = |factors: &Option<FactorTable<'_>>| {
        let squeezed = 7.min(stored - mirrored);
        let line = Line { views: &views, squeezed, mirrored, factors: *factors };
        let mut bytes = vec![0; line.encoded_len("test")];
        line.encode("test", &mut bytes).expect("a valid material");
        bytes
    };
    factors.iter().map(encoded).collect()
}
