//! Expanded materials: how near they come to the exact preparation, and that their density, values and samples belong together at
//! every level.

use glam::Vec3;
use srbf_core::{Draws, Error, Expanded, Level, Material, Mixture, Request, Towards, luminance};
use srbf_tests::inputs::Random;
use srbf_tests::kinds::{KINDS, Soa, for_each_level, materials, upper};
use srbf_tests::partition::Partition;
use srbf_tests::statistics::sidak;
use srbf_tests::tolerance::Worst;

/// Expands a material for as long as the test runs.
fn expanded(bytes: &[u8], rows: usize) -> (&'static Material<Vec<u8>>, Expanded<'static>) {
    let material = Material::from_bytes(bytes.to_vec()).expect("a valid material");
    let material: &_ = Box::leak(Box::new(material));
    let memory = vec![f32::NAN; material.expanded_len(rows)].leak();
    Expanded::check(material, rows).expect("an isotropic material");
    let expanded = Expanded::new(material, rows, memory).expect("checked bytes");
    assert_eq!(expanded.material().bytes(), material.bytes());
    (material, expanded)
}

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
            expanded
                .ask(
                    wo,
                    Towards { wi: wi_slices, value: Some(value.slices_mut()), pdf: Some(&mut pdf) }.into(),
                )
                .unwrap();
            expanded
                .ask(wo, Towards { wi: wi_slices, value: Some(alone.slices_mut()), pdf: None }.into())
                .unwrap();
            expanded
                .ask(wo, Towards { wi: wi_slices, value: None, pdf: Some(&mut pdf_alone) }.into())
                .unwrap();
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
            let samples = Draws {
                u: u.slices(),
                direction: direction.slices_mut(),
                pdf: Some(&mut pdf),
                weight: Some(weight.slices_mut()),
            };
            expanded.ask(wo.slices(), samples.into()).unwrap();
            expanded
                .ask(
                    wo.slices(),
                    Towards {
                        wi: direction.slices(),
                        value: Some(value.slices_mut()),
                        pdf: Some(&mut again),
                    }
                    .into(),
                )
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
            let samples = Draws {
                u: u.slices(),
                direction: direction_too.slices_mut(),
                pdf: Some(&mut pdf_too),
                weight: Some(weight_too.slices_mut()),
            };
            let (to, to_pdf) = (towards.slices_mut(), &mut towards_pdf);
            expanded
                .ask(
                    wo.slices(),
                    Request {
                        draw: Some(samples),
                        evaluate: Some(Towards { wi: wi.slices(), value: Some(to), pdf: Some(to_pdf) }),
                    },
                )
                .unwrap();
            assert_eq!(
                (&direction_too.0, &weight_too.0, &pdf_too),
                (&direction.0, &weight.0, &pdf),
                "{level:?} {name}"
            );
            expanded
                .ask(
                    wo.slices(),
                    Towards { wi: wi.slices(), value: Some(value.slices_mut()), pdf: Some(&mut again) }
                        .into(),
                )
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
    // Few rows, so that mixtures between them are far from either.
    for (name, bytes) in materials {
        let (_, expanded) = expanded(&bytes, 64);
        for (i, theta) in [0.017f32, 0.7, 1.4].into_iter().enumerate() {
            let wo = Vec3::new(-0.6 * theta.sin(), 0.8 * theta.sin(), theta.cos());
            let mut m = Mixture::<64>::empty();
            expanded.prepare(wo, &mut m).unwrap();
            let partition = Partition::new(&m, |d| {
                let mut pdf = [0.0];
                expanded
                    .ask(
                        [&[wo.x], &[wo.y], &[wo.z]],
                        Towards { wi: [&[d.x], &[d.y], &[d.z]], value: None, pdf: Some(&mut pdf) }.into(),
                    )
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
            let samples = Draws {
                u: u.slices(),
                direction: direction.slices_mut(),
                pdf: Some(&mut pdf),
                weight: Some(weight.slices_mut()),
            };
            expanded.ask(wo.slices(), samples.into()).unwrap();
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
            let samples = Draws {
                u: u.slices(),
                direction: direction.slices_mut(),
                pdf: Some(&mut pdf),
                weight: Some(weight.slices_mut()),
            };
            let (to, to_pdf) = (value.slices_mut(), &mut density);
            expanded
                .ask(
                    wo.slices(),
                    Request {
                        draw: Some(samples),
                        evaluate: Some(Towards { wi: wi.slices(), value: Some(to), pdf: Some(to_pdf) }),
                    },
                )
                .unwrap();
            for i in 0..n {
                let all = (direction.at(i), pdf[i], weight.at(i), value.at(i), density[i]);
                assert_eq!(all, (Vec3::Z, 0.0, Vec3::ZERO, Vec3::ZERO, 0.0), "{level:?} {name} {}", none[i]);
            }
            // Incident directions below the horizon.
            let below = Soa::new(&vec![Vec3::new(0.6, 0.0, -0.8); n]);
            expanded
                .ask(
                    wi.slices(),
                    Towards { wi: below.slices(), value: Some(value.slices_mut()), pdf: Some(&mut density) }
                        .into(),
                )
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
    let result = expanded.ask(
        [&[0.0]; 3],
        Towards { wi: [&[]; 3], value: Some(value.each_mut().map(|s| &mut s[..])), pdf: None }.into(),
    );
    assert_eq!(result, Err(Error::Length));
}
