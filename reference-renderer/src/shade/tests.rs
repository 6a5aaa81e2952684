//! Every sampler proves itself on materials that need no data: its directions have its density, the density does not integrate to
//! more than 1, and its estimate is the albedo.

use super::{Light, Sampler, SamplerName, Strategy};
use crate::numbers::points::{Points, PointsName};
use crate::numbers::random::Random;
use crate::shade::shader::{Scattering, Shader};
use crate::truth::Truth;
use crate::truth::measured::MeasuredMaterial;
use crate::truth::measured::tests::{model, vivid};
use crate::truth::stored::tests::{brushed, lacquer};
use glam::{DVec3, Vec3};
use srbf_thesis::samplers::ggx_parts::{GgxProposal, PARTS};

/// Directions that each sampler draws, and directions of the reference.
const DRAWN: u32 = 10_000;
const SEEN: u32 = 30_000;

/// A mean and the square of its standard error.
#[derive(Clone, Copy, Default)]
struct Mean {
    sum: f64,
    squares: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.squares += value * value;
        self.count += 1.0;
    }
    fn mean(&self) -> f64 {
        self.sum / self.count
    }
    fn variance(&self) -> f64 {
        ((self.squares / self.count - self.mean().powi(2)) / self.count).max(0.0)
    }
}

/// What directions are counted by: all, and bumps of several widths round the mirror direction and elsewhere, two sides told apart.
fn counted(wi: DVec3, wo: DVec3) -> [f64; 6] {
    let mirror = DVec3::new(-wo.x, -wo.y, wo.z);
    let bump = |at: DVec3, sharpness: f64| (-sharpness * (wi - at).length_squared()).exp();
    let side = wo.cross(DVec3::Z).normalize_or(DVec3::Y);
    let beside = (mirror + 0.2 * side).normalize();
    [1.0, bump(mirror, 1.0), bump(mirror, 20.0), bump(mirror, 400.0), bump(beside, 50.0), wi.z]
}

/// Directions with the weights that make sums over them integrals over the hemisphere: of GGX lobes of any width, and of the cosine.
fn reference(wo: DVec3, mut each: impl FnMut(DVec3, f64)) {
    let proposal = GgxProposal::even(wo);
    let mut random = Random::new(77, 1, 1);
    for i in 0..SEEN {
        let [u, v] = [(); 2].map(|()| f64::from(random.unit()));
        let wi = proposal.draw(i as usize % PARTS, u, v);
        each(wi, if wi.z > 0.0 { 1.0 / proposal.density(wi) } else { 0.0 });
    }
}

/// The ways in which the thesis's lobes are drawn from, and what else takes seconds to fit.
const SLOW: [SamplerName; 4] =
    [SamplerName::Thesis, SamplerName::ThesisWalk, SamplerName::ThesisMulti, SamplerName::Lafortune];

/// Whether a sampler can be fitted to a truth at all.
fn is_fitted(name: SamplerName, truth: &Truth<'_>) -> bool {
    match name {
        SamplerName::Rgl => truth.draws().is_some(),
        _ => truth.is_isotropic() || !SLOW.contains(&name),
    }
}

fn check(what: &str, truth: Truth<'_>, lobes: Option<Truth<'_>>, names: impl Iterator<Item = SamplerName>) {
    let lobes = lobes.map(|lobes| match lobes {
        Truth::Lobes(material) => material,
        Truth::Table(_) | Truth::Sheet(_) => panic!("lobes"),
    });
    for (name, fitted) in Sampler::fit_all(names, &truth, lobes) {
        assert_eq!(fitted.is_ok(), is_fitted(name, &truth), "{what}, {}", name.text());
        let Ok(sampler) = fitted else { continue };
        for (degrees, azimuth) in [(5.0f64, 0.4f64), (50.0, 2.0), (80.0, -2.8)] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let wo = DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos);
            check_direction(
                &format!("{what}, {}, {degrees} degrees", name.text()),
                name,
                &Shader { truth, sampler: &sampler },
                wo,
            );
        }
    }
}

fn check_direction<'a>(what: &str, name: SamplerName, shader: &Shader<'a>, wo: DVec3) {
    let mut scattering = Scattering::empty();
    shader.prepare(wo.as_vec3(), &mut scattering).unwrap();

    // By the density, and by quadrature.
    let (mut expected, mut albedo) = ([Mean::default(); 6], Mean::default());
    reference(wo, |wi, weight| {
        let (value, pdf) =
            if weight > 0.0 { scattering.evaluate_and_pdf(wi.as_vec3()) } else { (Vec3::ZERO, 0.0) };
        assert!(pdf >= 0.0 && pdf.is_finite(), "{what}: density {pdf} at {wi}");
        let counted = counted(wi, wo);
        (0..6).for_each(|k| expected[k].add(counted[k] * weight * f64::from(pdf)));
        albedo.add(weight * f64::from(value.x));
    });
    let within = expected[0].mean();
    assert!(within < 1.0 + 4.0 * expected[0].variance().sqrt(), "{what}: the density integrates to {within}");

    // By directions that were drawn.
    let mut random = Random::new(5, 6, 7);
    let (mut drawn, mut estimate) = ([Mean::default(); 6], Mean::default());
    for _ in 0..DRAWN {
        let sample = scattering.sample([random.unit(), random.unit(), random.unit()]);
        let counted = sample.map_or([0.0; 6], |s| counted(s.direction.as_dvec3(), wo));
        (0..6).for_each(|k| drawn[k].add(counted[k]));
        estimate.add(sample.map_or(0.0, |s| f64::from(s.weight.x)));
    }
    let is_biased = name == SamplerName::ThesisWalk;
    for k in 0..6 {
        let error = (expected[k].variance() + drawn[k].variance()).sqrt();
        let deviation = (expected[k].mean() - drawn[k].mean()).abs();
        // Beside chance, a walk has what its floor and its steps leave.
        let allowed = 4.5 * error + if is_biased { 0.05 } else { 1e-6 };
        assert!(deviation < allowed, "{what}, {k}: {} {} +- {error}", expected[k].mean(), drawn[k].mean());
    }
    agrees(what, &albedo, &estimate, is_biased);

    // Several directions together.
    if name.is_multi() {
        let (mut together, mut samples) = (Mean::default(), Vec::new());
        for i in 0..DRAWN / 8 {
            let points = Points::new(PointsName::Random, 5, 6, i as u64);
            scattering.sample_together(8, &points, &mut samples);
            together.add(samples.iter().map(|s| f64::from(s.weight.x)).sum::<f64>() / 8.0);
        }
        agrees(&format!("{what}, together"), &albedo, &together, false);
    }
}

/// An estimate of the albedo is the quadrature within four standard errors: of the hundreds that are compared, three would let one
/// fail by chance.
fn agrees(what: &str, albedo: &Mean, estimate: &Mean, is_biased: bool) {
    let error = (albedo.variance() + estimate.variance()).sqrt();
    let deviation = (albedo.mean() - estimate.mean()).abs();
    let allowed = 4.0 * error + if is_biased { 0.1 * albedo.mean().abs() } else { 1e-6 };
    assert!(
        deviation < allowed,
        "{what}: albedo {} by quadrature, {} by samples, +- {error}",
        albedo.mean(),
        estimate.mean()
    );
}

#[test]
fn samplers_of_lobes() {
    let lacquer = lacquer();
    let all_but_walk = SamplerName::all().filter(|&name| name != SamplerName::ThesisWalk);
    check(
        "lacquer",
        Truth::Lobes(&lacquer.material),
        None,
        all_but_walk.filter(|&name| name != SamplerName::Thesis),
    );
}

#[test]
fn samplers_of_anisotropic_lobes() {
    let brushed = brushed();
    check("brushed", Truth::Lobes(&brushed.material), None, SamplerName::all());
}

#[test]
fn samplers_of_a_model() {
    // The lobes of another material sample it: badly, and unbiased.
    let (lacquer, gloss) = (lacquer(), model("model:ggx:alpha=0.15,f0=0.6/0.4/0.2,diffuse=0.1"));
    check("ggx", Truth::Table(&gloss), Some(Truth::Lobes(&lacquer.material)), SamplerName::all());
}

#[test]
fn samplers_of_negative_channels() {
    check("vivid", Truth::Table(&vivid()), None, SamplerName::all().filter(|name| !SLOW.contains(name)));
}

#[test]
fn samplers_of_a_file_with_warps() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/corpus/small.bsdf");
    let measured = MeasuredMaterial::load(file).unwrap();
    assert!(measured.draws().is_some());
    check("bsdf", Truth::Table(&measured), None, SamplerName::all().filter(|name| !SLOW.contains(name)));
}

#[test]
fn a_black_material_is_sampled_or_refused() {
    let black = model("model:lambert:albedo=0");
    let truth = Truth::Table(&black);
    for (name, fitted) in Sampler::fit_all(SamplerName::all(), &truth, None) {
        let Ok(sampler) = fitted else {
            assert!(SLOW.contains(&name) || name == SamplerName::Rgl, "{}", name.text());
            continue;
        };
        let mut scattering = Scattering::empty();
        Shader { truth, sampler: &sampler }.prepare(Vec3::new(-0.6, 0.0, 0.8), &mut scattering).unwrap();
        for u in [[0.0; 3], [0.5; 3], [0.999; 3]] {
            let sample = scattering.sample(u);
            assert!(
                sample.is_none_or(|s| s.weight == Vec3::ZERO && s.pdf > 0.0),
                "{}: {sample:?}",
                name.text()
            );
        }
    }
}

#[test]
fn strategies_are_read_with_their_light() {
    let strategy: Strategy = "ggx+mis".parse().unwrap();
    assert_eq!(strategy, Strategy { sampler: SamplerName::Ggx, light: Light::Mis });
}

#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn samplers_of_measured_tables() {
    let folder = std::env::var("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the folder of the data");
    let measured = |file: &str| MeasuredMaterial::load(&format!("{folder}/{file}")).unwrap();
    let file = "rgl/vch_golden_yellow_rgb.bsdf";
    check(file, Truth::Table(&measured(file)), None, SamplerName::all());
    for file in ["rgl/aurora_white_rgb.bsdf", "cornell/garnet_red.brdf"] {
        check(
            file,
            Truth::Table(&measured(file)),
            None,
            SamplerName::all().filter(|name| !SLOW.contains(name)),
        );
    }
}
