//! Objects in the caller's storage: how a mixture and a material are told from memory that holds neither.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::guard::{Failure, Named};
use crate::pointers::check;
use crate::status::{SRBF_STATUS_CAPACITY, SRBF_STATUS_MISALIGNED, SRBF_STATUS_OBJECT, SRBF_STATUS_SIZE};
use core::ops::Range;
use srbf_core::{AnyMixture, MAX_LOBES, Mixture};

/// Alignment of the storage for a mixture, which is also what `malloc` gives on 64-bit platforms; 64 is a little faster.
pub const SRBF_MIXTURE_ALIGNMENT: usize = 16;
/// Bytes of storage for a mixture of at most 16 lobes.
pub const SRBF_MIXTURE_SIZE_16: usize = 1280;
/// Bytes of storage for a mixture of at most 32 lobes.
pub const SRBF_MIXTURE_SIZE_32: usize = 2304;
/// Bytes of storage for a mixture of at most 64 lobes, the most that there are.
pub const SRBF_MIXTURE_SIZE_64: usize = 4352;

/// The lobes of one outgoing direction, in the caller's storage.
///
/// Get its size from `srbf_mixture_size` or a constant `SRBF_MIXTURE_SIZE_...`, and the object by `srbf_mixture_init` or
/// `srbf_material_prepare_into`. It owns nothing: it needs no release, and its bytes may be copied within a process to
/// storage of the same size and alignment.
///
/// One that a material with factors has made, see `srbf_material_factor_nodes`, reads them from the material's bytes whenever it is
/// evaluated or sampled: the material must live, and its bytes stay as they are, for as long as the mixture or a copy of it is used. A
/// mixture of any other material, or of the caller's lobes, stands by itself.
pub struct srbf_mixture {
    tag: u32,
    capacity: u32,
}

/// What stands at the start of every mixture that this library made: "srbf mix".
const TAG: u32 = 0x5b2f_3b1d;

/// The storage in full. The head comes first, so that a pointer to it is a pointer to the whole.
#[repr(C, align(16))]
struct Storage<M> {
    head: srbf_mixture,
    /// Of a material with factors it reads these from the material's bytes, which live as long as the header says.
    mixture: M,
}

type Storage16 = Storage<Mixture<'static, 16>>;
type Storage32 = Storage<Mixture<'static, 32>>;
type Storage64 = Storage<Mixture<'static, 64>>;

// The constants of the header hold whatever core's mixture looks like.
const _: () = assert!(
    size_of::<Storage16>() <= SRBF_MIXTURE_SIZE_16
        && size_of::<Storage32>() <= SRBF_MIXTURE_SIZE_32
        && size_of::<Storage64>() <= SRBF_MIXTURE_SIZE_64
        && align_of::<Storage64>() == SRBF_MIXTURE_ALIGNMENT
        && MAX_LOBES == 64
);

/// The bytes of storage that a mixture of a number of lobes needs; `None` for more than 64.
pub(crate) const fn size_for(lobes: usize) -> Option<usize> {
    match lobes {
        0..=16 => Some(SRBF_MIXTURE_SIZE_16),
        17..=32 => Some(SRBF_MIXTURE_SIZE_32),
        33..=MAX_LOBES => Some(SRBF_MIXTURE_SIZE_64),
        _ => None,
    }
}

/// Reads the head of what should be a mixture; its capacity.
///
/// # Safety
/// The header's contract: a pointer that is not NULL points to a mixture.
#[inline(always)]
unsafe fn capacity(mixture: *const srbf_mixture) -> Result<u32, Failure> {
    // The alignment of the whole, not of the head.
    check(mixture.cast::<Storage16>()).of(Argument::Mixture)?;
    // SAFETY: not NULL and aligned; readable by the contract.
    let head = unsafe { &*mixture };
    if head.tag != TAG {
        return Err(SRBF_STATUS_OBJECT).of(Argument::Mixture);
    }
    Ok(head.capacity)
}

/// Borrows a mixture of the caller.
///
/// # Safety
/// The header's contract: a pointer that is not NULL points to a mixture that nobody writes during the call.
#[inline(always)]
pub(crate) unsafe fn mixture<'a>(mixture: *const srbf_mixture) -> Result<&'a AnyMixture<'static>, Failure> {
    // SAFETY: the caller's word is ours.
    match unsafe { capacity(mixture) }? {
        // SAFETY: the tag says that `init_at` wrote a storage of this capacity here.
        16 => Ok(unsafe { &(*mixture.cast::<Storage16>()).mixture }),
        // SAFETY: as above.
        32 => Ok(unsafe { &(*mixture.cast::<Storage32>()).mixture }),
        // SAFETY: as above.
        64 => Ok(unsafe { &(*mixture.cast::<Storage64>()).mixture }),
        _ => Err(SRBF_STATUS_OBJECT.into()),
    }
}

/// Borrows a mixture of the caller to overwrite it.
///
/// # Safety
/// The header's contract: a pointer that is not NULL points to a mixture that nobody else uses during the call.
#[inline(always)]
pub(crate) unsafe fn mixture_mut<'a>(
    mixture: *mut srbf_mixture,
) -> Result<&'a mut AnyMixture<'static>, Failure> {
    // SAFETY: the caller's word is ours.
    match unsafe { capacity(mixture) }? {
        // SAFETY: the tag says that `init_at` wrote a storage of this capacity here.
        16 => Ok(unsafe { &mut (*mixture.cast::<Storage16>()).mixture }),
        // SAFETY: as above.
        32 => Ok(unsafe { &mut (*mixture.cast::<Storage32>()).mixture }),
        // SAFETY: as above.
        64 => Ok(unsafe { &mut (*mixture.cast::<Storage64>()).mixture }),
        _ => Err(SRBF_STATUS_OBJECT.into()),
    }
}

/// Writes an empty mixture of the largest capacity that `size` bytes hold.
///
/// # Safety
/// The header's contract: `size` bytes at `storage` are writable and nobody else uses them.
pub(crate) unsafe fn init_at(storage: *mut u8, size: usize) -> Result<*mut srbf_mixture, Failure> {
    check_storage(storage)?;
    if size < size_for(0).unwrap_or(usize::MAX) {
        return Err(SRBF_STATUS_SIZE).of(Argument::StorageSize);
    }
    // SAFETY: not NULL, aligned, and `size` bytes are writable by the contract.
    unsafe { write_empty(storage, size) };
    Ok(storage.cast())
}

/// Refuses storage that is NULL or not aligned for a mixture.
pub(crate) fn check_storage(storage: *mut u8) -> Result<(), Failure> {
    check(storage).of(Argument::Storage)?;
    if storage.addr().is_multiple_of(SRBF_MIXTURE_ALIGNMENT) {
        Ok(())
    } else {
        Err(SRBF_STATUS_MISALIGNED).of(Argument::Storage)
    }
}

/// Writes an empty mixture of the largest capacity that `size` bytes hold; returns it within its storage.
///
/// # Safety
/// `size` bytes, at least those of the smallest capacity, can be written at `place`, which has the alignment.
pub(crate) unsafe fn write_empty(place: *mut u8, size: usize) -> *mut AnyMixture<'static> {
    macro_rules! write {
        ($storage:ty, $capacity:literal) => {{
            let place = place.cast::<$storage>();
            let head = srbf_mixture { tag: TAG, capacity: $capacity };
            // SAFETY: the caller's word; the constant is at least the size of the storage.
            unsafe {
                place.write(Storage { head, mixture: Mixture::<$capacity>::empty() });
                &raw mut **(&mut (*place).mixture)
            }
        }};
    }
    if size >= SRBF_MIXTURE_SIZE_64 {
        write!(Storage64, 64)
    } else if size >= SRBF_MIXTURE_SIZE_32 {
        write!(Storage32, 32)
    } else {
        write!(Storage16, 16)
    }
}

/// The bytes that a call on a mixture reads: its own, and those of the factors that it borrows.
pub(crate) fn extents(place: *const srbf_mixture, mixture: &AnyMixture<'_>) -> [Range<usize>; 2] {
    let factors = mixture.factor_bytes();
    let start = factors.as_ptr().addr();
    [extent(place, mixture), start..start + factors.len()]
}

/// The bytes that a mixture lies in.
pub(crate) fn extent(place: *const srbf_mixture, mixture: &AnyMixture<'_>) -> Range<usize> {
    let size = match mixture.capacity() {
        16 => size_of::<Storage16>(),
        32 => size_of::<Storage32>(),
        _ => size_of::<Storage64>(),
    };
    place.addr()..place.addr() + size
}

/// Refuses a capacity that is too small before anything is written.
pub(crate) fn check_room(needed: usize, available: usize) -> Result<(), Failure> {
    if needed > available {
        return Err(Failure::new(
            SRBF_STATUS_CAPACITY,
            format_args!("{needed} lobes are needed, there is room for {available}"),
        ));
    }
    Ok(())
}
