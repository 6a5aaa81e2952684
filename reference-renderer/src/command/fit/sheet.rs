//! `srbf fit` of a sheet: a material for each quarter, all in one file.

use super::names::{self, Job};
use super::{Args, fit_page, words};
use crate::out::output;
use crate::out::print::{data, shown};
use crate::out::progress::Progress;
use crate::truth::stored::QUARTERS;
use anyhow::{Context, bail};
use srbf_core::{Material, Quarter};
use srbf_fit::judge::report::Input;
use srbf_fit::read::SheetSource;
use srbf_fit::read::window::words as quarter_words;
use srbf_fit::{Light, QuarterFit, SheetFit, fit_sheet, stored};
use std::path::{Path, PathBuf};

/// The picture of a quarter, beside that of the whole.
fn picture_of(picture: &Path, quarter: Quarter) -> PathBuf {
    let stem = picture.file_stem().unwrap_or_default().to_string_lossy();
    let ending = picture.extension().unwrap_or_default().to_string_lossy();
    picture.with_file_name(format!("{stem}-{}.{ending}", QUARTERS[quarter as usize]))
}

/// Fits all quarters of a sheet, with a picture of each, and one report.
pub fn fit(args: &Args, place: &Job, picture: Option<&Path>, mut sheet: SheetSource) -> anyhow::Result<()> {
    let (name, sha256) = (sheet.name.clone(), sheet.sha256.clone());
    if args.cross_validate || args.method != super::MethodName::Tracked {
        bail!("{}: a sheet is fitted by our own method, without --cross-validate", shown(&place.file));
    }
    for quarter in stored(&sheet) {
        picture.map_or(Ok(()), |path| output::check_place(&picture_of(path, quarter)))?;
    }
    let light = picture.map(|_| args.picture.light()).transpose()?;
    let mut settings = args.settings.settings();
    settings.provenance = format!("{name}, SHA-256 {sha256}\n");
    let progress = Progress::of_shares(&name);
    let fit = fit_sheet(&sheet, &settings, |share| progress.set_share(share))
        .with_context(|| shown(&place.file))?;
    drop(progress);

    let files = output::together();
    output::write(&place.output, &fit.bytes)?;
    let (mut json, notes) = (fit.to_json(&sheet), notes(&sheet, &fit));
    let mut pictures = Vec::new();
    let mut quarters = serde_json::Map::new();
    for QuarterFit { quarter, fit, .. } in &fit.quarters {
        let own = QUARTERS[*quarter as usize];
        let material = Material::from_bytes(fit.bytes.as_slice())?;
        let input = Input { name: format!("{name}, {own}"), sha256: sha256.clone() };
        let report = fit.report.to_json(&material, &input, &settings)?;
        let words = args.words.say_quarter(quarter_words(*quarter), &fit.report, &material)?;
        quarters.insert(own.to_owned(), serde_json::from_str(&report)?);
        if let Some(((path, light), source)) =
            picture.zip(light.as_ref()).zip(sheet.quarters[*quarter as usize].take())
        {
            let path = picture_of(path, *quarter);
            if let Some(page) = args.picture.page(&path) {
                let title = place.output.file_stem().unwrap_or_default().to_string_lossy();
                let (name, report) = (format!("{title}, {own}"), Some(&fit.report));
                let opened = fit_page::opened(&name, &fit.bytes, report, Some(&source.content))?;
                fit_page::write(&page, opened, &words)?;
                pictures.push(page);
            }
            args.picture.write(&path, &path, light, (fit.bytes.clone(), source), &words)?;
            pictures.push(path);
        }
    }
    json["quarters"] = quarters.into();
    let json = format!("{json:#}\n");
    output::write(&names::report(&place.output), json.as_bytes())?;
    files.commit()?;
    if args.words.is_json() {
        data(&json);
        return Ok(());
    }
    say(&place.output, &notes, &fit);
    let report = names::report(&place.output);
    let paths = [&place.output, &report].into_iter().chain(&pictures).map(shown);
    println!("wrote {}", paths.collect::<Vec<_>>().join(", "));
    println!("next  {}", words::inspect(&place.output));
    Ok(())
}

/// Sentences about the sheet.
fn notes(sheet: &SheetSource, fit: &SheetFit) -> Vec<String> {
    let mut notes = Vec::new();
    if fit.is_symmetric {
        notes.push("the back is like the front, and is stored once".to_owned());
    }
    let disagreement = sheet.window().and_then(|window| window.disagreement);
    if let Some(apart) = disagreement.filter(|apart| *apart > 0.01) {
        notes.push(format!(
            "transmission from the front and from the back differs by {:.0} %; of a sheet that is reciprocal both are one function, and \
             their mean is fitted",
            100.0 * apart
        ));
    }
    if sheet.is_one_way() {
        let named = ["reflection of the front", "transmission", "reflection of the back"];
        for (_, words) in sheet.quarters.iter().zip(named).filter(|(own, _)| own.is_none()) {
            notes.push(format!("the {words} is black: it has no samples, or none above noise"));
        }
        if sheet.quarters[Quarter::FrontTransmission as usize].is_some() {
            notes.push(
                "the transmission is taken as the same from both sides, as light goes either way".to_owned(),
            );
        }
    }
    if fit.scale < 1.0 {
        notes.push(format!(
            "the file reflects and transmits up to {:.1} % of the light that falls on it; values are lowered to 100 %",
            100.0 / fit.scale
        ));
    }
    notes
}

/// Prints where the light goes.
fn say(output: &Path, notes: &[String], fit: &SheetFit) {
    println!("{}: {} bytes, {} quarters", shown(output), fit.bytes.len(), fit.quarters.len());
    notes.iter().for_each(|note| println!("note  {note}"));
    for QuarterFit { quarter, patches, .. } in &fit.quarters {
        let Some(patches) = patches else { continue };
        let words = quarter_words(*quarter);
        println!("patch {words}: values differ by {:.1} % (relative L2)", 100.0 * patches);
    }
    say_light(&fit.sides, fit.is_symmetric);
}

/// Prints shares of the light that falls on the front, and on the back where that differs.
pub fn say_light(sides: &[Vec<Light>; 2], is_symmetric: bool) {
    let both = ["front", "back"].into_iter().zip(sides);
    for (name, lights) in both.take(if is_symmetric { 1 } else { 2 }) {
        let of = if lights.iter().any(|light| light.data.is_some()) {
            "of the file and of the fit"
        } else {
            "of the fit"
        };
        println!("light on the {name}, share reflected and transmitted, {of}:");
        println!("  degrees   reflected        transmitted");
        for light in lights {
            let of = |which: usize| {
                let data = light.data.map_or_else(|| "-".to_owned(), |data| format!("{:.4}", data[which]));
                format!("{data:>6}  {:.4}", light.fit[which])
            };
            println!("  {:>7.1}   {}   {}", light.theta.to_degrees(), of(0), of(1));
        }
    }
}
