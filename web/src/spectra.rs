//! The spectra of a material, for the page: columns of its map, and how colours look under lights.

use serde_json::{Value, json};
use srbf_core::{Material, SpectralMap};
use srbf_fit::read::Spectra;
use srbf_fit::read::illuminants::{Illuminant, seen, wavelengths};

/// The map of a material, null without one.
///
/// `text`, `nm`, `columns` (for linear sRGB); and in `lights`, unless it is grey, for each light other than daylight nine numbers: the colours
/// that red, green and blue of the material have there, to an eye that is used to the light. They are exact for grey light and values
/// that are not below 0.
pub fn spectra(material: &Material<&[u8]>) -> Value {
    let Some(map) = material.spectral_map() else { return Value::Null };
    // All wavelengths are chosen.
    let Ok(spectra) = Spectra::of_map(map, None) else { return Value::Null };
    let others = Illuminant::ALL.into_iter().filter(|light| *light != Illuminant::D65 && !spectra.is_grey);
    let lights = others.map(|light| (light.name().to_owned(), json!(colours(map, light))));
    json!({
        "text": spectra.text(),
        "nm": spectra.wavelengths,
        "columns": spectra.of_rgb,
        "lights": lights.collect::<serde_json::Map<_, _>>(),
    })
}

/// The colours of red, green and blue under a light.
fn colours(map: SpectralMap<'_>, light: Illuminant) -> [f64; 9] {
    let nm = wavelengths();
    let mut out = [0.0; 9];
    for (seen, nm) in seen(&light.weights(&nm)).iter().zip(nm) {
        let column = map.column_at(nm as f32);
        out.iter_mut().enumerate().for_each(|(n, out)| *out += seen[n % 3] * f64::from(column[n / 3]));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn daylight_changes_no_colour_and_a_lamp_makes_red_brighter() {
        let bytes = include_bytes!("../../presets/garnet_red.srbf");
        let material = Material::from_bytes(&bytes[..]).unwrap();
        let day = colours(material.spectral_map().unwrap(), Illuminant::D65);
        for (n, value) in day.into_iter().enumerate() {
            assert!((value - f64::from(u8::from(n % 4 == 0))).abs() < 1e-3, "{day:?}");
        }
        let found = spectra(&material);
        assert_eq!(
            (&found["text"], found["columns"].as_array().unwrap().len()),
            (&json!("31 wavelengths from 400 to 700 nm"), 31)
        );
        assert!(found["lights"]["A"][0].as_f64().unwrap() > 1.05, "{found}");
        assert!(found["lights"].get("F11").is_some() && found["lights"].get("D65").is_none());
    }
}
