//! The cost of a hit on an anisotropic material beside one on an isotropic material of as many lobes.
//!
//! `cargo run --release -p srbf-benches --example turns [LEVEL...]`. Both are the garnet red preset, one of them as a brushed surface, with
//! numbers of 32 bits and in codes of 8. Times are the least of many rounds in which all ways take turns, in nanoseconds a hit.

use srbf_benches::harness::{Table, arguments, least_of, levels_of};
use srbf_benches::{Triples, brushed_material, garnet_red, packed, packed_material, whole_request};
use srbf_core::{Level, Material, Mixture};
use std::hint::black_box;
use std::process::ExitCode;

const HITS: usize = 4096;
const ROUNDS: usize = 100;

/// The work of a hit.
const WAYS: [&str; 9] = [
    "prepare",
    "draw",
    "value and density",
    "both",
    "mixture, both",
    "prepare, 16 at once",
    "requests of 16, both",
    "of 256, both",
    "of 256, value and density",
];

fn main() -> ExitCode {
    let levels = match levels_of("turns", &arguments()) {
        Ok(levels) => levels,
        Err(status) => return status,
    };
    let (isotropic, packed_isotropic, brushed) = (garnet_red(), packed_material(), brushed_material());
    let bytes = packed(brushed).leak();
    let packed_brushed: &'static Material =
        Box::leak(Box::new(Material::from_bytes(&*bytes).expect("valid")));
    for level in levels {
        table(level, "", [isotropic, brushed]);
        table(level, ", in codes", [packed_isotropic, packed_brushed]);
    }
    ExitCode::SUCCESS
}

/// Prints the times of a pair of materials.
fn table(level: Level, form: &str, materials: [&'static Material; 2]) {
    level.set().expect("an available level");
    let (wo, wi, u) =
        (Triples::directions(HITS, 1), Triples::directions(HITS, 2), Triples::uniforms(HITS, 3));
    let mut out = [(); 11].map(|()| vec![0.0f32; HITS]);
    let mut mixture = Mixture::<16>::empty();
    let mut mixtures = vec![Mixture::<16>::empty(); 16];
    let times = least_of(ROUNDS, 2 * WAYS.len(), HITS, |way| {
        let material = materials[way % 2];
        let mut sum = 0.0;
        match way / 2 {
            0 => (0..HITS).for_each(|i| {
                material.prepare(wo.at(i), &mut mixture).expect("a direction");
                sum += mixture.power();
            }),
            1 => (0..HITS).for_each(|i| {
                sum += material.sample(wo.at(i), u.at(i).to_array()).map_or(0.0, |sample| sample.pdf);
            }),
            2 => (0..HITS).for_each(|i| sum += material.evaluate_and_pdf(wo.at(i), wi.at(i)).1),
            3 => (0..HITS).for_each(|i| {
                sum += material.sample_and_evaluate(wo.at(i), u.at(i).to_array(), wi.at(i)).1.1;
            }),
            4 => (0..HITS).for_each(|i| {
                material.prepare(wo.at(i), &mut mixture).expect("a direction");
                sum += mixture.sample_and_evaluate(u.at(i).to_array(), wi.at(i)).1.1;
            }),
            5 => (0..HITS).step_by(16).for_each(|from| {
                let wo = wo.0.each_ref().map(|s| &s[from..from + 16]);
                material.prepare_into(wo, &mut mixtures).expect("as many mixtures");
                sum += mixtures[0].power();
            }),
            way => {
                let batch = if way == 6 { 16 } else { 256 };
                (0..HITS).step_by(batch).for_each(|from| {
                    let part = from..from + batch;
                    let mut request = whole_request(&u, &wi, &mut out, part.clone());
                    request.draw = request.draw.filter(|_| way < 8);
                    material.ask(wo.part(part), request).expect("slices of one length");
                });
            }
        }
        black_box(sum);
    });
    let title = format!("{}{form}, ns a hit", level.name());
    let mut table = Table::new(&title, ["isotropic", "anisotropic", "ratio"]);
    for (n, name) in WAYS.iter().enumerate() {
        let (one, other) = (times[2 * n], times[2 * n + 1]);
        table.row(name, [format!("{one:.1}"), format!("{other:.1}"), format!("{:.2}", other / one)]);
    }
    table.print();
}
