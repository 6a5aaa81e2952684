//! Between arrays of Python, whose last axis is a vector, and the structures of arrays that `srbf-core` takes.
//!
//! The axes before the last one are a leading shape. Leading shapes are broadcast as NumPy broadcasts shapes.

use numpy::{Element, PyArray1, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;

/// How far the squared length of a direction may be from 1: what core takes for a unit vector.
const LENGTH: f32 = 1e-3;

/// Bytes that a call takes for each pair of directions, at most.
const PAIR: usize = 128;

/// Vectors by their coordinates, in the order of NumPy.
pub struct Vectors<'n, T = f32> {
    columns: [Vec<T>; 3],
    shape: Vec<usize>,
    name: &'n str,
}

fn fail<T>(text: String) -> PyResult<T> {
    Err(PyValueError::new_err(text))
}

/// A shape as Python writes it.
pub fn text(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        all => format!("({})", all.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// Anything that numpy takes for an array, cast to a type.
pub fn cast<'py, T: Element>(object: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let numpy = object.py().import("numpy")?;
    let array = numpy.call_method1("ascontiguousarray", (object, T::get_dtype(object.py())));
    let shape = |error: PyErr| PyValueError::new_err(format!("{name}: {error}"));
    array.map_err(shape)?.extract::<PyReadonlyArrayDyn<'py, T>>()
}

/// Numbers of a shape, repeated until they have another one that it broadcasts to.
pub fn spread<T: Copy>(numbers: &[T], from: &[usize], to: &[usize]) -> Vec<T> {
    let mut spread = numbers.to_vec();
    let mut block = 1;
    // From the last axis on, so that a step of an axis holds all its numbers.
    for (back, &size) in to.iter().rev().enumerate() {
        let own = from.len().checked_sub(back + 1).map_or(1, |axis| from[axis]);
        if own != size {
            let repeated = spread.chunks(block).flat_map(|chunk| std::iter::repeat_n(chunk, size));
            spread = repeated.flatten().copied().collect();
        }
        // An axis of no steps leaves nothing to repeat.
        block = (block * size).max(1);
    }
    spread
}

impl<'n, T: Element + Copy> Vectors<'n, T> {
    /// Vectors of shape (..., 3).
    pub fn new(object: &Bound<'_, PyAny>, name: &'n str) -> PyResult<Self> {
        let array = cast::<T>(object, name)?;
        // `ascontiguousarray` makes a row of a number; a vector stays one.
        let Some((3, lead)) = array.shape().split_last().map(|(last, lead)| (*last, lead)) else {
            let given = object.getattr("shape").and_then(|s| s.str()).map(|s| s.to_string());
            let given = given.unwrap_or_else(|_| text(array.shape()));
            return fail(format!("{name}: shape (..., 3) is expected, not {given}"));
        };
        let numbers = array.as_slice().map_err(|e| PyValueError::new_err(format!("{name}: {e}")))?;
        let column = |c: usize| numbers.iter().skip(c).step_by(3).copied().collect();
        Ok(Self { columns: [column(0), column(1), column(2)], shape: lead.to_vec(), name })
    }

    /// The leading shape with its name, for `broadcast`.
    pub fn operand(&self) -> Operand<'_> {
        Operand { name: self.name, lead: &self.shape, last: &[3] }
    }

    /// Repeats them until they have that shape.
    pub fn spread(&mut self, shape: &Shape) {
        if self.shape != shape.lead {
            self.columns = self.columns.each_ref().map(|c| spread(c, &self.shape, &shape.lead));
            self.shape.clone_from(&shape.lead);
        }
    }

    pub fn slices(&self) -> [&[T]; 3] {
        self.columns.each_ref().map(|c| &c[..])
    }
}

impl<'n> Vectors<'n> {
    /// Unit vectors.
    pub fn directions(object: &Bound<'_, PyAny>, name: &'n str) -> PyResult<Self> {
        let vectors = Self::new(object, name)?;
        let [x, y, z] = &vectors.columns;
        for (i, ((x, y), z)) in x.iter().zip(y).zip(z).enumerate() {
            let squared = x * x + y * y + z * z;
            // NaN has no unit length either.
            if !(1.0 - LENGTH..=1.0 + LENGTH).contains(&squared) {
                let (place, length) = (vectors.place(i), squared.sqrt());
                return fail(format!("{place}: ({x}, {y}, {z}) has length {length}, not 1"));
            }
        }
        Ok(vectors)
    }

    /// Uniform numbers in [0, 1).
    pub fn uniform(object: &Bound<'_, PyAny>, name: &'n str) -> PyResult<Self> {
        let mut vectors = Self::new(object, name)?;
        let is_out = |u: &f32| !(0.0..=1.0).contains(u);
        for column in &vectors.columns {
            if let Some(i) = column.iter().position(is_out) {
                return fail(format!("{}: {} is not in [0, 1)", vectors.place(i), column[i]));
            }
        }
        // A float64 next to 1 is 1 as a float32.
        vectors.columns.iter_mut().flatten().for_each(|u| *u = u.min(1.0 - f32::EPSILON / 2.0));
        Ok(vectors)
    }

    /// A vector as Python names it: `wo[3, 1]`.
    fn place(&self, mut i: usize) -> String {
        let mut at: Vec<String> = Vec::new();
        for &size in self.shape.iter().rev() {
            at.insert(0, (i % size).to_string());
            i /= size;
        }
        if at.is_empty() { self.name.to_owned() } else { format!("{}[{}]", self.name, at.join(", ")) }
    }
}

/// The shape of an argument.
#[derive(Clone, Copy)]
pub struct Operand<'a> {
    pub name: &'a str,
    /// The axes that broadcast.
    pub lead: &'a [usize],
    /// The axes after it.
    pub last: &'a [usize],
}

impl Operand<'_> {
    /// The whole shape.
    pub fn text(&self) -> String {
        text(&[self.lead, self.last].concat())
    }
}

/// What several arguments make together.
#[derive(Clone)]
pub struct Shape {
    pub lead: Vec<usize>,
    /// How many pairs there are.
    pub n: usize,
}

/// The leading shape of all, as NumPy broadcasts them.
pub fn broadcast(all: &[Operand<'_>]) -> PyResult<Shape> {
    let shapes = || {
        let one = |o: &Operand<'_>| format!("{} of shape {}", o.name, o.text());
        all.iter().map(one).collect::<Vec<_>>().join(" and ")
    };
    let axes = all.iter().map(|o| o.lead.len()).max().unwrap_or(0);
    let mut lead = vec![1; axes];
    for operand in all {
        for (own, size) in lead.iter_mut().rev().zip(operand.lead.iter().rev()) {
            if *own != 1 && *size != 1 && own != size {
                return fail(format!("{}: the axes before the last do not broadcast", shapes()));
            }
            if *size != 1 {
                *own = *size;
            }
        }
    }
    let n = lead.iter().try_fold(1usize, |n, size| n.checked_mul(*size));
    // Asked for in vain here, and not where a refusal would end the process.
    let bytes =
        n.and_then(|n| n.checked_mul(PAIR)).filter(|b| Vec::<u8>::new().try_reserve_exact(*b).is_ok());
    match (n, bytes) {
        (Some(n), Some(_)) => Ok(Shape { lead, n }),
        _ => Err(PyMemoryError::new_err(format!("{}: too many pairs for the memory", shapes()))),
    }
}

/// Broadcasts vectors to one shape, with `extra` that has no vectors.
pub fn broadcast_vectors<T: Element + Copy>(
    all: &mut [&mut Vectors<'_, T>],
    extra: Option<Operand<'_>>,
) -> PyResult<Shape> {
    let operands: Vec<Operand<'_>> = all.iter().map(|v| v.operand()).chain(extra).collect();
    let shape = broadcast(&operands)?;
    all.iter_mut().for_each(|vectors| vectors.spread(&shape));
    Ok(shape)
}

/// Room for n vectors.
pub fn room(n: usize) -> [Vec<f32>; 3] {
    [(); 3].map(|()| vec![0.0; n])
}

pub fn slices_mut(columns: &mut [Vec<f32>; 3]) -> [&mut [f32]; 3] {
    columns.each_mut().map(|c| &mut c[..])
}

impl Shape {
    /// An array of shape (..., 3) of columns.
    pub fn vectors<'py>(&self, py: Python<'py>, columns: [Vec<f32>; 3]) -> PyResult<Bound<'py, PyAny>> {
        let [x, y, z] = columns;
        let flat: Vec<f32> = x.iter().zip(&y).zip(&z).flat_map(|((x, y), z)| [*x, *y, *z]).collect();
        self.array(py, flat, &[3])
    }

    /// An array of shape (...), or a number.
    pub fn numbers<'py>(&self, py: Python<'py>, numbers: Vec<f32>) -> PyResult<Bound<'py, PyAny>> {
        if self.lead.is_empty() {
            return PyArray1::from_vec(py, numbers).into_any().get_item(0);
        }
        self.array(py, numbers, &[])
    }

    /// An array whose last axes are given.
    pub fn array<'py, T: Element>(
        &self,
        py: Python<'py>,
        numbers: Vec<T>,
        last: &[usize],
    ) -> PyResult<Bound<'py, PyAny>> {
        let shape = [&self.lead[..], last].concat();
        Ok(PyArray1::from_vec(py, numbers).reshape(shape)?.into_any())
    }
}

/// An array of shape (n, 3) of rows.
pub fn table<'py>(py: Python<'py>, rows: impl Iterator<Item = [f64; 3]>) -> PyResult<Bound<'py, PyAny>> {
    let flat: Vec<f64> = rows.flatten().collect();
    let n = flat.len() / 3;
    Shape { lead: vec![n], n }.array(py, flat, &[3])
}
