//! A file that is opened: a material as it is, or a measurement that is fitted.

use crate::points::points;
use crate::spectra::spectra;
use serde_json::{Value, json};
use srbf_core::{Material, Quarter, Sheet, printable, printable_lines};
use srbf_evaluator::{QUARTERS, Surface, comments};
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::report::{Report, factor_words};
use srbf_fit::judge::verdict::Verdict;
use srbf_fit::read::{Content, Conventions, Source, Spectra, read_from};
use srbf_fit::{Settings, fit_source};
use std::error::Error;

/// First bytes of a `.srbf` file.
const MAGIC: &[u8] = b"\x89SRBF";

/// A material or a sheet with the texts and points that the page shows beside it.
#[derive(Debug)]
pub struct Opened {
    /// It as `.srbf` bytes in plain numbers.
    pub bytes: Vec<u8>,
    /// `name`, `facts` (label and text), `findings`, `verdict`, `data` (see the page's `plot.js`), `spectra`, of a sheet those of each quarter,
    /// and `comment`: the provenance as a shader has it.
    pub json: Value,
}

/// Opens a file: a `.srbf` material or sheet is checked, a measurement read, fitted with the usual settings and judged.
///
/// `progress` is called with the share of the fit that is done, 0 to 1.
///
/// # Errors
/// In words, with the name of the file and the place of the fault.
pub fn open(name: &str, bytes: &[u8], progress: impl FnMut(f64) + Send) -> Result<Opened, String> {
    if bytes.starts_with(MAGIC) {
        let name = &printable(name).to_string();
        let surface = Surface::from_bytes(bytes).map_err(|error| format!("{name}: {error}"))?;
        let (facts, spectra, provenance) = match &surface {
            Surface::Material(material) => (facts(material), spectra(material), material.provenance()),
            Surface::Sheet(sheet) => {
                let of = |quarter| sheet.quarter(quarter).map_or(Value::Null, |own| spectra(&own));
                (facts_of_sheet(sheet), json!(Quarter::ALL.map(of)), sheet.provenance())
            }
        };
        let json = json!({"name": stem(name), "facts": facts, "findings": [], "verdict": [], "data": null, "spectra": spectra, "comment": comments(provenance)});
        return Ok(Opened { bytes: surface.plain_bytes().into_owned(), json });
    }
    let source = read_from(name, bytes, &Conventions::default()).map_err(|error| said(&error))?;
    fitted(&source, progress)
}

/// An error and its causes.
fn said(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text += &format!(": {error}");
        cause = error.source();
    }
    text
}

/// Fits a measurement that was read, with the usual settings, and judges the fit.
///
/// # Errors
/// In words, with the name of the measurement.
pub fn fitted(source: &Source, progress: impl FnMut(f64) + Send) -> Result<Opened, String> {
    let Source { name, sha256, .. } = source;
    let settings = Settings { provenance: format!("{name}, SHA-256 {sha256}\n"), ..Settings::default() };
    let text = |error: srbf_fit::FitError| format!("{name}: {}", said(&error));
    let fit = fit_source(source, &settings, progress).map_err(text)?;
    let material = Material::from_bytes(fit.bytes.as_slice()).map_err(|error| format!("{name}: {error}"))?;
    let verdict = Verdict::of_material(&fit.report, &reciprocity(&material).map_err(text)?);
    let notes = fit.report.notes().into_iter().map(|note| format!("note {note}"));
    let lines: Vec<String> = notes.chain(verdict.lines()).collect();
    Ok(of_fit(stem(name), &fit.bytes, Some(&fit.report), Some(&source.content))?.judged(&lines))
}

/// Opens a material with the report of its fit, and the measurement.
///
/// # Errors
/// In words, for bytes that are no material.
pub fn of_fit(
    name: &str,
    bytes: &[u8],
    report: Option<&Report>,
    content: Option<&Content>,
) -> Result<Opened, String> {
    let mut opened = open(&format!("{name}.srbf"), bytes, |_| {})?;
    opened.json["findings"] = report.map_or_else(Vec::new, findings).into();
    opened.json["data"] = content.map_or(Value::Null, points);
    Ok(opened)
}

impl Opened {
    /// The same with the lines of a verdict.
    #[must_use]
    pub fn judged(mut self, verdict: &[String]) -> Self {
        let words: Vec<String> = verdict.iter().map(|line| printable(line).to_string()).collect();
        self.json["verdict"] = words.into();
        self
    }
}

/// The name of a file without its last ending.
fn stem(name: &str) -> &str {
    match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => name,
    }
}

/// Sentences about samples that need care.
fn findings(report: &Report) -> Vec<String> {
    let all = report.look.iter().flat_map(|look| &look.findings);
    all.filter(|finding| finding.is_off).map(|finding| finding.text.clone()).collect()
}

/// A label and a text.
fn fact(label: &str, text: String) -> [String; 2] {
    [label.to_owned(), text]
}

/// A text of a stranger.
fn made_of(provenance: &str) -> [String; 2] {
    fact("made of", printable_lines(provenance).to_string().trim().to_owned())
}

/// Properties of a sheet: its quarters.
fn facts_of_sheet(sheet: &Sheet<&[u8]>) -> Vec<[String; 2]> {
    let of = |quarter: Quarter| {
        let words = |own: Material<&[u8]>| {
            let kind = if own.is_isotropic() { "" } else { ", anisotropic" };
            format!("{} lobes, at {} views{kind}", own.lobe_count(), own.view_count())
        };
        let text = sheet.quarter(quarter).map_or_else(|| "black".to_owned(), words);
        fact(&QUARTERS[quarter as usize].replace('-', " "), text)
    };
    let is_stored = |quarter: &Quarter| !(sheet.is_symmetric() && quarter.is_back());
    let mut facts = vec![fact("size", format!("{} bytes, a sheet", sheet.bytes().len()))];
    facts.extend(Quarter::ALL.into_iter().filter(is_stored).map(of));
    facts.extend(sheet.is_symmetric().then(|| fact("back", "like the front".to_owned())));
    facts.push(made_of(sheet.provenance()));
    facts
}

/// Properties of a material.
fn facts(material: &Material<&[u8]>) -> Vec<[String; 2]> {
    let factors = factor_words(material).unwrap_or_else(|| "none".to_owned());
    let kind = if material.is_isotropic() { "isotropic" } else { "anisotropic" };
    let map = material.spectral_map().and_then(|map| Spectra::of_map(map, None).ok());
    vec![
        fact("size", format!("{} bytes", material.bytes().len())),
        fact("lobes", format!("{}, at {} views", material.lobe_count(), material.view_count())),
        fact("surface", kind.to_owned()),
        fact("factors", factors),
        fact("spectrum", map.map_or_else(|| "none".to_owned(), |map| map.text())),
        made_of(material.provenance()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_core::PackOptions;

    const PRESET: &[u8] = include_bytes!("../../presets/cayman.srbf");

    #[test]
    fn a_material_stays_as_it_is() {
        let opened = open("dir.ectory.srbf", PRESET, |_| panic!("nothing is fitted")).unwrap();
        assert_eq!(opened.bytes, PRESET);
        assert_eq!(opened.json["name"], "dir.ectory");
        assert_eq!(opened.json["facts"][0][1], format!("{} bytes", PRESET.len()));
    }

    #[test]
    fn a_packed_material_is_shown_in_plain_numbers() {
        let material = Material::from_bytes(PRESET).unwrap();
        let mut packed = vec![0; material.packed_len(PackOptions::default(), "")];
        material.pack(PackOptions::default(), "", &mut packed).unwrap();
        let opened = open("small.srbf", &packed, |_| {}).unwrap();
        let shown = Material::from_bytes(opened.bytes.as_slice()).unwrap();
        assert_eq!((shown.code_bits(), shown.view_count()), (None, material.view_count()));
        assert_eq!(opened.json["facts"][0][1], format!("{} bytes", packed.len()));
    }

    #[test]
    fn a_sheet_has_its_quarters() {
        let glass = include_bytes!("../../presets/sheets/ground_glass.srbf");
        let opened = open("glass.srbf", glass, |_| {}).unwrap();
        assert_eq!(opened.bytes, glass);
        let facts = opened.json["facts"].to_string();
        assert!(facts.contains("front transmission") && facts.contains("\"black\""), "{facts}");
        assert_eq!(opened.json["spectra"].as_array().map(Vec::len), Some(4));
    }

    #[test]
    fn damaged_and_other_files_are_refused_by_name() {
        let mut damaged = PRESET.to_vec();
        damaged[100] ^= 1;
        let error = open("a.srbf", &damaged, |_| {}).unwrap_err();
        assert!(error.starts_with("a.srbf: "), "{error}");
        let error = open("b.csv", b"neither, one\nnor, the other\n", |_| {}).unwrap_err();
        assert!(error.starts_with("b.csv: no line names the columns"), "{error}");
    }

    #[test]
    fn no_text_of_a_stranger_passes_as_it_is() {
        let bytes = include_bytes!("../../fuzz/found/material/inspect-escape.srbf");
        let name = "a\u{1b}[31m\u{202e}\nb.srbf";
        let opened = open(name, bytes, |_| {}).unwrap();
        assert_eq!(opened.json["name"], "a\\u{1b}[31m\\u{202e}\\u{a}b");
        for fact in opened.json["facts"].as_array().unwrap() {
            let text = fact[1].as_str().unwrap();
            assert_eq!(text, printable_lines(text).to_string());
        }
        for bytes in [&b"\x89SRBF"[..], b"neither, one\nnor, the other\n"] {
            let error = open(name, bytes, |_| {}).unwrap_err();
            assert_eq!(error, printable(&error).to_string());
        }
    }

    #[test]
    fn wavelengths_are_facts_of_a_material() {
        let opened = open("a.srbf", PRESET, |_| {}).unwrap();
        assert!(opened.json["facts"].to_string().contains("31 wavelengths from 400 to 700 nm"));
        let plain = include_bytes!("../../tests/corpus/version2.srbf");
        assert!(open("b.srbf", plain, |_| {}).unwrap().json["spectra"].is_null());
    }

    #[test]
    fn samples_are_fitted_and_judged() {
        let text = include_bytes!("../../tests/corpus/small.csv");
        let mut last = 0.0;
        let opened = open("small.csv", text, |share| last = share).unwrap();
        assert_eq!(last, 1.0);
        assert!(
            Material::from_bytes(opened.bytes.as_slice())
                .unwrap()
                .provenance()
                .starts_with("small.csv, SHA-256")
        );
        assert_eq!(opened.json["data"]["are"], "samples");
        assert!(!opened.json["verdict"].as_array().unwrap().is_empty());
    }
}
