//! What costs before anything is warm, or for one hit alone: a material that is loaded and checked, and one hit by each form of call.
//!
//! `cargo run --release -p srbf-benches --example cold [LEVEL...]`. Times are the least of many rounds in which all ways take turns, in
//! nanoseconds of a call. A hit draws a direction with its density and weight, and evaluates value and density towards another one.

use srbf_benches::harness::{Table, arguments, least_of, levels_of};
use srbf_benches::{GARNET_RED, Triples, garnet_red, packed};
use srbf_core::{Draws, Expanded, Level, Material, Request, Towards};
use std::hint::black_box;
use std::process::ExitCode;

const CALLS: usize = 256;
const ROUNDS: usize = 200;
const ROWS: usize = 512;

/// The timed call.
#[derive(Clone, Copy)]
enum Way {
    Load,
    LoadPacked,
    Single,
    Request,
    Expanded,
}

const WAYS: [(Way, &str); 5] = [
    (Way::Load, "a material loaded and checked"),
    (Way::LoadPacked, "the same in codes of 8 bits"),
    (Way::Single, "a hit, one call"),
    (Way::Request, "a hit, request for one"),
    (Way::Expanded, "a hit, request for one, expanded"),
];

fn main() -> ExitCode {
    let levels = match levels_of("cold", &arguments()) {
        Ok(levels) => levels,
        Err(status) => return status,
    };
    let codes = packed(garnet_red());
    let material = garnet_red();
    let mut memory = vec![0.0; material.expanded_len(ROWS)];
    let expanded = Expanded::new(material, ROWS, &mut memory).expect("an isotropic material");
    let inputs = [Triples::directions(CALLS, 1), Triples::directions(CALLS, 2), Triples::uniforms(CALLS, 3)];
    let mut table = Table::new("ns", levels.iter().map(|level| level.name()));
    let times: Vec<Vec<f64>> =
        levels.iter().map(|level| at(*level, material, &codes, &expanded, &inputs)).collect();
    for (i, (_, name)) in WAYS.iter().enumerate() {
        table.row(name, times.iter().map(|times| format!("{:.0}", times[i])));
    }
    table.print();
    ExitCode::SUCCESS
}

fn at(
    level: Level,
    material: &Material,
    codes: &[u8],
    expanded: &Expanded<'_>,
    [wo, wi, u]: &[Triples; 3],
) -> Vec<f64> {
    level.set().expect("an available level");
    let mut out = [[0.0f32]; 11];
    least_of(ROUNDS, WAYS.len(), CALLS, |way| {
        for i in 0..CALLS {
            let hit = [wo, wi, u].map(|t| t.slices().map(|s| &s[i..=i]));
            match WAYS[way].0 {
                Way::Load => {
                    black_box(Material::from_bytes(black_box(GARNET_RED)).expect("the preset is valid"));
                }
                Way::LoadPacked => {
                    black_box(Material::from_bytes(black_box(codes)).expect("a valid material"));
                }
                Way::Single => {
                    black_box(material.sample_and_evaluate(wo.at(i), u.at(i).to_array(), wi.at(i)));
                }
                Way::Request => material.ask(hit[0], request(hit, &mut out)).expect("equal lengths"),
                Way::Expanded => expanded.ask(hit[0], request(hit, &mut out)).expect("equal lengths"),
            }
        }
        black_box(&out);
    })
}

/// A draw with density and weight, and value and density towards another direction.
fn request<'a>([_, wi, u]: [[&'a [f32]; 3]; 3], out: &'a mut [[f32; 1]; 11]) -> Request<'a> {
    let [x, y, z, pdf, r, g, b, red, green, blue, density] = out.each_mut().map(|s| &mut s[..]);
    Request {
        draw: Some(Draws { u, direction: [x, y, z], pdf: Some(pdf), weight: Some([r, g, b]) }),
        evaluate: Some(Towards { wi, value: Some([red, green, blue]), pdf: Some(density) }),
    }
}
