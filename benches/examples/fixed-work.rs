//! A fixed amount of work, for counting instructions: `.ci/checks/60-instructions` runs it under callgrind.
//!
//! `fixed-work LEVEL OPERATION`, operation one of none, evaluate, evaluate-garnet, sample, one, one-round, one-draw,
//! one-draw-round, one-sample, one-sample-round, one-sample-pdf, one-sample-pdf-round, prepare, prepare-dropping, pairs,
//! sample-pdf-pairs, evaluate-pairs, pdf-pairs, luminance-pairs; `evaluate` and the `-round` of 12 general round lobes, the rest of the garnet red preset.

use srbf_benches::{GARNET_RED, Triples, garnet_mixture, general_mixture};
use srbf_core::{LeaveOut, Level, Material, Mixture, SamplesMut, Vec3};
use std::process::ExitCode;

/// The height of a direction drawn alone.
fn draw(mixture: &Mixture<64>, u: Vec3) -> f32 {
    mixture.sample_direction(u.to_array()).map_or(0.0, |direction| direction.z)
}

/// The density of a direction drawn alone, without the value.
fn sample_pdf(mixture: &Mixture<64>, u: Vec3) -> f32 {
    mixture.sample_pdf(u.to_array()).map_or(0.0, |(_, pdf)| pdf)
}

/// The density of a direction drawn alone.
fn sample(mixture: &Mixture<64>, u: Vec3) -> f32 {
    mixture.sample(u.to_array()).map_or(0.0, |sample| sample.pdf)
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [level, operation] = &arguments[..] else {
        eprintln!("usage: fixed-work LEVEL OPERATION");
        return ExitCode::from(2);
    };
    let Some(level) = Level::from_name(level) else {
        eprintln!("no such level: {level}");
        return ExitCode::from(2);
    };
    if level.set().is_err() {
        eprintln!("this machine lacks {}", level.name());
        return ExitCode::from(77);
    }
    let n = 4096;
    let (directions, uniforms) = (Triples::directions(n, 1), Triples::uniforms(n, 2));
    let incident = Triples::directions(n, 3);
    let mut out = [(); 7].map(|()| vec![0.0f32; n]);
    let [x, y, z, pdf, red, green, blue] = &mut out;
    let material = Material::from_bytes(GARNET_RED).expect("the preset is valid");
    let (general, garnet) = (general_mixture(12), garnet_mixture());
    let mut mixture = Mixture::<16>::empty();
    match operation.as_str() {
        "none" => {}
        "evaluate" => general.evaluate_into(directions.slices(), [red, green, blue]).expect("equal lengths"),
        "evaluate-garnet" => {
            garnet.evaluate_into(directions.slices(), [red, green, blue]).expect("equal lengths");
        }
        "sample" => {
            let samples = SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] };
            garnet.sample_into(uniforms.slices(), samples).expect("equal lengths");
        }
        "one" => (0..n).for_each(|i| pdf[i] = garnet.pdf(directions.at(i))),
        "one-round" => (0..n).for_each(|i| pdf[i] = general.pdf(directions.at(i))),
        "one-draw" => (0..n).for_each(|i| pdf[i] = draw(&garnet, uniforms.at(i))),
        "one-draw-round" => (0..n).for_each(|i| pdf[i] = draw(&general, uniforms.at(i))),
        "one-sample" => (0..n).for_each(|i| pdf[i] = sample(&garnet, uniforms.at(i))),
        "one-sample-round" => (0..n).for_each(|i| pdf[i] = sample(&general, uniforms.at(i))),
        "one-sample-pdf" => (0..n).for_each(|i| pdf[i] = sample_pdf(&garnet, uniforms.at(i))),
        "one-sample-pdf-round" => (0..n).for_each(|i| pdf[i] = sample_pdf(&general, uniforms.at(i))),
        "prepare" | "prepare-dropping" => {
            let share = if operation == "prepare" { 0.0 } else { 0.01 };
            let leave_out = LeaveOut::new(share, 1e-7).expect("shares");
            (0..n).for_each(|i| {
                material
                    .prepare_leaving_out(directions.at(i), leave_out, &mut mixture)
                    .expect("a valid direction");
                pdf[i] = mixture.power();
            });
        }
        "evaluate-pairs" => material
            .evaluate_pairs_into(directions.slices(), incident.slices(), [red, green, blue], pdf)
            .expect("equal lengths"),
        "pdf-pairs" => {
            material.pdf_pairs_into(directions.slices(), incident.slices(), pdf).expect("equal lengths");
        }
        "luminance-pairs" => {
            material
                .luminance_pairs_into(directions.slices(), incident.slices(), pdf)
                .expect("equal lengths");
        }
        "sample-pdf-pairs" => material
            .sample_pdf_pairs_into(directions.slices(), uniforms.slices(), [x, y, z], pdf)
            .expect("equal lengths"),
        "pairs" => {
            let samples = SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] };
            material
                .sample_pairs_into(directions.slices(), uniforms.slices(), samples)
                .expect("equal lengths");
        }
        _ => {
            eprintln!("no such operation: {operation}");
            return ExitCode::from(2);
        }
    }
    // So that no work is optimised away.
    let sum: f32 = out.iter().flatten().sum();
    println!("{sum}");
    ExitCode::SUCCESS
}
