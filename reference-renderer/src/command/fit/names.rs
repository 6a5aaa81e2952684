//! `srbf fit`: the names of the files that it writes. Endings are added to names, never put in place of a part of them.

use super::method::MethodName;
use crate::out::output;
use crate::out::print::shown;
use anyhow::{Context, bail, ensure};
use clap::ValueEnum;
use srbf_fit::analytic::PREFIX;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Folder that is written to if no file is named.
const FOLDER: &str = "out";

/// The name of the input: that of its file without the last ending, of the one material that is taken from it, or of a
/// model with all its parameters.
pub fn stem(file: &Path, material: Option<&str>) -> anyhow::Result<OsString> {
    let model = file.to_str().and_then(|text| text.strip_prefix(PREFIX));
    Ok(match material.or(model) {
        Some(text) => as_file_name(text).into(),
        None => file.file_stem().context("the file has no name")?.to_owned(),
    })
}

/// A text with `-` for characters that a file name should not have.
pub fn as_file_name(text: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || "-_.,=".contains(c) { c } else { '-' };
    text.chars().map(plain).collect()
}

/// An input, and where its fit goes.
#[derive(Debug, PartialEq)]
pub struct Job {
    /// The file or the model that is fitted.
    pub file: PathBuf,
    /// The material, or the report of another method.
    pub output: PathBuf,
}

/// The place of every input, after it has been found that it can be written and that no two are the same.
///
/// # Errors
/// Names the input or the output.
pub fn places(
    files: &[PathBuf],
    output: Option<&Path>,
    material: Option<&str>,
    method: MethodName,
) -> anyhow::Result<Vec<Job>> {
    ensure!(files.len() == 1 || material.is_none(), "--material: it is of one file");
    let mut places: Vec<Job> = Vec::new();
    for file in files {
        let output = place(file, output, files.len() > 1, material, method)?;
        if let Some(other) = places.iter().find(|place| place.output == output) {
            let [other, file] = [&other.file, file].map(shown);
            bail!("{other} and {file} would both be written to {}", shown(&output));
        }
        places.push(Job { file: file.clone(), output });
    }
    for place in &places {
        output::check_place(&place.output)?;
        if method == MethodName::Tracked {
            output::check_place(&report(&place.output))?;
        }
    }
    Ok(places)
}

/// Where the fit of a file goes: `-o`, or a name in the folder that it names.
fn place(
    file: &Path,
    output: Option<&Path>,
    is_one_of_many: bool,
    material: Option<&str>,
    method: MethodName,
) -> anyhow::Result<PathBuf> {
    let stem = stem(file, material)?;
    let is_folder = |path: &Path| path.as_os_str().to_string_lossy().ends_with(std::path::is_separator);
    let output = match output {
        None => None,
        Some(path) if is_one_of_many || is_folder(path) => {
            let is_file = ["srbf", "json"].iter().any(|ending| ends_in(path, ending));
            ensure!(!is_file, "-o {}: of several files it names a folder", shown(path));
            Some(path.join(with(&stem, ".srbf")))
        }
        Some(path) => Some(path.to_owned()),
    };
    if method == MethodName::Tracked {
        self::material(output, &stem)
    } else {
        Ok(baseline(output, &stem, method))
    }
}

/// The material to write.
fn material(output: Option<PathBuf>, stem: &OsString) -> anyhow::Result<PathBuf> {
    match output {
        Some(path) if ends_in(&path, "json") => {
            bail!("{}: -o names the material, and the report beside it ends in .json", shown(&path))
        }
        Some(path) => Ok(path),
        None => Ok(Path::new(FOLDER).join(with(stem, ".srbf"))),
    }
}

/// The report beside a material.
pub fn report(material: &Path) -> PathBuf {
    if ends_in(material, "srbf") { material.with_extension("json") } else { with(material, ".json").into() }
}

/// The picture beside a material.
pub fn picture(material: &Path) -> PathBuf {
    if ends_in(material, "srbf") { material.with_extension("png") } else { with(material, ".png").into() }
}

/// The report of another method: `-o` if it ends in .json; otherwise the name of the method is added, so that the report of our own
/// fit stays.
fn baseline(output: Option<PathBuf>, stem: &OsString, method: MethodName) -> PathBuf {
    let path = match output {
        Some(path) if ends_in(&path, "json") => return path,
        Some(path) if ends_in(&path, "srbf") => path.with_extension(""),
        Some(path) => path,
        None => Path::new(FOLDER).join(stem),
    };
    let method = method.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
    with(&path, &format!("-{method}.json")).into()
}

fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending))
}

fn with(path: impl AsRef<std::ffi::OsStr>, ending: &str) -> OsString {
    let mut name = path.as_ref().to_owned();
    name.push(ending);
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_inputs_or_methods_have_one_output() {
        let name = |file: &str, material| stem(Path::new(file), material).unwrap();
        let written = |file| material(None, &name(file, None)).unwrap().display().to_string();
        assert_eq!(written("a/steel.v2.csv"), "out/steel.v2.srbf");
        assert_eq!(written("a/steel.v3.csv"), "out/steel.v3.srbf");
        assert_eq!(written("model:ggx:alpha=0.2,f0=0.9/0.8/0.1"), "out/ggx-alpha=0.2,f0=0.9-0.8-0.1.srbf");
        assert_eq!(name("fits.csv", Some("blue/paint")), "blue-paint");

        assert_eq!(report(Path::new("out/steel.v2.srbf")), Path::new("out/steel.v2.json"));
        assert_eq!(report(Path::new("out/steel.v2")), Path::new("out/steel.v2.json"));
        let other = |output: Option<&str>, method| baseline(output.map(Into::into), &"a.b".into(), method);
        assert_eq!(other(None, MethodName::Thesis), Path::new("out/a.b-thesis.json"));
        assert_eq!(other(Some("x.srbf"), MethodName::Lafortune), Path::new("x-lafortune.json"));
        assert_eq!(other(Some("x.v1"), MethodName::Thesis), Path::new("x.v1-thesis.json"));
        assert_eq!(other(Some("x.json"), MethodName::Thesis), Path::new("x.json"));
        assert!(material(Some("x.JSON".into()), &"x".into()).is_err());
    }

    #[test]
    fn several_files_go_into_a_folder_and_none_over_another() {
        let of = |files: &[&str], output: Option<&str>| {
            let files: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
            let place = |file| place(file, output.map(Path::new), files.len() > 1, None, MethodName::Tracked);
            files.iter().map(|file| place(file).map(|path| path.display().to_string())).collect::<Vec<_>>()
        };
        let good = |files, output| of(files, output).into_iter().map(Result::unwrap).collect::<Vec<_>>();
        assert_eq!(good(&["a/x.csv", "b/y.binary"], Some("fits")), ["fits/x.srbf", "fits/y.srbf"]);
        assert_eq!(good(&["a/x.csv", "b/y.binary"], None), ["out/x.srbf", "out/y.srbf"]);
        assert_eq!(good(&["a/x.csv"], Some("fits/")), ["fits/x.srbf"]);
        assert_eq!(good(&["a/x.csv"], Some("fits")), ["fits"]);
        assert!(of(&["a/x.csv", "b/y.csv"], Some("one.srbf"))[0].is_err());
        let twins = ["a/x.csv".into(), "b/x.csv".into()];
        let error = places(&twins, None, None, MethodName::Tracked).unwrap_err().to_string();
        assert!(error.contains("a/x.csv and b/x.csv") && error.contains("out/x.srbf"), "{error}");
    }
}
