//! Reader of published fits: comma-separated rows `material,term,lobe,r,g,b`, after comments that start with `#`.
//!
//! The terms are `diffuse`, with no lobe, and `Cxy`, `Cz` and `n` of lobes that count from 0 and are all there.

use super::{CosineLobe, Lafortune};
use srbf_fit::read::{self, Source};
use srbf_fit::{FitError, ReadError};
use srbf_measured::file::{read_bytes, rows};
use std::path::Path;

const HEADER: &str = "material,term,lobe,r,g,b";
/// Most materials of a file, and lobes of a material.
const MOST: usize = 256;

/// Largest file that is read, bytes.
const MAX_FILE: u64 = 1 << 20;

/// Reads one material of a file, as something to fit.
///
/// # Errors
/// [`FitError::Io`]; [`FitError::Read`] with the line of a fault, or with the names there are.
pub fn read(path: &Path, material: &str) -> Result<Source, FitError> {
    let (bytes, all) = read_all(path)?;
    let names = list(&all);
    let Some((name, model)) = all.into_iter().find(|m| m.0 == material) else {
        return Err(fault(path, format!("material `{material}` where one of {names} was expected")));
    };
    Ok(Source::evaluable(Box::new(model), name, read::sha256(&bytes)))
}

/// The names of the materials of a file, separated by commas.
///
/// # Errors
/// As [`read()`].
pub fn names(path: &Path) -> Result<String, FitError> {
    Ok(list(&read_all(path)?.1))
}

fn list(all: &[(String, Lafortune)]) -> String {
    all.iter().map(|m| m.0.as_str()).collect::<Vec<_>>().join(", ")
}

fn fault(path: &Path, text: String) -> FitError {
    FitError::Read { path: path.to_path_buf(), source: ReadError::Content(text) }
}

/// Names and models, in the order of a file.
type Models = Vec<(String, Lafortune)>;

/// The bytes of a file, and its materials.
fn read_all(path: &Path) -> Result<(Vec<u8>, Models), FitError> {
    let bytes = read_bytes(path, MAX_FILE, |_| Ok(()))?;
    let all = parse(&bytes).map_err(|source| FitError::Read { path: path.to_path_buf(), source })?;
    Ok((bytes, all))
}

/// Parses the fits of a file: names and models, in the order of the file.
///
/// # Errors
/// [`ReadError`], with the line.
pub fn parse(bytes: &[u8]) -> Result<Vec<(String, Lafortune)>, ReadError> {
    let mut lines = rows::text(bytes)?.lines().enumerate().map(|(n, l)| (n + 1, l.trim_end()));
    let fail = |text: String| Err(ReadError::Content(text));
    match lines.find(|(_, l)| !l.starts_with('#')) {
        Some((_, HEADER)) => {}
        other => {
            return fail(format!("line {}: the header `{HEADER}` is expected", other.map_or(1, |l| l.0)));
        }
    }
    // Terms seen of each lobe: a bit each.
    let mut found: Vec<(String, Lafortune, bool, Vec<u8>)> = Vec::new();
    for (line, text) in lines.filter(|(_, l)| !l.is_empty() && !l.starts_with('#')) {
        let mut words = text.splitn(4, ',');
        let (Some(name), Some(term), Some(lobe), Some(numbers)) =
            (words.next(), words.next(), words.next(), words.next())
        else {
            return fail(format!("line {line}: 6 columns are expected"));
        };
        let mut rgb = [0.0; 3];
        rows::row(line, numbers, &mut rgb)?;
        let at = match found.iter().position(|f| f.0 == name) {
            Some(at) => at,
            None if found.len() == MOST => return fail(format!("line {line}: more than {MOST} materials")),
            None => {
                found.push((name.to_owned(), Lafortune::default(), false, vec![]));
                found.len() - 1
            }
        };
        let (_, model, has_diffuse, terms) = &mut found[at];
        if term == "diffuse" {
            if !lobe.is_empty() || *has_diffuse || rgb.iter().any(|v| *v < 0.0) {
                return fail(format!(
                    "line {line}: one diffuse term without a lobe, at least 0, is expected"
                ));
            }
            *has_diffuse = true;
            (0..3).for_each(|c| model.channels[c].diffuse = rgb[c]);
            continue;
        }
        let Some(k) = lobe.parse().ok().filter(|k: &usize| *k < MOST && *k <= terms.len()) else {
            return fail(format!("line {line}: lobe `{lobe}` where {} or less was expected", terms.len()));
        };
        if k == terms.len() {
            terms.push(0);
            model.channels.iter_mut().for_each(|c| c.lobes.push(CosineLobe::default()));
        }
        let bit = match term {
            "Cxy" => 1,
            "Cz" => 2,
            "n" if rgb.iter().all(|v| *v >= 0.0) => 4,
            _ => return fail(format!("line {line}: `{term}` where diffuse, Cxy, Cz or n >= 0 was expected")),
        };
        if terms[k] & bit != 0 {
            return fail(format!("line {line}: {term} of lobe {k} for a second time"));
        }
        terms[k] |= bit;
        for (channel, v) in model.channels.iter_mut().zip(rgb) {
            match bit {
                1 => channel.lobes[k].cxy = v,
                2 => channel.lobes[k].cz = v,
                _ => channel.lobes[k].n = v,
            }
        }
    }
    if let Some((name, ..)) = found.iter().find(|f| !f.2 || f.3.iter().any(|terms| *terms != 7)) {
        return fail(format!("{name}: a diffuse term, and Cxy, Cz and n of every lobe are expected"));
    }
    if found.is_empty() {
        return fail("no materials".to_owned());
    }
    Ok(found.into_iter().map(|f| (f.0, f.1)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_fit::table::Brdf;

    const TEXT: &str = "# a comment\nmaterial,term,lobe,r,g,b\na,diffuse,,0.1,0.2,0.3\na,Cxy,0,-1,-1,-1\n\
                        a,Cz,0,1,1,1\na,n,0,10,20,30\nb,diffuse,,0,0,0.5\n";

    #[test]
    fn a_file_is_read_and_evaluated() {
        let found = parse(TEXT.as_bytes()).unwrap();
        assert_eq!(found.iter().map(|f| f.0.as_str()).collect::<Vec<_>>(), ["a", "b"]);
        let (wi, wo) = ([0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]);
        // The mirror direction: -1 * -0.36 + 0.64 = 1.
        let value = found[0].1.evaluate(wi, wo);
        assert!((value[1] - (1.0 + 0.2 / std::f64::consts::PI)).abs() < 1e-12, "{value:?}");
        assert_eq!(found[1].1.evaluate(wi, wo)[0], 0.0);
    }

    #[test]
    fn damage_names_its_line() {
        for (from, to, message) in [
            ("material,term", "name,term", "line 2"),
            ("a,Cz,0,1,1,1", "a,Cz,0,1,1", "line 5"),
            ("a,Cz,0,1,1,1", "a,Cz,2,1,1,1", "line 5"),
            ("a,Cz,0,1,1,1", "a,Cxy,0,1,1,1", "line 5"),
            ("a,Cz,0,1,1,1", "a,Cz,0,1,x,1", "line 5"),
            ("a,Cz,0,1,1,1", "a,Cw,0,1,1,1", "line 5"),
            ("a,n,0,10,20,30", "a,n,0,10,-20,30", "line 6"),
            ("a,n,0,10,20,30\n", "", "a: a diffuse"),
            ("b,diffuse,,0,0,0.5", "a,diffuse,,0,0,0.5", "line 7"),
        ] {
            let error = parse(TEXT.replacen(from, to, 1).as_bytes()).unwrap_err().to_string();
            assert!(error.contains(message), "{to}: {error}");
        }
        assert!(parse(b"").is_err() && parse(&[0xff, 0xfe]).is_err());
    }
}
