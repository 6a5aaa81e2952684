//! Mixtures that lie one behind the other in the caller's storage.
#![allow(unsafe_code)]

use crate::guard::{Failure, Outcome};
use crate::pointers::check_extent;
use crate::status::SRBF_STATUS_STRIDE;
use crate::storage::{AnyMixture, AnyMixtures, check_storage, extent, mixture};
use crate::storage::{SRBF_MIXTURE_ALIGNMENT, SRBF_MIXTURE_SIZE_16, srbf_mixture};
use core::ops::Range;
use srbf_core::Error;

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
        check_storage(start.cast_mut())?;
        if stride < SRBF_MIXTURE_SIZE_16 || !stride.is_multiple_of(SRBF_MIXTURE_ALIGNMENT) {
            return Err(SRBF_STATUS_STRIDE.into());
        }
        check_extent(start.addr(), count, stride)?;
        let mut made = Self { start, stride, extent: start.addr()..start.addr() + count * stride };
        // The last one may be of a larger capacity than the stride has room for: nothing comes behind it.
        // SAFETY: the caller's word.
        let end = unsafe { extent(made.at(count - 1), &made.get(count - 1)?).end };
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
    unsafe fn get<'a>(&self, index: usize) -> Result<AnyMixture<'a>, Failure> {
        // SAFETY: within the extent that `new` has checked; the rest is the caller's word.
        unsafe { mixture(self.at(index)) }
    }

    /// Calls with the mixtures of some hits, and with their places among these hits. Each call has all mixtures of one capacity
    /// that follow each other.
    ///
    /// # Safety
    /// As [`Self::new`]; the hits are below the count.
    pub unsafe fn each(
        &self,
        hits: Range<usize>,
        mut call: impl FnMut(AnyMixtures<'_>, Range<usize>) -> Result<(), Error>,
    ) -> Outcome {
        let (from, count, mut at) = (hits.start, hits.len(), 0);
        while at < count {
            // SAFETY: the caller's word, as everywhere below.
            let first = unsafe { self.get(from + at)? };
            macro_rules! run {
                ($capacity:ident, $first:ident) => {{
                    let (mut run, mut len) = ([$first; RUN], 1);
                    while len < RUN && at + len < count {
                        // SAFETY: as above.
                        let AnyMixture::$capacity(next) = (unsafe { self.get(from + at + len)? }) else {
                            break;
                        };
                        run[len] = next;
                        len += 1;
                    }
                    call(AnyMixtures::$capacity(&run[..len]), at..at + len)?;
                    at += len;
                }};
            }
            match first {
                AnyMixture::C16(first) => run!(C16, first),
                AnyMixture::C32(first) => run!(C32, first),
                AnyMixture::C64(first) => run!(C64, first),
            }
        }
        Ok(())
    }
}

/// Mixtures that are handed on in one call.
const RUN: usize = 64;
