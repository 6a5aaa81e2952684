//! Light and material together by even sums, which two rays correct.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::convert::{direction, uniform};
use crate::environment::{Map, axes, object};
use crate::guard::{Named, Outcome, guard};
use crate::pointers::{Out, read, read_array, slice};
use crate::storage::mixture;
use crate::{
    SRBF_STATUS_ARGUMENT, SRBF_STATUS_UNIFORM, srbf_environment, srbf_mixture, srbf_sample, srbf_status,
};
use core::mem::offset_of;
use srbf_core::{LIGHT_BLOCK, LightBlock, LightSource, MAX_REFLECT_RAYS, Reflection, Sample, Vec3};

/// Samples of the light in a block.
pub const SRBF_LIGHT_BLOCK: usize = 16;
/// Most directions of the lobes of `srbf_mixture_reflect`.
pub const SRBF_MAX_REFLECT_RAYS: usize = 16;

const _: () = assert!(SRBF_LIGHT_BLOCK == LIGHT_BLOCK && SRBF_MAX_REFLECT_RAYS == MAX_REFLECT_RAYS);

/// Sixteen samples of an environment as rows: what `srbf_mixture_reflect` reads. A block at a multiple of 64 is the fastest.
///
/// Blocks are made before rendering, as many as the caller has memory for: a *tile* of some thousand, of the points of one evenly
/// spread sequence, serves all pixels. Where sample i of a pixel takes block i, or i with some bits flipped, the pixel's blocks
/// are evenly spread too.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_light_block {
    /// Unit vectors in the world, towards the light: x, y, z.
    pub direction: [[f32; 16]; 3],
    /// Radiance from there over the density: red, green, blue; linear sRGB.
    pub light: [[f32; 16]; 3],
    /// Densities; 1/sr.
    pub pdf: [f32; 16],
}

const _: () = assert!(
    size_of::<srbf_light_block>() == size_of::<LightBlock>()
        && offset_of!(srbf_light_block, light) == offset_of!(LightBlock, light)
        && offset_of!(srbf_light_block, pdf) == offset_of!(LightBlock, pdf)
);

/// What light a surface reflects, but for two rays: see `srbf_mixture_reflect`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_reflection {
    /// The path's own ray, drawn from the mixture; density 0 where that reflects nothing.
    pub ray: srbf_sample,
    /// Unit vector in the world, towards the light: where the shadow ray goes; all 0 where none is needed.
    pub shadow: [f32; 3],
    /// What `f cos` towards the ray is multiplied by to be the light from there; linear sRGB.
    pub ray_light: [f32; 3],
    /// Likewise towards the shadow ray.
    pub shadow_light: [f32; 3],
    /// What radiance along the ray is multiplied by to be `ray_light`; sr.
    pub ray_factor: f32,
    /// Likewise of the shadow ray.
    pub shadow_factor: f32,
    /// `f cos` of the mixture towards the ray; 1/sr.
    pub ray_value: [f32; 3],
    /// Likewise towards the shadow ray.
    pub shadow_value: [f32; 3],
    /// The mean of all directions of the block, without shadows; linear sRGB, in the unit of the map.
    pub block_sum: [f32; 3],
    /// Likewise of the lobes.
    pub ray_sum: [f32; 3],
}

impl srbf_reflection {
    fn from_core(r: &Reflection) -> Self {
        let none = Sample { direction: Vec3::Z, pdf: 0.0, weight: Vec3::ZERO };
        let Sample { direction, pdf, weight } = r.ray.unwrap_or(none);
        Self {
            ray: srbf_sample { direction: direction.to_array(), pdf, weight: weight.to_array() },
            shadow: r.shadow.unwrap_or(Vec3::ZERO).to_array(),
            ray_light: r.ray_light.to_array(),
            shadow_light: r.shadow_light.to_array(),
            ray_factor: r.ray_factor,
            shadow_factor: r.shadow_factor,
            ray_value: r.ray_value.to_array(),
            shadow_value: r.shadow_value.to_array(),
            block_sum: r.block_sum.to_array(),
            ray_sum: r.ray_sum.to_array(),
        }
    }

    pub(crate) fn to_core(self) -> Reflection {
        let v = Vec3::from_array;
        let srbf_sample { direction, pdf, weight } = self.ray;
        Reflection {
            ray: (pdf > 0.0).then(|| Sample { direction: v(direction), pdf, weight: v(weight) }),
            shadow: (self.shadow != [0.0; 3]).then(|| v(self.shadow)),
            ray_light: v(self.ray_light),
            shadow_light: v(self.shadow_light),
            ray_factor: self.ray_factor,
            shadow_factor: self.shadow_factor,
            shadow_value: v(self.shadow_value),
            ray_value: v(self.ray_value),
            block_sum: v(self.block_sum),
            ray_sum: v(self.ray_sum),
        }
    }
}

/// Draws a block of samples of the light.
///
/// Shapes: `u` [3][16], uniform numbers in [0, 1): the first of all samples, then the second, then the third; `block` one,
/// overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_light_block_draw(
    environment: *const srbf_environment,
    u: *const f32,
    block: *mut srbf_light_block,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        unsafe { draw_block(&Map(object(environment)?), u, block) }
    })
}

/// Draws a block of a light.
///
/// # Safety
/// The header's contract of [`srbf_light_block_draw`].
pub(crate) unsafe fn draw_block(
    light: &dyn LightSource,
    u: *const f32,
    block: *mut srbf_light_block,
) -> Outcome {
    // SAFETY: the header's contract.
    let (u, out) = unsafe { (read_array::<48>(u).of(Argument::U)?, Out::new(block).of(Argument::Block)?) };
    if !u.iter().all(|u| (0.0..1.0).contains(u)) {
        return Err(SRBF_STATUS_UNIFORM.into());
    }
    let row = |k: usize| core::array::from_fn(|i| u[16 * k + i]);
    let drawn = LightBlock::new(&light, [&row(0), &row(1), &row(2)]);
    out.set(srbf_light_block { direction: drawn.direction, light: drawn.light, pdf: drawn.pdf });
    Ok(())
}

/// Draws the ray that a path goes on along, and a shadow ray, for the light of an environment: where nothing is in the way the
/// reflected light is a sum over all directions of the block and all of `u`; with evenly spread numbers it is nearly exact.
///
/// `srbf_reflection_light` gives the light when both rays have been followed. Its mean is the integral of radiance times `f cos`
/// over directions that are not hidden; block, `u` and `choice` have to be independent of each other. Most of the light has to be
/// in sight for it to be faster than one sample of lobes and light each. Shapes: `block` from `srbf_light_block_draw`; `frame`
/// [9], tangent, bitangent and normal of the shading frame in the world, unit vectors at right angles; `flat` [3], the unit normal
/// of the surface itself, below which light counts nothing; `u` [3][count], `count` from 1 to 16, 8 serve well, uniform numbers in
/// [0, 1): the first of all directions of the lobes, then the second, then the third; the first direction is the path's own ray,
/// the others may be its shifts along a lattice; `choice` one more; `reflection` one, overwritten. Status: `SRBF_STATUS_ARGUMENT`
/// for a count out of range; `SRBF_STATUS_AMPLITUDE` where floats overflow.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_reflect(
    mixture: *const srbf_mixture,
    environment: *const srbf_environment,
    block: *const srbf_light_block,
    frame: *const f32,
    flat: *const f32,
    count: usize,
    u: *const f32,
    choice: f32,
    reflection: *mut srbf_reflection,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        unsafe {
            let light = Map(object(environment)?);
            reflect(mixture, &light, block, frame, flat, count, u, choice, reflection)
        }
    })
}

/// Draws the two rays, and sums.
///
/// # Safety
/// The header's contract of [`srbf_mixture_reflect`].
#[allow(clippy::too_many_arguments)] // those of the exported function
pub(crate) unsafe fn reflect(
    mixture: *const srbf_mixture,
    light: &dyn LightSource,
    block: *const srbf_light_block,
    frame: *const f32,
    flat: *const f32,
    count: usize,
    u: *const f32,
    choice: f32,
    reflection: *mut srbf_reflection,
) -> Outcome {
    // SAFETY: the header's contract.
    let (mixture, block, frame, flat, out) = unsafe {
        let (mixture, frame) = (self::mixture(mixture)?, read_array::<9>(frame).of(Argument::Frame)?);
        (
            mixture,
            read(block).of(Argument::Block)?,
            frame,
            read_array(flat).of(Argument::Flat)?,
            Out::new(reflection).of(Argument::Reflection)?,
        )
    };
    if count == 0 || count > MAX_REFLECT_RAYS {
        return Err(SRBF_STATUS_ARGUMENT.into());
    }
    let (frame, flat) = (axes(frame)?, direction(flat).of(Argument::Flat)?);
    let [choice] = uniform([choice]).of(Argument::Choice)?;
    // SAFETY: the header's contract.
    let u = unsafe { slice(u, 3 * count).of(Argument::U)? };
    if !u.iter().all(|u| (0.0..1.0).contains(u)) {
        return Err(SRBF_STATUS_UNIFORM.into());
    }
    let (first, rest) = u.split_at(count);
    let (second, third) = rest.split_at(count);
    // Copied, as a block may lie anywhere.
    let block = LightBlock { direction: block.direction, light: block.light, pdf: block.pdf };
    let drawn = mixture.reflect(&light, &block, &frame, flat, [first, second, third], choice)?;
    out.set(srbf_reflection::from_core(&drawn));
    Ok(())
}

/// The light that is reflected to the viewer, direct light by both rays: whether the path's own ray escapes to the environment, and
/// whether the shadow ray does, 0 or 1. The light that the path meets further on is added to it; of the environment, nothing is.
///
/// Shapes: `reflection` from `srbf_mixture_reflect`; `values` [2][3], for a caller who renders another function than the mixture:
/// its `f cos` towards the ray and towards the shadow ray, or NULL; `light` [3], linear sRGB, overwritten. Single estimates may be
/// below 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_reflection_light(
    reflection: *const srbf_reflection,
    ray_escapes: i32,
    shadow_is_clear: i32,
    values: *const f32,
    light: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (reflection, out) = unsafe {
            (read(reflection).of(Argument::Reflection)?, Out::<[f32; 3]>::array(light).of(Argument::Light)?)
        };
        let r = reflection.to_core();
        let (ray_escapes, shadow_is_clear) = (ray_escapes != 0, shadow_is_clear != 0);
        let found = if values.is_null() {
            r.light(ray_escapes, shadow_is_clear)
        } else {
            // SAFETY: the header's contract.
            let [a, b, c, d, e, f] = unsafe { read_array::<6>(values).of(Argument::Values)? };
            r.light_of(ray_escapes, shadow_is_clear, Vec3::new(a, b, c), Vec3::new(d, e, f))
        };
        out.set(found.to_array());
        Ok(())
    })
}
