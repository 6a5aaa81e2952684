//! The native part of the Python package `srbf_brdf`: materials, tables and the fit as classes on numpy arrays.
//!
//! It translates and computes nothing: values are those of `srbf-core`, bit for bit. Docs for users stand in
//! `srbf_brdf/_native.pyi`, which editors read, and are the `__doc__` of each class.

mod arrays;
mod blend;
mod error;
mod fit;
mod material;
mod sheet;
mod source;
mod table;
mod verbs;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use srbf_evaluator::Surface;

/// Native part of `srbf_brdf`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("_DEVICE_HEADER", srbf_evaluator::sheet_text(srbf_evaluator::Language::Cpp))?;
    module.add_function(wrap_pyfunction!(_plain_bytes, module)?)?;
    module.add("FitError", module.py().get_type::<error::FitError>())?;
    module.add_class::<material::Material>()?;
    module.add_class::<sheet::Sheet>()?;
    module.add_class::<blend::Blend>()?;
    module.add_class::<table::Table>()?;
    module.add_function(wrap_pyfunction!(table::read, module)?)?;
    module.add_function(wrap_pyfunction!(table::table, module)?)?;
    module.add_function(wrap_pyfunction!(fit::fit, module)?)?;
    module.add_function(wrap_pyfunction!(fit::fit_sheet, module)?)
}

/// The bytes of a material or a sheet as the text of `_DEVICE_HEADER` reads them: in plain numbers.
#[pyfunction]
fn _plain_bytes<'py>(py: Python<'py>, bytes: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
    let surface = Surface::from_bytes(bytes).map_err(error::value)?;
    if !surface.can_read() {
        return Err(PyValueError::new_err(
            "a file of version 1 is not read by the compiled plugin: register(compiled=False) reads it",
        ));
    }
    Ok(PyBytes::new(py, &surface.plain_bytes()))
}
