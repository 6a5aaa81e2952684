//! `Blend`: several materials at one hit.

use crate::arrays::{Operand, Shape, Vectors, broadcast, broadcast_vectors, cast, room, spread, text};
use crate::error;
use crate::material::Material;
use crate::verbs::{self, Ask};
use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use srbf_core::{BlendPart, Error, MAX_BLEND, Request, Vec3};

/// Several materials at one hit: the value is the sum of theirs, each times its weight and its tint.
///
/// `weights` of shape (k,), or (..., k) for hits that each have their own; `tints` of shape (k, 3) or (..., k, 3), 1 by default; `coats` of
/// shape (k,), the refractive index of a clear coat above each part, 1 for none. Draws choose a part by weight times power, and the density is
/// that of such draws. Directions and values are those of a `Material`.
#[pyclass(frozen, module = "srbf_brdf")]
pub struct Blend {
    materials: Vec<Py<Material>>,
    /// A row a hit, or one for all.
    weights: Vec<f32>,
    tints: Vec<f32>,
    coats: Vec<f32>,
    /// The shape of hits that have weights or tints of their own; no axes if all hits have the same.
    hits: Vec<usize>,
}

/// The numbers of an array whose last axes are `last`, and the axes before.
fn rows(object: &Bound<'_, PyAny>, name: &str, last: &[usize]) -> PyResult<(Vec<f32>, Vec<usize>)> {
    let array = cast::<f32>(object, name)?;
    let Some(lead) = array.shape().strip_suffix(last) else {
        let last: String = last.iter().map(|size| format!(", {size}")).collect();
        let given = text(array.shape());
        return Err(PyValueError::new_err(format!("{name}: shape (...{last}) is expected, not {given}")));
    };
    let numbers = array.as_slice().map_err(|e| PyValueError::new_err(format!("{name}: {e}")))?;
    Ok((numbers.to_vec(), lead.to_vec()))
}

impl Blend {
    /// The parts of a row of weights.
    fn parts(&self, row: usize) -> impl Iterator<Item = BlendPart<'_>> {
        let k = self.materials.len();
        self.materials.iter().enumerate().map(move |(n, material)| {
            let part = k * row + n;
            let tint = Vec3::from_slice(&self.tints[3 * part..][..3]);
            BlendPart::new(&material.get().material, self.weights[part]).tinted(tint).coated(self.coats[n])
        })
    }

    /// The row of weights that each of the pairs has.
    fn rows(&self, shape: &Shape) -> Vec<usize> {
        let rows: Vec<usize> = (0..self.hits.iter().product()).collect();
        spread(&rows, &self.hits, &shape.lead)
    }
}

impl Ask for Blend {
    fn answer(&self, shape: &Shape, wo: [&[f32]; 3], request: Request<'_>) -> Result<(), Error> {
        if self.hits.is_empty() {
            let parts: Vec<BlendPart<'_>> = self.parts(0).collect();
            return srbf_core::Blend::new(&parts)?.ask(wo, request);
        }
        let parts: Vec<BlendPart<'_>> =
            self.rows(shape).into_iter().flat_map(|row| self.parts(row)).collect();
        let blends: Result<Vec<_>, Error> =
            parts.chunks(self.materials.len()).map(srbf_core::Blend::new).collect();
        srbf_core::Blend::ask_each(&blends?, wo, request)
    }

    fn hits(&self) -> Option<Operand<'_>> {
        Some(Operand { name: "weights and tints", lead: &self.hits, last: &[] })
    }
}

#[pymethods]
impl Blend {
    #[new]
    #[pyo3(signature = (materials, weights, tints = None, coats = None))]
    fn new(
        materials: Vec<Py<Material>>,
        weights: &Bound<'_, PyAny>,
        tints: Option<&Bound<'_, PyAny>>,
        coats: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let k = materials.len();
        if k == 0 || k > MAX_BLEND {
            return Err(error::value(Error::Parts));
        }
        let (weights, first) = rows(weights, "weights", &[k])?;
        let (tints, second) =
            tints.map_or_else(|| Ok((vec![1.0; 3 * k], Vec::new())), |t| rows(t, "tints", &[k, 3]))?;
        let (coats, third) =
            coats.map_or_else(|| Ok((vec![1.0; k], Vec::new())), |c| rows(c, "coats", &[k]))?;
        if !third.is_empty() {
            return Err(PyValueError::new_err(format!("coats: shape {} is expected", text(&[k]))));
        }
        let shape = broadcast(&[
            Operand { name: "weights", lead: &first, last: &[k] },
            Operand { name: "tints", lead: &second, last: &[k, 3] },
        ])?;
        let full = |lead: &[usize], last: &[usize]| [lead, last].concat();
        let weights = spread(&weights, &full(&first, &[k]), &full(&shape.lead, &[k]));
        let tints = spread(&tints, &full(&second, &[k, 3]), &full(&shape.lead, &[k, 3]));
        let made = Self { materials, weights, tints, coats, hits: shape.lead };
        for row in 0..shape.n {
            let parts: Vec<BlendPart<'_>> = made.parts(row).collect();
            srbf_core::Blend::new(&parts).map_err(error::value)?;
        }
        Ok(made)
    }

    fn __repr__(&self) -> String {
        format!("<srbf_brdf.Blend of {} materials>", self.materials.len())
    }

    /// `f cos` of pairs of directions, float32 of shape (..., 3), 1/sr.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        verbs::evaluate(py, self, wo, wi)
    }

    /// Density of `sample` at pairs of directions, float32 of shape (...), 1/sr.
    fn pdf<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        verbs::pdf(py, self, wo, wi)
    }

    /// What `evaluate` and `pdf` give, in one pass.
    fn evaluate_and_pdf<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        verbs::evaluate_and_pdf(py, self, wo, wi)
    }

    /// Draws incident directions by three uniform numbers each, `u` of shape (..., 3) in [0, 1): a `Sample`.
    fn sample<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        verbs::sample(py, self, wo, u)
    }

    /// What `sample` gives, and value and density towards other directions `wi`.
    fn sample_and_evaluate<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        verbs::sample_and_evaluate(py, self, wo, u, wi)
    }

    /// Reflected light towards `wo`, of light from everywhere, float32 of shape (..., 3); below a coat a bound from above.
    fn albedo<'py>(&self, py: Python<'py>, wo: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let mut wo = Vectors::directions(wo, "wo")?;
        let shape = broadcast_vectors(&mut [&mut wo], self.hits())?;
        let ([x, y, z], mut albedo) = (wo.slices(), room(shape.n));
        for (i, row) in self.rows(&shape).into_iter().enumerate() {
            let parts: Vec<BlendPart<'_>> = self.parts(row).collect();
            let blend = srbf_core::Blend::new(&parts).map_err(error::value)?;
            let found = blend.albedo(Vec3::new(x[i], y[i], z[i])).to_array();
            (0..3).for_each(|c| albedo[c][i] = found[c]);
        }
        shape.vectors(py, albedo)
    }

    /// How the value of `evaluate` changes with the weights and with the tints: two arrays, float32 of shape (..., k, 3).
    ///
    /// The value is linear in both. A channel of a tint changes that channel of the value alone.
    fn gradients<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (mut wo, mut wi) = (Vectors::directions(wo, "wo")?, Vectors::directions(wi, "wi")?);
        let shape = broadcast_vectors(&mut [&mut wo, &mut wi], self.hits())?;
        let k = self.materials.len();
        let mut of = [vec![0.0; 3 * k * shape.n], vec![0.0; 3 * k * shape.n]];
        let ([x, y, z], [a, b, c]) = (wo.slices(), wi.slices());
        for (i, row) in self.rows(&shape).into_iter().enumerate() {
            let (wo, wi) = (Vec3::new(x[i], y[i], z[i]), Vec3::new(a[i], b[i], c[i]));
            for (n, part) in self.parts(row).enumerate() {
                let (weight, tint) = (part.weight(), part.tint());
                // The part alone, of weight and tint 1, with its coat.
                let alone = [BlendPart::new(&self.materials[n].get().material, 1.0).coated(self.coats[n])];
                let value = srbf_core::Blend::new(&alone).map_err(error::value)?.evaluate(wo, wi);
                let at = 3 * (k * i + n);
                of[0][at..at + 3].copy_from_slice(&(value * tint).to_array());
                of[1][at..at + 3].copy_from_slice(&(value * weight).to_array());
            }
        }
        let [weights, tints] = of;
        Ok((shape.array(py, weights, &[k, 3])?, shape.array(py, tints, &[k, 3])?))
    }
}
