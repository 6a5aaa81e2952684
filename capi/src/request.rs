//! One way to ask: outputs that are given are outputs that are wanted.
#![allow(unsafe_code)]

use crate::batch::srbf_samples_out;
use crate::guard::{Failure, Outcome, guard};
use crate::material::{material, srbf_material};
use crate::pointers::{apart, check_apart, read, slice};
use crate::status::{SRBF_STATUS_ARGUMENT, SRBF_STATUS_OVERLAP, SRBF_STATUS_SIZE, srbf_status};
use crate::streams::{BLOCK, Stream, srbf_numbers_out, srbf_vectors, srbf_vectors_out};
use core::ops::Range;
use srbf_core::{Draws, Material, Request, Towards};

/// What is asked for each of n hits. Start from zeros, set `size` and `wo`, and what is wanted.
///
/// `sizeof(srbf_request)` in `size` lets later versions ask for more. An output whose first pointer is NULL is not wanted and not
/// worked out: `value.x`, `pdf.values`, `samples.direction.x`, `samples.pdf.values`, `samples.weight.x`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_request {
    /// `sizeof(srbf_request)`.
    pub size: usize,
    /// Outgoing directions, n unit vectors.
    pub wo: srbf_vectors,
    /// Incident directions, n unit vectors; looked at if `value` or `pdf` is wanted.
    pub wi: srbf_vectors,
    /// Three uniform numbers in [0, 1) a hit; looked at if directions are drawn.
    pub u: srbf_vectors,
    /// `f cos` towards `wi`, linear sRGB; 1/sr.
    pub value: srbf_vectors_out,
    /// Density of drawing `wi`; 1/sr.
    pub pdf: srbf_numbers_out,
    /// Directions that are drawn, with densities and weights if they are wanted too.
    pub samples: srbf_samples_out,
}

/// Inputs: wo, wi, u. Outputs: value, pdf, direction, its density, its weight.
const INPUTS: usize = 9;
const OUTPUTS: usize = 11;

/// The arrays of a request, of which some are not there.
struct Arrays {
    inputs: [Option<Stream>; INPUTS],
    outputs: [Option<Stream>; OUTPUTS],
    count: usize,
}

impl Arrays {
    /// Checks pointers, strides and overlaps, but for the materials.
    fn new(request: &srbf_request, count: usize) -> Result<Self, Failure> {
        let srbf_request { wo, wi, u, value, pdf, samples, .. } = *request;
        let wants = [
            !value.x.is_null(),
            !pdf.values.is_null(),
            !samples.direction.x.is_null(),
            !samples.pdf.values.is_null(),
            !samples.weight.x.is_null(),
        ];
        let [wants_value, wants_pdf, draws, wants_density, wants_weight] = wants;
        // Densities and weights are of directions.
        if (wants_density || wants_weight) && !draws {
            return Err(SRBF_STATUS_ARGUMENT.into());
        }
        let mut arrays = Self { inputs: [None; INPUTS], outputs: [None; OUTPUTS], count };
        let put = |to: &mut [Option<Stream>], from: &[Stream], is_there: bool| {
            for (to, from) in to.iter_mut().zip(from) {
                *to = is_there.then_some(*from);
            }
        };
        put(&mut arrays.inputs[..3], &wo.streams(), true);
        put(&mut arrays.inputs[3..6], &wi.streams(), wants_value || wants_pdf);
        put(&mut arrays.inputs[6..], &u.streams(), draws);
        put(&mut arrays.outputs[..3], &value.streams(), wants_value);
        put(&mut arrays.outputs[3..4], &[pdf.stream()], wants_pdf);
        put(&mut arrays.outputs[4..7], &samples.direction.streams(), draws);
        put(&mut arrays.outputs[7..8], &[samples.pdf.stream()], wants_density);
        put(&mut arrays.outputs[8..], &samples.weight.streams(), wants_weight);
        arrays.check()?;
        Ok(arrays)
    }

    fn check(&self) -> Outcome {
        for stream in self.inputs.iter().chain(&self.outputs).flatten() {
            stream.check(self.count)?;
        }
        for (index, output) in self.outputs.iter().enumerate() {
            let Some(output) = output else { continue };
            let extent = output.extent(self.count);
            for other in self.inputs.iter().chain(&self.outputs[..index]).flatten() {
                if !apart(&extent, &other.extent(self.count)) && output.shares_with(other) {
                    return Err(SRBF_STATUS_OVERLAP.into());
                }
            }
        }
        Ok(())
    }

    /// From the first byte of any output to the last.
    fn hull(&self) -> Range<usize> {
        let extents = || self.outputs.iter().flatten().map(|stream| stream.extent(self.count));
        let start = extents().map(|extent| extent.start).min().unwrap_or(0);
        start..extents().map(|extent| extent.end).max().unwrap_or(0)
    }

    /// Refuses outputs upon bytes that are read; most objects are outside of the hull of all outputs.
    fn check_object(&self, hull: &Range<usize>, object: &Range<usize>) -> Outcome {
        if apart(hull, object) {
            return Ok(());
        }
        let mut extents = self.outputs.iter().flatten().map(|stream| stream.extent(self.count));
        extents.try_for_each(|extent| check_apart(&extent, object))
    }

    /// Calls core with the arrays from `from` on, `len` of them, at most [`BLOCK`].
    ///
    /// # Safety
    /// The header's contract of the arrays.
    unsafe fn ask(
        &self,
        from: usize,
        len: usize,
        call: impl FnOnce([&[f32]; 3], Request<'_>) -> Result<(), srbf_core::Error>,
    ) -> Outcome {
        let (mut read, mut written) = ([[0f32; BLOCK]; INPUTS], [[0f32; BLOCK]; OUTPUTS]);
        let mut inputs: [&[f32]; INPUTS] = [&[]; INPUTS];
        for ((slice, stream), block) in inputs.iter_mut().zip(&self.inputs).zip(&mut read) {
            if let Some(stream) = stream {
                // SAFETY: `check` has seen the array, of which `from + len` is no further than the end; the rest is the
                // header's contract.
                *slice = unsafe { stream.read(from, len, block) };
            }
        }
        let mut outputs = [const { None }; OUTPUTS];
        for ((slice, stream), block) in outputs.iter_mut().zip(&self.outputs).zip(&mut written) {
            if let Some(stream) = stream {
                // SAFETY: as above; no output meets another array.
                *slice = Some(unsafe { stream.place(from, len, block) });
            }
        }
        let [ox, oy, oz, ix, iy, iz, ux, uy, uz] = inputs;
        let [red, green, blue, pdf, x, y, z, density, w0, w1, w2] = outputs;
        let three = |a, b, c| Some([a?, b?, c?]);
        let (value, weight) = (three(red, green, blue), three(w0, w1, w2));
        let draw = three(x, y, z).map(|direction| Draws { u: [ux, uy, uz], direction, pdf: density, weight });
        let evaluate = (value.is_some() || pdf.is_some()).then_some(Towards { wi: [ix, iy, iz], value, pdf });
        call([ox, oy, oz], Request { draw, evaluate })?;
        for (stream, block) in self.outputs.iter().zip(&written) {
            if let Some(stream) = stream {
                // SAFETY: as above; no slice of the caller's memory is alive.
                unsafe { stream.write_back(from, len, block) };
            }
        }
        Ok(())
    }
}

/// Draws and evaluates for n hits, each with an outgoing direction of its own: what is given is what is wanted.
///
/// `materials` are n, or one for all hits (`material_count` = 1); they need not be sorted. The answers of
/// `srbf_material_sample_and_evaluate`, in less time. Where nothing is reflected, and for a `wo` that is no unit vector, values and
/// densities are 0 and the normal is drawn with density 0.
/// Shapes: `materials` [`material_count`]; every array of the request n, outputs overwritten. n = 0 looks at no pointer.
/// Status: `SRBF_STATUS_ARGUMENT` for a count that is neither 1 nor n, or densities or weights of draws without directions;
/// `SRBF_STATUS_SIZE` for a size that is not `sizeof(srbf_request)`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_ask(
    materials: *const *const srbf_material,
    material_count: usize,
    n: usize,
    request: *const srbf_request,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract; of a request of another size no more than that is read.
        if unsafe { read(request.cast::<usize>())? } != size_of::<srbf_request>() {
            return Err(SRBF_STATUS_SIZE.into());
        }
        if material_count != 1 && material_count != n {
            return Err(SRBF_STATUS_ARGUMENT.into());
        }
        // SAFETY: the header's contract.
        let (request, pointers) = unsafe { (read(request)?, slice(materials, material_count)?) };
        let arrays = Arrays::new(&request, n)?;
        let hull = arrays.hull();
        let start = materials.addr();
        arrays.check_object(&hull, &(start..start + size_of_val(pointers)))?;
        for &pointer in pointers {
            // SAFETY: the header's contract.
            let object = unsafe { material(pointer)? };
            for place in object.extents() {
                arrays.check_object(&hull, &place)?;
            }
        }
        // SAFETY: the header's contract.
        let first = &unsafe { material(pointers[0])? }.material;
        for from in (0..n).step_by(BLOCK) {
            let len = BLOCK.min(n - from);
            if material_count == 1 {
                // SAFETY: the header's contract.
                unsafe { arrays.ask(from, len, |wo, request| first.ask(wo, request))? };
                continue;
            }
            let mut each = [first; BLOCK];
            for (to, &pointer) in each.iter_mut().zip(&pointers[from..from + len]) {
                // SAFETY: the header's contract.
                *to = &unsafe { material(pointer)? }.material;
            }
            // SAFETY: the header's contract.
            unsafe { arrays.ask(from, len, |wo, request| Material::ask_each(&each[..len], wo, request))? };
        }
        Ok(())
    })
}
