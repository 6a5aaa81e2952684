//! Estimators, integrals of mixtures, series and the random walk, against quadrature and against each other.

use glam::{DVec3, Vec3};
use srbf_core::{
    AbelPoisson, Defensive, Domain, Error, Gaussian, Kernel, Lobe, Metropolis, Mixture,
    gaussian_coefficients_into, legendre_coefficients_into, legendre_series, legendre_singular_integral,
    power_heuristic, special,
};
use srbf_tests::inputs::Random;
use srbf_tests::oracle;
use srbf_tests::statistics::{ks_critical, ks_distance};

#[test]
fn estimates_agree_with_quadrature() {
    let mut random = Random(32);
    // Light that is not of the mixture's form: a step and a slope.
    let light = |d: Vec3| if d.x > 0.2 { 1.0 + d.y } else { 0.3 };
    for (squeeze, diffuse) in [(1.0, 0.0), (0.4, 0.0), (1.0, 0.6)] {
        let lobes: Vec<Lobe> = (0..6).map(|_| random.lobe(0.0, 2.0)).collect();
        let m = Mixture::<16>::new(Domain::Hemisphere, squeeze, &lobes[..3], &lobes[3..]).unwrap();
        let m = m.with_diffuse(Vec3::splat(diffuse)).unwrap();
        let lambert = |d: DVec3| f64::from(diffuse) * d.z.max(0.0) / std::f64::consts::PI;
        let want = oracle::integrate(Domain::Hemisphere, 300, |d| {
            (oracle::luminance(oracle::mixture(&m, d)) + lambert(d)) * f64::from(light(d.as_vec3()))
        });

        const N: usize = 200_000;
        let luminance = |v: Vec3| f64::from(srbf_core::luminance(v));
        let mut one = 0.0;
        for _ in 0..N {
            let s = m.sample(random.three()).unwrap();
            one += luminance(s.weight) * f64::from(light(s.direction));
        }
        one /= N as f64;

        println!("quadrature {want:.5}, one-sample {one:.5}");
        // A few standard errors, and the error of the quadrature at the step of the light.
        assert!((one / want - 1.0).abs() < 6e-3, "{one}, {want}");
    }
}

#[test]
fn the_heuristic_gives_weights() {
    {
        let f = power_heuristic;
        for a in [0.0, 1e-38, 1e-3, 1.0, 1e30, f32::MAX] {
            for b in [0.0, 1e-38, 1e-3, 1.0, 1e30, f32::MAX] {
                for (n, m) in [(1.0, 1.0), (3.0, 50.0), (0.0, 2.0)] {
                    let (x, y) = (f(n, a, m, b), f(m, b, n, a));
                    assert!((0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y), "{a:e} {b:e}");
                    let possible = n * a > 0.0 || m * b > 0.0;
                    assert!(
                        (x + y - if possible { 1.0 } else { 0.0 }).abs() < 1e-6,
                        "{n} {a:e} {m} {b:e}: {x} + {y}"
                    );
                }
            }
        }
    }
    assert_eq!(power_heuristic(1.0, 3.0, 1.0, 1.0), 0.9);
}

#[test]
fn a_defensive_component_bounds_the_weight_and_keeps_the_mean() {
    let mut random = Random(33);
    for domain in [Domain::Hemisphere, Domain::Sphere] {
        let mirror = Lobe::new(Vec3::new(0.6, 0.0, 0.8), 3e3, Vec3::splat(300.0)).unwrap();
        let m = match domain {
            Domain::Hemisphere => Mixture::<16>::hemisphere(&[mirror]).unwrap(),
            Domain::Sphere => Mixture::<16>::sphere(&[mirror]).unwrap(),
        };
        let defensive = Defensive::new(&m, 0.05).unwrap();
        // The truth has a wide part that the mixture lacks; it is at most 1 per steradian and cosine.
        let truth = |d: Vec3| {
            if domain == Domain::Hemisphere { d.z.max(0.0) * (0.5 + 0.5 * d.x) } else { 0.5 + 0.5 * d.x }
        };
        let solid_angle = if domain == Domain::Hemisphere { 1.0 } else { 4.0 };
        let bound = std::f32::consts::PI * solid_angle / 0.05;
        let mut sum = 0.0;
        const N: usize = 200_000;
        for _ in 0..N {
            let s = defensive.sample(random.three());
            assert!((s.pdf / defensive.pdf(s.direction) - 1.0).abs() < 1e-5);
            let weight = truth(s.direction) / s.pdf;
            assert!(weight <= bound * 1.000_01, "{weight} above {bound}");
            sum += f64::from(weight);
        }
        let want = if domain == Domain::Hemisphere {
            0.5 * std::f64::consts::PI
        } else {
            2.0 * std::f64::consts::PI
        };
        assert!((sum / N as f64 / want - 1.0).abs() < 0.04, "{domain:?}: {}", sum / N as f64);
    }
    let black = Mixture::<16>::empty();
    let all = Defensive::new(&black, 0.05).unwrap();
    let s = all.sample([0.7, 0.25, 0.5]);
    assert!((s.pdf - s.direction.z / core::f32::consts::PI).abs() < 1e-6);
}

#[test]
fn inner_products_of_mixtures_are_their_integrals() {
    let mut random = Random(34);
    for case in 0..6 {
        let lobes = |random: &mut Random| (0..4).map(|_| random.lobe(-1.0, 1.8)).collect::<Vec<_>>();
        let (a, b) = (lobes(&mut random), lobes(&mut random));
        for (first, second) in [
            (Domain::Sphere, Domain::Sphere),
            (Domain::Hemisphere, Domain::Hemisphere),
            (Domain::Hemisphere, Domain::Sphere),
        ] {
            let make = |domain, lobes: &[Lobe]| Mixture::<16>::new(domain, 1.0, &[], lobes).unwrap();
            let (m, n) = (make(first, &a), make(second, &b));
            let want = oracle::integrate(first, 60, |d| oracle::mixture(&m, d).y * oracle::mixture(&n, d).y);
            let got = f64::from(m.inner_product(&n).unwrap().y);
            assert!((got / want - 1.0).abs() < 2e-4, "case {case}, {first:?}, {second:?}: {got}, {want}");
            let back = f64::from(n.inner_product(&m).unwrap().y);
            assert!((back / got - 1.0).abs() < 2e-6, "does not commute");

            // The lobes of the product have the product's value.
            let mut out = vec![a[0]; m.product_len(&n)];
            assert_eq!(m.product_into(&n, &mut out).unwrap(), out.len());
            let d = DVec3::new(0.3, -0.5, 0.6).normalize();
            let value: f64 = out.iter().map(|l| f64::from(l.value(d.as_vec3()).x)).sum();
            let want = oracle::mixture(&m, d).x * oracle::mixture(&n, d).x;
            assert!((value / want - 1.0).abs() < 2e-5, "value {value}, {want}");
            assert!(matches!(m.product_into(&n, &mut out[1..]), Err(Error::Capacity { .. })));
        }
        // A lobe of light on a folded mixture: the reflected radiance.
        let m = Mixture::<16>::hemisphere(&a).unwrap();
        let light = b[0];
        let want = oracle::integrate(Domain::Hemisphere, 60, |d| {
            oracle::mixture(&m, d).x
                * f64::from(light.amplitude.x)
                * oracle::gaussian(light.gaussian.axis.as_dvec3(), f64::from(light.gaussian.sharpness), d)
        });
        let light_alone = Mixture::<16>::sphere(&[light]).unwrap();
        let got = f64::from(m.inner_product(&light_alone).unwrap().x);
        assert!((got / want - 1.0).abs() < 3e-4, "light: {got}, {want}");
        let mut out = vec![light; 16];
        let n = m.product_into(&light_alone, &mut out).unwrap();
        let integral: f64 =
            out[..n].iter().map(|l| f64::from(l.amplitude.x * l.gaussian.hemisphere_integral())).sum();
        assert!((integral / got - 1.0).abs() < 1e-5, "product with a lobe");
        let pair = a[0].inner_product(&a[1]).x;
        let whole =
            Mixture::<16>::sphere(&a[..1]).unwrap().inner_product(&Mixture::<16>::sphere(&a[1..2]).unwrap());
        assert!((pair / whole.unwrap().x - 1.0).abs() < 1e-6);
    }
    let squeezed = random.mixture(Domain::Hemisphere, 3, 0.5);
    assert_eq!(squeezed.inner_product(&squeezed), Err(Error::Squeezed));
}

#[test]
fn caps_hold_their_share() {
    for s in [0.0, 0.5, 40.0, 1e6] {
        let g = Gaussian::new(Vec3::Y, s).unwrap();
        for w in [0.0, 1e-6, 0.3, 2.0] {
            let share = f64::from(g.cap_integral(w)) / f64::from(g.integral());
            assert!((share - oracle::share_within(f64::from(s), f64::from(w))).abs() < 1e-6, "{s} {w}");
        }
    }
}

#[test]
fn coefficients_by_quadrature_agree_with_the_closed_forms() {
    let mut closed = [0.0; 64];
    let mut integrated = [0.0; 64];
    for s in [0.0, 1e-8, 1e-2, 1.0, 10.0, 300.0, 1e4, 1e6, 1e8] {
        gaussian_coefficients_into(s, &mut closed);
        let g = Gaussian::new(Vec3::Z, s).unwrap();
        legendre_coefficients_into(|w| g.value_at(2.0 * w), &mut integrated);
        let mean = special::sphere_integral(s) / (4.0 * core::f32::consts::PI);
        for l in 0..64 {
            let error = (integrated[l] - closed[l]).abs() / (mean * (2 * l + 1) as f32);
            assert!(error < 1.5e-6, "Gaussian {s:e}, l {l}: {:e} {:e}, {error:e}", integrated[l], closed[l]);
        }
    }
    for epsilon in [1e-6, 1e-3, 0.05, 0.5, 1.0] {
        let k = AbelPoisson::from_epsilon(Vec3::Z, epsilon).unwrap();
        srbf_core::abel_poisson_coefficients_into(epsilon, &mut closed);
        legendre_coefficients_into(|w| k.value_at(2.0 * w), &mut integrated);
        for l in 0..64 {
            let error = (integrated[l] - closed[l]).abs() / (2 * l + 1) as f32;
            assert!(
                error < 1.5e-6,
                "Abel-Poisson {epsilon:e}, l {l}: {:e} {:e}, {error:e}",
                integrated[l],
                closed[l]
            );
        }
    }
}

#[test]
fn series_give_the_kernel_and_its_singular_integral() {
    for (s1, s2) in [(0.0, 1.0), (1.0, 2.0), (10.0, 25.0), (60.0, 60.0)] {
        let (mut g, mut h) = ([0.0; 96], [0.0; 96]);
        gaussian_coefficients_into(s1, &mut g);
        gaussian_coefficients_into(s2, &mut h);
        let bound = 2e-7 * 104.0;
        for i in 0..=40 {
            let w = 0.05 * i as f32;
            let want = (-f64::from(s1) * f64::from(w)).exp();
            let size: f64 = g.iter().map(|&c| f64::from(c)).sum();
            let got = f64::from(legendre_series(&g, w));
            assert!((got - want).abs() < bound * size, "{s1}, w {w}: {got}, {want}");
            // The series of eq. 4 against the closed form of eq. 6.
            let axis = Vec3::new((w * (2.0 - w)).max(0.0).sqrt(), 0.0, 1.0 - w).normalize();
            let (a, b) = (Gaussian::new(Vec3::Z, s1).unwrap(), Gaussian::new(axis, s2).unwrap());
            let closed = f64::from(a.product(&b).integral());
            let series = f64::from(legendre_singular_integral(&g, &h, w));
            let peak = f64::from(a.product(&Gaussian::new(Vec3::Z, s2).unwrap()).integral());
            assert!((series - closed).abs() < 2e-5 * peak, "{s1} {s2} {w}: {series}, {closed}");
        }
    }
    assert_eq!(legendre_series(&[], 0.5), 0.0);
    assert_eq!(legendre_series(&[0.0, 0.0, 1.0], 1.0), -0.5);
    for l in 0..12 {
        let mut one = [0.0; 12];
        one[l] = 1.0;
        let want = oracle::legendre(l, 0.3);
        assert!((f64::from(legendre_series(&one, 0.7)) - want).abs() < 1e-6);
    }
}

#[test]
fn the_random_walk_comes_closer_with_every_step() {
    const N: usize = 100_000;
    for s in [0.0f32, 5.0, 1e3, 1e8] {
        let g = Gaussian::new(Vec3::new(0.36, 0.48, 0.8), s).unwrap();
        let value = |w: f32| g.value_at(2.0 * w);
        let mut distances = Vec::new();
        for steps in [0, 1, 2, 5, 10, 50] {
            let walk = Metropolis { steps, floor: 0.01 };
            let range = walk.range(value);
            // Directions below the floor are not drawn: the distribution is that of the rest.
            let last = 2.0 * (0.5 * f64::from(range)).sin().powi(2);
            let within = oracle::share_within(f64::from(s), last);
            let mut random = Random(35);
            let mut w: Vec<f64> =
                (0..N).map(|_| f64::from(walk.one_minus_cos(value, range, &mut random))).collect();
            assert!(w.iter().all(|&w| w <= last * 1.000_01), "s {s:e}");
            distances.push(ks_distance(&mut w, |w| oracle::share_within(f64::from(s), w.min(last)) / within));
        }
        println!("s {s:7.0e}: distance after 0, 1, 2, 5, 10, 50 steps {distances:.4?}");
        assert!(distances.windows(2).all(|d| d[1] < d[0] || d[1] < 2.0 * ks_critical(N, 0.01)), "{s}");
        assert!(distances[5] < ks_critical(N, 0.001), "{s}: {distances:?}");
    }
    assert_eq!(Metropolis::default(), Metropolis { steps: 5, floor: 0.01 });
    // A direction: round the axis, within the range; the kernel may be any.
    let k = AbelPoisson::new(Vec3::X, 0.9).unwrap();
    let walk = Metropolis::default();
    let range = walk.range(|w| k.value_at(2.0 * w));
    let mut random = Random(36);
    let dynamic: &mut dyn rand_core::Rng<Error = std::convert::Infallible> = &mut random;
    for _ in 0..1000 {
        let d = walk.sample(&k, range, dynamic);
        assert!((d.length() - 1.0).abs() < 4e-7 && k.value(d) >= 0.009 * k.value(Vec3::X), "{d}");
    }
}
