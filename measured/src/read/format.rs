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
    Fred,
    NumPy,
    Utia,
    Records,
    Window,
    Text,
}

/// First bytes of files that are not measurements as they are, and what to do with each.
const FOREIGN: [(&[u8], &str); 33] = [
    (
        b"\x89HDF\r\n\x1a\n",
        "an HDF5 file, as AxF (X-Rite, Pantone), MATLAB 7.3 and NetCDF 4 are: export its samples as a table of text (in Python by h5py; AxF by \
         its maker's SDK, whose maps of textures are no samples)",
    ),
    (
        b"MATLAB 5.0 MAT-file",
        "a MATLAB file: save the samples as text, by writetable(table, 'samples.csv'), with the names of the columns",
    ),
    (
        b"MATLAB 7.3 MAT-file",
        "a MATLAB file: save the samples as text, by writetable(table, 'samples.csv'), with the names of the columns",
    ),
    (b"CDF\x01", NETCDF),
    (b"CDF\x02", NETCDF),
    (b"CDF\x05", NETCDF),
    (
        b"PAR1",
        "a Parquet file: save it as text, in Python by pandas.read_parquet(...).to_csv(..., index=False)",
    ),
    (
        b"ARROW1",
        "an Arrow file (Feather): save it as text, in Python by pandas.read_feather(...).to_csv(..., index=False)",
    ),
    (b"SQLite format 3\0", "a database (SQLite): export the table of samples as CSV"),
    (
        b"\x80\x04\x95",
        "a pickle of Python: save the samples as text, by to_csv or numpy.savetxt with a header",
    ),
    (
        b"v/1\x01",
        "an OpenEXR picture, not a measurement: samples of a BRDF are expected, each with its two directions",
    ),
    (b"\x89PNG\r\n", PICTURE),
    (b"\xff\xd8\xff", PICTURE),
    (b"II*\0", PICTURE),
    (b"MM\0*", PICTURE),
    (b"GIF8", PICTURE),
    (b"8BPS", PICTURE),
    (b"DDS ", PICTURE),
    (b"#?RADIANCE", PICTURE),
    (b"#?RGBE", PICTURE),
    (b"SIMPLE  =", PICTURE),
    (b"%PDF", "a PDF document: tables in it have to be saved as text"),
    (b"BZh", COMPRESSED),
    (b"\xfd7zXZ\0", COMPRESSED),
    (b"\x28\xb5\x2f\xfd", COMPRESSED),
    (b"7z\xbc\xaf\x27\x1c", COMPRESSED),
    (b"Rar!", COMPRESSED),
    (
        b"NVIDIA ARC MBSDF",
        "an MBSDF, the measured BSDF of NVIDIA's MDL: its table is over the two angles and their azimuth. Export it as a table of text with \
         theta_i, theta_o, dphi and the BRDF (the MDL SDK reads it)",
    ),
    (
        b"\xd0\xcf\x11\xe0",
        "an old spreadsheet: save the sheet as CSV (comma separated values), and give that",
    ),
    (b"\x89SRBF", "a material, which is fitted already: `srbf inspect` shows it"),
    (b"FRDB", "a binary file of FRED: export the scatter data as text, which begins with `type bsdf_data`"),
    (b"\x7fELF", "a program, not a measurement"),
    (b"MZ\x90\0", "a program, not a measurement"),
];

const NETCDF: &str = "a NetCDF file: export its samples as a table of text, in Python by xarray.open_dataset(...).to_dataframe().to_csv(...)";
const PICTURE: &str =
    "a picture, not a measurement: samples of a BRDF are expected, each with its two directions";
const COMPRESSED: &str = "a compressed file: unpack it, or compress it by gzip, which is opened";

/// The error of a file that is no measurement as it stands, by its first bytes.
pub(super) fn foreign(bytes: &[u8]) -> Option<ReadError> {
    let known = FOREIGN.iter().find(|(head, _)| bytes.starts_with(head)).map(|known| known.1);
    let speos = || {
        let mut lines = bytes[..bytes.len().min(LOOKED_AT)].split(|b| *b == b'\n');
        let is_speos = lines.next().is_some_and(|first| first.starts_with(b"OPTIS"));
        (is_speos && lines.next().is_some_and(|mode| mode.trim_ascii().starts_with(b"1")))
            .then_some(SPEOS_BINARY)
    };
    known.or_else(|| zipped(bytes)).or_else(speos).map(|text| ReadError::Content(text.into()))
}

const SPEOS_BINARY: &str =
    "a SPEOS file of mode 1, which is binary: only text is read, whose mode is 0: save it as text in SPEOS";

/// What an archive of zip holds, by the names at its beginning.
fn zipped(bytes: &[u8]) -> Option<&'static str> {
    bytes.starts_with(b"PK\x03\x04").then_some(())?;
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(LOOKED_AT)]);
    Some(match () {
        () if head.contains(".npy") => {
            "an archive of NumPy (.npz): save the one array of samples by numpy.save, as .npy"
        }
        () if head.contains("[Content_Types].xml")
            || head.contains("xl/")
            || head.contains("opendocument") =>
        {
            "a spreadsheet: save the sheet as CSV (comma separated values), and give that"
        }
        () => {
            "an archive (zip) or a spreadsheet: unpack it, or save the sheet as CSV (comma separated values), and give that"
        }
    })
}

/// Whether a file is binary, and of a format that is known.
pub(super) fn is_known_binary(bytes: &[u8], size: u64) -> bool {
    let heads: [&[u8]; 4] = [b"tensor_file", &super::merl::HEAD, super::numpy::HEAD, super::gzip::HEAD];
    heads.iter().any(|head| bytes.starts_with(head)) || size == super::utia::SIZE as u64
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
    if let Some(fault) = foreign(bytes) {
        return Err(fault);
    }
    if bytes.starts_with(super::numpy::HEAD) {
        return Ok(Format::NumPy);
    }
    if bytes.len() == super::utia::SIZE && bytes[..LOOKED_AT].iter().any(|b| *b == 0 || *b > 0x7f) {
        return Ok(Format::Utia);
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
    // Python prints records so.
    if ["{'", "[{'"].iter().any(|start| text.starts_with(start)) {
        return Ok(Format::Text);
    }
    if first.starts_with('{') {
        return Ok(Format::OpenMaterial);
    }
    if text.strip_prefix('[').is_some_and(|rest| rest.trim_start().starts_with(['{', '['])) {
        return Ok(Format::Records);
    }
    if super::window::is_window(text) {
        return Ok(Format::Window);
    }
    if first.starts_with('<') {
        return fail("an XML or HTML file, not a measurement");
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
    if first.starts_with("type bsdf_data") {
        return Ok(Format::Fred);
    }
    if ending == "rtd" {
        return fail(
            "a file of LightTools (.rtd): export the measured scatter as BSDF data, a text with AngleOfIncidence, ScatterAzimuth and \
             ScatterRadial, or give a table of text with theta_i, phi_i, theta_o, phi_o and the BRDF",
        );
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
            ("<?xml version=\"1.0\"?><WindowElement>", "xml", Format::Window),
            ("theta_i,phi_i,theta_o,phi_o,value\n", "brdf", Format::Text),
            ("theta_i,phi_i,theta_o,phi_o,value\n", "", Format::Text),
        ] {
            assert_eq!(recognise(text.as_bytes(), ending), Ok(format), "{text}");
        }
        for (text, word) in [
            ("PK\x03\x04", "CSV"),
            ("<?xml version=\"1.0\"?><note>", "XML"),
            ("analytic\n\n::begin parameters", "Explorer"),
            ("\tTemperature\tWavelength\tIncAngle\tScatterBeta\n", "TracePro"),
        ] {
            assert!(recognise(text.as_bytes(), "brdf").unwrap_err().to_string().contains(word), "{text}");
        }
    }
}
