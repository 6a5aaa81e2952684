//! Makes the seeds of the attacks, small valid files of every format, in `fuzz/seeds/`: no measurement is in them.
//!
//! `cargo run --release -p srbf-tests --bin seeds` writes them; with `--check` it compares them with the files that are there.

use exr::image::write::layers::WritableLayers;
use exr::prelude::{
    Blocks, Compression, Encoding, Image, Layer, LayerAttributes, LineOrder, SpecificChannels, Vec2,
    WritableImage, f16,
};
use srbf_core::{Environment, Material, PackOptions, Sheet, environment_len};
use srbf_tests::attack::TARGETS;
use srbf_tests::inputs::Random;
use srbf_tests::kinds::{KINDS, packed, turned_materials};
use srbf_tests::seeds;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::io::Cursor;
use std::path::Path;
use std::process::ExitCode;

/// Files by their names within the folder.
type Files = BTreeMap<String, Vec<u8>>;

fn main() -> ExitCode {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/seeds");
    let files = files();
    let missing: Vec<_> =
        TARGETS.iter().filter(|t| !files.keys().any(|f| f.starts_with(&format!("{}/", t.name)))).collect();
    assert!(missing.is_empty(), "targets without a seed: {missing:?}");
    let is_check = std::env::args().nth(1).is_some_and(|argument| argument == "--check");
    let mut differ = Vec::new();
    for (name, bytes) in &files {
        let path = folder.join(name);
        if std::fs::read(&path).ok().as_ref() == Some(bytes) {
            continue;
        }
        differ.push(name);
        if !is_check {
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder that can be made");
            std::fs::write(&path, bytes).expect("a file that can be written");
        }
    }
    println!("{} seeds, {} {}", files.len(), differ.len(), if is_check { "differ" } else { "written" });
    if is_check && !differ.is_empty() {
        eprintln!("not as they are made: {differ:?}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

/// Two rotations of a sample.
const ZEMAX: &str = "Source Measured\nSymmetry Asymmetrical4D\nSpectralContent Monochrome\nScatterType BRDF\n\
    SampleRotation 2\n0 90\nAngleOfIncidence 1\n30\nScatterAzimuth 2\n0 180\nScatterRadial 2\n0 20\n\n\
    Monochrome\nDataBegin\nTIS 0.5\n.1 .2\n.1 .3\nTIS 0.5\n.2 .2\n.2 .4\nDataEnd\n";

/// Two planes of incidence.
const LIGHTTOOLS: &str = "Symmetry Asymmetric\nSpectralContent Monochrome\nScatterAzimuth 4\n0 90 180 270\nScatterRadial 2\n\
    0 30\nDataBegin\nAOI 30\nPOI 0\nSide Front\nScatterType BRDF\nTIS .3\n.1 .1 .1 .1 .1 .1 .1 .9\n\
    AOI 30\nPOI 90\nSide Front\nScatterType BRDF\nTIS .3\n.1 .1 .1 .1 .1 .1 .1 .5\nDataEnd\n";

/// Two angles of a sample.
const SPEOS: &str = "OPTIS - Anisotropic BSDF surface file v8.0\n0\nc\n1\nd0 1 0\n1 0\n1\n2\n0 90\n1\n20\n1\n20\n20 0\n\
    2\n350 50\n850 50\n2 2\n0 180\n0 1 1\n40 2 1\n2 2\n0 180\n0 1 1\n40 3 1\nEnd of file\n";

/// A table of text with a turn.
const ROTATION: &str = "theta_i,phi_i,theta_o,phi_o,rotation,f\n20,0,30,180,0,0.1\n20,0,30,180,90,0.3\n40,0,20,90,0,0.2\n\
    40,0,20,90,90,0.1\n60,0,70,180,45,2\n";

fn files() -> Files {
    let mut files = Files::new();
    materials(&mut files);
    light(&mut files);
    maps(&mut files);
    tables(&mut files);
    let mut add = |name: &str, bytes: &[u8]| files.insert(name.to_owned(), bytes.to_vec());
    for (name, text) in [
        ("lambert", "lambert:albedo=0.6/0.2/0.1"),
        ("phong", "phong:diffuse=0.3,specular=0.3,exponent=50"),
        ("ward", "ward:diffuse=0.2,specular=0.3,alpha_x=0.1,alpha_y=0.4"),
        ("ggx", "ggx:alpha=0.2,ior=1.5"),
    ] {
        add(&format!("exports/{name}"), text.as_bytes());
    }
    let others: [(&str, &[u8]); 11] = [
        ("zemax", include_bytes!("../../corpus/zemax.bsdf")),
        ("lighttools", include_bytes!("../../corpus/lighttools.bsdf")),
        ("speos-anisotropic", include_bytes!("../../corpus/small.anisotropicbsdf")),
        ("speos-spectral", include_bytes!("../../corpus/speos.brdf")),
        ("openmaterial", include_bytes!("../../corpus/small.xompt")),
        ("alta", include_bytes!("../../corpus/alta.dat")),
        ("pgii", include_bytes!("../../corpus/pgii.txt")),
        ("ssdd", include_bytes!("../../corpus/small.ssdd")),
        ("fred", include_bytes!("../../corpus/small.fred")),
        ("numpy", include_bytes!("../../corpus/small.npy")),
        ("records", include_bytes!("../../corpus/records.json")),
    ];
    for (which, (name, file)) in (0u8..).zip(others) {
        add(&format!("formats/{name}"), &[&[which][..], file].concat());
    }
    // Samples that were turned.
    for (name, which, text) in [("zemax", 0, ZEMAX), ("lighttools", 1, LIGHTTOOLS), ("speos", 2, SPEOS)] {
        add(&format!("formats/{name}-turned"), &[&[which], text.as_bytes()].concat());
    }
    add("csv/rotation", ROTATION.as_bytes());
    add("window/both-sides", include_bytes!("../../corpus/small.xml"));
    add("window/tree-of-three", include_bytes!("../../corpus/tree3.xml"));
    add("window/tree-of-four", include_bytes!("../../corpus/tree4.xml"));
    let own = "Host: 127.0.0.1:80\r\nOrigin: http://127.0.0.1:80\r\nContent-Length:";
    for (name, request) in [
        ("get", "GET /page.js HTTP/1.1\r\nHost: 127.0.0.1:80\r\n\r\n".to_owned()),
        ("head", "HEAD /?x HTTP/1.1\r\nHost: localhost:80\r\nContent-Length: 0\r\n\r\n".to_owned()),
        ("open", format!("POST /open?a%20%C3%A4.csv HTTP/1.1\r\n{own} 4\r\n\r\nrows")),
        ("export", format!("POST /export?glsl HTTP/1.1\r\nTransfer-Encoding:\r\n{own} 0\r\n\r\n")),
    ] {
        add(&format!("view/{name}"), request.as_bytes());
    }
    // Half plane waves: enough to be no constant.
    let weights = |n: usize| ((n as f32 * 0.7).sin() * 0.3).to_le_bytes();
    add("neural/one", &(0..675).flat_map(weights).collect::<Vec<u8>>());
    let doubles = |values: &[f64]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    for (name, values) in [
        ("even", &[1.0, 2.0, 0.5, 100.0][..]),
        ("gaps", &[-1.0, 0.0, 3.0]),
        ("large", &[1e300, 1e30, 1.0]),
        ("small", &[1e-300, 1e-45, 0.0]),
    ] {
        add(&format!("merl/{name}"), &[vec![0], doubles(values)].concat());
    }
    for (name, values) in [("even", &[0.1, 0.2, 0.3, 4.0, 5.0][..]), ("marks", &[-999.0, 0.5, 0.0])] {
        add(&format!("utia/{name}"), &[vec![0], doubles(values)].concat());
    }
    files
}

/// Pictures of light in OpenEXR, by each compression that the page reads: `web/check/heads.mjs` has their numbers.
fn maps(files: &mut Files) {
    let tiles = Blocks::Tiles(Vec2(16, 8));
    for (name, size, compression, blocks, line_order) in [
        ("none", (5, 3), Compression::Uncompressed, Blocks::ScanLines, LineOrder::Increasing),
        ("tiles", (19, 34), Compression::RLE, tiles, LineOrder::Increasing),
        ("rows", (19, 34), Compression::ZIP1, Blocks::ScanLines, LineOrder::Decreasing),
        ("zip", (40, 20), Compression::ZIP16, Blocks::ScanLines, LineOrder::Increasing),
        ("wavelets", (19, 34), Compression::PIZ, Blocks::ScanLines, LineOrder::Increasing),
        ("losses", (5, 3), Compression::PXR24, Blocks::ScanLines, LineOrder::Increasing),
    ] {
        let encoding = Encoding { compression, blocks, line_order };
        let pixel = |Vec2(x, y): Vec2<usize>| {
            let [x, y] = [x as f32, y as f32];
            (x / 3.0, f16::from_f32(y / 4.0 + x / 16.0), f16::from_f32(x * y % 32.0))
        };
        let channels = SpecificChannels::build()
            .with_channel("R")
            .with_channel("G")
            .with_channel("B")
            .with_pixel_fn(pixel);
        let layer = Layer::new(size, LayerAttributes::default(), encoding, channels);
        files.insert(format!("scene-exr/{name}"), written(&Image::from_layer(layer)));
    }
    // As many values as need the wavelets of 16 bits.
    let encoding = Encoding {
        compression: Compression::PIZ,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let pixel = |Vec2(x, y): Vec2<usize>| (f16::from_bits((640 * y + x) as u16),);
    let channels = SpecificChannels::build().with_channel("Y").with_pixel_fn(pixel);
    let layer = Layer::new((640, 32), LayerAttributes::default(), encoding, channels);
    files.insert("scene-exr/many-values".into(), written(&Image::from_layer(layer)));
}

/// The bytes of a picture.
fn written<'a, L: WritableLayers<'a> + 'a>(image: impl WritableImage<'a, L>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).expect("a picture that can be written");
    bytes.into_inner()
}

/// Materials, and mixtures of one's own.
fn materials(files: &mut Files) {
    files.insert("material/factored".into(), seeds::factored());
    for (name, bytes) in [
        ("version1", &include_bytes!("../../corpus/version1.srbf")[..]),
        ("version2", include_bytes!("../../corpus/version2.srbf")),
    ] {
        files.insert(format!("material/{name}"), bytes.to_vec());
    }
    let kinds =
        [0, 4].map(|kind: usize| Material::from_bytes(KINDS[kind].bytes()).expect("a valid material"));
    for (name, quarters, is_symmetric) in [
        ("both-sides", [Some(&kinds[0]), None, None, Some(&kinds[1])], false),
        ("alike", [None, Some(&kinds[1]), None, None], true),
    ] {
        let mut bytes = vec![0; Sheet::encoded_len(quarters, "a seed")];
        Sheet::encode(quarters, is_symmetric, "a seed", &mut bytes).expect("valid materials");
        files.insert(format!("sheet/{name}"), bytes);
    }
    let mut random = Random(13);
    for n in 0..6u8 {
        let head = (0..49u8).map(|i| if i == 0 { n + 1 } else { i.wrapping_mul(71).wrapping_add(30 * n) });
        let material = if n == 0 { seeds::factored() } else { seeds::extreme(&mut random) };
        files.insert(format!("blend/{n}"), head.chain(material).collect());
    }
    // Mirrored pairs, and factors.
    for (name, kind, options) in
        [("packed", 3, PackOptions::default()), ("packed-grey", 6, PackOptions { bits: 16, channels: 1 })]
    {
        files.insert(format!("material/{name}"), packed(&KINDS[kind].bytes(), options));
    }
    // Grids: with mirrors, with factors, in codes.
    for (name, bytes) in turned_materials().into_iter().filter(|(_, bytes)| bytes.len() <= 6000) {
        files.insert(format!("material/{}", name.replace(' ', "-")), bytes);
    }
    files.insert("material/spectral".into(), seeds::spectral());
    let mut random = Random(7);
    for n in 0..40 {
        let bytes = seeds::extreme(&mut random);
        // Small ones: a fuzzer is the faster for it.
        if bytes.len() <= 1200 {
            files.insert(format!("material/extreme-{n:02}"), bytes);
        }
    }
    for n in 0..6u8 {
        let lobes: Vec<u8> = (0..5 * (1 + 3 * n)).map(|i| i.wrapping_mul(37).wrapping_add(50 * n)).collect();
        files.insert(format!("mixture/{n}"), [&[n, n, n / 2, n][..], &lobes].concat());
    }
}

/// Maps, tables of maps, and maps with a material.
fn light(files: &mut Files) {
    let ramp: Vec<u8> = (0..96u8).map(|i| i.wrapping_mul(5)).collect();
    for (name, width, range) in [("one", 0, 1), ("powers", 3, 0), ("ends", 4, 2), ("bytes", 7, 1)] {
        files.insert(format!("environment_made/{name}"), [&[width, range][..], &ramp].concat());
    }
    let sun = |at: usize, n: usize| (0..n).map(|i| [if i == at { 1e6 } else { 1.0 }; 3]).collect();
    let maps: [(&str, usize, Vec<[f32; 3]>); 4] = [
        ("one", 1, vec![[1.0, 0.5, 0.25]]),
        ("black-corner", 2, vec![[0.0; 3], [1.0; 3], [0.0; 3], [1.0; 3]]),
        ("sun", 8, sun(11, 32)),
        ("colors", 3, (0..9).map(|i| [i as f32, 2.0, 8.0 - i as f32]).collect()),
    ];
    for (name, width, map) in maps {
        let memory = vec![0; environment_len(width, map.len() / width).expect("a size that may be")];
        let environment = Environment::new(width, &map, memory).expect("a map with light");
        let bytes = environment.table().iter().flat_map(|word| word.to_le_bytes()).collect();
        files.insert(format!("environment_read/{name}"), bytes);
    }
    let mut random = Random(9);
    for (n, material) in
        [seeds::factored(), seeds::extreme(&mut random), seeds::extreme(&mut random)].into_iter().enumerate()
    {
        let head: Vec<u8> = (0..64u8).map(|i| i.wrapping_mul(11).wrapping_add(n as u8)).collect();
        files.insert(format!("product/{n}"), [head, material].concat());
    }
}

/// Measured files, of a grey highlight above a diffuse colour.
fn tables(files: &mut Files) {
    let f = |theta_i: f64, theta_o: f64, phi: f64| {
        0.1 + 2.0 * (-20.0 * ((theta_i - theta_o).powi(2) + (phi - std::f64::consts::PI).powi(2))).exp()
    };
    let mut places = Vec::new();
    for theta_o in [0.2, 0.9] {
        for theta_i in [0.1, 0.6, 1.2] {
            for phi in [0.5, 2.0, std::f64::consts::PI] {
                places.push((theta_i, theta_o, phi, f(theta_i, theta_o, phi)));
            }
        }
    }
    let rows = |names: &str, row: &dyn Fn(f64, f64, f64, f64) -> String| {
        let mut text = format!("{names}\n");
        for &(theta_i, theta_o, phi, f) in &places {
            let _ = writeln!(text, "{}", row(theta_i, theta_o, phi, f));
        }
        text.into_bytes()
    };
    let mut add = |name: &str, bytes: Vec<u8>| files.insert(name.to_owned(), bytes);
    let angles = |i: f64, o: f64, phi: f64| {
        format!("{:.3},0,{:.3},{:.3}", i.to_degrees(), o.to_degrees(), phi.to_degrees())
    };
    add(
        "csv/vectors",
        rows("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b", &|i, o, phi, f| {
            let (x, y) = (i.sin() * phi.cos(), i.sin() * phi.sin());
            format!("{x:.6},{y:.6},{:.6},{:.6},0,{:.6},{f:.4},{f:.4},0.2", i.cos(), o.sin(), o.cos())
        }),
    );
    add(
        "csv/value",
        rows("theta_i,phi_i,theta_o,phi_o,value", &|i, o, phi, f| format!("{},{f:.4}", angles(i, o, phi))),
    );
    add(
        "csv/spectrum",
        rows("# a spectrum\ntheta_i,phi_i,theta_o,phi_o,400,500nm,600,700", &|i, o, phi, f| {
            format!("{},{f:.4},0.2,{f:.4},0.1", angles(i, o, phi))
        }),
    );
    // Other shapes: names beside numbers, matrices, names of rows with words above and below them, cosines.
    add(
        "csv/pairs",
        rows("log", &|i, o, phi, f| {
            format!(
                "[1] theta_i={:.3} theta_o={:.3} phi={:.3}, brdf={f:.4}",
                i.to_degrees(),
                o.to_degrees(),
                phi.to_degrees()
            )
        }),
    );
    let matrix = "AOI: 10\ntheta_o\\phi_o;0;90;180\n10;0,1;0,2;0,3\n40;0,1;0,2;0,4\nAOI: 30\ntheta_o\\phi_o;0;90;180\n10;0,1;0,2;0,5\n";
    add("csv/matrices", matrix.into());
    let mut named = rows(
        "incident,,outgoing,,\ntheta,phi,theta,phi,BRDF_s\ndeg,deg,deg,deg,1/sr\n---,---,---,---,---",
        &|i, o, phi, f| format!("{},{f:.4} # x", angles(i, o, phi)),
    );
    named.extend(b"END\n(18 rows)\n");
    add("csv/named", named);
    add(
        "csv/cosines",
        rows("\"mu0\" \"mu\" \"dphi\" \"BRF\"", &|i, o, phi, f| {
            format!("\"1\" {:.4} {:.4} {:.1} {f:.4}", i.cos(), o.cos(), phi.to_degrees())
        }),
    );
    add(
        "astm/rgb",
        rows(
            &format!("LAB_NAME ours\nNUM_POINTS {}\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B", places.len()),
            &|i, o, phi, f| format!("{o:.4},0,{i:.4},{phi:.4},{f:.4},{f:.4},0.2"),
        ),
    );
    add(
        "astm/spectrum",
        rows("VARS theta_i,phi_i,theta_s,phi_s,400nm,550nm,700nm", &|i, o, phi, f| {
            format!("{o:.4},0,{i:.4},{phi:.4},{f:.4},0.3,{f:.4}")
        }),
    );
    add(
        "cornell/spectrum",
        rows("# ours\n3\n400 550 700", &|i, o, phi, f| format!("{o:.4} 0 {i:.4} {phi:.4} {f:.4} 0.3 {f:.4}")),
    );
    for (name, path) in [
        ("astm/small", &include_bytes!("../../corpus/small.astm")[..]),
        ("cornell/small", include_bytes!("../../corpus/small.brdf")),
        ("csv/small", include_bytes!("../../corpus/small.csv")),
        ("rgl/small", include_bytes!("../../corpus/small.bsdf")),
    ] {
        add(name, path.to_vec());
    }
}
