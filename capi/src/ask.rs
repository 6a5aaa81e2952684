//! One way to ask for n hits: of mixtures, of materials, of expanded ones.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::arrays::Arrays;
use crate::expanded::{object, srbf_expanded};
use crate::guard::{Named, guard};
use crate::material::{material, srbf_material};
use crate::mixtures::Mixtures;
use crate::pointers::read;
use crate::request::srbf_request;
use crate::status::srbf_status;
use crate::storage::{extents, mixture, srbf_mixture};
use crate::streams::BLOCK;
use core::ops::Range;
use srbf_core::{AnyMixture, Draws, Material, Request, Towards};

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
            let (any, arrays) =
                unsafe { (mixture(mixtures).of(Argument::Mixtures)?, Arrays::new(request, n, false)?) };
            extents(mixtures, any).iter().try_for_each(|place| arrays.check_object(place))?;
            // SAFETY: the header's contract.
            return unsafe {
                arrays.each(n, &mut |_, _, request| {
                    any.ask(request)?;
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
                    AnyMixture::ask_each(mixtures, request)
                })
            })
        }
    })
}

/// A part of a request.
pub(crate) fn part_of<'a>(request: &'a mut Request<'_>, part: Range<usize>) -> Request<'a> {
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
        let materials = unsafe { read(request).of(Argument::Request)? }.materials;
        let place = materials.check(n)?;
        arrays.check_between(&place, size_of::<*const srbf_material>(), materials.stride)?;
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
