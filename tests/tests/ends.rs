//! Where numbers end: densities next to 0, the narrowest lobes under the strongest squeeze, and directions that are none.

use glam::{DVec3, Vec3};
use srbf_core::{
    AnyMixture, Domain, Draws, Expanded, FactorTable, Gaussian, Line, Lobe, Material, Mixture, PlaneLobe,
    Request, Towards, View, color_differences, luminance,
};
use srbf_tests::inputs::{Random, levels};
use srbf_tests::oracle::sphere_integral;
use srbf_tests::tolerance::{Worst, squeezed_unit};

fn lobe(axis: [f32; 3], sharpness: f32, amplitude: f32) -> Lobe {
    Lobe::new(Vec3::from(axis).normalize(), sharpness, Vec3::splat(amplitude)).unwrap()
}

/// Samples by a batch: direction, density and weight of each.
fn drawn(m: &Mixture<16>, u: &[[f32; 3]]) -> Vec<(Vec3, f32, Vec3)> {
    let u = [0, 1, 2].map(|c| u.iter().map(|u| u[c]).collect::<Vec<f32>>());
    let mut out = [(); 7].map(|()| vec![f32::NAN; u[0].len()]);
    let [x, y, z, pdf, red, green, blue] = &mut out;
    let draws = Draws {
        u: [&u[0], &u[1], &u[2]],
        direction: [x, y, z],
        pdf: Some(pdf),
        weight: Some([red, green, blue]),
    };
    m.ask(draws.into()).unwrap();
    let at = |i: usize, c: usize| Vec3::new(out[c][i], out[c + 1][i], out[c + 2][i]);
    (0..u[0].len()).map(|i| (at(i, 0), out[3][i], at(i, 4))).collect()
}

/// The densities of a batch.
fn densities(m: &Mixture<16>, directions: &[Vec3]) -> Vec<f32> {
    let d = [0, 1, 2].map(|c| directions.iter().map(|d| d[c]).collect::<Vec<f32>>());
    let mut pdf = vec![f32::NAN; directions.len()];
    m.ask(Towards { wi: [&d[0], &d[1], &d[2]], value: None, pdf: Some(&mut pdf) }.into()).unwrap();
    pdf
}

/// Numbers whose lobes and tails are as faint as they can be.
fn uniforms() -> Vec<[f32; 3]> {
    let last = 1.0 - f32::EPSILON / 2.0;
    let ends = [0.0, f32::from_bits(1), 1e-38, 1e-30, 1e-7, 0.3, 0.999, last];
    let pairs = ends.into_iter().flat_map(|a| ends.map(|b| [a, b]));
    pairs.flat_map(|[a, b]| [0.0, 0.4, last].map(|c| [a, b, c])).collect()
}

#[test]
fn what_reflects_draws_and_its_weights_are_numbers_one_by_one_and_in_batches() {
    // Lobes that are drawn only for u = 0, faint mixtures and bright ones.
    let beside = |faint: f32| vec![lobe([1.0, 0.0, 0.1], 100.0, faint), lobe([0.0, 0.0, 1.0], 1e4, 1.0)];
    let mut mixtures: Vec<(String, Mixture<16>)> = Vec::new();
    for faint in [1e-20, 1e-30, 1e-33, 1e-35, 1e-36, 1e-37, 1e-38, 1e-42] {
        mixtures.push((format!("beside {faint:e}"), Mixture::hemisphere(&beside(faint)).unwrap()));
        let squeezed = Mixture::new(Domain::Hemisphere, 0.01, &beside(faint), &[]).unwrap();
        mixtures.push((format!("squeezed {faint:e}"), squeezed));
    }
    for amplitude in [3e-38, 1e-37, 1e-36, 1e-34, 1e34, 1e38] {
        let m = Mixture::hemisphere(&[lobe([0.3, 0.0, 1.0], 30.0, amplitude)]).unwrap();
        mixtures.push((format!("alone {amplitude:e}"), m));
    }
    let u = uniforms();
    let mut faintest = 0;
    for (name, m) in mixtures.iter().filter(|(_, m)| m.power() > 0.0) {
        for level in levels() {
            let m = m.clone().with_level(level).unwrap();
            for (u, (direction, pdf, weight)) in u.iter().zip(drawn(&m, &u)) {
                let place = || format!("{level:?}, {name}, {u:?}: {direction} {pdf:e} {weight}");
                let one = m.sample(*u).unwrap_or_else(|| panic!("nothing drawn: {}", place()));
                assert!((one.direction - direction).length() < 2e-6, "{} {}", place(), one.direction);
                for (pdf, weight) in [(pdf, weight), (one.pdf, one.weight)] {
                    assert!(pdf.is_finite() && pdf >= f32::MIN_POSITIVE && weight.is_finite(), "{}", place());
                }
                // Where both are divided by, and far enough from the end to have digits.
                if pdf.min(one.pdf) > 1e-30 && pdf * m.power() > 1e-35 {
                    let apart = (weight - one.weight).abs().max_element();
                    assert!(apart <= 1e-5 * weight.abs().max_element(), "{} {}", place(), one.weight);
                }
                faintest += usize::from(pdf == f32::MIN_POSITIVE);
                assert_eq!(m.sample_direction(*u).unwrap(), one.direction, "{}", place());
            }
        }
    }
    assert!(faintest > 10, "{faintest} densities are the least");
    // What reflects nothing draws nothing, one by one, and the normal in batches.
    let black = Mixture::<16>::hemisphere(&[lobe([1.0, 0.0, 1.0], 1e8, 1e-38)]).unwrap();
    assert_eq!((black.sample([0.5; 3]), black.sample_direction([0.5; 3])), (None, None));
    assert!(drawn(&black, &u).iter().all(|drawn| *drawn == (Vec3::Z, 0.0, Vec3::ZERO)));
}

/// Density of the one squeezed lobe of a mixture by its equation, and the exponent in it. The fold adds nothing here.
fn density(m: &Mixture<16>, d: Vec3) -> (f64, f64) {
    let Gaussian { axis, sharpness } = m.lobe(0).unwrap().gaussian;
    // As it is kept.
    let inverse = f64::from(1.0 / m.squeeze());
    let wide = DVec3::new(1.0, inverse, 1.0) * d.as_dvec3();
    let (r, s) = (wide.length(), f64::from(sharpness));
    let t = 0.5 * s * (wide / r - axis.as_dvec3()).length_squared();
    ((-t).exp() * inverse / (r * r * r) / sphere_integral(s), t)
}

/// The density where a lobe draws, by the texts for one direction and for many: of the equation, and of each other.
#[test]
fn the_narrowest_lobes_have_one_density_under_the_strongest_squeeze() {
    let [mut error, mut apart] = [(); 2].map(|()| Worst::new("squeezed pdf"));
    let mut random = Random(83);
    let u: Vec<[f32; 3]> = (0..500).map(|_| random.three()).collect();
    for squeeze in [0.01, 0.1, 1.0, 2.0] {
        for axis in [[0.6, 0.0, 0.8], [0.9, 0.0, 0.4], [0.3, 0.5, 0.8], [0.0, 0.9, 0.4], [0.0, 0.0, 1.0]] {
            for sharpness in [1e6f32, 1e7, 1e8] {
                let lobes = [lobe(axis, sharpness, 1.0)];
                let m: Mixture<16> = Mixture::new(Domain::Hemisphere, squeeze, &lobes, &[]).unwrap();
                let axis_squared = m.lobe(0).unwrap().gaussian.axis.as_dvec3().length_squared();
                let directions: Vec<Vec3> = u.iter().map(|u| m.sample_direction(*u).unwrap()).collect();
                for level in levels() {
                    let m = m.clone().with_level(level).unwrap();
                    for (d, batch) in directions.iter().zip(densities(&m, &directions)) {
                        let (density, t) = density(&m, *d);
                        let (one, unit) = (m.pdf(*d), squeezed_unit(sharpness.into(), axis_squared, t));
                        let place = |got| {
                            format!("{level:?}, {squeeze}, {axis:?}, {sharpness:e}, {d}: {got} for {density}")
                        };
                        for got in [one, batch] {
                            error.see((f64::from(got) / density - 1.0).abs() / unit, || place(got));
                        }
                        // Half of it is either's.
                        apart.see(0.5 * (f64::from(batch) / f64::from(one) - 1.0).abs() / unit, || {
                            place(batch)
                        });
                    }
                }
            }
        }
    }
    println!("{error:?}\n{apart:?}");
    let failures: Vec<String> = [error.failure(), apart.excess()].into_iter().flatten().collect();
    assert!(failures.is_empty(), "{failures:#?}");
}

/// A material of two views with a diffuse term, with factors or without.
fn material(factors: Option<FactorTable>) -> Vec<u8> {
    let (log2_luminance, color_differences) = color_differences([0.0, -1.0, -2.0]);
    let lobe =
        |angle| PlaneLobe { angle, off_plane: 0.0, log2_sharpness: 5.0, log2_luminance, color_differences };
    let lobes = [[lobe(0.0), lobe(0.0)], [lobe(0.7), lobe(0.2)]];
    let view = |theta: f32, lobes| View {
        theta,
        log2_squeeze: 0.0,
        log2_diffuse: -3.0,
        diffuse_color_differences: [0.0; 2],
        lobes,
    };
    let views = [view(0.0, &lobes[0][..]), view(0.8, &lobes[1])];
    let line = Line { views: &views, squeezed: 1, mirrored: 0, factors };
    let mut bytes = vec![0; line.encoded_len("")];
    line.encode("", &mut bytes).unwrap();
    bytes
}

/// The outputs of a call for n pairs.
type Columns<const C: usize> = [Vec<f32>; C];

/// Calls, and finds 0 wherever it has written; it has to write everywhere.
fn writes_zeros<const C: usize>(place: &str, pairs: &[[[f32; 3]; 2]], fill: impl FnOnce(&mut Columns<C>)) {
    let mut out = [const { Vec::new() }; C];
    out.iter_mut().for_each(|column| column.resize(pairs.len(), f32::NAN));
    fill(&mut out);
    for (i, pair) in pairs.iter().enumerate() {
        let got = out.each_ref().map(|column| column[i]);
        assert_eq!(got, [0.0; C], "{place}, {} pairs: {pair:?}", pairs.len());
    }
}

/// What some hits are asked.
type Ask<'a> = &'a dyn Fn(Request);

/// The normal with density and weight 0, as seven numbers of which the height has been taken from 1.
fn is_no_sample<'a>(
    u: [&'a [f32]; 3],
    [x, y, z, pdf, red, green, blue]: &'a mut Columns<7>,
    ask: impl FnOnce(Draws),
) {
    let draws = Draws {
        u,
        direction: [&mut *x, &mut *y, &mut *z],
        pdf: Some(&mut *pdf),
        weight: Some([&mut *red, &mut *green, &mut *blue]),
    };
    ask(draws);
    z.iter_mut().for_each(|z| *z -= 1.0);
}

#[test]
fn an_outgoing_direction_that_is_none_gives_0_whatever_the_incident_one_is() {
    let (inf, nan) = (f32::INFINITY, f32::NAN);
    let none =
        [[0.0; 3], [nan, 0.0, 1.0], [0.0, 0.0, inf], [0.0, 0.0, 0.5], [3.0, 0.0, 4.0], [0.6, 0.0, -0.8]];
    let incident = [
        [0.0, 0.0, 1.0],
        [0.6, 0.0, 0.8],
        [0.0; 3],
        [nan; 3],
        [inf; 3],
        [0.0, 0.0, inf],
        [inf, 0.0, 1.0],
        [0.0, nan, 1.0],
        [f32::MAX; 3],
        [0.0, 0.0, -1.0],
        [1e20, 0.0, 1e30],
    ];
    let all: Vec<[[f32; 3]; 2]> = none.iter().flat_map(|&wo| incident.map(|wi| [wo, wi])).collect();
    let factors: Vec<[f32; 3]> = (0..12).map(|n| [0.3 * n as f32, 1.0, 2.0]).collect();
    let albedo_differences = [[0.1; 3]; 2];
    let table = FactorTable {
        half: 4,
        difference: 3,
        azimuth: 1,
        is_signed: false,
        factors: &factors,
        albedo_differences: &albedo_differences,
    };
    for factors in [None, Some(table)] {
        let bytes = material(factors);
        let material = Material::from_bytes(&bytes[..]).unwrap();
        let mut memory = vec![0.0; material.expanded_len(64)];
        let expanded = Expanded::new(&material, 64, &mut memory).unwrap();
        for level in levels() {
            level.set().unwrap();
            // A few, which are taken one by one, and many, in blocks.
            for n in [1, 3, all.len()] {
                let pairs = &all[..n];
                let column = |d: usize, c: usize| pairs.iter().map(|pair| pair[d][c]).collect::<Vec<f32>>();
                let [wo, wi] = [0, 1].map(|d| [0, 1, 2].map(|c| column(d, c)));
                let [wo, wi] = [&wo, &wi].map(|d| d.each_ref().map(Vec::as_slice));
                let u = [&[0.4; 99][..n]; 3];
                let mut mixtures = vec![Mixture::<16>::empty(); n];
                material.prepare_into(wo, &mut mixtures).unwrap();
                let asks: [(&str, Ask); 3] = [
                    ("material", &|request| material.ask(wo, request).unwrap()),
                    ("mixtures", &|request| AnyMixture::ask_each(&mixtures, request).unwrap()),
                    ("expanded", &|request| expanded.ask(wo, request).unwrap()),
                ];
                for (name, ask) in asks {
                    let place = |what| format!("{name} {what}, {level:?}, factors {}", factors.is_some());
                    writes_zeros(&place("value"), pairs, |[red, green, blue]| {
                        ask(Towards { wi, value: Some([red, green, blue]), pdf: None }.into());
                    });
                    writes_zeros(&place("both"), pairs, |[red, green, blue, pdf]| {
                        ask(Towards { wi, value: Some([red, green, blue]), pdf: Some(pdf) }.into());
                    });
                    writes_zeros(&place("density"), pairs, |[pdf]| {
                        ask(Towards { wi, value: None, pdf: Some(pdf) }.into());
                    });
                    writes_zeros(&place("sample"), pairs, |out| {
                        is_no_sample(u, out, |draws| ask(draws.into()));
                    });
                    writes_zeros(&place("towards another"), pairs, |[red, green, blue, pdf]| {
                        writes_zeros(&place("sample with it"), pairs, |out| {
                            is_no_sample(u, out, |draws| {
                                let value = Some([&mut red[..], green, blue]);
                                let towards = Towards { wi, value, pdf: Some(pdf) };
                                ask(Request { draw: Some(draws), evaluate: Some(towards) });
                            });
                        });
                    });
                }
            }
        }
    }
}

/// Where f32 rounds the channels of a value to subnormals, of which some are negative, their luminance may be below 0. No density is.
#[test]
fn no_density_is_below_0_where_values_are_subnormal() {
    // With Y an eighth of the least subnormal number red is 2 of these, green -1: the share of red in the luminance is rounded to 0.
    let lobes = [[16.0, 16.0], [16.0, 12.0], [15.0, 16.0]].map(|color_differences| {
        [0.0, 0.9].map(|angle| PlaneLobe {
            angle,
            off_plane: 0.0,
            log2_sharpness: 7.0,
            log2_luminance: -54.0,
            color_differences,
        })
    });
    let views = [0.0, 1.4].map(|theta| (theta, lobes.map(|of_views| of_views[usize::from(theta > 0.0)])));
    let views = views.each_ref().map(|(theta, lobes)| View {
        theta: *theta,
        log2_squeeze: 0.0,
        log2_diffuse: -126.0,
        diffuse_color_differences: [0.0; 2],
        lobes,
    });
    let mut bytes = [0; 512];
    let line = Line { views: &views, squeezed: 1, mirrored: 0, factors: None };
    let length = line.encode("faint", &mut bytes).unwrap();
    let material = Material::from_bytes(&bytes[..length]).unwrap();
    let mut memory = vec![0.0; material.expanded_len(16)];
    let expanded = Expanded::new(&material, 16, &mut memory).unwrap();
    let mut random = Random(44);
    let n = 20_000;
    let mut upper = || -> [Vec<f32>; 3] {
        let all: Vec<Vec3> = (0..n).map(|_| random.direction()).map(|d| d.with_z(d.z.abs())).collect();
        [0, 1, 2].map(|c| all.iter().map(|d| d[c]).collect())
    };
    let (wo, wi) = (upper(), upper());
    let [wo, wi] = [&wo, &wi].map(|d| d.each_ref().map(Vec::as_slice));
    for level in levels() {
        level.set().unwrap();
        let mut mixtures = vec![Mixture::<16>::empty(); n];
        material.prepare_into(wo, &mut mixtures).unwrap();
        let three = |[x, y, z]: [&[f32]; 3], i: usize| Vec3::new(x[i], y[i], z[i]);
        // One after the other: `Towards` of one hit.
        let each = |of: &dyn Fn(usize, Vec3) -> (Vec3, f32), request: Request| {
            let Some(Towards { value: Some([red, green, blue]), pdf: Some(pdf), .. }) = request.evaluate
            else {
                return;
            };
            for i in 0..n {
                let (value, density) = of(i, three(wi, i));
                (red[i], green[i], blue[i], pdf[i]) = (value.x, value.y, value.z, density);
            }
        };
        let asks: [(&str, Ask); 6] = [
            ("mixtures one by one", &|request| each(&|i, wi| mixtures[i].evaluate_and_pdf(wi), request)),
            ("hits one by one", &|request| {
                each(&|i, wi| material.evaluate_and_pdf(three(wo, i), wi), request);
            }),
            ("one mixture", &|request| mixtures[0].ask(request).unwrap()),
            ("mixtures", &|request| AnyMixture::ask_each(&mixtures, request).unwrap()),
            ("material", &|request| material.ask(wo, request).unwrap()),
            ("expanded", &|request| expanded.ask(wo, request).unwrap()),
        ];
        for (name, ask) in asks {
            let mut out = [(); 5].map(|()| vec![0.0; n]);
            let [red, green, blue, pdf, alone] = out.each_mut().map(Vec::as_mut_slice);
            ask(Towards { wi, value: Some([red, green, blue]), pdf: Some(pdf) }.into());
            ask(Towards { wi, value: None, pdf: Some(alone) }.into());
            let [red, green, blue, pdf, alone] = &out;
            let below = (0..n).filter(|&i| luminance(three([red, green, blue], i)) < 0.0).count();
            println!("{name}, {level:?}: {below} luminances below 0");
            assert!(below > 0, "{name}, {level:?}: no luminance is below 0");
            let least = pdf.iter().chain(alone).copied().fold(f32::INFINITY, f32::min);
            assert!(least >= 0.0, "{name}, {level:?}: density {least:e}");
        }
    }
}
