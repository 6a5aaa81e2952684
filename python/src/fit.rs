//! `fit`: in a thread of its own, so that this one can show progress and be interrupted.

use crate::error;
use crate::material::Material;
use crate::sheet::Sheet;
use crate::source::{Function, Stop, Stopped};
use crate::table::{Table, name_of, symmetry_of, table};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::report::Input;
use srbf_fit::judge::verdict::Verdict;
use srbf_fit::read::window::Band;
use srbf_fit::read::{Content, Conventions, sheet_of};
use srbf_fit::table::Symmetry;
use srbf_fit::{FactorNodes, Fit, FitError, Settings, fit_content, fit_source, in_threads};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

/// How often progress is shown, and an interruption is seen.
const STEP: Duration = Duration::from_millis(100);

/// The input of a fit: a table of Python, which is not copied, or a function.
enum From {
    Table(Py<Table>),
    Function(Box<Function>),
}

impl From {
    fn fit(&self, settings: &Settings, progress: impl FnMut(f64) + Send) -> Result<Fit, FitError> {
        match self {
            Self::Table(table) => fit_source(&table.get().source, settings, progress),
            Self::Function(function) => {
                // The trait object has to own the function.
                let function = Python::attach(|py| Function {
                    function: function.function.clone_ref(py),
                    symmetry: function.symmetry,
                    stop: function.stop.clone(),
                });
                fit_content(&Content::Evaluable(Box::new(function)), settings, progress)
            }
        }
    }
}

/// Fits lobes to a measurement.
///
/// `source`: a `Table`; the path of a measured file or `model:...`; a tuple of arrays `(wo, wi, f)`, see `table`; or a function
/// `f(wo, wi)` that takes two unit vectors, tuples of three floats with z > 0, and returns the BRDF without a cosine, 1/sr, as three
/// floats or one. It is called some million times, from one thread at a time.
///
/// `lobes`: 1 to 64. `error`: the mean relative L2 error that is asked for; as few lobes as reach it are used, at most `lobes`. `views`:
/// how many mixtures are stored. `bytes`: how many the material has at most; they are spent on factors where that shows. `factors`: "chosen", "none", or the numbers of nodes `(half, difference, azimuth)`, also as "24x6x3"; "24x6x5s" for signed ones. `symmetry`: of a function,
/// "isotropic", which is usual, "quadrant", "half turn" or "none"; other sources have their own. `progress`: True shows a bar, False nothing; a function is called with the share that is
/// done, 0 to 1. An interruption (Ctrl-C, or the stop button of a notebook) ends the fit.
#[pyfunction]
#[pyo3(signature = (source, *, lobes = 12, error = None, views = None, factors = None, squeezed = None, mirrored = None,
    bytes = None, smoothness = None, starts = None, steps = None, exchanges = None, symmetry = None, provenance = "", progress = None))]
#[allow(clippy::too_many_arguments)] // they are keywords, as Python has them
pub fn fit<'py>(
    py: Python<'py>,
    source: &Bound<'py, PyAny>,
    lobes: usize,
    error: Option<f64>,
    views: Option<usize>,
    factors: Option<&Bound<'py, PyAny>>,
    squeezed: Option<usize>,
    mirrored: Option<usize>,
    bytes: Option<usize>,
    smoothness: Option<f64>,
    starts: Option<usize>,
    steps: Option<usize>,
    exchanges: Option<usize>,
    symmetry: Option<&str>,
    provenance: &str,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Material> {
    let usual = Settings::default();
    let mut settings = Settings {
        lobes,
        error,
        squeezed,
        mirrored,
        bytes: bytes.unwrap_or(usual.bytes),
        smoothness: smoothness.unwrap_or(usual.smoothness),
        starts: starts.unwrap_or(usual.starts),
        steps: steps.unwrap_or(usual.steps),
        exchanges: exchanges.unwrap_or(usual.exchanges),
        views,
        factors: factor_nodes(factors)?,
        ..usual
    };
    settings.check().map_err(error::fit)?;
    let symmetry = symmetry.map(symmetry_of).transpose()?;
    let stop = Stop::default();
    let from = from(source, symmetry, &stop)?;
    let (input, first_line) = match &from {
        From::Table(table) => {
            let source = &table.get().source;
            let hash =
                if source.sha256.is_empty() { String::new() } else { format!(" sha256 {}", source.sha256) };
            let input = Input { name: source.name.clone(), sha256: source.sha256.clone() };
            (input, format!("{}{hash}\n", source.name))
        }
        From::Function(_) => {
            (Input { name: "a function".into(), sha256: String::new() }, "a function of Python\n".to_owned())
        }
    };
    settings.provenance = match provenance {
        "" => first_line,
        text => format!("{}\n", text.trim_end()),
    };

    let show = py.import("srbf_brdf.progress")?.call_method1("show", (progress,))?;
    let made = run(py, &stop, &show, {
        let settings = settings.clone();
        move |progress| from.fit(&settings, progress)
    });
    show.call_method0("close")?;
    let fit = made?;
    let material = Material::new(fit.bytes).map_err(error::value)?;
    let report = || -> Result<(String, Vec<String>), FitError> {
        let json = fit.report.to_json(&material.material, &input, &settings)?;
        let verdict = Verdict::of_material(&fit.report, &reciprocity(&material.material)?);
        let notes = fit.report.notes().into_iter().map(|note| format!("note {note}"));
        Ok((json, notes.chain(verdict.lines()).collect()))
    };
    let (json, words) = error::work(py, report)?;
    Ok(material.fitted(json, words))
}

/// Fits all quarters of a sheet: of a file of a window (WINDOW, Radiance), or of samples in front and behind.
///
/// `band`: the part of the spectrum of a file of a window, "visible", "solar", "infrared" or a name in the file; of samples, "visible". `lobes`, `views` and
/// `bytes` are those of each quarter, and `progress` is as `fit` has it.
#[pyfunction]
#[pyo3(signature = (path, *, band = "visible", lobes = 12, views = None, bytes = None, starts = None, steps = None, exchanges = None,
    provenance = "", progress = None))]
#[allow(clippy::too_many_arguments)] // they are keywords, as Python has them
pub fn fit_sheet<'py>(
    py: Python<'py>,
    path: PathBuf,
    band: &str,
    lobes: usize,
    views: Option<usize>,
    bytes: Option<usize>,
    starts: Option<usize>,
    steps: Option<usize>,
    exchanges: Option<usize>,
    provenance: &str,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Sheet> {
    let usual = Settings::default();
    let mut settings = Settings {
        lobes,
        views,
        bytes: bytes.unwrap_or(usual.bytes),
        starts: starts.unwrap_or(usual.starts),
        steps: steps.unwrap_or(usual.steps),
        exchanges: exchanges.unwrap_or(usual.exchanges),
        ..usual
    };
    settings.check().map_err(error::fit)?;
    let band = Band::parse(band).map_err(|error| PyValueError::new_err(format!("band: {error}")))?;
    let conventions = Conventions { band, ..Conventions::default() };
    let sheet = error::work(py, || sheet_of(&path, &conventions, true))?;
    let sheet =
        Arc::new(sheet.ok_or_else(|| PyValueError::new_err("a model is no sheet: a file is expected"))?);
    settings.provenance = match provenance {
        "" => format!("{} sha256 {}\n", sheet.name, sheet.sha256),
        text => format!("{}\n", text.trim_end()),
    };
    let show = py.import("srbf_brdf.progress")?.call_method1("show", (progress,))?;
    let stop = Stop::default();
    let made = run(py, &stop, &show, {
        let sheet = sheet.clone();
        move |progress| srbf_fit::fit_sheet(&sheet, &settings, progress)
    });
    show.call_method0("close")?;
    let fit = made?;
    let report = fit.to_json(&sheet).to_string();
    Sheet::fitted(fit.bytes, report)
}

/// How the thread of a fit ends.
type Ended<T> = Result<Result<T, FitError>, Box<dyn std::any::Any + Send>>;

/// Called with the share that is done, and ends a fit that is to stop.
type Report<'a> = &'a mut (dyn FnMut(f64) + Send);

/// Runs a fit in another thread, and shows its progress in this one.
fn run<T: Send + 'static>(
    py: Python<'_>,
    stop: &Stop,
    show: &Bound<'_, PyAny>,
    fit: impl FnOnce(Report<'_>) -> Result<T, FitError> + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver): (Sender<Ended<T>>, _) = channel();
    let share = Arc::new(AtomicU64::new(0f64.to_bits()));
    let thread = {
        let (stop, share) = (stop.clone(), share.clone());
        move || {
            let mut report = |done: f64| {
                stop.check();
                share.store(done.to_bits(), Ordering::Relaxed);
            };
            // On threads that a forked child has too.
            let fit = || in_threads(|| fit(&mut report)).and_then(|fit| fit);
            let ended = catch_unwind(AssertUnwindSafe(fit));
            // Nobody listens any more if the fit was interrupted.
            let _ = sender.send(ended);
        }
    };
    std::thread::Builder::new().name("srbf fit".into()).spawn(thread)?;
    loop {
        // Alone in its use, as a receiver cannot be shared.
        let receiver = &mut receiver;
        match py.detach(move || receiver.recv_timeout(STEP)) {
            Ok(Ok(fit)) => {
                let fit = fit.map_err(error::fit)?;
                show.call_method1("update", (1.0,))?;
                return Ok(fit);
            }
            Ok(Err(reason)) if reason.is::<Stopped>() => {
                let stopped = || PyRuntimeError::new_err("the fit was stopped");
                return Err(stop.take_error().unwrap_or_else(stopped));
            }
            Ok(Err(reason)) => resume_unwind(reason),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the thread of the fit ended without a result"));
            }
            Err(RecvTimeoutError::Timeout) => {
                let done = f64::from_bits(share.load(Ordering::Relaxed));
                let shown = py.check_signals().and_then(|()| show.call_method1("update", (done,)));
                if let Err(error) = shown {
                    stop.ask();
                    return Err(error);
                }
            }
        }
    }
}

fn factor_nodes(factors: Option<&Bound<'_, PyAny>>) -> PyResult<FactorNodes> {
    let Some(factors) = factors else { return Ok(FactorNodes::Chosen) };
    if let Ok(word) = factors.extract::<String>() {
        return word
            .parse()
            .map_err(|error| PyValueError::new_err(format!("factors: {error}, not {word:?}")));
    }
    let expected = |_| {
        PyValueError::new_err(
            "factors: \"chosen\", \"none\", \"24x6x5s\" and the like, (half, difference) or (half, difference, azimuth) is expected",
        )
    };
    if let Ok([half, difference]) = factors.extract::<[usize; 2]>() {
        return Ok(FactorNodes::Given([half, difference, 1]));
    }
    Ok(FactorNodes::Given(factors.extract::<[usize; 3]>().map_err(expected)?))
}

fn from(source: &Bound<'_, PyAny>, symmetry: Option<Symmetry>, stop: &Stop) -> PyResult<From> {
    if source.is_callable() {
        let symmetry = symmetry.unwrap_or(Symmetry::Isotropic);
        let function = Function { function: source.clone().unbind(), symmetry, stop: stop.clone() };
        return Ok(From::Function(Box::new(function)));
    }
    let table =
        if let Ok((wo, wi, f)) = source.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>, Bound<'_, PyAny>)>() {
            Bound::new(source.py(), table(source.py(), &wo, &wi, &f, "samples")?)?
        } else if source.cast::<PyDict>().is_ok() {
            return Err(PyValueError::new_err("a tuple of arrays (wo, wi, f) is expected, not a dict"));
        } else {
            Table::of(source)?
        };
    let own = table.get().symmetry();
    if symmetry.is_some_and(|given| name_of(given) != own) {
        let text = format!("symmetry: that of this source is {own:?}; another one is for functions");
        return Err(PyValueError::new_err(text));
    }
    Ok(From::Table(table.unbind()))
}
