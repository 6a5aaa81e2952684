//! Sheets: bytes, verbs, draws on both sides, requests.

use glam::Vec3;
use srbf_core::{
    Draws, Error, FormatError, Material, Mixture, Quarter, Request, Sheet, SheetMixture, Towards, luminance,
};
use srbf_tests::attack::put_right;
use srbf_tests::inputs::Random;
use srbf_tests::kinds::{for_each_level, materials};
use srbf_tests::partition::Partition;
use srbf_tests::statistics::sidak;

const SAMPLES: usize = 120_000;
const ALPHA: f64 = 0.01;
const TEXT: &str = "test, made by tests/sheets.rs";

/// The places of quarters among the kinds of materials; whether the back is like the front.
const SHEETS: [([Option<usize>; 4], bool); 5] = [
    ([Some(0), Some(1), Some(2), Some(3)], false),
    ([Some(0), Some(1), None, None], true),
    ([None, Some(2), None, None], true),
    ([Some(1), None, None, Some(0)], false),
    ([Some(3), Some(4), Some(0), None], false),
];

fn encode(quarters: [Option<usize>; 4], is_symmetric: bool) -> Vec<u8> {
    let all: Vec<_> =
        materials().into_iter().map(|(_, bytes)| Material::from_bytes(bytes).unwrap()).collect();
    let quarters = quarters.map(|place| place.map(|n| &all[n]));
    let mut bytes = vec![0; Sheet::encoded_len(quarters, TEXT)];
    assert_eq!(Sheet::encode(quarters, is_symmetric, TEXT, &mut bytes).unwrap(), bytes.len());
    bytes
}

fn sheets() -> Vec<(String, Sheet<Vec<u8>>)> {
    let make = |(quarters, is_symmetric)| {
        let name = format!("{quarters:?}, symmetric: {is_symmetric}");
        (name, Sheet::from_bytes(encode(quarters, is_symmetric)).unwrap())
    };
    SHEETS.into_iter().map(make).collect()
}

/// A direction of either side.
fn anywhere(random: &mut Random) -> Vec3 {
    loop {
        let d = Vec3::from([0; 3].map(|_| random.between(-1.0, 1.0)));
        if d.length() < 1.0 && d.length() > 0.1 && d.z.abs() > 0.02 {
            return d.normalize();
        }
    }
}

fn up(d: Vec3) -> Vec3 {
    Vec3::new(d.x, d.y, d.z.abs())
}

#[test]
fn a_sheet_gives_back_its_materials() {
    for ((quarters, is_symmetric), (name, sheet)) in SHEETS.into_iter().zip(sheets()) {
        let all = materials();
        for (place, quarter) in Quarter::ALL.into_iter().enumerate() {
            let wanted = quarters[if is_symmetric { place % 2 } else { place }];
            let found = sheet.quarter(quarter).map(|material| material.bytes().to_vec());
            assert_eq!(found, wanted.map(|n| all[n].1.clone()), "{name} {quarter:?}");
            assert_eq!((quarter.is_back(), quarter.is_transmission()), (place > 1, place % 2 == 1));
        }
        assert_eq!((sheet.provenance(), sheet.is_symmetric()), (TEXT, is_symmetric));
        let most = Quarter::ALL.into_iter().filter_map(|q| sheet.quarter(q)).map(|m| m.lobe_count()).max();
        assert_eq!(Some(sheet.lobe_count()), most, "{name}");
    }
}

#[test]
fn values_and_draws_are_those_of_the_quarter_that_is_seen() {
    for_each_level(|level| {
        for (name, sheet) in sheets() {
            let mut random = Random(5);
            let mut pair = SheetMixture::<64>::empty();
            for _ in 0..200 {
                let (wo, wi, u) = (anywhere(&mut random), anywhere(&mut random), random.three());
                let is_through = (wo.z < 0.0) != (wi.z < 0.0);
                let place = 2 * usize::from(wo.z < 0.0) + usize::from(is_through);
                let reflected = sheet.reflected_share(wo);
                let share = if is_through { 1.0 - reflected } else { reflected };
                let seen = sheet.quarter(Quarter::ALL[place]);
                let wanted = seen.map_or((Vec3::ZERO, 0.0), |m| m.evaluate_and_pdf(up(wo), up(wi)));
                let (value, pdf) = sheet.evaluate_and_pdf(wo, wi);
                assert_eq!((value, pdf), (wanted.0, share * wanted.1), "{level:?} {name} {wo} {wi}");
                assert_eq!((sheet.evaluate(wo, wi), sheet.pdf(wo, wi)), (value, pdf));

                // A draw tells the value and density of where it went.
                let sample = sheet.sample(wo, u);
                if let Some(sample) = sample {
                    assert_eq!((u[0] < reflected), (sample.direction.z < 0.0) == (wo.z < 0.0));
                    let (value, pdf) = sheet.evaluate_and_pdf(wo, sample.direction);
                    assert!((pdf / sample.pdf - 1.0).abs() < 2e-3, "{level:?} {name}: {pdf} {}", sample.pdf);
                    let off = (sample.weight * sample.pdf - value).abs().max_element();
                    assert!(off <= 2e-3 * value.abs().max_element(), "{level:?} {name}: {off}");
                }
                assert_eq!(sheet.sample_and_evaluate(wo, u, wi), (sample, (value, pdf)), "{level:?} {name}");

                // Mixtures say the same within rounding.
                sheet.prepare(wo, &mut pair).unwrap();
                let (mixed, density) = pair.evaluate_and_pdf(wi);
                let peak = value.abs().max_element().max(1e-3);
                assert!(
                    (mixed - value).abs().max_element() < 1e-3 * peak,
                    "{level:?} {name} {mixed} {value}"
                );
                assert!((density - pdf).abs() < 1e-3 * pdf.max(1e-3), "{level:?} {name} {density} {pdf}");
                match (sample, pair.sample(u)) {
                    (Some(a), Some(b)) => assert_eq!(a.direction.z < 0.0, b.direction.z < 0.0),
                    (a, b) => assert_eq!(a, b, "{level:?} {name}"),
                }
            }
        }
    });
}

#[test]
fn draws_follow_the_density_on_both_sides_and_bring_its_light() {
    let directions: Vec<Vec3> = (0..12)
        .map(|n| {
            let (theta, phi) = ((8.0 + 6.5 * n as f32).to_radians(), 2.4 * n as f32);
            let side = if n % 2 == 0 { 1.0 } else { -1.0 };
            Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), side * theta.cos())
        })
        .collect();
    let level = sidak(ALPHA, SHEETS.len() * directions.len() * 2);
    for (name, sheet) in sheets() {
        for (n, &wo) in directions.iter().enumerate() {
            let mut pair = SheetMixture::<64>::empty();
            sheet.prepare(wo, &mut pair).unwrap();
            let mut random = Random(100 + n as u64);
            let samples: Vec<_> = (0..SAMPLES).filter_map(|_| sheet.sample(wo, random.three())).collect();
            for is_through in [false, true] {
                let is_below = (wo.z < 0.0) != is_through;
                let own: Vec<_> = samples.iter().filter(|s| (s.direction.z < 0.0) == is_below).collect();
                let share =
                    if is_through { 1.0 - sheet.reflected_share(wo) } else { sheet.reflected_share(wo) };
                let expected = if pair.half(is_through).power() > 0.0 { f64::from(share) } else { 0.0 };
                // Five standard deviations of the count.
                let spread = 5.0 * (SAMPLES as f64 * expected * (1.0 - expected)).sqrt() + 1e-9;
                let count = own.len() as f64;
                assert!(
                    (count - SAMPLES as f64 * expected).abs() <= spread,
                    "{name} {wo}: {count} {expected}"
                );
                if own.is_empty() {
                    continue;
                }
                let mixture: &Mixture<64> = pair.half(is_through);
                let toward = |d: Vec3| Vec3::new(d.x, d.y, if is_below { -d.z } else { d.z });
                let partition = Partition::new(mixture, |d| sheet.pdf(wo, toward(d)) / share);
                assert!((partition.total() - 1.0).abs() < 1e-3, "{name} {wo}: {}", partition.total());
                let mut next = own.iter().map(|s| up(s.direction));
                let result = partition.test(own.len(), || next.next().unwrap());
                assert!(result.p > level, "{name} {wo}, through: {is_through}: p = {}", result.p);

                // White light: the mean of the weights is the albedo.
                let mean = own.iter().map(|s| f64::from(luminance(s.weight.to_array()))).sum::<f64>()
                    / SAMPLES as f64;
                let albedo = f64::from(luminance(pair.albedos()[usize::from(is_through)].to_array()));
                assert!(
                    (mean / albedo - 1.0).abs() < 0.03,
                    "{name} {wo}, through: {is_through}: {mean} {albedo}"
                );
            }
        }
    }
}

#[test]
fn requests_answer_what_single_calls_do() {
    for_each_level(|level| {
        for (name, sheet) in sheets() {
            for n in [1usize, 3, 16, 63, 64, 65, 200] {
                let mut random = Random(n as u64);
                let hits: Vec<_> =
                    (0..n).map(|_| (anywhere(&mut random), anywhere(&mut random), random.three())).collect();
                let soa = |get: &dyn Fn(usize) -> Vec3| {
                    [0, 1, 2].map(|k| (0..n).map(|i| get(i)[k]).collect::<Vec<f32>>())
                };
                let (wo, wi) = (soa(&|i| hits[i].0), soa(&|i| hits[i].1));
                let u = soa(&|i| Vec3::from(hits[i].2));
                let empty = || [vec![0f32; n], vec![0f32; n], vec![0f32; n]];
                let (mut direction, mut weight, mut value) = (empty(), empty(), empty());
                let (mut pdf, mut density) = (vec![0f32; n], vec![0f32; n]);
                let draw = Draws {
                    u: u.each_ref().map(|s| &s[..]),
                    direction: direction.each_mut().map(|s| &mut s[..]),
                    pdf: Some(&mut pdf),
                    weight: Some(weight.each_mut().map(|s| &mut s[..])),
                };
                let towards = Towards {
                    wi: wi.each_ref().map(|s| &s[..]),
                    value: Some(value.each_mut().map(|s| &mut s[..])),
                    pdf: Some(&mut density),
                };
                let request = Request { draw: Some(draw), evaluate: Some(towards) };
                sheet.ask(wo.each_ref().map(|s| &s[..]), request).unwrap();
                for (i, &(wo, wi, u)) in hits.iter().enumerate() {
                    let (sample, (single, single_pdf)) = sheet.sample_and_evaluate(wo, u, wi);
                    let found = Vec3::new(value[0][i], value[1][i], value[2][i]);
                    let peak = single.abs().max_element().max(1e-3);
                    assert!((found - single).abs().max_element() < 1e-3 * peak, "{level:?} {name} {n} {i}");
                    assert!(
                        (density[i] - single_pdf).abs() < 1e-3 * single_pdf.max(1e-3),
                        "{level:?} {name} {n} {i}"
                    );
                    let drawn = Vec3::new(direction[0][i], direction[1][i], direction[2][i]);
                    match sample {
                        Some(sample) => {
                            assert_eq!(drawn.z < 0.0, sample.direction.z < 0.0, "{level:?} {name} {n} {i}");
                            // A number at the border of two lobes may take either: the draw tells its own density.
                            let (value, there) = sheet.evaluate_and_pdf(wo, drawn);
                            assert!(
                                (there / pdf[i] - 1.0).abs() < 5e-3,
                                "{level:?} {name} {n} {i}: {there} {}",
                                pdf[i]
                            );
                            let weight = Vec3::new(weight[0][i], weight[1][i], weight[2][i]);
                            let off = (weight * pdf[i] - value).abs().max_element();
                            assert!(
                                off <= 5e-3 * value.abs().max_element(),
                                "{level:?} {name} {n} {i}: {off}"
                            );
                        }
                        None => assert_eq!((pdf[i], weight[0][i]), (0.0, 0.0)),
                    }
                }
            }
        }
    });
}

#[test]
fn slices_of_other_lengths_are_refused() {
    let (_, sheet) = sheets().remove(0);
    let (wo, wi, mut pdf) =
        ([[0.0f32; 4], [0.0; 4], [1.0; 4]], [[0.0f32; 3], [0.0; 3], [1.0; 3]], [0.0f32; 4]);
    let towards = Towards { wi: wi.each_ref().map(|s| &s[..]), value: None, pdf: Some(&mut pdf) };
    assert_eq!(sheet.ask(wo.each_ref().map(|s| &s[..]), towards.into()), Err(Error::Length));
}

#[test]
fn directions_that_are_none_reflect_nothing() {
    let (_, sheet) = sheets().remove(0);
    for wo in [Vec3::ZERO, Vec3::NAN, Vec3::new(0.0, 0.0, f32::INFINITY), Vec3::new(3.0, 0.0, -2.0)] {
        assert_eq!(sheet.evaluate_and_pdf(wo, Vec3::Z), (Vec3::ZERO, 0.0), "{wo}");
        assert_eq!(sheet.sample(wo, [0.5; 3]), None, "{wo}");
        assert!((0.0..=1.0).contains(&sheet.reflected_share(wo)), "{wo}");
    }
}

#[test]
fn damaged_bytes_are_refused_with_their_place() {
    let bytes = encode(SHEETS[0].0, false);
    for length in 0..bytes.len() {
        assert!(Sheet::from_bytes(&bytes[..length]).is_err(), "{length}");
    }
    for at in 0..bytes.len() {
        for bit in [1, 0x80] {
            let mut other = bytes.clone();
            other[at] ^= bit;
            assert!(Sheet::from_bytes(&other).is_err(), "a flipped bit at {at} was not found");
        }
    }
    // A whole checksum does not help a fault.
    let with = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut other = bytes.clone();
        change(&mut other);
        put_right(&mut other);
        Sheet::from_bytes(other).err()
    };
    assert_eq!(with(&|_| ()), None);
    for (at, value, name) in [
        (20, 2, "whether the back is like the front"),
        (20, 1, "tag of a block (a quarter that is there already)"),
        (24, 1, "reserved field"),
        (40, b'X', "tag of a block (shares come first, once)"),
        (48, 0, "share of reflected draws (1 to 254 where there are both)"),
        (80, b'X', "tag of a block (unknown, and not to be skipped)"),
    ] {
        match with(&|bytes| bytes[at] = value) {
            Some(FormatError::Field { name: found, .. }) => assert_eq!(found, name),
            other => panic!("{name}: {other:?}"),
        }
    }
    // One kind for another.
    let material = &materials()[0].1;
    assert_eq!(Sheet::from_bytes(material).err(), Some(FormatError::Kind { is_sheet: false }));
    assert_eq!(Material::from_bytes(&bytes[..]).err(), Some(FormatError::Kind { is_sheet: true }));
    let none: [Option<&Material<Vec<u8>>>; 4] = [None; 4];
    let mut room = vec![0; Sheet::encoded_len(none, "")];
    assert!(matches!(Sheet::encode(none, true, "", &mut room), Err(FormatError::Field { .. })));
    let few = Sheet::encode(none, true, "", &mut [0; 8]);
    assert_eq!(few, Err(FormatError::Buffer { needed: room.len(), available: 8 }));
}
