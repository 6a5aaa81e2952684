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
