//! Pairs: n directions, each with its own mixture, as a renderer has them that sorts its hits into streams.
#![allow(unsafe_code)]

use crate::batch::sampled_and_evaluated;
use crate::batch::srbf_samples_out;
use crate::guard::{Failure, Outcome, guard};
use crate::material::material;
use crate::material::srbf_material;
use crate::pair_batch;
use crate::pointers::{check_extent, read};
use crate::status::{SRBF_STATUS_STRIDE, srbf_status};
use crate::storage::{AnyMixture, AnyMixtures, check_storage, extent, mixture, with_mixture};
use crate::storage::{SRBF_MIXTURE_ALIGNMENT, SRBF_MIXTURE_SIZE_16, srbf_mixture};
use crate::streams::{Batch, srbf_numbers_out, srbf_vectors, srbf_vectors_out};
use core::ops::Range;
use srbf_core::{Error, Mixture, SamplesMut};

/// Evaluates `f cos` for n pairs of an outgoing and an incident direction, each pair with its own mixture; 1/sr.
///
/// The values of `srbf_material_prepare` and `srbf_mixture_evaluate`, pair by pair, without storage for mixtures.
/// Shapes: `wo` and `wi` n unit vectors; `value` n colours in linear sRGB, overwritten. n = 0 looks at no pointer but the material.
/// A `wo` that is no unit vector gives 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_evaluate_pairs_into(
    material: *const srbf_material,
    n: usize,
    wo: *const srbf_vectors,
    wi: *const srbf_vectors,
    value: *const srbf_vectors_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        // SAFETY: the header's contract.
        unsafe {
            pair_batch::evaluate(n, [wo, wi], value, object.extents(), |wo, wi, value| {
                object.material.evaluate_pairs_into(wo, wi, value)
            })
        }
    })
}

/// Evaluates `f cos` and the density of sampling for n pairs of an outgoing and an incident direction; 1/sr.
///
/// Shapes: as in `srbf_material_evaluate_pairs_into`, and `pdf` n numbers, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_evaluate_and_pdf_pairs_into(
    material: *const srbf_material,
    n: usize,
    wo: *const srbf_vectors,
    wi: *const srbf_vectors,
    value: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        // SAFETY: the header's contract.
        unsafe {
            pair_batch::evaluate_and_pdf(n, [wo, wi], value, pdf, object.extents(), |wo, wi, value, pdf| {
                object.material.evaluate_and_pdf_pairs_into(wo, wi, value, pdf)
            })
        }
    })
}

/// Evaluates the density of sampling alone for n pairs of an outgoing and an incident direction; 1/sr.
///
/// The densities of `srbf_material_evaluate_and_pdf_pairs_into` within rounding, in less time.
/// Shapes: `wo` and `wi` n unit vectors; `pdf` n numbers, overwritten. n = 0 and what is no unit vector as in
/// `srbf_material_evaluate_pairs_into`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_pdf_pairs_into(
    material: *const srbf_material,
    n: usize,
    wo: *const srbf_vectors,
    wi: *const srbf_vectors,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        // SAFETY: the header's contract.
        unsafe {
            pair_batch::pdf(n, [wo, wi], pdf, object.extents(), |wo, wi, pdf| {
                object.material.pdf_pairs_into(wo, wi, pdf)
            })
        }
    })
}

/// Draws an incident direction for each of n outgoing ones with its density, without a weight.
///
/// The samples of `srbf_material_sample_pairs_into`, for callers that take the value elsewhere, in less time.
/// Shapes: `wo` n unit vectors; `u` n times three uniform numbers in [0, 1); `direction` n unit vectors and `pdf` n
/// numbers, overwritten. n = 0 and what is no unit vector as in `srbf_material_evaluate_pairs_into`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_sample_pdf_pairs_into(
    material: *const srbf_material,
    n: usize,
    wo: *const srbf_vectors,
    u: *const srbf_vectors,
    direction: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        // SAFETY: the header's contract.
        unsafe {
            pair_batch::sample_pdf(n, [wo, u], direction, pdf, object.extents(), |wo, u, direction, pdf| {
                object.material.sample_pdf_pairs_into(wo, u, direction, pdf)
            })
        }
    })
}

/// Draws an incident direction for each of n outgoing ones, each with its own mixture.
///
/// The samples of `srbf_material_prepare` and `srbf_mixture_sample`, one by one, without storage for mixtures.
/// Shapes: `wo` n unit vectors; `u` n times three uniform numbers in [0, 1); `samples` n of each, overwritten. n = 0
/// and what is no unit vector as in `srbf_material_evaluate_pairs_into`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_sample_pairs_into(
    material: *const srbf_material,
    n: usize,
    wo: *const srbf_vectors,
    u: *const srbf_vectors,
    samples: *const srbf_samples_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        // SAFETY: the header's contract.
        unsafe {
            pair_batch::sample(n, [wo, u], samples, object.extents(), |wo, u, samples| {
                object.material.sample_pairs_into(wo, u, samples)
            })
        }
    })
}

/// Draws an incident direction for each of n outgoing ones, and evaluates value and density towards another one, with one
/// preparation: what next-event estimation needs at every hit.
///
/// Shapes: `wo`, `u` and `samples` as in `srbf_material_sample_pairs_into`; `wi`, `value` and `pdf` as in
/// `srbf_material_evaluate_and_pdf_pairs_into`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_sample_and_evaluate_pairs_into(
    material: *const srbf_material,
    n: usize,
    wo: *const srbf_vectors,
    u: *const srbf_vectors,
    samples: *const srbf_samples_out,
    wi: *const srbf_vectors,
    value: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        // SAFETY: the header's contract.
        unsafe {
            pair_batch::sample_and_evaluate(
                n,
                [wo, u, wi],
                samples,
                value,
                pdf,
                object.extents(),
                |wo, u, samples, wi, value, pdf| {
                    object.material.sample_and_evaluate_pairs_into(wo, u, samples, wi, value, pdf)
                },
            )
        }
    })
}

/// n mixtures, one behind the other; those that `srbf_material_prepare_into` makes.
struct Mixtures {
    start: *const u8,
    stride: usize,
    /// The bytes from the first to the end of the last.
    extent: Range<usize>,
}

impl Mixtures {
    /// # Safety
    /// The header's contract: there is a mixture at every multiple of the stride; `count` is not 0.
    unsafe fn new(start: *const srbf_mixture, count: usize, stride: usize) -> Result<Self, Failure> {
        let start = start.cast::<u8>();
        check_storage(start.cast_mut())?;
        if stride < SRBF_MIXTURE_SIZE_16 || !stride.is_multiple_of(SRBF_MIXTURE_ALIGNMENT) {
            return Err(SRBF_STATUS_STRIDE.into());
        }
        check_extent(start.addr(), count, stride)?;
        let mut made = Self { start, stride, extent: start.addr()..start.addr() + count * stride };
        // The last one may be of a larger capacity than the stride has room for: nothing comes behind it.
        // SAFETY: the caller's word.
        let end = unsafe { extent(made.at(count - 1), &made.get(count - 1)?).end };
        made.extent.end = made.extent.end.max(end);
        Ok(made)
    }

    fn extent(&self) -> Range<usize> {
        self.extent.clone()
    }

    /// Where a mixture is; `index` is below the count.
    #[inline(always)]
    fn at(&self, index: usize) -> *const srbf_mixture {
        self.start.wrapping_byte_add(index * self.stride).cast()
    }

    /// # Safety
    /// As [`Self::new`]; `index` is below the count.
    #[inline(always)]
    unsafe fn get<'a>(&self, index: usize) -> Result<AnyMixture<'a>, Failure> {
        // SAFETY: within the extent that `new` has checked; the rest is the caller's word.
        unsafe { mixture(self.at(index)) }
    }
    /// Calls with the mixtures of a part of the batch, as many of one capacity at a time as come one behind the other, and with their
    /// places within the part.
    ///
    /// # Safety
    /// As [`Self::new`]; `from + count` is at most the count.
    unsafe fn each(
        &self,
        from: usize,
        count: usize,
        mut call: impl FnMut(AnyMixtures<'_>, Range<usize>) -> Result<(), Error>,
    ) -> Outcome {
        let mut at = 0;
        while at < count {
            // SAFETY: the caller's word, as everywhere below.
            let first = unsafe { self.get(from + at)? };
            macro_rules! run {
                ($capacity:ident, $first:ident) => {{
                    let (mut run, mut len) = ([$first; RUN], 1);
                    while len < RUN && at + len < count {
                        // SAFETY: as above.
                        let AnyMixture::$capacity(next) = (unsafe { self.get(from + at + len)? }) else {
                            break;
                        };
                        run[len] = next;
                        len += 1;
                    }
                    call(AnyMixtures::$capacity(&run[..len]), at..at + len)?;
                    at += len;
                }};
            }
            match first {
                AnyMixture::C16(first) => run!(C16, first),
                AnyMixture::C32(first) => run!(C32, first),
                AnyMixture::C64(first) => run!(C64, first),
            }
        }
        Ok(())
    }
}

/// Mixtures that are handed on in one call.
const RUN: usize = 64;

/// A part of every slice.
fn part<'a, const K: usize>(slices: [&'a [f32]; K], range: &Range<usize>) -> [&'a [f32]; K] {
    slices.map(|s| &s[range.clone()])
}

/// A part of every slice, to overwrite.
fn part_mut<'a, const K: usize>(slices: &'a mut [&mut [f32]; K], range: &Range<usize>) -> [&'a mut [f32]; K] {
    slices.each_mut().map(|s| &mut s[range.clone()])
}

/// Evaluates `f cos` for n pairs of a mixture and a direction; 1/sr.
///
/// Mixture i is at `(const srbf_mixture *)((const char *)mixtures + i * mixture_stride)`.
/// Shapes: `mixtures` [n], `mixture_stride` bytes apart, a multiple of `SRBF_MIXTURE_ALIGNMENT` and at least
/// `SRBF_MIXTURE_SIZE_16`; `wi` n unit vectors; `value` n colours in linear sRGB, overwritten. n = 0 looks at no pointer. What is
/// not a unit vector gives an unspecified value.
/// Status: `SRBF_STATUS_OBJECT` if one of them is no mixture; the values are unspecified then.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_evaluate_pairs_into(
    mixtures: *const srbf_mixture,
    mixture_stride: usize,
    n: usize,
    wi: *const srbf_vectors,
    value: *const srbf_vectors_out,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let mixtures = unsafe { Mixtures::new(mixtures, n, mixture_stride)? };
        // SAFETY: the header's contract.
        let (wi, value) = unsafe { (read(wi)?, read(value)?) };
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, wi.streams(), value.streams(), [mixtures.extent()])? };
        let mut first = 0;
        batch.run(|wi, mut outputs: [&mut [f32]; 3]| {
            let (from, count) = (first, outputs[0].len());
            first += count;
            // SAFETY: the batch has n in all.
            unsafe {
                mixtures.each(from, count, |mixtures, range| {
                    let (wi, value) = (part(wi, &range), part_mut(&mut outputs, &range));
                    with_mixture!(AnyMixtures: mixtures, m => Mixture::evaluate_pairs_into(m, wi, value))
                })
            }
        })
    })
}

/// Evaluates `f cos` and the density of sampling for n pairs of a mixture and a direction; 1/sr.
///
/// Shapes and status as in `srbf_mixture_evaluate_pairs_into`; `pdf` n numbers, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_evaluate_and_pdf_pairs_into(
    mixtures: *const srbf_mixture,
    mixture_stride: usize,
    n: usize,
    wi: *const srbf_vectors,
    value: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let mixtures = unsafe { Mixtures::new(mixtures, n, mixture_stride)? };
        // SAFETY: the header's contract.
        let (wi, value, pdf) = unsafe { (read(wi)?, read(value)?, read(pdf)?) };
        let [red, green, blue] = value.streams();
        // SAFETY: the header's contract.
        let batch =
            unsafe { Batch::new(n, wi.streams(), [red, green, blue, pdf.stream()], [mixtures.extent()])? };
        let mut first = 0;
        batch.run(|wi, mut outputs: [&mut [f32]; 4]| {
            let (from, count) = (first, outputs[0].len());
            first += count;
            // SAFETY: the batch has n in all.
            unsafe {
                mixtures.each(from, count, |mixtures, range| {
                    let (wi, [red, green, blue, pdf]) = (part(wi, &range), part_mut(&mut outputs, &range));
                    let value = [red, green, blue];
                    with_mixture!(AnyMixtures: mixtures, m => Mixture::evaluate_and_pdf_pairs_into(m, wi, value, pdf))
                })
            }
        })
    })
}

/// Evaluates the density of sampling for n pairs of a mixture and a direction; 1/sr.
///
/// Shapes and status as in `srbf_mixture_evaluate_pairs_into`; `pdf` n numbers, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_pdf_pairs_into(
    mixtures: *const srbf_mixture,
    mixture_stride: usize,
    n: usize,
    wi: *const srbf_vectors,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let mixtures = unsafe { Mixtures::new(mixtures, n, mixture_stride)? };
        // SAFETY: the header's contract.
        let (wi, pdf) = unsafe { (read(wi)?, read(pdf)?) };
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, wi.streams(), [pdf.stream()], [mixtures.extent()])? };
        let mut first = 0;
        batch.run(|wi, mut outputs: [&mut [f32]; 1]| {
            let (from, count) = (first, outputs[0].len());
            first += count;
            // SAFETY: the batch has n in all.
            unsafe {
                mixtures.each(from, count, |mixtures, range| {
                    let (wi, [pdf]) = (part(wi, &range), part_mut(&mut outputs, &range));
                    with_mixture!(AnyMixtures: mixtures, m => Mixture::pdf_pairs_into(m, wi, pdf))
                })
            }
        })
    })
}

/// Draws one direction from each of n mixtures, with density and weight.
///
/// Shapes and status as in `srbf_mixture_evaluate_pairs_into`; `u` and `samples` as in `srbf_mixture_sample_into`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample_pairs_into(
    mixtures: *const srbf_mixture,
    mixture_stride: usize,
    n: usize,
    u: *const srbf_vectors,
    samples: *const srbf_samples_out,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let mixtures = unsafe { Mixtures::new(mixtures, n, mixture_stride)? };
        // SAFETY: the header's contract.
        let (u, samples) = unsafe { (read(u)?, read(samples)?) };
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, u.streams(), samples.streams(), [mixtures.extent()])? };
        let mut first = 0;
        batch.run(|u, mut outputs: [&mut [f32]; 7]| {
            let (from, count) = (first, outputs[0].len());
            first += count;
            // SAFETY: the batch has n in all.
            unsafe {
                mixtures.each(from, count, |mixtures, range| {
                    let (u, [x, y, z, pdf, w0, w1, w2]) = (part(u, &range), part_mut(&mut outputs, &range));
                    let samples = SamplesMut { direction: [x, y, z], pdf, weight: [w0, w1, w2] };
                    with_mixture!(AnyMixtures: mixtures, m => Mixture::sample_pairs_into(m, u, samples))
                })
            }
        })
    })
}

/// Draws one direction from each of n mixtures with its density, without a weight.
///
/// Shapes and status as in `srbf_mixture_evaluate_pairs_into`; `u`, `direction` and `pdf` as in `srbf_mixture_sample_pdf_into`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample_pdf_pairs_into(
    mixtures: *const srbf_mixture,
    mixture_stride: usize,
    n: usize,
    u: *const srbf_vectors,
    direction: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let mixtures = unsafe { Mixtures::new(mixtures, n, mixture_stride)? };
        // SAFETY: the header's contract.
        let (u, direction, pdf) = unsafe { (read(u)?, read(direction)?, read(pdf)?) };
        let [x, y, z] = direction.streams();
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, u.streams(), [x, y, z, pdf.stream()], [mixtures.extent()])? };
        let mut first = 0;
        batch.run(|u, mut outputs: [&mut [f32]; 4]| {
            let (from, count) = (first, outputs[0].len());
            first += count;
            // SAFETY: the batch has n in all.
            unsafe {
                mixtures.each(from, count, |mixtures, range| {
                    let (u, [x, y, z, pdf]) = (part(u, &range), part_mut(&mut outputs, &range));
                    with_mixture!(AnyMixtures: mixtures, m => Mixture::sample_pdf_pairs_into(m, u, [x, y, z], pdf))
                })
            }
        })
    })
}

/// Draws one direction from each of n mixtures, and evaluates value and density towards another one.
///
/// Shapes and status as in `srbf_mixture_sample_pairs_into` and, of the other directions `wi`, in
/// `srbf_mixture_evaluate_and_pdf_pairs_into`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample_and_evaluate_pairs_into(
    mixtures: *const srbf_mixture,
    mixture_stride: usize,
    n: usize,
    u: *const srbf_vectors,
    samples: *const srbf_samples_out,
    wi: *const srbf_vectors,
    value: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let mixtures = unsafe { Mixtures::new(mixtures, n, mixture_stride)? };
        // SAFETY: the header's contract.
        let (u, samples) = unsafe { (read(u)?, read(samples)?) };
        // SAFETY: the header's contract.
        let (wi, value, pdf) = unsafe { (read(wi)?, read(value)?, read(pdf)?) };
        let ([ux, uy, uz], [ix, iy, iz]) = (u.streams(), wi.streams());
        // SAFETY: the header's contract.
        let batch = unsafe {
            Batch::new(n, [ux, uy, uz, ix, iy, iz], samples.streams_beside(value, pdf), [mixtures.extent()])?
        };
        let mut first = 0;
        batch.run(|inputs, mut outputs: [&mut [f32]; 11]| {
            let (from, count) = (first, outputs[0].len());
            first += count;
            // SAFETY: the batch has n in all.
            unsafe {
                mixtures.each(from, count, |mixtures, range| {
                    let [ux, uy, uz, ix, iy, iz] = part(inputs, &range);
                    let (u, wi) = ([ux, uy, uz], [ix, iy, iz]);
                    let (samples, value, pdf) = sampled_and_evaluated(part_mut(&mut outputs, &range));
                    with_mixture!(AnyMixtures: mixtures, m => Mixture::sample_and_evaluate_pairs_into(m, u, samples, wi, value, pdf))
                })
            }
        })
    })
}
