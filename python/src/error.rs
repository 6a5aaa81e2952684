//! Errors of Rust as exceptions of Python.

use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use std::error::Error;
use std::path::Path;

pyo3::create_exception!(
    srbf_brdf,
    FitError,
    PyValueError,
    "An input that a fit, or the reader of a file, refuses; the message names the file, the place and the expectation."
);

/// The text of an error with those of its sources.
fn text(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(reason) = source {
        text = format!("{text}: {reason}");
        source = reason.source();
    }
    text
}

/// A `ValueError`.
pub fn value(error: impl Error) -> PyErr {
    PyValueError::new_err(text(&error))
}

/// A `FitError`, or an `OSError` for a refusal of the system.
pub fn fit(error: srbf_fit::FitError) -> PyErr {
    match error {
        srbf_fit::FitError::Io { ref path, ref source } => io(path, source),
        other => FitError::new_err(text(&other)),
    }
}

/// An `OSError` with its number, so that Python makes `FileNotFoundError` and the like of it.
pub fn io(path: &Path, source: &std::io::Error) -> PyErr {
    match source.raw_os_error() {
        Some(code) => {
            let reason = source.to_string();
            let reason = reason.split(" (os error").next().unwrap_or_default().to_owned();
            PyOSError::new_err((code, reason, path.display().to_string()))
        }
        None => PyOSError::new_err(format!("{}: {source}", path.display())),
    }
}
