//! Materials with a table of factors, against the f64 of its definition; factors that have no place in one; and weights within their bound.

use glam::{DVec3, Vec3};
use srbf_core::{
    Defensive, Draws, Error, FactorTable, FormatError, LeaveOut, Line, Material, Mixture, PlaneLobe,
    PrepareOptions, Sample, Towards, View, luminance,
};
use srbf_tests::attack::put_right;
use srbf_tests::inputs::{Random, levels};
use srbf_tests::oracle;
use srbf_tests::seeds::same_without_azimuth;
use srbf_tests::tolerance::SLACK;

const THETAS: [f32; 3] = [0.0, 0.6, 1.5];
const LOBES: usize = 5;
/// Allowed error of a factor, relative to the largest of its table.
const FACTOR: f64 = 6e-6;
const PROVENANCE: &str = "test, made by tests/factors.rs";

/// The parts of a material, so that it can be made without its factors too.
struct Made {
    lobes: Vec<Vec<PlaneLobe>>,
    nodes: [usize; 3],
    is_signed: bool,
    factors: Vec<[f32; 3]>,
    albedo_differences: Vec<[f32; 3]>,
}

impl Made {
    fn new(seed: u64, nodes: [usize; 3]) -> Self {
        let mut random = Random(seed);
        let lobe = |random: &mut Random, theta: f32, k: usize| PlaneLobe {
            angle: if theta > 0.0 { theta + random.between(-0.2, 0.2) } else { 0.0 },
            off_plane: if theta > 0.0 && k == LOBES - 1 { random.between(0.1, 0.4) } else { 0.0 },
            log2_sharpness: 2.0 * k as f32,
            log2_luminance: 2.0 * k as f32 - 5.0,
            color_differences: [random.between(-0.9, 1.0), random.between(-0.9, 1.0)],
        };
        let lobes = THETAS.map(|theta| (0..LOBES).map(|k| lobe(&mut random, theta, k)).collect()).into();
        let count = nodes.iter().product();
        let mut factors: Vec<[f32; 3]> = (0..count).map(|_| random.three().map(|x| 8.0 * x)).collect();
        same_without_azimuth(&mut factors, nodes[0], nodes[1]);
        let albedo_differences = THETAS.map(|_| [0, 1, 2].map(|_| random.between(-1.0, 2.0))).into();
        Self { lobes, nodes, is_signed: false, factors, albedo_differences }
    }

    fn table(&self) -> FactorTable<'_> {
        let Self {
            nodes: [half, difference, azimuth], is_signed, ref factors, ref albedo_differences, ..
        } = *self;
        FactorTable { half, difference, azimuth, is_signed, factors, albedo_differences }
    }

    fn try_encode(&self, factors: Option<FactorTable<'_>>) -> Result<Vec<u8>, FormatError> {
        let view = |(lobes, theta): (&Vec<PlaneLobe>, f32)| View {
            theta,
            log2_squeeze: -0.8 * theta,
            log2_diffuse: -3.0,
            diffuse_color_differences: [0.2, -0.3],
            lobes: lobes.clone().leak(),
        };
        let views: Vec<View> = self.lobes.iter().zip(THETAS).map(view).collect();
        let line = Line { views: &views, squeezed: 2, mirrored: 1, factors };
        let mut bytes = vec![0; line.encoded_len(PROVENANCE)];
        assert!(line.encode(PROVENANCE, &mut bytes)? == bytes.len());
        Ok(bytes)
    }

    /// With factors, and without.
    fn encode(&self) -> [Vec<u8>; 2] {
        [Some(self.table()), None].map(|factors| self.try_encode(factors).unwrap())
    }
}

/// A factor from the nodes that a material gives, in f64.
fn truth(material: &Material<impl AsRef<[u8]>>, wo: Vec3, wi: Vec3) -> DVec3 {
    let node = |i, j, k| Vec3::from_array(material.factor_node(i, j, k).unwrap()).as_dvec3();
    oracle::factor(
        (material.factor_nodes().unwrap(), material.has_signed_factors()),
        node,
        wo.as_dvec3(),
        wi.as_dvec3(),
    )
}

fn at(theta: f32, phi: f32) -> Vec3 {
    Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos().max(0.0))
}

/// Pairs everywhere, and where something could go wrong: equal, mirrored, at the normal and beside it, grazing, opposite at grazing.
fn pairs(random: &mut Random) -> Vec<[Vec3; 2]> {
    let up = |d: Vec3| Vec3::new(d.x, d.y, d.z.abs());
    let mut pairs: Vec<[Vec3; 2]> =
        (0..3000).map(|_| [up(random.direction()), up(random.direction())]).collect();
    for theta in [0.0, 1e-20, 1e-7, 1e-3, 0.4, 1.2, 1.57, std::f32::consts::FRAC_PI_2] {
        for phi in [0.0, 0.7, 3.0] {
            let wo = at(theta, phi);
            for by in [0.0, 1e-30, 1e-12, 1e-7, 1e-5, 1e-3, 0.1] {
                let aside = Vec3::new(by, -0.3 * by, 0.0);
                for wi in [wo, Vec3::new(-wo.x, -wo.y, wo.z), Vec3::Z, Vec3::new(wo.y, -wo.x, wo.z)] {
                    let wi = up((wi + aside).normalize());
                    // Opposite at the horizon there is no half direction.
                    if (wo + wi).length() > 1e-14 {
                        pairs.push([wo, wi]);
                    }
                }
            }
        }
    }
    for height in [1e-20, 1e-9, 1e-7, 1e-5, 1e-3] {
        pairs.push([Vec3::new(1.0, 0.0, height), Vec3::new(-1.0, 0.0, 0.0)]);
        pairs.push([Vec3::new(0.6, 0.8, height), Vec3::new(-0.6, -0.8, 0.5 * height)]);
    }
    pairs
}

#[test]
fn what_was_written_is_read() {
    for (nodes, is_signed) in [([2, 2, 1], false), ([7, 3, 2], true), ([32, 32, 3], false), ([5, 9, 8], true)]
    {
        let made = Made { is_signed, ..Made::new(1, nodes) };
        let count = nodes.iter().product::<usize>();
        let [bytes, plain] = made.encode();
        assert_eq!(bytes.len(), plain.len() + 8 + (4 + 4 * (9 + 1) + 3 * count).next_multiple_of(4));
        let (material, plain) =
            (Material::from_bytes(&bytes).unwrap(), Material::from_bytes(&plain).unwrap());
        assert_eq!((material.factor_nodes(), plain.factor_nodes()), (Some(nodes), None));
        assert_eq!((material.has_signed_factors(), plain.has_signed_factors()), (is_signed, false));
        assert_eq!((material.factor_len(), plain.factor_len()), (4 * (9 + 1) + 3 * count, 0));
        assert_eq!((material.provenance(), plain.provenance()), (PROVENANCE, PROVENANCE));
        let largest = made.factors.iter().flatten().fold(0f32, |a, b| a.max(*b));
        for n in 0..count {
            let (i, j, k) = (n / nodes[1] % nodes[0], n % nodes[1], n / (nodes[0] * nodes[1]));
            let (got, want) = (material.factor_node(i, j, k).unwrap(), made.factors[n]);
            for c in 0..3 {
                let apart = (got[c].sqrt() - want[c].sqrt()).abs();
                assert!(apart < 0.50001 / 255.0 * largest.sqrt(), "{i}, {j}, {k}: {got:?}, {want:?}");
            }
        }
        assert_eq!((material.largest_factor(), plain.largest_factor()), (largest, 1.0));
        for past in [[nodes[0], 0, 0], [0, nodes[1], 0], [0, 0, nodes[2]], [usize::MAX, 0, 0]] {
            assert_eq!(material.factor_node(past[0], past[1], past[2]), None);
        }
        assert_eq!((plain.factor_node(0, 0, 0), plain.view_albedo_difference(0)), (None, None));
        assert_eq!(plain.factor(Vec3::Z, Vec3::Z), Vec3::ONE);
        for view in 0..4 {
            assert_eq!(material.view_albedo_difference(view), made.albedo_differences.get(view).copied());
        }
    }
}

#[test]
fn factors_are_those_of_the_definition_and_symmetric_without_a_sign() {
    let mut worst = 0f64;
    let tables = [
        (2, [32, 32, 1], false),
        (3, [2, 2, 1], false),
        (4, [9, 24, 5], false),
        (5, [32, 32, 8], false),
        (6, [9, 24, 5], true),
        (7, [32, 32, 8], true),
        (8, [4, 6, 2], true),
    ];
    for (seed, nodes, is_signed) in tables {
        let [bytes, _] = Made { is_signed, ..Made::new(seed, nodes) }.encode();
        let material = Material::from_bytes(&bytes).unwrap();
        let largest = f64::from(material.largest_factor());
        let mut apart = 0f64;
        for [wo, wi] in pairs(&mut Random(5)) {
            let got = material.factor(wo, wi);
            let error = (got.as_dvec3() - truth(&material, wo, wi)).abs().max_element() / largest;
            assert!(error < FACTOR, "{nodes:?}, wo {wo}, wi {wi}: {got}, off by {error:e}");
            let exchanged = material.factor(wi, wo);
            apart = apart.max(f64::from((got - exchanged).abs().max_element()) / largest);
            assert!(is_signed || (got - exchanged).abs().max_element() < 2e-5 * largest as f32, "{wo} {wi}");
            worst = worst.max(error);
        }
        assert_eq!(apart > 0.1, is_signed, "{nodes:?}: {apart}");
        // Opposite at the horizon there is no half direction.
        let got = material.factor(Vec3::X, -Vec3::X);
        assert!(got.min_element() >= 0.0 && got.max_element() <= 1.00001 * largest as f32, "{got}");
    }
    println!("worst error of a factor: {worst:e} of the largest");
    assert!(worst > FACTOR / SLACK, "the bound is stale: {worst:e}");
}

#[test]
fn factors_are_continuous_across_the_borders_of_nodes() {
    let [bytes, _] = Made::new(6, [32, 32, 1]).encode();
    let material = Material::from_bytes(&bytes).unwrap();
    // Steps of 2e-4 along an arc through the mirror direction, the outgoing one and the horizon: the steepest is the fourth root at 0.
    let wo = at(0.7, 0.0);
    let mut before: Option<(f32, Vec3)> = None;
    let mut borders = 0;
    for step in -7800..7800 {
        let theta = 2e-4 * step as f32;
        let (got, want) = (material.factor(wo, at(theta, 0.0)), truth(&material, wo, at(theta, 0.0)));
        assert!((got.as_dvec3() - want).abs().max_element() < 2e-4, "{theta}: {got}, {want}");
        let place = ((theta - 0.7).abs() / 2.0).sin() * 31.0;
        if let Some((place_before, factor)) = before {
            borders += usize::from(place_before.floor() != place.floor());
            // Near the mirror direction a is sqrt(|theta + 0.7| / 2 / sqrt(2)), times 31 nodes that differ by up to 8.
            let steep = (theta + 0.7).abs().max(2e-4).sqrt().recip() * 2e-4 * 150.0 + 0.05;
            assert!((got - factor).abs().max_element() < steep + 1.5, "{theta}: {got}, {factor}");
        }
        before = Some((place, got));
    }
    assert!(borders > 20, "{borders}");
}

/// Value of a mixture with factors towards directions, by every way that gives it.
fn all_values(m: &Mixture<16>, d: &[Vec3]) -> [Vec<Vec3>; 3] {
    let arrays = [0, 1, 2].map(|i| d.iter().map(|d| d[i]).collect::<Vec<f32>>());
    let [x, y, z] = &arrays;
    let mut value = [(); 3].map(|()| vec![0.0; d.len()]);
    let [red, green, blue] = &mut value;
    m.ask(Towards { wi: [x, y, z], value: Some([red, green, blue]), pdf: None }.into()).unwrap();
    let batch = (0..d.len()).map(|i| Vec3::new(value[0][i], value[1][i], value[2][i])).collect();
    let one = d.iter().map(|d| m.evaluate(*d)).collect();
    let both = d.iter().map(|d| m.evaluate_and_pdf(*d).0).collect();
    [one, both, batch]
}

#[test]
fn values_are_those_of_the_lobes_times_the_factor_and_densities_those_of_the_lobes() {
    let [bytes, plain] = Made::new(7, [32, 20, 3]).encode();
    let (material, plain) = (Material::from_bytes(&bytes).unwrap(), Material::from_bytes(&plain).unwrap());
    let mut random = Random(8);
    for level in levels() {
        for [wo, _] in pairs(&mut random).into_iter().step_by(41) {
            let (mut m, mut bare) = (Mixture::<16>::empty(), Mixture::<16>::empty());
            let leave_out = LeaveOut::new(if random.uniform() < 0.5 { 0.0 } else { 0.02 }, 1e-7).unwrap();
            let options = PrepareOptions { leave_out, level: Some(level) };
            material.prepare_with(wo, options, &mut m).unwrap();
            plain.prepare_with(wo, options, &mut bare).unwrap();
            assert!(m.has_factors() && !bare.has_factors());
            assert_eq!((m.factor_bytes().len(), bare.factor_bytes().len()), (3 * 3 * 32 * 20 + 2, 0));
            assert_eq!((m.power(), m.diffuse(), m.len()), (bare.power(), bare.diffuse(), bare.len()));
            let d: Vec<Vec3> = (0..37).map(|_| random.direction()).collect();
            let (got, lobes) = (all_values(&m, &d), all_values(&bare, &d));
            for (got, lobes) in got.iter().zip(&lobes) {
                for (i, d) in d.iter().enumerate() {
                    let want =
                        if d.z < 0.0 { DVec3::ZERO } else { lobes[i].as_dvec3() * truth(&material, wo, *d) };
                    let scale = f64::from(8.0 * lobes[i].abs().max_element());
                    let off = (got[i].as_dvec3() - want).abs().max_element();
                    assert!(off <= 2e-5 * scale, "{level:?}, wo {wo}, wi {d}: {}, {want}", got[i]);
                    assert_eq!(m.pdf(*d), bare.pdf(*d));
                }
            }
            check_samples(&m, &bare, &mut random);
        }
    }
}

/// Samples are those of the lobes, with the factor in value and weight, and the weight within its bound.
fn check_samples(m: &Mixture<16>, bare: &Mixture<16>, random: &mut Random) {
    const N: usize = 50;
    // Of the largest code below 8 of the table.
    let (u, largest): (Vec<[f32; 3]>, f32) = ((0..N).map(|_| random.three()).collect(), 8.01);
    let check = |got: Sample, want: Sample, share: f32| {
        assert_eq!((got.direction, got.pdf), (want.direction, want.pdf));
        assert!(
            (got.weight * got.pdf - m.evaluate(got.direction)).abs().max_element()
                <= 2e-5 * largest * want.pdf * want.weight.max_element()
        );
        assert!(luminance(got.weight) <= m.power() * largest * 1.00001 / (1.0 - share));
    };
    let (defensive, bare_one) = (Defensive::new(m, 0.1).unwrap(), Defensive::new(bare, 0.1).unwrap());
    for &u in &u {
        let (Some(got), Some(want)) = (m.sample(u), bare.sample(u)) else { continue };
        check(got, want, 0.0);
        check(defensive.sample(u), bare_one.sample(u), 0.1);
    }
    let u = [0, 1, 2].map(|i| u.iter().map(|u| u[i]).collect::<Vec<f32>>());
    let draw = |m: &Mixture<16>| {
        let mut out = [(); 7].map(|()| vec![0.0; N]);
        let [x, y, z, pdf, red, green, blue] = &mut out;
        let samples = Draws {
            u: [&u[0], &u[1], &u[2]],
            direction: [x, y, z],
            pdf: Some(pdf),
            weight: Some([red, green, blue]),
        };
        m.ask(samples.into()).unwrap();
        out
    };
    let (got, lobes) = (draw(m), draw(bare));
    assert_eq!(got[..4], lobes[..4]);
    let vector = |first: usize, i: usize| Vec3::from([0, 1, 2].map(|k| got[first + k][i]));
    for (i, pdf) in got[3].iter().enumerate() {
        let (d, weight) = (vector(0, i), vector(4, i));
        let want = m.evaluate(d) / pdf;
        assert!((weight - want).abs().max_element() <= 1e-4 * largest * m.power(), "{d}: {weight}, {want}");
    }
}

#[test]
fn the_albedo_is_that_of_the_lobes_and_its_difference_between_the_views() {
    let made = Made::new(9, [4, 4, 2]);
    let [bytes, plain] = made.encode();
    let (material, plain) = (Material::from_bytes(&bytes).unwrap(), Material::from_bytes(&plain).unwrap());
    let stored = |view: usize| Vec3::from_array(made.albedo_differences[view]).as_dvec3();
    let between = |theta: f32| match theta {
        0.0..0.6 => stored(0).lerp(stored(1), f64::from(theta) / f64::from(THETAS[1])),
        0.6..1.5 => {
            stored(1).lerp(stored(2), f64::from(theta - THETAS[1]) / f64::from(THETAS[2] - THETAS[1]))
        }
        _ => stored(2),
    };
    let check = |theta: f32, m: &Mixture<16>, bare: &Mixture<16>| {
        let lobes = bare.albedo().as_dvec3();
        let want = lobes + f64::from(luminance(bare.albedo())) * between(theta);
        let off = (m.albedo().as_dvec3() - want).abs().max_element();
        let most = 2e-6 * (lobes.abs().max_element() + want.abs().max_element());
        assert!(off < most, "{:?}, {theta}: {}, {want}", m.level(), m.albedo());
        assert!((lobes - want).abs().max_element() > 0.01, "{theta}: the factors change nothing");
    };
    let thetas: Vec<f32> = (0..41).map(|i| 0.0375 * i as f32).chain([0.6, 1.5, 1.57]).collect();
    let wo: Vec<Vec3> = thetas.iter().map(|&theta| at(theta, 2.0)).collect();
    for level in levels() {
        for (&theta, &wo) in thetas.iter().zip(&wo) {
            // Of lobes that are left out neither has the albedo.
            for share in [0.0, 0.02] {
                let leave_out = LeaveOut::new(share, 1e-7).unwrap();
                let (mut m, mut bare) = (Mixture::empty(), Mixture::empty());
                let options = PrepareOptions { leave_out, level: Some(level) };
                material.prepare_with(wo, options, &mut m).unwrap();
                plain.prepare_with(wo, options, &mut bare).unwrap();
                check(theta, &m, &bare);
            }
        }
    }
    let [x, y, z] = [0, 1, 2].map(|i| wo.iter().map(|wo| wo[i]).collect::<Vec<f32>>());
    let mut mixtures = vec![Mixture::<16>::empty(); wo.len()];
    material.prepare_into([&x, &y, &z], &mut mixtures).unwrap();
    for (m, &wo) in mixtures.iter().zip(&wo) {
        let mut one = Mixture::<16>::empty();
        material.prepare(wo, &mut one).unwrap();
        let off = (m.albedo() - one.albedo()).abs().max_element();
        let scale = m.power() + m.albedo().abs().max_element();
        assert!(off <= 4e-6 * scale, "{wo}: {}, {}", m.albedo(), one.albedo());
    }
    let mut m = Mixture::<16>::empty();
    material.prepare(Vec3::new(0.6, 0.0, -0.8), &mut m).unwrap();
    assert_eq!((m.albedo(), m.has_factors(), m.evaluate(Vec3::Z)), (Vec3::ZERO, false, Vec3::ZERO));
}

#[test]
fn what_needs_lobes_alone_refuses_factors() {
    let [bytes, _] = Made::new(10, [3, 3, 1]).encode();
    let material = Material::from_bytes(&bytes).unwrap();
    let mut m = Mixture::<16>::empty();
    material.prepare(Vec3::Z, &mut m).unwrap();
    let light = Mixture::<16>::sphere(&[]).unwrap();
    assert_eq!(m.inner_product(&light), Err(Error::Squeezed));
    assert_eq!(m.product_into(&light, &mut []), Err(Error::Squeezed));
    assert_eq!(m.with_diffuse(Vec3::ONE).err(), Some(Error::Amplitude));
}

#[test]
fn what_has_no_place_in_a_table_is_refused_with_its_name() {
    let made = Made::new(11, [5, 6, 2]);
    let refused = |table: FactorTable<'_>| made.try_encode(Some(table)).unwrap_err().to_string();
    let table = made.table();
    for (half, difference) in [(1, 30), (30, 1), (33, 6), (5, 33), (0, 0), (usize::MAX, 2), (65541, 6)] {
        let message = refused(FactorTable { half, difference, ..table });
        assert!(message.contains("size of the table"), "{half}, {difference}: {message}");
    }
    for azimuth in [0, 9, usize::MAX] {
        assert!(refused(FactorTable { azimuth, ..table }).contains("size of the table"), "{azimuth}");
    }
    assert!(
        refused(FactorTable { azimuth: 1, is_signed: true, factors: &made.factors[..30], ..table })
            .contains("sign of one")
    );
    assert!(refused(FactorTable { half: 6, ..table }).contains("number of factors"));
    // At h = z and at wi = wo there is no azimuth.
    for n in [30, 35, 30 + 4 * 6] {
        let mut factors = made.factors.clone();
        factors[n][0] = if factors[n][0] > 1.0 { 0.5 } else { 2.0 };
        assert!(refused(FactorTable { factors: &factors, ..table }).contains("no azimuth"), "{n}");
    }
    assert!(
        refused(FactorTable { albedo_differences: &made.albedo_differences[1..], ..table })
            .contains("number of albedo differences")
    );
    for bad in [-0.1, 8.1, f32::NAN, f32::INFINITY] {
        let mut factors = made.factors.clone();
        factors[17][1] = bad;
        assert!(refused(FactorTable { factors: &factors, ..table }).contains("factor at"), "{bad}");
    }
    for bad in [16.1, -16.1, f32::NAN] {
        let mut albedo_differences = made.albedo_differences.clone();
        albedo_differences[1][2] = bad;
        let table = FactorTable { albedo_differences: &albedo_differences, ..table };
        assert!(refused(table).contains("albedo difference"), "{bad}");
    }
}

/// Bytes with the length and the checksum that they should have.
fn with_checksum(mut bytes: Vec<u8>) -> Vec<u8> {
    put_right(&mut bytes);
    bytes
}

/// Kernels multiply the largest factor by down to 2^-48: a file with a factor of 1e-41 had a larger one than its largest.
#[test]
fn factors_keep_their_digits_or_are_0() {
    for (share, is_there) in [(1e-18, true), (1e-22, false), (1e-41, false)] {
        let mut made = Made::new(3, [4, 3, 2]);
        made.factors.iter_mut().flatten().for_each(|factor| *factor *= share);
        let [bytes, _] = made.encode();
        let material = Material::from_bytes(bytes).unwrap();
        let largest = material.largest_factor();
        assert_eq!(largest > 0.0, is_there, "{share}");
        for [wo, wi] in pairs(&mut Random(4)) {
            let (got, want) = (material.factor(wo, wi).as_dvec3(), truth(&material, wo, wi));
            let error = (got - want).abs().max_element();
            assert!(error <= 1e-5 * f64::from(largest), "{share}, {wo}, {wi}: {got}, {want}");
        }
    }
}

#[test]
fn hostile_bytes_are_refused_with_the_place() {
    let [bytes, plain] = Made::new(12, [5, 6, 2]).encode();
    let block = plain.len() - 4 - 8 - PROVENANCE.len().next_multiple_of(4);
    let text = bytes.len() - 4 - 8 - PROVENANCE.len().next_multiple_of(4);
    let table = block + 8 + 4;
    let nodes = table + 4 * (9 + 1);
    let refused = |place: usize, put: [u8; 4]| {
        let mut bytes = bytes.clone();
        bytes[place..place + 4].copy_from_slice(&put);
        Material::from_bytes(&with_checksum(bytes)).map(|_| ()).unwrap_err()
    };
    let field = |name, offset| FormatError::Field { name, offset };
    for shape in [[1, 6, 2], [5, 1, 2], [5, 6, 0], [5, 6, 9], [33, 6, 2], [5, 33, 2], [255; 3]] {
        let error = field("size of the table of factors", block + 8);
        assert_eq!(refused(block + 8, [shape[0], shape[1], shape[2], 0]), error, "{shape:?}");
    }
    // Sizes that other bytes of the file do not fit.
    assert_eq!(refused(block + 8, [6, 6, 2, 0]), field("length of the block of factors", block + 4));
    for head in [[5, 6, 2, 2], [5, 12, 1, 1], [5, 6, 2, 255]] {
        assert_eq!(refused(block + 8, head), field("head of the table of factors", block + 8), "{head:?}");
    }
    for largest in [-0.1, 8.1, f32::NAN, f32::INFINITY, 9e-21, f32::from_bits(1)] {
        assert_eq!(refused(nodes - 4, f32::to_le_bytes(largest)), field("largest factor", nodes - 4));
    }
    assert_eq!(refused(table + 8, f32::NAN.to_le_bytes()), field("albedo difference", table + 8));
    // Any codes are factors.
    let mut any = bytes.clone();
    any[nodes..nodes + 3 * 60].fill(0xff);
    let any = with_checksum(any);
    let material = Material::from_bytes(&any).unwrap();
    assert!(material.factor(Vec3::Z, Vec3::Z).max_element() <= 1.00001 * material.largest_factor());

    // Blocks: an unknown one is skipped if its tag begins with a small letter, whatever it holds.
    let tag = "tag of a block (unknown, and not to be skipped)";
    assert_eq!(refused(block, *b"Spec"), field(tag, block));
    assert_eq!(refused(block, [0; 4]), field(tag, block));
    assert_eq!(refused(40, *b"lobe"), field("tag of a block (lobes come first, once)", 40));
    assert_eq!(refused(block, *b"LOBE"), field("tag of a block (lobes come first, once)", block));
    assert_eq!(refused(text, *b"FACT"), field("tag of a block (a second table of factors)", text));
    assert_eq!(refused(block, *b"text"), field("tag of a block (a second provenance)", text));
    let skipped = with_checksum([&bytes[..block], b"more", &bytes[block + 4..]].concat());
    let material = Material::from_bytes(&skipped).unwrap();
    assert_eq!((material.factor_nodes(), material.provenance()), (None, PROVENANCE));
    let inserted = [&bytes[..block], b"more\x05\0\0\0abcde\0\0\0", &bytes[block..]].concat();
    let material = Material::from_bytes(with_checksum(inserted)).unwrap();
    assert_eq!((material.factor_nodes(), material.provenance()), (Some([5, 6, 2]), PROVENANCE));
    for length in [u32::MAX, u32::MAX - 7, 0x7fff_ffff, bytes.len() as u32] {
        assert_eq!(refused(block + 4, length.to_le_bytes()), field("length of a block", block + 4));
        assert_eq!(refused(44, length.to_le_bytes()), field("length of a block", 44));
    }
    assert_eq!(refused(44, [0; 4]), field("length of the block of lobes", 44));
    let padding = text + 8 + PROVENANCE.len();
    assert_eq!(refused(padding - 3, *b"xxxx"), field("bytes between blocks (must be 0)", padding));
    assert_eq!(refused(36, [1, 0, 0, 0]), field("reserved field", 36));
    assert_eq!(refused(text + 8, [0xff; 4]), field("provenance (not UTF-8)", text + 8));

    // Colour differences: of the diffuse term of the second view, and of its third lobe.
    let head = 48 + 4 * (3 + 4);
    let lobe = 48 + 4 * (3 + 12) + 4 * (5 * LOBES + 1) + 4 * (3 * LOBES + 2);
    for bad in [f32::NAN, 16.1, -16.1, f32::INFINITY] {
        assert_eq!(refused(head + 8, bad.to_le_bytes()), field("diffuse albedo", head + 8), "{bad}");
        assert_eq!(refused(lobe, bad.to_le_bytes()), field("amplitude", lobe), "{bad}");
    }
    // Cut anywhere, with the length and the checksum put right: the provenance is the last that may be left out.
    for length in 60..bytes.len() {
        let cut = Material::from_bytes(&bytes[..length]);
        assert!(matches!(cut, Err(FormatError::Length { .. })), "{length}");
        let cut = Material::from_bytes(with_checksum(bytes[..length].to_vec()));
        assert_eq!(cut.is_ok(), [block + 4, text + 4].contains(&length), "{length}");
    }
    // Of version 0 and 4 nothing is known.
    assert_eq!(refused(8, [0; 4]), FormatError::Version(0));
    assert_eq!(refused(8, [4, 0, 0, 0]), FormatError::Version(4));
}

/// A file of version 2 with a table of 7 by 4 factors in 10 bits has the values that it had, and damage to it is found.
#[test]
fn version_2_is_read_as_it_was() {
    let bytes: &[u8] = include_bytes!("../corpus/version2.srbf");
    let material = Material::from_bytes(bytes).unwrap();
    assert_eq!((bytes[8], material.factor_nodes()), (2, Some([7, 4, 1])));
    let u32_at = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let [views, lobes, provenance, mirrored] = [20, 24, 32, 36].map(|at| u32_at(at) as usize);
    assert_eq!(material.provenance().len(), provenance);
    let table = 48 + 4 * (5 * views + (5 * lobes + mirrored) * views);
    let nodes = table + 12 * views + 4;
    assert_eq!(nodes + 4 * 7 * 4 + provenance + 4, bytes.len());
    let mut largest = 0f32;
    for n in 0..28 {
        let node = u32_at(nodes + 4 * n);
        let want = [0, 10, 20].map(|bit| ((node >> bit & 1023) as f32 / 360.0).powi(2));
        let got = material.factor_node(n / 4, n % 4, 0).unwrap();
        for c in 0..3 {
            assert!((got[c] - want[c]).abs() <= 1e-6 * want[c], "{n}: {got:?}, {want:?}");
            largest = largest.max(got[c]);
        }
    }
    assert_eq!(material.largest_factor(), largest);
    for [wo, wi] in pairs(&mut Random(13)) {
        let error = (material.factor(wo, wi).as_dvec3() - truth(&material, wo, wi)).abs().max_element();
        assert!(error < FACTOR * f64::from(largest), "wo {wo}, wi {wi}: {error:e}");
    }
    let theta = f32::from_bits(u32_at(48 + 4));
    assert_eq!(material.view_theta(1), Some(theta));

    let refused = |place: usize, put: [u8; 4]| {
        let mut bytes = bytes.to_vec();
        bytes[place..place + 4].copy_from_slice(&put);
        Material::from_bytes(with_checksum(bytes)).map(|_| ()).unwrap_err()
    };
    let field = |name, offset| FormatError::Field { name, offset };
    for both in [7u32, 4 << 16, 1 | 4 << 16, 33 | 4 << 16, 7 | 1 << 16, 7 | 33 << 16, u32::MAX] {
        assert_eq!(refused(44, both.to_le_bytes()), field("size of the table of factors", 44), "{both:x}");
    }
    assert_eq!(refused(44, (8u32 | 4 << 16).to_le_bytes()), field("length of the provenance", 32));
    assert_eq!(refused(40, [1, 0, 0, 0]), field("reserved field", 40));
    for node in [0, 27] {
        let place = nodes + 4 * node;
        assert_eq!(refused(place, [0, 0, 0, 0x40]), field("node of the table of factors", place));
        assert_eq!(refused(place, [0, 0, 0, 0x80]), field("node of the table of factors", place));
        // A larger code than any there.
        assert_eq!(refused(place, [0xff, 3, 0, 0]), field("largest factor", nodes - 4));
    }
    for largest in [0.0, 7.0, 9.0, f32::NAN, f32::INFINITY] {
        assert_eq!(refused(nodes - 4, f32::to_le_bytes(largest)), field("largest factor", nodes - 4));
    }
    for length in 60..bytes.len() {
        assert!(Material::from_bytes(with_checksum(bytes[..length].to_vec())).is_err(), "{length}");
    }
    // Version 1 has no table.
    assert_eq!(refused(8, [1, 0, 0, 0]), field("reserved field", 44));
}
