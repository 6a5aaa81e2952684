//! Blends: several materials at one hit, each with a weight and a tint.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::arrays::Arrays;
use crate::ask::part_of;
use crate::convert::{direction, uniform};
use crate::guard::{Failure, Named, guard};
use crate::material::{material, srbf_material};
use crate::pointers::{Out, check, check_extent, read, read_array};
use crate::request::srbf_request;
use crate::single::{drawn, srbf_sample};
use crate::status::{SRBF_STATUS_ARGUMENT, SRBF_STATUS_STRIDE, srbf_status};
use crate::storage::{extents, mixture, srbf_mixture};
use crate::streams::BLOCK;
use srbf_core::{Blend, BlendPart, MAX_BLEND, fresnel};

/// Most parts of a blend.
pub const SRBF_MAX_BLEND: usize = 8;

const _: () = assert!(SRBF_MAX_BLEND == MAX_BLEND);

/// A part of a blend: a material or a mixture, with its weight and a tint. Start from zeros.
///
/// A blend is an array of 1 to `SRBF_MAX_BLEND` parts: its value is the sum of their values, each times weight and tint. Weights need not sum
/// to 1. A part of weight 0, or of a black tint, costs nothing. Where one part is left, a hit is one on that part alone.
///
/// Every call that takes parts refuses by `SRBF_STATUS_ARGUMENT` none and too many. It refuses by
/// `SRBF_STATUS_WEIGHT` a weight, a tint or a coat out of its range, and weights of which none is above 0.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_blend_part {
    /// The material; or NULL.
    pub material: *const srbf_material,
    /// Looked at without a material: a mixture that has the outgoing direction of the call, or one of the caller's lobes.
    pub mixture: *const srbf_mixture,
    /// From 0 to 1000.
    pub weight: f32,
    /// By this the channels of its values are multiplied, linear sRGB, from 0 to 1000.
    pub tint: [f32; 3],
    /// Refractive index of a clear coat above it, from 1 to 10; 0 for none.
    ///
    /// Values are multiplied by its transmittance for both directions: 1 minus `srbf_fresnel` of each. Light that the coat reflects is
    /// a part of its own.
    pub coat: f32,
}

/// A part as core has it.
///
/// # Safety
/// The header's contract.
unsafe fn made<'a>(of: &srbf_blend_part) -> Result<BlendPart<'a>, Failure> {
    let part = if of.material.is_null() {
        // SAFETY: the caller's word.
        BlendPart::of_mixture(unsafe { mixture(of.mixture)? }, of.weight)
    } else {
        // SAFETY: the caller's word.
        let object: &'a srbf_material = unsafe { material(of.material)? };
        BlendPart::new(&object.material, of.weight)
    };
    let part = part.tinted(of.tint);
    Ok(if of.coat == 0.0 { part } else { part.coated(of.coat) })
}

/// The parts of one hit.
struct Parts<'a> {
    room: [BlendPart<'a>; MAX_BLEND],
    count: usize,
}

impl<'a> Parts<'a> {
    /// Reads them.
    ///
    /// # Safety
    /// The header's contract: `count` parts are readable.
    #[inline(never)]
    unsafe fn read(parts: *const srbf_blend_part, count: usize) -> Result<Self, Failure> {
        if count == 0 || count > MAX_BLEND {
            return Err(SRBF_STATUS_ARGUMENT.into());
        }
        check(parts).of(Argument::Parts)?;
        check_extent(parts.addr(), count, size_of::<srbf_blend_part>())?;
        // SAFETY: the caller's word; checked above.
        let first = unsafe { made(&*parts)? };
        let mut room = [first; MAX_BLEND];
        for (k, to) in room.iter_mut().enumerate().take(count).skip(1) {
            // SAFETY: as above.
            *to = unsafe { made(&*parts.add(k))? };
        }
        Ok(Self { room, count })
    }

    /// Not inlined: a call each is less text than the checks of each.
    #[inline(never)]
    fn blend(&'a self) -> Result<Blend<'a>, Failure> {
        Ok(Blend::new(&self.room[..self.count])?)
    }
}

/// Share of the light that the smooth face of a dielectric reflects, of unpolarised light from outside, by Fresnel's equations.
///
/// `index`: its refractive index, from 1; `cosine`: of the direction from the normal. Any other numbers give an unspecified one.
#[unsafe(no_mangle)]
pub extern "C" fn srbf_fresnel(index: f32, cosine: f32) -> f32 {
    fresnel(index, cosine)
}

/// Integrates `f cos` of a blend over all incident directions, in closed form; below a coat it is a bound from above.
///
/// Shapes: `parts` [part_count]; `wo` [3], unit vector in the shading frame; `albedo` [3], linear sRGB, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_blend_albedo(
    parts: *const srbf_blend_part,
    part_count: usize,
    wo: *const f32,
    albedo: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (parts, wo, out) = unsafe {
            (
                Parts::read(parts, part_count)?,
                read_array(wo).of(Argument::Wo)?,
                Out::<[f32; 3]>::array(albedo).of(Argument::Albedo)?,
            )
        };
        out.set(parts.blend()?.albedo(direction(wo).of(Argument::Wo)?).to_array());
        Ok(())
    })
}

/// Evaluates `f cos` of a blend and the density of `srbf_blend_sample` in one pass; 1/sr.
///
/// Shapes: `parts` [part_count]; `wo` and `wi` [3], unit vectors in the shading frame; `value` [3], linear sRGB, and `pdf`, one number; both
/// overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_blend_evaluate_and_pdf(
    parts: *const srbf_blend_part,
    part_count: usize,
    wo: *const f32,
    wi: *const f32,
    value: *mut f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (parts, wo, wi) = unsafe {
            (
                Parts::read(parts, part_count)?,
                read_array(wo).of(Argument::Wo)?,
                read_array(wi).of(Argument::Wi)?,
            )
        };
        // SAFETY: the header's contract.
        let (value_out, pdf_out) =
            unsafe { (Out::<[f32; 3]>::array(value).of(Argument::Value)?, Out::new(pdf).of(Argument::Pdf)?) };
        let (value, pdf) =
            parts.blend()?.evaluate_and_pdf(direction(wo).of(Argument::Wo)?, direction(wi).of(Argument::Wi)?);
        value_out.set(value.to_array());
        pdf_out.set(pdf);
        Ok(())
    })
}

/// Draws an incident direction of a blend: a part by weight, tint and power, then of that part.
///
/// Where nothing is reflected it gives the normal with density 0 and weight 0, and `SRBF_STATUS_OK`.
/// Shapes: `parts` [part_count]; `wo` [3], unit vector; `u` [3], uniform numbers in [0, 1): the first chooses the part and the lobe, the others the
/// direction in it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_blend_sample(
    parts: *const srbf_blend_part,
    part_count: usize,
    wo: *const f32,
    u: *const f32,
    sample: *mut srbf_sample,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let parts = unsafe { Parts::read(parts, part_count)? };
        // SAFETY: the header's contract.
        let (wo, u, out) = unsafe {
            (
                read_array(wo).of(Argument::Wo)?,
                read_array(u).of(Argument::U)?,
                Out::new(sample).of(Argument::Sample)?,
            )
        };
        let (wo, u) = (direction(wo).of(Argument::Wo)?, uniform(u).of(Argument::U)?);
        out.set(drawn(parts.blend()?.sample(wo, u)));
        Ok(())
    })
}

/// Draws an incident direction of a blend, and evaluates value and density towards another one: what next-event estimation needs at every
/// hit.
///
/// Shapes: `parts`, `wo`, `u` and `sample` as in `srbf_blend_sample`; `wi`, `value` and `pdf` as in `srbf_blend_evaluate_and_pdf`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_blend_sample_and_evaluate(
    parts: *const srbf_blend_part,
    part_count: usize,
    wo: *const f32,
    u: *const f32,
    sample: *mut srbf_sample,
    wi: *const f32,
    value: *mut f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let parts = unsafe { Parts::read(parts, part_count)? };
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
        let (sample, (value, pdf)) = parts.blend()?.sample_and_evaluate(wo, u, wi);
        sample_out.set(drawn(sample));
        value_out.set(value.to_array());
        pdf_out.set(pdf);
        Ok(())
    })
}

/// Chooses one part of a blend at random, and tells the number that is left of `u` for its draw.
///
/// A blend of that part alone has the values of the whole in the mean, at the cost of one hit. Its densities are its own.
/// All that is asked at a hit has to be asked of the one part that was chosen for it.
/// Shapes: `parts` [part_count]; `u` one uniform number in [0, 1); `part` one part and `left` one number in [0, 1), both overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_blend_choose(
    parts: *const srbf_blend_part,
    part_count: usize,
    u: f32,
    part: *mut srbf_blend_part,
    left: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let all = unsafe { Parts::read(parts, part_count)? };
        // SAFETY: the header's contract.
        let (part_out, left_out) =
            unsafe { (Out::new(part).of(Argument::Part)?, Out::new(left).of(Argument::Left)?) };
        let [u] = uniform([u]).of(Argument::U)?;
        let (place, chosen, left) = all.blend()?.choose(u);
        // SAFETY: as above; the place is below the count.
        let of = unsafe { read(parts.add(place))? };
        part_out.set(srbf_blend_part { weight: chosen.weight(), tint: chosen.tint().to_array(), ..of });
        left_out.set(left);
        Ok(())
    })
}

/// Draws and evaluates for n hits of blends, each with an outgoing direction of its own: outputs that are given are wanted.
///
/// The parts of hit i begin at `(const char *)parts + i * stride`; with a stride of 0 all hits have the same. The answers of
/// `srbf_blend_sample_and_evaluate` within rounding, in less time.
/// Shapes: `parts` [n][part_count], `stride` bytes from one hit to the next: 0, or a multiple of their alignment and at least their size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_blend_ask(
    parts: *const srbf_blend_part,
    part_count: usize,
    stride: usize,
    n: usize,
    request: *const srbf_request,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let first = unsafe { Parts::read(parts, part_count)? };
        // SAFETY: the header's contract.
        let arrays = unsafe { Arrays::new(request, n, true)? };
        let size = part_count * size_of::<srbf_blend_part>();
        let hits = if stride == 0 { 1 } else { n };
        if stride != 0 && (stride < size || !stride.is_multiple_of(align_of::<srbf_blend_part>())) {
            return Err(SRBF_STATUS_STRIDE.into());
        }
        check_extent(parts.addr(), hits, stride.max(size))?;
        let place = parts.addr()..parts.addr() + (hits - 1) * stride + size;
        if stride == 0 {
            arrays.check_object(&place)?;
        } else {
            arrays.check_between(&place, size, stride)?;
        }
        for i in 0..hits {
            // SAFETY: the header's contract; the extent has been checked.
            unsafe { check_hit(parts.byte_add(i * stride), part_count, &arrays)? };
        }
        let blend = first.blend()?;
        let mut room = [first.room[0]; 2 * BLOCK];
        let together = (room.len() / part_count).min(BLOCK);
        // One call for both: its text is long.
        let most = if stride == 0 { n } else { BLOCK };
        // SAFETY: the header's contract.
        unsafe {
            arrays.each(most, &mut |hits, wo, mut request| {
                if stride == 0 {
                    blend.ask(wo, request)?;
                    return Ok(());
                }
                for from in (0..hits.len()).step_by(together) {
                    let part = from..(from + together).min(hits.len());
                    for (i, to) in part.clone().zip(room.chunks_exact_mut(part_count)) {
                        let of = parts.byte_add((hits.start + i) * stride);
                        for (k, to) in to.iter_mut().enumerate() {
                            *to = made(&*of.add(k))?;
                        }
                    }
                    let mut blends = [blend; BLOCK];
                    for (blend, parts) in
                        blends.iter_mut().zip(room.chunks_exact(part_count)).take(part.len())
                    {
                        *blend = Blend::new(parts)?;
                    }
                    let wo = wo.map(|s| &s[part.clone()]);
                    Blend::ask_each(&blends[..part.len()], wo, part_of(&mut request, part))?;
                }
                Ok(())
            })
        }
    })
}

/// Checks the parts of a hit, and that no output lies upon one of their objects.
///
/// # Safety
/// The header's contract: `count` parts are readable.
unsafe fn check_hit(parts: *const srbf_blend_part, count: usize, arrays: &Arrays<'_>) -> Result<(), Failure> {
    // SAFETY: the caller's word.
    unsafe { Parts::read(parts, count)? }.blend()?;
    for k in 0..count {
        // SAFETY: as above.
        let of = unsafe { read(parts.add(k))? };
        let places = if of.material.is_null() {
            // SAFETY: as above; `read` has looked at it.
            extents(of.mixture, unsafe { mixture(of.mixture)? })
        } else {
            // SAFETY: as above.
            unsafe { material(of.material)? }.extents()
        };
        places.iter().try_for_each(|place| arrays.check_object(place))?;
    }
    Ok(())
}
