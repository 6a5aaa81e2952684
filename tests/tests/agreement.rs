//! Ways that lead to the same number give the same number: one direction and batches, at the normal and beside it.

use glam::Vec3;
use srbf_core::{
    AnyMixture, Domain, Error, KernelTable, LeaveOut, Level, Line, Lobe, Material, Mixture, PlaneLobe,
    Towards, View, color_differences, luminance,
};
use srbf_tests::inputs::Random;
use srbf_tests::kinds::for_each_level;

/// A material whose views all hold the same lobes but at the normal, where their angles are 0.
fn material(thetas: &[f32], lobes: &[PlaneLobe], squeezed: usize, mirrored: usize, diffuse: f32) -> Vec<u8> {
    let at_normal: Vec<PlaneLobe> =
        lobes.iter().map(|l| PlaneLobe { angle: 0.0, off_plane: 0.0, ..*l }).collect();
    let view = |&theta: &f32| View {
        theta,
        log2_squeeze: if theta > 0.0 && squeezed > 0 { -2.0 } else { 0.0 },
        log2_diffuse: diffuse,
        diffuse_color_differences: [0.0; 2],
        lobes: if theta > 0.0 { lobes } else { &at_normal },
    };
    let views: Vec<View> = thetas.iter().map(view).collect();
    let line = Line { views: &views, squeezed, mirrored, factors: None };
    let mut bytes = vec![0; line.encoded_len("")];
    line.encode("", &mut bytes).unwrap();
    bytes
}

fn plane_lobe(angle: f32, log2_sharpness: f32) -> PlaneLobe {
    let (log2_luminance, color_differences) = color_differences([0.0, -1.0, -2.0]);
    PlaneLobe { angle, off_plane: 0.0, log2_sharpness, log2_luminance, color_differences }
}

/// `f cos` by a batch of one direction.
fn in_a_batch(m: &AnyMixture<'_>, d: Vec3) -> Vec3 {
    let mut value = [[0.0]; 3];
    let [red, green, blue] = &mut value;
    m.ask(Towards { wi: [&[d.x], &[d.y], &[d.z]], value: Some([red, green, blue]), pdf: None }.into())
        .unwrap();
    Vec3::new(value[0][0], value[1][0], value[2][0])
}

#[test]
fn one_direction_and_a_batch_fold_the_same_lobes() {
    // One lobe beside the horizon needs its fold, one does not: they share a vector.
    let bytes = material(&[0.0, 1.2], &[plane_lobe(0.9, 0.0), plane_lobe(1.37, 6.0)], 0, 0, -126.0);
    let material = Material::from_bytes(&bytes).unwrap();
    for_each_level(|level| {
        for folds in [1e-7, 0.05, 0.35] {
            let mut m = Mixture::<16>::empty();
            let wo = Vec3::new(-1.2f32.sin(), 0.0, 1.2f32.cos());
            material.prepare_with(wo, LeaveOut::new(0.0, folds).unwrap().into(), &mut m).unwrap();
            for d in [Vec3::X, -Vec3::X, Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.8, 0.6, 0.0)] {
                let (one, batch) = (m.evaluate(d), in_a_batch(&m, d));
                let off = (one - batch).abs().max_element();
                assert!(off <= 1e-5 * batch.max_element(), "{level:?}, folds {folds}, {d}: {one}, {batch}");
            }
        }
    });
}

#[test]
fn a_faint_diffuse_term_is_as_exact_in_the_density_as_in_the_value() {
    let lobe = Lobe::new(Vec3::Z, 2000.0, Vec3::splat(0.9 * 2000.0 / 6.3)).unwrap();
    for_each_level(|level| {
        for albedo in [1e-3, 1e-6, 1e-9] {
            let m = Mixture::<16>::hemisphere(&[lobe]).unwrap().with_diffuse(Vec3::splat(albedo)).unwrap();
            // Where the lobe has ended.
            let d = Vec3::new(0.8, 0.0, 0.6);
            let wanted = luminance(m.evaluate(d));
            let mut out = [0.0];
            m.ask(Towards { wi: [&[d.x], &[d.y], &[d.z]], value: None, pdf: Some(&mut out) }.into()).unwrap();
            let got = out[0] * m.power();
            assert!((got / wanted - 1.0).abs() < 1e-6, "{level:?} {albedo}: {got}, {wanted}");
            let (pdf, both) = (m.pdf(d), m.evaluate_and_pdf(d).1);
            assert!((pdf / both - 1.0).abs() < 1e-6, "{level:?} {albedo}: {pdf}, {both}");
        }
    });
}

#[test]
fn outgoing_directions_beside_the_normal_are_as_good_as_it() {
    let bytes = material(&[0.0, 1.2], &[plane_lobe(0.7, 3.0), plane_lobe(1.1, 6.0)], 1, 0, -3.0);
    let material = Material::from_bytes(&bytes).unwrap();
    let d = Vec3::new(0.3, 0.4, 0.75f32.sqrt());
    for_each_level(|level| {
        let mut m = Mixture::<16>::empty();
        material.prepare(Vec3::Z, &mut m).unwrap();
        let wanted = m.evaluate(d);
        for across in [1e-30, 2.7e-23, 4.5e-23, 1e-22, 1e-21, 1e-19, 1e-15] {
            for wo in [Vec3::new(across, 0.0, 1.0), Vec3::new(-across, across, 1.0)] {
                material.prepare(wo, &mut m).unwrap();
                let [c, s] = m.azimuth_cos_sin();
                assert!((c.hypot(s) - 1.0).abs() < 1e-6, "{level:?} {across}: {c}, {s}");
                let value = m.evaluate(d);
                assert!(
                    (value - wanted).abs().max_element() < 1e-5 * wanted.max_element(),
                    "{level:?} {across}"
                );
                let mut in_batch = [m.clone()];
                material.prepare_into([&[wo.x], &[wo.y], &[wo.z]], &mut in_batch).unwrap();
                assert_eq!(in_batch[0].evaluate(d), value, "{level:?} {across}");
            }
        }
    });
}

#[test]
fn more_mirrored_lobes_than_numbers_before_the_first_view_are_read() {
    for (thetas, count) in [(&[0.0][..], 18), (&[0.0, 1.0], 24), (&[0.0, 0.7, 1.4], 32)] {
        let lobe =
            |k| PlaneLobe { off_plane: 0.01 * k as f32, ..plane_lobe(0.02 * k as f32, 2.0 + 0.1 * k as f32) };
        let lobes: Vec<PlaneLobe> = (0..count).map(lobe).collect();
        let bytes = material(thetas, &lobes, 0, count, -126.0);
        let material = Material::from_bytes(&bytes).unwrap();
        let theta = *thetas.last().unwrap();
        for_each_level(|level| {
            let mut m = Mixture::<64>::empty();
            material.prepare(Vec3::new(-theta.sin(), 0.0, theta.cos()), &mut m).unwrap();
            assert_eq!(m.len(), 2 * count);
            for k in 0..2 * count {
                let (stored, seen) = (lobes[k % count], m.lobe(k).unwrap());
                let wanted = stored.log2_sharpness.exp2();
                assert!((seen.gaussian.sharpness / wanted - 1.0).abs() < 1e-6, "{level:?} lobe {k}");
                let side = if theta == 0.0 { 0.0 } else { stored.off_plane.sin() };
                let side = if k < count { side } else { -side };
                assert!((seen.gaussian.axis.y - side).abs() < 1e-6, "{level:?} lobe {k}");
            }
        });
    }
}

#[test]
fn products_of_a_prepared_mixture_have_its_lobes_alone() {
    let bytes =
        material(&[0.0], &[plane_lobe(0.0, 0.0), plane_lobe(0.0, 0.5), plane_lobe(0.0, 1.0)], 0, 0, -126.0);
    let material = Material::from_bytes(&bytes).unwrap();
    let light = Lobe::new(Vec3::new(0.6, 0.0, 0.8), 5.0, Vec3::ONE).unwrap();
    for_each_level(|level| {
        let mut m = Mixture::<16>::empty();
        material.prepare(Vec3::Z, &mut m).unwrap();
        let wanted = m.len() + (0..m.len()).filter(|&k| m.is_folded(k)).count();
        assert_eq!(m.product_len(&Mixture::<16>::sphere(&[light]).unwrap()), wanted, "{level:?}");
        let mut out = vec![light; wanted];
        // A diffuse term of 2^-126 is none.
        assert_eq!(
            m.product_into(&Mixture::<16>::sphere(&[light]).unwrap(), &mut out),
            Ok(wanted),
            "{level:?}"
        );
    });
}

#[test]
fn direction_and_density_alone_are_those_of_a_sample() {
    let bytes = material(&[0.0, 1.2], &[plane_lobe(0.9, 0.0), plane_lobe(1.37, 6.0)], 1, 0, -3.0);
    let material = Material::from_bytes(&bytes).unwrap();
    let lobes = [
        Lobe::new(Vec3::new(0.6, 0.0, 0.8), 50.0, Vec3::new(1.0, 2.0, 0.5)).unwrap(),
        Lobe::new(Vec3::new(0.0, 0.6, -0.8), 1e5, Vec3::ONE).unwrap(),
    ];
    for_each_level(|level| {
        let mut prepared = Mixture::<16>::empty();
        material.prepare(Vec3::new(-1.2f32.sin(), 0.0, 1.2f32.cos()), &mut prepared).unwrap();
        let mixtures = [
            prepared,
            Mixture::sphere(&lobes).unwrap(),
            Mixture::hemisphere(&lobes).unwrap(),
            Mixture::new(Domain::Hemisphere, 0.3, &lobes[..1], &lobes[1..]).unwrap(),
        ];
        let mut random = Random(79);
        for m in &mixtures {
            for _ in 0..500 {
                let u = [random.uniform(), random.uniform(), random.uniform()];
                let (sample, direction) = (m.sample(u).unwrap(), m.sample_direction(u).unwrap());
                assert_eq!(direction, sample.direction, "{level:?}");
                let pdf = m.pdf(direction);
                assert!((pdf / sample.pdf - 1.0).abs() < 1e-5, "{level:?}: {pdf} {}", sample.pdf);
            }
        }
        assert_eq!(Mixture::<16>::empty().sample_direction([0.5; 3]), None);
    });
}

#[test]
fn a_diffuse_term_can_be_taken_back() {
    let faint = Lobe::new(Vec3::Z, 10.0, Vec3::splat(1e-4)).unwrap();
    let m = Mixture::<16>::hemisphere(&[faint]).unwrap();
    let (albedo, power) = (m.albedo(), m.power());
    let m = m.with_diffuse(Vec3::splat(1000.0)).unwrap().with_diffuse(Vec3::ZERO).unwrap();
    assert_eq!((m.albedo(), m.power()), (albedo, power));
    assert_eq!(Mixture::<16>::empty().with_diffuse(Vec3::ONE).unwrap().level(), Level::current());
}

#[test]
fn what_would_be_infinite_is_refused() {
    let huge = Lobe::new(Vec3::X, 1e8, Vec3::splat(3e38)).unwrap();
    assert_eq!(Mixture::<16>::hemisphere(&[huge]).unwrap_err(), Error::Amplitude);
    let large = Lobe::new(Vec3::Z, 1e8, Vec3::splat(1e37)).unwrap();
    let narrow = Mixture::<16>::new(Domain::Hemisphere, 0.01, &[large], &[]);
    assert_eq!(narrow.unwrap_err(), Error::Amplitude);
    assert!(Mixture::<16>::hemisphere(&[large]).is_ok());
    assert!(KernelTable::<256>::new(Vec3::Z, |w| 1e32 * (-1e8 * w).exp()).is_err());
}

#[test]
fn a_lobe_that_is_all_there_is_is_never_left_out() {
    let mut random = Random(78);
    for _ in 0..200 {
        let lobe = PlaneLobe {
            log2_luminance: random.between(-3.0, 3.0),
            color_differences: [random.between(-16.0, 16.0), random.between(-16.0, 16.0)],
            ..plane_lobe(0.0, random.between(-2.0, 12.0))
        };
        let bytes = material(&[0.0], &[lobe], 0, 0, -126.0);
        let material = Material::from_bytes(&bytes).unwrap();
        let mut m = Mixture::<16>::empty();
        let all = LeaveOut::new(1.0, 1e-7).unwrap();
        material.prepare_with(Vec3::Z, all.into(), &mut m).unwrap();
        assert_eq!(m.len(), 1, "{:?}", m.lobe(0));
    }
}

#[test]
fn a_level_that_was_asked_for_is_what_it_is_when_set() {
    let bytes = material(&[0.0, 0.6, 1.2], &[plane_lobe(0.9, 0.0), plane_lobe(0.7, 6.3)], 1, 0, -3.0);
    let material = Material::from_bytes(&bytes).unwrap();
    let wo = Vec3::new(-0.8f32.sin(), 0.0, 0.8f32.cos());
    let lobes = [Lobe::new(Vec3::new(0.6, 0.0, 0.8), 7.0, Vec3::new(0.3, 0.2, 0.1)).unwrap()];
    let directions = [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.48, 0.64, 0.6)];
    let values = |m: &Mixture<16>| directions.map(|d| (m.evaluate(d), m.pdf(d)));
    let mut wanted = Vec::new();
    for_each_level(|level| {
        let (mut m, leave_out) = (Mixture::<16>::empty(), LeaveOut::default());
        material.prepare_with(wo, leave_out.into(), &mut m).unwrap();
        wanted.push((level, values(&m), values(&Mixture::hemisphere(&lobes).unwrap())));
    });
    // Whatever is set now and whatever a mixture was made on.
    for_each_level(|_| {
        for (level, prepared, made) in &wanted {
            let mut m = Mixture::<16>::empty();
            material.prepare_with(wo, (*level).into(), &mut m).unwrap();
            assert_eq!((m.level(), values(&m)), (*level, *prepared));
            let m = Mixture::hemisphere(&lobes).unwrap().with_level(*level).unwrap();
            assert_eq!((m.level(), values(&m)), (*level, *made));
        }
    });
    for level in Level::ALL.into_iter().filter(|level| !level.is_available()) {
        let mut m = Mixture::<16>::hemisphere(&lobes).unwrap();
        assert!(matches!(m.clone().with_level(level), Err(Error::Level)));
        assert_eq!(material.prepare_with(wo, level.into(), &mut m), Err(Error::Level));
        assert!(m.is_empty());
    }
}
