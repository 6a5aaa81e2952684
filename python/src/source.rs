//! BRDFs: a material, and a function of Python.

use pyo3::prelude::*;
use srbf_core::{Level, MAX_LOBES, Material, Mixture};
use srbf_fit::table::{Brdf, Symmetry};
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

/// A material as a BRDF: its value without the cosine.
pub struct AsBrdf<'m>(pub &'m Material<Vec<u8>>);

impl Brdf for AsBrdf<'_> {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let mut mixture = Mixture::<MAX_LOBES>::empty();
        // The same on every processor; no direction that is given is none.
        if self.0.prepare_with(wo.map(|v| v as f32), Level::Scalar.into(), &mut mixture).is_err() {
            return [0.0; 3];
        }
        let value = mixture.evaluate(wi.map(|v| v as f32)).to_array();
        value.map(|v| f64::from(v) / wi[2].max(1e-6))
    }

    fn symmetry(&self) -> Symmetry {
        if self.0.is_isotropic() { Symmetry::Isotropic } else { Symmetry::None }
    }
}

/// What ends a fit early: raised by `resume_unwind` in a thread of the fit, which no message is printed for.
pub struct Stopped;

/// Whether a fit is to end, and the exception that made it.
#[derive(Clone, Default)]
pub struct Stop {
    is_asked: Arc<AtomicBool>,
    error: Arc<Mutex<Option<PyErr>>>,
}

impl Stop {
    pub fn ask(&self) {
        self.is_asked.store(true, Ordering::Relaxed);
    }

    /// Unwinds if the fit is to end.
    pub fn check(&self) {
        if self.is_asked.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Stopped));
        }
    }

    /// Keeps the first exception, and unwinds.
    fn fail(&self, error: PyErr) -> ! {
        if let Ok(mut first) = self.error.lock() {
            first.get_or_insert(error);
        }
        self.ask();
        resume_unwind(Box::new(Stopped))
    }

    pub fn take_error(&self) -> Option<PyErr> {
        self.error.lock().ok().and_then(|mut error| error.take())
    }
}

/// A function `f(wo, wi)` of Python, called with one pair of directions at a time.
pub struct Function {
    pub function: Py<PyAny>,
    pub symmetry: Symmetry,
    pub stop: Stop,
}

impl Brdf for Function {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        self.stop.check();
        let call = |py: Python<'_>| {
            let value = self.function.call1(py, (wo, wi))?;
            value.extract::<f64>(py).map(|grey| [grey; 3]).or_else(|_| value.extract::<[f64; 3]>(py))
        };
        match Python::attach(call) {
            Ok(value) => value,
            Err(error) => self.stop.fail(error),
        }
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }
}
