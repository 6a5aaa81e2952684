//! Fuzzing with a seeded generator: damaged `.srbf` bytes and tables give an error or something sound, never a panic, a
//! hang or a NaN.
//!
//! `SRBF_FUZZ=N` runs N executions of each target in place of the few of every test run; `tests/corpus/` holds seeds,
//! small files of our own, and `tests/src/seeds.rs` makes others: with factors, anisotropic, and of the ends of what the format
//! allows. What a run finds is added there.

use glam::Vec3;
use srbf_core::{Expanded, Material, Mixture, SamplesMut};
use srbf_fit::read::{self, Conventions, Intake};
use srbf_tests::inputs::Random;
use srbf_tests::seeds;

/// Executions of a target in an ordinary run: about a second each.
const EXECUTIONS: u64 = 20_000;

fn executions() -> u64 {
    match std::env::var("SRBF_FUZZ") {
        Ok(text) => text.parse().expect("SRBF_FUZZ is a number of executions"),
        Err(_) => EXECUTIONS,
    }
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
    for _ in 0..=random.below(8) {
        let at = random.below(bytes.len().max(1));
        match random.below(7) {
            0 => bytes.truncate(at),
            1 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            2 if at < bytes.len() => bytes[at] = random.below(256) as u8,
            3 => {
                let word = WORDS[random.below(WORDS.len())];
                let end = (at + word.len()).min(bytes.len());
                bytes[at.min(end)..end].copy_from_slice(&word[..end - at.min(end)]);
            }
            4 => {
                let word = WORDS[random.below(WORDS.len())];
                bytes.splice(at..at, word.iter().copied());
            }
            5 => {
                let end = (at + random.below(64)).min(bytes.len());
                let part = bytes[at.min(end)..end].to_vec();
                bytes.splice(at..at, part);
            }
            _ => {
                let end = (at + random.below(64)).min(bytes.len());
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

/// Prepares, evaluates and samples: everything is a number, and what reflects draws.
fn use_material(bytes: &[u8], random: &mut Random, place: &str) {
    let material = Material::from_bytes(bytes).expect("found to be sound");
    let mut memory = vec![0.0; if material.is_isotropic() { material.expanded_len(8) } else { 0 }];
    let expanded = Expanded::new(&material, 8, &mut memory);
    assert_eq!(expanded.is_ok(), material.is_isotropic(), "{place}: {:?}", expanded.err());
    let mut mixture = Mixture::<64>::empty();
    for wo in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, -0.99, 0.141).normalize(), Vec3::X] {
        material.prepare(wo, &mut mixture).expect("a unit vector and room for every lobe");
        let place = format!("{place}, {wo}");
        assert!(mixture.albedo().is_finite() && mixture.power().is_finite(), "{place}: albedo");
        let (u, wi) = (random.three(), random.direction());
        let factor = material.factor(wo, wi);
        // Below the horizon it is any number.
        let within = factor.min_element() >= 0.0 && factor.max_element() <= 1.001 * material.largest_factor();
        assert!(within || wi.z < 0.0, "{place}, {wi}: factor {factor}");
        let (mut value, mut pdf) = ([[0.0; 1]; 3], [0.0; 1]);
        let [red, green, blue] = value.each_mut().map(|channel| &mut channel[..]);
        let [o, i] = [wo, wi].map(|d| d.to_array().map(|x| [x]));
        let pair = [&o, &i].map(|d| [&d[0][..], &d[1][..], &d[2][..]]);
        material
            .evaluate_and_pdf_pairs_into(pair[0], pair[1], [red, green, blue], &mut pdf)
            .expect("one pair");
        assert!(
            value.as_flattened().iter().all(|v| v.is_finite()) && pdf[0].is_finite(),
            "{place}: {value:?}"
        );
        let sample = mixture.sample(u);
        assert_eq!(sample.is_some(), mixture.power() > 0.0, "{place}, {u:?}: what reflects draws");
        if let Some(sample) = sample {
            is_sound(sample.direction, sample.pdf, sample.weight, || format!("{place}, {u:?}"));
        }
        let Ok(expanded) = &expanded else { continue };
        let mut out = [[0.0; 1]; 7];
        let [x, y, z, pdf, red, green, blue] = out.each_mut().map(|number| &mut number[..]);
        let samples = SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] };
        let u = u.map(|u| [u]);
        expanded.sample_pairs_into(pair[0], [&u[0], &u[1], &u[2]], samples).expect("one sample");
        let [x, y, z, pdf, red, green, blue] = *out.as_flattened() else { unreachable!() };
        let (direction, weight) = (Vec3::new(x, y, z), Vec3::new(red, green, blue));
        is_sound(direction, pdf, weight, || format!("{place}, {u:?}, expanded"));
    }
}

/// A direction of the hemisphere, a density, and a weight that is 0 where there is nothing to divide by.
fn is_sound(direction: Vec3, pdf: f32, weight: Vec3, place: impl Fn() -> String) {
    let is_drawn = (direction.length() - 1.0).abs() < 1e-6 && direction.z >= 0.0;
    let is_weighed = weight.is_finite() && (weight == Vec3::ZERO || pdf >= f32::MIN_POSITIVE);
    assert!(
        is_drawn && pdf >= 0.0 && pdf.is_finite() && is_weighed,
        "{}: {direction} {pdf:e} {weight}",
        place()
    );
}

#[test]
fn srbf_bytes() {
    let factored = seeds::factored();
    let seeds: [&[u8]; 6] = [
        include_bytes!("../corpus/version1.srbf"),
        include_bytes!("../corpus/version2.srbf"),
        &factored,
        include_bytes!("../../presets/garnet_red.srbf"),
        include_bytes!("../../presets/krylon_blue.srbf"),
        include_bytes!("../../presets/cayman.srbf"),
    ];
    let mut random = Random(1);
    let (mut accepted, mut anisotropic) = (0, 0);
    for execution in 0..executions() {
        let extreme;
        let seed = match random.below(10) {
            n if n < seeds.len() => seeds[n],
            _ => {
                extreme = seeds::extreme(&mut random);
                &extreme
            }
        };
        let mut bytes = if random.below(8) == 0 { seed.to_vec() } else { mutate(&mut random, seed) };
        if bytes.len() >= 48 && random.below(4) > 0 {
            // The length and the checksum put right, so that the fields behind them are reached.
            let length = bytes.len() as u32;
            bytes[16..20].copy_from_slice(&length.to_le_bytes());
            let end = bytes.len() - 4;
            let crc = crc32(&bytes[..end]);
            bytes[end..].copy_from_slice(&crc.to_le_bytes());
        }
        let Ok(material) = Material::from_bytes(&bytes) else { continue };
        accepted += 1;
        anisotropic += u64::from(!material.is_isotropic());
        use_material(&bytes, &mut random, &format!("execution {execution}"));
    }
    println!("{} executions, {accepted} materials accepted, {anisotropic} anisotropic ones", executions());
    assert!(
        anisotropic > 0 && accepted > anisotropic,
        "no damaged material is sound: the fields are never reached"
    );
}

/// Every number at an end of what the format allows, in both kinds of material.
#[test]
fn materials_of_extremes() {
    let mut random = Random(3);
    for execution in 0..executions() / 4 {
        let bytes = seeds::extreme(&mut random);
        use_material(&bytes, &mut random, &format!("execution {execution}"));
    }
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
    let scattered = |parsed: Result<Intake, srbf_fit::ReadError>| {
        let Ok(intake) = parsed else { return false };
        let rows = intake.rows.iter().flat_map(|row| [row.wi, row.wo, row.rgb]).flatten();
        let views = intake.views();
        let samples = views.iter().flat_map(|(_, samples)| samples);
        let samples = samples.flat_map(|(direction, rgb)| [*direction, *rgb]).flatten();
        assert!(rows.chain(samples).all(|v| v.is_finite()), "a table holds a number that is not finite");
        true
    };
    let corpus = |name: &str| {
        let path = format!("{}/corpus/{name}", env!("CARGO_MANIFEST_DIR"));
        std::fs::read(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
    };
    type Parse = fn(&[u8], &Conventions) -> Result<Intake, srbf_fit::ReadError>;
    let formats: [(&str, Parse); 10] = [
        ("small.brdf", read::cornell::parse),
        ("small.astm", read::astm::parse),
        ("small.csv", read::csv::parse),
        ("zemax.bsdf", read::scatter_tables::zemax),
        ("lighttools.bsdf", read::scatter_tables::lighttools),
        ("small.anisotropicbsdf", read::speos::anisotropic),
        ("speos.brdf", read::speos::spectral),
        ("small.xompt", read::openmaterial::parse),
        ("alta.dat", read::alta::parse),
        ("pgii.txt", read::pab_opto::parse),
    ];
    for (name, parse) in formats {
        fuzz_reader(name, &corpus(name), |bytes| scattered(parse(bytes, &Conventions::default())));
    }
    fuzz_reader("small.ssdd", &corpus("small.ssdd"), |bytes| {
        scattered(read::ssdd::parse(bytes, &Conventions::default()))
    });
    fuzz_reader("bsdf", &corpus("small.bsdf"), |bytes| srbf_fit::read::rgl::parse(bytes).is_ok());
}
