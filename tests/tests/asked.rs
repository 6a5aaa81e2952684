//! A material that is asked directly: its answers are those of its mixtures, its draws follow their density, and batches are many
//! single answers.

use glam::Vec3;
use srbf_core::{AnyMixture, Draws, Error, Material, Mixture, Processor, Request, Sample, Towards};
use srbf_tests::inputs::Random;
use srbf_tests::kinds::{Soa, for_each_level, materials, turned_materials, upper};
use srbf_tests::partition::Partition;
use srbf_tests::statistics::sidak;

/// Values and densities, and the two of a draw, may be off by this of the largest.
const OFF: f32 = 1e-5;

fn all() -> Vec<(&'static str, Material<Vec<u8>>)> {
    let make = |(name, bytes)| (name, Material::from_bytes(bytes).expect("a valid material"));
    materials().into_iter().chain(turned_materials()).map(make).collect()
}

/// Distance of a draw from another, in widths of the lobes there.
fn apart(a: &Sample, b: &Sample) -> f32 {
    (a.direction - b.direction).length() * a.pdf.max(1e-2).sqrt()
}

#[test]
fn it_answers_what_its_mixtures_do_at_every_level() {
    let (mut worst, mut other_lobes, mut draws) = ([0f32; 2], 0, 0);
    for (name, material) in all() {
        for_each_level(|level| {
            let mut random = Random(3);
            let mut m = Mixture::<64>::empty();
            for _ in 0..120 {
                let wo = upper(&mut random);
                material.prepare(wo, &mut m).unwrap();
                let towards: Vec<Vec3> = (0..40)
                    .map(|i| match m.sample_direction(random.three()) {
                        Some(d) if i % 4 != 0 => d,
                        _ => upper(&mut random),
                    })
                    .collect();
                let wanted: Vec<_> = towards.iter().map(|&d| m.evaluate_and_pdf(d)).collect();
                let peak =
                    wanted.iter().fold([0f32; 2], |[v, p], w| [v.max(w.0.abs().max_element()), p.max(w.1)]);
                for (&wi, &(value, pdf)) in towards.iter().zip(&wanted) {
                    let (found, density) = material.evaluate_and_pdf(wo, wi);
                    let off =
                        [(found - value).abs().max_element() / peak[0], (density - pdf).abs() / peak[1]];
                    worst = [worst[0].max(off[0]), worst[1].max(off[1])];
                    assert!(off[0] <= OFF && off[1] <= OFF, "{level:?} {name} {wo} {wi}: {off:?}");
                    assert_eq!(material.evaluate(wo, wi), found, "{level:?} {name}");
                    assert_eq!(material.pdf(wo, wi), density, "{level:?} {name}");

                    let u = random.three();
                    let (drawn, towards) = material.sample_and_evaluate(wo, u, wi);
                    assert_eq!(towards, (found, density), "{level:?} {name}");
                    assert_eq!(drawn, material.sample(wo, u), "{level:?} {name}");
                    let (drawn, wanted) = (drawn.unwrap(), m.sample(u).unwrap());
                    draws += 1;
                    if apart(&drawn, &wanted) > 0.05 {
                        other_lobes += 1;
                    }
                    assert!((drawn.direction.length() - 1.0).abs() < 5e-7, "{level:?} {name}");
                }
            }
        });
    }
    println!("off by {worst:?} of the largest; {other_lobes} of {draws} draws from another lobe");
    assert!(other_lobes * 20_000 < draws, "{other_lobes} of {draws}");
}

#[test]
fn a_draw_has_the_density_and_the_value_that_evaluating_finds() {
    let mut worst = 0f32;
    for (name, material) in all() {
        for_each_level(|level| {
            let mut random = Random(9);
            for _ in 0..2000 {
                let (wo, u) = (upper(&mut random), random.three());
                let drawn = material.sample(wo, u).unwrap();
                let (value, pdf) = material.evaluate_and_pdf(wo, drawn.direction);
                let off = (drawn.pdf / pdf - 1.0).abs();
                worst = worst.max(off);
                assert!(off < 1e-6, "{level:?} {name}: {} {pdf}", drawn.pdf);
                let off = (drawn.weight - value / pdf).abs().max_element();
                assert!(off <= 1e-6 * drawn.weight.abs().max_element(), "{level:?} {name}: {off}");
            }
        });
    }
    println!("density of a draw: relative {worst:e}");
}

#[test]
fn draws_follow_their_density_which_integrates_to_1() {
    const SAMPLES: usize = 40_000;
    let all = all();
    let p_level = sidak(0.01, 3 * 4 * all.len());
    for (name, material) in all {
        for (i, theta) in [0.017f32, 0.7, 1.4].into_iter().enumerate() {
            let wo = Vec3::new(-0.6 * theta.sin(), 0.8 * theta.sin(), theta.cos());
            let mut m = Mixture::<64>::empty();
            material.prepare(wo, &mut m).unwrap();
            let partition = Partition::new(&m, |d| material.pdf(wo, d));
            let total = partition.total();
            assert!((total - 1.0).abs() < 3e-5, "{name} at {theta}: the density integrates to {total}");
            for_each_level(|level| {
                let mut random = Random(100 + i as u64);
                let result = partition
                    .test(SAMPLES, || material.sample(wo, random.three()).expect("it reflects").direction);
                let p = result.p;
                assert!(p > p_level, "{level:?} {name} at {theta}: p = {p:e}, level {p_level:e}");
            });
        }
    }
}

/// The outputs of a batch.
struct Batch {
    direction: Soa,
    pdf: Vec<f32>,
    weight: Soa,
    value: Soa,
    density: Vec<f32>,
}

impl Batch {
    fn new(n: usize) -> Self {
        let empty = || Soa::empty(n);
        let (pdf, density) = (vec![f32::NAN; n], vec![f32::NAN; n]);
        Self { direction: empty(), pdf, weight: empty(), value: empty(), density }
    }

    fn request<'a>(&'a mut self, u: &'a Soa, wi: &'a Soa) -> Request<'a> {
        Request {
            draw: Some(Draws {
                u: u.slices(),
                direction: self.direction.slices_mut(),
                pdf: Some(&mut self.pdf),
                weight: Some(self.weight.slices_mut()),
            }),
            evaluate: Some(Towards {
                wi: wi.slices(),
                value: Some(self.value.slices_mut()),
                pdf: Some(&mut self.density),
            }),
        }
    }

    /// Checks what hit `i` has.
    fn check(&self, i: usize, material: &Material<Vec<u8>>, wo: Vec3, u: [f32; 3], wi: Vec3, what: &str) {
        let (sample, (value, pdf)) = material.sample_and_evaluate(wo, u, wi);
        // Another lobe where a number falls on the edge between two: rounding decides.
        let (d, scale) = (self.direction.at(i), value.abs().max_element());
        match sample {
            None => assert_eq!((d, self.pdf[i], self.weight.at(i)), (Vec3::Z, 0.0, Vec3::ZERO), "{what}"),
            Some(sample) => {
                let found = Sample { direction: d, pdf: self.pdf[i], weight: self.weight.at(i) };
                assert!(apart(&sample, &found) < 1e-2, "{what}: {sample:?} {found:?}");
                let again = material.pdf(wo, d);
                assert!((found.pdf / again - 1.0).abs() < 1e-5, "{what}: {} {again}", found.pdf);
            }
        }
        let off = (self.value.at(i) - value).abs().max_element();
        assert!(off <= OFF * scale + 1e-30, "{what}: {} {value}", self.value.at(i));
        assert!((self.density[i] - pdf).abs() <= OFF * pdf + 1e-30, "{what}: {} {pdf}", self.density[i]);
    }
}

#[test]
fn batches_are_many_single_answers_whatever_their_number() {
    let all = all();
    for_each_level(|level| {
        let mut random = Random(21);
        for n in (0..=35).chain([64, 100]) {
            let wo: Vec<Vec3> = (0..n).map(|_| upper(&mut random)).collect();
            let wi: Vec<Vec3> = (0..n).map(|_| upper(&mut random)).collect();
            let u: Vec<Vec3> = (0..n).map(|_| random.three().into()).collect();
            let (wo, wi, u) = (Soa::new(&wo), Soa::new(&wi), Soa::new(&u));
            let materials: Vec<&Material<Vec<u8>>> =
                (0..n).map(|_| &all[random.below(all.len())].1).collect();
            let mut batch = Batch::new(n);
            Material::ask_each(&materials, wo.slices(), batch.request(&u, &wi)).unwrap();
            for (i, material) in materials.iter().enumerate() {
                let what = format!("{level:?}, {i} of {n} of many materials");
                batch.check(i, material, wo.at(i), u.at(i).to_array(), wi.at(i), &what);
            }
            let (name, material) = &all[n % all.len()];
            let mut batch = Batch::new(n);
            material.ask(wo.slices(), batch.request(&u, &wi)).unwrap();
            for i in 0..n {
                let what = format!("{level:?}, {i} of {n} of {name}");
                batch.check(i, material, wo.at(i), u.at(i).to_array(), wi.at(i), &what);
            }
        }
    });
}

#[test]
fn what_is_not_wanted_changes_nothing_else() {
    let all = all();
    let n = 37;
    for_each_level(|level| {
        let mut random = Random(22);
        let wo = Soa::new(&(0..n).map(|_| upper(&mut random)).collect::<Vec<_>>());
        let wi = Soa::new(&(0..n).map(|_| upper(&mut random)).collect::<Vec<_>>());
        let u = Soa::new(&(0..n).map(|_| random.three().into()).collect::<Vec<_>>());
        for (name, material) in &all {
            let mut whole = Batch::new(n);
            material.ask(wo.slices(), whole.request(&u, &wi)).unwrap();
            for outputs in 0..32u32 {
                let is = |bit: u32| outputs >> bit & 1 == 1;
                let mut batch = Batch::new(n);
                let Request { draw, evaluate } = batch.request(&u, &wi);
                let draw = draw.filter(|_| is(0)).map(|draw| Draws {
                    pdf: draw.pdf.filter(|_| is(1)),
                    weight: draw.weight.filter(|_| is(2)),
                    ..draw
                });
                let evaluate = evaluate.map(|towards| Towards {
                    value: towards.value.filter(|_| is(3)),
                    pdf: towards.pdf.filter(|_| is(4)),
                    ..towards
                });
                material.ask(wo.slices(), Request { draw, evaluate }).unwrap();
                let same = |found: &[f32], wanted: &[f32], is: bool| {
                    let all = if is { found == wanted } else { found.iter().all(|x| x.is_nan()) };
                    assert!(all, "{level:?} {name} {outputs:b}");
                };
                same(&batch.direction.0[0], &whole.direction.0[0], is(0));
                same(&batch.pdf, &whole.pdf, is(0) && is(1));
                same(&batch.weight.0[1], &whole.weight.0[1], is(0) && is(2));
                same(&batch.value.0[2], &whole.value.0[2], is(3));
                same(&batch.density, &whole.density, is(4));
            }
        }
    });
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
    let n = none.len();
    let (wo, wi, u) = (Soa::new(&none), Soa::new(&vec![Vec3::Z; n]), Soa::new(&vec![Vec3::splat(0.5); n]));
    for (name, material) in all() {
        for_each_level(|level| {
            let mut batch = Batch::new(n);
            material.ask(wo.slices(), batch.request(&u, &wi)).unwrap();
            for (i, &wo) in none.iter().enumerate() {
                let all = (batch.direction.at(i), batch.pdf[i], batch.weight.at(i));
                assert_eq!(all, (Vec3::Z, 0.0, Vec3::ZERO), "{level:?} {name} {wo}");
                assert_eq!((batch.value.at(i), batch.density[i]), (Vec3::ZERO, 0.0), "{level:?} {name} {wo}");
                assert_eq!(
                    material.sample_and_evaluate(wo, [0.5; 3], Vec3::Z),
                    (None, (Vec3::ZERO, 0.0)),
                    "{name}"
                );
            }
            // Incident directions below the horizon.
            let below = Vec3::new(0.6, 0.0, -0.8);
            assert_eq!(material.evaluate_and_pdf(Vec3::Z, below), (Vec3::ZERO, 0.0), "{level:?} {name}");
        });
    }
}

#[test]
fn slices_of_other_lengths_are_refused() {
    let (_, material) = &all()[0];
    let two = Soa::new(&[Vec3::Z; 2]);
    let (three, mut batch) = (Soa::new(&[Vec3::Z; 3]), Batch::new(2));
    assert_eq!(material.ask(two.slices(), batch.request(&three, &two)), Err(Error::Length));
    assert_eq!(material.ask(two.slices(), batch.request(&two, &three)), Err(Error::Length));
    assert_eq!(material.ask(three.slices(), batch.request(&two, &two)), Err(Error::Length));
    assert_eq!(
        Material::ask_each(&[material; 3], two.slices(), batch.request(&two, &two)),
        Err(Error::Length)
    );
    assert!(batch.pdf.iter().all(|pdf| pdf.is_nan()), "nothing is written");
    assert_eq!(material.ask(two.slices(), Request::default()), Ok(()));
}

#[test]
fn mixtures_answer_requests_as_they_answer_one_by_one() {
    let all = all();
    for_each_level(|level| {
        let mut random = Random(23);
        for (n, (name, material)) in [1, 7, 16, 45].into_iter().flat_map(|n| all.iter().map(move |m| (n, m)))
        {
            let wo: Vec<Vec3> = (0..n).map(|_| upper(&mut random)).collect();
            let wi = Soa::new(&(0..n).map(|_| upper(&mut random)).collect::<Vec<_>>());
            let u = Soa::new(&(0..n).map(|_| random.three().into()).collect::<Vec<_>>());
            let mut mixtures = vec![Mixture::<64>::empty(); n];
            for (m, &wo) in mixtures.iter_mut().zip(&wo) {
                material.prepare(wo, m).unwrap();
            }
            let (mut each, mut one) = (Batch::new(n), Batch::new(n));
            AnyMixture::ask_each(&mixtures, each.request(&u, &wi)).unwrap();
            mixtures[0].ask(one.request(&u, &wi)).unwrap();
            // Directions without densities, and weights without them, are the same ones.
            for wants_weight in [false, true] {
                let mut alone = Batch::new(n);
                let Request { draw, .. } = alone.request(&u, &wi);
                let draw = draw.map(|draw| Draws {
                    pdf: None,
                    weight: draw.weight.filter(|_| wants_weight),
                    ..draw
                });
                mixtures[0].ask(Request { draw, evaluate: None }).unwrap();
                assert_eq!(alone.direction.0, one.direction.0, "{level:?} {name}");
                assert!(alone.pdf.iter().chain(&alone.density).all(|x| x.is_nan()), "{level:?} {name}");
                let weights = if wants_weight { &one.weight.0[1] } else { &alone.pdf };
                assert!(
                    alone.weight.0[1].iter().zip(weights).all(|(a, b)| a == b || a.is_nan() && b.is_nan())
                );
            }
            for (i, of_hit) in mixtures.iter().enumerate() {
                for (batch, m) in [(&each, of_hit), (&one, &mixtures[0])] {
                    let what = format!("{level:?}, {i} of {n} of {name}");
                    let (sample, (value, pdf)) = m.sample_and_evaluate(u.at(i).to_array(), wi.at(i));
                    let (d, weight) = (batch.direction.at(i), batch.weight.at(i));
                    let found = Sample { direction: d, pdf: batch.pdf[i], weight };
                    assert!(apart(&sample.unwrap(), &found) < 1e-2, "{what}: {sample:?} {found:?}");
                    // A rounding of the direction, 6e-8, counts as many times as a lobe has widths in a radian.
                    let sharpest =
                        (0..m.len()).map(|k| m.lobe(k).unwrap().gaussian.sharpness).fold(1e4, f32::max);
                    assert!((found.pdf / m.pdf(d) - 1.0).abs() < 1e-7 * sharpest.sqrt(), "{what}");
                    let off = (batch.value.at(i) - value).abs().max_element();
                    assert!(off <= OFF * value.abs().max_element() + 1e-30, "{what}");
                    assert!((batch.density[i] - pdf).abs() <= OFF * pdf + 1e-30, "{what}");
                }
            }
        }
    });
}

#[test]
fn the_processor_is_named_as_the_system_names_it() {
    let name = Processor::this().to_string();
    println!("{name}");
    let Ok(text) = std::fs::read_to_string("/proc/cpuinfo") else { return };
    let field = |name: &str| {
        let is_it = |(key, value): (&str, &str)| (key.trim() == name).then(|| value.trim().to_owned());
        text.lines().find_map(|line| is_it(line.split_once(':')?))
    };
    if let (Some(maker), Some(family), Some(model)) =
        (field("vendor_id"), field("cpu family"), field("model"))
    {
        assert_eq!(name, format!("{maker}, family {family}, model {model}"));
    }
}
