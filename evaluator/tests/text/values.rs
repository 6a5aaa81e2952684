//! The text as C++ and as Metal, compiled and run beside the library.

use crate::driver::{Program, root};
use glam::Vec3;
use srbf_core::{
    Blend, BlendPart, Draws, FactorTable, Grid, GridView, Line, MAX_LOBES, Material, Mixture, PackOptions,
    PlaneLobe, Sheet, SheetMixture, SpectralColumns, SpectralMap, TiltedLobe, Towards, View, fresnel,
};
use srbf_evaluator::{Content, Language, Surface, export, functions, text};
use std::path::{Path, PathBuf};
use std::process::Command;

const N: usize = 4096;

/// Largest errors: of value, density and albedo; of the density and weight at a draw. The divisor of an error of a value: itself and the density times the
/// power. The worst is far from a lobe of sharpness 5400 at 2 degrees above the horizon: turning a direction in f32 rounds it.
pub const VALUE: f32 = 3e-4;
pub const AT_DRAW: f32 = 5e-4;

#[test]
fn the_header_is_the_text() {
    let path = root().join("include/srbf_device.hpp");
    let held = std::fs::read_to_string(&path).expect("include/srbf_device.hpp is there");
    let hint = "write it: cargo run --release -p srbf-evaluator --bin write cpp > include/srbf_device.hpp";
    assert!(held == text(Language::Cpp), "{hint}");
}

/// Uniform numbers.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn direction(&mut self) -> [f32; 3] {
        let z = 0.02 + 0.98 * f64::from(self.next());
        let phi = std::f64::consts::TAU * f64::from(self.next());
        let r = (1.0 - z * z).max(0.0).sqrt();
        [r * phi.cos(), r * phi.sin(), z].map(|v| v as f32)
    }
}

/// A brushed metal, on rings of views.
pub fn brushed() -> Vec<u8> {
    on_rings(8, 2, 0.0)
}

/// The same with mirrors, which stand along an axis.
pub fn mirrored() -> Vec<u8> {
    on_rings(4, 4, 0.7)
}

fn on_rings(azimuths: usize, turns: usize, axis: f32) -> Vec<u8> {
    let thetas = [0.0, 0.5, 1.0, 1.4];
    let step = std::f32::consts::TAU / (turns * if turns == 4 { azimuths - 1 } else { azimuths }) as f32;
    let views: Vec<(f32, f32)> = std::iter::once((0.0, 0.0))
        .chain((0..3 * azimuths).map(|i| (thetas[1 + i / azimuths], step * (i % azimuths) as f32)))
        .collect();
    let lobes: Vec<Vec<TiltedLobe>> = views
        .iter()
        .map(|(theta, azimuth)| {
            let lobe = |k: usize| TiltedLobe {
                // 0 in the planes of the mirrors.
                tilt: [theta * (0.8 + 0.1 * k as f32), 0.1 * theta * (0.5 * turns as f32 * azimuth).sin()],
                log2_sharpness: 8.0 - k as f32,
                log2_luminance: -0.9 - k as f32,
                color_differences: [-0.1, -0.3],
            };
            (0..5).map(lobe).collect()
        })
        .collect();
    let made: Vec<GridView<'_>> = views
        .iter()
        .zip(&lobes)
        .map(|((_, azimuth), lobes)| {
            let (s, c) = azimuth.sin_cos();
            let log2_squeeze = [c * c - s * s, -2.0 * c * s, s * s - c * c];
            GridView { log2_squeeze, log2_diffuse: -4.3, diffuse_color_differences: [-0.4, -0.7], lobes }
        })
        .collect();
    let grid = Grid { thetas: &thetas, azimuths, turns, axis, views: &made, squeezed: 3, factors: None };
    let mut bytes = vec![0; grid.encoded_len("made by tests")];
    let written = grid.encode("made by tests", &mut bytes).expect("the material is valid");
    bytes.truncate(written);
    bytes
}

/// Mirrored lobes, and factors that depend on the azimuth, an odd number of them, with its sign or without.
fn factored(is_signed: bool) -> Vec<u8> {
    let thetas = [0.0, 0.4, 0.9, 1.4];
    let lobes = thetas.map(|theta| {
        [0, 1, 2, 3].map(|k| PlaneLobe {
            angle: theta * (1.0 + 0.05 * k as f32),
            off_plane: if k == 3 { 0.3 * theta } else { 0.0 },
            log2_sharpness: 8.0 - 2.0 * k as f32,
            log2_luminance: 1.0 - 2.0 * k as f32,
            color_differences: [0.4, -0.2],
        })
    });
    let views = [0, 1, 2, 3].map(|v| View {
        theta: thetas[v],
        log2_squeeze: -thetas[v],
        log2_diffuse: -4.0,
        diffuse_color_differences: [0.1, 0.2],
        lobes: &lobes[v],
    });
    let (half, difference, azimuth) = (5, 7, 3);
    // Where there is no azimuth, nodes are the same for all.
    let factor = |n: usize| {
        let (i, j, k) = (n / difference % half, n % difference, n / difference / half);
        let turned = if i == 0 || j == 0 { 0 } else { k };
        [0.3 * (1 + i) as f32, 1.0 + 0.2 * turned as f32, 0.25 * (1 + j) as f32]
    };
    let factors: Vec<[f32; 3]> = (0..half * difference * azimuth).map(factor).collect();
    let albedo_differences = [[-0.25, 0.5, -0.125], [-0.25, 0.5, 0.25], [0.1, 0.2, 0.3], [0.0, 0.1, 0.2]];
    let factors = FactorTable {
        half,
        difference,
        azimuth,
        is_signed,
        factors: &factors,
        albedo_differences: &albedo_differences,
    };
    let line = Line { views: &views, squeezed: 2, mirrored: 1, factors: Some(factors) };
    let mut bytes = vec![0; line.encoded_len("made by tests")];
    let written = line.encode("made by tests", &mut bytes).expect("the material is valid");
    bytes.truncate(written);
    bytes
}

/// Factors, and spectra of four wavelengths or of one.
pub fn spectral(is_lidar: bool) -> Vec<u8> {
    let bytes = factored(true);
    let material = Material::from_bytes(&bytes[..]).expect("a material");
    let columns = [[0.1, -0.2, 1.5], [0.2, 0.9, 0.1], [0.9, 0.3, 0.0], [2.0, 1.0, -1.0]];
    let (nm, columns) = match is_lidar {
        true => (&[905.0][..], SpectralColumns::Luminance(&[1.0])),
        false => (&[420.0, 532.1, 640.0, 905.0][..], SpectralColumns::Rgb(&columns)),
    };
    let mut map = vec![0; SpectralMap::encoded_len(nm.len(), is_lidar)];
    SpectralMap::encode(nm, columns, 0.1, &mut map).expect("the map is valid");
    let map = SpectralMap::from_bytes(&map).expect("just encoded");
    let mut out = vec![0; material.with_spectral_map_len(map)];
    material.with_spectral_map(map, &mut out).expect("room for it");
    out
}

/// Rows of numbers: inputs, and the results of the library.
fn reference(bytes: &[u8]) -> (Vec<Vec<f32>>, Vec<Vec<f32>>) {
    let surface = Surface::from_bytes(bytes).expect("a material or a sheet");
    let is_sheet = matches!(surface, Surface::Sheet(_));
    let mut random = Random(88_172_645_463_325_252);
    let mut given = vec![vec![0.0; N]; 9];
    #[allow(clippy::needless_range_loop)] // several rows are written at a time
    for i in 0..N {
        let (wo, mut wi) = (random.direction(), random.direction());
        if i % 2 == 0 {
            // Near the mirror direction.
            let near = [-wo[0], -wo[1], wo[2]].map(|v| v + 0.2 * (random.next() - 0.5));
            let length = near.iter().map(|v| v * v).sum::<f32>().sqrt();
            wi = [near[0] / length, near[1] / length, near[2].abs() / length];
        }
        for c in 0..3 {
            (given[c][i], given[3 + c][i], given[6 + c][i]) = (wo[c], wi[c], random.next());
        }
        // Viewers and lights of a sheet stand on either side.
        if is_sheet {
            given[2][i] *= [1.0, -1.0][i / 2 % 2];
            given[5][i] *= [1.0, -1.0][i / 4 % 2];
        }
    }
    let mut out = vec![vec![0.0; N]; 14];
    {
        let rows = |from: usize| [0, 1, 2].map(|c| &given[from + c][..]);
        let mut parts = out.iter_mut().map(|row| &mut row[..]);
        let mut next = || parts.next().expect("fourteen rows");
        let (value, pdf) = ([next(), next(), next()], next());
        let samples = Draws {
            u: rows(6),
            direction: [next(), next(), next()],
            pdf: Some(next()),
            weight: Some([next(), next(), next()]),
        };
        let albedo = [next(), next(), next()];
        let towards = Towards { wi: rows(3), value: Some(value), pdf: Some(pdf) };
        match &surface {
            Surface::Material(material) => {
                material.ask(rows(0), towards.into()).expect("one length");
                material.ask(rows(0), samples.into()).expect("one length");
            }
            Surface::Sheet(sheet) => {
                sheet.ask(rows(0), towards.into()).expect("one length");
                sheet.ask(rows(0), samples.into()).expect("one length");
            }
        }
        for i in 0..N {
            let found = albedo_at(&surface, [0, 1, 2].map(|c| given[c][i]), given[5][i]).to_array();
            (0..3).for_each(|c| albedo[c][i] = found[c]);
        }
    }
    (given, out)
}

/// The albedo; of a sheet that of the half of the light.
fn albedo_at(surface: &Surface<&[u8]>, wo: [f32; 3], height: f32) -> Vec3 {
    match surface {
        Surface::Material(material) => {
            let mut mixture = Mixture::<MAX_LOBES>::empty();
            material.prepare(wo, &mut mixture).expect("a direction");
            mixture.albedo()
        }
        Surface::Sheet(sheet) => {
            let mut pair = SheetMixture::<MAX_LOBES>::empty();
            sheet.prepare(wo, &mut pair).expect("a direction");
            pair.albedos()[usize::from((wo[2] < 0.0) != (height < 0.0))]
        }
    }
}

fn largest<const C: usize>(numbers: [f32; C]) -> f32 {
    numbers.iter().fold(0.0, |most: f32, v| most.max(v.abs()))
}

fn text_of(errors: [f32; 5]) -> String {
    errors.map(|e| format!("{e:.1e}")).join(" ")
}

/// Compares, and prints the worst.
fn check(name: &str, language: Language, got: &[Vec<f32>], want: &[Vec<f32>]) {
    let mut worst = [0f32; 5];
    let mut elsewhere = 0;
    for i in 0..N {
        let apart = |rows: [usize; 3]| largest(rows.map(|r| got[r][i] - want[r][i]));
        let size = |rows: [usize; 3]| largest(rows.map(|r| want[r][i]));
        let power = got[14][i];
        let relative = |row: usize| (got[row][i] - want[row][i]).abs() / want[row][i];
        // Nothing at all, of a quarter that is black.
        if size([0, 1, 2]) == 0.0 {
            assert!(got[..4].iter().all(|row| row[i] == 0.0), "{name}: {i}");
        } else {
            worst[0] = worst[0].max(apart([0, 1, 2]) / size([0, 1, 2]).max(want[3][i] * power));
            worst[1] = worst[1].max(relative(3));
        }
        worst[2] = worst[2].max(apart([11, 12, 13]) / size([11, 12, 13]).max(power));
        if apart([4, 5, 6]) > 1e-4 {
            // A lobe chosen at the very edge between two may be the other one.
            elsewhere += 1;
            continue;
        }
        worst[3] = worst[3].max(relative(7));
        worst[4] = worst[4].max(apart([8, 9, 10]) / size([8, 9, 10]).max(power));
    }
    println!(
        "{name} {language:?}: value, density, albedo, density at a draw, weight {}, other lobe {elsewhere}",
        text_of(worst)
    );
    assert!(worst[..3].iter().all(|e| *e <= VALUE), "{name} {language:?}: {}", text_of(worst));
    assert!(
        worst[3..].iter().all(|e| *e <= AT_DRAW) && elsewhere <= 2,
        "{name} {language:?}: {} {elsewhere}",
        text_of(worst)
    );
}

#[test]
fn cpp_and_metal_say_what_the_library_says() {
    let mut programs = [Language::Cpp, Language::Metal]
        .map(|language| (language, Program::compile(language, language.name(), &["-O2"])));
    let presets = std::fs::read_dir(root().join("presets")).expect("presets are there");
    let mut materials: Vec<PathBuf> = presets
        .map(|entry| entry.expect("a file").path())
        .filter(|p| p.extension().is_some_and(|e| e == "srbf"))
        .collect();
    assert!(materials.len() >= 3);
    for (name, bytes) in [
        ("brushed", brushed()),
        ("brushed, with mirrors", mirrored()),
        ("factored", factored(false)),
        ("signed", factored(true)),
        ("spectral", spectral(false)),
        ("lidar", spectral(true)),
    ] {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.srbf"));
        std::fs::write(&path, bytes).expect("the target folder can be written");
        materials.push(path);
    }
    for material in materials {
        let bytes = std::fs::read(&material).expect("a material");
        let (given, want) = reference(&bytes);
        let spectra = Material::from_bytes(&bytes[..]).expect("a material");
        for (language, program) in &mut programs {
            let got = program.ask(&bytes, &given).expect("it answers").expect("a material");
            check(&material.file_stem().unwrap_or_default().to_string_lossy(), *language, &got, &want);
            for (i, u) in given[6].iter().enumerate() {
                let [column] = *spectra.primaries(&[300.0 + 700.0 * u]).columns();
                let apart = largest([0, 1, 2].map(|c| got[15 + c][i] - column[c]));
                assert!(apart <= 1e-4 * largest(column).max(1.0), "{}: {u}, {column:?}", material.display());
            }
        }
    }
}

/// A sheet of some quarters.
pub fn joined(quarters: [Option<&[u8]>; 4], is_symmetric: bool) -> Vec<u8> {
    let made = quarters.map(|bytes| bytes.map(|bytes| Material::from_bytes(bytes).expect("a material")));
    let quarters = made.each_ref().map(Option::as_ref);
    let mut bytes = vec![0; Sheet::encoded_len(quarters, "made by tests")];
    Sheet::encode(quarters, is_symmetric, "made by tests", &mut bytes).expect("the sheet is valid");
    bytes
}

/// Sheets by name: of four different quarters, alike on both sides, with quarters that are black.
pub fn sheets() -> Vec<(&'static str, Vec<u8>)> {
    let preset = |name: &str| std::fs::read(root().join("presets").join(name)).expect("a preset");
    let (red, grey) = (preset("garnet_red.srbf"), preset("sheets/ground_glass.srbf"));
    let parts = [mirrored(), factored(true), spectral(false), red];
    let [a, b, c, d] = parts.each_ref().map(|bytes| Some(&bytes[..]));
    vec![
        ("four quarters", joined([a, b, c, d], false)),
        ("alike", joined([c, d, None, None], true)),
        ("black", joined([d, None, None, b], false)),
        ("ground glass", grey),
    ]
}

#[test]
fn sheets_say_what_the_library_says() {
    let mut programs = [Language::Cpp, Language::Metal]
        .map(|language| (language, Program::compile(language, &format!("{language:?}-sheet"), &["-O2"])));
    for (name, bytes) in sheets() {
        let (given, want) = reference(&bytes);
        for (language, program) in &mut programs {
            let got = program.ask(&bytes, &given).expect("it answers").expect("a sheet");
            check(name, *language, &got, &want);
        }
    }
}

#[test]
fn blends_say_what_the_library_says() {
    let parts = [brushed(), std::fs::read(root().join("presets/cayman.srbf")).expect("a preset")];
    let bytes = joined([Some(&parts[0]), Some(&parts[1]), None, None], true);
    let [first, second] = parts.each_ref().map(|bytes| Material::from_bytes(&bytes[..]).expect("a material"));
    let all = [
        BlendPart::new(&first, 1.0).tinted([0.7; 3]),
        BlendPart::new(&second, 1.0).tinted([0.3, 0.24, 0.18]),
    ];
    let blend = Blend::new(&all).expect("sound weights");
    let mut random = Random(3);
    let hits: Vec<[[f32; 3]; 3]> = (0..N)
        .map(|_| [random.direction(), random.direction(), [random.next(), random.next(), random.next()]])
        .collect();
    let given: Vec<Vec<f32>> =
        (0..9).map(|row| hits.iter().map(|hit| hit[row / 3][row % 3]).collect()).collect();
    let mut want = vec![vec![0.0; N]; 14];
    for (i, [wo, wi, u]) in hits.iter().enumerate() {
        let (sample, (value, pdf)) = blend.sample_and_evaluate(*wo, *u, *wi);
        let sample = sample.expect("it reflects");
        let rows = [value.to_array(), [pdf, sample.direction.x, sample.direction.y]].concat();
        let rows = [rows, vec![sample.direction.z, sample.pdf], sample.weight.to_array().to_vec()].concat();
        let rows = [rows, blend.albedo(*wo).to_array().to_vec()].concat();
        want.iter_mut().zip(rows).for_each(|(want, number)| want[i] = number);
    }
    for language in [Language::Cpp, Language::Metal] {
        let folder = format!("{language:?}-blend");
        let mut program = Program::compile_with(language, &folder, &["-O2"], &["blend"]);
        let got = program.ask(&bytes, &given).expect("it answers").expect("a sheet");
        check("blend", language, &got, &want);
        for (i, [wo, wi, _]) in hits.iter().enumerate() {
            let coat = (1.0 - fresnel(1.5, wo[2])) * (1.0 - fresnel(1.5, wi[2]));
            assert!((got[15][i] - coat).abs() < 1e-5, "{language:?} {i}: {} {coat}", got[15][i]);
            assert!((got[16][i] - fresnel(1.33, wi[2])).abs() < 1e-5, "{language:?} {i}");
        }
    }
}

#[test]
fn exports_hold_their_sheet() {
    let sheets = sheets();
    for language in Language::ALL {
        let [material, sheet, blend] =
            [Content::Material, Content::Sheet, Content::Blend].map(|content| functions(language, content));
        for more in [sheet, blend] {
            assert!(more.starts_with(material.trim_end_matches(language_end(language))));
        }
        for (name, bytes) in &sheets {
            let surface = Surface::from_bytes(&bytes[..]).expect("a sheet");
            let written = surface.export(language);
            let last = bytes.last_chunk().map(|word| format!("0x{:08x}u\n", u32::from_le_bytes(*word)));
            assert!(surface.can_read() && written.contains("srbf_sheet_sample("), "{name}");
            assert!(written.contains(&last.expect("a word")), "{name}, {language:?}");
            for token in ["SELECT", "\nFN ", "STRUCT", "WORD(", "PLACE(", " LOBES", " KEEP("] {
                assert!(!written.contains(token), "{name}, {language:?}: {token}");
            }
        }
    }
    // A sheet in codes is written in plain numbers.
    let packed = |bytes: &[u8]| {
        let material = Material::from_bytes(bytes).expect("a material");
        let mut out = vec![0; material.packed_len(PackOptions::default(), "")];
        material.pack(PackOptions::default(), "", &mut out).expect("there is room");
        out
    };
    let (a, b) = (packed(&mirrored()), packed(&factored(false)));
    let bytes = joined([Some(&a), None, Some(&b), Some(&a)], false);
    let surface = Surface::from_bytes(&bytes[..]).expect("a sheet");
    let plain = surface.plain_bytes().into_owned();
    let mut program = Program::compile(Language::Cpp, "packed-sheet", &["-O2"]);
    let (given, want) = reference(&bytes);
    let got = program.ask(&plain, &given).expect("it answers").expect("a sheet");
    check("packed", Language::Cpp, &got, &want);
    let json = surface.json();
    assert!(json.contains("\"front-transmission\": null") && json.matches("\"theta\"").count() > 9);
}

/// What stands behind the functions of a material, within the namespace.
fn language_end(language: Language) -> &'static str {
    match language {
        Language::Cpp | Language::Cuda => include_str!("../../src/tail.hpp"),
        _ => "",
    }
}

#[test]
fn the_lines_of_the_page_run() {
    let page = std::fs::read_to_string(root().join("docs/use-from-shaders.md")).expect("the page is there");
    let (_, rest) = page.split_once("```cpp\n").expect("a block of C++");
    let (lines, _) = rest.split_once("```").expect("its end");
    let preset = root().join("presets/garnet_red.srbf");
    let bytes = std::fs::read(preset).expect("the preset is there");
    let words: Vec<String> =
        bytes.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word).to_string() + "u").collect();
    let program = format!(
        "#include \"srbf_device.hpp\"\n#include <cstdio>\nusing namespace srbf_device;\n\
         static const uint32_t words[] = {{{}}};\n\
         int main() {{\nvec3 wo(-0.6f, 0.0f, 0.8f), wi(0.0f, 0.6f, 0.8f);\nfloat u0 = 0.3f, u1 = 0.6f, u2 = 0.9f;\n{lines}\n\
         std::printf(\"%g %g %g\", sample.pdf, light.value.x, albedo.x);\n}}\n",
        words.join(",")
    );
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (source, built) = (folder.join("page.cpp"), folder.join("page"));
    std::fs::write(&source, program).expect("a file is written");
    let mut compiler = Command::new("g++");
    compiler.args(["-std=c++17", "-I"]).arg(root().join("include")).arg(&source).arg("-o").arg(&built);
    assert!(compiler.status().expect("g++ is installed").success(), "the lines of the page do not compile");
    let said = Command::new(&built).output().expect("the program runs").stdout;
    let said: Vec<f32> =
        String::from_utf8(said).expect("numbers").split(' ').map(|n| n.parse().expect("a number")).collect();
    let material = Material::from_bytes(bytes).expect("the preset is valid");
    let mut mixture = Mixture::<16>::empty();
    material.prepare([-0.6, 0.0, 0.8], &mut mixture).expect("a direction");
    let sample = mixture.sample([0.3, 0.6, 0.9]).expect("it reflects");
    let want = [sample.pdf, mixture.evaluate([0.0, 0.6, 0.8]).x, mixture.albedo().x];
    for (said, want) in said.iter().zip(want) {
        assert!((said - want).abs() <= AT_DRAW * want, "{said} for {want}");
    }
    assert_eq!(said.len(), 3);
}

#[test]
fn words_that_are_no_material_are_refused() {
    let mut program = Program::compile(Language::Cuda, "cuda", &["-O2"]);
    let bytes = factored(true);
    let table = bytes.windows(4).position(|w| w == b"FACT").expect("there are factors");
    let with = |offset: usize, value: u8| {
        let mut broken = bytes.clone();
        broken[offset] = value;
        broken
    };
    let cuts = [0, 4, 47, 48, 100, bytes.len() / 2].map(|length| bytes[..length].to_vec());
    let changed = [
        (0, 0),
        (8, 9),
        (12, 2),
        (21, 5),
        (24, 65),
        (28, 60),
        (32, 60),
        (40, 1),
        (46, 99),
        (table, b'D'),
        (table + 5, 99),
        (table + 8, 1),
        (table + 10, 9),
    ];
    let lidar = spectral(true);
    let block = lidar.windows(4).position(|w| w == b"spec").expect("there are spectra") + 8;
    // Kind, bits, count, wavelength, scale: 905 nm, low 1, step 0.
    for (offset, value) in [(-4, 9), (0, 2), (1, 9), (2, 2), (2, 0), (3, 9), (11, 0xff), (13, 0x80)] {
        let mut broken = lidar.clone();
        broken[block.strict_add_signed(offset)] = value;
        let answer = program.ask(&broken, &vec![vec![]; 9]).expect("it answers");
        assert!(answer.is_err(), "{offset} {value}");
    }
    for broken in cuts.into_iter().chain(changed.map(|(offset, value)| with(offset, value))) {
        let answer = program.ask(&broken, &vec![vec![]; 9]).expect("it answers");
        assert!(answer.is_err(), "{} bytes", broken.len());
    }
}

#[test]
fn exports_hold_their_material() {
    let bytes = std::fs::read(root().join("presets/garnet_red.srbf")).expect("the preset");
    let material = Material::from_bytes(bytes.as_slice()).expect("a material");
    for language in Language::ALL {
        let written = export(&material, language);
        assert!(
            written.contains("srbf_data")
                && written.contains("0x46425253u") != written.contains("0x42525389u")
        );
        assert_eq!(Language::from_name(language.name()), Some(language));
        // Every line of the text is there with its comments.
        assert!(written.contains("The part below the horizon, mirrored up."));
        for token in ["SELECT", "\nFN ", "STRUCT", "WORD(", " LOBES", " KEEP("] {
            assert!(!written.contains(token), "{language:?}: {token}");
        }
    }
    let json = srbf_evaluator::json(&material);
    assert!(json.starts_with('{') && json.matches("\"theta\"").count() == material.view_count());
}
