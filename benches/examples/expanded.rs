//! What expanded materials cost and gain: bytes, error and time by the number of rows.
//!
//! `cargo run --release -p srbf-benches --example expanded [LEVEL...] [FILE.srbf...]`, half a minute a level, and ten
//! seconds for each file. Errors are the largest difference from the exact preparation, relative to the largest value for
//! that outgoing direction, over 400 outgoing directions with 400 incident ones each. Times are the least of many rounds of
//! 4096 pairs, each with its own outgoing direction; ratios are to the exact path for pairs (`Material::ask`), round by
//! round in turn with it.

use srbf_benches::{Triples, factored_material, garnet_red, levels, mirror_like};
use srbf_core::{Draws, Expanded, Level, Material, Mixture, Request, Towards, Vec3};
use std::process::ExitCode;
use std::time::Instant;

const PAIRS: usize = 4096;
const ROUNDS: usize = 60;
const ROWS: [usize; 5] = [64, 128, 256, 512, 1024];

fn main() -> ExitCode {
    let (files, names): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.ends_with(".srbf"));
    let is_missing = |name: &&String| Level::from_name(name).is_none_or(|level| !level.is_available());
    if let Some(name) = names.iter().find(is_missing) {
        eprintln!("expanded: no such level here: {name}");
        return ExitCode::from(2);
    }
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
    println!("processor: {}", srbf_core::Processor::this());
    for level in levels().filter(|level| names.is_empty() || names.iter().any(|name| name == level.name())) {
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

    /// Nanoseconds a pair.
    fn time(
        &mut self,
        verb: Verb,
        material: &Material<impl AsRef<[u8]>>,
        expanded: Option<&Expanded<'_>>,
    ) -> f64 {
        let start = Instant::now();
        self.run(verb, material, expanded);
        start.elapsed().as_secs_f64() * 1e9 / PAIRS as f64
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
    println!(
        "{} {name}, {} lobes; ns a pair, and relative to the exact path",
        level.name(),
        material.lobe_count()
    );
    let mut work = Work::new();
    let mut least = vec![[f64::INFINITY; VERBS.len()]; ROWS.len() + 1];
    for _ in 0..ROUNDS {
        for (v, (verb, _)) in VERBS.iter().enumerate() {
            for (i, e) in [None].into_iter().chain(expanded.iter().map(Some)).enumerate() {
                least[i][v] = least[i][v].min(work.time(*verb, material, e));
            }
        }
    }
    let mut head = format!("{:>6} {:>9} {:>9}", "rows", "bytes", "error");
    let mut exact = format!("{:>6} {:>9} {:>9}", "exact", material.bytes().len(), "");
    for (v, (_, name)) in VERBS.iter().enumerate() {
        head += &format!(" {name:>15}");
        exact += &format!(" {:>15.1}", least[0][v]);
    }
    println!("{head}\n{exact}");
    for (i, e) in expanded.iter().enumerate() {
        let mut line =
            format!("{:>6} {:>9} {:>9.1e}", ROWS[i], 4 * material.expanded_len(ROWS[i]), error(material, e));
        for (time, exact) in least[i + 1].iter().zip(&least[0]) {
            line += &format!(" {time:>8.1} ({:.2})", time / exact);
        }
        println!("{line}");
    }
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
