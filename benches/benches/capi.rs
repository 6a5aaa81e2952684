//! The cost of a call through the C interface over the same call in Rust, as a ratio: `cargo bench --bench capi`.
//!
//! The two are timed in turn, many times, and the medians divided: a noisy machine slows both. The C functions are called
//! through pointers that the optimiser cannot see through, as a C program calls them.
#![allow(unsafe_code, reason = "calls the C interface as C does")]

use srbf::{srbf_mixture, srbf_numbers_out, srbf_request, srbf_sample, srbf_vectors, srbf_vectors_out};
use srbf_core::{Domain, Draws, Lobe, Mixture, Towards, Vec3};
use std::cell::RefCell;
use std::hint::black_box;
use std::time::Instant;

#[repr(align(64))]
struct Storage([u8; srbf::SRBF_MIXTURE_SIZE_16]);

fn lobes() -> Vec<Lobe> {
    let lobe = |k: usize| {
        let angle = 0.1 * k as f32 - 0.5;
        Lobe::new(Vec3::new(angle.sin(), 0.0, angle.cos()), 2.0 * 1.6f32.powi(k as i32), Vec3::ONE)
    };
    (0..12).map(|k| lobe(k).expect("the lobe is valid")).collect()
}

/// Prints the ratio of the medians of two ways of doing the same.
fn compare(name: &str, calls: u32, mut rust: impl FnMut(), mut c: impl FnMut()) {
    let time = |work: &mut dyn FnMut()| {
        let start = Instant::now();
        (0..calls).for_each(|_| work());
        start.elapsed().as_secs_f64() * 1e9 / f64::from(calls)
    };
    let mut times: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    for _ in 0..401 {
        times[0].push(time(&mut rust));
        times[1].push(time(&mut c));
    }
    let [rust, c] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    println!("{name:<20} Rust {rust:9.1} ns   C {c:9.1} ns   ratio {:.3}", c / rust);
}

fn main() {
    println!("processor: {}", srbf_core::Processor::this());
    for level in srbf_benches::harness::capped_and_best() {
        level.set().expect("an available level");
        println!("{}:", level.name());
        report();
    }
}

fn report() {
    let lobes = lobes();
    let mixture = Mixture::<16>::new(Domain::Hemisphere, 0.5, &lobes[..5], &lobes[5..]).expect("valid lobes");
    let mut storage = Box::new(Storage([0; srbf::SRBF_MIXTURE_SIZE_16]));
    let mut made: *mut srbf_mixture = std::ptr::null_mut();
    let plain: Vec<srbf::srbf_lobe> = lobes
        .iter()
        .map(|l| srbf::srbf_lobe {
            axis: l.gaussian.axis.to_array(),
            sharpness: l.gaussian.sharpness,
            amplitude: l.amplitude.to_array(),
        })
        .collect();
    // SAFETY: the storage is large and aligned enough and lives to the end of main; the lobes are as many as said.
    unsafe {
        let size = storage.0.len();
        assert_eq!(srbf::srbf_mixture_init(storage.0.as_mut_ptr().cast(), size, &mut made), 0);
        let none = std::ptr::null();
        assert_eq!(srbf::srbf_mixture_from_lobes(1, 0.5, 5, 12, plain.as_ptr(), none, made), 0);
    }
    let direction = black_box([0.36f32, 0.48, 0.8]);
    let u = black_box([0.3f32, 0.6, 0.9]);
    let one_pdf = black_box(srbf::srbf_mixture_pdf as unsafe extern "C" fn(_, _, _) -> _);
    let one_sample = black_box(srbf::srbf_mixture_sample as unsafe extern "C" fn(_, _, _) -> _);
    let many = black_box(srbf::srbf_mixture_ask as unsafe extern "C" fn(_, _, _, _) -> _);
    let mixture = black_box(&mixture);

    let (mut pdf, mut sample) = (0.0f32, srbf_sample { direction: [0.0; 3], pdf: 0.0, weight: [0.0; 3] });
    compare(
        "pdf/12/1",
        2000,
        || {
            black_box(mixture.pdf(black_box(Vec3::from_array(direction))));
        },
        || {
            // SAFETY: all three point to memory as the header asks for it.
            black_box(unsafe { one_pdf(made.cast_const(), black_box(&direction).as_ptr(), &raw mut pdf) });
        },
    );
    compare(
        "sample/12/1",
        2000,
        || {
            // The weight is part of the result of the C call.
            black_box(mixture.sample(black_box(u)).map(|sample| (sample, sample.weight)));
        },
        || {
            // SAFETY: as above.
            black_box(unsafe { one_sample(made.cast_const(), black_box(&u).as_ptr(), &raw mut sample) });
        },
    );
    for n in [16usize, 1024] {
        let column =
            |k: usize| (0..n).map(|i| ((i * (2 * k + 7) + k) % n) as f32 / n as f32).collect::<Vec<_>>();
        let (x, y, z) = (column(0), column(1), column(2));
        // Both write to the same places, so that neither has the luckier ones.
        let out: RefCell<[Vec<f32>; 7]> = RefCell::new(std::array::from_fn(|_| vec![0.0; n]));
        let stride = size_of::<f32>();
        let input = srbf_vectors { x: x.as_ptr(), y: y.as_ptr(), z: z.as_ptr(), stride };
        let calls = (20_000 / n) as u32 + 1;
        compare(
            &format!("pdf/12/{n}"),
            calls,
            || {
                let mut out = out.borrow_mut();
                let towards = Towards { wi: black_box([&x, &y, &z]), value: None, pdf: Some(&mut out[0]) };
                mixture.ask(towards.into()).expect("one length");
            },
            || {
                let mut request = nothing();
                request.wi = black_box(input);
                request.pdf = srbf_numbers_out { values: out.borrow_mut()[0].as_mut_ptr(), stride };
                // SAFETY: the arrays are as long as said, and nothing else uses the outputs.
                black_box(unsafe { many(made.cast_const(), 0usize, n, &raw const request) });
            },
        );
        compare(
            &format!("sample/12/{n}"),
            calls,
            || {
                let mut out = out.borrow_mut();
                let [x_out, y_out, z_out, pdf, red, green, blue] = out.each_mut().map(Vec::as_mut_slice);
                let draws = Draws {
                    u: black_box([&x, &y, &z]),
                    direction: [x_out, y_out, z_out],
                    pdf: Some(pdf),
                    weight: Some([red, green, blue]),
                };
                mixture.ask(draws.into()).expect("one length");
            },
            || {
                let [a, b, c, d, e, f, g] = out.borrow_mut().each_mut().map(|v| v.as_mut_ptr());
                let mut request = nothing();
                request.u = black_box(input);
                request.samples.direction = srbf_vectors_out { x: a, y: b, z: c, stride };
                request.samples.pdf = srbf_numbers_out { values: d, stride };
                request.samples.weight = srbf_vectors_out { x: e, y: f, z: g, stride };
                // SAFETY: as above.
                black_box(unsafe { many(made.cast_const(), 0usize, n, &raw const request) });
            },
        );
    }
}

/// A request that asks for nothing.
fn nothing() -> srbf_request {
    // SAFETY: pointers and numbers, all of which may be zero.
    let zeros: srbf_request = unsafe { std::mem::zeroed() };
    srbf_request { size: size_of::<srbf_request>(), ..zeros }
}
