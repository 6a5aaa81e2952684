//! Mixtures that lie one behind the other in the caller's storage.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::guard::{Failure, Named, Outcome};
use crate::pointers::check_extent;
use crate::status::SRBF_STATUS_STRIDE;
use crate::storage::{SRBF_MIXTURE_ALIGNMENT, SRBF_MIXTURE_SIZE_16, srbf_mixture};
use crate::storage::{check_storage, extent, mixture};
use core::ops::Range;
use srbf_core::{AnyMixture, Error};

/// n mixtures, `stride` bytes apart.
pub(crate) struct Mixtures {
    start: *const u8,
    stride: usize,
    /// The bytes from the first to the end of the last.
    extent: Range<usize>,
}

impl Mixtures {
    /// # Safety
    /// The header's contract: there is a mixture at every multiple of the stride; `count` is not 0.
    pub unsafe fn new(start: *const srbf_mixture, count: usize, stride: usize) -> Result<Self, Failure> {
        let start = start.cast::<u8>();
        check_storage(start.cast_mut()).of(Argument::Mixtures)?;
        if stride < SRBF_MIXTURE_SIZE_16 || !stride.is_multiple_of(SRBF_MIXTURE_ALIGNMENT) {
            return Err(SRBF_STATUS_STRIDE).of(Argument::Mixtures);
        }
        check_extent(start.addr(), count, stride)?;
        let mut made = Self { start, stride, extent: start.addr()..start.addr() + count * stride };
        // The last one may be of a larger capacity than the stride has room for: nothing comes behind it.
        // SAFETY: the caller's word.
        let end = unsafe { extent(made.at(count - 1), made.get(count - 1)?).end };
        made.extent.end = made.extent.end.max(end);
        Ok(made)
    }

    pub fn extent(&self) -> Range<usize> {
        self.extent.clone()
    }

    /// Where a mixture is; `index` is below the count.
    #[inline(always)]
    fn at(&self, index: usize) -> *const srbf_mixture {
        self.start.wrapping_byte_add(index * self.stride).cast()
    }

    /// # Safety
    /// As [`Self::new`]; `index` is below the count.
    #[inline(always)]
    unsafe fn get<'a>(&self, index: usize) -> Result<&'a AnyMixture<'static>, Failure> {
        // SAFETY: within the extent that `new` has checked; the rest is the caller's word.
        unsafe { mixture(self.at(index)) }.of(Argument::Mixtures)
    }

    /// Calls with the mixtures of some hits, and with their places among these hits.
    ///
    /// # Safety
    /// As [`Self::new`]; the hits are below the count.
    pub unsafe fn each(
        &self,
        hits: Range<usize>,
        mut call: impl FnMut(&[&AnyMixture<'static>], Range<usize>) -> Result<(), Error>,
    ) -> Outcome {
        for from in (0..hits.len()).step_by(RUN) {
            let len = RUN.min(hits.len() - from);
            // SAFETY: the caller's word.
            let first = unsafe { self.get(hits.start + from)? };
            let mut run = [first; RUN];
            for (i, mixture) in run[..len].iter_mut().enumerate().skip(1) {
                // SAFETY: as above.
                *mixture = unsafe { self.get(hits.start + from + i)? };
            }
            call(&run[..len], from..from + len)?;
        }
        Ok(())
    }
}

/// Mixtures that are handed on in one call.
const RUN: usize = 64;
