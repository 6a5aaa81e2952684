//! The whole way from the bytes of a material to a sample, against f64: views, lobes, folds, squeeze, density, value.

use super::measure::{Decade, Operation, relative};
use glam::{DVec3, Vec3};
use srbf_core::{Draws, Expanded, FactorTable, Line, Material, Mixture, PlaneLobe, Sample, View, luminance};
use srbf_reference_renderer::numbers::random::Random;
use srbf_tests::oracle;
use std::f64::consts::PI;

/// Angles of the views, radians.
const VIEWS: [f32; 4] = [0.0, 0.4, 0.9, 1.4];
/// Lobes: how many times the sharpness of the decade each has, and how many of its own widths it stands off the mirror direction.
const LOBES: [(f32, f32); 3] = [(0.5, 1.5), (1.0, 0.0), (2.0, -1.0)];
/// Logarithm of the squeeze at a view, times its angle.
const SQUEEZE: f32 = -2.0;
/// Nodes of factors along half angle, difference angle and azimuth.
const NODES: [usize; 3] = [8, 6, 3];

/// How directions are drawn.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Exact,
    Streamed,
    Expanded,
    Factors,
}

/// Measures all ways, `draws` directions a decade.
pub fn measure(draws: u32, seed: u64) -> Vec<Operation> {
    let ways = [
        (Way::Exact, "material to mixture to sample", "prepared, then drawn"),
        (Way::Streamed, "material to sample", "drawn without a mixture"),
        (Way::Expanded, "expanded material to sample", "drawn from 1024 rows, between which it interpolates"),
        (Way::Factors, "material with factors to sample", "prepared, then drawn; the value has factors"),
    ];
    let of_way = |(n, (way, name, meaning)): (usize, (Way, &'static str, &'static str))| {
        let rows = (-8..=8).map(|decade| {
            let mut random = Random::new(seed, 100 + n as u64, (decade + 8) as u64);
            row(way, decade, draws, &mut random)
        });
        Operation {
            name,
            meaning,
            plain: "views, exp(s (d . axis - 1)) and 2 pi (1 - exp(-2 s)) / s in f32",
            along: "sharpness",
            rows: rows.collect(),
        }
    };
    ways.into_iter().enumerate().map(of_way).collect()
}

/// The lobes of a view: their width follows the sharpness.
fn lobes(decade: i32, theta: f32) -> [PlaneLobe; 3] {
    LOBES.map(|(times, off)| {
        let log2_sharpness = (times.log2() + decade as f32 * std::f32::consts::LOG2_10).min(26.5);
        let width = (-0.5 * log2_sharpness).exp2().min(0.2);
        let is_normal = theta == 0.0;
        PlaneLobe {
            angle: if is_normal { 0.0 } else { theta + off * width },
            off_plane: 0.0,
            log2_sharpness,
            // The integral is about the same at every sharpness.
            log2_luminance: log2_sharpness.max(0.0) - 4.0 + theta,
            color_differences: [0.0; 2],
        }
    })
}

fn factor(i: usize, j: usize, k: usize) -> f32 {
    // The factors of no half angle and of no difference angle do not depend on the azimuth.
    let azimuth = if i == 0 || j == 0 { 0.0 } else { k as f32 };
    1.0 + 0.3 * (0.7 * i as f32 + j as f32 + 0.5 * azimuth).sin()
}

fn bytes(decade: i32, has_factors: bool) -> Vec<u8> {
    let owned = VIEWS.map(|theta| (theta, lobes(decade, theta)));
    let views = owned.each_ref().map(|(theta, lobes)| View {
        theta: *theta,
        log2_squeeze: SQUEEZE * theta,
        log2_diffuse: -4.0 + theta,
        diffuse_color_differences: [0.0; 2],
        lobes,
    });
    let [half, difference, azimuth] = NODES;
    // Along the difference angle first, then the half angle, then the azimuth.
    let nodes: Vec<[f32; 3]> = (0..half * difference * azimuth)
        .map(|n| [factor(n / difference % half, n % difference, n / (half * difference)); 3])
        .collect();
    let table = FactorTable {
        half,
        difference,
        azimuth,
        is_signed: false,
        factors: &nodes,
        albedo_differences: &[[0.0; 3]; 4],
    };
    let line = Line { views: &views, squeezed: 1, mirrored: 0, factors: has_factors.then_some(table) };
    let mut bytes = vec![0; line.encoded_len("")];
    line.encode("", &mut bytes).expect("numbers in range");
    bytes
}

/// The mixture that the views give for an outgoing direction, in f64.
struct Between {
    /// Axis, sharpness, amplitude; the first is squeezed.
    lobes: Vec<(DVec3, f64, f64)>,
    squeeze: f64,
    diffuse: f64,
}

impl Between {
    fn new(decade: i32, wo: Vec3) -> Self {
        let wo = wo.as_dvec3();
        let theta = wo.x.hypot(wo.y).atan2(wo.z);
        let views = VIEWS.map(f64::from);
        let before = views[1..3].iter().filter(|view| **view <= theta).count();
        let t = ((theta - views[before]) / (views[before + 1] - views[before])).clamp(0.0, 1.0);
        let blend = |of: &dyn Fn(f32) -> f32| {
            let [a, b] = [before, before + 1].map(|view| f64::from(of(VIEWS[view])));
            a + (b - a) * t
        };
        let lobe = |k: usize| {
            let angle = blend(&|theta| lobes(decade, theta)[k].angle);
            let axis = DVec3::new(angle.sin(), 0.0, angle.cos());
            let sharpness = blend(&|theta| lobes(decade, theta)[k].log2_sharpness).exp2();
            (axis, sharpness, blend(&|theta| lobes(decade, theta)[k].log2_luminance).exp2())
        };
        Self {
            lobes: (0..LOBES.len()).map(lobe).collect(),
            squeeze: blend(&|theta| SQUEEZE * theta).exp2(),
            diffuse: blend(&|theta| -4.0 + theta).exp2(),
        }
    }

    fn power(&self) -> f64 {
        self.lobes.iter().map(|(_, s, a)| a * oracle::sphere_integral(*s)).sum::<f64>() + self.diffuse
    }

    /// Luminance of `f cos` without factors, towards a direction in the frame of the view.
    fn value(&self, d: DVec3) -> f64 {
        let lobe = |(k, (axis, s, a)): (usize, &(DVec3, f64, f64))| {
            let (u, scale) = if k == 0 { oracle::squeezed([1.0, self.squeeze], d) } else { (d, 1.0) };
            let both = oracle::gaussian(*axis, *s, u) + oracle::gaussian(*axis, *s, oracle::mirrored(u));
            a * both * scale
        };
        let of_lobes: f64 = self.lobes.iter().enumerate().map(lobe).sum();
        of_lobes + self.diffuse * d.normalize().z / PI
    }

    /// Density and value by the plain formulas in f32.
    fn plain(&self, d: Vec3) -> [f32; 2] {
        let (mut value, mut power) = (self.diffuse as f32 * d.z / PI as f32, self.diffuse as f32);
        for (k, (axis, s, a)) in self.lobes.iter().enumerate() {
            let (axis, s, a) = (axis.as_vec3(), *s as f32, *a as f32);
            let (u, scale) = if k == 0 {
                let c = self.squeeze as f32;
                let m = Vec3::new(d.x, d.y / c, d.z);
                (m / m.length(), 1.0 / (c * m.length().powi(3)))
            } else {
                (d, 1.0)
            };
            let image = Vec3::new(u.x, u.y, -u.z);
            value += a * scale * ((s * (u.dot(axis) - 1.0)).exp() + (s * (image.dot(axis) - 1.0)).exp());
            power += a * 2.0 * PI as f32 * (1.0 - (-2.0 * s).exp()) / s;
        }
        [value / power, value]
    }
}

fn row(way: Way, decade: i32, draws: u32, random: &mut Random) -> Decade {
    let material = Material::from_bytes(bytes(decade, way == Way::Factors)).expect("a valid material");
    let drawn = draw(way, &material, draws, random);
    let mut row = Decade { at: 10f64.powi(decade), ours: 0.0, plain: Some(0.0) };
    for (wo, sample) in drawn {
        let between = Between::new(decade, wo);
        // The frame of the view: its x axis points to the mirror direction.
        let x = DVec3::new(-f64::from(wo.x), -f64::from(wo.y), 0.0).normalize_or(DVec3::X);
        let y = DVec3::Z.cross(x);
        let wi = sample.direction.as_dvec3();
        let local = DVec3::new(wi.dot(x), wi.dot(y), wi.z);
        let value = between.value(local);
        let density = value / between.power();
        let factor = match way {
            Way::Factors => {
                // As it is stored, in 8 bits.
                let stored = |i, j, k| material.factor_node(i, j, k).expect("a node of the table");
                let node = |i, j, k| Vec3::from(stored(i, j, k)).as_dvec3();
                oracle::factor((NODES, false), node, wo.as_dvec3(), wi).x
            }
            _ => 1.0,
        };
        let brought = luminance(sample.weight) * sample.pdf;
        row.ours = row.ours.max(relative(density, sample.pdf)).max(relative(value * factor, brought));
        let [plain_density, plain_value] = between.plain(local.as_vec3());
        let plain = relative(density, plain_density).max(relative(value, plain_value));
        row.plain = row.plain.map(|worst| worst.max(plain));
    }
    row
}

/// Outgoing directions to 80 degrees, and the draws for each.
fn draw(way: Way, material: &Material<Vec<u8>>, draws: u32, random: &mut Random) -> Vec<(Vec3, Sample)> {
    let numbers: Vec<(Vec3, [f32; 3])> = (0..draws)
        .map(|_| {
            let (sin, cos) = (1.39 * random.unit()).sin_cos();
            let (across, along) = (std::f32::consts::TAU * random.unit()).sin_cos();
            (Vec3::new(sin * along, sin * across, cos), [(); 3].map(|()| random.unit()))
        })
        .collect();
    let mut mixture = Mixture::<16>::empty();
    let one = |(wo, u): &(Vec3, [f32; 3])| {
        let sample = match way {
            Way::Streamed => material.sample(*wo, *u)?,
            _ => {
                material.prepare(*wo, &mut mixture).ok()?;
                mixture.sample(*u)?
            }
        };
        Some((*wo, sample))
    };
    if way != Way::Expanded {
        return numbers.iter().filter_map(one).collect();
    }
    let mut memory = vec![0.0; material.expanded_len(Expanded::DEFAULT_ROWS)];
    let expanded =
        Expanded::new(material, Expanded::DEFAULT_ROWS, &mut memory).expect("an isotropic material");
    let wo = [0, 1, 2].map(|i| numbers.iter().map(|n| n.0[i]).collect::<Vec<f32>>());
    let u = [0, 1, 2].map(|i| numbers.iter().map(|n| n.1[i]).collect::<Vec<f32>>());
    let [mut x, mut y, mut z, mut pdf, mut r, mut g, mut b] = [(); 7].map(|()| vec![0.0; numbers.len()]);
    let [wo, u] = [&wo, &u].map(|columns| columns.each_ref().map(Vec::as_slice));
    let draw = Draws {
        u,
        direction: [&mut x, &mut y, &mut z],
        pdf: Some(&mut pdf),
        weight: Some([&mut r, &mut g, &mut b]),
    };
    expanded.ask(wo, draw.into()).expect("slices of one length");
    let sample = |i: usize| Sample {
        direction: Vec3::new(x[i], y[i], z[i]),
        pdf: pdf[i],
        weight: Vec3::new(r[i], g[i], b[i]),
    };
    numbers.iter().enumerate().map(|(i, n)| (n.0, sample(i))).collect()
}
