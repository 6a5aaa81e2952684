//! Fuzzing with a seeded generator: damaged `.srbf` bytes and tables give an error or something sound, never a panic, a
//! hang or a NaN.
//!
//! `SRBF_FUZZ=N` runs N executions of each target in place of the few of every test run; `tests/corpus/` holds the seeds,
//! small files of our own. What a run finds is added there.

use glam::Vec3;
use srbf_core::{FactorTable, Line, Material, Mixture, PlaneLobe, View};
use srbf_fit::table;
use srbf_tests::inputs::Random;

/// Executions of a target in an ordinary run: about a second each.
const EXECUTIONS: u64 = 20_000;

fn executions() -> u64 {
    match std::env::var("SRBF_FUZZ") {
        Ok(text) => text.parse().expect("SRBF_FUZZ is a number of executions"),
        Err(_) => EXECUTIONS,
    }
}

fn below(random: &mut Random, limit: usize) -> usize {
    ((random.uniform() as f64 * limit as f64) as usize).min(limit.saturating_sub(1))
}

/// Damages a seed in one to eight places.
fn mutate(random: &mut Random, seed: &[u8]) -> Vec<u8> {
    /// What numbers and lengths are replaced with.
    const WORDS: [&[u8]; 12] = [
        &[0xff; 4],
        &[0; 8],
        &[0x7f, 0xff, 0xff, 0xff],
        &[0, 0, 0xc0, 0x7f],
        &[0, 0, 0x80, 0x7f],
        &[0, 0, 0, 0x80],
        b" NaN ",
        b" 1e400 ",
        b"-1",
        b" 99999999999999999999 ",
        b"\n",
        b",",
    ];
    let mut bytes = seed.to_vec();
    for _ in 0..=below(random, 8) {
        let at = below(random, bytes.len().max(1));
        match below(random, 7) {
            0 => bytes.truncate(at),
            1 if at < bytes.len() => bytes[at] ^= 1 << below(random, 8),
            2 if at < bytes.len() => bytes[at] = below(random, 256) as u8,
            3 => {
                let word = WORDS[below(random, WORDS.len())];
                let end = (at + word.len()).min(bytes.len());
                bytes[at.min(end)..end].copy_from_slice(&word[..end - at.min(end)]);
            }
            4 => {
                let word = WORDS[below(random, WORDS.len())];
                bytes.splice(at..at, word.iter().copied());
            }
            5 => {
                let end = (at + below(random, 64)).min(bytes.len());
                let part = bytes[at.min(end)..end].to_vec();
                bytes.splice(at..at, part);
            }
            _ => {
                let end = (at + below(random, 64)).min(bytes.len());
                bytes.drain(at.min(end)..end);
            }
        }
    }
    bytes
}

/// CRC-32, so that damage gets past the checksum (IEEE 802.3, bit by bit).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |mut crc, &byte| {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
        }
        crc
    })
}

/// A material with colours outside the gamut and a table of factors.
fn factored() -> Vec<u8> {
    let lobe = |k: usize, angle| PlaneLobe {
        angle,
        off_plane: 0.0,
        log2_sharpness: 2.0 + 3.0 * k as f32,
        log2_luminance: 2.0 * k as f32 - 5.0,
        color_differences: [4.0 * k as f32 - 1.5, 12.0 - 8.0 * k as f32],
    };
    let lobes = [[lobe(0, 0.0), lobe(1, 0.0)], [lobe(0, 0.9), lobe(1, 1.1)]];
    let view = |v: usize| View {
        theta: 1.2 * v as f32,
        log2_squeeze: -(v as f32),
        log2_diffuse: -3.0,
        diffuse_color_differences: [-1.2, 3.0],
        lobes: &lobes[v],
    };
    let factors: Vec<[f32; 3]> = (0..12).map(|n| [0.6 * n as f32, 1.0, 0.0]).collect();
    let albedo_differences = [[0.5, -0.2, 1.0]; 2];
    let factors = Some(FactorTable {
        half: 4,
        difference: 3,
        factors: &factors,
        albedo_differences: &albedo_differences,
    });
    let line = Line { views: &[view(0), view(1)], squeezed: 1, mirrored: 0, factors };
    let mut bytes = vec![0; line.encoded_len("made by tests/fuzz.rs")];
    line.encode("made by tests/fuzz.rs", &mut bytes).expect("the seed is valid");
    bytes
}

#[test]
fn srbf_bytes() {
    let factored = factored();
    let seeds: [&[u8]; 5] = [
        include_bytes!("../corpus/version1.srbf"),
        &factored,
        include_bytes!("../../presets/garnet_red.srbf"),
        include_bytes!("../../presets/krylon_blue.srbf"),
        include_bytes!("../../presets/cayman.srbf"),
    ];
    let mut random = Random(1);
    let mut accepted = 0;
    for execution in 0..executions() {
        let seed = seeds[below(&mut random, 5)];
        let mut bytes = mutate(&mut random, seed);
        if bytes.len() >= 48 && below(&mut random, 4) > 0 {
            // The length and the checksum put right, so that the fields behind them are reached.
            let length = bytes.len() as u32;
            bytes[16..20].copy_from_slice(&length.to_le_bytes());
            let end = bytes.len() - 4;
            let crc = crc32(&bytes[..end]);
            bytes[end..].copy_from_slice(&crc.to_le_bytes());
        }
        let Ok(material) = Material::from_bytes(&bytes) else { continue };
        accepted += 1;
        let mut mixture = Mixture::<64>::empty();
        for wo in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, -0.99, 0.141).normalize(), Vec3::X] {
            material.prepare(wo, &mut mixture).expect("a unit vector and room for every lobe");
            let u = [random.uniform(), random.uniform(), random.uniform()];
            assert!(mixture.albedo().is_finite(), "execution {execution}: albedo");
            let wi = random.direction();
            let factor = material.factor(wo, wi);
            // Below the horizon it is any number.
            let within =
                factor.min_element() >= 0.0 && factor.max_element() <= 1.001 * material.largest_factor();
            assert!(within || wi.z < 0.0, "execution {execution}, {wo}, {wi}: factor {factor}");
            let (mut value, mut pdf) = ([[0.0; 1]; 3], [0.0; 1]);
            let [red, green, blue] = value.each_mut().map(|channel| &mut channel[..]);
            let [o, i] = [wo, wi].map(|d| d.to_array().map(|x| [x]));
            let pair = [&o, &i].map(|d| [&d[0][..], &d[1][..], &d[2][..]]);
            material
                .evaluate_and_pdf_pairs_into(pair[0], pair[1], [red, green, blue], &mut pdf)
                .expect("one pair");
            assert!(value.as_flattened().iter().all(|v| v.is_finite()), "execution {execution}: {value:?}");
            if let Some(sample) = mixture.sample(u) {
                let sound =
                    sample.direction.is_finite() && sample.pdf.is_finite() && sample.weight.is_finite();
                assert!(sound, "execution {execution}, {wo}, {u:?}: {sample:?}");
            }
        }
    }
    println!("{} executions, {accepted} materials accepted", executions());
    assert!(accepted > 0, "no damaged material is sound: the fields are never reached");
}

/// Runs a reader over damaged seeds; `parse` says whether it accepted.
fn fuzz_reader(name: &str, seed: &[u8], parse: impl Fn(&[u8]) -> bool) {
    assert!(parse(seed), "the seed of {name} is not accepted");
    let mut random = Random(2);
    let accepted = (0..executions()).filter(|_| parse(&mutate(&mut random, seed))).count();
    println!("{name}: {} executions, {accepted} accepted", executions());
}

#[test]
fn tables() {
    let scattered = |parsed: Result<Vec<(f64, table::Scattered)>, srbf_fit::ReadError>| {
        let Ok(views) = parsed else { return false };
        let samples = views.iter().flat_map(|(_, samples)| samples);
        let mut numbers = samples.flat_map(|(direction, rgb)| direction.iter().chain(rgb));
        assert!(numbers.all(|v| v.is_finite()), "a table holds a number that is not finite");
        true
    };
    let corpus = |name: &str| {
        let path = format!("{}/corpus/{name}", env!("CARGO_MANIFEST_DIR"));
        std::fs::read(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
    };
    fuzz_reader("brdf", &corpus("small.brdf"), |bytes| scattered(srbf_fit::read::cornell::parse(bytes)));
    fuzz_reader("astm", &corpus("small.astm"), |bytes| scattered(srbf_fit::read::astm::parse(bytes)));
    fuzz_reader("csv", &corpus("small.csv"), |bytes| scattered(srbf_fit::read::csv::parse(bytes)));
    fuzz_reader("bsdf", &corpus("small.bsdf"), |bytes| srbf_fit::read::rgl::parse(bytes).is_ok());
}
