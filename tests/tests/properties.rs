//! Properties that hold for every input, with generated ones; near-equal and near-opposite axes on purpose.

use glam::{DQuat, DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use srbf_core::{Domain, Folded, Gaussian, Kernel, Lobe, Mixture};
use srbf_tests::inputs::Random;
use srbf_tests::oracle;
use srbf_tests::partition::Partition;

fn direction() -> impl Strategy<Value = Vec3> {
    (-1f64..1.0, -3.2f64..3.2).prop_map(|(z, phi)| {
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * phi.cos(), r * phi.sin(), z).normalize().as_vec3()
    })
}

/// 0 now and then, else a power of ten between -4 and `largest`.
fn sharpness(largest: f32) -> impl Strategy<Value = f32> {
    prop_oneof![1 => Just(0f32), 12 => (-4f32..largest).prop_map(|e| 10f32.powf(e))]
}

/// A second axis: any, or 1e-7 to 0.1 from the first one or from its opposite.
fn pair() -> impl Strategy<Value = (Vec3, Vec3)> {
    (direction(), direction(), -7f32..-1.0, 0usize..3).prop_map(|(a, b, exponent, kind)| {
        let near = |a: Vec3| (a + b * 10f32.powf(exponent)).normalize();
        (a, [b, near(a), near(-a)][kind])
    })
}

/// Error that rounding the directions to f32 makes in a value of exponent `t`, beyond that of the function itself.
fn rounding(s: f32, t: f64) -> f64 {
    3e-7 * (2.0 + t) + 3e-7 * (2.0 * f64::from(s) * t).sqrt()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(7), cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn values_do_not_depend_on_the_frame(
        (axis, d) in pair(), s in sharpness(8.0), turn in direction(), angle in -3f64..3.0
    ) {
        let rotation = DQuat::from_axis_angle(turn.as_dvec3().normalize(), angle);
        let rotate = |v: Vec3| (rotation * v.as_dvec3()).normalize().as_vec3();
        let before = Gaussian::new(axis, s).unwrap();
        let after = Gaussian::new(rotate(axis), s).unwrap();
        let t = -f64::from(before.value(d)).ln();
        if t < 80.0 {
            let ratio = f64::from(after.value(rotate(d))) / f64::from(before.value(d));
            prop_assert!((ratio - 1.0).abs() < rounding(s, t), "{} at t {t}", ratio - 1.0);
        }
    }

    #[test]
    fn the_inverse_of_a_sample_is_its_number(axis in direction(), s in sharpness(8.0), u in 0f32..1.0, v in 0f32..1.0) {
        let g = Gaussian::new(axis, s).unwrap();
        let [u_back, v_back] = g.invert_sample(g.sample([u, v]));
        prop_assert!((u_back - u).abs() < 3e-7 * (2.0 + s.sqrt()), "{u_back}");
        let w = srbf_core::special::one_minus_cos(u, s);
        let turn = (v_back - v).abs();
        prop_assert!(turn.min(1.0 - turn) * (w * (2.0 - w)).sqrt() < 1e-6, "{v_back}, w {w}");
    }

    #[test]
    fn the_product_of_lobes_commutes_and_is_the_product_of_their_values(
        (a, b) in pair(), s1 in sharpness(8.0), s2 in sharpness(8.0), same in any::<bool>(), d in direction()
    ) {
        let s2 = if same { s1 } else { s2 };
        let (g, h) = (Gaussian::new(a, s1).unwrap(), Gaussian::new(b, s2).unwrap());
        let (p, q) = (g.product(&h), h.product(&g));
        prop_assert!((p.exponent - q.exponent).abs() <= 3e-7 * (2.0 + p.exponent));
        prop_assert!((p.gaussian.sharpness - q.gaussian.sharpness).abs() <= 3e-7 * p.gaussian.sharpness);
        prop_assert!(p.exponent >= 0.0 && p.gaussian.sharpness >= 0.0);
        prop_assert!((p.gaussian.axis.length() - 1.0).abs() < 3e-7);
        for d in [d, p.gaussian.axis] {
            let (sg, sh) = (f64::from(s1), f64::from(s2));
            let (a, b) = (g.axis.as_dvec3(), h.axis.as_dvec3());
            let want = oracle::gaussian(a, sg, d.as_dvec3()) * oracle::gaussian(b, sh, d.as_dvec3());
            let t = -want.ln();
            if t < 85.0 {
                let error = f64::from(p.value(d)) / want - 1.0;
                prop_assert!(error.abs() < 3e-7 * (2.0 + t), "{error:e} at t {t}");
                let error = f64::from(q.value(d)) / want - 1.0;
                prop_assert!(error.abs() < 3e-7 * (2.0 + t), "{error:e} at t {t}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(7), cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn the_product_integrates_to_the_inner_product(
        (a, b) in pair(), s1 in sharpness(6.0), s2 in sharpness(6.0), same in any::<bool>()
    ) {
        let s2 = if same { s1 } else { s2 };
        let (g, h) = (Gaussian::new(a, s1).unwrap(), Gaussian::new(b, s2).unwrap());
        let p = g.product(&h);
        if p.exponent < 60.0 {
            let (a, b) = (g.axis.as_dvec3().normalize(), h.axis.as_dvec3().normalize());
            let axis = p.gaussian.axis.as_dvec3() + p.axis_low.as_dvec3();
            let whole = oracle::integrate_around(axis.normalize(), 120, |d| {
                oracle::gaussian(a, f64::from(s1), d) * oracle::gaussian(b, f64::from(s2), d)
            });
            let error = f64::from(p.integral()) / whole - 1.0;
            prop_assert!(error.abs() < 1e-5 + 3e-7 * f64::from(p.exponent), "{error:e}");
        }
    }

    #[test]
    fn a_folded_squeezed_density_integrates_to_one(axis in direction(), s in sharpness(4.0), c in 0.02f32..2.0) {
        let lobe = Lobe::new(axis, s, Vec3::ONE).unwrap();
        let m = Mixture::<16>::new(Domain::Hemisphere, c, &[lobe], &[]).unwrap();
        let folded = Folded::squeezed(lobe.gaussian, c).unwrap();
        let total = Partition::new(&m, |d| folded.pdf(d)).total();
        prop_assert!((total - 1.0).abs() < 3e-5, "folded and squeezed: {total}");
        let total = Partition::new(&m, |d| m.pdf(d)).total();
        prop_assert!((total - 1.0).abs() < 3e-5, "mixture: {total}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(7), cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn a_mixture_has_the_values_of_the_equations(
        seed in any::<u64>(), count in 1usize..64, sphere in any::<bool>(), squeeze in 0.05f32..2.0, d in direction()
    ) {
        let domain = if sphere { Domain::Sphere } else { Domain::Hemisphere };
        let m = Random(seed).mixture(domain, count, squeeze);
        let want = oracle::mixture_and_pdf(&m, d.as_dvec3()).1;
        let got = f64::from(m.pdf(d));
        // What left-out folds and the clamp of the exponent may take away, and 20 units of rounding.
        prop_assert!((got - want).abs() <= 6e-6 * want + 1e-7, "{got:e}, {want:e}");
    }
}

#[test]
fn every_kernel_has_the_density_of_its_samples_in_every_direction() {
    // The triple of the trait, by its default methods.
    let g = Gaussian::new(Vec3::Z, 5.0).unwrap();
    let k: &dyn Kernel = &g;
    let mut random = Random(3);
    for _ in 0..1000 {
        let u = random.two();
        let d = k.sample(u);
        assert_eq!(k.axis(), g.axis);
        assert_eq!(k.value(d), g.value(d));
        assert_eq!(k.pdf(d), g.pdf(d));
        assert_eq!(d, g.sample(u));
        assert_eq!(k.invert_sample(d), g.invert_sample(d));
    }
}
