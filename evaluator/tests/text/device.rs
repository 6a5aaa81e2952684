//! Files of strangers and directions that are none, under AddressSanitizer and UBSan: nothing outside is read, no NaN becomes a whole number,
//! and all answers are finite. Where core takes a file too, answers are core's.
//!
//! `SRBF_FUZZ=N cargo test --release -p srbf-evaluator device` for N files in place of the few of every test run.

use crate::driver::{Program, root};
use crate::values::{AT_DRAW, VALUE, sheets};
use glam::Vec3;
use srbf_core::{FormatError, LeaveOut, Material, Mixture};
use srbf_evaluator::{Language, Surface, can_read};
use srbf_tests::attack::{above, any_direction, kept, mutate, put_quarters_right, put_right, uniform};
use srbf_tests::inputs::Random;
use srbf_tests::seeds::extreme;
use std::path::Path;

/// Files of an ordinary run: seconds.
const FILES: u64 = 10_000;

/// Hits of a file: one that is compared with core, and others.
const HITS: usize = 6;

/// Core's names of numbers that are out of their ranges.
const NUMBERS: [&str; 9] = [
    "angle of a view",
    "squeeze",
    "squeeze matrix",
    "diffuse albedo",
    "angle of an axis",
    "angle out of the plane of incidence",
    "sharpness",
    "amplitude",
    "albedo difference",
];

/// Largest errors of value, density, albedo, and density at a draw.
const BOUNDS: [f32; 4] = [VALUE, VALUE, VALUE, AT_DRAW];

fn files() -> u64 {
    std::env::var("SRBF_FUZZ").map_or(FILES, |n| n.parse().expect("SRBF_FUZZ is a number of files"))
}

/// The text under sanitizers, and with an option more.
fn sanitized(language: Language, folder: &str, more: &str) -> Program {
    let sanitizers = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    Program::compile(language, folder, &[&["-O1", "-g"], &sanitizers[..], &[more]].concat())
}

/// Materials to begin with.
fn seeds() -> Vec<Vec<u8>> {
    let presets = ["garnet_red", "cayman"].map(|name| root().join(format!("presets/{name}.srbf")));
    let presets = presets.map(|path| std::fs::read(path).expect("a preset"));
    kept("material").into_iter().map(|(_, bytes)| bytes).chain(presets).collect()
}

/// Writes a file of interest; its place.
fn keep(bytes: &[u8], file: u64) -> String {
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("device-{file}.srbf"));
    std::fs::write(&kept, bytes).expect("the target folder can be written");
    kept.display().to_string()
}

/// Asks; where the program ends, the sanitizer has said why.
fn ask(program: &mut Program, bytes: &[u8], hits: &[[Vec3; 3]], file: u64) -> Result<Vec<Vec<f32>>, i32> {
    let row = |row: usize| hits.iter().map(|hit| hit[row / 3][row % 3]).collect::<Vec<f32>>();
    let given: Vec<Vec<f32>> = (0..9).map(row).collect();
    program.ask(bytes, &given).unwrap_or_else(|error| panic!("{}, {hits:?}: {error}", keep(bytes, file)))
}

/// Any number.
fn number(random: &mut Random) -> f32 {
    const ENDS: [f32; 10] =
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, 1e30, -1e30, f32::MAX, 1e-30, -1e-45, 1.0];
    match random.below(4) {
        0 => f32::from_bits((random.below(1 << 16) << 16 | random.below(1 << 16)) as u32),
        1 => random.between(-2.0, 2.0),
        _ => ENDS[random.below(ENDS.len())],
    }
}

/// A direction, or something else.
fn vector(random: &mut Random) -> [f32; 3] {
    let mut made = any_direction(random).to_array();
    match random.below(4) {
        0 => made = [(); 3].map(|()| number(random)),
        1 => made[random.below(3)] = number(random),
        2 => made = made.map(|x| x * [0.0, 0.1, 0.9, 1.1, 7.0, 1e30][random.below(6)]),
        _ => {}
    }
    made
}

/// Three vectors: wo, wi, uniform numbers.
fn hit(random: &mut Random) -> [Vec3; 3] {
    [(); 3].map(|()| vector(random).into())
}

/// Replaces one to four words of some: by ends of ranges of the format, or by any number.
fn renumber(random: &mut Random, words: &mut [[u8; 4]]) {
    const ENDS: [f32; 8] = [1.0, 1.570_796_4, 2.0, 16.0, 26.5, 60.0, 100.0, 126.0];
    for _ in 0..=random.below(4) {
        let end = ENDS[random.below(ENDS.len())];
        let new = if random.below(3) == 0 { number(random) } else { random.end(-end, end) };
        let at = random.below(words.len());
        words[at] = new.to_le_bytes();
    }
}

fn is_number(numbers: &[f32]) -> bool {
    numbers.iter().all(|v| v.is_finite())
}

/// The promises for every hit, whatever it was asked.
fn is_sound(given: [Vec3; 3], got: &[f32], place: &str) {
    let place = || format!("{place}: {given:?} gave {got:?}");
    assert!(is_number(got), "{}", place());
    let [wo, wi, _] = given;
    let (pdf, there, drawn) = (got[3], got[7], Vec3::new(got[4], got[5], got[6]));
    assert!(pdf >= 0.0 && there >= 0.0 && got[14] >= 0.0, "{}", place());
    assert!((drawn.length() - 1.0).abs() < 1e-3 && drawn.z >= 0.0, "{}", place());
    // A length that is far off, or none.
    let is_none = |d: Vec3| d.is_nan() || (d.length_squared() - 1.0).abs() >= 0.6;
    if is_none(wo) || wo.z < 0.0 {
        assert!(got[..4].iter().chain(&got[7..11]).all(|v| *v == 0.0), "{}", place());
    } else if is_none(wi) || wi.z <= 0.0 {
        assert!(got[..4].iter().all(|v| *v == 0.0), "{}", place());
    }
}

/// The least and the largest of core's answers for directions that round to these: red, green, blue, density, albedo.
struct Range {
    low: [f32; 7],
    high: [f32; 7],
}

impl Range {
    fn new(material: &Material<&[u8]>, wo: Vec3, wi: Vec3) -> Self {
        let mut mixture = Mixture::<64>::empty();
        // With every fold, as the text has them.
        let whole = LeaveOut::new(0.0, 0.0).expect("shares");
        let mut range = Self { low: [f32::INFINITY; 7], high: [f32::NEG_INFINITY; 7] };
        for n in 0..19 {
            // Themselves, and some roundings away in each of their six numbers.
            let near = |d: Vec3, number: usize| {
                let mut d = d.to_array();
                if let Some(x) = number.checked_sub(1).and_then(|at| d.get_mut(at / 3)) {
                    *x += [1.0, -2.0, 4.0][number % 3] * f32::EPSILON;
                }
                Vec3::new(d[0], d[1], d[2].max(0.0))
            };
            let (wo, wi) = (near(wo, n), near(wi, n.saturating_sub(9)));
            material.prepare_with(wo, whole.into(), &mut mixture).expect("a direction");
            let (value, pdf) = mixture.evaluate_and_pdf(wi);
            let albedo = mixture.albedo();
            for (i, v) in
                [value.x, value.y, value.z, pdf, albedo.x, albedo.y, albedo.z].into_iter().enumerate()
            {
                (range.low[i], range.high[i]) = (range.low[i].min(v), range.high[i].max(v));
            }
        }
        range
    }

    /// How far numbers from `from` on are from the range, over their size; `None` where roundings decide them.
    fn apart(&self, from: usize, got: &[f32], least: f32) -> Option<f32> {
        let (low, high) = (&self.low[from..][..got.len()], &self.high[from..][..got.len()]);
        let size = low.iter().chain(high).fold(least, |most, v| most.max(v.abs()));
        let spread = low.iter().zip(high).fold(0f32, |most, (l, h)| most.max(h - l));
        let beyond = |(i, v): (usize, &f32)| (low[i] - v).max(v - high[i]);
        let apart = got.iter().enumerate().map(beyond).fold(0.0, f32::max);
        (spread <= 1e-4 * size).then(|| apart / size)
    }
}

/// How far value, density, albedo and the density at the draw are from core's; `None` where roundings decide, and where the text has nothing.
fn errors(material: &Material<&[u8]>, [wo, wi, _]: [Vec3; 3], got: &[f32]) -> Option<[Option<f32>; 4]> {
    let (power, drawn) = (got[14], Vec3::new(got[4], got[5], got[6]));
    let [towards, at_draw] = [wi, drawn].map(|wi| Range::new(material, wo, wi));
    // It has nothing in the horizon itself, nor below 2^-100.
    let is_there = wi.z > 0.0 && drawn.z > 0.0 && power > 1e-20 && towards.high[3] * power > 1e-20;
    is_there.then(|| {
        [
            towards.apart(0, &got[..3], towards.high[3] * power),
            towards.apart(3, &got[3..4], 0.0),
            towards.apart(4, &got[11..14], power),
            at_draw.apart(3, &got[7..8], 0.0),
        ]
    })
}

#[test]
fn nothing_outside_is_read_and_answers_are_those_of_core() {
    // `undefined` knows nothing of conversions of a NaN.
    let mut program = sanitized(Language::Cpp, "device", "-fsanitize=float-cast-overflow");
    let (files, seeds, mut random) = (files(), seeds(), Random(5));
    let (mut taken, mut by_core, mut refused, mut compared) = (0, 0, 0, 0);
    let mut worst = [0f32; 4];
    for file in 0..files {
        let seed = &seeds[random.below(seeds.len())];
        let mut bytes = match random.below(4) {
            0 => seed.clone(),
            1 => extreme(&mut random),
            2 => mutate(&mut random, seed),
            _ => {
                let mut bytes = seed.clone();
                renumber(&mut random, bytes[48..].as_chunks_mut().0);
                bytes
            }
        };
        if random.below(8) > 0 {
            put_right(&mut bytes);
        }
        let place = format!("file {file}, {} bytes", bytes.len());
        let mut hits: Vec<[Vec3; 3]> = (0..HITS).map(|_| hit(&mut random)).collect();
        hits[0] = [above(&mut random), above(&mut random), [(); 3].map(|()| uniform(&mut random)).into()];
        let answer = ask(&mut program, &bytes, &hits, file);
        let by_library = Material::from_bytes(&bytes[..]);
        if let Err(FormatError::Field { name, .. }) = by_library {
            let is_number = NUMBERS.contains(&name);
            assert!(!is_number || answer.is_err(), "{place}: core refuses its {name}");
            refused += u64::from(is_number);
        }
        let material = by_library.ok().filter(|m| can_read(m) && m.code_bits().is_none());
        let Ok(rows) = answer else {
            assert!(material.is_none(), "{place}: refused for word {answer:?}: {bytes:02x?}");
            continue;
        };
        taken += 1;
        let got = |hit: usize| rows.iter().map(|row| row[hit]).collect::<Vec<f32>>();
        (0..HITS).for_each(|hit| is_sound(hits[hit], &got(hit), &place));
        let Some(material) = material else { continue };
        by_core += 1;
        for (i, error) in errors(&material, hits[0], &got(0)).into_iter().flatten().enumerate() {
            let Some(error) = error else { continue };
            compared += 1;
            worst[i] = worst[i].max(error);
            if error > BOUNDS[i] {
                println!("{}: number {i}, {error:.1e} from core's, {:?}", keep(&bytes, file), hits[0]);
            }
        }
    }
    println!(
        "{files} files, {taken} taken, {by_core} by core too, {refused} refused for a number, {compared} numbers compared, worst {worst:?}"
    );
    assert!(
        8 * taken > files && 8 * by_core > files && 100 * refused > files && compared > by_core,
        "too few are sound to say something"
    );
    assert!(worst.iter().zip(BOUNDS).all(|(worst, bound)| *worst <= bound), "{worst:?}");
}

/// A shader has no `srbf_check`, so that views and factors may have any numbers; and its compiler may forget that there are NaN.
#[test]
fn nothing_outside_is_read_whatever_the_numbers() {
    let mut program = sanitized(Language::Metal, "device-metal", "-ffast-math");
    let (seeds, mut random) = (seeds(), Random(6));
    let mut taken = 0;
    for file in 0..files() / 2 {
        let mut bytes = match random.below(2) {
            0 => seeds[random.below(seeds.len())].clone(),
            _ => extreme(&mut random),
        };
        let is_plain = |m: &Material<&[u8]>| m.bytes()[8] == 3 && m.code_bits().is_none();
        if !Material::from_bytes(&bytes[..]).as_ref().is_ok_and(is_plain) {
            continue;
        }
        taken += 1;
        // Behind the head of the block of lobes, and that of the factors, which follows it.
        let words = bytes.as_chunks_mut().0;
        let end_of_lobes = 12 + u32::from_le_bytes(words[11]) as usize / 4;
        let (lobes, rest) = words.split_at_mut(end_of_lobes);
        renumber(&mut random, &mut lobes[12..]);
        if rest[0] == *b"FACT" && random.below(2) == 0 {
            let end = 2 + u32::from_le_bytes(rest[1]) as usize / 4;
            renumber(&mut random, &mut rest[3..end]);
        }
        let hits: Vec<[Vec3; 3]> = (0..HITS).map(|_| hit(&mut random)).collect();
        let _ = ask(&mut program, &bytes, &hits, file);
    }
    assert!(8 * taken > files(), "too few are sound to say something");
}

/// A sheet that core takes is taken; of a sheet that is taken all answers are numbers, whatever the vectors.
#[test]
fn nothing_outside_a_sheet_is_read() {
    let mut program = sanitized(Language::Cpp, "device-sheet", "-fsanitize=float-cast-overflow");
    let seeds: Vec<Vec<u8>> = kept("sheet").into_iter().map(|(_, bytes)| bytes).collect();
    let seeds = [seeds, sheets().into_iter().map(|(_, bytes)| bytes).collect()].concat();
    let (mut random, mut taken, mut by_core) = (Random(7), 0, 0);
    for file in 0..files() / 4 {
        let seed = &seeds[random.below(seeds.len())];
        let mut bytes = mutate(&mut random, seed);
        if random.below(8) > 0 {
            put_quarters_right(&mut bytes);
            put_right(&mut bytes);
        }
        let hits: Vec<[Vec3; 3]> = (0..HITS).map(|_| hit(&mut random)).collect();
        let answer = ask(&mut program, &bytes, &hits, file);
        let is_whole = |of: &Surface<&[u8]>| of.can_read() && of.plain_bytes() == bytes;
        let is_sound = Surface::from_bytes(&bytes[..]).as_ref().is_ok_and(is_whole);
        by_core += u64::from(is_sound);
        let Ok(rows) = answer else {
            assert!(!is_sound, "{}: refused for word {answer:?}", keep(&bytes, file));
            continue;
        };
        taken += 1;
        for row in [&rows[..4], &rows[7..15]].concat() {
            assert!(is_number(&row), "{}: {hits:?} gave {row:?}", keep(&bytes, file));
        }
        assert!(rows[3].iter().chain(&rows[7]).all(|pdf| *pdf >= 0.0), "{}: {hits:?}", keep(&bytes, file));
    }
    println!("{} files, {taken} taken, {by_core} by core too", files() / 4);
    assert!(128 * taken > files() && 128 * by_core > files(), "too few are sound to say something");
}
