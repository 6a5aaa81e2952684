//! Light of any kind, as two functions of the caller.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::environment::{sample_product, srbf_product_sample, srbf_product_sampling};
use crate::guard::{Named, Outcome, guard};
use crate::pointers::{Out, read, read_array};
use crate::reflect::{draw_block, reflect, srbf_light_block, srbf_reflection};
use crate::status::{SRBF_STATUS_LIGHT, SRBF_STATUS_NULL, SRBF_STATUS_OK, srbf_status};
use crate::storage::srbf_mixture;
use core::cell::Cell;
use core::ffi::c_void;
use core::mem::offset_of;
use core::ptr::from_mut;
use srbf_core::{LIGHT_BLOCK, LightRows, LightSource, Vec3};

/// Up to sixteen directions of a light as rows, filled by the functions of a `srbf_light_source`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_light_rows {
    /// Unit vectors in the world, towards the light: x, y, z.
    pub direction: [[f32; 16]; 3],
    /// Estimates of the radiance from there: red, green, blue; linear sRGB, not negative.
    pub radiance: [[f32; 16]; 3],
    /// Densities; 1/sr.
    pub pdf: [f32; 16],
}

const _: () = assert!(
    size_of::<srbf_light_rows>() == size_of::<LightRows>()
        && align_of::<srbf_light_rows>() <= align_of::<LightRows>()
        && offset_of!(srbf_light_rows, radiance) == offset_of!(LightRows, radiance)
        && offset_of!(srbf_light_rows, pdf) == offset_of!(LightRows, pdf)
);

/// Light that can be drawn from, as two functions of the caller: one learnt from a renderer's own paths, or lamps that a surface sees.
///
/// The functions give the density of the draws, and an estimate of the radiance. A draw is multiplied by the renderer's own
/// radiance along the direction, so that the mean is right whatever the estimate is. Two things are asked for that: both functions give
/// the density that directions are drawn with, 0 for a draw that finds nothing; and the estimate is above 0 wherever the true radiance
/// may be, if only by little. A number that has no meaning, such as a density that is NaN, counts as no light.
///
/// A function gives 0. Any other number makes the call that asked it give `SRBF_STATUS_LIGHT`. It has to return, by no exception and no
/// jump; it may call this library. It is called in the thread of the call that asks it.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_light_source {
    /// Given to both functions as it is; may be NULL.
    pub user: *mut c_void,
    /// Draws `count` directions, 1 to 16, each by itself with the density that it tells. Shapes: `u` [3][16], uniform numbers in [0, 1),
    /// of which the first `count` of each row count; `rows` overwritten, the first `count` of each row.
    pub sample: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            count: usize,
            u: *const f32,
            rows: *mut srbf_light_rows,
        ) -> srbf_status,
    >,
    /// Gives estimates of the radiance, and the density of `sample`, of the first `count` directions of `rows`, 1 to 16.
    pub evaluate: Option<
        unsafe extern "C" fn(user: *mut c_void, count: usize, rows: *mut srbf_light_rows) -> srbf_status,
    >,
}

/// A light whose functions are there, and whether one has failed.
struct Called {
    light: srbf_light_source,
    has_failed: Cell<bool>,
}

impl Called {
    /// Runs `body` with the light of the caller.
    ///
    /// # Safety
    /// The header's contract: a pointer that is not NULL points to a light, whose functions keep to it.
    unsafe fn with(light: *const srbf_light_source, body: impl FnOnce(&Self) -> Outcome) -> Outcome {
        // SAFETY: the header's contract.
        let light = unsafe { read(light).of(Argument::Light)? };
        if light.sample.is_none() || light.evaluate.is_none() {
            return Err(SRBF_STATUS_NULL.into());
        }
        let called = Self { light, has_failed: Cell::new(false) };
        body(&called)?;
        if called.has_failed.get() { Err(SRBF_STATUS_LIGHT.into()) } else { Ok(()) }
    }

    /// Takes the status of a function: after a failure there is no light.
    fn take(&self, status: srbf_status, to: &mut LightRows) {
        if status != SRBF_STATUS_OK {
            self.has_failed.set(true);
            *to = LightRows::NONE;
        }
    }
}

impl LightSource for Called {
    fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
        let count = u[0].len();
        let mut numbers = [[0.5; LIGHT_BLOCK]; 3];
        for k in 0..3 {
            numbers[k][..count].copy_from_slice(u[k]);
        }
        if let Some(sample) = self.light.sample {
            // SAFETY: rows of the caller's structure are those of `LightRows`, asserted above; the function keeps the header's contract.
            let status =
                unsafe { sample(self.light.user, count, numbers.as_ptr().cast(), from_mut(to).cast()) };
            self.take(status, to);
        }
    }

    fn evaluate_into(&self, count: usize, to: &mut LightRows) {
        if let Some(evaluate) = self.light.evaluate {
            // SAFETY: as above.
            let status = unsafe { evaluate(self.light.user, count, from_mut(to).cast()) };
            self.take(status, to);
        }
    }
}

/// Draws a direction for any light and a mixture together, as `srbf_mixture_sample_product` does for an environment.
///
/// The light that reaches the viewer is the sample's `factor` times the radiance that the caller finds along its direction. Its mean is
/// the integral of that radiance times `f cos`, times one minus `srbf_product_ray_weight`, whatever the light's estimates are. `weight` is
/// of the estimate. The light is asked to evaluate the candidates of the mixture, and to draw the others.
/// Shapes: as there. Status: `SRBF_STATUS_NULL` for a function that is NULL too; `SRBF_STATUS_LIGHT`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample_product_from(
    mixture: *const srbf_mixture,
    light: *const srbf_light_source,
    frame: *const f32,
    sampling: *const srbf_product_sampling,
    u: *const f32,
    choice: f32,
    sample: *mut srbf_product_sample,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        unsafe {
            Called::with(light, |light| sample_product(mixture, light, frame, sampling, u, choice, sample))
        }
    })
}

/// Draws a block of samples of any light, as `srbf_light_block_draw` does of an environment; their light is the estimate.
///
/// Shapes: as there. Status: `SRBF_STATUS_NULL` for a function that is NULL too; `SRBF_STATUS_LIGHT`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_light_block_draw_from(
    light: *const srbf_light_source,
    u: *const f32,
    block: *mut srbf_light_block,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        unsafe { Called::with(light, |light| draw_block(light, u, block)) }
    })
}

/// Draws the ray that a path goes on along, and a shadow ray, for any light, as `srbf_mixture_reflect` does for an environment. The
/// sums are of the light's estimates; `srbf_reflection_light_from` corrects them by the radiance that the caller finds.
///
/// Shapes: as there; `block` from `srbf_light_block_draw_from`. Status: `SRBF_STATUS_NULL` for a function that is NULL too;
/// `SRBF_STATUS_LIGHT`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_reflect_from(
    mixture: *const srbf_mixture,
    light: *const srbf_light_source,
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
            Called::with(light, |light| {
                reflect(mixture, light, block, frame, flat, count, u, choice, reflection)
            })
        }
    })
}

/// The light that is reflected to the viewer, of any light: of the radiance that the caller finds along the path's ray and along the
/// shadow ray, 0 where nothing comes from there.
///
/// Shapes: `reflection` from `srbf_mixture_reflect_from`; `radiance` [2][3], linear sRGB, that along the ray first; that of a ray which does
/// not exist may be anything; `light` [3], linear sRGB, overwritten. Single estimates may be below 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_reflection_light_from(
    reflection: *const srbf_reflection,
    radiance: *const f32,
    light: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (reflection, [a, b, c, d, e, f], out) = unsafe {
            (
                read(reflection).of(Argument::Reflection)?,
                read_array::<6>(radiance).of(Argument::Radiance)?,
                Out::<[f32; 3]>::array(light).of(Argument::Light)?,
            )
        };
        let found = reflection.to_core().light_from(Vec3::new(a, b, c), Vec3::new(d, e, f));
        out.set(found.to_array());
        Ok(())
    })
}
