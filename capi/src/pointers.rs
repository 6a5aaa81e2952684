//! The pointer mechanics: pointers of a caller are checked here before their memory is touched.
//!
//! Nothing here can see whether memory is really there. The caller promises that a pointer which is not NULL points to enough
//! readable or writable memory. The contract is at the top of the header. That contract is what every `SAFETY` comment calls "the
//! header's contract".
#![allow(unsafe_code)]

use crate::guard::{Failure, Outcome};
use crate::status::{SRBF_STATUS_MISALIGNED, SRBF_STATUS_NULL, SRBF_STATUS_OVERLAP, SRBF_STATUS_SIZE};
use core::ops::Range;
use core::ptr::NonNull;

/// Refuses NULL and addresses that are not aligned for `T`.
#[inline(always)]
pub(crate) fn check<T>(pointer: *const T) -> Result<(), Failure> {
    if pointer.is_null() {
        return Err(SRBF_STATUS_NULL.into());
    }
    if !pointer.is_aligned() {
        return Err(SRBF_STATUS_MISALIGNED.into());
    }
    Ok(())
}

/// Copies a value that the caller owns.
///
/// # Safety
/// The header's contract: a pointer that is not NULL points to a `T` that nobody writes during the call.
#[inline(always)]
pub(crate) unsafe fn read<T: Copy>(pointer: *const T) -> Result<T, Failure> {
    check(pointer)?;
    // SAFETY: not NULL and aligned, checked above; readable and initialised by the header's contract.
    Ok(unsafe { pointer.read() })
}

/// Copies `K` numbers.
///
/// # Safety
/// As [`read`], for an array of `K`.
#[inline(always)]
pub(crate) unsafe fn read_array<const K: usize>(pointer: *const f32) -> Result<[f32; K], Failure> {
    check(pointer)?;
    // One by one, which the compiler may not change: where a caller has just stored them one by one, a read of two at a
    // time waits until they have gone through the cache.
    // SAFETY: not NULL and aligned, checked above; `K` are readable and initialised by the header's contract.
    Ok(core::array::from_fn(|i| unsafe { pointer.add(i).read_volatile() }))
}

/// Borrows bytes or objects that the caller owns; NULL is allowed where the count is 0.
///
/// # Safety
/// As [`read`], for `count` values, for as long as `'a`.
#[inline]
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, count: usize) -> Result<&'a [T], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    check(pointer)?;
    check_extent(pointer.addr(), count, size_of::<T>())?;
    // SAFETY: not NULL, aligned and not past the end of the address space, checked above; the rest is the contract.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

/// Refuses buffers of `count` elements, `stride` bytes apart, that the address space has no room for.
#[inline]
pub(crate) fn check_extent(start: usize, count: usize, stride: usize) -> Result<(), Failure> {
    let bytes = count.checked_mul(stride).filter(|&bytes| isize::try_from(bytes).is_ok());
    match bytes.and_then(|bytes| start.checked_add(bytes)) {
        Some(_) => Ok(()),
        None => Err(crate::SRBF_STATUS_SIZE.into()),
    }
}

/// Whether two runs of bytes have none in common.
#[inline(always)]
pub(crate) fn apart(a: &Range<usize>, b: &Range<usize>) -> bool {
    a.end <= b.start || b.end <= a.start
}

/// Refuses bytes that are to be written where others are.
#[inline]
pub(crate) fn check_apart(written: &Range<usize>, other: &Range<usize>) -> Result<(), Failure> {
    if apart(written, other) { Ok(()) } else { Err(SRBF_STATUS_OVERLAP.into()) }
}

/// A place of the caller for one result. No reference to it is ever made, so that it may hold anything beforehand.
pub(crate) struct Out<T>(NonNull<T>);

impl<T> Out<T> {
    /// Checks the place, before any work is done.
    ///
    /// # Safety
    /// The header's contract: a pointer that is not NULL points to memory for a `T` that nobody else uses during the call.
    #[inline(always)]
    pub unsafe fn new(pointer: *mut T) -> Result<Self, Failure> {
        check(pointer)?;
        NonNull::new(pointer).map(Self).ok_or_else(|| SRBF_STATUS_NULL.into())
    }

    /// The bytes that the result will lie in.
    pub fn extent(&self) -> Range<usize> {
        let start = self.0.addr().get();
        start..start + size_of::<T>()
    }

    /// Writes the result.
    #[inline(always)]
    pub fn set(&self, value: T) {
        // SAFETY: not NULL and aligned, checked when it was made; writable by the word given to `new`.
        unsafe { self.0.write(value) }
    }
}

impl<const K: usize> Out<[f32; K]> {
    /// A place for `K` numbers.
    ///
    /// # Safety
    /// As [`Out::new`], for an array of `K`.
    #[inline(always)]
    pub unsafe fn array(pointer: *mut f32) -> Result<Self, Failure> {
        // SAFETY: an array is aligned as its elements are; the caller's word is ours.
        unsafe { Self::new(pointer.cast()) }
    }
}

/// The addresses of bytes.
pub(crate) fn bytes_of(bytes: &[u8]) -> Range<usize> {
    let start = bytes.as_ptr().addr();
    start..start + bytes.len()
}

/// Puts an object that reads the caller's bytes into his storage, and gives the place. `size`, `alignment`: those that the header says.
///
/// # Safety
/// The header's contract: storage that is not NULL is writable for the bytes that it is said to have.
pub(crate) unsafe fn put_in_storage<T>(
    bytes: &[u8],
    place: *mut T,
    storage_size: usize,
    [size, alignment]: [usize; 2],
    out: &Out<*mut T>,
    make: impl FnOnce() -> Result<T, Failure>,
) -> Outcome {
    check(place)?;
    if !place.addr().is_multiple_of(alignment) {
        return Err(SRBF_STATUS_MISALIGNED.into());
    }
    if storage_size < size {
        return Err(SRBF_STATUS_SIZE.into());
    }
    check_extent(place.addr(), size, 1)?;
    let made = make()?;
    let written = place.addr()..place.addr() + size;
    check_apart(&written, &bytes_of(bytes))?;
    check_apart(&out.extent(), &written)?;
    check_apart(&out.extent(), &bytes_of(bytes))?;
    // SAFETY: not NULL, aligned and large enough; writable by the contract.
    unsafe { place.write(made) };
    out.set(place);
    Ok(())
}
