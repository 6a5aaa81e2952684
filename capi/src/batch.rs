//! Batches: n directions, one mixture.
#![allow(unsafe_code)]

use crate::guard::guard;
use crate::pointers::read;
use crate::status::srbf_status;
use crate::storage::srbf_mixture;
use crate::storage::{extents, mixture, with_mixture};
use crate::streams::{Batch, srbf_numbers_out, srbf_vectors, srbf_vectors_out};
use srbf_core::SamplesMut;

/// Where n samples go; see `srbf_sample`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_samples_out {
    /// Incident directions, unit vectors in the caller's shading frame.
    pub direction: srbf_vectors_out,
    /// Density of the whole mixture at the direction; 1/sr. 0 where nothing was drawn, else above 0.
    pub pdf: srbf_numbers_out,
    /// `f cos / pdf`, linear sRGB.
    pub weight: srbf_vectors_out,
}

impl srbf_samples_out {
    pub(crate) fn streams(&self) -> [crate::streams::Stream; 7] {
        let ([x, y, z], pdf) = (self.direction.streams(), self.pdf.stream());
        let [red, green, blue] = self.weight.streams();
        [x, y, z, pdf, red, green, blue]
    }

    /// Where samples go, and values and densities towards other directions.
    pub(crate) fn streams_beside(
        &self,
        value: srbf_vectors_out,
        pdf: srbf_numbers_out,
    ) -> [crate::streams::Stream; 11] {
        let [x, y, z, density, w0, w1, w2] = self.streams();
        let [red, green, blue] = value.streams();
        [x, y, z, density, w0, w1, w2, red, green, blue, pdf.stream()]
    }
}

/// The slices of `srbf_samples_out::streams_beside`, as core takes them.
pub(crate) fn sampled_and_evaluated(
    [x, y, z, density, w0, w1, w2, red, green, blue, pdf]: [&mut [f32]; 11],
) -> (SamplesMut<'_>, [&mut [f32]; 3], &mut [f32]) {
    let samples = SamplesMut { direction: [x, y, z], pdf: density, weight: [w0, w1, w2] };
    (samples, [red, green, blue], pdf)
}

/// Evaluates `f cos` towards n directions; 1/sr. The values of `srbf_mixture_evaluate` within rounding.
///
/// Shapes: `wi` n unit vectors; `value` n colours in linear sRGB, overwritten. n = 0 looks at no pointer but the
/// mixture. What is not a unit vector gives an unspecified value; the others are not touched by it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_evaluate_into(
    mixture: *const srbf_mixture,
    n: usize,
    wi: *const srbf_vectors,
    value: *const srbf_vectors_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let any = unsafe { self::mixture(mixture)? };
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let batch =
            unsafe { Batch::new(n, read(wi)?.streams(), read(value)?.streams(), extents(mixture, &any))? };
        with_mixture!(AnyMixture: &any, m => batch.run(|wi, value| m.evaluate_into(wi, value)))?;
        Ok(())
    })
}

/// Evaluates the density of sampling at n directions; 1/sr. The values of `srbf_mixture_pdf` within rounding.
///
/// Shapes and directions as in `srbf_mixture_evaluate_into`; `pdf` n numbers, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_pdf_into(
    mixture: *const srbf_mixture,
    n: usize,
    wi: *const srbf_vectors,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let any = unsafe { self::mixture(mixture)? };
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let batch =
            unsafe { Batch::new(n, read(wi)?.streams(), [read(pdf)?.stream()], extents(mixture, &any))? };
        with_mixture!(AnyMixture: &any, m => batch.run(|wi, [pdf]| m.pdf_into(wi, pdf)))?;
        Ok(())
    })
}

/// Evaluates `f cos` and the density of sampling at n directions; 1/sr. The values of `srbf_mixture_evaluate_and_pdf` within
/// rounding.
///
/// Shapes and directions as in `srbf_mixture_evaluate_into`; `value` n colours and `pdf` n numbers, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_evaluate_and_pdf_into(
    mixture: *const srbf_mixture,
    n: usize,
    wi: *const srbf_vectors,
    value: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let any = unsafe { self::mixture(mixture)? };
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let (wi, value, pdf) = unsafe { (read(wi)?, read(value)?, read(pdf)?) };
        let [red, green, blue] = value.streams();
        let outputs = [red, green, blue, pdf.stream()];
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, wi.streams(), outputs, extents(mixture, &any))? };
        with_mixture!(AnyMixture: &any, m => batch.run(|wi, [red, green, blue, pdf]| {
            m.evaluate_and_pdf_into(wi, [red, green, blue], pdf)
        }))?;
        Ok(())
    })
}

/// Draws n directions with density and weight, in one pass.
///
/// Shapes: `u` n times three uniform numbers in [0, 1): the first chooses the lobe, the others the direction in it;
/// `samples` n of each, overwritten. Numbers outside give an unspecified sample. n = 0 as in
/// `srbf_mixture_evaluate_into`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample_into(
    mixture: *const srbf_mixture,
    n: usize,
    u: *const srbf_vectors,
    samples: *const srbf_samples_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let any = unsafe { self::mixture(mixture)? };
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let batch =
            unsafe { Batch::new(n, read(u)?.streams(), read(samples)?.streams(), extents(mixture, &any))? };
        with_mixture!(AnyMixture: &any, m => batch.run(|u, [x, y, z, pdf, red, green, blue]| {
            m.sample_into(u, SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] })
        }))?;
        Ok(())
    })
}

/// Draws n directions with their density, without a weight.
///
/// The samples of `srbf_mixture_sample_into`, for callers that take the value elsewhere, in less time.
/// Shapes: `u` as for `srbf_mixture_sample_into`; `direction` n unit vectors and `pdf` n numbers, overwritten. n = 0 as in
/// `srbf_mixture_evaluate_into`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample_pdf_into(
    mixture: *const srbf_mixture,
    n: usize,
    u: *const srbf_vectors,
    direction: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let any = unsafe { self::mixture(mixture)? };
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let (u, direction, pdf) = unsafe { (read(u)?, read(direction)?, read(pdf)?) };
        let [x, y, z] = direction.streams();
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, u.streams(), [x, y, z, pdf.stream()], extents(mixture, &any))? };
        with_mixture!(AnyMixture: &any, m => batch.run(|u, [x, y, z, pdf]| m.sample_pdf_into(u, [x, y, z], pdf)))?;
        Ok(())
    })
}

/// Draws n directions with density and weight, and evaluates value and density towards n others: what next-event estimation needs.
///
/// Shapes: `u` and `samples` as in `srbf_mixture_sample_into`; `wi`, `value` and `pdf` as in `srbf_mixture_evaluate_and_pdf_into`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample_and_evaluate_into(
    mixture: *const srbf_mixture,
    n: usize,
    u: *const srbf_vectors,
    samples: *const srbf_samples_out,
    wi: *const srbf_vectors,
    value: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let any = unsafe { self::mixture(mixture)? };
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let (u, samples) = unsafe { (read(u)?, read(samples)?) };
        // SAFETY: the header's contract.
        let (wi, value, pdf) = unsafe { (read(wi)?, read(value)?, read(pdf)?) };
        let ([ux, uy, uz], [ix, iy, iz]) = (u.streams(), wi.streams());
        let outputs = samples.streams_beside(value, pdf);
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, [ux, uy, uz, ix, iy, iz], outputs, extents(mixture, &any))? };
        with_mixture!(AnyMixture: &any, m => batch.run(|[ux, uy, uz, ix, iy, iz], outputs| {
            let (samples, value, pdf) = sampled_and_evaluated(outputs);
            m.sample_and_evaluate_into([ux, uy, uz], samples, [ix, iy, iz], value, pdf)
        }))?;
        Ok(())
    })
}
