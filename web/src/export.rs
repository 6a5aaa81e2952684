//! A material or a sheet in the format of another program.

use srbf_evaluator::Surface;
use srbf_fit::export::{Lobes, merl, rgl};
use srbf_fit::table::Brdf;

/// Most angles of a curve.
const MOST_COLUMNS: usize = 4096;

/// Writes a material in a format: `rgl`, `merl`, `json`, or a language of the evaluator such as `glsl`. The first two have no sheets.
/// The last two need the feature `page`.
///
/// `curve DEGREES COLUMNS` is `f cos` over the plane of incidence, light from -90 to 90 degrees and the viewer at `-DEGREES`: of each
/// column luminance, red, green and blue, as little-endian f32.
///
/// # Errors
/// In words: for bytes of neither, for a surface that the format does not hold, and for a format that is not known.
pub fn export(bytes: &[u8], format: &str) -> Result<Vec<u8>, String> {
    let surface = Surface::from_bytes(bytes).map_err(|error| error.to_string())?;
    match (format, surface) {
        ("rgl", Surface::Material(material)) => {
            rgl(&Lobes(material), None).map_err(|error| error.to_string())
        }
        ("merl", Surface::Material(material)) => {
            merl(&Lobes(material)).map(|file| file.bytes).map_err(|error| error.to_string())
        }
        (format, Surface::Material(material)) if format.starts_with("curve ") => {
            let numbers: Vec<f64> = format.split(' ').skip(1).filter_map(|word| word.parse().ok()).collect();
            match numbers[..] {
                [degrees, columns]
                    if (0.0..90.0).contains(&degrees) && (2.0..=MOST_COLUMNS as f64).contains(&columns) =>
                {
                    Ok(curve(&Lobes(material), degrees.to_radians(), columns as usize))
                }
                _ => Err(format!(
                    "{format}: degrees from 0 to 90 and at most {MOST_COLUMNS} columns are expected"
                )),
            }
        }
        ("rgl" | "merl", _) => Err(format!("format {format}: a quarter of the sheet is expected")),
        (name, surface) => text(name, &surface),
    }
}

/// A text: JSON, or a language of the evaluator.
#[cfg(feature = "page")]
fn text<B: AsRef<[u8]>>(name: &str, surface: &Surface<B>) -> Result<Vec<u8>, String> {
    if !surface.can_read() {
        return Err("a material of format version 1, which shaders do not read".into());
    }
    if name == "json" {
        return Ok(surface.json().into_bytes());
    }
    let language = srbf_evaluator::Language::from_name(name);
    let language =
        language.ok_or_else(|| format!("format {name}: rgl, merl, json or a language is expected"))?;
    Ok(surface.export(language).into_bytes())
}

/// The page has the text of shaders itself: the fitter alone has none.
#[cfg(not(feature = "page"))]
fn text<B: AsRef<[u8]>>(name: &str, _: &Surface<B>) -> Result<Vec<u8>, String> {
    Err(format!("format {name}: rgl, merl or curve is expected"))
}

/// `f cos` over the plane of incidence.
fn curve(brdf: &impl Brdf, theta: f64, columns: usize) -> Vec<u8> {
    let wo = [-libm::sin(theta), 0.0, libm::cos(theta)];
    let column = |i: usize| {
        let angle = std::f64::consts::PI * (i as f64 / (columns - 1) as f64 - 0.5);
        let wi = [libm::sin(angle), 0.0, libm::cos(angle).max(0.0)];
        let [red, green, blue] = brdf.evaluate(wi, wo).map(|f| if wi[2] > 1e-6 { f * wi[2] } else { 0.0 });
        [0.2126 * red + 0.7152 * green + 0.0722 * blue, red, green, blue]
    };
    (0..columns).flat_map(column).flat_map(|value| (value as f32).to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_core::Material;

    #[test]
    fn a_curve_has_the_values_of_the_lobes() {
        let bytes = export(PRESET, "curve 40 181").unwrap();
        let value = |i: usize| f64::from(f32::from_le_bytes(bytes[4 * i..4 * i + 4].try_into().unwrap()));
        assert_eq!(bytes.len(), 16 * 181);
        let (wo, wi) = (40_f64.to_radians(), 30_f64.to_radians());
        let material = Lobes(Material::from_bytes(PRESET).unwrap());
        let expected = material.evaluate([wi.sin(), 0.0, wi.cos()], [-wo.sin(), 0.0, wo.cos()]);
        // A column a degree, from -90 on.
        for (c, expected) in expected.into_iter().enumerate() {
            assert!((value(4 * 120 + 1 + c) / (expected * wi.cos()) - 1.0).abs() < 1e-5);
        }
        assert!(value(4 * 130) > value(4 * 50), "the highlight is where light is mirrored");
        for format in ["curve", "curve 40", "curve 90 100", "curve 40 1e9", "curve nan 3", "curve a b"] {
            assert!(export(PRESET, format).is_err(), "{format}");
        }
    }

    const PRESET: &[u8] = include_bytes!("../../presets/garnet_red.srbf");
    const SHEET: &[u8] = include_bytes!("../../presets/sheets/ground_glass.srbf");

    #[test]
    fn every_format_is_written_and_read_again() {
        let read = |name: &str, format: &str| {
            let bytes = export(PRESET, format).unwrap();
            srbf_fit::read::read_from(name, &bytes, &srbf_fit::read::Conventions::default()).unwrap()
        };
        let [wi, wo] = [[0.48, 0.64, 0.6], [-0.6, 0.0, 0.8]];
        let material = Lobes(Material::from_bytes(PRESET).unwrap());
        let expected = srbf_fit::table::Brdf::evaluate(&material, wi, wo);
        for (name, format) in [("a.bsdf", "rgl"), ("a.binary", "merl")] {
            let srbf_fit::read::Content::Evaluable(brdf) = read(name, format).content else {
                panic!("no BRDF")
            };
            let found = brdf.evaluate(wi, wo);
            for c in 0..3 {
                assert!((found[c] / expected[c] - 1.0).abs() < 0.05, "{format}: {found:?} {expected:?}");
            }
        }
        let shader = String::from_utf8(export(PRESET, "glsl").unwrap()).unwrap();
        assert!(shader.contains("srbf_evaluate(") && shader.contains("srbf_data"));
        assert!(export(PRESET, "json").unwrap().starts_with(b"{"));
    }

    #[test]
    fn a_sheet_is_a_shader_and_its_quarters_are_tables() {
        let shader = String::from_utf8(export(SHEET, "glsl").unwrap()).unwrap();
        assert!(shader.contains("srbf_sheet_sample(") && shader.contains("srbf_data"));
        assert!(export(SHEET, "json").unwrap().starts_with(b"{"));
        assert!(export(SHEET, "rgl").unwrap_err().contains("a quarter"));
    }

    #[test]
    fn other_formats_and_other_bytes_are_refused() {
        assert!(export(PRESET, "exe").unwrap_err().contains("exe"));
        assert!(export(b"nothing", "glsl").is_err());
    }
}
