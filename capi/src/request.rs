//! The request of the C interface: outputs that are given are wanted.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::guard::{Failure, Named};
use crate::material::{material, srbf_material};
use crate::pointers::{check, check_extent};
use crate::status::SRBF_STATUS_STRIDE;
use crate::streams::{srbf_numbers_out, srbf_samples_out, srbf_vectors, srbf_vectors_out};
use core::ops::Range;

/// The inputs and the wanted outputs for each of n hits. Start from zeros, set `size`, the inputs and the wanted outputs.
///
/// `sizeof(srbf_request)` in `size` lets later versions ask for more. An output whose first pointer is NULL is not wanted:
/// `value.x`, `pdf.values`, `samples.direction.x`, `samples.pdf.values`, `samples.weight.x`. Inputs that no output needs are not
/// looked at. Each array has n elements; outputs are overwritten, and may overlap nothing, inputs may overlap each other.
///
/// A call checks the arrays that are asked for, and no others, before it writes anything. No pointer may be NULL or misaligned, and
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
    pub(crate) fn check(&self, count: usize) -> Result<Range<usize>, Failure> {
        check(self.first).of(Argument::Materials)?;
        let size = size_of::<*const srbf_material>();
        if self.stride < size || !self.stride.is_multiple_of(align_of::<*const srbf_material>()) {
            return Err(SRBF_STATUS_STRIDE).of(Argument::Materials);
        }
        check_extent(self.first.addr(), count, self.stride).of(Argument::Materials)?;
        let start = self.first.addr();
        Ok(start..start + (count - 1) * self.stride + size)
    }

    /// # Safety
    /// They have been checked; `index` is below the count; the header's contract.
    #[inline(always)]
    pub(crate) unsafe fn get<'a>(&self, index: usize) -> Result<&'a srbf_material, Failure> {
        // SAFETY: the caller's word.
        unsafe { material(self.first.byte_add(index * self.stride).read()) }.of(Argument::Materials)
    }
}
