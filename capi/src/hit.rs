//! One hit on a material, without a mixture.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::convert::{direction, uniform};
use crate::guard::{Named, guard};
use crate::material::{material, srbf_material};
use crate::pointers::{Out, read_array};
use crate::single::{drawn, srbf_sample};
use crate::status::srbf_status;

/// Evaluates `f cos` for an outgoing and an incident direction; 1/sr.
///
/// The values of `srbf_material_prepare` and `srbf_mixture_evaluate` but for rounding, without a mixture: for a few incident
/// directions of one `wo` it takes less time. An outgoing direction below the horizon reflects nothing.
/// Shapes: `wo` and `wi` [3], unit vectors in the shading frame; `value` [3], linear sRGB, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_evaluate(
    material: *const srbf_material,
    wo: *const f32,
    wi: *const f32,
    value: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        // SAFETY: the header's contract.
        let (wo, wi, out) = unsafe {
            (
                read_array(wo).of(Argument::Wo)?,
                read_array(wi).of(Argument::Wi)?,
                Out::<[f32; 3]>::array(value).of(Argument::Value)?,
            )
        };
        let (wo, wi) = (direction(wo).of(Argument::Wo)?, direction(wi).of(Argument::Wi)?);
        out.set(object.material.evaluate(wo, wi).to_array());
        Ok(())
    })
}

/// Evaluates the density of `srbf_material_sample` at an incident direction; 1/sr.
///
/// Shapes: `wo` and `wi` as in `srbf_material_evaluate`; `pdf` one number, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_pdf(
    material: *const srbf_material,
    wo: *const f32,
    wi: *const f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        // SAFETY: the header's contract.
        let (wo, wi, out) = unsafe {
            (
                read_array(wo).of(Argument::Wo)?,
                read_array(wi).of(Argument::Wi)?,
                Out::new(pdf).of(Argument::Pdf)?,
            )
        };
        let (wo, wi) = (direction(wo).of(Argument::Wo)?, direction(wi).of(Argument::Wi)?);
        out.set(object.material.pdf(wo, wi));
        Ok(())
    })
}

/// Evaluates value and density in one pass, for multiple importance sampling.
///
/// Shapes: `wo` and `wi` as in `srbf_material_evaluate`; `value` [3], linear sRGB, and `pdf`, one number; both overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_evaluate_and_pdf(
    material: *const srbf_material,
    wo: *const f32,
    wi: *const f32,
    value: *mut f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        // SAFETY: the header's contract.
        let (wo, wi) = unsafe { (read_array(wo).of(Argument::Wo)?, read_array(wi).of(Argument::Wi)?) };
        // SAFETY: the header's contract.
        let (value_out, pdf_out) =
            unsafe { (Out::<[f32; 3]>::array(value).of(Argument::Value)?, Out::new(pdf).of(Argument::Pdf)?) };
        let (value, pdf) = object
            .material
            .evaluate_and_pdf(direction(wo).of(Argument::Wo)?, direction(wi).of(Argument::Wi)?);
        value_out.set(value.to_array());
        pdf_out.set(pdf);
        Ok(())
    })
}

/// Draws an incident direction for an outgoing one; no sample is wasted below the horizon.
///
/// Where nothing is reflected it gives the normal with density 0 and weight 0, and `SRBF_STATUS_OK`.
/// Shapes: `wo` [3], unit vector; `u` [3], uniform numbers in [0, 1): the first chooses the lobe, the others the direction in it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_sample(
    material: *const srbf_material,
    wo: *const f32,
    u: *const f32,
    sample: *mut srbf_sample,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        // SAFETY: the header's contract.
        let (wo, u, out) = unsafe {
            (
                read_array(wo).of(Argument::Wo)?,
                read_array(u).of(Argument::U)?,
                Out::new(sample).of(Argument::Sample)?,
            )
        };
        let (wo, u) = (direction(wo).of(Argument::Wo)?, uniform(u).of(Argument::U)?);
        out.set(drawn(object.material.sample(wo, u)));
        Ok(())
    })
}

/// Draws an incident direction, and evaluates value and density towards another one: what next-event estimation needs at every hit.
///
/// Shapes: `wo`, `u` and `sample` as in `srbf_material_sample`; `wi`, `value` and `pdf` as in `srbf_material_evaluate_and_pdf`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_sample_and_evaluate(
    material: *const srbf_material,
    wo: *const f32,
    u: *const f32,
    sample: *mut srbf_sample,
    wi: *const f32,
    value: *mut f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::material(material)? };
        // SAFETY: the header's contract.
        let (wo, u, wi) = unsafe {
            (
                read_array(wo).of(Argument::Wo)?,
                read_array(u).of(Argument::U)?,
                read_array(wi).of(Argument::Wi)?,
            )
        };
        // SAFETY: the header's contract.
        let (sample_out, value_out, pdf_out) = unsafe {
            (
                Out::new(sample).of(Argument::Sample)?,
                Out::<[f32; 3]>::array(value).of(Argument::Value)?,
                Out::new(pdf).of(Argument::Pdf)?,
            )
        };
        let (wo, u, wi) =
            (direction(wo).of(Argument::Wo)?, uniform(u).of(Argument::U)?, direction(wi).of(Argument::Wi)?);
        let (sample, (value, pdf)) = object.material.sample_and_evaluate(wo, u, wi);
        sample_out.set(drawn(sample));
        value_out.set(value.to_array());
        pdf_out.set(pdf);
        Ok(())
    })
}
