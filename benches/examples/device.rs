//! Times of `srbf_device.hpp`, the evaluator's text as C++, beside single calls of the library: `cargo run --release -p srbf-benches --example device`.
//!
//! Garnet red, 12 lobes. The header is compiled with `-O3 -march=native`, and with `-ffast-math` too. All take turns in every round; a time is the
//! least of all rounds, nanoseconds of a hit.

use srbf_benches::device::{DeviceText, Verbs, words};
use srbf_benches::harness::{Table, least_of};
use srbf_benches::{GARNET_RED, Triples, garnet_red};
use srbf_core::{Mixture, Processor};
use std::hint::black_box;

const HITS: usize = 1024;
const ROUNDS: usize = 300;

fn main() {
    println!("processor: {}", Processor::this());
    let (material, words) = (garnet_red(), words(GARNET_RED));
    let (wo, wi, u) =
        (Triples::directions(HITS, 1), Triples::directions(HITS, 2), Triples::uniforms(HITS, 3));
    let mut mixture = Mixture::<16>::empty();
    material.prepare(wo.at(0), &mut mixture).expect("a direction");
    let mut table = Table::new("ns a hit", ["library", "header", "ratio", "-ffast-math", "ratio"]);
    for (name, draws, evaluates, keeps) in [
        ("a material: value and density", false, true, false),
        ("a material: draw", true, false, false),
        ("a material: both", true, true, false),
        ("a mixture: value and density", false, true, true),
        ("a mixture: draw", true, false, true),
    ] {
        let library = || {
            let mut sum = 0.0;
            for i in 0..HITS {
                let (u, wi) = (u.at(i).to_array(), wi.at(i));
                let (sample, value) = match (draws, evaluates, keeps) {
                    (true, true, _) => {
                        let (sample, value) = material.sample_and_evaluate(wo.at(i), u, wi);
                        (sample, Some(value))
                    }
                    (true, _, true) => (mixture.sample(u), None),
                    (true, _, false) => (material.sample(wo.at(i), u), None),
                    (false, _, true) => (None, Some(mixture.evaluate_and_pdf(wi))),
                    (false, _, false) => (None, Some(material.evaluate_and_pdf(wo.at(i), wi))),
                };
                if let Some(s) = sample {
                    sum += s.direction.x + s.pdf + s.weight.element_sum();
                }
                if let Some((value, pdf)) = value {
                    sum += pdf + value.element_sum();
                }
            }
            sum
        };
        let verbs = Verbs { draws, evaluates, keeps_the_mixture: keeps };
        let careful = || DeviceText::Careful.run(&words, &wo, &wi, &u, verbs);
        let fast = || DeviceText::Fast.run(&words, &wo, &wi, &u, verbs);
        let (a, b) = (library(), careful());
        assert!((a - b).abs() < 1e-2 * a.abs(), "{name}: {a} and {b} are apart");
        let ways: [&dyn Fn() -> f32; 3] = [&library, &careful, &fast];
        let least = least_of(ROUNDS, ways.len(), HITS, |way| {
            black_box(ways[way]());
        });
        let [library, careful, fast] =
            [0, 1, 2].map(|way| (format!("{:.1}", least[way]), format!("{:.2}", least[way] / least[0])));
        table.row(name, [library.0, careful.0, careful.1, fast.0, fast.1]);
    }
    table.print();
}
