//! Blends: values, draws and densities of several materials at one hit, tints, coats, requests.

use glam::Vec3;
use srbf_core::{
    AnyMixture, Blend, BlendPart, Draws, Error, Grid, GridView, Lobe, MAX_BLEND, Material, Mixture, Request,
    Sample, TiltedLobe, Towards, fresnel, luminance,
};
use srbf_tests::inputs::Random;
use srbf_tests::kinds::{Soa, for_each_level, materials, upper};
use srbf_tests::partition::Partition;
use srbf_tests::statistics::sidak;

const SAMPLES: usize = 60_000;
const ALPHA: f64 = 0.01;

/// Places among the kinds of materials, weights, tints, and the index of a coat.
type Recipe = &'static [(usize, f32, [f32; 3], f32)];

/// Of two, of four with factors and many lobes, with a black part, with coats.
const RECIPES: [Recipe; 5] = [
    &[(8, 0.7, [1.0; 3], 1.0), (7, 0.3, [1.0, 0.8, 0.6], 1.0)],
    &[
        (3, 0.1, [0.3, 1.0, 0.5], 1.0),
        (6, 0.4, [1.0; 3], 1.0),
        (5, 0.2, [0.9, 0.2, 0.1], 1.0),
        (1, 0.3, [1.0; 3], 1.0),
    ],
    &[(8, 0.5, [1.0; 3], 1.0), (0, 0.0, [1.0; 3], 1.0), (9, 0.5, [0.0, 0.0, 1.0], 1.0)],
    &[(9, 1.0, [1.0; 3], 1.5), (8, 0.05, [1.0; 3], 1.0)],
    &[
        (0, 2.0, [1.0; 3], 1.0),
        (2, 1e-3, [1.0; 3], 1.33),
        (4, 0.5, [0.1, 0.2, 0.3], 1.0),
        (11, 1.0, [1.0; 3], 1.0),
        (12, 0.5, [1.0; 3], 1.0),
    ],
];

fn all() -> Vec<Material<Vec<u8>>> {
    materials().into_iter().map(|(_, bytes)| Material::from_bytes(bytes).unwrap()).collect()
}

/// A material that a turn changes.
fn anisotropic() -> Material<Vec<u8>> {
    let (thetas, azimuths) = ([0.0, 0.7, 1.4], 4usize);
    let lobes = thetas.map(|theta| {
        [0.9, 1.1].map(|share| TiltedLobe {
            tilt: [theta * share, 0.0],
            log2_sharpness: 6.0,
            log2_luminance: -2.0,
            color_differences: [-0.1, 0.2],
        })
    });
    let views: Vec<GridView<'_>> = (0..1 + 2 * azimuths)
        .map(|view| GridView {
            log2_squeeze: [0.5, 0.0, -0.5],
            log2_diffuse: -4.0,
            diffuse_color_differences: [-0.4, 0.3],
            lobes: &lobes[view.div_ceil(azimuths)],
        })
        .collect();
    let grid =
        Grid { thetas: &thetas, azimuths, turns: 2, axis: 0.3, views: &views, squeezed: 1, factors: None };
    let mut bytes = vec![0; grid.encoded_len("")];
    grid.encode("", &mut bytes).unwrap();
    Material::from_bytes(bytes).unwrap()
}

fn parts<'a>(all: &'a [Material<Vec<u8>>], recipe: Recipe) -> Vec<BlendPart<'a>> {
    recipe
        .iter()
        .map(|&(n, weight, tint, index)| BlendPart::new(&all[n], weight).tinted(tint).coated(index))
        .collect()
}

/// Outgoing directions from the normal to almost grazing.
fn outgoing(n: usize) -> Vec<Vec3> {
    (0..n)
        .map(|i| {
            let (theta, phi) = ((4.0 + 80.0 * i as f32 / n as f32).to_radians(), 2.4 * i as f32);
            Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
        })
        .collect()
}

#[test]
fn a_blend_of_one_is_its_material_to_the_bit() {
    let mut all = all();
    all.push(anisotropic());
    for_each_level(|level| {
        for (n, material) in all.iter().enumerate() {
            let other = &all[(n + 1) % all.len()];
            let alone = [BlendPart::new(material, 1.0)];
            let beside_black = [BlendPart::new(other, 0.0), BlendPart::new(material, 1.0)];
            let beside_dark = [BlendPart::new(material, 1.0), BlendPart::new(other, 1.0).tinted([0.0; 3])];
            let mut random = Random(n as u64);
            for _ in 0..50 {
                let (wo, wi, u) = (upper(&mut random), random.direction(), random.three());
                let wanted = material.sample_and_evaluate(wo, u, wi);
                let mut mixture = Mixture::<64>::empty();
                material.prepare(wo, &mut mixture).unwrap();
                for parts in [&alone[..], &beside_black, &beside_dark] {
                    let blend = Blend::new(parts).unwrap();
                    assert_eq!(blend.sample_and_evaluate(wo, u, wi), wanted, "{level:?} {n}");
                    assert_eq!(blend.sample(wo, u), material.sample(wo, u), "{level:?} {n}");
                    assert_eq!(blend.evaluate_and_pdf(wo, wi), material.evaluate_and_pdf(wo, wi));
                    assert_eq!(blend.pdf(wo, wi), material.pdf(wo, wi), "{level:?} {n}");
                    assert_eq!(blend.albedo(wo), mixture.albedo(), "{level:?} {n}");
                    let (_, part, left) = blend.choose(u[0]);
                    let one = [part];
                    let chosen = Blend::new(&one).unwrap().sample(wo, [left, u[1], u[2]]);
                    assert_eq!(chosen, material.sample(wo, u), "{level:?} {n}");
                }
                let prepared = [BlendPart::of_mixture(&mixture, 1.0)];
                let blend = Blend::new(&prepared).unwrap();
                let wanted = mixture.sample_and_evaluate(u, wi);
                assert_eq!(blend.sample_and_evaluate(wo, u, wi), wanted, "{level:?} {n}");
            }
            // Whole blocks too.
            let (wo, wi, u): (Vec<_>, Vec<_>, Vec<_>) = (0..40)
                .map(|_| (upper(&mut random), random.direction(), Vec3::from(random.three())))
                .collect();
            let wanted = ask(&|wo, request| material.ask(wo, request), &wo, &wi, &u);
            let blend = Blend::new(&beside_black).unwrap();
            assert_eq!(ask(&|wo, request| blend.ask(wo, request), &wo, &wi, &u), wanted, "{level:?} {n}");
        }
    });
}

/// Directions, densities, weights, values, densities.
type Answers = Vec<(Vec3, f32, Vec3, Vec3, f32)>;

/// A request of a material or a blend.
type Verb<'a> = &'a dyn Fn([&[f32]; 3], Request<'_>) -> Result<(), Error>;

fn ask(verb: Verb<'_>, wo: &[Vec3], wi: &[Vec3], u: &[Vec3]) -> Answers {
    let (n, wo, wi, u) = (wo.len(), Soa::new(wo), Soa::new(wi), Soa::new(u));
    let (mut direction, mut weight, mut value) = (Soa::empty(n), Soa::empty(n), Soa::empty(n));
    let (mut pdf, mut density) = (vec![f32::NAN; n], vec![f32::NAN; n]);
    let draw = Draws {
        u: u.slices(),
        direction: direction.slices_mut(),
        pdf: Some(&mut pdf),
        weight: Some(weight.slices_mut()),
    };
    let towards = Towards { wi: wi.slices(), value: Some(value.slices_mut()), pdf: Some(&mut density) };
    verb(wo.slices(), Request { draw: Some(draw), evaluate: Some(towards) }).unwrap();
    (0..n).map(|i| (direction.at(i), pdf[i], weight.at(i), value.at(i), density[i])).collect()
}

#[test]
fn values_are_sums_and_draws_tell_their_density() {
    let all = all();
    for_each_level(|level| {
        for (n, recipe) in RECIPES.into_iter().enumerate() {
            let parts = parts(&all, recipe);
            let blend = Blend::new(&parts).unwrap();
            let mut random = Random(n as u64);
            for wo in outgoing(12) {
                let mut mixtures = vec![Mixture::<64>::empty(); recipe.len()];
                let mut powers = Vec::new();
                for (&(place, weight, tint, index), mixture) in recipe.iter().zip(&mut mixtures) {
                    all[place].prepare(wo, mixture).unwrap();
                    powers.push(weight * luminance(tint) * (1.0 - fresnel(index, wo.z)) * mixture.power());
                }
                let total: f32 = powers.iter().sum();
                let expected = |wi: Vec3| {
                    let (mut value, mut pdf) = (Vec3::ZERO, 0.0);
                    for ((&(_, weight, tint, index), mixture), power) in
                        recipe.iter().zip(&mixtures).zip(&powers)
                    {
                        let (own, density) = mixture.evaluate_and_pdf(wi);
                        let coat = (1.0 - fresnel(index, wo.z)) * (1.0 - fresnel(index, wi.z));
                        value += own * Vec3::from(tint) * (weight * coat);
                        pdf += density * power / total;
                    }
                    (value, pdf)
                };
                let prepared: Vec<BlendPart<'_>> = recipe
                    .iter()
                    .zip(&mixtures)
                    .map(|(&(_, weight, tint, index), mixture)| {
                        BlendPart::of_mixture(mixture, weight).tinted(tint).coated(index)
                    })
                    .collect();
                let of_mixtures = Blend::new(&prepared).unwrap();
                let hits: Vec<_> =
                    (0..40).map(|_| (wo, random.direction(), Vec3::from(random.three()))).collect();
                let (wos, wis, us): (Vec<_>, Vec<_>, Vec<_>) = hits.iter().copied().collect();
                let asked = ask(&|wo, request| blend.ask(wo, request), &wos, &wis, &us);
                for (&(wo, wi, u), asked) in hits.iter().zip(&asked) {
                    let u = u.to_array();
                    let (value, pdf) = blend.evaluate_and_pdf(wo, wi);
                    let wanted = expected(wi);
                    let near = |a: Vec3, b: Vec3, off: f32| {
                        (a - b).abs().max_element() <= off * b.abs().max_element().max(1e-3)
                    };
                    let close = |a: f32, b: f32, off: f32| (a - b).abs() <= off * b.max(1e-3);
                    assert!(near(value, wanted.0, 1e-4), "{level:?} {n} {value} {}", wanted.0);
                    assert!(close(pdf, wanted.1, 1e-4), "{level:?} {n} {pdf} {}", wanted.1);
                    assert_eq!(blend.evaluate(wo, wi), value);
                    assert!(close(blend.pdf(wo, wi), pdf, 1e-4));
                    let sample = blend.sample(wo, u).expect("it reflects");
                    // Without a draw the lobes are summed without mixtures: the same but for rounding.
                    let both = blend.sample_and_evaluate(wo, u, wi);
                    assert_eq!(both.0, Some(sample), "{level:?} {n}");
                    assert!(
                        near(both.1.0, value, 1e-4) && close(both.1.1, pdf, 1e-4),
                        "{level:?} {n}: {both:?}"
                    );
                    let prepared = of_mixtures.sample_and_evaluate(wo, u, wi);
                    assert_eq!(prepared, both, "{level:?} {n}");
                    let check = |Sample { direction, pdf, weight }: Sample| {
                        let (value, density) = blend.evaluate_and_pdf(wo, direction);
                        assert!((density / pdf - 1.0).abs() < 2e-3, "{level:?} {n}: {density} {pdf}");
                        assert!(near(weight * pdf, value, 2e-3), "{level:?} {n}: {weight} {pdf} {value}");
                    };
                    check(sample);
                    check(Sample { direction: asked.0, pdf: asked.1, weight: asked.2 });
                    assert!(
                        near(asked.3, value, 1e-3) && close(asked.4, pdf, 1e-3),
                        "{level:?} {n}: {asked:?} {value} {pdf}"
                    );
                }
            }
        }
    });
}

#[test]
fn hits_of_other_blends_are_asked_together() {
    let all = all();
    let rough = anisotropic();
    for_each_level(|level| {
        for n in [1usize, 3, 16, 17, 40, 100] {
            let mut random = Random(n as u64);
            // Blocks of one part each, of some of two and three, some with an anisotropic material, and some that are asked alone: a mixture.
            let mut mixture = Mixture::<16>::empty();
            all[8].prepare([0.6, 0.0, 0.8], &mut mixture).unwrap();
            let parts: Vec<Vec<BlendPart<'_>>> = (0..n)
                .map(|i| {
                    let of = |k: usize, weight: f32| {
                        BlendPart::new(&all[k % 10], weight).tinted([weight, 0.5, 1.0])
                    };
                    let count = if i < 16 { 1 } else { 1 + random.below(3) };
                    let mut parts: Vec<_> =
                        (0..count).map(|k| of(random.below(10) + k, random.between(0.1, 1.0))).collect();
                    if i > 60 && i % 7 == 0 {
                        parts.push(BlendPart::of_mixture(&mixture, 0.5));
                    }
                    if i % 5 == 0 {
                        parts.push(BlendPart::new(&rough, 0.5).coated(1.4));
                    }
                    parts
                })
                .collect();
            let blends: Vec<Blend<'_>> = parts.iter().map(|parts| Blend::new(parts).unwrap()).collect();
            let (wo, wi, u): (Vec<_>, Vec<_>, Vec<_>) = (0..n)
                .map(|_| (upper(&mut random), upper(&mut random), Vec3::from(random.three())))
                .collect();
            let asked = ask(&|wo, request| Blend::ask_each(&blends, wo, request), &wo, &wi, &u);
            let mut elsewhere = 0;
            for (i, (direction, pdf, weight, value, density)) in asked.into_iter().enumerate() {
                let single = blends[i].evaluate_and_pdf(wo[i], wi[i]);
                let peak = single.0.abs().max_element().max(1e-3);
                assert!(
                    (value - single.0).abs().max_element() <= 1e-3 * peak,
                    "{level:?} {n} {i}: {value} {single:?}"
                );
                assert!(
                    (density - single.1).abs() <= 1e-3 * single.1.max(1e-3),
                    "{level:?} {n} {i}: {density} {single:?}"
                );
                let there = blends[i].evaluate_and_pdf(wo[i], direction);
                assert!((there.1 / pdf - 1.0).abs() < 5e-3, "{level:?} {n} {i}: {pdf} {there:?}");
                let off = (weight * pdf - there.0).abs().max_element();
                assert!(off <= 5e-3 * there.0.abs().max_element(), "{level:?} {n} {i}: {off}");
                // As the one that is drawn alone, but where a number is at the border of two.
                let alone = blends[i].sample(wo[i], u[i].to_array()).expect("it reflects");
                elsewhere += usize::from((alone.direction - direction).length() > 1e-2);
            }
            assert!(elsewhere <= n / 50, "{level:?} {n}: {elsewhere}");
        }
    });
}

/// The room for lobes has the hits of a block times their parts.
#[test]
fn requests_of_any_length_have_the_answers_of_long_ones() {
    let all = all();
    let mut random = Random(66);
    let (wo, wi, u): (Vec<_>, Vec<_>, Vec<_>) =
        (0..33).map(|_| (upper(&mut random), upper(&mut random), Vec3::from(random.three()))).collect();
    for_each_level(|level| {
        for count in 1..=4 {
            let parts: Vec<_> = (0..count).map(|k| BlendPart::new(&all[7 + k], 0.5)).collect();
            let blend = Blend::new(&parts).unwrap();
            for n in 1..=wo.len() {
                let asked = ask(&|wo, request| blend.ask(wo, request), &wo[..n], &wi[..n], &u[..n]);
                for (i, (direction, .., value, density)) in asked.into_iter().enumerate() {
                    let alone = blend.sample(wo[i], u[i].to_array()).expect("it reflects");
                    assert!(
                        (alone.direction - direction).length() < 1e-2,
                        "{level:?} {count} {n} {i}: {direction} {alone:?}"
                    );
                    let single = blend.evaluate_and_pdf(wo[i], wi[i]);
                    let off = (value - single.0).abs().max_element();
                    assert!(
                        off <= 1e-3 * single.0.abs().max_element().max(1e-3),
                        "{level:?} {count} {n} {i}"
                    );
                    assert!(
                        (density - single.1).abs() <= 1e-3 * single.1.max(1e-3),
                        "{level:?} {count} {n} {i}"
                    );
                }
            }
        }
    });
}

#[test]
fn draws_follow_the_density_and_bring_the_albedo() {
    let all = all();
    let directions = outgoing(4);
    let level = sidak(ALPHA, RECIPES.len() * directions.len() * srbf_tests::inputs::levels().len());
    for_each_level(|simd| {
        for (n, recipe) in RECIPES.into_iter().enumerate() {
            let parts = parts(&all, recipe);
            let blend = Blend::new(&parts).unwrap();
            for (k, &wo) in directions.iter().enumerate() {
                let mixtures: Vec<Mixture<'_, 64>> = recipe
                    .iter()
                    .map(|&(place, ..)| {
                        let mut mixture = Mixture::empty();
                        all[place].prepare(wo, &mut mixture).unwrap();
                        mixture
                    })
                    .collect();
                let mixtures: Vec<&AnyMixture<'_>> = mixtures.iter().map(|m| &**m).collect();
                let partition = Partition::of_all(&mixtures, |d| blend.pdf(wo, d));
                assert!((partition.total() - 1.0).abs() < 1e-3, "{simd:?} {n} {wo}: {}", partition.total());
                let mut random = Random(100 * n as u64 + k as u64);
                let samples: Vec<Sample> =
                    (0..SAMPLES).filter_map(|_| blend.sample(wo, random.three())).collect();
                let mut next = samples.iter().map(|s| s.direction);
                let result = partition.test(samples.len(), || next.next().unwrap());
                assert!(result.p > level, "{simd:?} {n} {wo}: p = {}", result.p);
                // White light: the mean of the weights is the albedo, and below a coat less.
                let mean = samples.iter().map(|s| s.weight.as_dvec3()).sum::<glam::DVec3>() / SAMPLES as f64;
                let albedo = blend.albedo(wo).as_dvec3();
                let is_coated = recipe.iter().any(|part| part.3 > 1.0);
                // The kinds with factors make up what these change of the albedo.
                let has_factors = mixtures.iter().any(|mixture| mixture.has_factors());
                for c in (0..3).filter(|_| !has_factors) {
                    let ratio = mean[c] / albedo[c];
                    assert!(
                        if is_coated { (0.2..1.02).contains(&ratio) } else { (ratio - 1.0).abs() < 0.04 },
                        "{simd:?} {n} {wo} channel {c}: {mean} {albedo}"
                    );
                }
                // So is that of one part at random.
                let mut one_mean = glam::DVec3::ZERO;
                for _ in 0..SAMPLES {
                    let u = random.three();
                    let (_, part, left) = blend.choose(u[0]);
                    let one = [part];
                    if let Some(sample) = Blend::new(&one).unwrap().sample(wo, [left, u[1], u[2]]) {
                        one_mean += sample.weight.as_dvec3() / SAMPLES as f64;
                    }
                }
                assert!(((one_mean - mean) / mean).abs().max_element() < 0.08, "{n} {wo}: {one_mean} {mean}");
            }
        }
    });
}

#[test]
fn a_coated_base_with_its_coat_reflects_no_more_than_falls_on_it_and_either_way() {
    // A base that loses nothing, below a coat of a narrow lobe.
    let index = 1.5;
    let base = Mixture::<16>::hemisphere(&[]).unwrap().with_diffuse([1.0; 3]).unwrap();
    for wo in outgoing(20) {
        let f = fresnel(index, wo.z);
        let unit = Lobe::new(Vec3::new(-wo.x, -wo.y, wo.z), 1e4, [1.0; 3]).unwrap();
        let scale = 1.0 / unit.integral().x;
        let lobe = Lobe::new(Vec3::new(-wo.x, -wo.y, wo.z), 1e4, [scale; 3]).unwrap();
        let coat = Mixture::<16>::hemisphere(&[lobe]).unwrap();
        let parts = [BlendPart::of_mixture(&coat, f), BlendPart::of_mixture(&base, 1.0).coated(index)];
        let blend = Blend::new(&parts).unwrap();
        let albedo = blend.albedo(wo).max_element();
        assert!(albedo < 1.0 + 1e-5, "{wo}: {albedo}");
        let mut random = Random(7);
        let mean = (0..SAMPLES)
            .filter_map(|_| blend.sample(wo, random.three()))
            .map(|s| f64::from(s.weight.y) / SAMPLES as f64)
            .sum::<f64>();
        assert!(mean < 1.0 && mean > 0.5, "{wo}: {mean}");
        // Base alone: f(wo, wi) = f(wi, wo).
        let alone = [parts[1]];
        let alone = Blend::new(&alone).unwrap();
        for wi in outgoing(9) {
            let (there, back) = (alone.evaluate(wo, wi).y / wi.z, alone.evaluate(wi, wo).y / wo.z);
            assert!((there / back - 1.0).abs() < 1e-5, "{wo} {wi}: {there} {back}");
        }
    }
}

#[test]
fn it_is_linear_in_weights_and_tints() {
    let all = all();
    let mut random = Random(3);
    for _ in 0..200 {
        let (wo, wi) = (upper(&mut random), upper(&mut random));
        let value = |weight: f32, red: f32| {
            let parts =
                [BlendPart::new(&all[8], weight).tinted([red, 0.5, 0.5]), BlendPart::new(&all[7], 0.4)];
            Blend::new(&parts).unwrap().evaluate(wo, wi)
        };
        let (from, to, half) = (value(0.25, 0.5), value(0.75, 0.5), value(0.5, 0.5));
        assert!(
            (half - 0.5 * (from + to)).abs().max_element() <= 1e-5 * half.abs().max_element(),
            "{wo} {wi}"
        );
        let slope = (value(0.5, 1.0).x - value(0.5, 0.0).x) / 1.0;
        let own = 0.5 * all[8].evaluate(wo, wi).x;
        assert!((slope - own).abs() <= 1e-3 * half.abs().max_element(), "{wo} {wi}: {slope} {own}");
    }
}

#[test]
fn hostile_numbers_are_refused_and_never_make_a_nan() {
    let all = all();
    let part = |weight| BlendPart::new(&all[8], weight);
    assert_eq!(Blend::new(&[]).err(), Some(Error::Parts));
    assert_eq!(Blend::new(&[part(0.1); MAX_BLEND + 1]).err(), Some(Error::Parts));
    for weight in [f32::NAN, -1e-9, 1001.0, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0] {
        assert_eq!(Blend::new(&[part(weight)]).err(), Some(Error::Weight), "{weight}");
        let tinted = [part(1.0).tinted([1.0, 1.0, weight])];
        assert_eq!(Blend::new(&tinted).err(), (weight != 0.0).then_some(Error::Weight), "{weight}");
        assert_eq!(Blend::new(&[part(1.0).coated(weight)]).err(), Some(Error::Weight), "{weight}");
    }
    let mut random = Random(11);
    let numbers = [0.0, 1e-45, 1e-38, 1e-30, 1e-7, 0.5, 1.0, 1000.0];
    let vectors = [Vec3::ZERO, Vec3::NAN, Vec3::splat(f32::INFINITY), Vec3::NEG_Z, Vec3::Z, Vec3::X];
    for _ in 0..4000 {
        let mut pick = |of: &[f32]| of[(random.three()[0] * of.len() as f32) as usize];
        let parts: Vec<BlendPart<'_>> = (0..3)
            .map(|k| {
                let tint = [pick(&numbers), pick(&numbers), pick(&numbers)];
                BlendPart::new(&all[3 * k], pick(&numbers)).tinted(tint).coated(pick(&[1.0, 1.5, 10.0]))
            })
            .collect();
        let Ok(blend) = Blend::new(&parts) else { continue };
        let (wo, wi, u) = (upper(&mut random), random.direction(), random.three());
        let (sample, (value, pdf)) = blend.sample_and_evaluate(wo, u, wi);
        assert!(value.is_finite() && pdf.is_finite() && pdf >= 0.0, "{parts:?}: {value} {pdf}");
        if let Some(sample) = sample {
            assert!(sample.weight.is_finite() && sample.pdf > 0.0, "{parts:?} {sample:?}");
        }
        assert!(blend.albedo(wo).is_finite());
        let (_, part, left) = blend.choose(u[0]);
        assert!((0.0..1.0).contains(&left), "{left}");
        let one = [part];
        if let Ok(one) = Blend::new(&one) {
            let (value, pdf) = one.evaluate_and_pdf(wo, wi);
            assert!(value.is_finite() && pdf.is_finite());
        }
        for wo in vectors {
            for wi in vectors {
                // No panic, and nothing from below.
                let (sample, _) = blend.sample_and_evaluate(wo, u, wi);
                assert!(sample.is_none() || wo.z >= 0.0, "{wo}");
            }
        }
    }
}

#[test]
fn slices_of_other_lengths_are_refused() {
    let all = all();
    let parts = [BlendPart::new(&all[8], 1.0), BlendPart::new(&all[7], 1.0)];
    let blend = Blend::new(&parts).unwrap();
    let (wo, wi, mut pdf) =
        ([[0.0f32; 4], [0.0; 4], [1.0; 4]], [[0.0f32; 3], [0.0; 3], [1.0; 3]], [0.0f32; 4]);
    let towards = Towards { wi: wi.each_ref().map(|s| &s[..]), value: None, pdf: Some(&mut pdf) };
    assert_eq!(blend.ask(wo.each_ref().map(|s| &s[..]), towards.into()), Err(Error::Length));
}
