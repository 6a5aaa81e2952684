//! The grid of verbs: whatever the shape of a call, it gives what calls for one direction give.

use glam::Vec3;
use srbf_core::{
    Domain, Error, Expanded, FactorTable, Grid, GridView, Level, Line, Lobe, Material, Mixture, PlaneLobe,
    SamplesMut, TiltedLobe, View,
};
use srbf_tests::inputs::Random;
use srbf_tests::seeds::same_without_azimuth;

type Inputs<'a> = [&'a [f32]; 3];
type Done = Result<(), Error>;

/// The verbs for n directions, in one shape.
trait Verbs {
    fn evaluate(&self, wi: Inputs, value: [&mut [f32]; 3]) -> Done;
    fn evaluate_and_pdf(&self, wi: Inputs, value: [&mut [f32]; 3], pdf: &mut [f32]) -> Done;
    fn pdf(&self, wi: Inputs, pdf: &mut [f32]) -> Done;
    fn sample(&self, u: Inputs, samples: SamplesMut) -> Done;
    fn sample_pdf(&self, u: Inputs, direction: [&mut [f32]; 3], pdf: &mut [f32]) -> Done;
    fn sample_and_evaluate(
        &self,
        u: Inputs,
        samples: SamplesMut,
        wi: Inputs,
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Done;
}

/// One shape: `$start` are the arguments that its calls begin with.
macro_rules! shape {
    ($name:ident<$life:lifetime>($($field:ty),*), $self:ident, [$($of:tt)*], [$($start:expr),*],
     $evaluate:ident, $both:ident, $pdf:ident, $sample:ident, $sample_pdf:ident, $sample_and:ident) => {
        struct $name<$life>($($field),*);

        impl Verbs for $name<'_> {
            fn evaluate(&$self, wi: Inputs, value: [&mut [f32]; 3]) -> Done {
                $($of)*$evaluate($($start,)* wi, value)
            }
            fn evaluate_and_pdf(&$self, wi: Inputs, value: [&mut [f32]; 3], pdf: &mut [f32]) -> Done {
                $($of)*$both($($start,)* wi, value, pdf)
            }
            fn pdf(&$self, wi: Inputs, pdf: &mut [f32]) -> Done {
                $($of)*$pdf($($start,)* wi, pdf)
            }
            fn sample(&$self, u: Inputs, samples: SamplesMut) -> Done {
                $($of)*$sample($($start,)* u, samples)
            }
            fn sample_pdf(&$self, u: Inputs, direction: [&mut [f32]; 3], pdf: &mut [f32]) -> Done {
                $($of)*$sample_pdf($($start,)* u, direction, pdf)
            }
            fn sample_and_evaluate(
                &$self,
                u: Inputs,
                samples: SamplesMut,
                wi: Inputs,
                value: [&mut [f32]; 3],
                pdf: &mut [f32],
            ) -> Done {
                $($of)*$sample_and($($start,)* u, samples, wi, value, pdf)
            }
        }
    };
}

shape!(OfOne<'a>(&'a Mixture<'a, 64>), self, [self.0.], [],
    evaluate_into, evaluate_and_pdf_into, pdf_into, sample_into, sample_pdf_into, sample_and_evaluate_into);
shape!(OfMixtures<'a>(&'a [Mixture<'a, 64>]), self, [Mixture::], [self.0],
    evaluate_pairs_into, evaluate_and_pdf_pairs_into, pdf_pairs_into,
    sample_pairs_into, sample_pdf_pairs_into, sample_and_evaluate_pairs_into);
shape!(OfReferences<'a>(&'a [&'a Mixture<'a, 64>]), self, [Mixture::], [self.0],
    evaluate_pairs_into, evaluate_and_pdf_pairs_into, pdf_pairs_into,
    sample_pairs_into, sample_pdf_pairs_into, sample_and_evaluate_pairs_into);
shape!(OfMaterial<'a>(&'a Material<Vec<u8>>, Inputs<'a>), self, [self.0.], [self.1],
    evaluate_pairs_into, evaluate_and_pdf_pairs_into, pdf_pairs_into,
    sample_pairs_into, sample_pdf_pairs_into, sample_and_evaluate_pairs_into);
shape!(OfExpanded<'a>(&'a Expanded<'a>, Inputs<'a>), self, [self.0.], [self.1],
    evaluate_pairs_into, evaluate_and_pdf_pairs_into, pdf_pairs_into,
    sample_pairs_into, sample_pdf_pairs_into, sample_and_evaluate_pairs_into);

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
    fn out(&mut self) -> SamplesMut<'_> {
        SamplesMut { direction: self.direction.out(), pdf: &mut self.pdf, weight: self.weight.out() }
    }
}

fn near(a: f32, b: f32, size: f32) -> bool {
    (a - b).abs() <= 2e-5 * size
}

/// Every verb of a shape, against calls for one direction of the mixture of each.
fn check(shape: &dyn Verbs, of_each: &[&Mixture<64>], wi: &[Vec3], u: &[Vec3], place: &str) {
    let n = of_each.len();
    let (wi_in, u_in) = (Arrays::of(&wi[..n]), Arrays::of(&u[..n]));
    let (wi_in, u_in) = (wi_in.slices(), u_in.slices());
    let (mut value, mut both, mut beside) = (Arrays::new(n), Arrays::new(n), Arrays::new(n));
    let (mut pdf, mut both_pdf, mut beside_pdf) = (vec![f32::NAN; n], vec![f32::NAN; n], vec![f32::NAN; n]);
    let (mut samples, mut sampled) = (Samples::new(n), Samples::new(n));
    let (mut drawn, mut drawn_pdf) = (Arrays::new(n), vec![f32::NAN; n]);
    shape.evaluate(wi_in, value.out()).unwrap();
    shape.evaluate_and_pdf(wi_in, both.out(), &mut both_pdf).unwrap();
    shape.pdf(wi_in, &mut pdf).unwrap();
    shape.sample(u_in, samples.out()).unwrap();
    shape.sample_pdf(u_in, drawn.out(), &mut drawn_pdf).unwrap();
    shape.sample_and_evaluate(u_in, sampled.out(), wi_in, beside.out(), &mut beside_pdf).unwrap();
    for (i, m) in of_each.iter().enumerate() {
        let place = format!("{place}, {i} of {n}, {}", wi[i]);
        let (want, density) = m.evaluate_and_pdf(wi[i]);
        let size = want.abs().max_element();
        for got in [value.at(i), both.at(i), beside.at(i), m.evaluate(wi[i])] {
            assert!((0..3).all(|c| near(got[c], want[c], size)), "{place}: value {got}, {want}");
        }
        for got in [pdf[i], both_pdf[i], beside_pdf[i], m.pdf(wi[i])] {
            assert!(near(got, density, density), "{place}: density {got}, {density}");
        }

        let one = m.sample(u[i].to_array());
        let (direction, d_pdf) = (samples.direction.at(i), samples.pdf[i]);
        for got in [drawn.at(i), sampled.direction.at(i)] {
            assert!(got.distance(direction) < 4e-6, "{place}: drawn {got}, {direction}");
        }
        for got in [drawn_pdf[i], sampled.pdf[i]] {
            assert!(near(got, d_pdf, 10.0 * d_pdf), "{place}: density {got}, {d_pdf}");
        }
        let weight = samples.weight.at(i);
        assert!(sampled.weight.at(i).distance(weight) <= 1e-4 * weight.length(), "{place}: weight");
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
        let (again, towards) = m.sample_and_evaluate(u[i].to_array(), wi[i]);
        assert_eq!((again, towards), (one, m.evaluate_and_pdf(wi[i])), "{place}");
    }
    if n > 0 {
        let short = wi_in.map(|s| &s[1..]);
        assert_eq!(shape.evaluate(short, value.out()), Err(Error::Length));
        assert_eq!(shape.evaluate_and_pdf(wi_in, both.out(), &mut pdf[1..]), Err(Error::Length));
        assert_eq!(shape.pdf(short, &mut pdf), Err(Error::Length));
        assert_eq!(shape.sample(short, samples.out()), Err(Error::Length));
        assert_eq!(shape.sample_pdf(u_in, drawn.out(), &mut pdf[1..]), Err(Error::Length));
        let end = shape.sample_and_evaluate(u_in, sampled.out(), short, beside.out(), &mut pdf);
        assert_eq!(end, Err(Error::Length));
    }
}

/// A table of factors for `views` views.
fn with_factors(random: &mut Random, views: usize, run: impl FnOnce(FactorTable) -> Vec<u8>) -> Vec<u8> {
    let (half, difference, azimuth) = (7, 5, 3);
    let mut factors: Vec<[f32; 3]> = (0..105).map(|_| [(); 3].map(|()| random.between(0.3, 2.0))).collect();
    same_without_azimuth(&mut factors, half, difference);
    let albedo_differences = vec![[0.0; 3]; views];
    run(FactorTable { half, difference, azimuth, factors: &factors, albedo_differences: &albedo_differences })
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
    let grid = Grid { thetas: &[0.0, 1.2], azimuths: 4, turns: 1, views: &views, squeezed: 2, factors: None };
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

/// The level is that of the process, and no other test here reads it.
fn for_each_level(mut each: impl FnMut(Level)) {
    for level in Level::ALL.into_iter().filter(|level| level.set().is_ok()) {
        each(level);
    }
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
                check(&OfMaterial(material, wo_in.slices()), &of_each[..n], &wi, &u, &place);
                check(&OfMixtures(&mixtures[..n]), &of_each[..n], &wi, &u, &format!("{place}, mixtures"));
                check(&OfReferences(&of_each[..n]), &of_each[..n], &wi, &u, &format!("{place}, references"));
                let one = &mixtures[0];
                check(&OfOne(one), &vec![one; n], &wi, &u, &format!("{place}, one mixture"));
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
                    &OfExpanded(&expanded, wo_in.slices()),
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
    let levels: Vec<Level> = Level::ALL.into_iter().filter(|level| level.is_available()).collect();
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
        check(&OfMixtures(&mixtures), &of_each, &wi, &u, &format!("round {round}"));
    }
}
