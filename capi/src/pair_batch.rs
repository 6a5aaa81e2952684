//! One body for every function of n pairs, whatever makes the mixture of an outgoing direction: the arrays are checked, and core is
//! called with slices. `objects` are the bytes that no output may meet.
#![allow(unsafe_code)]

use crate::batch::sampled_and_evaluated;
use crate::batch::srbf_samples_out;
use crate::guard::Outcome;
use crate::pointers::read;
use crate::streams::{Batch, srbf_numbers_out, srbf_vectors, srbf_vectors_out};
use core::ops::Range;
use srbf_core::{Error, SamplesMut};

/// Directions as core takes them.
type In<'a> = [&'a [f32]; 3];
/// Directions or colours that core writes.
type Out<'a> = [&'a mut [f32]; 3];

/// Values of pairs (wo, wi).
///
/// # Safety
/// As all here: the header's contract of the arrays; with n = 0 they are not looked at.
pub(crate) unsafe fn evaluate(
    n: usize,
    [wo, wi]: [*const srbf_vectors; 2],
    value: *const srbf_vectors_out,
    objects: [Range<usize>; 2],
    mut call: impl FnMut(In<'_>, In<'_>, Out<'_>) -> Result<(), Error>,
) -> Outcome {
    if n == 0 {
        return Ok(());
    }
    // SAFETY: the header's contract.
    let (wo, wi, value) = unsafe { (read(wo)?, read(wi)?, read(value)?) };
    let ([ox, oy, oz], [ix, iy, iz]) = (wo.streams(), wi.streams());
    // SAFETY: the header's contract.
    let batch = unsafe { Batch::new(n, [ox, oy, oz, ix, iy, iz], value.streams(), objects)? };
    batch.run(|[ox, oy, oz, ix, iy, iz], value| call([ox, oy, oz], [ix, iy, iz], value))?;
    Ok(())
}

/// Values and densities of pairs (wo, wi).
///
/// # Safety
/// As [`evaluate`].
pub(crate) unsafe fn evaluate_and_pdf(
    n: usize,
    [wo, wi]: [*const srbf_vectors; 2],
    value: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
    objects: [Range<usize>; 2],
    mut call: impl FnMut(In<'_>, In<'_>, Out<'_>, &mut [f32]) -> Result<(), Error>,
) -> Outcome {
    if n == 0 {
        return Ok(());
    }
    // SAFETY: the header's contract.
    let (wo, wi, value, pdf) = unsafe { (read(wo)?, read(wi)?, read(value)?, read(pdf)?) };
    let ([ox, oy, oz], [ix, iy, iz]) = (wo.streams(), wi.streams());
    let [red, green, blue] = value.streams();
    let (inputs, outputs) = ([ox, oy, oz, ix, iy, iz], [red, green, blue, pdf.stream()]);
    // SAFETY: the header's contract.
    let batch = unsafe { Batch::new(n, inputs, outputs, objects)? };
    batch.run(|[ox, oy, oz, ix, iy, iz], [red, green, blue, pdf]| {
        call([ox, oy, oz], [ix, iy, iz], [red, green, blue], pdf)
    })?;
    Ok(())
}

/// Densities of pairs (wo, wi).
///
/// # Safety
/// As [`evaluate`].
pub(crate) unsafe fn pdf(
    n: usize,
    [wo, wi]: [*const srbf_vectors; 2],
    pdf: *const srbf_numbers_out,
    objects: [Range<usize>; 2],
    mut call: impl FnMut(In<'_>, In<'_>, &mut [f32]) -> Result<(), Error>,
) -> Outcome {
    if n == 0 {
        return Ok(());
    }
    // SAFETY: the header's contract.
    let (wo, wi, pdf) = unsafe { (read(wo)?, read(wi)?, read(pdf)?) };
    let ([ox, oy, oz], [ix, iy, iz]) = (wo.streams(), wi.streams());
    // SAFETY: the header's contract.
    let batch = unsafe { Batch::new(n, [ox, oy, oz, ix, iy, iz], [pdf.stream()], objects)? };
    batch.run(|[ox, oy, oz, ix, iy, iz], [pdf]| call([ox, oy, oz], [ix, iy, iz], pdf))?;
    Ok(())
}

/// Samples of outgoing directions, by three uniform numbers each: (wo, u).
///
/// # Safety
/// As [`evaluate`].
pub(crate) unsafe fn sample(
    n: usize,
    [wo, u]: [*const srbf_vectors; 2],
    samples: *const srbf_samples_out,
    objects: [Range<usize>; 2],
    mut call: impl FnMut(In<'_>, In<'_>, SamplesMut<'_>) -> Result<(), Error>,
) -> Outcome {
    if n == 0 {
        return Ok(());
    }
    // SAFETY: the header's contract.
    let (wo, u, samples) = unsafe { (read(wo)?, read(u)?, read(samples)?) };
    let ([ox, oy, oz], [ux, uy, uz]) = (wo.streams(), u.streams());
    // SAFETY: the header's contract.
    let batch = unsafe { Batch::new(n, [ox, oy, oz, ux, uy, uz], samples.streams(), objects)? };
    batch.run(|[ox, oy, oz, ux, uy, uz], [x, y, z, pdf, red, green, blue]| {
        let samples = SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] };
        call([ox, oy, oz], [ux, uy, uz], samples)
    })?;
    Ok(())
}

/// Directions with densities of outgoing directions: (wo, u).
///
/// # Safety
/// As [`evaluate`].
pub(crate) unsafe fn sample_pdf(
    n: usize,
    wo_and_u: [*const srbf_vectors; 2],
    direction: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
    objects: [Range<usize>; 2],
    call: impl FnMut(In<'_>, In<'_>, Out<'_>, &mut [f32]) -> Result<(), Error>,
) -> Outcome {
    // Two times three numbers in, three and one out.
    // SAFETY: the header's contract.
    unsafe { evaluate_and_pdf(n, wo_and_u, direction, pdf, objects, call) }
}

/// Samples of outgoing directions, and values and densities towards others: (wo, u, wi).
///
/// # Safety
/// As [`evaluate`].
pub(crate) unsafe fn sample_and_evaluate(
    n: usize,
    [wo, u, wi]: [*const srbf_vectors; 3],
    samples: *const srbf_samples_out,
    value: *const srbf_vectors_out,
    pdf: *const srbf_numbers_out,
    objects: [Range<usize>; 2],
    mut call: impl FnMut(In<'_>, In<'_>, SamplesMut<'_>, In<'_>, Out<'_>, &mut [f32]) -> Result<(), Error>,
) -> Outcome {
    if n == 0 {
        return Ok(());
    }
    // SAFETY: the header's contract.
    let (wo, u, samples) = unsafe { (read(wo)?, read(u)?, read(samples)?) };
    // SAFETY: the header's contract.
    let (wi, value, pdf) = unsafe { (read(wi)?, read(value)?, read(pdf)?) };
    let ([ox, oy, oz], [ux, uy, uz], [ix, iy, iz]) = (wo.streams(), u.streams(), wi.streams());
    let inputs = [ox, oy, oz, ux, uy, uz, ix, iy, iz];
    // SAFETY: the header's contract.
    let batch = unsafe { Batch::new(n, inputs, samples.streams_beside(value, pdf), objects)? };
    batch.run(|[ox, oy, oz, ux, uy, uz, ix, iy, iz], outputs| {
        let (samples, value, pdf) = sampled_and_evaluated(outputs);
        call([ox, oy, oz], [ux, uy, uz], samples, [ix, iy, iz], value, pdf)
    })?;
    Ok(())
}
