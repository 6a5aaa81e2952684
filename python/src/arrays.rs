//! Between arrays of Python, a row a vector, and the structures of arrays that `srbf-core` takes.

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// How far the squared length of a direction may be from 1: what core takes for a unit vector.
const LENGTH: f32 = 1e-3;

/// n vectors, or one that stands for as many as the others have.
pub struct Vectors {
    columns: [Vec<f32>; 3],
    /// Whether a single vector was given, without a row of its own.
    pub is_single: bool,
}

fn fail<T>(text: String) -> PyResult<T> {
    Err(PyValueError::new_err(text))
}

/// Anything that numpy takes for an array, cast to a type.
pub fn cast<'py, T: numpy::Element>(
    object: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let numpy = object.py().import("numpy")?;
    let array = numpy.call_method1("ascontiguousarray", (object, T::get_dtype(object.py())));
    let shape = |error: PyErr| PyValueError::new_err(format!("{name}: {error}"));
    array.map_err(shape)?.extract::<PyReadonlyArrayDyn<'py, T>>()
}

/// The numbers of an array of shape (n, 3) or (3,), and whether it is the latter.
pub fn rows<'a, T: numpy::Element>(
    array: &'a PyReadonlyArrayDyn<'_, T>,
    object: &Bound<'_, PyAny>,
    name: &str,
) -> PyResult<(&'a [T], bool)> {
    // `ascontiguousarray` makes a row of a number; a vector stays one.
    let shape = array.shape();
    if !(shape.len() == 1 || shape.len() == 2) || shape.last() != Some(&3) {
        let given = object.getattr("shape").and_then(|s| s.str()).map(|s| s.to_string());
        return fail(format!(
            "{name}: shape (n, 3) or (3,) is expected, not {}",
            given.unwrap_or_else(|_| format!("{shape:?}"))
        ));
    }
    let numbers = array.as_slice().map_err(|e| PyValueError::new_err(format!("{name}: {e}")))?;
    Ok((numbers, shape.len() == 1))
}

impl Vectors {
    /// Vectors of shape (n, 3) or (3,).
    pub fn new(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Self> {
        let array = cast::<f32>(object, name)?;
        let (numbers, is_single) = rows(&array, object, name)?;
        let column = |c: usize| numbers.iter().skip(c).step_by(3).copied().collect();
        Ok(Self { columns: [column(0), column(1), column(2)], is_single })
    }

    /// Unit vectors.
    pub fn directions(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Self> {
        let vectors = Self::new(object, name)?;
        let [x, y, z] = &vectors.columns;
        for (i, ((x, y), z)) in x.iter().zip(y).zip(z).enumerate() {
            let squared = x * x + y * y + z * z;
            // NaN has no unit length either.
            if !(1.0 - LENGTH..=1.0 + LENGTH).contains(&squared) {
                return fail(format!("{name}[{i}]: ({x}, {y}, {z}) has length {}, not 1", squared.sqrt()));
            }
        }
        Ok(vectors)
    }

    /// Uniform numbers in [0, 1).
    pub fn uniform(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Self> {
        let mut vectors = Self::new(object, name)?;
        for column in &mut vectors.columns {
            for (i, u) in column.iter_mut().enumerate() {
                if !(0.0..=1.0).contains(u) {
                    return fail(format!("{name}[{i}]: {u} is not in [0, 1)"));
                }
                // A float64 next to 1 is 1 as a float32.
                *u = u.min(1.0 - f32::EPSILON / 2.0);
            }
        }
        Ok(vectors)
    }

    fn len(&self) -> usize {
        self.columns[0].len()
    }

    pub fn slices(&self) -> [&[f32]; 3] {
        self.columns.each_ref().map(|c| &c[..])
    }
}

/// What several vectors make together.
#[derive(Clone, Copy)]
pub struct Shape {
    /// How many there are of each.
    pub n: usize,
    /// Whether each was one vector: the result is one too.
    pub is_single: bool,
}

/// Repeats single vectors until all have as many.
pub fn broadcast<const N: usize>(all: [&mut Vectors; N], names: &str) -> PyResult<Shape> {
    let is_single = all.iter().all(|v| v.is_single);
    let n = all.iter().find(|v| !v.is_single).map_or(1, |v| v.len());
    for vectors in all {
        if vectors.is_single {
            vectors.columns.iter_mut().for_each(|c| *c = vec![c[0]; n]);
        } else if vectors.len() != n {
            return fail(format!("{names}: {n} and {} rows; as many are expected", vectors.len()));
        }
    }
    Ok(Shape { n, is_single })
}

/// Room for n vectors.
pub fn room(n: usize) -> [Vec<f32>; 3] {
    [(); 3].map(|()| vec![0.0; n])
}

pub fn slices_mut(columns: &mut [Vec<f32>; 3]) -> [&mut [f32]; 3] {
    columns.each_mut().map(|c| &mut c[..])
}

impl Shape {
    /// An array of shape (n, 3), or (3,), of columns.
    pub fn vectors<'py>(self, py: Python<'py>, columns: [Vec<f32>; 3]) -> PyResult<Bound<'py, PyAny>> {
        let [x, y, z] = columns;
        let flat: Vec<f32> = x.iter().zip(&y).zip(&z).flat_map(|((x, y), z)| [*x, *y, *z]).collect();
        let array = PyArray1::from_vec(py, flat);
        if self.is_single { Ok(array.into_any()) } else { Ok(array.reshape([self.n, 3])?.into_any()) }
    }

    /// An array of shape (n,), or a number.
    pub fn numbers<'py>(self, py: Python<'py>, numbers: Vec<f32>) -> PyResult<Bound<'py, PyAny>> {
        let array = PyArray1::from_vec(py, numbers).into_any();
        if self.is_single { array.get_item(0) } else { Ok(array) }
    }
}

/// An array of shape (n, 3) of rows.
pub fn table<'py>(py: Python<'py>, rows: impl Iterator<Item = [f64; 3]>) -> PyResult<Bound<'py, PyAny>> {
    let flat: Vec<f64> = rows.flatten().collect();
    let n = flat.len() / 3;
    Ok(PyArray1::from_vec(py, flat).reshape([n, 3])?.into_any())
}
