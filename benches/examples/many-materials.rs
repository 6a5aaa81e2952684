//! The cost of a hit in a scene of many materials: one, ten, thirty, a hundred, a thousand, no two alike.
//!
//! `cargo run --release -p srbf-benches --example many-materials [LEVEL...]`, half a minute a level. A hit draws a direction with its
//! density and weight, and evaluates value and density towards another one. Each of 4096 hits has an outgoing direction of its own;
//! its material is drawn at random, or (*sorted*) the same for runs of 256. Times are the least of many rounds in which all ways take
//! turns, in nanoseconds of this thread's time a hit.

use srbf_benches::ggx::Ggx;
use srbf_benches::harness::{Table, arguments, least_of, levels_of};
use srbf_benches::{Random, Triples, different_materials, packed};
use srbf_core::{Draws, Level, Material, Mixture, Request, Towards};
use std::hint::black_box;
use std::process::ExitCode;

const HITS: usize = 4096;
const RUN: usize = 256;
const ROUNDS: usize = 120;
const COUNTS: [usize; 5] = [1, 10, 30, 100, 1000];

fn main() -> ExitCode {
    let levels = match levels_of("many-materials", &arguments()) {
        Ok(levels) => levels,
        Err(status) => return status,
    };
    let bytes = different_materials(COUNTS[COUNTS.len() - 1]);
    let materials = of_bytes(&bytes);
    let packed: Vec<Vec<u8>> = materials.iter().map(packed).collect();
    let packed = of_bytes(&packed);
    for level in levels {
        level.set().expect("an available level");
        report(level, &materials, &packed);
    }
    memory(&materials, &packed);
    ExitCode::SUCCESS
}

fn of_bytes(bytes: &[Vec<u8>]) -> Vec<Material<&[u8]>> {
    bytes.iter().map(|bytes| Material::from_bytes(&bytes[..]).expect("a valid material")).collect()
}

/// The work on all hits.
#[derive(Clone, Copy)]
enum Way {
    Prepared,
    Asked,
    Ggx,
    EvaluatePrepared,
    EvaluateAsked,
    EvaluateGgx,
    Sorted,
    SortedOneByOne,
    Batch,
    AskedPacked,
    BatchPacked,
    BatchOfOne,
    BatchOfEight,
}

const WAYS: [(Way, &str); 13] = [
    (Way::Prepared, "mixture: prepared and asked"),
    (Way::Asked, "material asked"),
    (Way::Ggx, "GGX and diffuse, C"),
    (Way::EvaluatePrepared, "value and density alone: mixture"),
    (Way::EvaluateAsked, "value and density alone: material"),
    (Way::EvaluateGgx, "value and density alone: GGX, C"),
    (Way::SortedOneByOne, "sorted, material asked one by one"),
    (Way::Sorted, "sorted, batches of 256"),
    (Way::Batch, "not sorted, batches of 256"),
    (Way::AskedPacked, "codes of 8 bits, asked"),
    (Way::BatchPacked, "codes of 8 bits, not sorted, batches of 256"),
    (Way::BatchOfOne, "sorted, batches of 1"),
    (Way::BatchOfEight, "sorted, batches of 8"),
];

struct Work {
    wo: Triples,
    wi: Triples,
    u: Triples,
    out: [Vec<f32>; 11],
    ggx: Vec<Ggx>,
}

fn report(level: Level, materials: &[Material<&[u8]>], packed: &[Material<&[u8]>]) {
    let mut random = Random(5);
    let mut work = Work {
        wo: Triples::directions(HITS, 1),
        wi: Triples::directions(HITS, 2),
        u: Triples::uniforms(HITS, 3),
        out: [(); 11].map(|()| vec![0.0; HITS]),
        ggx: (0..materials.len())
            .map(|_| Ggx {
                diffuse: [random.uniform(); 3],
                specular: [random.uniform(); 3],
                alpha: 0.1 + 0.4 * random.uniform(),
                share: 0.5,
            })
            .collect(),
    };
    let mut times = Vec::new();
    for count in COUNTS {
        let at_random: Vec<usize> =
            (0..HITS).map(|_| (random.uniform() * count as f32) as usize % count).collect();
        let sorted: Vec<usize> = (0..HITS).map(|i| at_random[i / RUN * RUN]).collect();
        let each: Vec<_> = at_random.iter().map(|&m| &materials[m]).collect();
        let each_packed: Vec<_> = at_random.iter().map(|&m| &packed[m]).collect();
        times.push(least_of(ROUNDS, WAYS.len(), HITS, |way| {
            let way = WAYS[way].0;
            let is_packed = matches!(way, Way::AskedPacked | Way::BatchPacked);
            let (materials, each) = if is_packed { (packed, &each_packed) } else { (materials, &each) };
            work.run(way, materials, &at_random, &sorted, each);
        }));
    }
    let mut table = counted(&format!("{}, ns a hit; materials", level.name()));
    for (row, (_, name)) in WAYS.iter().enumerate() {
        table.row(name, times.iter().map(|times| format!("{:.1}", times[row])));
    }
    table.print();
}

/// A table with a column for each number of materials.
fn counted(title: &str) -> Table {
    Table::new(title, COUNTS.map(|n| n.to_string()))
}

impl Work {
    fn run(
        &mut self,
        way: Way,
        materials: &[Material<&[u8]>],
        at_random: &[usize],
        sorted: &[usize],
        each: &[&Material<&[u8]>],
    ) {
        let Self { wo, wi, u, out, ggx } = self;
        let mut sum = 0.0;
        match way {
            Way::Prepared => {
                let mut m = Mixture::<16>::empty();
                for (i, &k) in at_random.iter().enumerate() {
                    materials[k].prepare(wo.at(i), &mut m).expect("a direction");
                    let (sample, (_, pdf)) = m.sample_and_evaluate(u.at(i).to_array(), wi.at(i));
                    sum += sample.map_or(0.0, |s| s.pdf) + pdf;
                }
            }
            Way::Asked | Way::AskedPacked => {
                for (i, &k) in at_random.iter().enumerate() {
                    let (sample, (_, pdf)) =
                        materials[k].sample_and_evaluate(wo.at(i), u.at(i).to_array(), wi.at(i));
                    sum += sample.map_or(0.0, |s| s.pdf) + pdf;
                }
            }
            Way::Ggx => {
                for (i, &k) in at_random.iter().enumerate() {
                    let wo = wo.at(i).to_array();
                    let (_, weight, pdf) = ggx[k].sample(wo, u.at(i).to_array());
                    sum += weight[0] + pdf + ggx[k].evaluate_and_pdf(wo, wi.at(i).to_array()).1;
                }
            }
            Way::EvaluatePrepared => {
                let mut m = Mixture::<16>::empty();
                for (i, &k) in at_random.iter().enumerate() {
                    materials[k].prepare(wo.at(i), &mut m).expect("a direction");
                    sum += m.evaluate_and_pdf(wi.at(i)).1;
                }
            }
            Way::EvaluateAsked => {
                for (i, &k) in at_random.iter().enumerate() {
                    sum += materials[k].evaluate_and_pdf(wo.at(i), wi.at(i)).1;
                }
            }
            Way::EvaluateGgx => {
                for (i, &k) in at_random.iter().enumerate() {
                    sum += ggx[k].evaluate_and_pdf(wo.at(i).to_array(), wi.at(i).to_array()).1;
                }
            }
            Way::SortedOneByOne => {
                for (i, &k) in sorted.iter().enumerate() {
                    let (sample, (_, pdf)) =
                        materials[k].sample_and_evaluate(wo.at(i), u.at(i).to_array(), wi.at(i));
                    sum += sample.map_or(0.0, |s| s.pdf) + pdf;
                }
            }
            Way::Sorted | Way::BatchOfOne | Way::BatchOfEight => {
                let run = match way {
                    Way::Sorted => RUN,
                    Way::BatchOfOne => 1,
                    _ => 8,
                };
                for from in (0..HITS).step_by(run) {
                    let range = from..from + run;
                    let [wo, wi, u] = [&*wo, wi, u].map(|t| t.slices().map(|s| &s[range.clone()]));
                    let out = out.each_mut().map(|s| &mut s[range.clone()]);
                    materials[sorted[from]].ask(wo, request(wi, u, out)).expect("equal lengths");
                }
            }
            Way::Batch | Way::BatchPacked => {
                for from in (0..HITS).step_by(RUN) {
                    let range = from..from + RUN;
                    let [wo, wi, u] = [&*wo, wi, u].map(|t| t.slices().map(|s| &s[range.clone()]));
                    let out = out.each_mut().map(|s| &mut s[range.clone()]);
                    Material::ask_each(&each[range.clone()], wo, request(wi, u, out)).expect("equal lengths");
                }
            }
        }
        black_box((sum, out));
    }
}

/// A draw with density and weight, and value and density towards another direction.
fn request<'a>(wi: [&'a [f32]; 3], u: [&'a [f32]; 3], out: [&'a mut [f32]; 11]) -> Request<'a> {
    let [x, y, z, pdf, r, g, b, red, green, blue, density] = out;
    Request {
        draw: Some(Draws { u, direction: [x, y, z], pdf: Some(pdf), weight: Some([r, g, b]) }),
        evaluate: Some(Towards { wi, value: Some([red, green, blue]), pdf: Some(density) }),
    }
}

/// The memory of the materials, beside the tables of Dupuy and Jakob 2018 (RGL), whose isotropic ones in RGB are 659 kB each.
fn memory(materials: &[Material<&[u8]>], packed: &[Material<&[u8]>]) {
    let mean =
        |of: &[Material<&[u8]>]| of.iter().map(|m| m.bytes().len()).sum::<usize>() as f64 / of.len() as f64;
    let mut table = counted("memory, kB; materials");
    let mut row = |name: &str, one: f64| {
        table.row(name, COUNTS.map(|n| format!("{:.0}", one * n as f64 / 1000.0)));
    };
    row("materials, the bytes of their files", mean(materials));
    row("the same in codes of 8 bits", mean(packed));
    row("GGX, parameters", std::mem::size_of::<Ggx>() as f64);
    row("RGL tables", 659_000.0);
    table.print();
}
