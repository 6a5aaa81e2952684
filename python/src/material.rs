//! `Material`: the result of a fit, for renderers.

use crate::arrays::{Vectors, broadcast_vectors, cast, room};
use crate::error;
use crate::source::AsBrdf;
use crate::table::{Reduced, Table};
use crate::verbs;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use srbf_core::{MAX_LOBES, Mixture, printable};
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::report::{Input, Report, ViewReport};
use srbf_fit::judge::verdict::Verdict;
use srbf_fit::read::{Content, Spectra};
use srbf_fit::table::evaluation_views;
use std::path::{Path, PathBuf};

/// Most bytes of a file that is read as a material.
const MAX_FILE: u64 = 1 << 26;

/// The thing that the bytes of a file make.
pub fn loaded<T>(path: &Path, make: impl Fn(Vec<u8>) -> Result<T, srbf_core::FormatError>) -> PyResult<T> {
    let bytes = srbf_fit::read_at_most(path, MAX_FILE).map_err(|e| error::io(path, &e))?;
    let fault = |e| PyValueError::new_err(format!("{}: {e}", printable(&path.to_string_lossy())));
    make(bytes).map_err(fault)
}

/// A report that is JSON, or an empty one.
pub fn report_of<'py>(py: Python<'py>, json: Option<&String>) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (json.map_or("{}", String::as_str),))
}

/// A BRDF as lobes: a few kilobytes that are evaluated, integrated and sampled.
///
/// Directions are unit vectors in the shading frame, +z the normal, float32 of shape (..., 3); float64 is cast.
/// `wo` points towards the viewer, `wi` towards the light. Values are `f cos`, the BRDF times the cosine of `wi`, in
/// linear sRGB, 1/sr; channels of colours outside the gamut are negative.
#[pyclass(frozen, module = "srbf_brdf")]
pub struct Material {
    pub material: srbf_core::Material<Vec<u8>>,
    /// What its fit says; of a material that was just fitted.
    fitted: Option<Fitted>,
}

/// The report of a fit, as JSON, and in words.
type Fitted = (String, Vec<String>);

impl Material {
    pub fn new(bytes: Vec<u8>) -> Result<Self, srbf_core::FormatError> {
        Ok(Self { material: srbf_core::Material::from_bytes(bytes)?, fitted: None })
    }

    /// With what its fit says.
    pub fn fitted(self, json: String, words: Vec<String>) -> Self {
        Self { fitted: Some((json, words)), ..self }
    }
}

#[pymethods]
impl Material {
    /// Reads a `.srbf` file.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        loaded(&path, Self::new)
    }

    /// Takes the bytes of a `.srbf` file.
    #[staticmethod]
    fn from_bytes(bytes: Vec<u8>) -> PyResult<Self> {
        Self::new(bytes).map_err(error::value)
    }

    /// The bytes of its `.srbf` file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, self.material.bytes())
    }

    /// Writes a `.srbf` file: under a temporary name first, so that it is never there half.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        srbf_fit::write_atomically(&path, self.material.bytes()).map_err(error::fit)
    }

    /// With what its fit says, which no file holds: how it is unpickled.
    #[staticmethod]
    fn _restored(bytes: Vec<u8>, fitted: Option<Fitted>) -> PyResult<Self> {
        Ok(Self { fitted, ..Self::from_bytes(bytes)? })
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Reduced<'py, (Bound<'py, PyBytes>, Option<Fitted>)>> {
        Ok((py.get_type::<Self>().getattr("_restored")?, (self.to_bytes(py), self.fitted.clone())))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().material.bytes() == self.material.bytes())
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        self.material.bytes().hash(&mut hasher);
        hasher.finish()
    }

    fn __repr__(&self) -> String {
        let kind = if self.material.is_isotropic() { "isotropic" } else { "anisotropic" };
        let factors = match self.material.factor_nodes() {
            Some([half, difference, 1]) => format!(", {half} x {difference} factors"),
            Some([half, difference, azimuth]) => {
                let signed = if self.material.has_signed_factors() { " signed" } else { "" };
                format!(", {half} x {difference} x {azimuth}{signed} factors")
            }
            None => String::new(),
        };
        let map = self.material.spectral_map().and_then(|map| Spectra::of_map(map, None).ok());
        let spectrum = map.map_or_else(String::new, |map| format!(", {}", map.text()));
        format!(
            "<srbf_brdf.Material: {kind}, {} lobes, {} views{factors}{spectrum}, {} bytes>",
            self.material.lobe_count(),
            self.material.view_count(),
            self.material.bytes().len()
        )
    }

    /// Number of lobes of a mixture.
    #[getter]
    fn lobe_count(&self) -> usize {
        self.material.lobe_count()
    }

    /// Number of views: outgoing directions at which a mixture is stored.
    #[getter]
    fn view_count(&self) -> usize {
        self.material.view_count()
    }

    /// Whether turning both directions round the normal changes nothing.
    #[getter]
    fn is_isotropic(&self) -> bool {
        self.material.is_isotropic()
    }

    /// Whether factors are others where the two directions change places.
    #[getter]
    fn has_signed_factors(&self) -> bool {
        self.material.has_signed_factors()
    }

    /// Where it comes from, as its maker wrote it.
    #[getter]
    fn provenance(&self) -> &str {
        self.material.provenance()
    }

    /// What its fit says of itself, as a dict; empty for a material that was read.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        report_of(py, self.fitted.as_ref().map(|(json, _)| json))
    }

    /// How good its fit is, a sentence each, with what to try; empty for a material that was read.
    #[getter]
    fn verdict(&self) -> Vec<String> {
        self.fitted.as_ref().map_or_else(Vec::new, |(_, words)| words.clone())
    }

    /// Whether it has a map from its colours to spectra, as fits of measured wavelengths have.
    #[getter]
    fn has_spectrum(&self) -> bool {
        self.material.has_spectrum()
    }

    /// The wavelengths of that map, nm, float32 of shape (n,); empty without one.
    #[getter]
    fn wavelengths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        let map = self.material.spectral_map();
        let nm = map.iter().flat_map(|map| (0..map.len()).filter_map(|n| map.wavelength(n)));
        PyArray1::from_iter(py, nm)
    }

    /// What takes its colours to values at wavelengths in nm: a `Primaries`.
    fn primaries<'py>(
        &self,
        py: Python<'py>,
        wavelengths: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let wavelengths = cast::<f32>(wavelengths, "wavelengths")?;
        let nm = wavelengths.as_slice().map_err(error::value)?;
        let columns = nm.iter().flat_map(|nm| *self.material.primaries(&[*nm]).columns());
        let columns = PyArray1::from_iter(py, columns.flatten()).reshape([nm.len(), 3])?;
        py.import("srbf_brdf.types")?.getattr("Primaries")?.call1((columns,))
    }

    /// `f cos` of pairs of directions, float32 of shape (..., 3), 1/sr.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        verbs::evaluate(py, &self.material, wo, wi)
    }

    /// Density of `sample` at pairs of directions, float32 of shape (...), 1/sr.
    fn pdf<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        verbs::pdf(py, &self.material, wo, wi)
    }

    /// What `evaluate` and `pdf` give, in one pass.
    fn evaluate_and_pdf<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        verbs::evaluate_and_pdf(py, &self.material, wo, wi)
    }

    /// Draws incident directions by three uniform numbers each, `u` of shape (..., 3) in [0, 1).
    ///
    /// Returns a `Sample`: `direction` (..., 3), `pdf` (...) in 1/sr, `weight` (..., 3), which is `f cos / pdf`. Where nothing
    /// is reflected the direction is the normal and the rest 0.
    fn sample<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        verbs::sample(py, &self.material, wo, u)
    }

    /// What `sample` gives, and value and density towards other directions `wi`, as light sampling needs them.
    fn sample_and_evaluate<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        verbs::sample_and_evaluate(py, &self.material, wo, u, wi)
    }

    /// Directional albedo, the integral of `f cos` over the hemisphere, float32 of shape (..., 3).
    fn albedo<'py>(&self, py: Python<'py>, wo: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let mut wo = Vectors::directions(wo, "wo")?;
        let shape = broadcast_vectors(&mut [&mut wo], None)?;
        let [x, y, z] = wo.slices();
        let mut albedo = room(shape.n);
        py.detach(|| {
            let mut mixture = Mixture::<MAX_LOBES>::empty();
            for i in 0..shape.n {
                self.material.prepare([x[i], y[i], z[i]], &mut mixture)?;
                let found = mixture.albedo().to_array();
                (0..3).for_each(|c| albedo[c][i] = found[c]);
            }
            Ok::<(), srbf_core::Error>(())
        })
        .map_err(error::value)?;
        shape.vectors(py, albedo)
    }

    /// Compares it with a table: a `Comparison` that prints as the verdict.
    ///
    /// `angles`: outgoing directions in degrees from the normal, by default 0, 5, 30, 60 and 75, where the table has a value everywhere. Of samples, the
    /// views of the table are taken.
    #[pyo3(signature = (table, angles = None))]
    fn compare<'py>(
        &self,
        py: Python<'py>,
        table: &Bound<'py, PyAny>,
        angles: Option<Vec<f64>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let angles = angles.unwrap_or_else(|| vec![0.0, 5.0, 30.0, 60.0, 75.0]);
        let table = Table::of(table)?;
        let table = table.get();
        if !self.material.is_isotropic() {
            return Err(PyValueError::new_err("anisotropic; only isotropic materials are compared so"));
        }
        let judge = || {
            let made;
            let views = match &table.source.content {
                Content::Samples(table) => &table.views,
                Content::Evaluable(brdf) => {
                    let thetas: Vec<f64> = angles.iter().map(|a| a.to_radians()).collect();
                    made = evaluation_views::judging_table(brdf.as_ref(), &thetas)?;
                    &made.views
                }
            };
            let views =
                views.iter().map(|v| ViewReport::judge(&self.material, v)).collect::<Result<_, _>>()?;
            let report = Report { held_out: views, ..Report::default() };
            let words = Verdict::of_material(&report, &reciprocity(&self.material)?).lines();
            let input = Input { name: table.source.name.clone(), sha256: table.source.sha256.clone() };
            Ok((report.to_json_of(&self.material, "srbf", &input)?.to_string(), words))
        };
        let (json, words) = error::work(py, judge)?;
        let json = py.import("json")?.call_method1("loads", (json,))?;
        py.import("srbf_brdf.types")?.getattr("Comparison")?.call1((json, words))
    }

    /// Writes it as a MERL `.binary` file: 90 x 90 x 180 cells, as other renderers read them.
    fn to_merl(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.export(py, &path, |brdf| Ok(srbf_fit::export::merl(brdf)?.bytes))
    }

    /// Writes it as an RGL `.bsdf` file, as Mitsuba's `measured` reads them.
    fn to_rgl(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.export(py, &path, |brdf| srbf_fit::export::rgl(brdf, None))
    }

    /// The numbers of all views, as float32 arrays by name: what an evaluator of one's own needs.
    ///
    /// `theta` and `azimuth` (V,) in radians; `log2_squeeze` (V,), or (V, 3) of an anisotropic material; `diffuse` (V, 3) and,
    /// of every lobe, `color` (V, K, 3): log2 of the luminance, `(R - Y) / Y`, `(B - Y) / Y`; `tilt` (V, K, 2): angles of the axis
    /// in the plane of incidence and out of it; `log2_sharpness` (V, K); `factors` of shape (azimuth, half, difference, 3) and
    /// `albedo_difference` (V, 3), empty without factors. Of an anisotropic material `turns` says how often a ring is repeated over the full turn,
    /// 4 being mirror images, and `axis` where its azimuths begin, radians. The first `squeezed` lobes are squeezed, the last `mirrored` stand for two.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let m = &self.material;
        let (views, lobes) = (m.view_count(), m.view_lobe_count());
        let dict = PyDict::new(py);
        let put = |name: &str, numbers: Vec<f32>, shape: &[usize]| {
            dict.set_item(name, PyArray1::from_vec(py, numbers).reshape(shape)?)
        };
        let all = |number: &dyn Fn(usize) -> Option<f32>| (0..views).filter_map(number).collect::<Vec<_>>();
        put("theta", all(&|v| m.view_theta(v)), &[views])?;
        put("azimuth", all(&|v| m.view_azimuth(v)), &[views])?;
        if m.is_isotropic() {
            put("log2_squeeze", all(&|v| m.view_log2_squeeze(v)), &[views])?;
        } else {
            let squeeze = (0..views).filter_map(|v| m.view_log2_squeeze_matrix(v)).flatten().collect();
            put("log2_squeeze", squeeze, &[views, 3])?;
        }
        let mut diffuse = Vec::new();
        let (mut color, mut tilt, mut sharpness) = (Vec::new(), Vec::new(), Vec::new());
        for v in 0..views {
            diffuse.extend(m.view_log2_diffuse(v));
            diffuse.extend(m.view_diffuse_color_differences(v).into_iter().flatten());
            for k in 0..lobes {
                if let Some(lobe) = m.view_lobe(v, k) {
                    tilt.extend([lobe.angle, lobe.off_plane]);
                    sharpness.push(lobe.log2_sharpness);
                    color.push(lobe.log2_luminance);
                    color.extend(lobe.color_differences);
                } else if let Some(lobe) = m.view_tilted_lobe(v, k) {
                    tilt.extend(lobe.tilt);
                    sharpness.push(lobe.log2_sharpness);
                    color.push(lobe.log2_luminance);
                    color.extend(lobe.color_differences);
                }
            }
        }
        put("diffuse", diffuse, &[views, 3])?;
        put("tilt", tilt, &[views, lobes, 2])?;
        put("log2_sharpness", sharpness, &[views, lobes])?;
        put("color", color, &[views, lobes, 3])?;
        let [half, difference, azimuth] = m.factor_nodes().unwrap_or_default();
        let node = |i: usize| m.factor_node(i / difference % half, i % difference, i / difference / half);
        put(
            "factors",
            (0..azimuth * half * difference).filter_map(node).flatten().collect(),
            &[azimuth, half, difference, 3],
        )?;
        let differences: Vec<f32> =
            (0..views).filter_map(|v| m.view_albedo_difference(v)).flatten().collect();
        let rows = differences.len() / 3;
        put("albedo_difference", differences, &[rows, 3])?;
        if let Some((turns, axis)) = m.grid_turns() {
            dict.set_item("turns", turns)?;
            dict.set_item("axis", axis)?;
        }
        dict.set_item("squeezed", m.squeezed_count())?;
        dict.set_item("mirrored", m.mirrored_count())?;
        Ok(dict)
    }

    /// A picture of a lit ball of it, as an array of uint8 of shape (size, size, 3); needs numpy alone.
    #[pyo3(signature = (size = 256))]
    fn ball<'py>(slf: &Bound<'py, Self>, size: usize) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("srbf_brdf.picture")?.call_method1("ball", (slf, size))
    }

    fn _repr_png_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("srbf_brdf.picture")?.call_method1("png_of_ball", (slf,))
    }

    /// Draws a sheet by matplotlib: curves over the plane of incidence, albedo, and a ball. A `table` is drawn beside it: dotted, or its
    /// samples near that plane as points.
    ///
    /// `angles`: outgoing directions in degrees from the normal, by default 5, 30, 60 and 75, or four of those of the samples. Returns the
    /// `matplotlib.figure.Figure`.
    #[pyo3(signature = (table = None, angles = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        table: Option<&Bound<'py, PyAny>>,
        angles: Option<Vec<f64>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let table = table.map(Table::of).transpose()?;
        slf.py().import("srbf_brdf.plot")?.call_method1("plot", (slf, table, angles))
    }
}

impl Material {
    fn export(
        &self,
        py: Python<'_>,
        path: &Path,
        write: impl Fn(&dyn srbf_fit::table::Brdf) -> Result<Vec<u8>, srbf_fit::FitError> + Sync,
    ) -> PyResult<()> {
        error::work(py, || srbf_fit::write_atomically(path, &write(&AsBrdf(&self.material))?))
    }
}
