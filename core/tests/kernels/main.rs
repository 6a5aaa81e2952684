//! The kernels of every level against plain texts in f64, by the public interface: what `cargo test -p srbf-core` finds alone.
//!
//! `srbf_levels` has values, densities, draws and factors of mixtures and materials that it makes. The rest is here: presets, lobes
//! between views, codes, the angles of draws, blocks of hits, expanded materials, light.

mod light;

use srbf_core::{
    AnyMixture, Draws, Expanded, FactorTable, Grid, GridView, Level, Line, Lobe, Material, Mixture,
    PackOptions, PlaneLobe, Request, TiltedLobe, Towards, Vec3, View, luminance,
};
use srbf_levels::inputs::Random;
use srbf_levels::outputs::{Guarded, slices, structure_of_arrays};
use srbf_levels::truth::truth;
use std::f64::consts::TAU;
use std::sync::Mutex;

/// One test at a time, as the level is that of the process.
fn at_each_level(mut run: impl FnMut(Level)) {
    static ONE: Mutex<()> = Mutex::new(());
    let _guard = ONE.lock();
    let levels: Vec<Level> = Level::ALL.into_iter().filter(|level| level.set().is_ok()).collect();
    println!("{levels:?}");
    for level in levels {
        level.set().unwrap();
        run(level);
    }
}

/// Whether two numbers are the same but for `roundings` of `size`.
fn is_near(got: f32, want: f64, size: f64, roundings: f64) -> bool {
    (f64::from(got) - want).abs() <= roundings * f64::from(f32::EPSILON) * size
}

fn upper(random: &mut Random) -> Vec3 {
    let d = random.direction();
    Vec3::new(d.x, d.y, d.z.abs())
}

fn three(random: &mut Random) -> Vec3 {
    Vec3::new(random.uniform(), random.uniform(), random.uniform())
}

/// A material of a number of stored lobes, of which the first are squeezed and the last stand for two; with factors or without.
fn made([lobes, squeezed, mirrored]: [usize; 3], has_factors: bool) -> Vec<u8> {
    let mut random = Random(lobes as u64);
    let thetas = [0.0f32, 0.4, 0.9, 1.4];
    let all = thetas.map(|theta| {
        let mut lobe = |k: usize| PlaneLobe {
            angle: if theta > 0.0 { theta + 0.4 * random.uniform() - 0.2 } else { 0.0 },
            off_plane: if theta > 0.0 && k >= lobes - mirrored { 0.1 + 0.5 * random.uniform() } else { 0.0 },
            log2_sharpness: 1.0 + 8.0 * random.uniform(),
            log2_luminance: -3.0 + 4.0 * random.uniform(),
            color_differences: [random.uniform() - 0.3, 2.0 * random.uniform() - 0.5],
        };
        (0..lobes).map(&mut lobe).collect::<Vec<_>>()
    });
    let view = |v: usize| View {
        theta: thetas[v],
        log2_squeeze: -thetas[v],
        log2_diffuse: thetas[v] - 4.0,
        diffuse_color_differences: [0.3, -0.2 - thetas[v]],
        lobes: &all[v],
    };
    let views = [view(0), view(1), view(2), view(3)];
    let factors: Vec<[f32; 3]> = (0..6 * 5).map(|_| three(&mut random).to_array().map(|f| 0.4 + f)).collect();
    let albedo_differences = [0.0, 0.1, 0.2, -0.1].map(|d| [d, 0.3 - d, -d]);
    let table = FactorTable {
        half: 6,
        difference: 5,
        azimuth: 1,
        is_signed: false,
        factors: &factors,
        albedo_differences: &albedo_differences,
    };
    let line = Line { views: &views, squeezed, mirrored, factors: has_factors.then_some(table) };
    let mut bytes = vec![0; line.encoded_len("made")];
    line.encode("made", &mut bytes).unwrap();
    bytes
}

/// Presets; made-up materials, with pairs, factors, and more lobes than a vector holds; and all in codes.
fn materials() -> Vec<(String, Material<Vec<u8>>)> {
    let preset = |name: &str| {
        let path = format!("{}/../presets/{name}.srbf", env!("CARGO_MANIFEST_DIR"));
        (name.to_owned(), std::fs::read(path).unwrap())
    };
    let mut all = ["cayman", "garnet_red", "krylon_blue"].map(preset).to_vec();
    all.push(("pairs".to_owned(), made([9, 3, 4], false)));
    all.push(("factors".to_owned(), made([8, 3, 2], true)));
    all.push(("64 lobes".to_owned(), made([52, 20, 12], false)));
    for (i, (name, bytes)) in all.clone().into_iter().enumerate() {
        let options = PackOptions { bits: [8, 16][i % 2], channels: 3 };
        let material = Material::from_bytes(bytes).unwrap();
        let mut packed = vec![0; material.packed_len(options, "")];
        material.pack(options, "", &mut packed).unwrap();
        all.push((format!("{name} in codes"), packed));
    }
    all.into_iter().map(|(name, bytes)| (name, Material::from_bytes(bytes).unwrap())).collect()
}

#[test]
fn every_level_gives_the_f64_values_of_made_up_mixtures() {
    at_each_level(|level| {
        let found = srbf_levels::check(level).unwrap();
        assert_eq!(found.failures(), Vec::<String>::new(), "{level:?}");
        assert!(found.worst.iter().map(|worst| worst.count).sum::<usize>() > 10_000);
    });
}

/// Linear sRGB of a luminance and two relative colour differences.
fn color(luminance: f64, [rho, beta]: [f64; 2]) -> [f64; 3] {
    let green = 1.0 - (0.2126 * rho + 0.0722 * beta) / 0.7152;
    [1.0 + rho, green, 1.0 + beta].map(|channel| channel * luminance)
}

/// Two views, and how far between them.
#[derive(Clone, Copy)]
struct Between {
    views: [usize; 2],
    share: f64,
}

impl Between {
    fn new(material: &Material<Vec<u8>>, wo: Vec3) -> Self {
        let theta = f64::from(wo.x).hypot(f64::from(wo.y)).atan2(f64::from(wo.z));
        let angle = |view: usize| f64::from(material.view_theta(view).unwrap());
        let last = material.view_count() - 1;
        let before = (0..last).rev().find(|&view| angle(view) <= theta).unwrap_or(0);
        let after = (before + 1).min(last);
        let share = ((theta - angle(before)) / (angle(after) - angle(before))).clamp(0.0, 1.0);
        Self { views: [before, after], share: if after > before { share } else { 0.0 } }
    }
    fn of(self, number: impl Fn(usize) -> f32) -> f64 {
        let [a, b] = self.views.map(|view| f64::from(number(view)));
        a + (b - a) * self.share
    }
    /// How far the number goes from one view to the other: an error of the share counts by this.
    fn step(self, number: impl Fn(usize) -> f32) -> f64 {
        let [a, b] = self.views.map(|view| f64::from(number(view)));
        (b - a).abs()
    }
}

#[test]
fn mixtures_are_those_between_the_views() {
    let materials = materials();
    at_each_level(|level| {
        let mut random = Random(3);
        for (name, material) in &materials {
            for n in 0..60 {
                let wo = if n == 0 { Vec3::Z } else { upper(&mut random) };
                let mut m = Mixture::<64>::empty();
                material.prepare(wo, &mut m).unwrap();
                is_between_views(material, &m, wo, &format!("{name}, {level:?}, {wo}"));
            }
        }
    });
}

fn is_between_views(material: &Material<Vec<u8>>, m: &Mixture<64>, wo: Vec3, place: &str) {
    let between = Between::new(material, wo);
    let squeeze = between.of(|v| material.view_log2_squeeze(v).unwrap()).exp2();
    assert!(is_near(m.squeeze(), squeeze, squeeze, 200.0), "{place}: squeeze {} {squeeze}", m.squeeze());
    let log2 = between.of(|v| material.view_log2_diffuse(v).unwrap());
    let diffuse = if log2 <= -125.0 { 0.0 } else { log2.exp2() };
    let differences = [0, 1].map(|i| between.of(|v| material.view_diffuse_color_differences(v).unwrap()[i]));
    let mut albedo = color(diffuse, differences);
    for c in 0..3 {
        assert!(is_near(m.diffuse()[c], albedo[c], 20.0 * diffuse, 200.0), "{place}: diffuse {albedo:?}");
    }
    let (stored, mirrored) = (material.view_lobe_count(), material.mirrored_count());
    assert_eq!(m.len(), stored + mirrored, "{place}");
    for k in 0..m.len() {
        let of_stored = if k < stored { k } else { k - mirrored };
        let number =
            |number: fn(PlaneLobe) -> f32| between.of(|v| number(material.view_lobe(v, of_stored).unwrap()));
        let [angle, off_plane] = [number(|lobe| lobe.angle), number(|lobe| lobe.off_plane)];
        let off_plane = if k < stored { off_plane } else { -off_plane };
        let axis = [angle.sin() * off_plane.cos(), off_plane.sin(), (angle.cos() * off_plane.cos()).abs()];
        let sharpness = number(|lobe| lobe.log2_sharpness).exp2();
        let luminance = number(|lobe| lobe.log2_luminance).exp2();
        let rgb = color(luminance, [number(|l| l.color_differences[0]), number(|l| l.color_differences[1])]);
        let lobe = m.lobe(k).unwrap();
        let (got, of) = (lobe.gaussian.axis, format!("{place}, lobe {k}: {lobe:?}"));
        // A share has up to 40 roundings of its own, since an angle near grazing has few digits of the step between two views.
        let step = between.step(|v| material.view_lobe(v, of_stored).unwrap().angle);
        assert!((0..3).all(|c| is_near(got[c], axis[c], 1.0 + step, 40.0)), "{of}, axis {axis:?}");
        assert!(is_near(lobe.gaussian.sharpness, sharpness, sharpness, 200.0), "{of}, sharpness {sharpness}");
        for c in 0..3 {
            assert!(is_near(lobe.amplitude[c], rgb[c], 20.0 * luminance, 200.0), "{of}, amplitude {rgb:?}");
            albedo[c] += rgb[c] * -TAU * (-2.0 * sharpness).exp_m1() / sharpness;
        }
    }
    let power = 0.2126 * albedo[0] + 0.7152 * albedo[1] + 0.0722 * albedo[2];
    assert!(is_near(m.power(), power, power, 200.0), "{place}: power {} {power}", m.power());
    for c in 0..3 {
        let factors = between.of(|v| material.view_albedo_difference(v).map_or(0.0, |d| d[c]));
        let (got, want) = (m.albedo()[c], albedo[c] + factors * power);
        assert!(is_near(got, want, 10.0 * power, 200.0), "{place}: albedo {got} {want}");
    }
}

/// Values, densities and draws of hits in every shape are those of the mixtures one by one; these are the values of the lobes, times
/// factors.
#[test]
fn hits_in_blocks_are_hits_one_by_one() {
    let materials = materials();
    let n = 37;
    at_each_level(|level| {
        let mut random = Random(5);
        for (i, (name, material)) in materials.iter().enumerate() {
            let wo: Vec<Vec3> = (0..n).map(|_| upper(&mut random)).collect();
            let of_each: Vec<&Material<Vec<u8>>> =
                (0..n).map(|h| &materials[(i + h) % materials.len()].1).collect();
            let (mut same, mut mixed) = (vec![Mixture::<64>::empty(); n], vec![Mixture::<64>::empty(); n]);
            for h in 0..n {
                material.prepare(wo[h], &mut same[h]).unwrap();
                of_each[h].prepare(wo[h], &mut mixed[h]).unwrap();
            }
            let mut memory = vec![0.0; material.expanded_len(64)];
            let expanded = Expanded::new(material, 64, &mut memory).unwrap();
            let mut between_rows = vec![Mixture::<64>::empty(); n];
            let arrays = structure_of_arrays(&wo);
            for (m, &wo) in between_rows.iter_mut().zip(&wo) {
                expanded.prepare(wo, m).unwrap();
            }
            for count in [1, 3, 4, 8, 9, 17, n] {
                let wo = slices(&arrays, count);
                let place = format!("{name}, {level:?}, {count} hits");
                let mut check = |of: &[Mixture<64>], what: &str, ask: &dyn Fn(Request)| {
                    are_single(of, &mut random, &format!("{place}, {what}"), ask);
                };
                check(&same[..count], "material", &|request| material.ask(wo, request).unwrap());
                check(&mixed[..count], "materials", &|request| {
                    Material::ask_each(&of_each[..count], wo, request).unwrap();
                });
                check(&same[..count], "mixtures", &|request| {
                    AnyMixture::ask_each(&same[..count], request).unwrap()
                });
                check(&between_rows[..count], "expanded", &|request| expanded.ask(wo, request).unwrap());
                check(&vec![same[0].clone(); count], "mixture", &|request| same[0].ask(request).unwrap());
            }
            // At a view the rows of an expanded material are exact.
            let theta = material.view_theta(material.view_count() / 2).unwrap();
            let wo = Vec3::new(-0.6 * theta.sin(), 0.8 * theta.sin(), theta.cos());
            let [mut exact, mut row] = [Mixture::<64>::empty(), Mixture::<64>::empty()];
            material.prepare(wo, &mut exact).unwrap();
            expanded.prepare(wo, &mut row).unwrap();
            let wi = exact.sample_direction([0.4, 0.5, 0.2]).unwrap();
            let (got, want) = (row.evaluate(wi), exact.evaluate(wi));
            assert!(got.distance(want) < 1e-3 * want.length(), "{name}, {level:?}: {got} {want}");
        }
    });
}

/// Everything asked at once is what each mixture gives alone.
fn are_single(of: &[Mixture<64>], random: &mut Random, place: &str, ask: &dyn Fn(Request)) {
    let n = of.len();
    let [wi, u] = [upper, three]
        .map(|draw: fn(&mut Random) -> Vec3| (0..n).map(|_| draw(random)).collect::<Vec<Vec3>>());
    let (wi_arrays, u_arrays) = (structure_of_arrays(&wi), structure_of_arrays(&u));
    let (mut towards, mut drawn, mut alone) =
        (Guarded::<4>::new(n), Guarded::<7>::new(n), Guarded::<1>::new(n));
    let ([r, g, b, pdf], [alone_pdf]) = (towards.slices(), alone.slices());
    let evaluate = Towards { wi: slices(&wi_arrays, n), value: Some([r, g, b]), pdf: Some(pdf) };
    let [x, y, z, pdf, r, g, b] = drawn.slices();
    let draw =
        Draws { u: slices(&u_arrays, n), direction: [x, y, z], pdf: Some(pdf), weight: Some([r, g, b]) };
    ask(Request { draw: Some(draw), evaluate: Some(evaluate) });
    ask(Towards { wi: slices(&wi_arrays, n), value: None, pdf: Some(alone_pdf) }.into());
    assert!(
        towards.is_intact() && drawn.is_intact() && alone.is_intact(),
        "{place}: a guard zone was written"
    );
    let near = |a: f32, b: f32, size: f32| (a - b).abs() <= 3e-5 * size;
    for (i, m) in of.iter().enumerate() {
        let place = format!("{place}, {i}, wi {}, u {}", wi[i], u[i]);
        let (want, density) = m.evaluate_and_pdf(wi[i]);
        let size = want.abs().max_element();
        assert!((0..3).all(|c| near(towards.at(c, i), want[c], size)), "{place}: value {want}");
        for got in [towards.at(3, i), alone.at(0, i), m.pdf(wi[i])] {
            assert!(near(got, density, density), "{place}: density {got} {density}");
        }
        let one = m.sample(u[i].to_array()).unwrap();
        let direction = Vec3::new(drawn.at(0, i), drawn.at(1, i), drawn.at(2, i));
        assert!(one.direction.distance(direction) < 1e-5, "{place}: drawn {direction}, {}", one.direction);
        // At its own direction: a sharp lobe changes by much in the distance of the two.
        let (value, density) = m.evaluate_and_pdf(direction);
        assert!(near(drawn.at(3, i), density, 20.0 * density), "{place}: density {density} of a draw");
        let weight = Vec3::new(drawn.at(4, i), drawn.at(5, i), drawn.at(6, i));
        assert!((weight * density).distance(value) < 1e-3 * value.length(), "{place}: weight {weight}");
        if !m.has_factors() {
            let wanted = truth(m, wi[i]);
            for c in 0..3 {
                // A fold of up to 1e-7 of an amplitude is left out.
                let folds =
                    (0..m.len()).map(|k| f64::from(m.lobe(k).unwrap().amplitude[c].abs())).sum::<f64>();
                let got = want[c];
                assert!(
                    is_near(got, wanted.value[c], wanted.scale[c] + folds, 4.0),
                    "{place}: {got}, {:?}",
                    wanted.value
                );
            }
            assert!(near(luminance(weight), m.power(), 10.0 * m.power()), "{place}: weight {weight}");
        }
    }
}

/// A direction in the frame of the view, as a lobe sees it.
fn seen(m: &Mixture<64>, d: Vec3, is_squeezed: bool) -> [f64; 3] {
    let [c, s] = m.azimuth_cos_sin().map(f64::from);
    let [x, y, z] = d.to_array().map(f64::from);
    let (x, y) = (c * x + s * y, c * y - s * x);
    let [along, across] =
        if is_squeezed { [m.squeeze_along(), m.squeeze()].map(f64::from) } else { [1.0; 2] };
    let (x, y) = (x / along, y / across);
    let r = (x * x + y * y + z * z).sqrt();
    [x / r, y / r, z / r]
}

/// Draws lie at the angle from the axis of the chosen lobe that the second number stands for, and evenly round it.
#[test]
fn draws_lie_round_the_axis_of_the_chosen_lobe() {
    let materials = materials();
    at_each_level(|level| {
        let mut random = Random(8);
        let mut count = 0;
        for (name, material) in &materials {
            for _ in 0..40 {
                let (wo, [u, v, _]) = (upper(&mut random), three(&mut random).to_array());
                let mut m = Mixture::<64>::empty();
                material.prepare(wo, &mut m).unwrap();
                let place = format!("{name}, {level:?}, {wo}, {u}, {v}");
                count += usize::from(draws_round_the_axis(&m, [u, v], &place));
            }
        }
        assert!(count > 300, "{count}");
    });
}

fn draws_round_the_axis(m: &Mixture<64>, [u, v]: [f32; 2], place: &str) -> bool {
    const TURNS: usize = 16;
    let numbers: Vec<Vec3> = (0..TURNS).map(|i| Vec3::new(u, v, (i as f32 + 0.5) / TURNS as f32)).collect();
    let arrays = structure_of_arrays(&numbers);
    let mut drawn = Guarded::<3>::new(TURNS);
    let draws = Draws { u: slices(&arrays, TURNS), direction: drawn.slices(), pdf: None, weight: None };
    m.ask(draws.into()).unwrap();
    let lobe = |k: usize| m.lobe(k).unwrap();
    let power = |k: usize| {
        let (lobe, s) = (lobe(k), f64::from(lobe(k).gaussian.sharpness));
        f64::from(luminance(lobe.amplitude)) * -TAU * (-2.0 * s).exp_m1() / s
    };
    let target = f64::from(u) * f64::from(m.power());
    let (mut sum, mut chosen) = (0.0, None);
    for k in 0..m.len() {
        sum += power(k);
        // Rounding may choose the next one.
        if (sum - target).abs() < 1e-5 * f64::from(m.power()) {
            return false;
        }
        if target < sum && chosen.is_none() {
            chosen = Some(k);
        }
    }
    let v = f64::from(v);
    let is_squeezed = chosen.is_some_and(|k| k < m.squeezed_len());
    let (axis, fall) = match chosen.map(lobe) {
        Some(Lobe { gaussian, .. }) => {
            let s = f64::from(gaussian.sharpness);
            (gaussian.axis.to_array().map(f64::from), -(v * (-2.0 * s).exp_m1()).ln_1p() / s)
        }
        None => ([0.0, 0.0, 1.0], 1.0 - (1.0 - v).sqrt()),
    };
    let mut mean = [0.0; 2];
    let roundings = 1e-6 / f64::from(m.squeeze()).min(1.0);
    for i in 0..TURNS {
        let d = Vec3::new(drawn.at(0, i), drawn.at(1, i), drawn.at(2, i));
        assert!((d.length() - 1.0).abs() < 1e-6 && d.z >= 0.0, "{place}: {d}");
        let [x, y, z] = seen(m, d, is_squeezed);
        let chord = |z: f64| {
            let [dx, dy, dz] = [x - axis[0], y - axis[1], z - axis[2]];
            (dx * dx + dy * dy + dz * dz).sqrt()
        };
        let wanted = (2.0 * fall).sqrt();
        // What falls below the horizon is mirrored up.
        let off = (chord(z) - wanted).abs().min((chord(-z) - wanted).abs());
        assert!(off < 4.0 * roundings, "{place}: {d} is {off:e} off {wanted:e} from the axis of {chosen:?}");
        mean = [mean[0] + x / TURNS as f64, mean[1] + y / TURNS as f64];
    }
    let off = [0, 1].map(|c| (mean[c] - (1.0 - fall) * axis[c]).abs());
    assert!(
        off[0].max(off[1]) < 4.0 * roundings,
        "{place}: {mean:?} is not evenly round the axis of {chosen:?}"
    );
    true
}

/// An anisotropic material with the same views all round is the isotropic one.
#[test]
fn an_anisotropic_material_of_equal_azimuths_is_isotropic() {
    let bytes = made([9, 3, 0], false);
    let line = Material::from_bytes(&bytes[..]).unwrap();
    let line_of = &line;
    let tilted = |view: usize| {
        (0..9).map(move |k| {
            let lobe = line_of.view_lobe(view, k).unwrap();
            TiltedLobe {
                tilt: [lobe.angle, 0.0],
                log2_sharpness: lobe.log2_sharpness,
                log2_luminance: lobe.log2_luminance,
                color_differences: lobe.color_differences,
            }
        })
    };
    let lobes: Vec<Vec<TiltedLobe>> = (0..4).map(|view| tilted(view).collect()).collect();
    let view = |view: usize| GridView {
        log2_squeeze: [0.0, 0.0, -line.view_log2_squeeze(view).unwrap()],
        log2_diffuse: line.view_log2_diffuse(view).unwrap(),
        diffuse_color_differences: line.view_diffuse_color_differences(view).unwrap(),
        lobes: &lobes[view],
    };
    let views: Vec<GridView> =
        std::iter::once(view(0)).chain((1..4).flat_map(|ring| (0..5).map(move |_| ring)).map(view)).collect();
    let thetas: Vec<f32> = (0..4).map(|view| line.view_theta(view).unwrap()).collect();
    let grid =
        Grid { thetas: &thetas, azimuths: 5, turns: 1, axis: 0.0, views: &views, squeezed: 3, factors: None };
    let mut bytes = vec![0; grid.encoded_len("")];
    grid.encode("", &mut bytes).unwrap();
    let grid = Material::from_bytes(bytes).unwrap();
    at_each_level(|level| {
        let mut random = Random(9);
        let wo: Vec<Vec3> = (0..37).map(|_| upper(&mut random)).collect();
        let mut all = vec![Mixture::<64>::empty(); wo.len()];
        for (m, &wo) in all.iter_mut().zip(&wo) {
            let mut isotropic = Mixture::<64>::empty();
            line.prepare(wo, &mut isotropic).unwrap();
            grid.prepare(wo, m).unwrap();
            let largest = (0..m.len()).map(|k| m.lobe(k).unwrap().amplitude.length()).fold(0.0, f32::max);
            for _ in 0..10 {
                let wi = upper(&mut random);
                let ((got, pdf), (want, density)) = (m.evaluate_and_pdf(wi), isotropic.evaluate_and_pdf(wi));
                let place = format!("{level:?}, wo {wo}, wi {wi}: {got} {want}");
                assert!(got.distance(want) < 3e-5 * largest, "{place}");
                assert!((pdf - density).abs() < 1e-4 * density.max(1.0), "{place}, {pdf} {density}");
            }
        }
        let arrays = structure_of_arrays(&wo);
        let wo = slices(&arrays, wo.len());
        are_single(&all, &mut random, &format!("anisotropic, {level:?}"), &|request| {
            grid.ask(wo, request).unwrap()
        });
    });
}

/// Between the views of a ring numbers are linear in the azimuth, between rings in the angle.
#[test]
fn an_anisotropic_material_is_linear_round_its_rings() {
    const THETAS: [f32; 3] = [0.0, 0.5, 1.4];
    const AZIMUTHS: usize = 5;
    // Every view has a luminance of its own.
    let log2 = |ring: usize, j: usize| {
        if ring == 0 { 1.0 } else { (ring * AZIMUTHS + 2 * j % AZIMUTHS) as f32 * 0.3 }
    };
    let views = (0..=2).flat_map(|ring| (0..if ring == 0 { 1 } else { AZIMUTHS }).map(move |j| [ring, j]));
    let lobes: Vec<[TiltedLobe; 1]> = views
        .map(|[ring, j]| {
            let log2_luminance = log2(ring, j);
            [TiltedLobe { tilt: [0.0; 2], log2_sharpness: 3.0, log2_luminance, color_differences: [0.0; 2] }]
        })
        .collect();
    let view = |lobes| GridView {
        log2_squeeze: [0.0; 3],
        log2_diffuse: -126.0,
        diffuse_color_differences: [0.0; 2],
        lobes,
    };
    let views: Vec<GridView> = lobes.iter().map(|lobes| view(&lobes[..])).collect();
    let grid = Grid {
        thetas: &THETAS,
        azimuths: AZIMUTHS,
        turns: 1,
        axis: 0.0,
        views: &views,
        squeezed: 0,
        factors: None,
    };
    let mut bytes = vec![0; grid.encoded_len("")];
    grid.encode("", &mut bytes).unwrap();
    let material = Material::from_bytes(bytes).unwrap();
    at_each_level(|level| {
        let mut random = Random(10);
        for _ in 0..200 {
            let wo = upper(&mut random);
            let [x, y, z] = wo.to_array().map(f64::from);
            let theta = x.hypot(y).atan2(z);
            let within = usize::from(theta >= f64::from(THETAS[1]));
            let [from, to] = [THETAS[within], THETAS[within + 1]].map(f64::from);
            let outward = ((theta - from) / (to - from)).min(1.0);
            let place = y.atan2(x).rem_euclid(TAU) / TAU * AZIMUTHS as f64;
            let on_ring = |ring: usize| {
                let [a, b] = [0, 1].map(|next| f64::from(log2(ring, (place as usize + next) % AZIMUTHS)));
                a + (b - a) * place.fract()
            };
            let want = (on_ring(within) * (1.0 - outward) + on_ring(within + 1) * outward).exp2();
            let mut m = Mixture::<64>::empty();
            material.prepare(wo, &mut m).unwrap();
            let got = m.lobe(0).unwrap().amplitude.y;
            assert!(is_near(got, want, want, 200.0), "{level:?}, {wo}: {got} {want}");
        }
    });
}
