//! Anisotropic materials: written numbers are read, mixtures between the views follow the documentation, continuous in
//! the outgoing direction, the same at every level, and sampled by their density.

use glam::{DMat2, DVec2, DVec3, Vec3};
use srbf_core::{
    Draws, FactorTable, Grid, GridView, LUMINANCE, Level, Material, Mixture, PackOptions, TiltedLobe, Towards,
};
use srbf_tests::inputs::{Random, levels};
use srbf_tests::oracle;
use srbf_tests::partition::Partition;
use srbf_tests::statistics::sidak;
use std::f64::consts::{PI, TAU};
use std::sync::Mutex;

/// The level is chosen for the whole process.
static LEVEL: Mutex<()> = Mutex::new(());

const LOBES: usize = 5;
const SQUEEZED: usize = 3;
const THETAS: [f32; 4] = [0.0, 0.5, 1.0, 1.4];
const TEXT: &str = "test, made by tests/anisotropic.rs";

/// A grid of random views: numbers of a head, lobes.
struct Made {
    azimuths: usize,
    turns: usize,
    axis: f32,
    views: Vec<([f32; 3], [f32; 3], Vec<TiltedLobe>)>,
}

/// A view of the numbers of [`Made`].
fn view((log2_squeeze, diffuse, lobes): &([f32; 3], [f32; 3], Vec<TiltedLobe>)) -> GridView<'_> {
    GridView {
        log2_squeeze: *log2_squeeze,
        log2_diffuse: diffuse[0],
        diffuse_color_differences: [diffuse[1], diffuse[2]],
        lobes,
    }
}

impl Made {
    fn new(seed: u64, azimuths: usize, turns: usize, sharpest: f32) -> Self {
        let mut random = Random(seed);
        let sharpness: Vec<f32> = (0..LOBES).map(|_| random.between(0.0, sharpest)).collect();
        let views = (0..1 + (THETAS.len() - 1) * azimuths)
            .map(|view| {
                // In the planes of mirrors lobes are their own images.
                let is_free =
                    turns < 4 || view > 0 && !matches!((view - 1) % azimuths, 0) && view % azimuths != 0;
                let aside = if is_free { 1.0 } else { 0.0 };
                let theta = if view == 0 { 0.0 } else { THETAS[1 + (view - 1) / azimuths] };
                let squeeze =
                    [random.between(-1.5, 1.5), aside * random.between(-1.0, 1.0), random.between(-1.5, 3.0)];
                let diffuse = [-2.0, random.between(-1.0, 2.0), random.between(-1.0, 3.0)];
                let lobes = (0..LOBES)
                    .map(|k| {
                        let level = sharpness[k] - 6.0;
                        TiltedLobe {
                            tilt: [
                                theta + random.between(-0.3, 0.3) * if view == 0 { aside } else { 1.0 },
                                aside * random.between(-0.4, 0.4),
                            ],
                            log2_sharpness: sharpness[k] + random.between(-0.5, 0.5),
                            log2_luminance: level,
                            color_differences: [random.between(-1.5, 2.0), random.between(-1.0, 4.0)],
                        }
                    })
                    .collect();
                (squeeze, diffuse, lobes)
            })
            .collect();
        // Mirrors stand anywhere.
        let axis = if turns == 4 { 0.1 * seed as f32 } else { 0.0 };
        Self { azimuths, turns, axis, views }
    }

    fn encode(&self) -> Vec<u8> {
        self.encode_with(None)
    }

    fn encode_with(&self, factors: Option<FactorTable<'_>>) -> Vec<u8> {
        let views: Vec<GridView> = self.views.iter().map(view).collect();
        let grid = Grid {
            thetas: &THETAS,
            azimuths: self.azimuths,
            turns: self.turns,
            axis: self.axis,
            views: &views,
            squeezed: SQUEEZED,
            factors,
        };
        let mut bytes = vec![0; grid.encoded_len(TEXT)];
        assert_eq!(grid.encode(TEXT, &mut bytes).unwrap(), bytes.len());
        bytes
    }

    /// All numbers of a view in one row: squeeze matrix, diffuse, then of each lobe tilt, sharpness, amplitude.
    fn numbers(&self, view: usize) -> Vec<f64> {
        let (squeeze, diffuse, lobes) = &self.views[view];
        let of_lobes = lobes.iter().flat_map(|l| {
            l.tilt.into_iter().chain([l.log2_sharpness, l.log2_luminance]).chain(l.color_differences)
        });
        squeeze.iter().copied().chain(*diffuse).chain(of_lobes).map(f64::from).collect()
    }

    /// Value and albedo from the documentation, in f64.
    fn truth(&self, wo: DVec3, wi: DVec3) -> (DVec3, DVec3) {
        let theta = wo.x.hypot(wo.y).atan2(wo.z);
        let real = DVec2::from_angle(wo.y.atan2(wo.x) + PI);
        let axis = (f64::from(self.axis) * 65536.0 / PI).round() * PI / 65536.0;
        let mut phi = (wo.y.atan2(wo.x) - axis).rem_euclid(TAU);
        let mut image = 1.0;
        if self.turns == 4 {
            let half = phi.rem_euclid(PI);
            (phi, image) = if half > 0.5 * PI { (PI - half, -1.0) } else { (half, 1.0) };
        }
        let a = DVec2::from_angle(phi + PI);
        let within = (1..3).rev().find(|&r| f64::from(THETAS[r]) <= theta).unwrap_or(0);
        let (from, to) = (f64::from(THETAS[within]), f64::from(THETAS[within + 1]));
        let outward = ((theta - from) / (to - from)).min(1.0);
        let steps = self.turns * if self.turns == 4 { self.azimuths - 1 } else { self.azimuths };
        let along = phi / TAU * steps as f64;
        let onward = along.fract();
        let ring = |ring: usize| {
            if ring == 0 {
                let mut v = self.numbers(0);
                let turn = |x: f64, y: f64| [x * a.x + y * a.y, y * a.x - x * a.y];
                let r = DMat2::from_cols(DVec2::new(a.x, -a.y), DVec2::new(a.y, a.x));
                let s = DMat2::from_cols(DVec2::new(v[0], v[1]), DVec2::new(v[1], v[2]));
                let s = r * s * r.transpose();
                (v[0], v[1], v[2]) = (s.x_axis.x, s.x_axis.y, s.y_axis.y);
                v[6..].chunks_mut(6).for_each(|l| [l[0], l[1]] = turn(l[0], l[1]));
                return v;
            }
            let view = |add: usize| 1 + (ring - 1) * self.azimuths + (along as usize + add) % self.azimuths;
            let (p, q) = (self.numbers(view(0)), self.numbers(view(1)));
            p.iter().zip(&q).map(|(p, q)| p + onward * (q - p)).collect::<Vec<f64>>()
        };
        let (p, q) = (ring(within), ring(within + 1));
        let mut v: Vec<f64> = p.iter().zip(&q).map(|(p, q)| p + outward * (q - p)).collect();
        v[1] *= image;
        v[6..].chunks_mut(6).for_each(|l| l[1] *= image);
        let a = real;

        // The matrix by its exponential series in the Pauli decomposition: exp(m + t) = e^m (cosh r + sinh r / r t).
        let l = std::f64::consts::LN_2;
        let (m, d, o) = (0.5 * l * (v[0] + v[2]), 0.5 * l * (v[0] - v[2]), l * v[1]);
        let r = d.hypot(o).max(1e-300);
        let (c, s) = (r.cosh(), r.sinh() / r);
        let matrix = m.exp() * DMat2::from_cols(DVec2::new(c + s * d, s * o), DVec2::new(s * o, c - s * d));
        let see = |d: DVec3| {
            let xy = matrix * d.truncate();
            let seen = xy.extend(d.z);
            (seen.normalize(), matrix.determinant() / seen.length().powi(3))
        };

        let d = DVec3::new(wi.x * a.x + wi.y * a.y, wi.y * a.x - wi.x * a.y, wi.z);
        let diffuse = oracle::color(v[3].exp2(), [v[4], v[5]]);
        let (mut value, mut albedo) = (diffuse * d.z / PI, diffuse);
        for (k, l) in v[6..].chunks(6).enumerate() {
            let tilt = DVec2::new(l[0], l[1]);
            let r = tilt.length();
            let mut axis = (tilt * if r > 0.0 { r.sin() / r } else { 1.0 }).extend(r.cos());
            let (mut u, mut scale) = (d, 1.0);
            if k < SQUEEZED {
                (u, scale) = see(d);
                axis = see(axis).0;
            }
            let s = l[2].exp2();
            let rgb = oracle::color(l[3].exp2(), [l[4], l[5]]);
            let image = axis.with_z(-axis.z);
            let g = |axis: DVec3| (-0.5 * s * (u - axis).length_squared()).exp();
            value += rgb * scale * (g(axis) + g(image));
            albedo += rgb * (-2.0 * PI * (-2.0 * s).exp_m1() / s);
        }
        (value, albedo)
    }
}

fn direction(theta: f32, phi: f32) -> Vec3 {
    Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

fn prepare<'m>(material: &'m Material<impl AsRef<[u8]>>, wo: Vec3) -> Mixture<'m, 16> {
    let mut m = Mixture::empty();
    material.prepare(wo, &mut m).unwrap();
    m
}

#[test]
fn what_was_written_is_read() {
    let made = Made::new(1, 4, 2, 10.0);
    let bytes = made.encode();
    let material = Material::from_bytes(&bytes).unwrap();
    assert!(!material.is_isotropic());
    assert_eq!(
        (material.view_count(), material.lobe_count(), material.squeezed_count()),
        (13, LOBES, SQUEEZED)
    );
    assert_eq!(material.provenance(), TEXT);
    for (v, (squeeze, diffuse, lobes)) in made.views.iter().enumerate() {
        let ring = if v == 0 { 0 } else { 1 + (v - 1) / 4 };
        assert_eq!(material.view_theta(v), Some(THETAS[ring]));
        let azimuth = if v == 0 { 0.0 } else { (v - 1) as f32 % 4.0 * std::f32::consts::FRAC_PI_4 };
        assert!((material.view_azimuth(v).unwrap() - azimuth).abs() < 1e-6);
        assert_eq!(material.view_log2_squeeze_matrix(v), Some(*squeeze));
        assert_eq!(material.view_log2_diffuse(v), Some(diffuse[0]));
        assert_eq!(material.view_diffuse_color_differences(v), Some([diffuse[1], diffuse[2]]));
        for (k, lobe) in lobes.iter().enumerate() {
            assert_eq!(material.view_tilted_lobe(v, k), Some(*lobe));
        }
        assert_eq!((material.view_lobe(v, 0), material.view_log2_squeeze(v)), (None, None));
    }
    for v in [13, usize::MAX] {
        assert_eq!((material.view_theta(v), material.view_azimuth(v)), (None, None));
        assert_eq!((material.view_log2_diffuse(v), material.view_log2_squeeze_matrix(v)), (None, None));
        assert_eq!(material.view_tilted_lobe(v, 0), None);
    }
}

#[test]
fn factors_of_a_grid_multiply_values_and_albedo_differences_are_interpolated_along_and_across_rings() {
    let made = Made::new(3, 3, 2, 8.0);
    let factors: Vec<[f32; 3]> = (0..20).map(|n| [0.3 * n as f32, 1.0, 2.0 / (1 + n) as f32]).collect();
    let mut random = Random(31);
    let differences: Vec<[f32; 3]> = made.views.iter().map(|_| random.three()).collect();
    let table = FactorTable {
        half: 5,
        difference: 4,
        azimuth: 1,
        is_signed: false,
        factors: &factors,
        albedo_differences: &differences,
    };
    let (bytes, bare) = (made.encode_with(Some(table)), made.encode());
    let (material, bare) = (Material::from_bytes(&bytes).unwrap(), Material::from_bytes(&bare).unwrap());
    assert_eq!((material.factor_nodes(), bare.factor_nodes()), (Some([5, 4, 1]), None));
    for v in 0..=made.views.len() {
        assert_eq!(material.view_albedo_difference(v), differences.get(v).copied());
    }
    for _ in 0..500 {
        let (theta, phi) = (random.between(0.0, 1.57), random.between(0.0, 6.0));
        let wo = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        let wi = random.direction();
        let wi = wi.with_z(wi.z.abs());
        let (m, lobes) = (prepare(&material, wo), prepare(&bare, wo));
        let node = |i, j, k| Vec3::from_array(material.factor_node(i, j, k).unwrap()).as_dvec3();
        let want = oracle::factor(([5, 4, 1], false), node, wo.as_dvec3(), wi.as_dvec3())
            * lobes.evaluate(wi).as_dvec3();
        let (got, scale) = (m.evaluate(wi), f64::from(6.0 * lobes.evaluate(wi).abs().max_element()));
        assert!((got.as_dvec3() - want).abs().max_element() <= 6e-6 * scale, "{wo} {wi}: {got}, {want}");
        assert_eq!(m.pdf(wi), lobes.pdf(wi));

        // The albedo difference in f64, from the angles of the documentation, beside the albedo of the lobes.
        let theta = f64::from(wo.x).hypot(f64::from(wo.y)).atan2(f64::from(wo.z));
        let within = (1..3).rev().find(|&r| f64::from(THETAS[r]) <= theta).unwrap_or(0);
        let (from, to) = (f64::from(THETAS[within]), f64::from(THETAS[within + 1]));
        let outward = ((theta - from) / (to - from)).min(1.0);
        let along = f64::from(wo.y).atan2(f64::from(wo.x)).rem_euclid(TAU) / TAU * 6.0;
        let stored = |ring: usize, place: usize| {
            let view = if ring == 0 { 0 } else { 1 + (ring - 1) * 3 + place % 3 };
            Vec3::from_array(differences[view]).as_dvec3()
        };
        let ring = |ring| stored(ring, along as usize).lerp(stored(ring, along as usize + 1), along.fract());
        let albedo = made.truth(wo.as_dvec3(), wi.as_dvec3()).1;
        let power = albedo.dot(DVec3::from_array(LUMINANCE.map(f64::from)));
        let want = albedo + power * ring(within).lerp(ring(within + 1), outward);
        let off = (m.albedo().as_dvec3() - want).abs().max_element();
        assert!(off < 1e-4 * (albedo.abs().max_element() + power), "{wo}: {}, {want}", m.albedo());
    }
}

#[test]
fn what_has_no_place_in_a_material_is_refused_with_its_name() {
    fn error(azimuths: usize, turns: usize, change: impl Fn(&mut Made)) -> String {
        let mut made = Made::new(1, azimuths, turns, 10.0);
        change(&mut made);
        let views: Vec<GridView> = made.views.iter().map(view).collect();
        let grid = Grid {
            thetas: &THETAS,
            azimuths: made.azimuths,
            turns,
            axis: made.axis,
            views: &views,
            squeezed: SQUEEZED,
            factors: None,
        };
        let mut bytes = vec![0; grid.encoded_len("")];
        grid.encode("", &mut bytes).unwrap_err().to_string()
    }
    assert!(error(65, 1, |_| {}).contains("ring"));
    assert!(error(4, 3, |_| {}).contains("turns"));
    assert!(error(4, 0, |_| {}).contains("turns"));
    assert!(error(1, 4, |_| {}).contains("ring"));
    for axis in [-0.1, 3.2, f32::NAN] {
        assert!(error(4, 1, |m| m.axis = axis).contains("axis"), "{axis}");
    }
    assert!(error(4, 1, |m| m.azimuths = 5).contains("views"));
    assert!(error(4, 1, |m| m.azimuths = usize::MAX).contains("views"));
    assert!(error(4, 1, |m| m.views[7].2.truncate(2)).contains("lobes"));
    for (bad, name) in
        [([7.0, 0.0, 0.0], "squeeze"), ([0.0, 6.0, -2.0], "squeeze"), ([0.0, f32::NAN, 0.0], "squeeze")]
    {
        assert!(error(4, 1, |m| m.views[3].0 = bad).contains(name), "{bad:?}");
    }
    assert!(error(4, 1, |m| m.views[2].1[0] = 3.0).contains("diffuse"));
    assert!(error(4, 1, |m| m.views[2].2[1].tilt = [3.0, 1.0]).contains("axis"));
    assert!(error(4, 1, |m| m.views[2].2[1].tilt = [0.0, f32::NAN]).contains("axis"));
    assert!(error(4, 1, |m| m.views[2].1[2] = f32::NAN).contains("diffuse"));
    assert!(error(4, 1, |m| m.views[2].2[1].color_differences[1] = 16.1).contains("amplitude"));
    assert!(error(4, 1, |m| m.views[2].2[1].log2_sharpness = 27.0).contains("sharpness"));
    assert!(error(4, 1, |m| m.views[2].2[1].log2_luminance = f32::INFINITY).contains("amplitude"));
}

#[test]
fn every_flipped_bit_is_refused_and_with_a_right_checksum_refused_or_usable() {
    let bytes = Made::new(2, 3, 1, 10.0).encode();
    for length in 0..bytes.len() {
        assert!(Material::from_bytes(&bytes[..length]).is_err(), "cut at {length}");
    }
    let (mut refused, mut usable) = (0, 0);
    let end = bytes.len() - 4;
    for at in 0..bytes.len() {
        for flip in [1u8, 2, 4, 8, 16, 32, 64, 128, 255] {
            let mut damaged = bytes.clone();
            damaged[at] ^= flip;
            assert!(Material::from_bytes(&damaged).is_err(), "flipped {flip} at {at}");
            if at >= end {
                continue;
            }
            let sum = crc32fast::hash(&damaged[..end]).to_le_bytes();
            damaged[end..].copy_from_slice(&sum);
            let Ok(material) = Material::from_bytes(&damaged) else {
                refused += 1;
                continue;
            };
            usable += 1;
            for (theta, phi) in [(0.0, 0.0), (0.7, 1.0), (1.5, 4.0)] {
                let mut m = Mixture::<64>::empty();
                material.prepare(direction(theta, phi), &mut m).unwrap();
                let value = m.evaluate(Vec3::new(0.6, 0.0, 0.8));
                assert!(!value.is_nan() && !m.pdf(Vec3::Z).is_nan(), "{flip} at {at}");
                if let Some(s) = m.sample([0.3, 0.6, 0.9]) {
                    assert!(!s.direction.is_nan() && s.pdf > 0.0, "{flip} at {at}");
                }
            }
        }
    }
    assert!(refused > 1000 && usable > 1000, "{refused} refused, {usable} usable");
}

#[test]
fn a_mixture_that_held_more_lobes_forgets_them() {
    let _guard = LEVEL.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let before = Level::current();
    let bytes = Made::new(13, 4, 1, 8.0).encode();
    let few = Material::from_bytes(&bytes).unwrap();
    let many = Material::from_bytes(include_bytes!("../../presets/garnet_red.srbf")).unwrap();
    assert!(many.lobe_count() > 8 && few.lobe_count() < 8, "a vector of 8 lanes more than is needed");
    for level in levels() {
        level.set().unwrap();
        let mut random = Random(13);
        let mut m = Mixture::<16>::empty();
        for _ in 0..100 {
            let (wo, wi) = (random.direction(), random.direction());
            many.prepare(wo.with_z(wo.z.abs()), &mut m).unwrap();
            few.prepare(wo, &mut m).unwrap();
            let fresh = prepare(&few, wo);
            assert_eq!(m.evaluate_and_pdf(wi), fresh.evaluate_and_pdf(wi), "{level:?}, {wo}, {wi}");
            assert_eq!(m.pdf(wi), fresh.pdf(wi), "{level:?}, {wo}, {wi}");
            let u = random.three();
            assert_eq!(m.sample(u), fresh.sample(u), "{level:?}, {wo}, {u:?}");
        }
    }
    before.set().unwrap();
}

#[test]
fn every_level_gives_the_f64_values_one_by_one_in_batches_and_in_pairs() {
    let _guard = LEVEL.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let before = Level::current();
    for level in levels() {
        level.set().unwrap();
        let mut worst = 0f64;
        for (seed, azimuths, turns) in [(3, 5, 1), (4, 4, 2), (5, 1, 1), (6, 8, 1), (7, 4, 4), (8, 2, 4)] {
            let made = Made::new(seed, azimuths, turns, 9.0);
            let bytes = made.encode();
            let material = Material::from_bytes(&bytes).unwrap();
            let mut random = Random(seed);
            let n = 40;
            let mut wo: Vec<Vec3> = (0..n).map(|_| random.direction()).map(|d| d.with_z(d.z.abs())).collect();
            wo[0] = Vec3::Z;
            wo[1] = direction(0.5, 0.0);
            wo[2] = direction(0.3, -1e-7);
            let wi: Vec<Vec3> = (0..n)
                .map(|i| {
                    let near = Vec3::new(-wo[i].x, -wo[i].y, wo[i].z) + 0.3 * random.direction();
                    near.with_z(near.z.abs()).normalize()
                })
                .collect();
            let split = |v: &[Vec3]| [0, 1, 2].map(|i| v.iter().map(|d| d[i]).collect::<Vec<f32>>());
            let (wo_split, wi_split) = (split(&wo), split(&wi));
            fn slices(v: &[Vec<f32>; 3]) -> [&[f32]; 3] {
                [&v[0], &v[1], &v[2]]
            }
            let mut pairs = [(); 4].map(|()| vec![0.0; n]);
            let [r, g, b, pdf] = &mut pairs;
            material
                .ask(
                    slices(&wo_split),
                    Towards { wi: slices(&wi_split), value: Some([r, g, b]), pdf: Some(pdf) }.into(),
                )
                .unwrap();
            for i in 0..n {
                let m = prepare(&material, wo[i]);
                let (value, albedo) = made.truth(wo[i].as_dvec3(), wi[i].as_dvec3());
                let mut batch = [(); 3].map(|()| vec![0.0; n]);
                let [r, g, b] = &mut batch;
                m.ask(Towards { wi: slices(&wi_split), value: Some([r, g, b]), pdf: None }.into()).unwrap();
                let one = m.evaluate(wi[i]);
                let peak = value.max_element();
                for c in 0..3 {
                    for found in [one[c], batch[c][i], pairs[c][i]] {
                        // Sharpness 2^9.5: a rounding of axis and azimuth moves the value by 1e-7 sqrt(2 s t).
                        let error = (f64::from(found) - value[c]).abs() / (value[c] + 1e-3 * peak);
                        worst = worst.max(error);
                        assert!(
                            error < 4e-5,
                            "{}: wo {} wi {}: {found} {}",
                            level.name(),
                            wo[i],
                            wi[i],
                            value[c]
                        );
                    }
                    let error = (f64::from(m.albedo()[c]) / albedo[c] - 1.0).abs();
                    assert!(error < 1e-5, "albedo at {}: {} {}", wo[i], m.albedo()[c], albedo[c]);
                }
            }
        }
        println!("level {}: worst relative error {worst:.1e}", level.name());
    }
    before.set().unwrap();
}

/// Materials in codes give the values of their plain numbers at every level, and those are near to the numbers of the whole.
#[test]
fn codes_are_what_they_unpack_to() {
    let _guard = LEVEL.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let before = Level::current();
    for (seed, azimuths, turns) in [(3, 5, 1), (4, 4, 2), (7, 4, 4)] {
        let whole = Material::from_bytes(Made::new(seed, azimuths, turns, 9.0).encode()).unwrap();
        for (bits, channels) in [(8, 3), (8, 1), (16, 3), (16, 1)] {
            let options = PackOptions { bits, channels };
            let mut bytes = vec![0; whole.packed_len(options, TEXT)];
            assert_eq!(whole.pack(options, TEXT, &mut bytes), Ok(bytes.len()));
            assert!(bytes.len() < whole.bytes().len() * 2 / 3, "{options:?}");
            let small = Material::from_bytes(bytes).unwrap();
            let mut bytes = vec![0; small.unpacked_len()];
            assert_eq!(small.unpack(&mut bytes), Ok(whole.bytes().len()));
            let plain = Material::from_bytes(bytes).unwrap();
            assert_eq!((small.code_bits(), plain.code_bits()), (Some(bits), None));
            assert_eq!(small.grid_turns(), whole.grid_turns());
            for v in 0..whole.view_count() {
                assert_eq!(small.view_log2_squeeze_matrix(v), plain.view_log2_squeeze_matrix(v));
                assert!((small.view_theta(v).unwrap() - whole.view_theta(v).unwrap()).abs() < 2e-5);
                assert_eq!(small.view_azimuth(v), whole.view_azimuth(v));
                for k in 0..LOBES {
                    let [a, b, c] = [&small, &plain, &whole].map(|m| m.view_tilted_lobe(v, k).unwrap());
                    assert_eq!(a, b);
                    // Half a step of the range of tilts and of the sharpness, and what rounding leaves of the scale.
                    let most = if bits == 8 { 0.51 / 255.0 } else { 0.51 / 65_535.0 };
                    let near = |a: f32, c: f32, range: f32| (a - c).abs() <= most * 1.1 * range + 2e-5;
                    assert!((0..2).all(|i| near(a.tilt[i], c.tilt[i], 2.0)), "{options:?} {a:?} {c:?}");
                    assert!(near(a.log2_sharpness, c.log2_sharpness, 1.2), "{options:?} {a:?} {c:?}");
                    if channels == 1 {
                        assert_eq!(a.color_differences, [0.0; 2]);
                    }
                }
            }
            for level in levels() {
                level.set().unwrap();
                let mut random = Random(seed);
                for _ in 0..40 {
                    let (wo, wi) = (random.direction(), random.direction());
                    let (wo, u) = (wo.with_z(wo.z.abs()), random.three());
                    let (a, b) = (prepare(&small, wo), prepare(&plain, wo));
                    assert_eq!(
                        a.evaluate_and_pdf(wi),
                        b.evaluate_and_pdf(wi),
                        "{level:?} {options:?} {wo} {wi}"
                    );
                    assert_eq!((a.sample(u), a.albedo()), (b.sample(u), b.albedo()), "{level:?} {options:?}");
                    let hit = |m: &Material<Vec<u8>>| m.sample_and_evaluate(wo, u, wi);
                    assert_eq!(hit(&small), hit(&plain), "{level:?} {options:?} {wo} {wi}");
                }
            }
            // Cut off, and with other heads of the block.
            for end in (0..small.bytes().len()).step_by(7) {
                assert!(Material::from_bytes(&small.bytes()[..end]).is_err(), "{end}");
            }
            for (at, value) in [(48, 9), (49, 2), (50, 1), (44, 1), (40, b'Q')] {
                let mut damaged = small.bytes().to_vec();
                damaged[at] = value;
                assert!(Material::from_bytes(damaged).is_err(), "{at}");
            }
        }
    }
    before.set().unwrap();
}

#[test]
fn samples_follow_the_density_and_their_weights_the_albedo() {
    let jobs: Vec<(u64, f32)> = (0..12).map(|i| (i, 0.13 * i as f32)).collect();
    let level = sidak(0.01, jobs.len());
    for (seed, theta) in jobs {
        let bytes = Made::new(seed, 4, 1 + seed as usize % 2, 10.0).encode();
        let material = Material::from_bytes(&bytes).unwrap();
        let m = prepare(&material, direction(theta, 2.4 * seed as f32));
        let partition = Partition::new(&m, |d| m.pdf(d));
        assert!(
            (partition.total() - 1.0).abs() < 5e-5,
            "{seed}: the density integrates to {}",
            partition.total()
        );
        let mut random = Random(100 + seed);
        let (mut sum, mut square, n) = (DVec3::ZERO, DVec3::ZERO, 100_000);
        let result = partition.test(n, || {
            let sample = m.sample(random.three()).expect("the mixture is not black");
            let weight = sample.weight.as_dvec3();
            sum += weight;
            square += weight * weight;
            sample.direction
        });
        assert!(result.p > level, "{seed}: p = {:e}, level {level:e}", result.p);
        let mean = sum / n as f64;
        let error = ((square / n as f64 - mean * mean) / n as f64).max(DVec3::ZERO).map(f64::sqrt);
        let off = (mean - m.albedo().as_dvec3()).abs();
        assert!(off.cmple(4.5 * error + 1e-5 * mean).all(), "{seed}: {mean} {} +- {error}", m.albedo());
    }
}

/// The same of a fit, at six angles by four turns of the sample.
#[test]
fn a_fit_is_drawn_by_its_density_at_every_angle_and_turn() {
    let content = srbf_fit::read::read("model:ggx:alpha_x=0.15,alpha_y=0.4,f0=0.9".as_ref()).unwrap().content;
    let view_angles = Some(vec![0.0, 0.5, 1.0, 1.4]);
    // With factors the albedo is interpolated, and weights vary.
    let factors = srbf_fit::FactorNodes::None;
    let few = srbf_fit::Settings { lobes: 6, starts: 1, steps: 10, ..Default::default() };
    let fit =
        srbf_fit::fit_content(&content, &srbf_fit::Settings { view_angles, factors, ..few }, |_| {}).unwrap();
    let material = Material::from_bytes(fit.bytes).unwrap();
    let views: Vec<(f32, f32)> =
        (0..24).map(|n| (0.12 + 0.23 * (n % 6) as f32, 0.3 + 1.57 * (n / 6) as f32)).collect();
    let (level, draws, mut random) = (sidak(0.01, views.len()), 100_000, Random(62));
    let srbf_fit::read::Content::Evaluable(model) = &content else { panic!("a model") };
    let mut energy = 0f64;
    for (theta, phi) in views {
        let m = prepare(&material, direction(theta, phi));
        let partition = Partition::new(&m, |d| m.pdf(d));
        assert!((partition.total() - 1.0).abs() < 5e-5, "{theta} {phi}: {}", partition.total());
        // A white furnace: light from everywhere comes back as the albedo says, and no more than falls on it.
        let furnace = Partition::new(&m, |d| m.evaluate(d).x).total();
        assert!((furnace / f64::from(m.albedo().x) - 1.0).abs() < 5e-5, "{theta} {phi}: {furnace}");
        assert!(furnace < 1.0, "{theta} {phi}: {furnace}");
        let (mut sum, mut square, mut largest, mut truth) = (0.0, 0.0, 0f64, 0.0);
        let wo = direction(theta, phi).as_dvec3().to_array();
        let result = partition.test(draws, || {
            let sample = m.sample(random.three()).expect("the mixture is not black");
            let weight = f64::from(sample.weight.x);
            (sum, square, largest) = (sum + weight, square + weight * weight, largest.max(weight));
            let wi = sample.direction.as_dvec3();
            truth += model.evaluate(wi.to_array(), wo)[0] * wi.z / f64::from(sample.pdf);
            sample.direction
        });
        energy = energy.max((truth / sum - 1.0).abs());
        assert!(result.p > level, "{theta} {phi}: p = {:e}, level {level:e}", result.p);
        assert!(largest < 20.0, "{theta} {phi}: a weight of {largest}");
        let (n, albedo) = (draws as f64, f64::from(m.albedo().x));
        let mean: f64 = sum / n;
        let error = (square / n - mean * mean).max(0.0).sqrt() / n.sqrt();
        assert!(
            (mean - albedo).abs() < 4.5 * error + 1e-5 * mean,
            "{theta} {phi}: {mean} {albedo} +- {error}"
        );
    }
    println!("energy off by {:.2} %", 100.0 * energy);
    assert!(energy < 0.01, "{energy}");
}

#[test]
fn mixtures_are_continuous_in_the_outgoing_direction() {
    let mut worst = 0f32;
    for (seed, azimuths, turns) in [(7, 6, 1), (8, 4, 2), (9, 1, 1), (12, 3, 4)] {
        let bytes = Made::new(seed, azimuths, turns, 9.0).encode();
        let material = Material::from_bytes(&bytes).unwrap();
        let mut random = Random(seed);
        let mut directions: Vec<Vec3> =
            (0..60).map(|_| random.direction()).map(|d| d.with_z(d.z.abs())).collect();
        let step = std::f32::consts::TAU / (azimuths * turns) as f32;
        for theta in [0.0, 1e-6, 1e-3, 0.2, 0.5, 0.7, 1.0, 1.4, 1.55] {
            for phi in
                [0.0, step, 2.0 * step, 0.5 * step, std::f32::consts::PI, -std::f32::consts::FRAC_PI_2, 0.3]
            {
                let here = prepare(&material, direction(theta, phi));
                directions.truncate(60);
                directions.extend((0..60).filter_map(|_| here.sample(random.three())).map(|s| s.direction));
                let value = |m: &Mixture<16>, d: Vec3| m.evaluate(d).max_element();
                let peak = directions.iter().map(|&d| value(&here, d)).fold(0.0, f32::max);
                for (tilt, turn) in [(1e-4f32, 0.0f32), (-1e-4, 0.0), (0.0, 1e-4), (0.0, -1e-4), (1e-5, 2.0)]
                {
                    // Round the normal any turn is a small step.
                    let turn = if theta < 1e-5 { 1e4 * turn } else { turn.min(1e-4) };
                    let there = prepare(&material, direction((theta + tilt).max(0.0), phi + turn));
                    let moved = directions
                        .iter()
                        .map(|&d| (value(&here, d) - value(&there, d)).abs() / peak)
                        .fold(0.0, f32::max);
                    worst = worst.max(moved);
                    // Random neighbours differ by up to a lobe's width times ten over a step of the grid: slopes of 100.
                    assert!(moved < 0.01, "theta {theta} phi {phi}, tilt {tilt} turn {turn}: {moved}");
                }
            }
        }
    }
    println!("largest change over 1e-4: {worst:.1e} of the peak");
}

#[test]
fn at_the_normal_every_azimuth_gives_one_mixture() {
    let bytes = Made::new(10, 4, 1, 12.0).encode();
    let material = Material::from_bytes(&bytes).unwrap();
    let normal = prepare(&material, Vec3::Z);
    let mut random = Random(10);
    for i in 0..64 {
        let phi = std::f32::consts::TAU * i as f32 / 64.0;
        // So close that the ring has no share that f32 could see.
        let m = prepare(&material, Vec3::new(1e-12 * phi.cos(), 1e-12 * phi.sin(), 1.0));
        for _ in 0..50 {
            let d = random.direction();
            let d = d.with_z(d.z.abs());
            let (a, b) = (normal.evaluate(d), m.evaluate(d));
            // An axis rounded after a turn: 1e-7 sqrt(2 s t) at s = 2^12.5, t up to 20.
            assert!((a - b).abs().max_element() <= 1e-4 * a.max_element(), "{phi} {d}: {a} {b}");
        }
    }
}

#[test]
fn pairs_are_sampled_as_the_mixtures_one_by_one() {
    let bytes = Made::new(11, 5, 1, 8.0).encode();
    let material = Material::from_bytes(&bytes).unwrap();
    let mut random = Random(11);
    let n = 37;
    let wo: Vec<Vec3> = (0..n).map(|_| random.direction()).collect();
    let u: Vec<[f32; 3]> = (0..n).map(|_| random.three()).collect();
    let column = |i: usize| wo.iter().map(|d| d[i]).collect::<Vec<f32>>();
    let number = |i: usize| u.iter().map(|d| d[i]).collect::<Vec<f32>>();
    let ([x, y, z], [u0, u1, u2]) = ([0, 1, 2].map(column), [0, 1, 2].map(number));
    let mut out = [(); 7].map(|()| vec![f32::NAN; n]);
    let [dx, dy, dz, pdf, r, g, b] = &mut out;
    let samples =
        Draws { u: [&u0, &u1, &u2], direction: [dx, dy, dz], pdf: Some(pdf), weight: Some([r, g, b]) };
    material.ask([&x, &y, &z], samples.into()).unwrap();
    let mut mixtures = vec![Mixture::<16>::empty(); n];
    material.prepare_into([&x, &y, &z], &mut mixtures).unwrap();
    for i in 0..n {
        let m = prepare(&material, wo[i]);
        assert!((mixtures[i].power() - m.power()).abs() <= 1e-5 * m.power());
        match m.sample(u[i]) {
            None => assert_eq!((wo[i].z < 0.0, out[3][i]), (true, 0.0)),
            Some(sample) => {
                let d = Vec3::new(out[0][i], out[1][i], out[2][i]);
                assert!((sample.direction - d).length() < 1e-5, "{i}: {} {d}", sample.direction);
                assert!((out[3][i] / sample.pdf - 1.0).abs() < 1e-3, "{i}");
            }
        }
    }
}
