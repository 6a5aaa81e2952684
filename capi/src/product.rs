//! Products of mixtures, and their integrals: of plain lobes only.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::guard::{Named, guard};
use crate::lobe::srbf_lobe;
use crate::pointers::{Out, check, check_apart, check_extent};
use crate::status::{SRBF_STATUS_SIZE, srbf_status};
use crate::storage::srbf_mixture;
use crate::storage::{extent, mixture};
use core::mem::offset_of;
use srbf_core::{Gaussian, Lobe};

/// Integrates the product of two mixtures of round lobes over the domain that they share.
///
/// For a material's mixture and one of lobes of radiance: the radiance that is reflected towards the viewer.
/// Shapes: `integral` [3], overwritten. Status: `SRBF_STATUS_SQUEEZED`; `SRBF_STATUS_AMPLITUDE` where floats overflow.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_inner_product(
    a: *const srbf_mixture,
    b: *const srbf_mixture,
    integral: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (a, b, out) = unsafe {
            (
                mixture(a).of(Argument::A)?,
                mixture(b).of(Argument::B)?,
                Out::<[f32; 3]>::array(integral).of(Argument::Integral)?,
            )
        };
        let sum = a.inner_product(b)?;
        out.set(sum.to_array());
        Ok(())
    })
}

/// Multiplies two mixtures of round lobes, lobe by lobe.
///
/// A folded lobe counts as two, itself and its mirror image. The products are lobes of the caller's shading frame, not
/// folded; they stand for the product on the domain that the mixtures share. Sharpness may reach 2e8,
/// which no call takes, and an amplitude infinity, where two multiply to more than a float holds.
/// Shapes: `lobes` [capacity], of which the first `*count` are overwritten; `lobes` may be NULL with capacity 0, to ask
/// for the count alone. Status: `SRBF_STATUS_SIZE` if the capacity is too small, `*count` gives the capacity needed;
/// `SRBF_STATUS_SQUEEZED`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_product(
    a: *const srbf_mixture,
    b: *const srbf_mixture,
    capacity: usize,
    lobes: *mut srbf_lobe,
    count: *mut usize,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (first, second, out) = unsafe {
            (mixture(a).of(Argument::A)?, mixture(b).of(Argument::B)?, Out::new(count).of(Argument::Count)?)
        };
        let needed = first.product_len(second);
        if capacity < needed {
            out.set(needed);
            return Err(SRBF_STATUS_SIZE.into());
        }
        let room: &mut [Lobe] = if needed == 0 {
            &mut []
        } else {
            check(lobes).of(Argument::Lobes)?;
            check_extent(lobes.addr(), needed, size_of::<srbf_lobe>())?;
            let written = lobes.addr()..lobes.addr() + needed * size_of::<srbf_lobe>();
            for object in [extent(a, first), extent(b, second)] {
                check_apart(&written, &object)?;
            }
            // SAFETY: not NULL, aligned, within the address space and apart from the inputs, checked above; writable
            // by the header's contract. The two structures are laid out alike, asserted below, and any bits are one.
            unsafe { core::slice::from_raw_parts_mut(lobes.cast(), needed) }
        };
        first.product_into(second, room)?;
        out.set(needed);
        Ok(())
    })
}

const _: () = assert!(
    size_of::<Lobe>() == size_of::<srbf_lobe>()
        && align_of::<Lobe>() == align_of::<srbf_lobe>()
        && offset_of!(Gaussian, axis) == offset_of!(srbf_lobe, axis)
        && offset_of!(Lobe, gaussian) + offset_of!(Gaussian, sharpness) == offset_of!(srbf_lobe, sharpness)
        && offset_of!(Lobe, amplitude) == offset_of!(srbf_lobe, amplitude)
);
