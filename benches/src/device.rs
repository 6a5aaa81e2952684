//! `srbf_device.hpp`, as a program that does not link the library compiles it.
#![allow(unsafe_code)]

use crate::Triples;

/// The questions to the text.
#[derive(Clone, Copy, Debug)]
pub struct Verbs {
    /// A direction with density and weight is drawn.
    pub draws: bool,
    /// Value and density towards another direction are evaluated.
    pub evaluates: bool,
    /// All hits have the first outgoing direction: one mixture serves all.
    pub keeps_the_mixture: bool,
}

/// How the text is compiled, by the C++ compiler with `-O3 -march=native`.
#[derive(Clone, Copy, Debug)]
pub enum DeviceText {
    /// As it is.
    Careful,
    /// With `-ffast-math`.
    Fast,
}

/// Hits as arrays of x, y and z, or of three numbers.
#[repr(C)]
struct Hits {
    words: *const u32,
    wo: [*const f32; 3],
    wi: [*const f32; 3],
    u: [*const f32; 3],
    count: usize,
}

unsafe extern "C" {
    fn srbf_device_careful(hits: *const Hits, verbs: i32) -> f32;
    fn srbf_device_fast(hits: *const Hits, verbs: i32) -> f32;
}

impl DeviceText {
    /// Asks for every hit; the sum of all answers. `words` are those of a valid `.srbf` file.
    pub fn run(self, words: &[u32], wo: &Triples, wi: &Triples, u: &Triples, verbs: Verbs) -> f32 {
        let count = wo.0[0].len();
        let [wo, wi, u] = [wo, wi, u].map(|triples| triples.slices().map(|s| s[..count].as_ptr()));
        let hits = Hits { words: words.as_ptr(), wo, wi, u, count };
        let verbs = i32::from(verbs.draws)
            | i32::from(verbs.evaluates) << 1
            | i32::from(verbs.keeps_the_mixture) << 2;
        let run = match self {
            Self::Careful => srbf_device_careful,
            Self::Fast => srbf_device_fast,
        };
        // SAFETY: the arrays have as many numbers each, at least one; the words are those of a valid file.
        unsafe { run(&raw const hits, verbs) }
    }
}

/// The words of the bytes of a `.srbf` file.
pub fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect()
}
