//! One way to ask for n hits: outputs that are given are outputs that are wanted.
#![allow(unsafe_code)]

use crate::expanded::{object, srbf_expanded};
use crate::guard::{Failure, Outcome, guard};
use crate::material::{material, srbf_material};
use crate::mixtures::Mixtures;
use crate::pointers::{apart, check, check_apart, check_extent, read};
use crate::status::{
    SRBF_STATUS_ARGUMENT, SRBF_STATUS_OVERLAP, SRBF_STATUS_SIZE, SRBF_STATUS_STRIDE, srbf_status,
};
use crate::storage::{extents, mixture, srbf_mixture, with_mixture};
use crate::streams::{BLOCK, Stream, srbf_numbers_out, srbf_samples_out, srbf_vectors, srbf_vectors_out};
use core::ops::Range;
use srbf_core::{Draws, Material, Mixture, Request, Towards};

/// The inputs and the wanted outputs for each of n hits. Start from zeros, set `size`, the inputs and the wanted outputs.
///
/// `sizeof(srbf_request)` in `size` lets later versions ask for more. An output whose first pointer is NULL is not wanted:
/// `value.x`, `pdf.values`, `samples.direction.x`, `samples.pdf.values`, `samples.weight.x`. Inputs that no output needs are not
/// looked at. Each array has n elements; outputs are overwritten, and may overlap nothing, inputs may overlap each other.
///
/// Where nothing is reflected, and for a `wo` that is no unit vector, values and densities are 0 and the normal is drawn
/// with density 0. A `wi` that is no unit vector gives an unspecified value, and so does a number `u` outside [0, 1);
/// others are not touched by it.
///
/// Every call that takes one refuses by `SRBF_STATUS_SIZE` a size that is not `sizeof(srbf_request)`, by `SRBF_STATUS_ARGUMENT`
/// densities or weights of draws without directions. n = 0 looks at no pointer, and succeeds.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_request {
    /// `sizeof(srbf_request)`.
    pub size: usize,
    /// Materials, n; looked at by `srbf_material_ask` without a material.
    pub materials: srbf_materials,
    /// Outgoing directions, n unit vectors; a mixture has its own, and does not look at them.
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

/// n materials to read, by pointers to them.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_materials {
    /// The first pointer.
    pub first: *const *const srbf_material,
    /// Bytes from one pointer to the next; a multiple of their alignment, at least their size.
    pub stride: usize,
}

impl srbf_materials {
    /// Checks where the pointers are; their bytes.
    fn check(&self, count: usize) -> Result<Range<usize>, Failure> {
        check(self.first)?;
        let size = size_of::<*const srbf_material>();
        if self.stride < size || !self.stride.is_multiple_of(align_of::<*const srbf_material>()) {
            return Err(SRBF_STATUS_STRIDE.into());
        }
        check_extent(self.first.addr(), count, self.stride)?;
        let start = self.first.addr();
        Ok(start..start + (count - 1) * self.stride + size)
    }

    /// # Safety
    /// They have been checked; `index` is below the count; the header's contract.
    #[inline(always)]
    unsafe fn get<'a>(&self, index: usize) -> Result<&'a srbf_material, Failure> {
        // SAFETY: the caller's word.
        unsafe { material(self.first.byte_add(index * self.stride).read()) }
    }
}

/// Inputs: wo, wi, u. Outputs: value, pdf, direction, its density, its weight.
const INPUTS: usize = 9;
const OUTPUTS: usize = 11;

/// The arrays of a request, of which some are not there.
struct Arrays {
    inputs: [Option<Stream>; INPUTS],
    outputs: [Option<Stream>; OUTPUTS],
    count: usize,
    /// All are dense.
    is_dense: bool,
    /// From the first byte of any output to the last, nowhere if there is none: most objects are outside.
    hull: Range<usize>,
}

impl Arrays {
    /// Checks pointers, strides and overlaps, but for the objects. `looks_at_wo`: outgoing directions are an input.
    ///
    /// # Safety
    /// The header's contract: inputs are readable and nobody writes them during the call, outputs are writable and nobody else
    /// uses them. `count` is not 0.
    unsafe fn new(request: *const srbf_request, count: usize, looks_at_wo: bool) -> Result<Self, Failure> {
        // SAFETY: the header's contract; of a request of another size no more than that is read.
        if unsafe { read(request.cast::<usize>())? } != size_of::<srbf_request>() {
            return Err(SRBF_STATUS_SIZE.into());
        }
        // In place: a copy would wait for the stores of the caller.
        // SAFETY: not NULL and aligned, as `read` has seen; readable by the header's contract.
        let srbf_request { wo, wi, u, value, pdf, samples, .. } = unsafe { &*request };
        let wants_value = !value.x.is_null();
        let wants_pdf = !pdf.values.is_null();
        let draws = !samples.direction.x.is_null();
        let wants_density = !samples.pdf.values.is_null();
        let wants_weight = !samples.weight.x.is_null();
        // Densities and weights are of directions.
        if (wants_density || wants_weight) && !draws {
            return Err(SRBF_STATUS_ARGUMENT.into());
        }
        let (mut inputs, mut outputs) = ([None; INPUTS], [None; OUTPUTS]);
        let put = |to: &mut [Option<Stream>], from: &[Stream], is_there: bool| {
            for (to, from) in to.iter_mut().zip(from) {
                *to = is_there.then_some(*from);
            }
        };
        put(&mut inputs[..3], &wo.streams(), looks_at_wo);
        put(&mut inputs[3..6], &wi.streams(), wants_value || wants_pdf);
        put(&mut inputs[6..], &u.streams(), draws);
        put(&mut outputs[..3], &value.streams(), wants_value);
        put(&mut outputs[3..4], &[pdf.stream()], wants_pdf);
        put(&mut outputs[4..7], &samples.direction.streams(), draws);
        put(&mut outputs[7..8], &[samples.pdf.stream()], wants_density);
        put(&mut outputs[8..], &samples.weight.streams(), wants_weight);
        let mut arrays = Self { inputs, outputs, count, is_dense: true, hull: 0..0 };
        arrays.check()?;
        Ok(arrays)
    }

    /// Extents first, each once: in most requests none meets another.
    fn check(&mut self) -> Outcome {
        let (mut read, mut written) = ([[0; 2]; INPUTS], [[0; 2]; OUTPUTS]);
        let (count, mut is_dense) = (self.count, true);
        let mut extents =
            |streams: &[Option<Stream>], extents: &mut [[usize; 2]]| -> Result<usize, Failure> {
                let mut n = 0;
                for stream in streams.iter().flatten() {
                    stream.check(count)?;
                    is_dense &= stream.is_dense();
                    let extent = stream.extent(count);
                    extents[n] = [extent.start, extent.end];
                    n += 1;
                }
                Ok(n)
            };
        let reads = extents(&self.inputs, &mut read)?;
        let writes = extents(&self.outputs, &mut written)?;
        self.is_dense = is_dense;
        let (read, written) = (&read[..reads], &written[..writes]);
        // Without branches that depend on the addresses.
        let mut meeting = false;
        for (o, &[start, end]) in written.iter().enumerate() {
            let first = if o == 0 { start } else { self.hull.start };
            self.hull = first.min(start)..self.hull.end.max(end);
            for &[from, to] in read.iter().chain(&written[..o]) {
                meeting |= (start < to) & (from < end);
            }
        }
        if !meeting {
            return Ok(());
        }
        let streams = || self.inputs.iter().chain(&self.outputs).flatten();
        let before_outputs = self.inputs.iter().flatten().count();
        for (index, output) in self.outputs.iter().flatten().enumerate() {
            let extent = output.extent(self.count);
            for other in streams().take(before_outputs + index) {
                if !apart(&extent, &other.extent(self.count)) && output.shares_with(other) {
                    return Err(SRBF_STATUS_OVERLAP.into());
                }
            }
        }
        Ok(())
    }

    /// Refuses outputs upon bytes that are read.
    fn check_object(&self, object: &Range<usize>) -> Outcome {
        if apart(&self.hull, object) {
            return Ok(());
        }
        let mut extents = self.outputs.iter().flatten().map(|stream| stream.extent(self.count));
        extents.try_for_each(|extent| check_apart(&extent, object))
    }

    /// Refuses outputs upon pointers that are read, `stride` bytes apart: of one stride, they may lie in between.
    fn check_between(&self, place: &Range<usize>, stride: usize) -> Outcome {
        for output in self.outputs.iter().flatten() {
            let is_apart = apart(&output.extent(self.count), place);
            if !is_apart && output.meets(place.start, size_of::<*const srbf_material>(), stride) {
                return Err(SRBF_STATUS_OVERLAP.into());
            }
        }
        Ok(())
    }

    /// Calls with all arrays, at most `most` numbers at a time, and with where these begin; copies are of [`BLOCK`].
    ///
    /// # Safety
    /// The word given to [`new`](Self::new).
    unsafe fn each(&self, most: usize, call: Call<'_>) -> Outcome {
        if self.is_dense {
            for from in (0..self.count).step_by(most) {
                // SAFETY: nothing is copied.
                unsafe { self.part(from, most.min(self.count - from), &mut [], &mut [], call)? };
            }
            return Ok(());
        }
        let (mut read, mut written) = ([[0f32; BLOCK]; INPUTS], [[0f32; BLOCK]; OUTPUTS]);
        for from in (0..self.count).step_by(BLOCK) {
            let len = BLOCK.min(self.count - from);
            // SAFETY: `new` has checked the arrays, of which `from + len` is no further than the end.
            unsafe { self.part(from, len, &mut read, &mut written, call)? };
        }
        Ok(())
    }

    /// Calls with `len` numbers of each array from `from` on; `read` and `written` are for copies.
    ///
    /// # Safety
    /// As [`each`](Self::each).
    unsafe fn part(
        &self,
        from: usize,
        len: usize,
        read: &mut [[f32; BLOCK]],
        written: &mut [[f32; BLOCK]],
        call: Call<'_>,
    ) -> Outcome {
        let mut inputs: [&[f32]; INPUTS] = [&[]; INPUTS];
        let mut blocks = read.iter_mut();
        for (slice, stream) in inputs.iter_mut().zip(&self.inputs) {
            let block = blocks.next();
            if let Some(stream) = stream {
                // SAFETY: the caller's word.
                *slice = unsafe { stream.read(from, len, block) };
            }
        }
        let mut outputs = [const { None }; OUTPUTS];
        let mut blocks = written.iter_mut();
        for (slice, stream) in outputs.iter_mut().zip(&self.outputs) {
            let block = blocks.next();
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
        call(from..from + len, [ox, oy, oz], Request { draw, evaluate })?;
        for (stream, block) in self.outputs.iter().zip(&*written) {
            if let Some(stream) = stream {
                // SAFETY: as above; no slice of the caller's memory is alive.
                unsafe { stream.write_back(from, len, block) };
            }
        }
        Ok(())
    }
}

/// What answers a part of a request: its place among the hits, outgoing directions, the rest. Not generic, so that the mechanics
/// are compiled once.
type Call<'a> = &'a mut dyn FnMut(Range<usize>, [&[f32]; 3], Request<'_>) -> Outcome;

/// Draws and evaluates for n hits of mixtures: outputs that are given are wanted.
///
/// Mixture i is at `(const srbf_mixture *)((const char *)mixtures + i * mixture_stride)`; with a stride of 0 all hits are of the
/// one mixture. The answers of `srbf_mixture_sample_and_evaluate` within rounding, in less time.
/// Shapes: `mixtures` [n], `mixture_stride` bytes apart: 0, or a multiple of `SRBF_MIXTURE_ALIGNMENT` and at least
/// `SRBF_MIXTURE_SIZE_16`. Status: `SRBF_STATUS_OBJECT` if one of them is no mixture; outputs are unspecified then.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_ask(
    mixtures: *const srbf_mixture,
    mixture_stride: usize,
    n: usize,
    request: *const srbf_request,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        if mixture_stride == 0 {
            // SAFETY: the header's contract.
            let (any, arrays) = unsafe { (mixture(mixtures)?, Arrays::new(request, n, false)?) };
            extents(mixtures, &any).iter().try_for_each(|place| arrays.check_object(place))?;
            // SAFETY: the header's contract.
            return unsafe {
                arrays.each(n, &mut |_, _, request| {
                    with_mixture!(AnyMixture: &any, m => m.ask(request))?;
                    Ok(())
                })
            };
        }
        // SAFETY: the header's contract.
        let (all, arrays) =
            unsafe { (Mixtures::new(mixtures, n, mixture_stride)?, Arrays::new(request, n, false)?) };
        arrays.check_object(&all.extent())?;
        // SAFETY: the header's contract.
        unsafe {
            arrays.each(BLOCK, &mut |hits, _, mut request| {
                all.each(hits, |mixtures, part| {
                    let request = part_of(&mut request, part);
                    with_mixture!(AnyMixtures: mixtures, m => Mixture::ask_each(m, request))
                })
            })
        }
    })
}

/// A part of a request.
fn part_of<'a>(request: &'a mut Request<'_>, part: Range<usize>) -> Request<'a> {
    let draw = request.draw.as_mut().map(|Draws { u, direction, pdf, weight }| Draws {
        u: u.map(|s| &s[part.clone()]),
        direction: direction.each_mut().map(|s| &mut s[part.clone()]),
        pdf: pdf.as_mut().map(|s| &mut s[part.clone()]),
        weight: weight.as_mut().map(|weight| weight.each_mut().map(|s| &mut s[part.clone()])),
    });
    let evaluate = request.evaluate.as_mut().map(|Towards { wi, value, pdf }| Towards {
        wi: wi.map(|s| &s[part.clone()]),
        value: value.as_mut().map(|value| value.each_mut().map(|s| &mut s[part.clone()])),
        pdf: pdf.as_mut().map(|s| &mut s[part.clone()]),
    });
    Request { draw, evaluate }
}

/// Draws and evaluates for n hits of a material, each with an outgoing direction of its own: outputs that are given are wanted.
///
/// The answers of `srbf_material_sample_and_evaluate` within rounding, in less time.
/// Shapes: `material` one for all hits; or NULL, and each hit has its own in `materials` of the request. They need not be sorted.
/// An output may lie between their pointers, but not upon one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_ask(
    material: *const srbf_material,
    n: usize,
    request: *const srbf_request,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let arrays = unsafe { Arrays::new(request, n, true)? };
        let check =
            |object: &srbf_material| object.extents().iter().try_for_each(|place| arrays.check_object(place));
        if !material.is_null() {
            // SAFETY: the header's contract.
            let object = unsafe { self::material(material)? };
            check(object)?;
            // SAFETY: the header's contract.
            return unsafe {
                arrays.each(n, &mut |_, wo, request| {
                    object.material.ask(wo, request)?;
                    Ok(())
                })
            };
        }
        // SAFETY: the header's contract; `new` has read it.
        let materials = unsafe { read(request)? }.materials;
        let place = materials.check(n)?;
        arrays.check_between(&place, materials.stride)?;
        for i in 0..n {
            // SAFETY: the header's contract.
            check(unsafe { materials.get(i)? })?;
        }
        // SAFETY: the header's contract.
        unsafe {
            arrays.each(BLOCK, &mut |hits, wo, request| {
                let mut each = [&materials.get(hits.start)?.material; BLOCK];
                let len = hits.len();
                for (to, i) in each.iter_mut().zip(hits) {
                    *to = &materials.get(i)?.material;
                }
                Material::ask_each(&each[..len], wo, request)?;
                Ok(())
            })
        }
    })
}

/// Draws and evaluates for n hits of an expanded material, each with an outgoing direction of its own: outputs that are given are
/// wanted. The answers of `srbf_material_ask` within the error of the rows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_expanded_ask(
    expanded: *const srbf_expanded,
    n: usize,
    request: *const srbf_request,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let (object, arrays) = unsafe { (object(expanded)?, Arrays::new(request, n, true)?) };
        object.extents().iter().try_for_each(|place| arrays.check_object(place))?;
        // SAFETY: the header's contract.
        unsafe {
            arrays.each(n, &mut |_, wo, request| {
                object.expanded.ask(wo, request)?;
                Ok(())
            })
        }
    })
}
