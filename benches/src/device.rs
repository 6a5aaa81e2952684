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

type Three = [*const f32; 3];

unsafe extern "C" {
    fn srbf_device_careful(
        words: *const u32,
        wo: *const Three,
        wi: *const Three,
        u: *const Three,
        n: i32,
        verbs: i32,
    ) -> f32;
    fn srbf_device_fast(
        words: *const u32,
        wo: *const Three,
        wi: *const Three,
        u: *const Three,
        n: i32,
        verbs: i32,
    ) -> f32;
}

impl DeviceText {
    /// Asks for every hit; the sum of all answers. `words` are those of a valid `.srbf` file.
    pub fn run(self, words: &[u32], wo: &Triples, wi: &Triples, u: &Triples, verbs: Verbs) -> f32 {
        let n = wo.0[0].len();
        let arrays = [wo, wi, u].map(|triples| triples.slices().map(|s| s[..n].as_ptr()));
        let verbs = i32::from(verbs.draws)
            | i32::from(verbs.evaluates) << 1
            | i32::from(verbs.keeps_the_mixture) << 2;
        let run = match self {
            Self::Careful => srbf_device_careful,
            Self::Fast => srbf_device_fast,
        };
        // SAFETY: the arrays have n numbers each, which is not 0 nor above the range; the words are those of a valid file.
        unsafe { run(words.as_ptr(), &arrays[0], &arrays[1], &arrays[2], n as i32, verbs) }
    }
}

/// The words of the bytes of a `.srbf` file.
pub fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect()
}
