//! Every SIMD level against f64, for every count round the lane widths.
//!
//! A package of its own, without std, so that it also runs on processors that are only imitated: see the checks in
//! `.ci/checks` whose names begin with 7.
#![no_std]

extern crate alloc;

mod factors;
mod findings;
pub mod inputs;
pub mod outputs;
#[path = "../../src/tolerance.rs"]
pub mod tolerance;
pub mod truth;

use alloc::format;
use alloc::vec;
use alloc::vec::Vec;
pub use findings::Findings;
use inputs::{Case, Random};
use outputs::{COUNTS, Guarded, slices, structure_of_arrays};
use srbf_core::{AnyMixture, Draws, Level, Material, Mixture, Towards, Vec3};
use tolerance::Worst;
use truth::{Truth, truth};

/// Mixtures that are tried.
const MIXTURES: usize = 60;

/// Checks a level, which the machine must have; it is then the current one.
///
/// # Errors
/// [`srbf_core::Error::Level`] where it has not.
pub fn check(level: Level) -> Result<Findings, srbf_core::Error> {
    level.set()?;
    let names = [
        "batch value",
        "batch pdf",
        "one value",
        "one pdf",
        "sampled pdf",
        "sampled weight",
        "factored value",
    ];
    let mut found = Findings { worst: names.map(Worst::new).into(), faults: Vec::new() };
    let mut random = Random(7);
    for n in 0..MIXTURES {
        let case = Case::new(n, &mut random);
        if case.mixture.level() != level {
            found.fault(format!("{}: made for {:?}", case.name, case.mixture.level()));
        }
        check_values(&case, &mut random, &mut found);
        check_samples(&case.mixture, &format!("mixture {n}"), &mut random, &mut found);
    }
    for mirrored in [0, 3] {
        check_prepared(mirrored, &mut random, &mut found);
    }
    factors::check(&mut random, &mut found);
    Ok(found)
}

/// Values and densities at every count, and one by one.
fn check_values(case: &Case, random: &mut Random, found: &mut Findings) {
    let m = &case.mixture;
    let directions: Vec<Vec3> = (0..COUNTS).map(|_| random.direction()).collect();
    let wanted: Vec<Truth> = directions.iter().map(|&d| truth(m, d)).collect();
    let arrays = structure_of_arrays(&directions);
    let power = f64::from(m.power());
    for n in 0..COUNTS {
        let (mut out, mut both, mut alone) =
            (Guarded::<3>::new(n), Guarded::<4>::new(n), Guarded::<1>::new(n));
        let ([red, green, blue, with_value], [pdf]) = (both.slices(), alone.slices());
        let written = m
            .ask(Towards { wi: slices(&arrays, n), value: Some(out.slices()), pdf: None }.into())
            .and(
                m.ask(
                    Towards {
                        wi: slices(&arrays, n),
                        value: Some([red, green, blue]),
                        pdf: Some(with_value),
                    }
                    .into(),
                ),
            )
            .and(m.ask(Towards { wi: slices(&arrays, n), value: None, pdf: Some(pdf) }.into()));
        if written.is_err() || !out.is_intact() || !both.is_intact() || !alone.is_intact() {
            found.fault(format!("{}, {n} directions: {written:?}, or a guard zone was written", case.name));
        }
        for (i, want) in wanted[..n].iter().enumerate() {
            let place = || format!("{}, direction {i} of {n}: {}", case.name, directions[i]);
            for c in 0..3 {
                found.see("batch value", out.at(c, i), want.value[c], want.scale[c], &place());
            }
            let (value, scale) = (want.luminance(), want.luminance_scale);
            found.see("batch pdf", both.at(3, i), value / power, scale / power, &place());
            found.see("batch pdf", alone.at(0, i), value / power, scale / power, &place());
            if (0..3).any(|c| both.at(c, i) != out.at(c, i)) {
                found.fault(format!("{}: another value beside the density", place()));
            }
        }
    }
    for (d, want) in directions.iter().zip(&wanted) {
        let place = format!("{}, {d}", case.name);
        let value = m.evaluate(*d);
        for c in 0..3 {
            found.see("one value", value[c], want.value[c], want.scale[c], &place);
        }
        let (value, scale) = (want.luminance(), want.luminance_scale);
        found.see("one pdf", m.pdf(*d), value / power, scale / power, &place);
    }
}

/// Samples in a batch are unit vectors above the horizon, with the density and the weight of the mixture there, and
/// those that one call after the other gives.
fn check_samples(m: &Mixture<64>, name: &str, random: &mut Random, found: &mut Findings) {
    // Every width that a level takes at a time, and a rest.
    let n = COUNTS - 3;
    let u: Vec<Vec3> =
        (0..n).map(|_| Vec3::new(random.uniform(), random.uniform(), random.uniform())).collect();
    let arrays = structure_of_arrays(&u);
    let (mut out, mut bare) = (Guarded::<7>::new(n), Guarded::<4>::new(n));
    let [x, y, z, pdf, r, g, b] = out.slices();
    let samples =
        Draws { u: slices(&arrays, n), direction: [x, y, z], pdf: Some(pdf), weight: Some([r, g, b]) };
    let written = m.ask(samples.into());
    let [x, y, z, pdf] = bare.slices();
    let written = written.and(
        m.ask(Draws { u: slices(&arrays, n), direction: [x, y, z], pdf: Some(pdf), weight: None }.into()),
    );
    if written.is_err() || !out.is_intact() || !bare.is_intact() {
        found.fault(format!("{name}: {written:?}, or a guard zone was written"));
    }
    let power = f64::from(m.power());
    for (i, u) in u.iter().enumerate() {
        let d = Vec3::new(out.at(0, i), out.at(1, i), out.at(2, i));
        let place = format!("{name}, u {u}: {d}");
        if !((d.length() - 1.0).abs() < 3e-7 && truth::is_inside(m, d)) {
            found.fault(format!("{place}: no unit vector of the domain"));
        }
        let want = truth(m, d);
        let (density, scale) = (want.luminance() / power, want.luminance_scale / power);
        found.see("sampled pdf", out.at(3, i), density, scale, &place);
        found.see("sampled pdf", bare.at(3, i), density, scale, &place);
        let weight = srbf_core::luminance(Vec3::new(out.at(4, i), out.at(5, i), out.at(6, i)));
        found.see("sampled weight", weight, power, power, &place);
        let one = m.sample(u.to_array()).map(|s| s.direction);
        let again = Vec3::new(bare.at(0, i), bare.at(1, i), bare.at(2, i));
        for other in [one, m.sample_direction(u.to_array()), Some(again)] {
            if !other.is_some_and(|o| o.distance(d) < 4e-6) {
                found.fault(format!("{place}: another call gives {other:?}"));
            }
        }
    }
}

/// The same for prepared mixtures, and mixtures prepared pair by pair are those prepared one by one.
fn check_prepared(mirrored: usize, random: &mut Random, found: &mut Findings) {
    let bytes = inputs::material(random, mirrored);
    let material = Material::from_bytes(&bytes).expect("a valid material");
    for n in 0..40 {
        let mut wo = random.direction();
        wo.z = wo.z.abs();
        let mut m = Mixture::<64>::empty();
        material.prepare(wo, &mut m).expect("a unit vector");
        check_azimuth(&m, wo, found);
        check_samples(&m, &format!("prepared {n}, wo {wo}"), random, found);
    }
    check_pairs(&material, random, found);
}

/// +x of a prepared mixture is away from the outgoing direction, but for the rounding of its cosine and sine, which narrow lobes see:
/// the truth has it as it is.
fn check_azimuth(m: &Mixture<64>, wo: Vec3, found: &mut Findings) {
    let ([c, s], x, y) = (m.azimuth_cos_sin().map(f64::from), f64::from(-wo.x), f64::from(-wo.y));
    let off = (s * x - c * y).abs() / libm::hypot(x, y);
    if m.power() > 0.0 && !(off < 1.2e-7 && c * x + s * y > 0.0) {
        found.fault(format!("wo {wo}: azimuth off by {off:e}"));
    }
}

/// Values and densities of pairs at every count are the truth's, and samples those of the mixtures one by one. Blocks read the rows of
/// the material, so that they round differently from a mixture: the truth bounds both.
fn check_pairs(material: &Material<impl AsRef<[u8]>>, random: &mut Random, found: &mut Findings) {
    let wo: Vec<Vec3> = (0..COUNTS).map(|_| random.direction()).collect();
    let wi: Vec<Vec3> = wo.iter().map(|d| Vec3::new(d.y, d.z, d.x)).collect();
    let u: Vec<Vec3> =
        (0..COUNTS).map(|_| Vec3::new(random.uniform(), random.uniform(), random.uniform())).collect();
    let mut mixtures = vec![Mixture::<64>::empty(); COUNTS];
    for (m, wo) in mixtures.iter_mut().zip(&wo) {
        material.prepare(*wo, m).expect("a unit vector");
    }
    let (wo_arrays, wi_arrays) = (structure_of_arrays(&wo), structure_of_arrays(&wi));
    let u_arrays = structure_of_arrays(&u);
    for n in 0..COUNTS {
        let (wo_in, wi_in, u_in) = (slices(&wo_arrays, n), slices(&wi_arrays, n), slices(&u_arrays, n));
        let (mut out, mut one_channel) = (Guarded::<4>::new(n), Guarded::<2>::new(n));
        let (mut drawn, mut bare) = (Guarded::<7>::new(n), Guarded::<4>::new(n));
        let [r, g, b, pdf] = out.slices();
        let mut written =
            material.ask(wo_in, Towards { wi: wi_in, value: Some([r, g, b]), pdf: Some(pdf) }.into());
        let [pdf, of_mixtures] = one_channel.slices();
        written = written
            .and(material.ask(wo_in, Towards { wi: wi_in, value: None, pdf: Some(pdf) }.into()))
            .and(AnyMixture::ask_each(
                &mixtures[..n],
                Towards { wi: wi_in, value: None, pdf: Some(of_mixtures) }.into(),
            ));
        let [x, y, z, pdf, r, g, b] = drawn.slices();
        let samples = Draws { u: u_in, direction: [x, y, z], pdf: Some(pdf), weight: Some([r, g, b]) };
        written = written.and(material.ask(wo_in, samples.into()));
        let [x, y, z, pdf] = bare.slices();
        written = written.and(
            material.ask(wo_in, Draws { u: u_in, direction: [x, y, z], pdf: Some(pdf), weight: None }.into()),
        );
        let intact = out.is_intact() && one_channel.is_intact() && drawn.is_intact() && bare.is_intact();
        if written.is_err() || !intact {
            found.fault(format!("{n} pairs: {written:?}, or a guard zone was written"));
        }
        for (i, m) in mixtures[..n].iter().enumerate() {
            let place = format!("pair {i} of {n}: wo {}, wi {}, u {}", wo[i], wi[i], u[i]);
            check_azimuth(m, wo[i], found);
            let power = f64::from(m.power());
            if wo[i].z >= 0.0 {
                let want = truth(m, wi[i]);
                for c in 0..3 {
                    found.see("batch value", out.at(c, i), want.value[c], want.scale[c], &place);
                }
                let (value, scale) = (want.luminance(), want.luminance_scale);
                for pdf in [out.at(3, i), one_channel.at(0, i), one_channel.at(1, i)] {
                    found.see("batch pdf", pdf, value / power, scale / power, &place);
                }
            } else if (0..4).any(|c| out.at(c, i) != 0.0) || (0..2).any(|c| one_channel.at(c, i) != 0.0) {
                found.fault(format!("{place}: below the horizon, and not 0"));
            }

            let d = Vec3::new(bare.at(0, i), bare.at(1, i), bare.at(2, i));
            let one = m.sample_direction(u[i].to_array()).unwrap_or(Vec3::Z);
            let whole = Vec3::new(drawn.at(0, i), drawn.at(1, i), drawn.at(2, i));
            if d != whole || d.distance(one) > 4e-6 {
                found.fault(format!("{place}: drawn {d}, with weight {whole}, one by one {one}"));
            }
            if m.power() > 0.0 {
                let want = truth(m, d);
                let (density, scale) = (want.luminance() / power, want.luminance_scale / power);
                found.see("sampled pdf", bare.at(3, i), density, scale, &place);
                found.see("sampled pdf", drawn.at(3, i), density, scale, &place);
            } else if bare.at(3, i) != 0.0 {
                found.fault(format!("{place}: nothing is reflected, and the density is not 0"));
            }
        }
    }
}
