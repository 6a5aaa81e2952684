//! The format of a file: by its first bytes, not by its name.

use crate::ReadError;

/// Bytes of a text that are looked at.
const LOOKED_AT: usize = 4096;

/// The formats that are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Rgl,
    Merl,
    Cornell,
    Astm,
    Zemax,
    LightTools,
    OpenMaterial,
    Alta,
    SpeosAnisotropic,
    SpeosSpectral,
    PabOpto,
    Ssdd,
    Text,
}

/// Tells the format of a file by its first bytes; `ending`: what its name ends in, in lower case, for what bytes leave open.
///
/// # Errors
/// [`ReadError::Content`] for formats that are known and not read, with advice, and for files without a measurement.
pub(crate) fn recognise(bytes: &[u8], ending: &str) -> Result<Format, ReadError> {
    let fail = |text: &str| Err(ReadError::Content(text.into()));
    if bytes.starts_with(b"tensor_file") {
        return Ok(Format::Rgl);
    }
    if bytes.starts_with(&super::merl::HEAD) || ending == "binary" {
        return Ok(Format::Merl);
    }
    if bytes.starts_with(b"PK\x03\x04") {
        return fail(
            "a spreadsheet or archive: save the sheet as CSV (comma separated values), and give that",
        );
    }
    if bytes.starts_with(b"\xd0\xcf\x11\xe0") {
        return fail("an old spreadsheet: save the sheet as CSV (comma separated values), and give that");
    }
    if bytes.starts_with(b"\x89SRBF") {
        return fail("a material, which is fitted already: `srbf inspect` shows it");
    }
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(LOOKED_AT)]);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let first = text.lines().next().unwrap_or("").trim();
    let has = |word: &str| text.lines().any(|line| line.trim_start().starts_with(word));
    if first.starts_with("OPTIS") {
        let lower = first.to_ascii_lowercase();
        return match () {
            () if lower.contains("anisotropic bsdf") => Ok(Format::SpeosAnisotropic),
            () if lower.contains("brdf surface") => Ok(Format::SpeosSpectral),
            () => fail("a SPEOS file of another kind: .anisotropicbsdf and .brdf, saved as text, are read"),
        };
    }
    if first.starts_with('{') {
        return Ok(Format::OpenMaterial);
    }
    if first.starts_with('<') {
        let is_window = text.contains("WindowElement");
        return fail(if is_window {
            "an XML file of a window (Radiance, WINDOW): its patches are no samples; give the measurement that it was made from"
        } else {
            "an XML or HTML file, not a measurement"
        });
    }
    if has("VARS") && (has("NUM_POINTS") || ending == "astm" || has("MEAS_NAME") || has("LAB_NAME")) {
        return Ok(Format::Astm);
    }
    if first.starts_with("VERSION") && has("DATA_TYPE") || ending == "ssdd" {
        return Ok(Format::Ssdd);
    }
    if has("#PARAM_IN") || has("#DIM") {
        return Ok(Format::Alta);
    }
    if has("#intheta") || has("#incident_angle") {
        return Ok(Format::PabOpto);
    }
    let is_grid = has("ScatterAzimuth") || has("ScatterRadial");
    if is_grid && has("AngleOfIncidence") {
        return Ok(Format::Zemax);
    }
    if is_grid {
        return Ok(Format::LightTools);
    }
    if text.contains("ScatterBeta") || first.contains("TracePro") {
        return fail(
            "a TracePro surface property: its table is over beta - beta0, sines in place of angles. Give a table of text with \
             theta_i, phi_i, theta_o, phi_o and the BRDF",
        );
    }
    if first == "analytic" || first.starts_with("analytic ") {
        return fail(
            "a shader of BRDF Explorer, not a measurement; models are named, such as model:ggx:alpha=0.2",
        );
    }
    if ending == "brdf" && has_numbers_alone(text) {
        return Ok(Format::Cornell);
    }
    if ending == "astm" {
        return Ok(Format::Astm);
    }
    if ending == "bsdf" && bytes.iter().take(64).any(|b| *b == 0) {
        return Ok(Format::Rgl);
    }
    Ok(Format::Text)
}

/// Whether a text begins with numbers, comments apart.
fn has_numbers_alone(text: &str) -> bool {
    let mut words =
        text.lines().map(|line| line.split('#').next().unwrap_or("")).flat_map(str::split_whitespace);
    words.next().is_none_or(|word| word.parse::<f64>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_line_tells_whatever_the_ending() {
        for (text, ending, format) in [
            ("tensor_file\0\x01", "csv", Format::Rgl),
            (
                "Symmetry PlaneSymmetrical\nAngleOfIncidence 1\n0\nScatterAzimuth 1\n0\n",
                "bsdf",
                Format::Zemax,
            ),
            ("Symmetry Asymmetric\nScatterAzimuth 1\n0\nScatterRadial 1\n0\n", "bsdf", Format::LightTools),
            ("OPTIS - Anisotropic BSDF surface file v8.0\n", "txt", Format::SpeosAnisotropic),
            ("OPTIS - brdf surface file v9.0\n", "brdf", Format::SpeosSpectral),
            ("{\"brdf\": {}}", "xompt", Format::OpenMaterial),
            ("#DIM 3 1\n#PARAM_IN COS_TH\n", "dat", Format::Alta),
            ("#intheta 10\n", "txt", Format::PabOpto),
            ("VERSION 0.2\nDATA_TYPE brdf\n", "ssdd", Format::Ssdd),
            ("MEAS_NAME BRDF\nVARS theta_i,phi_i\n", "txt", Format::Astm),
            ("# x\n31 # wavelengths\n400", "brdf", Format::Cornell),
            ("theta_i,phi_i,theta_o,phi_o,value\n", "brdf", Format::Text),
            ("theta_i,phi_i,theta_o,phi_o,value\n", "", Format::Text),
        ] {
            assert_eq!(recognise(text.as_bytes(), ending), Ok(format), "{text}");
        }
        for (text, word) in [
            ("PK\x03\x04", "CSV"),
            ("<?xml version=\"1.0\"?><WindowElement>", "window"),
            ("analytic\n\n::begin parameters", "Explorer"),
            ("\tTemperature\tWavelength\tIncAngle\tScatterBeta\n", "TracePro"),
        ] {
            assert!(recognise(text.as_bytes(), "brdf").unwrap_err().to_string().contains(word), "{text}");
        }
    }
}
