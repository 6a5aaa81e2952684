//! Every extreme, one by one: refused by a constructor, or met without a NaN.

use glam::Vec3;
use srbf_core::{
    AbelPoisson, Defensive, Domain, Error, Folded, Gaussian, KernelTable, Lobe, Mixture, special,
};
use srbf_tests::inputs::{Random, UNIFORM, axes};

fn directions() -> Vec<Vec3> {
    let mut random = Random(5);
    let mut all = axes();
    all.extend((0..50).map(|_| random.direction()));
    all
}

/// Value, density and samples of a mixture: finite, not negative, unit, consistent.
fn check(name: &str, m: &Mixture<16>) {
    for d in directions() {
        let (value, pdf) = m.evaluate_and_pdf(d);
        assert!(value.is_finite() && value.min_element() >= 0.0, "{name}: value {value} at {d}");
        assert!(pdf.is_finite() && pdf >= 0.0, "{name}: pdf {pdf} at {d}");
    }
    for u0 in UNIFORM {
        for u1 in UNIFORM {
            if let Some(s) = m.sample([u0, u1, 0.3]) {
                assert!((s.direction.length() - 1.0).abs() < 4e-7, "{name}: {}", s.direction);
                assert!(s.pdf >= 0.0 && s.pdf.is_finite() && s.weight.is_finite(), "{name}: {s:?}");
            } else {
                assert!(m.power() == 0.0, "{name}: what reflects draws");
            }
        }
    }
}

fn lobe(axis: Vec3, s: f32, a: f32) -> Lobe {
    Lobe::new(axis, s, Vec3::splat(a)).unwrap()
}

#[test]
fn sharpness_that_has_no_meaning_is_refused() {
    for s in [-1e-30, -1.0, 1.1e8, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
        assert_eq!(Gaussian::new(Vec3::Z, s), Err(Error::Sharpness), "{s}");
        assert_eq!(Lobe::new(Vec3::Z, s, Vec3::ONE), Err(Error::Sharpness), "{s}");
    }
}

#[test]
fn tiny_sharpness_is_constant() {
    for s in [0.0, 1e-45, 1e-30, 1e-8] {
        let g = Gaussian::new(Vec3::X, s).unwrap();
        assert!((g.integral() / (4.0 * core::f32::consts::PI) - 1.0).abs() < 2e-7, "{s}");
        for d in directions() {
            assert!((g.value(d) - 1.0).abs() < 1e-7);
            assert!((g.pdf(d) * 4.0 * core::f32::consts::PI - 1.0).abs() < 3e-7);
        }
        for u in UNIFORM {
            assert!((special::one_minus_cos(u, s) / (2.0 * u).max(1e-38) - 1.0).abs() < 3e-7 || u == 0.0);
        }
        assert!((g.hemisphere_integral() / core::f32::consts::TAU - 1.0).abs() < 1e-6);
        check("tiny sharpness", &Mixture::hemisphere(&[lobe(Vec3::X, s, 1.0)]).unwrap());
    }
}

#[test]
fn the_largest_sharpness_works_on_every_axis() {
    for axis in axes() {
        let g = Gaussian::new(axis, 1e8).unwrap();
        assert_eq!(g.value(g.axis), 1.0);
        assert_eq!(g.value(-g.axis), 0.0);
        assert!((g.integral() * 1e8 / core::f32::consts::TAU - 1.0).abs() < 3e-7);
        check("1e8", &Mixture::hemisphere(&[lobe(axis, 1e8, 1.0)]).unwrap());
        check("1e8 squeezed", &Mixture::new(Domain::Hemisphere, 0.01, &[lobe(axis, 1e8, 1.0)], &[]).unwrap());
    }
}

#[test]
fn amplitudes_from_nothing_to_the_largest() {
    let amplitude = |r, g, b| Lobe::new(Vec3::Z, 1.0, Vec3::new(r, g, b));
    for a in [-1.0, f32::INFINITY, f32::NAN] {
        assert_eq!(amplitude(1.0, a, 1.0), Err(Error::Amplitude), "{a}");
    }
    // A channel may be negative, and up to 32 times the luminance; luminance none without any.
    for (red, green, blue) in [(-1e-38, 1.0, 1.0), (1.0, -0.2, 0.0), (-2.5, 1.0, 0.0), (0.0, 0.0, 1e-44)] {
        assert!(amplitude(red, green, blue).is_ok(), "{red}, {green}, {blue}");
    }
    for (red, green, blue) in [(1.0, -0.29, 0.0), (-3.36, 1.0, 0.0), (-1e-38, 0.0, 0.0), (0.0, 0.0, -1.0)] {
        assert_eq!(amplitude(red, green, blue), Err(Error::Amplitude), "{red}, {green}, {blue}");
        let black = Mixture::<16>::empty().with_diffuse(Vec3::new(red, green, blue));
        assert_eq!(black.err(), Some(Error::Amplitude), "{red}, {green}, {blue}");
    }
    // A black mixture reflects nothing and draws nothing; so does one whose integral underflows.
    for m in [
        Mixture::hemisphere(&[lobe(Vec3::Z, 5.0, 0.0), lobe(Vec3::X, 0.0, 0.0)]).unwrap(),
        Mixture::hemisphere(&[lobe(Vec3::Z, 1e8, 1e-38)]).unwrap(),
        Mixture::<16>::empty(),
    ] {
        assert_eq!(m.sample([0.5; 3]), None);
        assert_eq!(m.pdf(Vec3::Z), 0.0);
        assert_eq!(m.power(), 0.0);
        check("black", &m);
    }
    let faint: Mixture<16> = Mixture::hemisphere(&[lobe(Vec3::Z, 0.1, 1e-37)]).unwrap();
    assert!(faint.sample([0.5; 3]).is_some());
    check("faint", &faint);
    // 1e38 is fine where the integral is finite, and refused where it is not.
    check("1e38", &Mixture::hemisphere(&[lobe(Vec3::Z, 1e4, 1e38)]).unwrap());
    assert_eq!(Mixture::<16>::hemisphere(&[lobe(Vec3::Z, 0.0, 1e38)]).err(), Some(Error::Amplitude));
    assert_eq!(lobe(Vec3::Z, 0.0, 1e38).integral().x, f32::INFINITY);
    // One lobe of nothing beside one of something is never drawn.
    let m: Mixture<16> = Mixture::hemisphere(&[lobe(Vec3::X, 1e4, 0.0), lobe(Vec3::Z, 1e4, 1.0)]).unwrap();
    for u in UNIFORM {
        assert!(m.sample([u, 0.5, 0.5]).unwrap().direction.z > 0.9, "{u}");
    }
}

#[test]
fn axes_that_are_not_quite_unit_are_normalised_or_refused() {
    for axis in axes() {
        for scale in [1.0 - 9e-4, 1.0 - 1e-6, 1.0 + 1e-6, 1.0 + 9e-4] {
            let g = Gaussian::new(axis * scale, 1e8).unwrap();
            assert!((g.axis.length() - 1.0).abs() < 2e-7);
            assert!(g.value(axis) > 0.99, "{}", g.value(axis));
            AbelPoisson::new(axis * scale, 0.5).unwrap();
        }
        for bad in [axis * 0.9, axis * 1.1, axis * f32::INFINITY, axis * f32::NAN, Vec3::ZERO] {
            assert_eq!(Gaussian::new(bad, 1.0), Err(Error::Axis));
            assert_eq!(AbelPoisson::new(bad, 0.5), Err(Error::Axis));
        }
        let below: Mixture<16> = Mixture::hemisphere(&[lobe(axis, 50.0, 1.0)]).unwrap();
        assert!((below.albedo().x / below.lobe(0).unwrap().integral().x - 1.0).abs() < 1e-6);
        check("axis", &below);
    }
}

#[test]
fn pairs_of_lobes_identical_and_opposite() {
    for s in [0.0, 1e-30, 1e-8, 1.0, 1e4, 1e8] {
        for axis in axes() {
            let a = Gaussian::new(axis, s).unwrap();
            // Identical: twice the sharpness, the same axis, no exponent.
            let p = a.product(&a);
            assert!((p.gaussian.sharpness - 2.0 * s).abs() <= 3e-7 * s, "{s:e}");
            assert!(p.exponent <= 1e-6 * (1.0 + s * 1e-8), "{s:e}: {}", p.exponent);
            assert!(s < 1e-20 || p.gaussian.axis.dot(axis) > 1.0 - 3e-7);
            // Opposite and equal: a constant.
            let p = a.product(&Gaussian::new(-axis, s).unwrap());
            assert_eq!(p.gaussian.sharpness, 0.0, "{s:e}");
            assert!((p.exponent - 2.0 * s).abs() <= 3e-7 * s);
            assert!(p.value(Vec3::X).is_finite() && p.integral().is_finite());
            // Almost either: unit axes, no NaN.
            for offset in [1e-7, 1e-4] {
                let t = axis.any_orthonormal_vector();
                for other in [(axis + t * offset).normalize(), (t * offset - axis).normalize()] {
                    let p = a.product(&Gaussian::new(other, s).unwrap());
                    assert!((p.gaussian.axis.length() - 1.0).abs() < 3e-7, "{s:e}, {offset}");
                    assert!(
                        p.exponent >= 0.0 && p.gaussian.sharpness.is_finite() && p.integral().is_finite()
                    );
                }
            }
        }
    }
    let twice: Mixture<16> = Mixture::hemisphere(&[lobe(Vec3::Z, 30.0, 0.5); 2]).unwrap();
    let once: Mixture<16> = Mixture::hemisphere(&[lobe(Vec3::Z, 30.0, 1.0)]).unwrap();
    for d in directions() {
        assert!((twice.pdf(d) - once.pdf(d)).abs() <= 1e-6 * once.pdf(d));
    }
}

#[test]
fn sharpness_1e_minus_3_beside_1e8() {
    let wide = lobe(Vec3::new(0.6, 0.0, 0.8), 1e-3, 1.0);
    let sharp = lobe(Vec3::new(0.0, 0.6, 0.8), 1e8, 1e8);
    for m in [
        Mixture::<16>::hemisphere(&[wide, sharp]).unwrap(),
        Mixture::new(Domain::Hemisphere, 0.01, &[sharp], &[wide]).unwrap(),
        Mixture::new(Domain::Sphere, 1.0, &[], &[sharp, wide]).unwrap(),
    ] {
        check("mixed", &m);
        let product = m.inner_product(&m);
        assert!(product.is_err() || product.unwrap().is_finite());
    }
}

#[test]
fn parameters_out_of_range_are_refused() {
    let g = Gaussian::new(Vec3::Z, 1.0).unwrap();
    for c in [0.0, 0.009, 2.1, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(Folded::squeezed(g, c).err(), Some(Error::Squeeze), "{c}");
        assert_eq!(Mixture::<16>::new(Domain::Sphere, c, &[], &[]).err(), Some(Error::Squeeze), "{c}");
    }
    assert_eq!(Folded::new(g).kernel(), &g);
    for h in [-0.1, -1e-9, 1.0, 1.5, f32::NAN, f32::INFINITY] {
        assert_eq!(AbelPoisson::new(Vec3::Z, h), Err(Error::Kernel), "{h}");
    }
    for f in [|_: f32| -1.0, |_| f32::NAN, |_| 0.0, |_| f32::INFINITY] {
        assert_eq!(KernelTable::<32>::new(Vec3::Z, f).err(), Some(Error::Kernel));
    }
    let m: Mixture<16> = Mixture::hemisphere(&[lobe(Vec3::Z, 1.0, 1.0)]).unwrap();
    for share in [-0.1, 1.1, f32::NAN] {
        assert!(Defensive::new(&m, share).is_err(), "{share}");
    }
    let seventeen = [lobe(Vec3::Z, 1.0, 1.0); 17];
    assert_eq!(Mixture::<16>::sphere(&seventeen).err(), Some(Error::Capacity { needed: 17, available: 16 }));
}

#[test]
fn directions_that_are_no_number_never_panic() {
    let m: Mixture<16> = Mixture::hemisphere(&[lobe(Vec3::Z, 1e8, 1.0), lobe(Vec3::X, 0.0, 1.0)]).unwrap();
    for d in [Vec3::NAN, Vec3::INFINITY, Vec3::new(0.0, f32::NAN, 1.0), Vec3::ZERO] {
        let _ = (m.evaluate(d), m.pdf(d), m.evaluate_and_pdf(d));
        let f = Folded::squeezed(Gaussian::new(Vec3::Z, 10.0).unwrap(), 0.5).unwrap();
        let _ = (f.value(d), f.pdf(d), f.invert_sample(d, 0.5));
    }
}

#[test]
fn the_fold_is_left_out_only_within_its_bound() {
    // The bound of the share below the horizon holds, and the rule of mixtures keeps to it.
    for i in 0..400 {
        let z = (i as f32 + 0.5) / 400.0;
        for s in [0.0f32, 0.1, 3.0, 20.0, 100.0, 1e3, 1e5, 1e8] {
            let axis = Vec3::new((1.0 - z * z).sqrt(), 0.0, z).normalize();
            let below = Gaussian { axis: -axis, sharpness: s };
            let share = below.hemisphere_integral() / below.integral();
            let bound = special::share_below_horizon_bound(axis.z, s);
            assert!(
                share <= bound * (1.0 + 1e-5 * (2.0 + bound.max(1e-38).ln().abs())),
                "z {z}, s {s}: {share:e}, {bound:e}"
            );
            let m: Mixture<16> = Mixture::hemisphere(&[lobe(axis, s, 1.0)]).unwrap();
            assert!(m.is_folded(0) || bound <= 1.01e-7, "z {z}, s {s}: fold left out at {bound:e}");
            assert!(!m.is_folded(0) || bound >= 0.9e-7, "z {z}, s {s}: fold kept at {bound:e}");
        }
    }
    assert_eq!(special::share_below_horizon_bound(0.0, 1e8), 1.0);
    assert_eq!(special::share_below_horizon_bound(-0.5, 1.0), 1.0);
}
