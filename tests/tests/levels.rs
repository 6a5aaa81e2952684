//! Every SIMD level against the scalar one, and the scalar one against f64, for every count round the lane widths.

use srbf_core::{Domain, Level, Lobe, Mixture, PlaneLobe, SamplesMut, Vec3, View};
use srbf_core::{Material, encode, encoded_len};

/// A small deterministic generator (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 40) as f32 / (1u64 << 24) as f32
    }
    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }
    fn direction(&mut self) -> Vec3 {
        let (z, phi) = (self.between(-1.0, 1.0), self.between(0.0, core::f32::consts::TAU));
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * phi.cos(), r * phi.sin(), z).normalize()
    }
}

/// Runs `check` once per level that this machine has; prints the others, so that none passes silently.
fn for_each_level(mut check: impl FnMut(Level)) {
    // The level is chosen for the whole process: one test at a time.
    static ONE: std::sync::Mutex<()> = std::sync::Mutex::new(());
    let _guard = ONE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    for level in Level::ALL {
        if level.is_available() {
            level.set().expect("an available level");
            check(level);
        } else {
            println!("level {} NOT RUN: this machine lacks it", level.name());
        }
    }
}

fn lobes(random: &mut Random, count: usize, in_plane: bool) -> Vec<Lobe> {
    (0..count)
        .map(|_| {
            let mut axis = random.direction();
            if in_plane {
                axis = Vec3::new(axis.x, 0.0, axis.z).normalize();
            }
            let sharpness = 10f32.powf(random.between(-2.0, 5.0));
            let rgb = Vec3::new(random.next(), random.next(), random.next());
            Lobe::new(axis, sharpness, rgb).unwrap()
        })
        .collect()
}

/// `f cos` in f64 from the definition.
fn truth(m: &Mixture<64>, azimuth: f64, d: Vec3) -> [f64; 3] {
    let (sin, cos) = azimuth.sin_cos();
    let d = d.as_dvec3();
    let (x, y, z) = (d.x * cos + d.y * sin, d.y * cos - d.x * sin, d.z);
    if z < 0.0 && m.domain() == Domain::Hemisphere {
        return [0.0; 3];
    }
    let inverse = f64::from(1.0 / m.squeeze());
    let r = (x * x + y * y * inverse * inverse + z * z).sqrt();
    let mut sum = m.diffuse().to_array().map(|rho| f64::from(rho) * z / core::f64::consts::PI);
    for k in 0..m.len() {
        let lobe = m.lobe(k).unwrap();
        let axis = lobe.gaussian.axis.as_dvec3();
        let (u, scale) = if k < m.squeezed_len() {
            ([x / r, y * inverse / r, z / r], inverse / (r * r * r))
        } else {
            ([x, y, z], 1.0)
        };
        let s = f64::from(lobe.gaussian.sharpness);
        let g = |axis_z: f64| {
            let (dx, dy, dz) = (u[0] - axis.x, u[1] - axis.y, u[2] - axis_z);
            (-0.5 * s * (dx * dx + dy * dy + dz * dz)).exp()
        };
        let fold = if m.domain() == Domain::Hemisphere { g(-axis.z) } else { 0.0 };
        for (sum, a) in sum.iter_mut().zip(lobe.amplitude.to_array()) {
            *sum += f64::from(a) * (g(axis.z) + fold) * scale;
        }
    }
    sum
}

fn assert_close(name: &str, got: f32, want: f64, relative: f64, absolute: f64) {
    let error = (f64::from(got) - want).abs();
    assert!(
        error <= relative * want.abs() + absolute,
        "{name}: got {got:e}, want {want:e}, error {error:e}, relative {:e}",
        error / want.abs()
    );
}

#[test]
fn every_level_gives_the_f64_values_at_every_count() {
    for_each_level(|level| {
        let mut random = Random(7);
        let mut worst = 0.0f64;
        for case in 0..60 {
            let in_plane = case % 2 == 0;
            let domain = if case % 3 == 0 { Domain::Sphere } else { Domain::Hemisphere };
            let count = 1 + (case * 7) % 64;
            let squeezed = if case % 5 == 0 { 0 } else { count / 2 };
            let all = lobes(&mut random, count, in_plane);
            let squeeze = random.between(0.05, 1.5);
            let mut m = Mixture::<64>::new(domain, squeeze, &all[..squeezed], &all[squeezed..]).unwrap();
            if domain == Domain::Hemisphere && case % 4 < 2 {
                m = m.with_diffuse(Vec3::new(0.3, 0.2, 0.1)).unwrap();
            }
            assert_eq!(m.level(), level);
            for n in 0..=33 {
                // Guard zones round every output.
                const GUARD: f32 = -7.25e33;
                let d: Vec<Vec3> = (0..n).map(|_| random.direction()).collect();
                let soa = [0, 1, 2].map(|i| d.iter().map(|d| d[i]).collect::<Vec<_>>());
                let directions = [&soa[0][..], &soa[1][..], &soa[2][..]];
                let mut out = [(); 4].map(|()| vec![GUARD; n + 8]);
                let [r, g, b, p] = &mut out;
                m.evaluate_into(directions, [&mut r[4..n + 4], &mut g[4..n + 4], &mut b[4..n + 4]]).unwrap();
                m.pdf_into(directions, &mut p[4..n + 4]).unwrap();
                for slice in &out {
                    assert!(slice[..4].iter().chain(&slice[n + 4..]).all(|&v| v == GUARD), "guard zone");
                }
                for (i, &d) in d.iter().enumerate() {
                    let want = truth(&m, 0.0, d);
                    let single = m.evaluate(d).to_array();
                    for channel in 0..3 {
                        // |t| of the lobes that matter here is below 20; 3e-7 (2 + |t|) relative each.
                        let name = format!("{} case {case} n {n} direction {d}", level.name());
                        assert_close(&name, out[channel][4 + i], want[channel], 6e-6, 1e-9);
                        assert_close(&name, single[channel], want[channel], 6e-6, 1e-9);
                        if want[channel] > 1e-3 {
                            let e = (f64::from(single[channel]) / want[channel] - 1.0).abs();
                            worst = worst.max(e);
                        }
                    }
                    let pdf = (0.2126 * want[0] + 0.7152 * want[1] + 0.0722 * want[2]) / f64::from(m.power());
                    assert_close("pdf", out[3][4 + i], pdf, 8e-6, 1e-9);
                    assert_close("pdf one", m.pdf(d), pdf, 8e-6, 1e-9);
                }
            }
        }
        println!("level {}: worst relative error of a value above 1e-3: {worst:.2e}", level.name());
    });
}

fn material(random: &mut Random) -> Vec<u8> {
    let knots = 9;
    let views: Vec<(f32, f32, Vec<PlaneLobe>)> = (0..knots)
        .map(|v| {
            let theta = v as f32 / (knots - 1) as f32 * core::f32::consts::FRAC_PI_2;
            let lobes = (0..12)
                .map(|k| PlaneLobe {
                    angle: if v == 0 { 0.0 } else { theta * k as f32 / 11.0 },
                    log2_sharpness: k as f32 + 0.3 * random.next(),
                    log2_amplitude: [-3.0 - random.next(), -2.5, -4.0 + 0.5 * k as f32],
                })
                .collect();
            (theta, theta.cos().max(0.1).log2() * f32::from(v > 0), lobes)
        })
        .collect();
    let views: Vec<View> = views
        .iter()
        .map(|(theta, squeeze, lobes)| View {
            theta: *theta,
            log2_squeeze: *squeeze,
            log2_diffuse: [-4.0, -3.0, -2.0],
            lobes,
        })
        .collect();
    let mut bytes = vec![0; encoded_len(views.len(), 12, "test")];
    encode(&views, 7, "test", &mut bytes).unwrap();
    bytes
}

#[test]
fn every_level_prepares_and_samples_alike() {
    let bytes = material(&mut Random(3));
    let material = Material::from_bytes(&bytes).unwrap();
    for_each_level(|level| {
        let mut random = Random(11);
        for _ in 0..200 {
            let mut wo = random.direction();
            wo.z = wo.z.abs();
            let mut m = Mixture::<64>::empty();
            material.prepare(wo, &mut m).unwrap();
            let azimuth = f64::from(-wo.y).atan2(f64::from(-wo.x));
            let n = 19;
            let u = [(); 3].map(|()| (0..n).map(|_| random.next()).collect::<Vec<_>>());
            let mut out = [(); 7].map(|()| vec![0.0f32; n]);
            let [x, y, z, pdf, r, g, b] = &mut out;
            let samples = SamplesMut { direction: [x, y, z], pdf, weight: [r, g, b] };
            m.sample_into([&u[0], &u[1], &u[2]], samples).unwrap();
            for i in 0..n {
                let d = Vec3::new(out[0][i], out[1][i], out[2][i]);
                assert!((d.length() - 1.0).abs() < 3e-7 && d.z >= 0.0, "{d}");
                let want = truth(&m, azimuth, d);
                let pdf = (0.2126 * want[0] + 0.7152 * want[1] + 0.0722 * want[2]) / f64::from(m.power());
                assert_close(level.name(), out[3][i], pdf, 1e-4, 1e-9);
                let one = m.sample([u[0][i], u[1][i], u[2][i]]).unwrap();
                assert!(one.direction.distance(d) < 4e-6, "{} {} {d}", level.name(), one.direction);
                let weight = srbf_core::luminance(Vec3::new(out[4][i], out[5][i], out[6][i]));
                assert!((weight / m.power() - 1.0).abs() < 2e-6, "{weight} {}", m.power());
            }
        }
    });
}
