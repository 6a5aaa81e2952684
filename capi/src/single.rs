//! One direction at a time.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::convert::{direction, uniform};
use crate::guard::{Named, guard};
use crate::pointers::{Out, read_array};
use crate::status::srbf_status;
use crate::storage::mixture;
use crate::storage::srbf_mixture;
use srbf_core::Sample;

/// A direction drawn from a mixture.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_sample {
    /// Incident direction, unit vector in the caller's shading frame.
    pub direction: [f32; 3],
    /// Density of the whole mixture at the direction; 1/sr. 0 where nothing was drawn, else above 0.
    pub pdf: f32,
    /// `f cos / pdf`, linear sRGB: the factor on the throughput of a path. 0 where the density is below 1.2e-38.
    pub weight: [f32; 3],
}

/// Evaluates `f cos`, the BRDF times the incident cosine, towards a direction; 1/sr.
///
/// 0 below the horizon of a hemisphere.
/// Shapes: `wi` [3], unit vector; `value` [3], linear sRGB, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_evaluate(
    mixture: *const srbf_mixture,
    wi: *const f32,
    value: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (mixture, wi, out) = unsafe {
            (
                self::mixture(mixture)?,
                read_array(wi).of(Argument::Wi)?,
                Out::<[f32; 3]>::array(value).of(Argument::Value)?,
            )
        };
        let wi = direction(wi).of(Argument::Wi)?;
        out.set(mixture.evaluate(wi).to_array());
        Ok(())
    })
}

/// Evaluates the density of `srbf_mixture_sample` at a direction; 1/sr, per solid angle.
///
/// Shapes: `wi` [3], unit vector; `pdf` one number, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_pdf(
    mixture: *const srbf_mixture,
    wi: *const f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (mixture, wi, out) = unsafe {
            (self::mixture(mixture)?, read_array(wi).of(Argument::Wi)?, Out::new(pdf).of(Argument::Pdf)?)
        };
        let wi = direction(wi).of(Argument::Wi)?;
        out.set(mixture.pdf(wi));
        Ok(())
    })
}

/// Evaluates value and density in one pass, for multiple importance sampling.
///
/// Shapes: `wi` [3], unit vector; `value` [3], `f cos` in linear sRGB; `pdf` one number; both overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_evaluate_and_pdf(
    mixture: *const srbf_mixture,
    wi: *const f32,
    value: *mut f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (mixture, wi, value_out, pdf_out) = unsafe {
            (
                self::mixture(mixture)?,
                read_array(wi).of(Argument::Wi)?,
                Out::<[f32; 3]>::array(value).of(Argument::Value)?,
                Out::new(pdf).of(Argument::Pdf)?,
            )
        };
        let wi = direction(wi).of(Argument::Wi)?;
        let (value, pdf) = mixture.evaluate_and_pdf(wi);
        value_out.set(value.to_array());
        pdf_out.set(pdf);
        Ok(())
    })
}

/// Draws an incident direction from the density of a mixture; no sample is wasted below the horizon.
///
/// A mixture that reflects nothing gives the normal with density 0 and weight 0, and `SRBF_STATUS_OK`.
/// Shapes: `u` [3], uniform numbers in [0, 1): the first chooses the lobe, the others the direction in it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample(
    mixture: *const srbf_mixture,
    u: *const f32,
    sample: *mut srbf_sample,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (mixture, u, out) = unsafe {
            (self::mixture(mixture)?, read_array(u).of(Argument::U)?, Out::new(sample).of(Argument::Sample)?)
        };
        let u = uniform(u).of(Argument::U)?;
        out.set(drawn(mixture.sample(u)));
        Ok(())
    })
}

/// Draws an incident direction, and evaluates value and density towards another one: what next-event estimation needs at every hit.
///
/// Shapes: `u` and `sample` as in `srbf_mixture_sample`; `wi`, `value` and `pdf` as in `srbf_mixture_evaluate_and_pdf`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample_and_evaluate(
    mixture: *const srbf_mixture,
    u: *const f32,
    sample: *mut srbf_sample,
    wi: *const f32,
    value: *mut f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (mixture, u, wi) = unsafe {
            (self::mixture(mixture)?, read_array(u).of(Argument::U)?, read_array(wi).of(Argument::Wi)?)
        };
        // SAFETY: the header's contract.
        let (sample_out, value_out, pdf_out) = unsafe {
            (
                Out::new(sample).of(Argument::Sample)?,
                Out::<[f32; 3]>::array(value).of(Argument::Value)?,
                Out::new(pdf).of(Argument::Pdf)?,
            )
        };
        let (u, wi) = (uniform(u).of(Argument::U)?, direction(wi).of(Argument::Wi)?);
        let (sample, (value, pdf)) = mixture.sample_and_evaluate(u, wi);
        sample_out.set(drawn(sample));
        value_out.set(value.to_array());
        pdf_out.set(pdf);
        Ok(())
    })
}

/// A sample, or the numbers of a black mixture that the header states.
#[inline(always)]
pub(crate) fn drawn(sample: Option<Sample>) -> srbf_sample {
    match sample {
        Some(Sample { direction, pdf, weight }) => {
            srbf_sample { direction: direction.to_array(), pdf, weight: weight.to_array() }
        }
        None => srbf_sample { direction: [0.0, 0.0, 1.0], pdf: 0.0, weight: [0.0; 3] },
    }
}
