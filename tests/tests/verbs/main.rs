//! The grid of verbs: whatever the shape of a call, it gives what calls for one direction give.

mod statistics;

use glam::Vec3;
use srbf_core::{
    AnyMixture, Domain, Draws, Error, Expanded, FactorTable, Grid, GridView, Line, Lobe, Material, Mixture,
    PlaneLobe, Request, TiltedLobe, Towards, View,
};
use srbf_tests::inputs::{Random, levels};
use srbf_tests::kinds::for_each_level;
use srbf_tests::seeds::same_without_azimuth;

type Inputs<'a> = [&'a [f32]; 3];
type Done = Result<(), Error>;

/// One shape: of what n hits are asked.
type Ask<'a> = &'a dyn Fn(Request) -> Done;

/// A structure of arrays.
struct Arrays([Vec<f32>; 3]);

impl Arrays {
    fn of(vectors: &[Vec3]) -> Self {
        Self([0, 1, 2].map(|i| vectors.iter().map(|v| v[i]).collect()))
    }
    fn new(n: usize) -> Self {
        Self([(); 3].map(|()| vec![f32::NAN; n]))
    }
    fn slices(&self) -> Inputs<'_> {
        self.0.each_ref().map(Vec::as_slice)
    }
    fn out(&mut self) -> [&mut [f32]; 3] {
        self.0.each_mut().map(Vec::as_mut_slice)
    }
    fn at(&self, i: usize) -> Vec3 {
        Vec3::new(self.0[0][i], self.0[1][i], self.0[2][i])
    }
}

/// Samples of n.
struct Samples {
    direction: Arrays,
    pdf: Vec<f32>,
    weight: Arrays,
}

impl Samples {
    fn new(n: usize) -> Self {
        Self { direction: Arrays::new(n), pdf: vec![f32::NAN; n], weight: Arrays::new(n) }
    }
    fn draws<'a>(&'a mut self, u: Inputs<'a>) -> Draws<'a> {
        let (direction, weight) = (self.direction.out(), Some(self.weight.out()));
        Draws { u, direction, pdf: Some(&mut self.pdf), weight }
    }
}

fn near(a: f32, b: f32, size: f32) -> bool {
    (a - b).abs() <= 2e-5 * size
}

/// Everything that can be asked in a shape, against calls for one direction of the mixture of each.
fn check(ask: Ask, of_each: &[&Mixture<64>], wi: &[Vec3], u: &[Vec3], place: &str) {
    let n = of_each.len();
    let (wi_in, u_in) = (Arrays::of(&wi[..n]), Arrays::of(&u[..n]));
    let (wi_in, u_in) = (wi_in.slices(), u_in.slices());
    let (mut value, mut both, mut beside) = (Arrays::new(n), Arrays::new(n), Arrays::new(n));
    let (mut pdf, mut both_pdf, mut beside_pdf) = (vec![f32::NAN; n], vec![f32::NAN; n], vec![f32::NAN; n]);
    let (mut samples, mut sampled) = (Samples::new(n), Samples::new(n));
    let (mut drawn, mut drawn_pdf) = (Arrays::new(n), vec![f32::NAN; n]);
    let (mut bare, mut weighed, mut weights) = (Arrays::new(n), Arrays::new(n), Arrays::new(n));
    let wi = wi_in;
    ask(Towards { wi, value: Some(value.out()), pdf: None }.into()).unwrap();
    ask(Towards { wi, value: Some(both.out()), pdf: Some(&mut both_pdf) }.into()).unwrap();
    ask(Towards { wi, value: None, pdf: Some(&mut pdf) }.into()).unwrap();
    ask(samples.draws(u_in).into()).unwrap();
    ask(Draws { u: u_in, direction: drawn.out(), pdf: Some(&mut drawn_pdf), weight: None }.into()).unwrap();
    ask(Draws { u: u_in, direction: bare.out(), pdf: None, weight: None }.into()).unwrap();
    ask(Draws { u: u_in, direction: weighed.out(), pdf: None, weight: Some(weights.out()) }.into()).unwrap();
    let towards = Towards { wi, value: Some(beside.out()), pdf: Some(&mut beside_pdf) };
    ask(Request { draw: Some(sampled.draws(u_in)), evaluate: Some(towards) }).unwrap();
    ask(Request::default()).unwrap();
    for (i, m) in of_each.iter().enumerate() {
        let (wi, u) = (Vec3::new(wi[0][i], wi[1][i], wi[2][i]), u[i].to_array());
        let place = format!("{place}, {i} of {n}, {wi}");
        let (want, density) = m.evaluate_and_pdf(wi);
        let size = want.abs().max_element();
        for got in [value.at(i), both.at(i), beside.at(i), m.evaluate(wi)] {
            assert!((0..3).all(|c| near(got[c], want[c], size)), "{place}: value {got}, {want}");
        }
        for got in [pdf[i], both_pdf[i], beside_pdf[i], m.pdf(wi)] {
            assert!(near(got, density, density), "{place}: density {got}, {density}");
        }

        let one = m.sample(u);
        let (direction, d_pdf) = (samples.direction.at(i), samples.pdf[i]);
        for got in [drawn.at(i), sampled.direction.at(i), bare.at(i), weighed.at(i)] {
            assert!(got.distance(direction) < 4e-6, "{place}: drawn {got}, {direction}");
        }
        for got in [drawn_pdf[i], sampled.pdf[i]] {
            assert!(near(got, d_pdf, 10.0 * d_pdf), "{place}: density {got}, {d_pdf}");
        }
        let weight = samples.weight.at(i);
        for got in [sampled.weight.at(i), weights.at(i)] {
            assert!(got.distance(weight) <= 1e-4 * weight.length(), "{place}: weight");
        }
        match one {
            Some(one) => {
                assert!(one.direction.distance(direction) < 4e-6, "{place}: {direction}, {}", one.direction);
                // At the direction that was drawn: a sharp lobe changes by much in the distance of the two.
                let (want, density) = m.evaluate_and_pdf(direction);
                assert!(near(d_pdf, density, 20.0 * density), "{place}: {d_pdf}, {density}");
                assert!((weight * d_pdf).distance(want) <= 4e-4 * want.length(), "{place}: weight {weight}");
            }
            None => assert_eq!((d_pdf, weight), (0.0, Vec3::ZERO), "{place}"),
        }
        let (again, towards) = m.sample_and_evaluate(u, wi);
        assert_eq!((again, towards), (one, m.evaluate_and_pdf(wi)), "{place}");
    }
    if n > 0 {
        let short = wi.map(|s| &s[1..]);
        let value = || Arrays::new(n);
        let refused = |request: Request| assert_eq!(ask(request), Err(Error::Length), "{place}");
        refused(Towards { wi: short, value: Some(value().out()), pdf: None }.into());
        refused(Towards { wi, value: Some(value().out()), pdf: Some(&mut pdf[1..]) }.into());
        refused(Towards { wi: short, value: None, pdf: Some(&mut pdf) }.into());
        refused(samples.draws(short).into());
        refused(Draws { u: u_in, direction: drawn.out(), pdf: Some(&mut pdf[1..]), weight: None }.into());
        let towards = Towards { wi: short, value: Some(beside.out()), pdf: Some(&mut pdf) };
        refused(Request { draw: Some(sampled.draws(u_in)), evaluate: Some(towards) });
    }
}

/// A table of factors for `views` views.
fn with_factors(random: &mut Random, views: usize, run: impl FnOnce(FactorTable) -> Vec<u8>) -> Vec<u8> {
    let (half, difference, azimuth) = (7, 5, 3);
    let mut factors: Vec<[f32; 3]> = (0..105).map(|_| [(); 3].map(|()| random.between(0.3, 2.0))).collect();
    same_without_azimuth(&mut factors, half, difference);
    let albedo_differences = vec![[0.0; 3]; views];
    run(FactorTable {
        half,
        difference,
        azimuth,
        is_signed: false,
        factors: &factors,
        albedo_differences: &albedo_differences,
    })
}

/// An isotropic material of three views.
fn isotropic(
    random: &mut Random,
    lobes: usize,
    squeezed: usize,
    mirrored: usize,
    factors: bool,
) -> Material<Vec<u8>> {
    let thetas = [0.0, 0.7, 1.4];
    let all: Vec<Vec<PlaneLobe>> = thetas
        .iter()
        .map(|&theta| {
            let mut lobe = |k: usize| PlaneLobe {
                angle: if theta > 0.0 { random.between(-1.3, 1.3) } else { 0.0 },
                off_plane: if theta > 0.0 && k >= lobes - mirrored { random.between(0.1, 0.9) } else { 0.0 },
                log2_sharpness: random.between(-1.0, 7.0),
                log2_luminance: random.between(-3.0, 1.0),
                color_differences: [random.between(-0.5, 0.5), random.between(-0.5, 0.5)],
            };
            (0..lobes).map(&mut lobe).collect()
        })
        .collect();
    let views: Vec<View> = thetas
        .iter()
        .zip(&all)
        .map(|(&theta, lobes)| View {
            theta,
            log2_squeeze: -theta,
            log2_diffuse: -3.0,
            diffuse_color_differences: [0.1, -0.2],
            lobes,
        })
        .collect();
    let encode = |factors: Option<FactorTable>| {
        let line = Line { views: &views, squeezed, mirrored, factors };
        let mut bytes = vec![0; line.encoded_len("verbs")];
        line.encode("verbs", &mut bytes).unwrap();
        bytes
    };
    let bytes = if factors { with_factors(random, 3, |table| encode(Some(table))) } else { encode(None) };
    Material::from_bytes(bytes).unwrap()
}

/// An anisotropic material of one ring.
fn anisotropic(random: &mut Random) -> Material<Vec<u8>> {
    let lobes: Vec<[TiltedLobe; 3]> = (0..5)
        .map(|_| {
            [(); 3].map(|()| TiltedLobe {
                tilt: [random.between(-0.8, 0.8), random.between(-0.8, 0.8)],
                log2_sharpness: random.between(-1.0, 6.0),
                log2_luminance: random.between(-3.0, 1.0),
                color_differences: [0.2, -0.2],
            })
        })
        .collect();
    let views: Vec<GridView> = lobes
        .iter()
        .map(|lobes| GridView {
            log2_squeeze: [0.5, 0.2, -0.5],
            log2_diffuse: -4.0,
            diffuse_color_differences: [0.0; 2],
            lobes,
        })
        .collect();
    let grid = Grid {
        thetas: &[0.0, 1.2],
        azimuths: 4,
        turns: 1,
        axis: 0.0,
        views: &views,
        squeezed: 2,
        factors: None,
    };
    let mut bytes = vec![0; grid.encoded_len("verbs")];
    grid.encode("verbs", &mut bytes).unwrap();
    Material::from_bytes(bytes).unwrap()
}

/// Pairs: more than two blocks, and no multiple of any width.
const PAIRS: usize = 37;

fn prepared<'a>(material: &'a Material<Vec<u8>>, wo: &[Vec3]) -> Vec<Mixture<'a, 64>> {
    wo.iter()
        .map(|&wo| {
            let mut mixture = Mixture::empty();
            let _ = material.prepare(wo, &mut mixture);
            mixture
        })
        .collect()
}

#[test]
fn every_verb_gives_in_every_shape_what_single_calls_give() {
    let mut random = Random(31);
    let materials = [
        ("plain", isotropic(&mut random, 5, 0, 0, false)),
        ("squeezed pairs", isotropic(&mut random, 14, 6, 5, false)),
        ("factors", isotropic(&mut random, 12, 4, 0, true)),
        ("52 lobes", isotropic(&mut random, 40, 9, 12, false)),
        ("anisotropic", anisotropic(&mut random)),
    ];
    let mut wo: Vec<Vec3> = (0..PAIRS).map(|_| random.direction()).collect();
    // Most are above the horizon; one is none at all.
    wo.iter_mut().step_by(2).for_each(|d| d.z = d.z.abs());
    wo[5] = Vec3::new(3.0, 0.0, 1.0);
    let wi: Vec<Vec3> = (0..PAIRS).map(|_| random.direction()).collect();
    let u: Vec<Vec3> = (0..PAIRS).map(|_| Vec3::from_array(random.three())).collect();
    for_each_level(|level| {
        for (name, material) in &materials {
            let place = format!("{level:?}, {name}");
            let mixtures = prepared(material, &wo);
            let of_each: Vec<&Mixture<64>> = mixtures.iter().collect();
            for n in [0, 1, 3, 4, 16, 17, PAIRS] {
                let wo_in = Arrays::of(&wo[..n]);
                let check = |ask: Ask, of_each: &[&Mixture<64>], what: &str| {
                    check(ask, of_each, &wi, &u, &format!("{place}, {what}"));
                };
                check(&|request| material.ask(wo_in.slices(), request), &of_each[..n], "material");
                let each = vec![material; n];
                check(
                    &|request| Material::ask_each(&each, wo_in.slices(), request),
                    &of_each[..n],
                    "materials",
                );
                check(&|request| AnyMixture::ask_each(&mixtures[..n], request), &of_each[..n], "mixtures");
                check(&|request| AnyMixture::ask_each(&of_each[..n], request), &of_each[..n], "references");
                let one = &mixtures[0];
                check(&|request| one.ask(request), &vec![one; n], "one mixture");
            }
            if !material.is_isotropic() {
                continue;
            }
            let mut memory = vec![0.0; material.expanded_len(64)];
            let expanded = Expanded::new(material, 64, &mut memory).unwrap();
            let mut mixtures = vec![Mixture::<64>::empty(); PAIRS];
            for (mixture, &wo) in mixtures.iter_mut().zip(&wo) {
                let _ = expanded.prepare(wo, mixture);
            }
            let of_each: Vec<&Mixture<64>> = mixtures.iter().collect();
            for n in [0, 1, 16, PAIRS] {
                let wo_in = Arrays::of(&wo[..n]);
                check(
                    &|request| expanded.ask(wo_in.slices(), request),
                    &of_each[..n],
                    &wi,
                    &u,
                    &format!("{place}, expanded"),
                );
            }
        }
    });
}

/// Mixtures of several levels, materials and domains in one call, with and without factors.
#[test]
fn mixtures_of_all_kinds_may_stand_side_by_side() {
    let mut random = Random(32);
    let (plain, factored) = (isotropic(&mut random, 6, 2, 0, false), isotropic(&mut random, 9, 3, 0, true));
    let other = isotropic(&mut random, 9, 0, 2, true);
    let levels = levels();
    let upper = |random: &mut Random| {
        let d = random.direction();
        d.with_z(d.z.abs())
    };
    for round in 0..60 {
        let mut mixtures = Vec::new();
        for i in 0..PAIRS {
            let level = levels[if round % 3 == 0 { i % levels.len() } else { round % levels.len() }];
            let kind = if round % 4 == 0 { random.uniform() } else { round as f32 / 60.0 };
            let mut m = Mixture::<64>::empty();
            if kind < 0.25 {
                plain.prepare_with(upper(&mut random), level.into(), &mut m).unwrap();
            } else if kind < 0.5 {
                factored.prepare_with(upper(&mut random), level.into(), &mut m).unwrap();
            } else if kind < 0.75 {
                // Half of them reflect nothing.
                other.prepare_with(random.direction(), level.into(), &mut m).unwrap();
            } else {
                let lobes: Vec<Lobe> = (0..5).map(|_| random.lobe(-1.0, 3.0)).collect();
                let domain = if kind < 0.9 { Domain::Sphere } else { Domain::Hemisphere };
                m = Mixture::new(domain, 0.7, &lobes[..2], &lobes[2..]).unwrap().with_level(level).unwrap();
            }
            mixtures.push(m);
        }
        let wi: Vec<Vec3> = (0..PAIRS).map(|_| random.direction()).collect();
        let u: Vec<Vec3> = (0..PAIRS).map(|_| Vec3::from_array(random.three())).collect();
        let of_each: Vec<&Mixture<64>> = mixtures.iter().collect();
        check(
            &|request| AnyMixture::ask_each(&mixtures, request),
            &of_each,
            &wi,
            &u,
            &format!("round {round}"),
        );
    }
}

#[test]
fn a_mixture_is_copied_into_any_room_that_holds_its_lobes() {
    let mut random = Random(91);
    let lobes: Vec<_> = (0..20).map(|_| random.lobe(0.3, 0.9)).collect();
    let many = Mixture::<48>::hemisphere(&lobes).unwrap().with_diffuse([0.1, 0.2, 0.3]).unwrap();
    let (mut exact, mut large) = (Mixture::<32>::empty(), Mixture::<64>::sphere(&lobes[..3]).unwrap());
    let rooms: [&mut AnyMixture<'_>; 2] = [&mut exact, &mut large];
    for (to, room) in rooms.into_iter().zip([32, 64]) {
        assert_eq!(to.capacity(), room);
        to.copy_from(&many).unwrap();
        assert_eq!((to.len(), to.power()), (many.len(), many.power()));
        for _ in 0..64 {
            let (wi, u) = (random.direction(), random.three());
            assert_eq!((to.evaluate(wi), to.pdf(wi)), (many.evaluate(wi), many.pdf(wi)));
            assert_eq!(to.sample(u), many.sample(u));
        }
    }
    // One that is too small stays as it was.
    let mut small = Mixture::<16>::hemisphere(&lobes[..2]).unwrap();
    let before = small.evaluate(Vec3::Z);
    assert_eq!(small.copy_from(&many), Err(Error::Capacity { needed: 20, available: 16 }));
    assert_eq!((small.len(), small.evaluate(Vec3::Z)), (2, before));
}
