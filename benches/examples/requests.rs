//! The time of a request for few hits, in C and in Rust, beside single calls: `cargo run --release -p srbf-benches --example requests`.
//! A number of rounds may follow it. There is a table for AVX2, and one for the best level of the processor.
//!
//! A hit draws a direction with its density and weight, and evaluates value and density towards another one; or it does the latter
//! alone. Of C the *arrays* are dense, or the members of a structure for each hit. Requests for no hit have empty arrays: their time is
//! that of making and checking a request. All ways take turns in every round. A time is the least of all rounds, nanoseconds of a hit; the
//! ratios after it are to the single call of C.
#![allow(unsafe_code, reason = "calls the C interface as C does")]

use srbf::{srbf_material, srbf_mixture, srbf_numbers_out, srbf_request, srbf_sample, srbf_status};
use srbf::{srbf_samples_out, srbf_vectors, srbf_vectors_out};
use srbf_benches::harness::{Table, capped_and_best, least_of};
use srbf_benches::{GARNET_RED, Triples, garnet_red};
use srbf_core::{Draws, Level, Material, Mixture, Processor, Request, Towards};
use std::hint::black_box;

const HITS: usize = 1024;
const ROUNDS: usize = 400;
const COUNTS: [usize; 5] = [1, 4, 16, 64, 256];
const NUMBER: usize = size_of::<f32>();

/// A hit as a renderer's own structure has it.
#[derive(Clone, Copy, Default)]
#[repr(C)]
struct Hit {
    wo: [f32; 3],
    wi: [f32; 3],
    u: [f32; 3],
    value: [f32; 3],
    pdf: f32,
    direction: [f32; 3],
    density: f32,
    weight: [f32; 3],
}

#[derive(Clone, Copy, PartialEq)]
enum Subject {
    Material,
    Mixture,
}

#[derive(Clone, Copy)]
enum Way {
    SingleC,
    Single,
    Dense,
    Members,
    Rust,
    /// A request for no hit.
    Nothing,
}

const WAYS: [(Way, &str); 6] = [
    (Way::SingleC, "single calls, C"),
    (Way::Single, "single calls, Rust"),
    (Way::Dense, "request, C, dense arrays"),
    (Way::Members, "request, C, members"),
    (Way::Rust, "request, Rust"),
    (Way::Nothing, "for no hit, Rust"),
];

fn main() {
    let rounds = std::env::args().nth(1).map_or(ROUNDS, |rounds| rounds.parse().expect("a number of rounds"));
    println!("processor: {}", Processor::this());
    for level in capped_and_best() {
        level.set().expect("an available level");
        let mut work = Work::new();
        for subject in [Subject::Material, Subject::Mixture] {
            for draws in [true, false] {
                report(level, &mut work, subject, draws, rounds);
            }
        }
    }
}

fn report(level: Level, work: &mut Work, subject: Subject, draws: bool, rounds: usize) {
    let times =
        COUNTS.map(|n| least_of(rounds, WAYS.len(), HITS, |way| work.run(WAYS[way].0, subject, draws, n)));
    let of = if subject == Subject::Material { "a material" } else { "a mixture" };
    let what = if draws { "draw, and value and density" } else { "value and density" };
    let title = format!("{}, {of}: {what}; hits a call", level.name());
    let mut table = Table::new(&title, COUNTS.map(|n| n.to_string()));
    for (row, (_, name)) in WAYS.iter().enumerate() {
        table.row(name, times.iter().map(|ns| format!("{:.1} {:.2}", ns[row], ns[row] / ns[0])));
    }
    let more = times.iter().zip(COUNTS).map(|(ns, n)| format!("{:.0}", (ns[2] - ns[4]) * n as f64));
    table.row("C over Rust, ns a call", more);
    table.print();
}

#[repr(align(64))]
struct Storage([u8; srbf::SRBF_MIXTURE_SIZE_16]);

type AskMaterial = unsafe extern "C" fn(*const srbf_material, usize, *const srbf_request) -> srbf_status;
type AskMixture = unsafe extern "C" fn(*const srbf_mixture, usize, usize, *const srbf_request) -> srbf_status;

/// Called through pointers that the optimiser cannot see through, as a C program calls them.
struct Calls {
    ask_material: AskMaterial,
    ask_mixture: AskMixture,
    material: unsafe extern "C" fn(
        *const srbf_material,
        *const f32,
        *const f32,
        *mut srbf_sample,
        *const f32,
        *mut f32,
        *mut f32,
    ) -> srbf_status,
    material_evaluate:
        unsafe extern "C" fn(*const srbf_material, *const f32, *const f32, *mut f32, *mut f32) -> srbf_status,
    mixture: unsafe extern "C" fn(
        *const srbf_mixture,
        *const f32,
        *mut srbf_sample,
        *const f32,
        *mut f32,
        *mut f32,
    ) -> srbf_status,
    mixture_evaluate:
        unsafe extern "C" fn(*const srbf_mixture, *const f32, *mut f32, *mut f32) -> srbf_status,
}

struct Work {
    calls: Calls,
    material: &'static Material,
    mixture: Mixture<'static, 16>,
    c_material: *mut srbf_material,
    c_mixture: *mut srbf_mixture,
    _storage: Box<Storage>,
    wo: Triples,
    wi: Triples,
    u: Triples,
    out: [Vec<f32>; 11],
    hits: Vec<Hit>,
}

impl Work {
    fn new() -> Self {
        let (wo, wi, u) =
            (Triples::directions(HITS, 1), Triples::directions(HITS, 2), Triples::uniforms(HITS, 3));
        let hit = |i: usize| Hit {
            wo: wo.at(i).to_array(),
            wi: wi.at(i).to_array(),
            u: u.at(i).to_array(),
            ..Hit::default()
        };
        let hits = (0..HITS).map(hit).collect();
        let material = garnet_red();
        let mut mixture = Mixture::empty();
        let view = [-0.6f32, 0.0, 0.8];
        material.prepare(view, &mut mixture).expect("a direction");
        let mut storage = Box::new(Storage([0; srbf::SRBF_MIXTURE_SIZE_16]));
        let (mut c_mixture, mut c_material) = (std::ptr::null_mut(), std::ptr::null_mut());
        let (size, bytes) = (storage.0.len(), GARNET_RED);
        // SAFETY: the storage is large and aligned enough, and lives as long as the mixture; the bytes are as many as said.
        let statuses = unsafe {
            [
                srbf::srbf_mixture_init(storage.0.as_mut_ptr().cast(), size, &raw mut c_mixture),
                srbf::srbf_material_from_bytes(bytes.as_ptr(), bytes.len(), &raw mut c_material),
                srbf::srbf_material_prepare(c_material, view.as_ptr(), c_mixture),
            ]
        };
        assert_eq!(statuses, [0; 3]);
        let calls = black_box(Calls {
            ask_material: srbf::srbf_material_ask,
            ask_mixture: srbf::srbf_mixture_ask,
            material: srbf::srbf_material_sample_and_evaluate,
            material_evaluate: srbf::srbf_material_evaluate_and_pdf,
            mixture: srbf::srbf_mixture_sample_and_evaluate,
            mixture_evaluate: srbf::srbf_mixture_evaluate_and_pdf,
        });
        let out = [(); 11].map(|()| vec![0.0; HITS]);
        let _storage = storage;
        Self { calls, material, mixture, c_material, c_mixture, _storage, wo, wi, u, out, hits }
    }

    fn run(&mut self, way: Way, subject: Subject, draws: bool, n: usize) {
        match way {
            Way::SingleC => (0..HITS).for_each(|i| self.single_c(subject, draws, i)),
            Way::Single => (0..HITS).for_each(|i| self.single(subject, draws, i)),
            Way::Dense | Way::Members => {
                for from in (0..HITS).step_by(n) {
                    let request = match way {
                        Way::Dense => self.dense(draws, from),
                        _ => self.members(draws, from),
                    };
                    // SAFETY: the arrays are as long as said, and nothing else uses the outputs.
                    let status = unsafe {
                        match subject {
                            Subject::Material => {
                                (self.calls.ask_material)(self.c_material, n, &raw const request)
                            }
                            Subject::Mixture => {
                                (self.calls.ask_mixture)(self.c_mixture, 0, n, &raw const request)
                            }
                        }
                    };
                    assert_eq!(status, 0);
                }
            }
            Way::Rust => (0..HITS).step_by(n).for_each(|from| self.rust(subject, draws, from, n)),
            Way::Nothing => (0..HITS).step_by(n).for_each(|from| self.rust(subject, draws, from, 0)),
        }
        black_box((&self.out, &self.hits));
    }

    fn single_c(&mut self, subject: Subject, draws: bool, i: usize) {
        let hit = &mut self.hits[i];
        let mut sample = srbf_sample { direction: [0.0; 3], pdf: 0.0, weight: [0.0; 3] };
        let (wo, wi, u) = (hit.wo.as_ptr(), hit.wi.as_ptr(), hit.u.as_ptr());
        let (value, pdf) = (hit.value.as_mut_ptr(), &raw mut hit.pdf);
        // SAFETY: all point to memory as the header demands.
        let status = unsafe {
            match (subject, draws) {
                (Subject::Material, true) => {
                    (self.calls.material)(self.c_material, wo, u, &raw mut sample, wi, value, pdf)
                }
                (Subject::Material, false) => {
                    (self.calls.material_evaluate)(self.c_material, wo, wi, value, pdf)
                }
                (Subject::Mixture, true) => {
                    (self.calls.mixture)(self.c_mixture, u, &raw mut sample, wi, value, pdf)
                }
                (Subject::Mixture, false) => (self.calls.mixture_evaluate)(self.c_mixture, wi, value, pdf),
            }
        };
        assert_eq!(status, 0);
        (hit.direction, hit.density, hit.weight) = (sample.direction, sample.pdf, sample.weight);
    }

    fn single(&mut self, subject: Subject, draws: bool, i: usize) {
        let hit = &mut self.hits[i];
        let (wo, wi, u) = (hit.wo, hit.wi, hit.u);
        let (sample, (value, pdf)) = match (subject, draws) {
            (Subject::Material, true) => self.material.sample_and_evaluate(wo, u, wi),
            (Subject::Material, false) => (None, self.material.evaluate_and_pdf(wo, wi)),
            (Subject::Mixture, true) => self.mixture.sample_and_evaluate(u, wi),
            (Subject::Mixture, false) => (None, self.mixture.evaluate_and_pdf(wi)),
        };
        (hit.value, hit.pdf) = (value.to_array(), pdf);
        if let Some(sample) = sample {
            (hit.direction, hit.density) = (sample.direction.to_array(), sample.pdf);
            hit.weight = sample.weight.to_array();
        }
    }

    fn rust(&mut self, subject: Subject, draws: bool, from: usize, n: usize) {
        let range = from..from + n;
        let [wo, wi, u] = [&self.wo, &self.wi, &self.u].map(|t| t.slices().map(|s| &s[range.clone()]));
        let [x, y, z, density, r, g, b, red, green, blue, pdf] =
            self.out.each_mut().map(|s| &mut s[range.clone()]);
        let draw = Draws { u, direction: [x, y, z], pdf: Some(density), weight: Some([r, g, b]) };
        let request = Request {
            draw: draws.then_some(draw),
            evaluate: Some(Towards { wi, value: Some([red, green, blue]), pdf: Some(pdf) }),
        };
        match subject {
            Subject::Material => self.material.ask(wo, request),
            Subject::Mixture => self.mixture.ask(request),
        }
        .expect("equal lengths");
    }

    fn dense(&mut self, draws: bool, from: usize) -> srbf_request {
        let [wo, wi, u] = [&self.wo, &self.wi, &self.u].map(|t| {
            let [x, y, z] = t.slices().map(|s| s[from..].as_ptr());
            srbf_vectors { x, y, z, stride: NUMBER }
        });
        let [x, y, z, density, r, g, b, red, green, blue, pdf] =
            self.out.each_mut().map(|s| s[from..].as_mut_ptr());
        let mut request = nothing();
        (request.wo, request.wi) = (wo, wi);
        request.value = srbf_vectors_out { x: red, y: green, z: blue, stride: NUMBER };
        request.pdf = srbf_numbers_out { values: pdf, stride: NUMBER };
        if draws {
            request.u = u;
            request.samples = srbf_samples_out {
                direction: srbf_vectors_out { x, y, z, stride: NUMBER },
                pdf: srbf_numbers_out { values: density, stride: NUMBER },
                weight: srbf_vectors_out { x: r, y: g, z: b, stride: NUMBER },
            };
        }
        request
    }

    fn members(&mut self, draws: bool, from: usize) -> srbf_request {
        // By the pointer to the whole, so that it reaches all hits.
        let hit = self.hits[from..].as_mut_ptr();
        let stride = size_of::<Hit>();
        let mut request = nothing();
        // SAFETY: members of a hit that is there.
        let [wo, wi, u, value, direction, weight] = unsafe {
            [
                &raw mut (*hit).wo,
                &raw mut (*hit).wi,
                &raw mut (*hit).u,
                &raw mut (*hit).value,
                &raw mut (*hit).direction,
                &raw mut (*hit).weight,
            ]
            .map(<*mut [f32; 3]>::cast::<f32>)
        };
        // SAFETY: as above.
        let (pdf, density) = unsafe { (&raw mut (*hit).pdf, &raw mut (*hit).density) };
        let read = |p: *mut f32| srbf_vectors { x: p, y: p.wrapping_add(1), z: p.wrapping_add(2), stride };
        let write =
            |p: *mut f32| srbf_vectors_out { x: p, y: p.wrapping_add(1), z: p.wrapping_add(2), stride };
        (request.wo, request.wi) = (read(wo), read(wi));
        (request.value, request.pdf) = (write(value), srbf_numbers_out { values: pdf, stride });
        if draws {
            request.u = read(u);
            let pdf = srbf_numbers_out { values: density, stride };
            request.samples = srbf_samples_out { direction: write(direction), pdf, weight: write(weight) };
        }
        request
    }
}

/// A request that asks for nothing.
fn nothing() -> srbf_request {
    // SAFETY: pointers and numbers, all of which may be zero.
    let zeros: srbf_request = unsafe { std::mem::zeroed() };
    srbf_request { size: size_of::<srbf_request>(), ..zeros }
}
