//! The cost of a hit on a sheet beside one on a material of as many lobes.
//!
//! `cargo run --release -p srbf-benches --example sheets [LEVEL...]`. Two presets are reflection and transmission of a sheet, whose back is like
//! its front. Light lies on either side. Times are the least of many rounds in which all ways take turns, in nanoseconds a hit.

use srbf_benches::harness::{Table, arguments, least_of, levels_of};
use srbf_benches::{Triples, whole_request};
use srbf_core::{Material, Sheet};
use std::hint::black_box;
use std::process::ExitCode;

const HITS: usize = 4096;
const BATCH: usize = 256;
const ROUNDS: usize = 200;

const WAYS: [&str; 4] = ["draw", "value and density", "both", "both, in requests of 256"];

fn main() -> ExitCode {
    let levels = match levels_of("sheets", &arguments()) {
        Ok(levels) => levels,
        Err(status) => return status,
    };
    let [reflection, transmission] = [
        &include_bytes!("../../presets/garnet_red.srbf")[..],
        include_bytes!("../../presets/krylon_blue.srbf"),
    ]
    .map(|bytes| Material::from_bytes(bytes).expect("a preset"));
    let quarters = [Some(&reflection), Some(&transmission), None, None];
    let mut bytes = vec![0; Sheet::encoded_len(quarters, "")];
    Sheet::encode(quarters, true, "", &mut bytes).expect("two materials");
    let sheet = Sheet::from_bytes(&bytes[..]).expect("a sheet");

    let (wo, u) = (Triples::directions(HITS, 1), Triples::uniforms(HITS, 3));
    let above = Triples::directions(HITS, 2);
    // Every other light is behind.
    let mut wi = Triples::directions(HITS, 2);
    wi.0[2].iter_mut().step_by(2).for_each(|z| *z = -*z);
    let mut out = [(); 11].map(|()| vec![0.0f32; HITS]);
    for level in levels {
        level.set().expect("an available level");
        let times = least_of(ROUNDS, 2 * WAYS.len(), HITS, |way| {
            let is_sheet = way >= WAYS.len();
            let mut sum = 0.0;
            match way % WAYS.len() {
                0 => (0..HITS).for_each(|i| {
                    let sample = if is_sheet {
                        sheet.sample(wo.at(i), u.at(i).to_array())
                    } else {
                        reflection.sample(wo.at(i), u.at(i).to_array())
                    };
                    sum += sample.map_or(0.0, |sample| sample.pdf);
                }),
                1 => (0..HITS).for_each(|i| {
                    sum += if is_sheet {
                        sheet.evaluate_and_pdf(wo.at(i), wi.at(i)).1
                    } else {
                        reflection.evaluate_and_pdf(wo.at(i), above.at(i)).1
                    };
                }),
                2 => (0..HITS).for_each(|i| {
                    sum += if is_sheet {
                        sheet.sample_and_evaluate(wo.at(i), u.at(i).to_array(), wi.at(i)).1.1
                    } else {
                        reflection.sample_and_evaluate(wo.at(i), u.at(i).to_array(), above.at(i)).1.1
                    };
                }),
                _ => (0..HITS).step_by(BATCH).for_each(|from| {
                    let part = from..from + BATCH;
                    let lights = if is_sheet { &wi } else { &above };
                    let request = whole_request(&u, lights, &mut out, part.clone());
                    let wo = wo.part(part);
                    let asked = if is_sheet { sheet.ask(wo, request) } else { reflection.ask(wo, request) };
                    asked.expect("slices of one length");
                }),
            }
            black_box(sum);
        });
        let mut table = Table::new(&format!("{}, ns a hit", level.name()), ["material", "sheet", "ratio"]);
        for (n, name) in WAYS.iter().enumerate() {
            let (material, sheet) = (times[n], times[n + WAYS.len()]);
            table.row(
                name,
                [format!("{material:.1}"), format!("{sheet:.1}"), format!("{:.2}", sheet / material)],
            );
        }
        table.print();
    }
    ExitCode::SUCCESS
}
