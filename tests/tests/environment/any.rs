//! Light of any kind: an environment behind the two verbs is the environment; means of lights that know little, and of lights that
//! break every promise.
#![allow(clippy::needless_range_loop)] // rows are read side by side

use glam::{DVec3, Vec3};
use srbf_core::{
    Environment, Error, LIGHT_BLOCK, LightBlock, LightRows, LightSource, Lobe, Material, Mixture,
    ProductSampling, luminance,
};
use srbf_tests::inputs::{Random, levels};
use srbf_tests::maps::{Map, Moments, bright, frame, to_local, to_world};
use srbf_tests::statistics::sidak;
use std::path::Path;

/// A light by its two verbs alone: kernels do not see that it is a map.
struct Hidden<'a>(&'a Environment<Vec<u32>>);

impl LightSource for Hidden<'_> {
    fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
        self.0.sample_into(u, to);
    }
    fn evaluate_into(&self, count: usize, to: &mut LightRows) {
        self.0.evaluate_into(count, to);
    }
}

fn mixtures() -> Vec<(String, Mixture<'static, 64>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../presets");
    let mut all = Vec::new();
    for (name, wo) in [("cayman", Vec3::new(0.36, 0.48, 0.8)), ("krylon_blue", Vec3::new(0.0, -0.96, 0.28))] {
        let bytes = std::fs::read(folder.join(name).with_extension("srbf")).unwrap();
        let material: &'static Material<Vec<u8>> = Box::leak(Box::new(Material::from_bytes(bytes).unwrap()));
        let mut m = Mixture::empty();
        material.prepare(wo, &mut m).unwrap();
        all.push((name.to_owned(), m));
    }
    let sharp = Lobe::new(Vec3::new(0.5, 0.2, 1.0).normalize(), 400.0, Vec3::new(20.0, 15.0, 3.0)).unwrap();
    let wide = Lobe::new(Vec3::Z, 2.0, Vec3::splat(0.1)).unwrap();
    all.push(("lobes".into(), Mixture::hemisphere(&[sharp, wide]).unwrap()));
    all
}

fn numbers<const N: usize>(random: &mut Random) -> [[f32; N]; 3] {
    let mut u = [[0.0; N]; 3];
    u.as_flattened_mut().fill_with(|| random.uniform());
    u
}

/// `a` and `b` agree, up to rounding.
fn is_near(a: Vec3, b: Vec3) -> bool {
    (a - b).abs().max_element() <= 2e-3 * (a.abs().max_element() + b.abs().max_element())
}

#[test]
fn a_map_behind_two_verbs_draws_what_the_map_draws() {
    let (mut near, mut all) = (0, 0);
    for (name, m) in mixtures() {
        for map in [Map::sky(), Map::noise(64, 33)] {
            let environment = map.environment().turned(0.7);
            let hidden = Hidden(&environment);
            for level in levels() {
                let m = m.clone().with_level(level).unwrap();
                let mut random = Random(41);
                for round in 0..200 {
                    let u = numbers::<32>(&mut random);
                    let axes = frame(random.direction());
                    let (choice, count) = (random.uniform(), [2, 8, 16, 17, 32][round % 5]);
                    let sampling = ProductSampling::new(count, [0.5, 0.0, 1.0][round % 3], 4.0).unwrap();
                    let given = u.each_ref().map(|u| &u[..count]);
                    let one = m.sample_product(&environment, &axes, &sampling, given, choice).unwrap();
                    let other = m.sample_product(&hidden, &axes, &sampling, given, choice).unwrap();
                    assert_eq!(one.is_some(), other.is_some(), "{name} {level:?}");
                    all += 1;
                    if let (Some(one), Some(other)) = (one, other) {
                        let radiance = environment.radiance(one.direction);
                        assert!(is_near(one.factor * radiance, one.weight), "{name} {level:?}: {one:?}");
                        near += usize::from(
                            is_near(one.weight, other.weight)
                                && is_near(one.factor, other.factor)
                                && is_near(one.direction, other.direction),
                        );
                    } else {
                        near += 1;
                    }

                    let v = numbers::<LIGHT_BLOCK>(&mut random);
                    let block = LightBlock::new(&environment, v.each_ref());
                    let same = LightBlock::new(&hidden, v.each_ref());
                    for (a, b) in block.light.as_flattened().iter().zip(same.light.as_flattened()) {
                        assert!((a - b).abs() <= 1e-5 * a.abs(), "{block:?} {same:?}");
                    }
                    let given = u.each_ref().map(|u| &u[..8]);
                    let one = m.reflect(&environment, &block, &axes, axes[2], given, choice).unwrap();
                    let other = m.reflect(&hidden, &block, &axes, axes[2], given, choice).unwrap();
                    assert!(is_near(one.block_sum, other.block_sum) && is_near(one.ray_sum, other.ray_sum));
                    assert!(is_near(one.ray_light, other.ray_light), "{name} {level:?}: {one:?} {other:?}");
                    // The map's own radiance is no correction.
                    let ray = environment.radiance(to_world(&axes, one.ray.unwrap().direction));
                    let shadow = one.shadow.map_or(Vec3::ZERO, |d| environment.radiance(d));
                    for [r, s] in [[ray, shadow], [ray, Vec3::ZERO], [Vec3::ZERO, shadow]] {
                        let (from, light) =
                            (one.light_from(r, s), one.light(r != Vec3::ZERO, s != Vec3::ZERO));
                        // Where nothing of the light is reflected, the share of it is not known.
                        let scale = one.block_sum + one.ray_sum + light.abs();
                        assert!(
                            (from - light).abs().max_element() <= 4e-3 * scale.max_element(),
                            "{name} {level:?}: {from} {light}, {one:?}"
                        );
                    }
                }
            }
        }
    }
    println!("{near} of {all} draws alike");
    // The density that is looked up differs from that of a draw by rounding: a few choose another candidate.
    assert!(near as f64 > 0.99 * f64::from(all), "{near} of {all}");
}

/// A light of three round lobes of its own, which knows nothing of what there is.
struct Guess(Mixture<'static, 16>);

impl Guess {
    fn new() -> Self {
        let lobe = |axis: [f32; 3], sharpness: f32, bright: f32| {
            Lobe::new(Vec3::from(axis).normalize(), sharpness, Vec3::splat(bright)).unwrap()
        };
        let lobes = [
            lobe([0.3, 0.2, 0.9], 6.0, 1.0),
            lobe([-0.8, 0.1, 0.2], 30.0, 4.0),
            lobe([0.0, 0.0, 1.0], 0.1, 0.1),
        ];
        Self(Mixture::new(srbf_core::Domain::Sphere, 1.0, &[], &lobes).unwrap())
    }
}

impl LightSource for Guess {
    fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
        for i in 0..u[0].len() {
            let d = self.0.sample_direction([u[0][i], u[1][i], u[2][i]]).unwrap();
            (0..3).for_each(|k| to.direction[k][i] = d[k]);
        }
        self.evaluate_into(u[0].len(), to);
    }
    fn evaluate_into(&self, count: usize, to: &mut LightRows) {
        for i in 0..count {
            let d = Vec3::new(to.direction[0][i], to.direction[1][i], to.direction[2][i]);
            let (value, pdf) = self.0.evaluate_and_pdf(d);
            (0..3).for_each(|k| to.radiance[k][i] = value[k] + 0.02);
            to.pdf[i] = pdf;
        }
    }
}

/// As [`Guess`], of which half of the draws find nothing.
struct Seldom(Guess);

impl LightSource for Seldom {
    fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
        let first: Vec<f32> = u[0].iter().map(|u| (2.0 * u).fract()).collect();
        self.0.sample_into([&first, u[1], u[2]], to);
        for i in 0..first.len() {
            to.pdf[i] *= if u[0][i] < 0.5 { 0.0 } else { 0.5 };
        }
    }
    fn evaluate_into(&self, count: usize, to: &mut LightRows) {
        self.0.evaluate_into(count, to);
        to.pdf[..count].iter_mut().for_each(|pdf| *pdf *= 0.5);
    }
}

/// What there is in truth: behind an occluder, noisy.
const TRUTHS: [fn(Vec3, &mut Random) -> f32; 3] = [
    |d, _| 1.0 + d.x,
    |d, _| if d.y > 0.2 * d.x { 0.0 } else { 2.0 + d.z },
    |d, random| -(1.0 - random.uniform()).ln() * (1.5 + d.y),
];

/// How many standard errors the means of both estimators are from that of the lobes alone.
fn apart(
    m: &Mixture<'_, 64>,
    light: &impl LightSource,
    truth: fn(Vec3, &mut Random) -> f32,
    seed: u64,
) -> [f64; 2] {
    let mut random = Random(seed);
    let axes = frame(Vec3::new(0.2, -0.3, 0.9).normalize());
    let (mut alone, mut product, mut even) = (Moments::default(), Moments::default(), Moments::default());
    let sampling = ProductSampling::new(8, 0.5, f32::INFINITY).unwrap();
    for _ in 0..60_000 {
        let u = numbers::<8>(&mut random);
        let drawn = m
            .sample_product(light, &axes, &sampling, u.each_ref().map(|u| &u[..]), random.uniform())
            .unwrap();
        product.see(drawn.map_or(0.0, |d| bright(d.factor * truth(d.direction, &mut random))));

        let block = LightBlock::new(light, numbers(&mut random).each_ref());
        let u = numbers::<8>(&mut random);
        let u = u.each_ref().map(|u| &u[..]);
        let drawn = m.reflect(light, &block, &axes, axes[2], u, random.uniform()).unwrap();
        let mut found = |d: Option<Vec3>| {
            Vec3::splat(d.filter(|d| d.dot(axes[2]) > 0.0).map_or(0.0, |d| truth(d, &mut random)))
        };
        let ray = found(drawn.ray.map(|ray| to_world(&axes, ray.direction)));
        let shadow = found(drawn.shadow);
        even.see(bright(drawn.light_from(ray, shadow)));
    }
    for _ in 0..600_000 {
        let sample = m.sample(random.three()).unwrap();
        alone.see(bright(sample.weight * truth(to_world(&axes, sample.direction), &mut random)));
    }
    [product, even].map(|m| (m.mean() - alone.mean()) / m.error().hypot(alone.error()))
}

#[test]
fn means_are_those_of_the_truth_whatever_the_light_knows() {
    let mut z = Vec::new();
    for (i, (name, m)) in mixtures().iter().enumerate() {
        for (j, truth) in TRUTHS.into_iter().enumerate() {
            let seed = 700 + 10 * i as u64 + j as u64;
            z.extend(apart(m, &Guess::new(), truth, seed));
            z.extend(apart(m, &Seldom(Guess::new()), truth, 50 + seed));
            println!("{name}, truth {j}: {:.2?} standard errors", &z[z.len() - 4..]);
        }
    }
    let worst = z.iter().fold(0f64, |a, b| a.max(b.abs()));
    println!("{} means: worst {worst:.2}", z.len());
    assert!(worst < 4.0 && sidak(0.01, z.len()) > 6.4e-5, "{worst}");
    // A density that is 10 % too large is found.
    struct Wrong(Guess);
    impl LightSource for Wrong {
        fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
            self.0.sample_into(u, to);
            to.pdf.iter_mut().for_each(|pdf| *pdf *= 1.1);
        }
        fn evaluate_into(&self, count: usize, to: &mut LightRows) {
            self.0.evaluate_into(count, to);
            to.pdf.iter_mut().for_each(|pdf| *pdf *= 1.1);
        }
    }
    let (_, m) = &mixtures()[0];
    let planted = apart(m, &Wrong(Guess::new()), TRUTHS[0], 3);
    println!("planted: {planted:.1?}");
    assert!(planted[0].abs() > 5.0, "{planted:?}");
}

/// Numbers that mean nothing.
const NONSENSE: [f32; 12] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    0.0,
    -0.0,
    -1.0,
    f32::MAX,
    f32::MIN,
    1e-45,
    1e-38,
    1.0,
    3e30,
];

/// A light that answers anything.
struct Hostile(std::cell::RefCell<Random>);

impl Hostile {
    fn any(&self) -> f32 {
        let mut random = self.0.borrow_mut();
        NONSENSE[(random.uniform() * NONSENSE.len() as f32) as usize]
    }
}

impl LightSource for Hostile {
    fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
        self.evaluate_into(u[0].len(), to);
        for i in 0..u[0].len() {
            let is_direction = self.0.borrow_mut().uniform() < 0.5;
            let d = if is_direction {
                self.0.borrow_mut().direction()
            } else {
                Vec3::from_array([(); 3].map(|()| self.any()))
            };
            (0..3).for_each(|k| to.direction[k][i] = d[k]);
        }
    }
    fn evaluate_into(&self, _: usize, to: &mut LightRows) {
        to.radiance.as_flattened_mut().iter_mut().chain(&mut to.pdf).for_each(|number| *number = self.any());
        to.direction[0][0] = self.any();
    }
}

#[test]
fn nothing_that_a_light_answers_makes_a_nan() {
    let light = Hostile(std::cell::RefCell::new(Random(8)));
    let mut random = Random(9);
    let (mut drawn, mut refused) = (0, 0);
    for (_, m) in mixtures() {
        for level in levels() {
            let m = m.clone().with_level(level).unwrap();
            for round in 0..3000 {
                let u = numbers::<32>(&mut random);
                let axes = frame(random.direction());
                let (choice, count) = (random.uniform(), [2, 3, 8, 17, 32][round % 5]);
                let sampling = ProductSampling::new(count, [0.5, 0.0, 1.0][round % 3], 4.0).unwrap();
                let given = u.each_ref().map(|u| &u[..count]);
                if let Some(d) = m.sample_product(&light, &axes, &sampling, given, choice).unwrap() {
                    drawn += 1;
                    assert!((d.direction.length() - 1.0).abs() < 1e-3, "{d:?}");
                    assert!(d.factor.is_finite() && !d.weight.is_nan(), "{d:?}");
                }
                let block = LightBlock::new(&light, numbers(&mut random).each_ref());
                let given = u.each_ref().map(|u| &u[..1 + round % 16]);
                match m.reflect(&light, &block, &axes, axes[2], given, choice) {
                    Err(error) => {
                        assert_eq!(error, Error::Amplitude);
                        refused += 1;
                    }
                    Ok(r) => {
                        for bits in 0..4 {
                            let light = r.light(bits & 1 == 1, bits & 2 == 2);
                            assert!(!light.is_nan(), "{r:?}");
                        }
                        let from = r.light_from(Vec3::ONE, Vec3::ZERO);
                        assert!(!from.is_nan(), "{r:?}");
                        assert!(r.ray_factor.is_finite() && r.shadow_factor.is_finite());
                    }
                }
            }
        }
    }
    println!("{drawn} drawn, {refused} overflow");
    assert!(drawn > 1000 && refused > 100);
}

/// A light is taken through a reference to a trait object too.
#[test]
fn a_light_may_be_a_trait_object() {
    let environment = Map::sky().environment();
    let object: &dyn LightSource = &environment;
    assert!(object.environment().is_some() && Hidden(&environment).environment().is_none());
    let (_, m) = &mixtures()[0];
    let axes = frame(Vec3::Z);
    let sampling = ProductSampling::new(8, 0.5, f32::INFINITY).unwrap();
    let u = numbers::<8>(&mut Random(4));
    let u = u.each_ref().map(|u| &u[..]);
    let one = m.sample_product(&environment, &axes, &sampling, u, 0.3).unwrap();
    assert_eq!(m.sample_product(&object, &axes, &sampling, u, 0.3).unwrap(), one);
    let d = one.unwrap().direction;
    let mut rows = LightRows::NONE;
    (0..3).for_each(|k| rows.direction[k][0] = d[k]);
    object.evaluate_into(1, &mut rows);
    assert_eq!(rows.pdf[0], environment.pdf(d));
    let local = to_local(&axes, d).as_dvec3();
    assert!((local.length() - 1.0).abs() < 1e-5 && local.dot(DVec3::Z) > 0.0);
    assert!(luminance(environment.radiance(d)) > 0.0);
}
