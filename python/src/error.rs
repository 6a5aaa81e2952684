//! Errors of Rust as exceptions of Python.

use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use srbf_core::printable;
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
        srbf_fit::FitError::Threads(reason) => PyRuntimeError::new_err(reason),
        other => FitError::new_err(text(&other)),
    }
}

/// Does work on threads that a forked child has too, without Python's lock: whatever may use several threads is done in here.
pub fn work<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, srbf_fit::FitError> + Send,
) -> PyResult<T> {
    py.detach(|| srbf_fit::in_threads(work)).and_then(|made| made).map_err(fit)
}

/// An `OSError` with its number, so that Python makes `FileNotFoundError` and the like of it.
pub fn io(path: &Path, source: &std::io::Error) -> PyErr {
    match source.raw_os_error() {
        Some(code) => {
            let reason = source.to_string();
            let reason = reason.split(" (os error").next().unwrap_or_default().to_owned();
            PyOSError::new_err((code, reason, path.display().to_string()))
        }
        None => PyOSError::new_err(format!("{}: {source}", printable(&path.to_string_lossy()))),
    }
}
