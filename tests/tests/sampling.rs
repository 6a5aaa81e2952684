//! Samples against the distribution: Kolmogorov-Smirnov in the lobe's own scale, distinct directions, the ends of u.

use glam::Vec3;
use srbf_core::{AbelPoisson, Folded, Gaussian, Kernel, KernelTable, Lobe, Mixture};
use srbf_tests::inputs::{Random, SHARPNESS, UNIFORM, axes, levels};
use srbf_tests::oracle;
use srbf_tests::statistics::{ks_critical, ks_distance, sidak};

const SAMPLES: usize = 1_000_000;

/// `1 - cos` of the angle to an axis, in f64 from the rounded direction.
fn one_minus_cos(axis: Vec3, d: Vec3) -> f64 {
    0.5 * (d.as_dvec3().normalize() - axis.as_dvec3().normalize()).length_squared()
}

#[test]
fn a_million_samples_follow_the_distribution_at_every_sharpness() {
    // 15 sharpnesses, each by the single lobe and by the mixture: together at 1 %.
    let critical = ks_critical(SAMPLES, sidak(0.01, 2 * SHARPNESS.len()));
    let axis = Vec3::new(0.36, 0.48, 0.8);
    let mut random = Random(11);
    for s in SHARPNESS {
        let g = Gaussian::new(axis, s).unwrap();
        let m = Mixture::<16>::sphere(&[Lobe::new(axis, s, Vec3::ONE).unwrap()]).unwrap();
        let cdf = |w: f64| oracle::share_within(f64::from(s), w);
        let mut single: Vec<f64> =
            (0..SAMPLES).map(|_| one_minus_cos(axis, g.sample(random.two()))).collect();
        let mut mixed: Vec<f64> =
            (0..SAMPLES).map(|_| one_minus_cos(axis, m.sample(random.three()).unwrap().direction)).collect();
        let (single, mixed) = (ks_distance(&mut single, cdf), ks_distance(&mut mixed, cdf));
        println!("s {s:7.0e}: distance {single:.6} (lobe), {mixed:.6} (mixture), critical {critical:.6}");
        assert!(single < critical && mixed < critical, "s {s:e}");
    }
}

#[test]
fn the_inverse_is_exact_for_u_of_every_size() {
    let mut worst = 0f64;
    for s in SHARPNESS {
        // All of [0, 1) in steps of 1009 numbers, and every number within 1e-6 of 1.
        let one = 1f32.to_bits();
        for bits in (0..one).step_by(1009).chain(one - 20..one) {
            let u = f32::from_bits(bits);
            let want = if s == 0.0 {
                2.0 * f64::from(u)
            } else {
                -(f64::from(u) * (-2.0 * f64::from(s)).exp_m1()).ln_1p() / f64::from(s)
            };
            if want >= f64::from(f32::MIN_POSITIVE) {
                let error = (f64::from(srbf_core::special::one_minus_cos(u, s)) / want - 1.0).abs();
                assert!(error < 2e-6, "u {u:e}, s {s:e}: {error:e}");
                worst = worst.max(error);
            }
        }
    }
    println!("worst relative error of 1 - cos: {worst:.2e}");
}

#[test]
fn samples_of_a_mixture_lie_at_the_exact_angle() {
    // Round +z the components x and y keep every digit of the angle.
    for level in levels() {
        level.set().unwrap();
        let mut worst = (0f64, String::new());
        for s in SHARPNESS {
            let m = Mixture::<16>::sphere(&[Lobe::new(Vec3::Z, s, Vec3::ONE).unwrap()]).unwrap();
            let one = 1f32.to_bits();
            for bits in (0..one).step_by(100_003).chain(one - 20..one) {
                let u = f32::from_bits(bits);
                let s = f64::from(s);
                let want = if s == 0.0 {
                    2.0 * f64::from(u)
                } else {
                    -(f64::from(u) * (-2.0 * s).exp_m1()).ln_1p() / s
                };
                // Below 1e-30 the squares of x and y underflow; beyond 60 degrees z says more.
                if want > 1e-30
                    && let Some(sample) = m.sample([0.5, u, 0.125])
                {
                    let d = sample.direction.as_dvec3();
                    let square = d.x * d.x + d.y * d.y;
                    let w = if want < 0.5 { square / (1.0 + (1.0 - square).sqrt()) } else { 1.0 - d.z };
                    let error = (w / want - 1.0).abs();
                    if error > worst.0 {
                        worst = (error, format!("u {u:e}, s {s:e}"));
                    }
                }
            }
        }
        println!(
            "{}: worst relative error of 1 - cos of samples: {:.2e} at {}",
            level.name(),
            worst.0,
            worst.1
        );
        assert!(worst.0 < 2e-6, "{}: {worst:?}", level.name());
    }
}

#[test]
fn the_distance_test_rejects_a_sharpness_two_percent_off() {
    let g = Gaussian::new(Vec3::Z, 1e6).unwrap();
    let mut random = Random(12);
    let mut w: Vec<f64> = (0..SAMPLES).map(|_| one_minus_cos(Vec3::Z, g.sample(random.two()))).collect();
    let distance = ks_distance(&mut w, |w| oracle::share_within(1.02e6, w));
    assert!(distance > 3.0 * ks_critical(SAMPLES, 0.01), "{distance}");
}

#[test]
fn a_million_samples_at_sharpness_1e6_are_distinct() {
    for axis in [Vec3::Z, Vec3::new(0.36, 0.48, 0.8), Vec3::X] {
        let g = Gaussian::new(axis, 1e6).unwrap();
        let mut random = Random(13);
        let mut bits: Vec<[u32; 3]> =
            (0..SAMPLES).map(|_| g.sample(random.two()).to_array().map(f32::to_bits)).collect();
        bits.sort_unstable();
        bits.dedup();
        println!("axis {axis}: {} distinct directions of {SAMPLES}", bits.len());
        assert!(bits.len() > 900_000, "axis {axis}: {}", bits.len());
    }
}

#[test]
fn the_ends_of_u_give_unit_vectors_in_the_right_place() {
    for s in SHARPNESS {
        for axis in axes() {
            let g = Gaussian::new(axis, s).unwrap();
            let m = Mixture::<16>::hemisphere(&[Lobe::new(axis, s, Vec3::ONE).unwrap()]).unwrap();
            for u in UNIFORM {
                for turns in [0.0, 0.125, 0.5, 1.0 - f32::EPSILON / 2.0] {
                    let d = g.sample([u, turns]);
                    let place = format!("s {s:e}, axis {axis}, u [{u:e}, {turns}]: {d}");
                    assert!((d.length() - 1.0).abs() < 4e-7, "{place}");
                    // The angle to the axis returns, within the rounding of the direction.
                    let w = one_minus_cos(axis, d);
                    let want = f64::from(srbf_core::special::one_minus_cos(u, s));
                    let rounding = 3e-7 * (w.sqrt() + want.sqrt()) + 1e-13;
                    assert!((w - want).abs() < rounding, "{place}: {w:e} {want:e}");
                    assert!(g.pdf(d).is_finite() && g.value(d) <= 1.0, "{place}");
                    if let Some(sample) = m.sample([u.min(0.999), u, turns]) {
                        let d = sample.direction;
                        assert!((d.length() - 1.0).abs() < 4e-7 && d.z >= 0.0, "{place}: mixture {d}");
                        assert!(
                            sample.pdf > 0.0 && sample.pdf.is_finite() && sample.weight.is_finite(),
                            "{place}"
                        );
                    } else {
                        // Only where the density underflows: the last share of a sharp lobe.
                        assert!(u >= 1.0 - 2e-7 && s >= 10.0, "{place}: no sample");
                    }
                }
            }
        }
    }
}

#[test]
fn other_kernels_follow_their_distribution_too() {
    let n = 200_000;
    let axis = Vec3::new(0.36, 0.48, 0.8);
    let mut random = Random(14);
    let critical = ks_critical(n, sidak(0.01, 12));
    for epsilon in [1e-6, 1e-4, 0.02, 0.3, 1.0] {
        let k = AbelPoisson::from_epsilon(axis, epsilon).unwrap();
        let e = f64::from(epsilon);
        let mut w: Vec<f64> = (0..n).map(|_| one_minus_cos(axis, k.sample(random.two()))).collect();
        let distance = ks_distance(&mut w, |w| {
            let root = (e * e + 2.0 * (1.0 - e) * w).sqrt();
            (2.0 - e) * w / (root * (root + e))
        });
        assert!(distance < critical, "Abel-Poisson {epsilon}: {distance}");
    }
    for s in [0.0, 1e-2, 1.0, 30.0, 1e4, 1e6, 1e8] {
        let g = Gaussian::new(axis, s).unwrap();
        let table = KernelTable::<256>::new(axis, |w| g.value_at(2.0 * w)).unwrap();
        let mut w: Vec<f64> = (0..n).map(|_| one_minus_cos(axis, table.sample(random.two()))).collect();
        let own = ks_distance(&mut w, |w| f64::from(table.share_within(w as f32)));
        let kernel = ks_distance(&mut w, |w| oracle::share_within(f64::from(s), w));
        println!(
            "table, s {s:e}: distance {own:.5} from its own distribution, {kernel:.5} from the kernel's"
        );
        assert!(own < critical, "table {s}: {own}");
        assert!(kernel < critical + 5e-4, "table {s}: {kernel}");
        assert!((table.integral() / g.integral() - 1.0).abs() < 3e-3, "table {s}");
    }
}

#[test]
fn a_folded_squeezed_kernel_is_inverted_by_one_of_two() {
    let mut random = Random(15);
    for s in [0.0, 0.3, 3.0, 50.0, 1e4] {
        for c in [1.0, 0.01, 0.2, 2.0] {
            for axis in axes() {
                let f = Folded::squeezed(Gaussian::new(axis, s).unwrap(), c).unwrap();
                for _ in 0..50 {
                    let u = random.two();
                    let d = f.sample(u);
                    assert!(d.z >= 0.0 && (d.length() - 1.0).abs() < 4e-7);
                    let error = |v: [f32; 2]| {
                        let turn = (v[1] - u[1]).abs();
                        let w = srbf_core::special::one_minus_cos(u[0], s);
                        let sine = (w * (2.0 - w)).sqrt();
                        (v[0] - u[0]).abs() / (2.0 + s.sqrt()) / c.min(1.0).recip()
                            + turn.min(1.0 - turn) * sine * c.min(1.0)
                    };
                    let best = error(f.invert_sample(d, 0.0)).min(error(f.invert_sample(d, 0.999_999_9)));
                    assert!(best < 2e-6, "s {s}, c {c}, axis {axis}, u {u:?}, d {d}: {best:e}");
                }
            }
        }
    }
}
