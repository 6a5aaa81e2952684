//! `KEY=VALUE,KEY=VALUE`: each key known, given at most once, its value in range.

use super::{Colours, Given};
use crate::ReadError;
use std::ops::RangeInclusive;
use std::path::Path;

/// Parameters as they were given, each taken out once.
pub(super) struct Parameters<'a> {
    given: Vec<(&'a str, &'a str)>,
    colours: Colours<'a>,
    /// Keys that were asked for, for the message about one that was not.
    known: Vec<&'static str>,
}

fn fail<T>(text: String) -> Result<T, ReadError> {
    Err(ReadError::Content(text))
}

impl<'a> Parameters<'a> {
    pub fn parse(text: &'a str, colours: Colours<'a>) -> Result<Self, ReadError> {
        let mut given: Vec<(&str, &str)> = Vec::new();
        for part in text.split(',').filter(|p| !p.is_empty()) {
            let Some((key, value)) = part.split_once('=') else {
                return fail(format!("`{part}`: KEY=VALUE was expected"));
            };
            if given.iter().any(|g| g.0 == key) {
                return fail(format!("{key} is given twice"));
            }
            given.push((key, value));
        }
        Ok(Self { given, colours, known: Vec::new() })
    }

    /// Whether a parameter was given and not yet taken.
    pub fn has(&self, key: &str) -> bool {
        self.given.iter().any(|g| g.0 == key)
    }

    /// Takes a parameter as it is.
    pub fn text(&mut self, key: &'static str) -> Option<&'a str> {
        self.known.push(key);
        let at = self.given.iter().position(|g| g.0 == key)?;
        Some(self.given.swap_remove(at).1)
    }

    /// Takes a number.
    pub fn number(
        &mut self,
        key: &'static str,
        default: f64,
        range: RangeInclusive<f64>,
    ) -> Result<f64, ReadError> {
        self.text(key).map_or(Ok(default), |text| number(key, text, &range))
    }

    /// Takes a reflectance: a number in [0, 1], three with slashes between, or the file of a spectrum.
    pub fn colour(&mut self, key: &'static str, default: f64) -> Result<[f64; 3], ReadError> {
        let Some(text) = self.text(key) else { return Ok([default; 3]) };
        if text.parse::<f64>().is_err() && Path::new(text).is_file() {
            return (self.colours)(Given::File(Path::new(text)));
        }
        let words: Vec<&str> = text.split('/').collect();
        let one = |word: &str| number(key, word, &(0.0..=1.0));
        match words[..] {
            [grey] if grey.contains('.') && grey.parse::<f64>().is_err() => {
                fail(format!("{key}: `{text}` where a colour, or the file of a spectrum, was expected"))
            }
            [grey] => Ok([one(grey)?; 3]),
            [red, green, blue] => {
                let rgb = [one(red)?, one(green)?, one(blue)?];
                (self.colours)(Given::Rgb(rgb))
            }
            _ => fail(format!(
                "{key}: `{text}` where one number, RED/GREEN/BLUE or the file of a spectrum was expected"
            )),
        }
    }

    /// Takes the two roughnesses: `alpha`, or `alpha_x` and `alpha_y`.
    pub fn roughness(&mut self) -> Result<[f64; 2], ReadError> {
        let range = 1e-3..=1.0;
        if self.has("alpha") && (self.has("alpha_x") || self.has("alpha_y")) {
            return fail("alpha_x and alpha_y take the place of alpha: not both".into());
        }
        let alpha = self.number("alpha", 0.2, range.clone())?;
        Ok([self.number("alpha_x", alpha, range.clone())?, self.number("alpha_y", alpha, range)?])
    }

    /// A parameter that no model took is a mistake.
    pub fn finish(self) -> Result<(), ReadError> {
        match self.given.first() {
            None => Ok(()),
            Some((key, _)) => fail(format!("no parameter {key}; there are {}", self.known.join(", "))),
        }
    }
}

fn number(key: &str, text: &str, range: &RangeInclusive<f64>) -> Result<f64, ReadError> {
    match text.parse::<f64>() {
        // False for a NaN too.
        Ok(v) if range.contains(&v) => Ok(v),
        _ => {
            let shown: String = text.chars().take(40).collect();
            fail(format!(
                "{key}: `{shown}` where a number from {} to {} was expected",
                range.start(),
                range.end()
            ))
        }
    }
}

/// Refuses a diffuse and a specular share that reflect more than comes in.
pub(super) fn check_sum(diffuse: [f64; 3], specular: [f64; 3]) -> Result<(), ReadError> {
    match (0..3).find(|&c| diffuse[c] + specular[c] > 1.0) {
        None => Ok(()),
        Some(c) => fail(format!("diffuse {} and specular {} are more than 1", diffuse[c], specular[c])),
    }
}
