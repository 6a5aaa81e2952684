//! One way to ask for n hits: outputs that are given are outputs that are wanted.
#![allow(unsafe_code)]

use crate::arrays::Arrays;
use crate::expanded::{object, srbf_expanded};
use crate::guard::{Failure, guard};
use crate::material::{material, srbf_material};
use crate::mixtures::Mixtures;
use crate::pointers::{check, check_extent, read};
use crate::status::{SRBF_STATUS_STRIDE, srbf_status};
use crate::storage::{extents, mixture, srbf_mixture, with_mixture};
use crate::streams::{BLOCK, srbf_numbers_out, srbf_samples_out, srbf_vectors, srbf_vectors_out};
use core::ops::Range;
use srbf_core::{Draws, Material, Mixture, Request, Towards};

/// The inputs and the wanted outputs for each of n hits. Start from zeros, set `size`, the inputs and the wanted outputs.
///
/// `sizeof(srbf_request)` in `size` lets later versions ask for more. An output whose first pointer is NULL is not wanted:
/// `value.x`, `pdf.values`, `samples.direction.x`, `samples.pdf.values`, `samples.weight.x`. Inputs that no output needs are not
/// looked at. Each array has n elements; outputs are overwritten, and may overlap nothing, inputs may overlap each other.
///
/// A call checks the arrays of what is asked, and no others, before it writes anything. No pointer may be NULL or misaligned, and
/// arrays end within the address space. No number of an output may lie upon another output, an input, the request, the object or
/// its bytes. Numbers themselves are not looked at.
///
/// Where nothing is reflected, and for a `wo` that is no unit vector, values and densities are 0 and the normal is drawn with density
/// 0. A `wi` that is no unit vector gives an unspecified value, and so does a number `u` outside [0, 1); others are not touched by it.
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

/// Draws and evaluates for n hits of mixtures: what is given is what is wanted.
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
