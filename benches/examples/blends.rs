//! The cost of a hit on a blend of 1 to 4 materials beside one on a material alone.
//!
//! `cargo run --release -p srbf-benches --example blends [LEVEL...]`. No two parts are alike, and their weights are the same. Times are the least
//! of many rounds in which all ways take turns, in multiples of the material's own.

use srbf_benches::harness::{Table, arguments, least_of, levels_of};
use srbf_benches::{Triples, whole_request};
use srbf_core::{Blend, BlendPart, Error, Material, Mixture};
use std::hint::black_box;
use std::process::ExitCode;

const HITS: usize = 2048;
const BATCH: usize = 256;
const ROUNDS: usize = 100;

const WAYS: [&str; 6] = [
    "draw",
    "value and density",
    "both",
    "both, of mixtures that are there",
    "both, of one chosen at random",
    "both, in requests of 256",
];

/// The material alone, and blends of 1 to 4.
const COLUMNS: usize = 5;

fn main() -> ExitCode {
    let levels = match levels_of("blends", &arguments()) {
        Ok(levels) => levels,
        Err(status) => return status,
    };
    let materials = [
        &include_bytes!("../../presets/garnet_red.srbf")[..],
        include_bytes!("../../presets/krylon_blue.srbf"),
        include_bytes!("../../presets/cayman.srbf"),
        include_bytes!("../../presets/garnet_red.srbf"),
    ]
    .map(|bytes| Material::from_bytes(bytes).expect("a preset"));
    let alone = &materials[0];
    let (wo, u, wi) =
        (Triples::directions(HITS, 1), Triples::uniforms(HITS, 3), Triples::directions(HITS, 2));
    let mut out = [(); 11].map(|()| vec![0.0f32; HITS]);
    for level in levels {
        level.set().expect("an available level");
        let mut mixtures = [(); 4].map(|()| Mixture::<16>::empty());
        for (material, mixture) in materials.iter().zip(&mut mixtures) {
            material.prepare(wo.at(0), mixture).expect("a direction, and room");
        }
        let times = least_of(ROUNDS, COLUMNS * WAYS.len(), HITS, |way| {
            let (row, count) = (way / COLUMNS, way % COLUMNS);
            let weight = 1.0 / count.max(1) as f32;
            // Black where the column is of fewer.
            let part = |k: usize| BlendPart::new(&materials[k], if k < count { weight } else { 0.0 });
            let mixed = |k: usize| BlendPart::of_mixture(&mixtures[k], if k < count { weight } else { 0.0 });
            let hit = |i: usize| (wo.at(i), u.at(i).to_array(), wi.at(i));
            let mut sum = 0.0;
            match row {
                0..=2 => (0..HITS).for_each(|i| {
                    let (wo, u, wi) = hit(i);
                    let parts = [part(0), part(1), part(2), part(3)];
                    let blend = (count > 0).then(|| Blend::new(&parts).expect("sound weights"));
                    sum += match (row, blend) {
                        (0, Some(blend)) => blend.sample(wo, u).map_or(0.0, |sample| sample.pdf),
                        (0, None) => alone.sample(wo, u).map_or(0.0, |sample| sample.pdf),
                        (1, Some(blend)) => blend.evaluate_and_pdf(wo, wi).1,
                        (1, None) => alone.evaluate_and_pdf(wo, wi).1,
                        (_, Some(blend)) => blend.sample_and_evaluate(wo, u, wi).1.1,
                        (_, None) => alone.sample_and_evaluate(wo, u, wi).1.1,
                    };
                }),
                3 => (0..HITS).for_each(|i| {
                    let (wo, u, wi) = hit(i);
                    let parts = [mixed(0), mixed(1), mixed(2), mixed(3)];
                    sum += match count {
                        0 => mixtures[0].sample_and_evaluate(u, wi).1.1,
                        _ => Blend::new(&parts).expect("sound weights").sample_and_evaluate(wo, u, wi).1.1,
                    };
                }),
                4 => (0..HITS).for_each(|i| {
                    let (wo, u, wi) = hit(i);
                    let parts = [part(0), part(1), part(2), part(3)];
                    sum += match count {
                        0 => alone.sample_and_evaluate(wo, u, wi).1.1,
                        _ => {
                            let blend = Blend::new(&parts).expect("sound weights");
                            let (_, part, left) = blend.choose(u[0]);
                            let one = [part];
                            let one = Blend::new(&one).expect("sound weights");
                            one.sample_and_evaluate(wo, [left, u[1], u[2]], wi).1.1
                        }
                    };
                }),
                _ => (0..HITS).step_by(BATCH).for_each(|from| {
                    let range = from..from + BATCH;
                    let request = whole_request(&u, &wi, &mut out, range.clone());
                    let wo = wo.part(range);
                    let parts = [part(0), part(1), part(2), part(3)];
                    let asked: Result<(), Error> = match count {
                        0 => alone.ask(wo, request),
                        _ => Blend::new(&parts).and_then(|blend| blend.ask(wo, request)),
                    };
                    asked.expect("slices of one length");
                }),
            }
            black_box(sum);
        });
        let title = format!("{}, multiples of a material", level.name());
        let mut table = Table::new(&title, ["material, ns", "1", "2", "3", "4"]);
        for (row, name) in WAYS.iter().enumerate() {
            let own = times[row * COLUMNS];
            let ratio = |count: usize| format!("{:.2}", times[row * COLUMNS + count] / own);
            table.row(name, [format!("{own:.1}"), ratio(1), ratio(2), ratio(3), ratio(4)]);
        }
        table.print();
    }
    ExitCode::SUCCESS
}
