//! `Table`: a measured file, arrays of samples, or an analytic model.

use crate::arrays::{Vectors, broadcast_vectors, cast, table as array_of, text as shape_text};
use crate::error;
use numpy::{PyArray1, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use srbf_core::printable;
use srbf_fit::look::{Finding, Look};
use srbf_fit::read::{Content, Conventions, LeftOut, Reason, Source, csv};
use srbf_fit::table::{Symmetry, evaluation_views};
use srbf_fit::{ReadError, analytic};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A pickle: a function, and its arguments.
pub type Reduced<'py, Arguments> = (Bound<'py, PyAny>, Arguments);

/// A measurement: scattered samples, or values at every pair of directions.
#[pyclass(frozen, module = "srbf_brdf")]
pub struct Table {
    pub source: Source,
    origin: Origin,
}

/// The way to make a table once more, in another process.
enum Origin {
    /// A model by its name.
    Model(PathBuf),
    /// A file by its place, whose bytes would double the memory of the table.
    File(PathBuf),
    /// The bytes of a file that is elsewhere.
    Bytes(Vec<u8>),
    /// Samples, as a table of text.
    Samples(String),
}

/// Most bytes of a file that is pickled.
const MAX_FILE: u64 = 1 << 30;

/// Symmetries by the names that Python has for them.
pub const SYMMETRIES: [(&str, Symmetry); 4] = [
    ("isotropic", Symmetry::Isotropic),
    ("quadrant", Symmetry::Quadrant),
    ("half turn", Symmetry::HalfTurn),
    ("none", Symmetry::None),
];

/// The symmetry of that name.
pub fn symmetry_of(name: &str) -> PyResult<Symmetry> {
    let expected = || {
        let all = SYMMETRIES.map(|s| format!("{:?}", s.0)).join(", ");
        PyValueError::new_err(format!("symmetry: one of {all} is expected, not {name:?}"))
    };
    SYMMETRIES.iter().find(|s| s.0 == name).map(|s| s.1).ok_or_else(expected)
}

/// The name of a symmetry.
pub fn name_of(symmetry: Symmetry) -> &'static str {
    SYMMETRIES.iter().find(|s| s.1 == symmetry).map_or("none", |s| s.0)
}

/// Reads a measured file: MERL `.binary`, RGL `.bsdf`, Cornell `.brdf` and `.astm`, samples as `.csv`; or `model:...`, an
/// analytic model such as `model:ggx:alpha=0.2,f0=0.9`.
#[pyfunction]
pub fn read(py: Python<'_>, path: PathBuf) -> PyResult<Table> {
    let source = error::work(py, || srbf_fit::read::read(&path))?;
    let is_model = path.to_str().is_some_and(|path| path.starts_with(analytic::PREFIX));
    let origin = if is_model {
        Origin::Model(path)
    } else {
        // Wherever this process goes from here.
        Origin::File(std::path::absolute(&path).unwrap_or(path))
    };
    Ok(Table { source, origin })
}

/// Makes a table of samples: directions `wo` and `wi` and the BRDF `f` (without a cosine, 1/sr, linear sRGB), float64 of
/// shape (..., 3) each. `f` of shape (...) is grey. Samples whose `f` is NaN or masked are left out, and `left_out` counts them.
#[pyfunction]
#[pyo3(signature = (wo, wi, f, name = "samples"))]
pub fn table(
    py: Python<'_>,
    wo: &Bound<'_, PyAny>,
    wi: &Bound<'_, PyAny>,
    f: &Bound<'_, PyAny>,
    name: &str,
) -> PyResult<Table> {
    let (mut wo, mut wi) = (Vectors::<f64>::new(wo, "wo")?, Vectors::<f64>::new(wi, "wi")?);
    let given = format!("wo of shape {} and wi of shape {}", wo.operand().text(), wi.operand().text());
    let shape = broadcast_vectors(&mut [&mut wo, &mut wi], None)?;
    let f = cast::<f64>(&unmasked(f)?, "f")?;
    // Not by the count of numbers: (3, n) has as many as (n, 3).
    let channels = match f.shape().strip_prefix(&shape.lead[..]) {
        Some([] | [1]) => 1,
        Some([3]) => 3,
        _ => 0,
    };
    if shape.n == 0 || channels == 0 {
        let [grey, colour] = [&[][..], &[3]].map(|last| shape_text(&[&shape.lead, last].concat()));
        let text = format!(
            "f of shape {}, {given}: f of shape {grey} or {colour}, and a sample at least, are expected",
            shape_text(f.shape())
        );
        return Err(PyValueError::new_err(text));
    }
    let f = f.as_slice().map_err(|e| PyValueError::new_err(format!("f: {e}")))?;
    let text = py.detach(|| {
        // The reader of CSV groups, checks and names the fault of a line: a sample is line n + 2.
        let mut text = String::from("wo_x,wo_y,wo_z,wi_x,wi_y,wi_z,r,g,b\n");
        for i in 0..shape.n {
            let [o, d] = [&wo, &wi].map(|vectors| vectors.slices().map(|c| c[i]));
            let rgb = [0, 1, 2].map(|c| if channels == 1 { f[i] } else { f[3 * i + c] });
            let [r, g, b] = rgb;
            // Writing to a string does not fail.
            let _ = writeln!(text, "{},{},{},{},{},{},{r},{g},{b}", o[0], o[1], o[2], d[0], d[1], d[2]);
        }
        text
    });
    of_samples(py, name, text)
}

/// An array with NaN in place of masked values.
fn unmasked<'py>(object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let masked = object.py().import("numpy")?.getattr("ma")?;
    if !masked.call_method1("isMaskedArray", (object,))?.is_truthy()? {
        return Ok(object.clone());
    }
    object.call_method1("astype", ("float64",))?.call_method1("filled", (f64::NAN,))
}

/// Makes a table of samples as text.
fn of_samples(py: Python<'_>, name: &str, text: String) -> PyResult<Table> {
    let make = || {
        let fault = |source| srbf_fit::FitError::Read { path: name.into(), source };
        let intake = csv::parse(text.as_bytes(), &Conventions::default()).map_err(fault)?;
        // Directions below the horizon are mistakes; NaN is a value that was not measured.
        let is_fault = |left: &LeftOut| matches!(left.reason, Reason::Transmission | Reason::Behind);
        if intake.left_out.iter().any(is_fault) {
            let text = format!("{}; directions above the horizon are expected", intake.left_out_text());
            return Err(fault(ReadError::Content(text)));
        }
        Source::of_samples(intake, name.to_owned(), String::new())
    };
    Ok(Table { source: error::work(py, make)?, origin: Origin::Samples(text) })
}

impl Table {
    /// A table, or the one that a path names.
    pub fn of<'py>(object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, Self>> {
        if let Ok(table) = object.cast::<Self>() {
            return Ok(table.clone());
        }
        match object.extract::<PathBuf>() {
            Ok(path) => Bound::new(object.py(), read(object.py(), path)?),
            Err(_) => Err(PyTypeError::new_err("a Table, or the path of a measured file, is expected")),
        }
    }
}

#[pymethods]
impl Table {
    /// Name of the file, or of the model.
    #[getter]
    fn name(&self) -> &str {
        &self.source.name
    }

    /// SHA-256 of the file, hexadecimal; empty for arrays.
    #[getter]
    fn sha256(&self) -> &str {
        &self.source.sha256
    }

    /// Whether it has a value at every pair of directions; otherwise it is scattered samples.
    #[getter]
    fn is_evaluable(&self) -> bool {
        matches!(self.source.content, Content::Evaluable(_))
    }

    /// Rows that were not taken as samples, counted by reason, with their lines; empty for none. Row i of arrays is line i + 2.
    #[getter]
    fn left_out(&self) -> String {
        self.source.intake.as_ref().map(srbf_fit::read::Intake::left_out_text).unwrap_or_default()
    }

    /// What turning or mirroring both directions leaves as it is: "isotropic", "quadrant", "half turn" or "none".
    #[getter]
    pub fn symmetry(&self) -> &'static str {
        name_of(match &self.source.content {
            Content::Samples(_) => Symmetry::Isotropic,
            Content::Evaluable(brdf) => brdf.symmetry(),
        })
    }

    /// Of the bytes of a file, or of samples as text: how it is unpickled.
    #[staticmethod]
    fn _restored(py: Python<'_>, name: &str, bytes: Vec<u8>, is_file: bool) -> PyResult<Self> {
        if !is_file {
            return of_samples(py, name, String::from_utf8(bytes)?);
        }
        let read = || srbf_fit::read::read_from(name, &bytes, &Conventions::default());
        Ok(Self { source: error::work(py, read)?, origin: Origin::Bytes(bytes) })
    }

    /// A file is read once more, and has to be as it was.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py, Bound<'py, PyTuple>>> {
        let bytes = match &self.origin {
            Origin::Model(name) => {
                let read = py.import("srbf_brdf")?.getattr("read")?;
                return Ok((read, (name,).into_pyobject(py)?));
            }
            Origin::File(path) => {
                let bytes = srbf_fit::read_at_most(path, MAX_FILE).map_err(|e| error::io(path, &e))?;
                let bytes = PyBytes::new(py, &bytes);
                let hash = py.import("hashlib")?.call_method1("sha256", (&bytes,))?;
                if hash.call_method0("hexdigest")?.extract::<String>()? != self.source.sha256 {
                    let path = printable(&path.to_string_lossy()).to_string();
                    return Err(PyValueError::new_err(format!("{path}: changed since it was read")));
                }
                bytes
            }
            Origin::Bytes(bytes) => PyBytes::new(py, bytes),
            Origin::Samples(text) => PyBytes::new(py, text.as_bytes()),
        };
        let is_file = !matches!(self.origin, Origin::Samples(_));
        let restored = py.get_type::<Self>().getattr("_restored")?;
        Ok((restored, (&self.source.name, bytes, is_file).into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        let of = match &self.source.content {
            Content::Samples(table) => {
                let samples: usize = table.views.iter().map(|v| v.samples.len()).sum();
                format!("{samples} samples at {} outgoing directions", table.views.len())
            }
            Content::Evaluable(_) => format!("values everywhere, symmetry {}", self.symmetry()),
        };
        format!("<srbf_brdf.Table {}: {of}>", printable(&self.source.name))
    }

    /// `f cos` of pairs of directions, float64 of shape (..., 3), 1/sr; only of a table with a value everywhere.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Content::Evaluable(brdf) = &self.source.content else {
            let text = "scattered samples have no value in between; `fit` completes them";
            return Err(PyValueError::new_err(text));
        };
        let (mut wo, mut wi) = (Vectors::<f64>::new(wo, "wo")?, Vectors::<f64>::new(wi, "wi")?);
        let shape = broadcast_vectors(&mut [&mut wo, &mut wi], None)?;
        let value = |i: usize| {
            let [wo, wi] = [&wo, &wi].map(|vectors| vectors.slices().map(|c| c[i]));
            let is_above = wo[2] > 0.0 && wi[2] > 0.0;
            let f = if is_above { brdf.evaluate(wi, wo) } else { [0.0; 3] };
            f.map(|f| if f.is_finite() { f * wi[2] } else { 0.0 })
        };
        let values = py.detach(|| (0..shape.n).flat_map(value).collect());
        shape.array(py, values, &[3])
    }

    /// Its samples, as a dict of float64 arrays: `theta_o` (n,), the angle of the outgoing direction from the normal in radians;
    /// `wi` (n, 3) in the frame whose outgoing direction is `(-sin theta_o, 0, cos theta_o)`, `y >= 0`; `f` (n, 3), the BRDF without a
    /// cosine, 1/sr; `weight` (n,), the solid angle that it stands for, sr.
    ///
    /// A table with a value everywhere is sampled at outgoing directions of `angles`, degrees, by default every 15 up to 75; samples are given as they were read.
    #[pyo3(signature = (angles = None))]
    fn samples<'py>(&self, py: Python<'py>, angles: Option<Vec<f64>>) -> PyResult<Bound<'py, PyDict>> {
        let angles = angles.unwrap_or_else(|| vec![0.0, 15.0, 30.0, 45.0, 60.0, 75.0]);
        let made;
        let table = match &self.source.content {
            Content::Samples(table) => table,
            Content::Evaluable(brdf) => {
                let thetas: Vec<f64> = angles.iter().map(|a| a.to_radians()).collect();
                let make = || evaluation_views::judging_table(brdf.as_ref(), &thetas);
                made = error::work(py, make)?;
                &made
            }
        };
        let all = || table.views.iter().flat_map(|view| view.samples.iter().map(move |s| (view.theta, s)));
        let dict = PyDict::new(py);
        dict.set_item("theta_o", PyArray1::from_iter(py, all().map(|s| s.0)))?;
        dict.set_item("wi", array_of(py, all().map(|s| s.1.direction))?)?;
        dict.set_item("f", array_of(py, all().map(|s| s.1.rgb))?)?;
        dict.set_item("weight", PyArray1::from_iter(py, all().map(|s| s.1.weight)))?;
        Ok(dict)
    }

    /// Findings about the samples before they are fitted, a sentence each, as of `srbf look`: conventions, turns of the sample,
    /// units, swapped pairs, the highlight, outliers by line. Sentences that begin with "check" name faults. Empty for a
    /// table with a value everywhere. `quick` leaves out units and outliers, which take seconds.
    #[pyo3(signature = (quick = false))]
    fn look(&self, py: Python<'_>, quick: bool) -> PyResult<Vec<String>> {
        let (Some(intake), Content::Samples(table)) = (&self.source.intake, &self.source.content) else {
            return Ok(Vec::new());
        };
        let complete = || srbf_fit::complete::complete(table);
        let completion = if quick { None } else { Some(error::work(py, complete)?) };
        let report = completion.as_ref().map(|completion| &completion.report);
        let look = error::work(py, || Ok(Look::new(intake, report)))?;
        let sentence = |finding: &Finding| {
            let mark = if finding.is_off { "check" } else { "note" };
            format!("{mark}: {}", finding.text)
        };
        Ok(std::iter::once(look.summary()).chain(look.findings.iter().map(sentence)).collect())
    }

    /// Writes it in another format, by the end of the name: MERL `.binary`, RGL `.bsdf`, `.csv` or `.astm`.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        error::work(py, || self.written(&path).and_then(|bytes| srbf_fit::write_atomically(&path, &bytes)))
    }
}

impl Table {
    fn written(&self, path: &Path) -> Result<Vec<u8>, srbf_fit::FitError> {
        use srbf_fit::export;
        let refuse = |text: &str| Err(srbf_fit::FitError::Table(text.to_owned()));
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match (&self.source.content, ending.as_str()) {
            (Content::Evaluable(brdf), "binary") => Ok(export::merl(brdf.as_ref())?.bytes),
            (Content::Evaluable(brdf), "bsdf") => {
                export::rgl(brdf.as_ref(), self.source.spectra().filter(|spectra| !spectra.is_grey))
            }
            (Content::Evaluable(brdf), "csv") => {
                Ok(export::csv(&export::sampled(brdf.as_ref())?, self.source.spectra()).into())
            }
            (Content::Evaluable(brdf), "astm") => Ok(export::astm(&export::sampled(brdf.as_ref())?).into()),
            (Content::Samples(table), "csv") => Ok(match self.source.own_spectra() {
                Some(own) => export::csv_of_spectra(own).into(),
                None => export::csv(table, self.source.spectra()).into(),
            }),
            (Content::Samples(table), "astm") => Ok(export::astm(table).into()),
            (Content::Samples(_), "binary" | "bsdf") => {
                refuse("scattered samples have no value in between; fit them, and save the material so")
            }
            _ => refuse("the name has to end in .binary, .bsdf, .csv or .astm"),
        }
    }
}
