//! Pairs: n directions, each with its own mixture, as a renderer has them that sorts its hits into streams.
#![allow(unsafe_code)]

use crate::guard::{Failure, guard};
use crate::material::{Bytes, material};
use crate::pointers::{check_extent, read};
use crate::single::draw;
use crate::storage::{AnyMixture, check_storage, extent, mixture, with_mixture};
use crate::streams::{Batch, srbf_numbers_out, srbf_vectors, srbf_vectors_out};
use crate::{
    SRBF_MIXTURE_ALIGNMENT, SRBF_MIXTURE_SIZE_16, SRBF_STATUS_STRIDE, srbf_material, srbf_mixture,
    srbf_samples_out, srbf_status,
};
use core::ops::Range;
use srbf_core::{Error, Material, SamplesMut, Vec3};

/// Evaluates value and density for n pairs of an outgoing and an incident direction, each pair with its own mixture.
///
/// The values of `srbf_material_prepare` and `srbf_mixture_evaluate_and_pdf`, pair by pair, without storage for mixtures.
/// Shapes: `wo` and `wi` n unit vectors; `value` n colours in linear sRGB, `f cos`, and `pdf` n numbers, overwritten.
/// n = 0 looks at no pointer but the material. A `wo` that is no unit vector gives 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_evaluate_pairs_into(
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
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let (wo, wi, value, pdf) = unsafe { (read(wo)?, read(wi)?, read(value)?, read(pdf)?) };
        let ([ox, oy, oz], [ix, iy, iz]) = (wo.streams(), wi.streams());
        let [red, green, blue] = value.streams();
        let (inputs, outputs) = ([ox, oy, oz, ix, iy, iz], [red, green, blue, pdf.stream()]);
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, inputs, outputs, object.extents())? };
        batch.run(|[ox, oy, oz, ix, iy, iz], [red, green, blue, pdf]| {
            object.material.evaluate_pairs_into([ox, oy, oz], [ix, iy, iz], [red, green, blue], pdf)
        })?;
        Ok(())
    })
}

/// Evaluates the density of sampling alone for n pairs of an outgoing and an incident direction; 1/sr.
///
/// The densities of `srbf_material_evaluate_pairs_into` within rounding, in less time.
/// Shapes: `wo` and `wi` n unit vectors; `pdf` n numbers, overwritten. n = 0 and what is no unit vector as there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_pdf_pairs_into(
    material: *const srbf_material,
    n: usize,
    wo: *const srbf_vectors,
    wi: *const srbf_vectors,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    // SAFETY: the header's contract.
    unsafe { one_channel(material, n, wo, wi, pdf, Material::pdf_pairs_into) }
}

/// Evaluates the luminance of `f cos` (Rec. 709) for n pairs of an outgoing and an incident direction; 1/sr.
///
/// One colour channel in place of the three of `srbf_material_evaluate_pairs_into`.
/// Shapes: `wo` and `wi` n unit vectors; `luminance` n numbers, overwritten. n = 0 and what is no unit vector as there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_luminance_pairs_into(
    material: *const srbf_material,
    n: usize,
    wo: *const srbf_vectors,
    wi: *const srbf_vectors,
    luminance: *const srbf_numbers_out,
) -> srbf_status {
    // SAFETY: the header's contract.
    unsafe { one_channel(material, n, wo, wi, luminance, Material::luminance_pairs_into) }
}

type OneChannel = fn(&Material<Bytes>, [&[f32]; 3], [&[f32]; 3], &mut [f32]) -> Result<(), Error>;

/// # Safety
/// The header's contract.
unsafe fn one_channel(
    material: *const srbf_material,
    n: usize,
    wo: *const srbf_vectors,
    wi: *const srbf_vectors,
    out: *const srbf_numbers_out,
    run: OneChannel,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let (wo, wi, out) = unsafe { (read(wo)?, read(wi)?, read(out)?) };
        let ([ox, oy, oz], [ix, iy, iz]) = (wo.streams(), wi.streams());
        let inputs = [ox, oy, oz, ix, iy, iz];
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, inputs, [out.stream()], object.extents())? };
        batch
            .run(|[ox, oy, oz, ix, iy, iz], [out]| run(&object.material, [ox, oy, oz], [ix, iy, iz], out))?;
        Ok(())
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
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let (wo, u, direction, pdf) = unsafe { (read(wo)?, read(u)?, read(direction)?, read(pdf)?) };
        let ([ox, oy, oz], [ux, uy, uz]) = (wo.streams(), u.streams());
        let [x, y, z] = direction.streams();
        let (inputs, outputs) = ([ox, oy, oz, ux, uy, uz], [x, y, z, pdf.stream()]);
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, inputs, outputs, object.extents())? };
        batch.run(|[ox, oy, oz, ux, uy, uz], [x, y, z, pdf]| {
            object.material.sample_pdf_pairs_into([ox, oy, oz], [ux, uy, uz], [x, y, z], pdf)
        })?;
        Ok(())
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
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let (wo, u, samples) = unsafe { (read(wo)?, read(u)?, read(samples)?) };
        let ([ox, oy, oz], [ux, uy, uz]) = (wo.streams(), u.streams());
        let inputs = [ox, oy, oz, ux, uy, uz];
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, inputs, samples.streams(), object.extents())? };
        batch.run(|[ox, oy, oz, ux, uy, uz], [x, y, z, pdf, red, green, blue]| {
            let samples = SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] };
            object.material.sample_pairs_into([ox, oy, oz], [ux, uy, uz], samples)
        })?;
        Ok(())
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
        let batch =
            unsafe { Batch::new(n, read(wi)?.streams(), read(value)?.streams(), [mixtures.extent()])? };
        let mut first = 0;
        batch.run(|wi, [red, green, blue]| {
            for i in 0..wi[0].len() {
                // SAFETY: first + i < n.
                let mixture = unsafe { mixtures.get(first + i)? };
                let wi = Vec3::new(wi[0][i], wi[1][i], wi[2][i]);
                let value = with_mixture!(AnyMixture: &mixture, m => m.evaluate(wi));
                [red[i], green[i], blue[i]] = value.to_array();
            }
            first += wi[0].len();
            Ok(())
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
        let batch =
            unsafe { Batch::new(n, read(wi)?.streams(), [read(pdf)?.stream()], [mixtures.extent()])? };
        let mut first = 0;
        batch.run(|wi, [pdf]| {
            for i in 0..wi[0].len() {
                // SAFETY: first + i < n.
                let mixture = unsafe { mixtures.get(first + i)? };
                let wi = Vec3::new(wi[0][i], wi[1][i], wi[2][i]);
                pdf[i] = with_mixture!(AnyMixture: &mixture, m => m.pdf(wi));
            }
            first += wi[0].len();
            Ok(())
        })
    })
}

/// Draws one direction from each of n mixtures.
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
        let batch =
            unsafe { Batch::new(n, read(u)?.streams(), read(samples)?.streams(), [mixtures.extent()])? };
        let mut first = 0;
        batch.run(|u, [x, y, z, pdf, red, green, blue]| {
            for i in 0..u[0].len() {
                // SAFETY: first + i < n.
                let mixture = unsafe { mixtures.get(first + i)? };
                let u = [u[0][i], u[1][i], u[2][i]];
                let sample = with_mixture!(AnyMixture: &mixture, m => draw(m, u));
                [x[i], y[i], z[i]] = sample.direction;
                pdf[i] = sample.pdf;
                [red[i], green[i], blue[i]] = sample.weight;
            }
            first += u[0].len();
            Ok(())
        })
    })
}
