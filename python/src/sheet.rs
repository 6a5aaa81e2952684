//! `Sheet`: reflection and transmission of a thin surface.

use crate::arrays::{Vectors, broadcast_vectors, room};
use crate::error;
use crate::material::{Material, loaded, report_of};
use crate::table::Reduced;
use crate::verbs;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use srbf_core::{MAX_LOBES, Quarter, SheetMixture, Vec3, printable};
use std::path::PathBuf;

/// Names of the quarters, in the order of their bytes.
const NAMES: [&str; 4] = ["front_reflection", "front_transmission", "back_reflection", "back_transmission"];

/// A thin surface that reflects light and lets some through: up to four materials.
///
/// Directions are unit vectors in the frame of the sheet, whose front is +z, float32 of shape (..., 3). `wo` points
/// towards the viewer, `wi` towards the light, and both lie in front or behind. Values are `f |cos|`, in linear sRGB, 1/sr.
#[pyclass(frozen, module = "srbf_brdf")]
pub struct Sheet {
    sheet: srbf_core::Sheet<Vec<u8>>,
    /// The report of its fit, JSON; of a sheet that was just fitted.
    report: Option<String>,
}

impl Sheet {
    /// The sheet of a fit.
    pub fn fitted(bytes: Vec<u8>, report: String) -> PyResult<Self> {
        Ok(Self { report: Some(report), ..Self::from_bytes(bytes)? })
    }
}

#[pymethods]
impl Sheet {
    /// Reads a `.srbf` file.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        Ok(Self { sheet: loaded(&path, srbf_core::Sheet::from_bytes)?, report: None })
    }

    /// Takes the bytes of a `.srbf` file.
    #[staticmethod]
    fn from_bytes(bytes: Vec<u8>) -> PyResult<Self> {
        Ok(Self { sheet: srbf_core::Sheet::from_bytes(bytes).map_err(error::value)?, report: None })
    }

    /// Puts materials together; `symmetric`: the back is like the front.
    #[staticmethod]
    #[pyo3(signature = (*, front_reflection = None, front_transmission = None, back_reflection = None, back_transmission = None, symmetric = false))]
    fn join(
        front_reflection: Option<Bound<'_, Material>>,
        front_transmission: Option<Bound<'_, Material>>,
        back_reflection: Option<Bound<'_, Material>>,
        back_transmission: Option<Bound<'_, Material>>,
        symmetric: bool,
    ) -> PyResult<Self> {
        let all = [&front_reflection, &front_transmission, &back_reflection, &back_transmission];
        let quarters = all.map(|own| own.as_ref().map(|own| &own.get().material));
        Self::from_bytes(srbf_fit::joined(quarters, symmetric).map_err(error::value)?)
    }

    /// The bytes of its `.srbf` file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, self.sheet.bytes())
    }

    /// Writes a `.srbf` file: under a temporary name first, so that it is never there half.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        srbf_fit::write_atomically(&path, self.sheet.bytes()).map_err(error::fit)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py, (Bound<'py, PyBytes>,)>> {
        Ok((py.get_type::<Self>().getattr("from_bytes")?, (self.to_bytes(py),)))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().sheet.bytes() == self.sheet.bytes())
    }

    fn __repr__(&self) -> String {
        let there =
            Quarter::ALL.into_iter().zip(NAMES).filter(|(quarter, _)| self.sheet.quarter(*quarter).is_some());
        let names: Vec<&str> = there.map(|(_, name)| name).collect();
        format!("<srbf_brdf.Sheet: {}, {} bytes>", names.join(", "), self.sheet.bytes().len())
    }

    /// Whether the back is like the front.
    #[getter]
    fn is_symmetric(&self) -> bool {
        self.sheet.is_symmetric()
    }

    /// What its fit says of itself, as a dict: where light goes by angle, and how far patches are apart; empty for a sheet that was read.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        report_of(py, self.report.as_ref())
    }

    /// Where it comes from, as its maker wrote it.
    #[getter]
    fn provenance(&self) -> &str {
        self.sheet.provenance()
    }

    /// A `Material`: `front_reflection`, `front_transmission`, `back_reflection` or `back_transmission`; None for black.
    fn quarter(&self, name: &str) -> PyResult<Option<Material>> {
        let place = NAMES.iter().position(|own| *own == name);
        let place = place.ok_or_else(|| {
            PyValueError::new_err(format!("{}: one of {} is expected", printable(name), NAMES.join(", ")))
        })?;
        let found = self.sheet.quarter(Quarter::ALL[place]).map(|material| material.bytes().to_vec());
        found.map(Material::new).transpose().map_err(error::value)
    }

    /// `f |cos|` of pairs of directions, float32 of shape (..., 3), 1/sr.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        verbs::evaluate(py, &self.sheet, wo, wi)
    }

    /// Density of `sample` at pairs of directions, float32 of shape (...), 1/sr.
    fn pdf<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        verbs::pdf(py, &self.sheet, wo, wi)
    }

    /// What `evaluate` and `pdf` give, in one pass.
    fn evaluate_and_pdf<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        verbs::evaluate_and_pdf(py, &self.sheet, wo, wi)
    }

    /// Draws incident directions on both sides by three uniform numbers each, `u` of shape (..., 3) in [0, 1): a `Sample`.
    fn sample<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        verbs::sample(py, &self.sheet, wo, u)
    }

    /// What `sample` gives, and value and density towards other directions `wi`.
    fn sample_and_evaluate<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        verbs::sample_and_evaluate(py, &self.sheet, wo, u, wi)
    }

    /// Share of draws that are reflected, float32 of shape (...).
    fn reflected_share<'py>(&self, py: Python<'py>, wo: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let mut wo = Vectors::directions(wo, "wo")?;
        let shape = broadcast_vectors(&mut [&mut wo], None)?;
        let [x, y, z] = wo.slices();
        let share = |i: usize| self.sheet.reflected_share(Vec3::new(x[i], y[i], z[i]));
        shape.numbers(py, (0..shape.n).map(share).collect())
    }

    /// Reflected and transmitted light towards `wo`, of light from everywhere: two arrays, float32 of shape (..., 3).
    fn albedos<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let mut wo = Vectors::directions(wo, "wo")?;
        let shape = broadcast_vectors(&mut [&mut wo], None)?;
        let [x, y, z] = wo.slices();
        let (mut reflected, mut transmitted) = (room(shape.n), room(shape.n));
        py.detach(|| {
            let mut pair = SheetMixture::<MAX_LOBES>::empty();
            for i in 0..shape.n {
                self.sheet.prepare(Vec3::new(x[i], y[i], z[i]), &mut pair)?;
                let found = pair.albedos().map(|rgb| rgb.to_array());
                for c in 0..3 {
                    (reflected[c][i], transmitted[c][i]) = (found[0][c], found[1][c]);
                }
            }
            Ok::<(), srbf_core::Error>(())
        })
        .map_err(error::value)?;
        Ok((shape.vectors(py, reflected)?, shape.vectors(py, transmitted)?))
    }
}
