//! Bytes of the stack that calls of the C interface use, at each level: `cargo run --release -p srbf-benches --example stack`.
//!
//! The unused part of a thread's stack is written full of one byte, a function is called, and the changed bytes are counted.
#![allow(unsafe_code, reason = "calls the C interface as C does, and looks below its own stack")]

use srbf::{srbf_material, srbf_mixture, srbf_request, srbf_sample, srbf_vectors, srbf_vectors_out};
use srbf_benches::harness::Table;
use srbf_benches::{GARNET_RED, Triples, factored_material, levels};
use srbf_core::{Grid, GridView, Level, Line, PlaneLobe, Processor, TiltedLobe, View};
use std::hint::black_box;

const HITS: usize = 256;
/// Bytes that are looked at, and their content before a call.
const REACH: usize = 1 << 18;
const MARK: u8 = 0xa5;
/// Bytes below this function's own frame that are left alone.
const NEAR: usize = 512;

fn main() {
    println!("processor: {}", Processor::this());
    for level in levels() {
        level.set().expect("an available level");
        report(level);
    }
}

fn report(level: Level) {
    let heads = ["ask", "members", "single", "prepare", "albedo"];
    let mut table = Table::new(&format!("{}, bytes", level.name()), heads);
    for (name, bytes) in [
        ("garnet red", GARNET_RED.to_vec()),
        ("garnet red with factors", factored_material().bytes().to_vec()),
        ("48 lobes and 16 mirrored", line(48, 16)),
        ("64 lobes, anisotropic", grid(64)),
    ] {
        let used = std::thread::Builder::new().stack_size(4 * REACH).spawn(move || of(&bytes));
        let used = used.expect("a thread").join().expect("no panic");
        table.row(name, used.map(|bytes| bytes.to_string()));
    }
    table.print();
}

/// A material of stored lobes, of which some stand for two.
fn line(stored: usize, mirrored: usize) -> Vec<u8> {
    let view = |theta: f32| -> Vec<PlaneLobe> {
        let lobe = |k: usize| PlaneLobe {
            angle: theta * 0.9,
            off_plane: if k >= stored - mirrored { theta * 0.3 } else { 0.0 },
            log2_sharpness: 1.0 + 0.1 * k as f32,
            log2_luminance: -5.0,
            color_differences: [0.0; 2],
        };
        (0..stored).map(lobe).collect()
    };
    let lobes = [view(0.0), view(1.2)];
    let views = [0, 1].map(|v| View {
        theta: 1.2 * v as f32,
        log2_squeeze: 0.0,
        log2_diffuse: -4.0,
        diffuse_color_differences: [0.0; 2],
        lobes: &lobes[v],
    });
    let line = Line { views: &views, squeezed: 2, mirrored, factors: None };
    let mut bytes = vec![0; line.encoded_len("")];
    line.encode("", &mut bytes).expect("a valid material");
    bytes
}

/// An anisotropic material.
fn grid(count: usize) -> Vec<u8> {
    let view = |theta: f32| -> Vec<TiltedLobe> {
        let lobe = |k: usize| TiltedLobe {
            tilt: [theta * 0.9, 0.0],
            log2_sharpness: 1.0 + 0.1 * k as f32,
            log2_luminance: -5.0,
            color_differences: [0.0; 2],
        };
        (0..count).map(lobe).collect()
    };
    let lobes = [view(0.0), view(1.2)];
    let views: Vec<GridView<'_>> = [0, 1, 1, 1, 1]
        .map(|v| GridView {
            log2_squeeze: [0.5, 0.2, -0.5],
            log2_diffuse: -4.0,
            diffuse_color_differences: [0.0; 2],
            lobes: &lobes[v],
        })
        .to_vec();
    let grid = Grid {
        thetas: &[0.0, 1.2],
        azimuths: 4,
        turns: 1,
        axis: 0.0,
        views: &views,
        squeezed: 2,
        factors: None,
    };
    let mut bytes = vec![0; grid.encoded_len("")];
    grid.encode("", &mut bytes).expect("a valid material");
    bytes
}

/// A request of dense arrays, one of members of a structure, a single hit, a mixture, an albedo.
fn of(bytes: &[u8]) -> [usize; 5] {
    let wo = Triples::directions(HITS, 1);
    let wi = Triples::directions(HITS, 2);
    let u = Triples::uniforms(HITS, 3);
    let mut out = [(); 11].map(|()| vec![0f32; HITS]);
    let mut spread = vec![[0f32; 20]; HITS];
    for (i, hit) in spread.iter_mut().enumerate() {
        for (to, of) in hit.chunks_exact_mut(3).zip([&wo, &wi, &u]) {
            to.copy_from_slice(&of.at(i).to_array());
        }
    }
    let mut storage = vec![0u128; srbf::SRBF_MIXTURE_SIZE_64 / 16];
    let (mut material, mut mixture) =
        (std::ptr::null_mut::<srbf_material>(), std::ptr::null_mut::<srbf_mixture>());
    // SAFETY: the storage is large and aligned enough; the bytes are as many as said.
    let status = unsafe {
        srbf::srbf_material_from_bytes(bytes.as_ptr(), bytes.len(), &raw mut material)
            | srbf::srbf_mixture_init(storage.as_mut_ptr().cast(), 16 * storage.len(), &raw mut mixture)
    };
    assert_eq!(status, 0);
    let starts = out.each_mut().map(|s| s.as_mut_ptr());
    let inputs = [&wo, &wi, &u].map(|t| t.slices().map(<[f32]>::as_ptr));
    let dense = request(inputs, starts, size_of::<f32>());
    // By the pointer to the whole, so that it reaches all hits.
    let first = spread.as_mut_ptr().cast::<f32>();
    let at = |k: usize| first.wrapping_add(k);
    let inputs = [0, 3, 6].map(|k| [k, k + 1, k + 2].map(|k| at(k).cast_const()));
    let members = request(inputs, std::array::from_fn(|k| at(9 + k)), size_of::<[f32; 20]>());
    let mut sample = srbf_sample { direction: [0.0; 3], pdf: 0.0, weight: [0.0; 3] };
    let (one, towards, numbers) = ([0.6f32, 0.0, 0.8], [0.0f32, 0.6, 0.8], [0.3f32, 0.6, 0.9]);
    let (mut value, mut pdf) = ([0f32; 3], 0f32);
    // SAFETY: all point to memory as the header demands, here and below.
    let ask = |request: &srbf_request| unsafe { srbf::srbf_material_ask(material, HITS, request) };
    let used = [
        used_by(|| ask(&dense)),
        used_by(|| ask(&members)),
        used_by(|| {
            let (one, u, wi) = (one.as_ptr(), numbers.as_ptr(), towards.as_ptr());
            let (value, pdf) = (value.as_mut_ptr(), &raw mut pdf);
            // SAFETY: as above.
            unsafe {
                srbf::srbf_material_sample_and_evaluate(material, one, u, &raw mut sample, wi, value, pdf)
            }
        }),
        // SAFETY: as above.
        used_by(|| unsafe { srbf::srbf_material_prepare(material, one.as_ptr(), mixture) }),
        // SAFETY: as above.
        used_by(|| unsafe { srbf::srbf_material_albedo(material, one.as_ptr(), value.as_mut_ptr()) }),
    ];
    // SAFETY: the library has made it.
    assert_eq!(unsafe { srbf::srbf_material_free(material) }, 0);
    used
}

fn request(inputs: [[*const f32; 3]; 3], out: [*mut f32; 11], stride: usize) -> srbf_request {
    // SAFETY: pointers and numbers, all of which may be zero.
    let mut request: srbf_request = unsafe { std::mem::zeroed() };
    request.size = size_of::<srbf_request>();
    [request.wo, request.wi, request.u] = inputs.map(|[x, y, z]| srbf_vectors { x, y, z, stride });
    let three = |k: usize| srbf_vectors_out { x: out[k], y: out[k + 1], z: out[k + 2], stride };
    request.value = three(0);
    (request.pdf.values, request.pdf.stride) = (out[3], stride);
    request.samples.direction = three(4);
    (request.samples.pdf.values, request.samples.pdf.stride) = (out[7], stride);
    request.samples.weight = three(8);
    request
}

/// Bytes that a call has changed, from the lowest one up to the caller's frame.
#[inline(never)]
fn used_by(mut call: impl FnMut() -> i32) -> usize {
    // Detection and linking happen once.
    assert_eq!(call(), 0);
    let here = 0u8;
    let top = (&raw const here).cast_mut().wrapping_sub(NEAR);
    for k in 0..REACH {
        // SAFETY: the thread's own stack, which is larger, and no frame is there.
        unsafe { top.wrapping_sub(k).write_volatile(MARK) };
    }
    assert_eq!(black_box(call()), 0);
    // SAFETY: as above.
    let untouched = (0..REACH).rev().take_while(|&k| unsafe { top.wrapping_sub(k).read_volatile() } == MARK);
    REACH - untouched.count() + NEAR
}
