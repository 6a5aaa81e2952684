//! Materials in fewer bytes.

use crate::{folder, refused, srbf};
use srbf_core::{Material, read_file};
use std::path::Path;

/// Bytes of the spectra of a preset.
const SPECTRA: usize = 268;

fn material(place: &Path, name: &str) -> Material<Vec<u8>> {
    Material::from_bytes(read_file(&place.join(name)).unwrap()).unwrap()
}

#[test]
fn a_preset_is_packed_and_plain_again_and_both_are_rendered() {
    let place = folder("pack");
    let said = srbf(&place, &["pack", "garnet_red", "-o", "small.srbf"]);
    assert!(said.status.success(), "{said:?}");
    let small = material(&place, "small.srbf");
    assert_eq!((small.code_bits(), small.lobe_count(), small.view_count()), (Some(8), 12, 17));
    assert!(small.bytes().len() <= 1600 + SPECTRA, "{} bytes", small.bytes().len());
    let text = String::from_utf8(said.stdout).unwrap();
    let (whole, packed) = (text.lines().next().unwrap(), text.lines().nth(1).unwrap());
    assert!(whole.contains("4512 bytes") && whole.ends_with("error 0.00 %"), "{text}");
    let error: f64 = packed.split_whitespace().rev().nth(1).unwrap().parse().unwrap();
    assert!(packed.starts_with(" 8 bits") && error > 0.0 && error < 1.0, "{text}");

    assert!(srbf(&place, &["pack", "small.srbf", "--bits", "32", "-o", "plain.srbf"]).status.success());
    let plain = material(&place, "plain.srbf");
    let (wo, wi) = ([0.6f32, 0.0, 0.8], [-0.48f32, 0.36, 0.8]);
    assert_eq!((plain.code_bits(), plain.evaluate(wo, wi)), (None, small.evaluate(wo, wi)));
    assert_eq!(plain.provenance(), small.provenance());

    // What cannot read codes gets plain numbers: the words of both are the same.
    let words = |name: &str| srbf(&place, &["export", name, "--glsl"]).stdout;
    assert!(!words("plain.srbf").is_empty() && words("small.srbf") == words("plain.srbf"));
    let pictures = ["small", "plain"].map(|name| {
        let (input, output) = (format!("{name}.srbf"), format!("{name}.exr"));
        let options = [
            "render",
            "--scene",
            "sphere",
            "--size",
            "32x32",
            "--spp",
            "4",
            "--material",
            &input,
            "-o",
            &output,
        ];
        let said = srbf(&place, &options);
        assert!(said.status.success(), "{said:?}");
        std::fs::read(place.join(output)).unwrap()
    });
    assert!(pictures[0] == pictures[1]);
}

/// A quarter of its views is stored, and mirrors go on when lobes and rings are cut off.
#[test]
fn an_anisotropic_fit_is_packed_cut_and_plain_again() {
    let place = folder("pack-anisotropic");
    let run = |words: &str| {
        let said = srbf(&place, &words.split(' ').collect::<Vec<_>>());
        assert!(said.status.success(), "{words}: {said:?}");
    };
    run(
        "fit model:ggx:alpha_x=0.15,alpha_y=0.4,f0=0.9 --lobes 8 --steps 8 --starts 1 --views 26 --no-picture -o fit.srbf",
    );
    run("pack fit.srbf --cut -o small.srbf");
    run("pack small.srbf --bits 32 -o plain.srbf");
    run("pack fit.srbf --lobes 5 --views 16 --cut -o few.srbf");
    let [fit, small, plain, few] =
        ["fit", "small", "plain", "few"].map(|name| material(&place, &format!("{name}.srbf")));
    let [of_fit, of_small, of_plain] = [&fit, &small, &plain].map(|m| m.bytes().len() - m.provenance().len());
    assert_eq!((fit.view_count(), fit.grid_turns(), small.code_bits()), (26, Some((4, 0.0)), Some(8)));
    // The text of each is filled up to a multiple of four bytes.
    assert!(2 * of_small < of_fit && of_plain.abs_diff(of_fit) < 4, "{of_fit} {of_small} {of_plain}");
    assert!(few.lobe_count() <= 5 && few.view_count() == 16, "{} {}", few.lobe_count(), few.view_count());
    let (mut apart, mut all) = (0.0, 0.0);
    for n in 0..24u8 {
        let (theta, phi) = (0.05 * f32::from(n), 1.3 * f32::from(n));
        let wo = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
        let wi = [-0.9 * wo[0], -0.8 * wo[1], (1.0 - (0.9 * wo[0]).powi(2) - (0.8 * wo[1]).powi(2)).sqrt()];
        let [a, b, c] = [&fit, &small, &plain].map(|m| m.evaluate(wo, wi).x);
        assert_eq!(b, c, "{wo:?}");
        (apart, all) = (apart + (a - b).abs(), all + a);
        // Mirrors along x and across it change nothing of the rest.
        let value =
            |x: f32, y: f32| few.evaluate([x * wo[0], y * wo[1], wo[2]], [x * wi[0], y * wi[1], wi[2]]).x;
        let whole = value(1.0, 1.0);
        for image in [value(-1.0, 1.0), value(1.0, -1.0), value(-1.0, -1.0)] {
            assert!((image - whole).abs() <= 1e-3 * whole, "{wo:?}: {image} {whole}");
        }
    }
    assert!(apart < 0.05 * all, "{apart} {all}");
}

#[test]
fn fewer_lobes_are_fitted_again_and_grey_ones_have_no_colour() {
    let place = folder("pack-again");
    let options =
        ["pack", "krylon_blue", "--lobes", "4", "--views", "6", "--channels", "1", "-o", "few.srbf"];
    let said = srbf(&place, &options);
    let text = String::from_utf8(said.stdout).unwrap();
    assert!(said.status.success() && text.contains("fitted again"), "{text}");
    let few = material(&place, "few.srbf");
    assert_eq!((few.lobe_count(), few.view_count()), (4, 6));
    assert!((0..4).all(|k| few.view_lobe(1, k).is_none_or(|lobe| lobe.color_differences == [0.0; 2])));
    let cut = srbf(&place, &["pack", "krylon_blue", "--lobes", "4", "--cut", "-o", "cut.srbf"]);
    let text = String::from_utf8(cut.stdout).unwrap();
    assert!(!text.contains("fitted again") && material(&place, "cut.srbf").lobe_count() <= 4, "{text}");
}

#[test]
fn what_cannot_be_packed_is_refused_by_name() {
    let place = folder("pack-refused");
    std::fs::write(place.join("broken.srbf"), b"no material").unwrap();
    for (arguments, says) in [
        (&["pack", "garnet_red", "--bits", "12"][..], &["--bits", "expected 8, 16 or 32"][..]),
        (&["pack", "garnet_red", "--channels", "2"], &["--channels", "expected 1 or 3"]),
        (&["pack", "garnet_red", "--lobes", "13"], &["lobes", "from 1 to 12"]),
        (&["pack", "garnet_red", "--views", "1"], &["views", "from 2 to 17"]),
        (&["pack", "garnet_red", "--factors", "16x6x3"], &["factors", "which the material has"]),
        (&["pack", "garnet_red", "--error", "0"], &["--error", "above 0"]),
        (&["pack", "garnet_red", "--error", "1", "--lobes", "3"], &["--error", "--lobes"]),
        (&["pack", "garnet_red", "--bits", "32", "--lobes", "3"], &["--bits 32"]),
        (&["pack", "broken.srbf"], &["broken.srbf"]),
        (&["pack", "missing.srbf"], &["missing.srbf"]),
        (&["pack", "model:ggx:alpha=0.2,f0=0.9", "--against", "broken.srbf"], &["--against"]),
    ] {
        refused(&place, arguments, says);
    }
    assert!(!place.join("out").exists(), "nothing is written");
}
