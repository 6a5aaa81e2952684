//! What expanded materials cost and gain: bytes, error and time by the number of rows.
//!
//! `cargo run --release -p srbf-benches --example expanded [LEVEL...] [FILE.srbf...]`, half a minute a level, and ten
//! seconds for each file. Errors are the largest difference from the exact preparation, relative to the largest value for
//! that outgoing direction, over 400 outgoing directions with 400 incident ones each. Times are the least of many rounds of
//! 4096 pairs, each with its own outgoing direction; ratios are to the exact path for pairs (`Material::ask`), round by
//! round in turn with it.

use srbf_benches::harness::{Table, arguments, least_of, levels_of};
use srbf_benches::{Triples, factored_material, garnet_red, mirror_like};
use srbf_core::{Draws, Expanded, Level, Material, Mixture, Request, Towards, Vec3};
use std::process::ExitCode;

const PAIRS: usize = 4096;
const ROUNDS: usize = 60;
const ROWS: [usize; 5] = [64, 128, 256, 512, 1024];

fn main() -> ExitCode {
    let (files, names): (Vec<String>, Vec<String>) =
        arguments().into_iter().partition(|argument| argument.ends_with(".srbf"));
    let levels = match levels_of("expanded", &names) {
        Ok(levels) => levels,
        Err(status) => return status,
    };
    let mut materials = vec![
        ("garnet red".to_string(), garnet_red().bytes().to_vec()),
        ("garnet red with factors".to_string(), factored_material().bytes().to_vec()),
        ("mirror-like".to_string(), mirror_like()),
    ];
    for file in files {
        match std::fs::read(&file) {
            Ok(bytes) => materials.push((file, bytes)),
            Err(error) => {
                eprintln!("expanded: {file}: {error}");
                return ExitCode::from(2);
            }
        }
    }
    for level in levels {
        level.set().expect("an available level");
        for (name, bytes) in &materials {
            match Material::from_bytes(bytes) {
                Ok(material) => report(level, name, &material),
                Err(error) => {
                    eprintln!("expanded: {name}: {error}");
                    return ExitCode::from(2);
                }
            }
        }
    }
    ExitCode::SUCCESS
}

/// The timed call: of the exact path, or of an expanded material.
#[derive(Clone, Copy, PartialEq)]
enum Verb {
    Sample,
    Evaluate,
    Pdf,
    SampleAndEvaluate,
    Prepare,
}

const VERBS: [(Verb, &str); 5] = [
    (Verb::Sample, "sample"),
    (Verb::Evaluate, "value+pdf"),
    (Verb::Pdf, "pdf"),
    (Verb::SampleAndEvaluate, "sample+towards"),
    (Verb::Prepare, "prepare one"),
];

struct Work {
    wo: Triples,
    wi: Triples,
    u: Triples,
    out: [Vec<f32>; 11],
}

impl Work {
    fn new() -> Self {
        Self {
            wo: Triples::directions(PAIRS, 1),
            wi: Triples::directions(PAIRS, 3),
            u: Triples::uniforms(PAIRS, 2),
            out: [(); 11].map(|()| vec![0.0; PAIRS]),
        }
    }

    fn run(&mut self, verb: Verb, material: &Material<impl AsRef<[u8]>>, expanded: Option<&Expanded<'_>>) {
        let (wo, wi, u) = (self.wo.slices(), self.wi.slices(), self.u.slices());
        let [x, y, z, pdf, red, green, blue, r, g, b, p] = &mut self.out;
        let draw = Draws { u, direction: [x, y, z], pdf: Some(pdf), weight: Some([red, green, blue]) };
        let mut towards = Towards { wi, value: Some([r, g, b]), pdf: Some(p) };
        let ask = |request| match expanded {
            Some(expanded) => expanded.ask(wo, request),
            None => material.ask(wo, request),
        };
        match verb {
            Verb::Sample => ask(draw.into()),
            Verb::Evaluate => ask(towards.into()),
            Verb::Pdf => {
                towards.value = None;
                ask(towards.into())
            }
            Verb::SampleAndEvaluate => ask(Request { draw: Some(draw), evaluate: Some(towards) }),
            Verb::Prepare => {
                let (p, mut mixture) = (&mut self.out[10], Mixture::<16>::empty());
                (0..PAIRS).try_for_each(|i| {
                    match expanded {
                        Some(e) => e.prepare(self.wo.at(i), &mut mixture)?,
                        None => material.prepare(self.wo.at(i), &mut mixture)?,
                    }
                    p[i] = mixture.power();
                    Ok(())
                })
            }
        }
        .expect("equal lengths");
    }
}

fn report(level: Level, name: &str, material: &Material<impl AsRef<[u8]>>) {
    let mut memory: Vec<Vec<f32>> = ROWS.map(|rows| vec![0.0; material.expanded_len(rows)]).into();
    let expanded: Vec<Expanded<'_>> = ROWS
        .iter()
        .zip(&mut memory)
        .map(|(&rows, memory)| Expanded::new(material, rows, memory).expect("an isotropic material"))
        .collect();
    let (mut work, ways) = (Work::new(), ROWS.len() + 1);
    // The exact path, then each expanded material; for each verb.
    let least = least_of(ROUNDS, ways * VERBS.len(), PAIRS, |way| {
        let expanded = (way % ways).checked_sub(1).map(|row| &expanded[row]);
        work.run(VERBS[way / ways].0, material, expanded);
    });
    let title = format!("{} {name}, {} lobes; ns a pair; rows", level.name(), material.lobe_count());
    let mut table = Table::new(&title, ["bytes", "error"].into_iter().chain(VERBS.map(|(_, name)| name)));
    let times = |row: usize| {
        let least = &least;
        (0..VERBS.len()).map(move |verb| {
            let (ns, exact) = (least[verb * ways + row], least[verb * ways]);
            if row == 0 { format!("{ns:.1}") } else { format!("{ns:.1} ({:.2})", ns / exact) }
        })
    };
    table.row("exact", [material.bytes().len().to_string(), String::new()].into_iter().chain(times(0)));
    for (i, e) in expanded.iter().enumerate() {
        let bytes = 4 * material.expanded_len(ROWS[i]);
        let cells = [bytes.to_string(), format!("{:.1e}", error(material, e))];
        table.row(&ROWS[i].to_string(), cells.into_iter().chain(times(i + 1)));
    }
    table.print();
}

/// Largest difference from the exact preparation, relative to the largest value for that outgoing direction.
fn error(material: &Material<impl AsRef<[u8]>>, expanded: &Expanded<'_>) -> f32 {
    const EACH: usize = 400;
    let (outgoing, uniform) = (Triples::directions(EACH, 7), Triples::uniforms(EACH, 8));
    let (mut exact, mut between) = (Mixture::<64>::empty(), Mixture::<64>::empty());
    let mut worst = 0f32;
    for i in 0..EACH {
        material.prepare(outgoing.at(i), &mut exact).expect("a direction");
        expanded.prepare(outgoing.at(i), &mut between).expect("a direction");
        let towards: Vec<Vec3> =
            (0..EACH).filter_map(|j| exact.sample_direction(uniform.at(j).to_array())).collect();
        let values: Vec<Vec3> = towards.iter().map(|&d| exact.evaluate(d)).collect();
        let peak = values.iter().map(|v| v.max_element()).fold(0.0, f32::max);
        for (&d, &value) in towards.iter().zip(&values) {
            worst = worst.max((between.evaluate(d) - value).abs().max_element() / peak);
        }
    }
    worst
}
