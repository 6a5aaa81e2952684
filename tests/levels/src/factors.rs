//! A material with factors: every way to a value gives that of the lobes times the factor of the definition, in f64.

use crate::findings::Findings;
use crate::inputs::{self, Random};
use crate::outputs::{COUNTS, Guarded, slices, structure_of_arrays};
use alloc::format;
use alloc::vec::Vec;
use srbf_core::{Draws, Material, Mixture, Towards, Vec3};

const NAME: &str = "factored value";

/// The factor of a pair of directions above the horizon, from the nodes.
fn truth(material: &Material<impl AsRef<[u8]>>, wo: Vec3, wi: Vec3) -> [f64; 3] {
    let [half, difference, azimuth] = material.factor_nodes().expect("a table");
    let ([ox, oy, oz], [ix, iy, iz]) = (wo.to_array().map(f64::from), wi.to_array().map(f64::from));
    let (x, y, z) = (ix + ox, iy + oy, iz + oz);
    let length = libm::sqrt(x * x + y * y + z * z);
    let across = (x * x + y * y) / (length * length);
    let a = libm::pow((x * x + y * y) / (length * (length + z)), 0.25) * (half - 1) as f64;
    let (x, y, z) = (ix - ox, iy - oy, iz - oz);
    let b = libm::sqrt((x * x + y * y + z * z) / (4.0 + 2.0 * length)) * (difference - 1) as f64;
    let c = (z * z / ((x * x + y * y + z * z) * across).max(1e-300)).min(1.0);
    let c =
        if material.has_signed_factors() { 0.5 + (0.5 * c).copysign(z) } else { c } * (azimuth - 1) as f64;
    let (i, j) = ((a as usize).min(half - 2), (b as usize).min(difference - 2));
    let k = (c as usize).min(azimuth.saturating_sub(2));
    let (a, b, c) = (a - i as f64, b - j as f64, c - k as f64);
    [0, 1, 2].map(|channel| {
        let node = |i, j, k| f64::from(material.factor_node(i, j, k).expect("a node")[channel]);
        let plane = |k| {
            (node(i, j, k) * (1.0 - a) + node(i + 1, j, k) * a) * (1.0 - b)
                + (node(i, j + 1, k) * (1.0 - a) + node(i + 1, j + 1, k) * a) * b
        };
        if azimuth == 1 { plane(0) } else { plane(k) * (1.0 - c) + plane(k + 1) * c }
    })
}

/// Checks one value, given that of the lobes alone.
fn see(
    found: &mut Findings,
    material: &Material<impl AsRef<[u8]>>,
    [wo, wi]: [Vec3; 2],
    got: Vec3,
    lobes: Vec3,
) {
    if wi.z < 0.0 || wo.z < 0.0 {
        if got != Vec3::ZERO {
            found.fault(format!("wo {wo}, wi {wi}: below the horizon {got}"));
        }
        return;
    }
    let (factor, largest) = (truth(material, wo, wi), f64::from(material.largest_factor()));
    for c in 0..3 {
        let (want, scale) = (factor[c] * f64::from(lobes[c]), largest * f64::from(lobes[c].abs()));
        found.see(NAME, got[c], want, scale, &format!("wo {wo}, wi {wi}"));
    }
}

/// Batches, samples and single calls of mixtures, and pairs; of a table over three variables, of a signed one, and of one over two.
pub fn check(random: &mut Random, found: &mut Findings) {
    let [bytes, signed, flat, bare] = inputs::factored(random);
    for bytes in [&bytes, &signed, &flat] {
        check_material(bytes, &bare, random, found);
    }
}

fn check_material(bytes: &[u8], bare: &[u8], random: &mut Random, found: &mut Findings) {
    let [material, bare] = [bytes, bare].map(|bytes| Material::from_bytes(bytes).expect("a valid material"));
    let wo: Vec<Vec3> = (0..COUNTS).map(|_| random.direction()).collect();
    let wi: Vec<Vec3> = (0..COUNTS).map(|_| random.direction()).collect();
    let (wo_arrays, wi_arrays) = (structure_of_arrays(&wo), structure_of_arrays(&wi));
    for (n, wo) in wo.iter().enumerate() {
        let (mut m, mut lobes) = (Mixture::<64>::empty(), Mixture::<64>::empty());
        material.prepare(*wo, &mut m).and(bare.prepare(*wo, &mut lobes)).expect("a unit vector");
        let (mut out, mut plain) = (Guarded::<3>::new(n), Guarded::<3>::new(n));
        let (mut both, mut plain_both) = (Guarded::<4>::new(n), Guarded::<4>::new(n));
        let inputs = slices(&wi_arrays, n);
        let mut written = m
            .ask(Towards { wi: inputs, value: Some(out.slices()), pdf: None }.into())
            .and(lobes.ask(Towards { wi: inputs, value: Some(plain.slices()), pdf: None }.into()));
        for (m, both) in [(&m, &mut both), (&lobes, &mut plain_both)] {
            let [r, g, b, pdf] = both.slices();
            written =
                written.and(m.ask(Towards { wi: inputs, value: Some([r, g, b]), pdf: Some(pdf) }.into()));
        }
        if written.is_err() || !out.is_intact() || !both.is_intact() {
            found.fault(format!("{n} values with factors: {written:?}, or a guard zone was written"));
        }
        for (i, wi) in wi[..n].iter().enumerate() {
            let vector = |from: &Guarded<3>| Vec3::new(from.at(0, i), from.at(1, i), from.at(2, i));
            see(found, &material, [*wo, *wi], vector(&out), vector(&plain));
            see(found, &material, [*wo, *wi], m.evaluate(*wi), lobes.evaluate(*wi));
            let together = m.evaluate_and_pdf(*wi);
            let same_value = (0..3).all(|c| both.at(c, i) == out.at(c, i));
            let same_density = both.at(3, i) == plain_both.at(3, i);
            if !same_value || !same_density || together != (m.evaluate(*wi), lobes.evaluate_and_pdf(*wi).1) {
                found.fault(format!("wo {wo}, wi {wi}: another value beside the density, or {together:?}"));
            }
        }
        check_samples(&material, *wo, [&m, &lobes], random, found);
    }
    for n in 0..COUNTS {
        let (mut out, mut plain, mut alone) =
            (Guarded::<4>::new(n), Guarded::<4>::new(n), Guarded::<3>::new(n));
        let (wo_in, wi_in) = (slices(&wo_arrays, n), slices(&wi_arrays, n));
        let mut written = Ok(());
        for (material, out) in [(&material, &mut out), (&bare, &mut plain)] {
            let [r, g, b, pdf] = out.slices();
            written = written.and(
                material.ask(wo_in, Towards { wi: wi_in, value: Some([r, g, b]), pdf: Some(pdf) }.into()),
            );
        }
        written = written
            .and(material.ask(wo_in, Towards { wi: wi_in, value: Some(alone.slices()), pdf: None }.into()));
        if written.is_err() || !out.is_intact() || !alone.is_intact() {
            found.fault(format!("{n} pairs with factors: {written:?}, or a guard zone was written"));
        }
        for i in 0..n {
            let vector = |from: &Guarded<4>| Vec3::new(from.at(0, i), from.at(1, i), from.at(2, i));
            see(found, &material, [wo[i], wi[i]], vector(&out), vector(&plain));
            if (0..3).any(|c| alone.at(c, i) != out.at(c, i)) || out.at(3, i) != plain.at(3, i) {
                found.fault(format!("pair {i} of {n}: another value beside the density, or another density"));
            }
        }
    }
}

/// Samples are those of the lobes, their weights times the factor.
fn check_samples(
    material: &Material<impl AsRef<[u8]>>,
    wo: Vec3,
    [m, lobes]: [&Mixture<'_, 64>; 2],
    random: &mut Random,
    found: &mut Findings,
) {
    let n = COUNTS - 3;
    let u: Vec<Vec3> =
        (0..n).map(|_| Vec3::new(random.uniform(), random.uniform(), random.uniform())).collect();
    let arrays = structure_of_arrays(&u);
    let (mut out, mut plain) = (Guarded::<7>::new(n), Guarded::<7>::new(n));
    for (m, out) in [(m, &mut out), (lobes, &mut plain)] {
        let [x, y, z, pdf, r, g, b] = out.slices();
        let samples =
            Draws { u: slices(&arrays, n), direction: [x, y, z], pdf: Some(pdf), weight: Some([r, g, b]) };
        if m.ask(samples.into()).is_err() || !out.is_intact() {
            found.fault(format!("wo {wo}: samples with factors, or a guard zone was written"));
        }
    }
    for (i, u) in u.iter().enumerate() {
        let vector =
            |from: &Guarded<7>, at: usize| Vec3::new(from.at(at, i), from.at(at + 1, i), from.at(at + 2, i));
        let d = vector(&out, 0);
        if d != vector(&plain, 0) || out.at(3, i) != plain.at(3, i) {
            found.fault(format!("wo {wo}, sample {i}: another draw or density than of the lobes"));
        }
        see(found, material, [wo, d], vector(&out, 4), vector(&plain, 4));
        match (m.sample(u.to_array()), lobes.sample(u.to_array())) {
            (Some(got), Some(want)) if (got.direction, got.pdf) == (want.direction, want.pdf) => {
                see(found, material, [wo, got.direction], got.weight * got.pdf, want.weight * want.pdf);
            }
            (None, None) => {}
            (got, want) => found.fault(format!("wo {wo}, sample {i}: {got:?}, of the lobes {want:?}")),
        }
    }
}
