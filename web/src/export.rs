//! A material or a sheet in the format of another program.

use srbf_evaluator::{Language, Surface};
use srbf_fit::export::{Lobes, merl, rgl};

/// Writes a material in a format: `rgl`, `merl`, `json`, or a language of the evaluator such as `glsl`. The first two have no sheets.
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
        ("rgl" | "merl", _) => Err(format!("format {format}: a quarter of the sheet is expected")),
        (_, surface) if !surface.can_read() => {
            Err("a material of format version 1, which shaders do not read".into())
        }
        ("json", surface) => Ok(surface.json().into_bytes()),
        (name, surface) => {
            let language = Language::from_name(name);
            let language = language
                .ok_or_else(|| format!("format {name}: rgl, merl, json or a language is expected"))?;
            Ok(surface.export(language).into_bytes())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_core::Material;

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
