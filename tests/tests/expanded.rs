//! Expanded materials: how near they come to the exact preparation, and that their density, values and samples belong together at
//! every level.

use glam::Vec3;
use srbf_core::{
    Error, Expanded, FactorTable, Level, Line, Material, Mixture, PlaneLobe, SamplesMut, View, luminance,
};
use srbf_tests::inputs::Random;
use srbf_tests::partition::Partition;
use srbf_tests::seeds::same_without_azimuth;
use srbf_tests::statistics::sidak;
use srbf_tests::tolerance::Worst;

/// Bytes of a material of a kind, in views at uneven angles.
///
/// Lobes follow the mirror direction but for their own width, `sharpness` is the range of log2. Of `lobes` stored ones the first
/// `squeezed` are squeezed, the last `mirrored` stand for two.
struct Kind {
    name: &'static str,
    views: usize,
    lobes: usize,
    squeezed: usize,
    mirrored: usize,
    sharpness: [f32; 2],
    factors: bool,
}

const KINDS: [Kind; 7] = [
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
    fn bytes(&self) -> Vec<u8> {
        let mut random = Random(self.lobes as u64);
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
fn materials() -> Vec<(&'static str, Vec<u8>)> {
    let mut all: Vec<_> = KINDS.iter().map(|kind| (kind.name, kind.bytes())).collect();
    all.push(("cayman", include_bytes!("../../presets/cayman.srbf").to_vec()));
    all.push(("garnet red", include_bytes!("../../presets/garnet_red.srbf").to_vec()));
    all.push(("krylon blue", include_bytes!("../../presets/krylon_blue.srbf").to_vec()));
    all
}

/// Expands a material for as long as the test runs.
fn expanded(bytes: &[u8], rows: usize) -> (&'static Material<Vec<u8>>, Expanded<'static>) {
    let material = Material::from_bytes(bytes.to_vec()).expect("a valid material");
    let material: &_ = Box::leak(Box::new(material));
    let memory = vec![f32::NAN; material.expanded_len(rows)].leak();
    Expanded::check(material, rows).expect("an isotropic material");
    let expanded = Expanded::new(material, rows, memory).expect("what was checked");
    assert!(expanded.row_count() >= rows.min(material.view_count()), "{}", expanded.row_count());
    assert_eq!(expanded.material().bytes(), material.bytes());
    (material, expanded)
}

fn upper(random: &mut Random) -> Vec3 {
    let d = random.direction();
    d.with_z(d.z.abs())
}

/// Structure of arrays.
struct Soa([Vec<f32>; 3]);

impl Soa {
    fn new(all: &[Vec3]) -> Self {
        Self([0, 1, 2].map(|i| all.iter().map(|d| d[i]).collect()))
    }
    fn empty(n: usize) -> Self {
        Self([0, 1, 2].map(|_| vec![f32::NAN; n]))
    }
    fn slices(&self) -> [&[f32]; 3] {
        self.0.each_ref().map(|s| &s[..])
    }
    fn slices_mut(&mut self) -> [&mut [f32]; 3] {
        self.0.each_mut().map(|s| &mut s[..])
    }
    fn at(&self, i: usize) -> Vec3 {
        Vec3::new(self.0[0][i], self.0[1][i], self.0[2][i])
    }
}

/// One test at a time, as the level is that of the process.
fn for_each_level(mut each: impl FnMut(Level)) {
    let _guard = ONE.lock();
    let before = Level::current();
    for level in Level::ALL.into_iter().filter(|level| level.set().is_ok()) {
        each(level);
    }
    before.set().unwrap();
}

static ONE: std::sync::Mutex<()> = std::sync::Mutex::new(());

/// Largest differences of value and density from the exact preparation, relative to the largest of each outgoing direction.
fn errors(bytes: &[u8], rows: usize) -> [f32; 2] {
    let (material, expanded) = expanded(bytes, rows);
    let mut random = Random(77);
    let (mut exact, mut between) = (Mixture::<64>::empty(), Mixture::<64>::empty());
    let mut worst = [0f32; 2];
    for _ in 0..150 {
        let wo = upper(&mut random);
        material.prepare(wo, &mut exact).unwrap();
        expanded.prepare(wo, &mut between).unwrap();
        let towards: Vec<Vec3> = (0..200).filter_map(|_| exact.sample_direction(random.three())).collect();
        let wanted: Vec<_> = towards.iter().map(|&d| exact.evaluate_and_pdf(d)).collect();
        let peak = wanted.iter().fold([0f32; 2], |[v, p], w| [v.max(w.0.max_element()), p.max(w.1)]);
        for (&d, &(value, pdf)) in towards.iter().zip(&wanted) {
            let (v, p) = between.evaluate_and_pdf(d);
            worst[0] = worst[0].max((v - value).abs().max_element() / peak[0]);
            worst[1] = worst[1].max((p - pdf).abs() / peak[1]);
        }
    }
    worst
}

#[test]
fn the_error_falls_with_the_square_of_the_rows() {
    for (name, bytes) in materials() {
        let all = [64, 128, 256, Expanded::DEFAULT_ROWS].map(|rows| errors(&bytes, rows));
        println!("{name}: {all:?}");
        assert!(all[3][0] <= 1e-3 && all[3][1] <= 1e-3, "{name}: {:?}", all[3]);
        for (what, coarse) in all[0].into_iter().enumerate() {
            // A quarter each time; or rounding alone is left, which sharp lobes show most.
            let fine = all[2][what];
            assert!(
                fine <= coarse / 9.0 || fine <= 1e-4,
                "{name}: {coarse:e} with 64 rows, {fine:e} with 256"
            );
        }
    }
}

/// Largest sharpness of a mixture.
fn sharpest(m: &Mixture<'_, 64>) -> f32 {
    (0..m.len()).filter_map(|k| m.lobe(k)).map(|l| l.gaussian.sharpness).fold(0.0, f32::max)
}

#[test]
fn pairs_have_what_their_mixtures_have_at_every_level() {
    let mut worst = Worst::new("expanded value");
    let mut worst_pdf = Worst::new("expanded pdf");
    for (name, bytes) in materials() {
        let (_, expanded) = expanded(&bytes, 128);
        let mut random = Random(5);
        // Incident directions by the lobes, and anywhere; a number of pairs that is no multiple of a block.
        let wo: Vec<Vec3> = (0..217).map(|_| upper(&mut random)).collect();
        Level::Scalar.set().unwrap();
        let mut mixtures = vec![Mixture::<64>::empty(); wo.len()];
        for (m, &wo) in mixtures.iter_mut().zip(&wo) {
            expanded.prepare(wo, m).unwrap();
        }
        let wi: Vec<Vec3> =
            mixtures
                .iter()
                .enumerate()
                .map(|(i, m)| {
                    if i % 4 == 0 { upper(&mut random) } else { m.sample_direction(random.three()).unwrap() }
                })
                .collect();
        let n = wo.len();
        for_each_level(|level| {
            let (wo, wi) = (Soa::new(&wo), Soa::new(&wi));
            let (mut value, mut alone) = (Soa::empty(n), Soa::empty(n));
            let (mut pdf, mut pdf_alone) = (vec![f32::NAN; n], vec![f32::NAN; n]);
            let (wo, wi_slices) = (wo.slices(), wi.slices());
            expanded.evaluate_and_pdf_pairs_into(wo, wi_slices, value.slices_mut(), &mut pdf).unwrap();
            expanded.evaluate_pairs_into(wo, wi_slices, alone.slices_mut()).unwrap();
            expanded.pdf_pairs_into(wo, wi_slices, &mut pdf_alone).unwrap();
            for (i, m) in mixtures.iter().enumerate() {
                let wanted = m.evaluate_and_pdf(wi.at(i));
                let peak = (0..m.len())
                    .filter_map(|k| m.lobe(k))
                    .map(|l| l.amplitude.max_element())
                    .fold(m.diffuse().max_element(), f32::max);
                let unit = f64::from(peak) * (4.0 + f64::from(sharpest(m)).sqrt()) / f64::from(m.squeeze());
                let off = (value.at(i) - wanted.0).abs().max_element();
                worst.see(f64::from(off) / unit, || format!("{level:?} {name} pair {i}"));
                assert_eq!(alone.at(i), value.at(i), "{level:?} {name}");
                let off = (pdf[i] - wanted.1).abs().max((pdf_alone[i] - wanted.1).abs()) * m.power();
                worst_pdf.see(f64::from(off) / unit, || format!("{level:?} {name} pair {i}"));
            }
        });
    }
    for worst in [worst, worst_pdf] {
        println!("{worst:?}");
        assert_eq!(worst.failure(), None);
    }
}

#[test]
fn samples_have_the_density_and_the_value_that_evaluating_finds() {
    for (name, bytes) in materials() {
        let (material, expanded) = expanded(&bytes, Expanded::DEFAULT_ROWS);
        let mut random = Random(9);
        let n = 333;
        let wo = Soa::new(&(0..n).map(|_| upper(&mut random)).collect::<Vec<_>>());
        let wi = Soa::new(&(0..n).map(|_| upper(&mut random)).collect::<Vec<_>>());
        let u = Soa::new(&(0..n).map(|_| random.three().into()).collect::<Vec<_>>());
        let mut m = Mixture::<64>::empty();
        for_each_level(|level| {
            let (mut direction, mut weight, mut value) = (Soa::empty(n), Soa::empty(n), Soa::empty(n));
            let (mut pdf, mut again) = (vec![f32::NAN; n], vec![f32::NAN; n]);
            let samples =
                SamplesMut { direction: direction.slices_mut(), pdf: &mut pdf, weight: weight.slices_mut() };
            expanded.sample_pairs_into(wo.slices(), u.slices(), samples).unwrap();
            expanded
                .evaluate_and_pdf_pairs_into(wo.slices(), direction.slices(), value.slices_mut(), &mut again)
                .unwrap();
            for i in 0..n {
                assert!(
                    (direction.at(i).length() - 1.0).abs() < 5e-7,
                    "{level:?} {name} {i}: {}",
                    direction.at(i)
                );
                assert!(
                    (pdf[i] / again[i] - 1.0).abs() < 1e-5,
                    "{level:?} {name} {i}: {} {}",
                    pdf[i],
                    again[i]
                );
                let off = (weight.at(i) - value.at(i) / again[i]).abs().max_element();
                assert!(off < 1e-5 * weight.at(i).abs().max_element(), "{level:?} {name} {i}: {off}");
                expanded.prepare(wo.at(i), &mut m).unwrap();
                if material.factor_nodes().is_none() {
                    let off = luminance(weight.at(i)) / m.power() - 1.0;
                    assert!(off.abs() < 1e-5, "{level:?} {name} {i}: {off}");
                }
            }

            // With another direction: the same samples, and what evaluating finds there.
            let (mut direction_too, mut weight_too) = (Soa::empty(n), Soa::empty(n));
            let (mut pdf_too, mut towards, mut towards_pdf) =
                (vec![f32::NAN; n], Soa::empty(n), vec![f32::NAN; n]);
            let samples = SamplesMut {
                direction: direction_too.slices_mut(),
                pdf: &mut pdf_too,
                weight: weight_too.slices_mut(),
            };
            let (to, to_pdf) = (towards.slices_mut(), &mut towards_pdf);
            expanded
                .sample_and_evaluate_pairs_into(wo.slices(), u.slices(), samples, wi.slices(), to, to_pdf)
                .unwrap();
            assert_eq!(
                (&direction_too.0, &weight_too.0, &pdf_too),
                (&direction.0, &weight.0, &pdf),
                "{level:?} {name}"
            );
            expanded
                .evaluate_and_pdf_pairs_into(wo.slices(), wi.slices(), value.slices_mut(), &mut again)
                .unwrap();
            for i in 0..n {
                let off = (towards.at(i) - value.at(i)).abs().max_element();
                assert!(off <= 1e-5 * value.at(i).abs().max_element(), "{level:?} {name} {i}: {off}");
                assert!((towards_pdf[i] - again[i]).abs() <= 1e-5 * again[i], "{level:?} {name} {i}");
            }
        });
    }
}

#[test]
fn samples_follow_their_density_which_integrates_to_1() {
    const SAMPLES: usize = 120_000;
    let materials = materials();
    let p_level = sidak(0.01, 3 * materials.len());
    // Few rows, so that what lies between them is far from either.
    for (name, bytes) in materials {
        let (_, expanded) = expanded(&bytes, 64);
        for (i, theta) in [0.017f32, 0.7, 1.4].into_iter().enumerate() {
            let wo = Vec3::new(-0.6 * theta.sin(), 0.8 * theta.sin(), theta.cos());
            let mut m = Mixture::<64>::empty();
            expanded.prepare(wo, &mut m).unwrap();
            let partition = Partition::new(&m, |d| {
                let mut pdf = [0.0];
                expanded
                    .pdf_pairs_into([&[wo.x], &[wo.y], &[wo.z]], [&[d.x], &[d.y], &[d.z]], &mut pdf)
                    .unwrap();
                pdf[0]
            });
            let total = partition.total();
            assert!((total - 1.0).abs() < 3e-5, "{name} at {theta}: the density integrates to {total}");
            let mut random = Random(100 + i as u64);
            let u = Soa::new(&(0..SAMPLES).map(|_| random.three().into()).collect::<Vec<_>>());
            let wo = Soa::new(&vec![wo; SAMPLES]);
            let (mut direction, mut weight, mut pdf) =
                (Soa::empty(SAMPLES), Soa::empty(SAMPLES), vec![0.0; SAMPLES]);
            let samples =
                SamplesMut { direction: direction.slices_mut(), pdf: &mut pdf, weight: weight.slices_mut() };
            expanded.sample_pairs_into(wo.slices(), u.slices(), samples).unwrap();
            let mut next = 0..SAMPLES;
            let result = partition.test(SAMPLES, || direction.at(next.next().unwrap()));
            assert!(result.p > p_level, "{name} at {theta}: p = {:e}, level {p_level:e}", result.p);
        }
    }
}

#[test]
fn nothing_jumps_from_one_row_or_view_to_the_next() {
    const ROWS: usize = 64;
    for (name, bytes) in materials() {
        let (material, expanded) = expanded(&bytes, ROWS);
        let mut m = Mixture::<64>::empty();
        let last = material.view_theta(material.view_count() - 1).unwrap();
        // Steps that fall on either side of every row, and on views.
        let steps = 40 * ROWS;
        let apart = 1e-6;
        for i in 0..steps {
            let theta = i as f32 / steps as f32 * last.max(1.0);
            let towards = |theta: f32| Vec3::new(-theta.sin(), 0.0, theta.cos());
            expanded.prepare(towards(theta), &mut m).unwrap();
            let d = m.sample_direction([0.5, 0.6, 0.3]).unwrap();
            let before = m.evaluate(d);
            let largest = sharpest(&m);
            let peak =
                (0..m.len()).filter_map(|k| m.lobe(k)).map(|l| l.amplitude.max_element()).fold(0.0, f32::max);
            expanded.prepare(towards(theta + apart), &mut m).unwrap();
            let off = (m.evaluate(d) - before).abs().max_element();
            let allowed = peak * 30.0 * apart * (1.0 + largest.sqrt());
            assert!(off <= allowed, "{name} at {theta}: {before} changes by {off:e}, allowed {allowed:e}");
        }
    }
}

#[test]
fn what_is_no_outgoing_direction_reflects_nothing() {
    let nan = f32::NAN;
    let none = [
        Vec3::new(0.6, 0.0, -0.8),
        Vec3::new(nan, 0.0, 1.0),
        Vec3::new(0.0, 0.0, nan),
        Vec3::splat(nan),
        Vec3::new(0.0, 0.0, 2.0),
        Vec3::ZERO,
        Vec3::splat(f32::INFINITY),
        Vec3::new(0.0, 0.0, -1.0),
    ];
    for (name, bytes) in materials() {
        let (_, expanded) = expanded(&bytes, 64);
        for_each_level(|level| {
            let n = none.len();
            let (wo, wi, u) =
                (Soa::new(&none), Soa::new(&vec![Vec3::Z; n]), Soa::new(&vec![Vec3::splat(0.5); n]));
            let (mut direction, mut weight, mut value) = (Soa::empty(n), Soa::empty(n), Soa::empty(n));
            let (mut pdf, mut density) = (vec![nan; n], vec![nan; n]);
            let samples =
                SamplesMut { direction: direction.slices_mut(), pdf: &mut pdf, weight: weight.slices_mut() };
            let (to, to_pdf) = (value.slices_mut(), &mut density);
            expanded
                .sample_and_evaluate_pairs_into(wo.slices(), u.slices(), samples, wi.slices(), to, to_pdf)
                .unwrap();
            for i in 0..n {
                let all = (direction.at(i), pdf[i], weight.at(i), value.at(i), density[i]);
                assert_eq!(all, (Vec3::Z, 0.0, Vec3::ZERO, Vec3::ZERO, 0.0), "{level:?} {name} {}", none[i]);
            }
            // Incident directions below the horizon.
            let below = Soa::new(&vec![Vec3::new(0.6, 0.0, -0.8); n]);
            expanded
                .evaluate_and_pdf_pairs_into(wi.slices(), below.slices(), value.slices_mut(), &mut density)
                .unwrap();
            assert!(density.iter().all(|&p| p == 0.0) && value.at(0) == Vec3::ZERO, "{level:?} {name}");
        });
        let mut m = Mixture::<64>::empty();
        assert_eq!(expanded.prepare(Vec3::new(0.0, 0.0, 2.0), &mut m), Err(Error::Direction));
        assert_eq!(expanded.prepare(Vec3::splat(nan), &mut m), Err(Error::Direction));
        assert_eq!((expanded.prepare(none[0], &mut m), m.power()), (Ok(()), 0.0));
    }
}

#[test]
fn what_cannot_be_expanded_is_refused() {
    let bytes = KINDS[0].bytes();
    let material = Material::from_bytes(&bytes).unwrap();
    let needed = material.expanded_len(64);
    let mut memory = vec![0.0; needed];
    assert!(Expanded::new(&material, 64, &mut memory).is_ok());
    let available = needed - 1;
    let result = Expanded::new(&material, 64, &mut memory[..available]);
    assert_eq!(result.err(), Some(Error::Memory { needed, available }));
    for rows in [0, 1, Expanded::MAX_ROWS + 1, usize::MAX] {
        assert!(material.expanded_len(rows) >= 15);
        assert_eq!(Expanded::new(&material, rows, &mut memory).err(), Some(Error::Rows), "{rows}");
    }
    // Fewer rows than views, and memory that begins anywhere.
    let mut memory = vec![0.0; material.expanded_len(2) + 3];
    let expanded = Expanded::new(&material, 2, &mut memory[3..]).unwrap();
    let mut small = Mixture::<16>::empty();
    expanded.prepare(Vec3::new(0.6, 0.0, 0.8), &mut small).unwrap();
    assert!(small.power() > 0.0);
    let many = KINDS[5].bytes();
    let material = Material::from_bytes(&many).unwrap();
    let mut memory = vec![0.0; material.expanded_len(16)];
    let expanded = Expanded::new(&material, 16, &mut memory).unwrap();
    let error = Err(Error::Capacity { needed: 64, available: 16 });
    assert_eq!(expanded.prepare(Vec3::Z, &mut small), error);
    let mut value = [[0.0]; 3];
    let result = expanded.evaluate_pairs_into([&[0.0]; 3], [&[]; 3], value.each_mut().map(|s| &mut s[..]));
    assert_eq!(result, Err(Error::Length));
}
