//! The verbs of a material and of a sheet on arrays.

use crate::arrays::{Operand, Shape, Vectors, broadcast_vectors, room, slices_mut};
use crate::error;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use srbf_core::{Draws, Error, Material, Request, Sheet, Towards};

/// Draws and evaluates for many hits.
pub trait Ask: Sync {
    /// See `srbf_core::Material::ask`, for pairs of a shape.
    fn answer(&self, shape: &Shape, wo: [&[f32]; 3], request: Request<'_>) -> Result<(), Error>;

    /// The hits that have something of their own, whose shape is broadcast with those of directions.
    fn hits(&self) -> Option<Operand<'_>> {
        None
    }
}

impl Ask for Material<Vec<u8>> {
    fn answer(&self, _: &Shape, wo: [&[f32]; 3], request: Request<'_>) -> Result<(), Error> {
        self.ask(wo, request)
    }
}

impl Ask for Sheet<Vec<u8>> {
    fn answer(&self, _: &Shape, wo: [&[f32]; 3], request: Request<'_>) -> Result<(), Error> {
        self.ask(wo, request)
    }
}

/// The samples of a call.
struct Drawn {
    direction: [Vec<f32>; 3],
    pdf: Vec<f32>,
    weight: [Vec<f32>; 3],
}

impl Drawn {
    fn new(n: usize) -> Self {
        Self { direction: room(n), pdf: vec![0.0; n], weight: room(n) }
    }

    fn draws<'a>(&'a mut self, u: [&'a [f32]; 3]) -> Draws<'a> {
        Draws {
            u,
            direction: slices_mut(&mut self.direction),
            pdf: Some(&mut self.pdf),
            weight: Some(slices_mut(&mut self.weight)),
        }
    }

    /// As a `srbf_brdf.Sample`.
    fn into_python<'py>(self, py: Python<'py>, shape: &Shape) -> PyResult<Bound<'py, PyAny>> {
        let arguments = (
            shape.vectors(py, self.direction)?,
            shape.numbers(py, self.pdf)?,
            shape.vectors(py, self.weight)?,
        );
        py.import("srbf_brdf.types")?.getattr("Sample")?.call1(arguments)
    }
}

/// Values and densities of pairs of directions, of which those are filled that are wanted.
fn towards<'py>(
    py: Python<'py>,
    of: &impl Ask,
    [wo, wi]: [&Bound<'py, PyAny>; 2],
    [value, pdf]: [bool; 2],
) -> PyResult<(Shape, [Vec<f32>; 3], Vec<f32>)> {
    let (mut wo, mut wi) = (Vectors::directions(wo, "wo")?, Vectors::directions(wi, "wi")?);
    let shape = broadcast_vectors(&mut [&mut wo, &mut wi], of.hits())?;
    let (mut values, mut densities) = (room(shape.n), vec![0.0; shape.n]);
    let towards = Towards {
        wi: wi.slices(),
        value: value.then(|| slices_mut(&mut values)),
        pdf: pdf.then_some(&mut densities[..]),
    };
    py.detach(|| of.answer(&shape, wo.slices(), towards.into())).map_err(error::value)?;
    Ok((shape, values, densities))
}

/// `f cos` of pairs of directions.
pub fn evaluate<'py>(
    py: Python<'py>,
    of: &impl Ask,
    wo: &Bound<'py, PyAny>,
    wi: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (shape, value, _) = towards(py, of, [wo, wi], [true, false])?;
    shape.vectors(py, value)
}

/// Density of pairs of directions.
pub fn pdf<'py>(
    py: Python<'py>,
    of: &impl Ask,
    wo: &Bound<'py, PyAny>,
    wi: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (shape, _, pdf) = towards(py, of, [wo, wi], [false, true])?;
    shape.numbers(py, pdf)
}

/// Both.
pub fn evaluate_and_pdf<'py>(
    py: Python<'py>,
    of: &impl Ask,
    wo: &Bound<'py, PyAny>,
    wi: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let (shape, value, pdf) = towards(py, of, [wo, wi], [true, true])?;
    Ok((shape.vectors(py, value)?, shape.numbers(py, pdf)?))
}

/// Incident directions by three uniform numbers each.
pub fn sample<'py>(
    py: Python<'py>,
    of: &impl Ask,
    wo: &Bound<'py, PyAny>,
    u: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (mut wo, mut u) = (Vectors::directions(wo, "wo")?, Vectors::uniform(u, "u")?);
    let shape = broadcast_vectors(&mut [&mut wo, &mut u], of.hits())?;
    let mut drawn = Drawn::new(shape.n);
    let draws = drawn.draws(u.slices());
    py.detach(|| of.answer(&shape, wo.slices(), draws.into())).map_err(error::value)?;
    drawn.into_python(py, &shape)
}

/// Both, towards other directions.
pub fn sample_and_evaluate<'py>(
    py: Python<'py>,
    of: &impl Ask,
    wo: &Bound<'py, PyAny>,
    u: &Bound<'py, PyAny>,
    wi: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyTuple>> {
    let (mut wo, mut u) = (Vectors::directions(wo, "wo")?, Vectors::uniform(u, "u")?);
    let mut wi = Vectors::directions(wi, "wi")?;
    let shape = broadcast_vectors(&mut [&mut wo, &mut u, &mut wi], of.hits())?;
    let (mut drawn, mut value, mut pdf) = (Drawn::new(shape.n), room(shape.n), vec![0.0; shape.n]);
    let towards = Towards { wi: wi.slices(), value: Some(slices_mut(&mut value)), pdf: Some(&mut pdf) };
    let request = Request { draw: Some(drawn.draws(u.slices())), evaluate: Some(towards) };
    py.detach(|| of.answer(&shape, wo.slices(), request)).map_err(error::value)?;
    let sample = drawn.into_python(py, &shape)?;
    PyTuple::new(py, [sample, shape.vectors(py, value)?, shape.numbers(py, pdf)?])
}
