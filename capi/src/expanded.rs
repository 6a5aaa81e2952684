//! Expanded materials in the caller's storage.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::convert::direction;
use crate::guard::{Failure, Named, guard};
use crate::material::material;
use crate::material::srbf_material;
use crate::pointers::{Out, check, check_apart, check_extent, read_array};
use crate::status::{SRBF_STATUS_MISALIGNED, SRBF_STATUS_OBJECT, SRBF_STATUS_SIZE, srbf_status};
use crate::storage::srbf_mixture;
use crate::storage::{check_room, mixture_mut};
use core::ops::Range;
use srbf_core::Expanded;

/// Alignment of the storage for an expanded material, which is also what `malloc` gives on 64-bit platforms.
pub const SRBF_EXPANDED_ALIGNMENT: usize = 16;
/// Rows at which the error of an expanded material is below 1e-3 of the largest value on every material that was tried.
pub const SRBF_EXPANDED_DEFAULT_ROWS: usize = 1024;

/// A material made ready for speed: lobes for many angles of the outgoing direction, in the caller's storage.
///
/// It never changes, so any number of threads may use one at once. It needs no release. Its bytes may not be moved. The bytes of
/// the material that it was made from must live, and stay as they are, for as long as it is used.
pub struct srbf_expanded {
    tag: u32,
    pub(crate) expanded: Expanded<'static>,
    /// Bytes of the storage.
    size: usize,
}

/// What stands at the start of every expanded material that this library made.
const TAG: u32 = 0x71e5_02a9;

/// Bytes before the rows.
const HEAD: usize = size_of::<srbf_expanded>().next_multiple_of(SRBF_EXPANDED_ALIGNMENT);

const _: () = assert!(
    align_of::<srbf_expanded>() <= SRBF_EXPANDED_ALIGNMENT
        && SRBF_EXPANDED_DEFAULT_ROWS == Expanded::DEFAULT_ROWS
);

impl srbf_expanded {
    /// The bytes that it lies in, and the `.srbf` bytes that it reads.
    pub(crate) fn extents(&self) -> [Range<usize>; 2] {
        let start = core::ptr::from_ref(self).addr();
        let bytes = self.expanded.material().bytes().as_ptr_range();
        [start..start + self.size, bytes.start.addr()..bytes.end.addr()]
    }
}

/// Borrows an expanded material of the caller.
///
/// # Safety
/// The header's contract: a pointer that is not NULL points to an expanded material.
#[inline(always)]
pub(crate) unsafe fn object<'a>(expanded: *const srbf_expanded) -> Result<&'a srbf_expanded, Failure> {
    check(expanded).of(Argument::Expanded)?;
    // SAFETY: not NULL and aligned; readable by the contract. The tag is looked at through the pointer, before there is a
    // reference to a whole that may not be one.
    if unsafe { (&raw const (*expanded).tag).read() } != TAG {
        return Err(SRBF_STATUS_OBJECT).of(Argument::Expanded);
    }
    // SAFETY: the tag says that this library wrote one here; it never changes.
    Ok(unsafe { &*expanded })
}

/// The bytes of an expanded material of a number of rows; `None` if there are more than an object may have.
fn size_of_rows(material: &srbf_material, rows: usize) -> Option<usize> {
    let bytes = material.material.expanded_len(rows).checked_mul(size_of::<f32>())?.checked_add(HEAD)?;
    isize::try_from(bytes).is_ok().then_some(bytes)
}

/// Gives the bytes of storage that an expanded material of `rows` rows needs: 448 a row, or 512 if lobes are mirrored, for up to
/// sixteen lobes, and as much for each sixteen lobes more.
///
/// Range: `rows` at least 2, at most 16384; `SRBF_EXPANDED_DEFAULT_ROWS` is a good number.
/// Status: `SRBF_STATUS_SIZE` if the bytes are more than the address space has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_expanded_size(
    material: *const srbf_material,
    rows: usize,
    size: *mut usize,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, out) = unsafe { (self::material(material)?, Out::new(size).of(Argument::Size)?) };
        out.set(size_of_rows(material, rows).ok_or(SRBF_STATUS_SIZE)?);
        Ok(())
    })
}

/// Expands a material in the caller's storage: prepares it exactly at `rows` angles of the outgoing direction.
///
/// Its values differ from those of `srbf_material_prepare` by an error that falls with the square of the number of rows.
/// Shapes: `storage` [storage_size], at least what `srbf_expanded_size` says, aligned to `SRBF_EXPANDED_ALIGNMENT`; `expanded` one
/// pointer, which is set to the storage. Neither may overlap the other, nor the material.
/// Status: `SRBF_STATUS_ARGUMENT` for an anisotropic material and for a number of rows out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_expanded_make(
    material: *const srbf_material,
    rows: usize,
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    expanded: *mut *mut srbf_expanded,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, out) =
            unsafe { (self::material(material)?, Out::new(expanded).of(Argument::Expanded)?) };
        let place = storage.cast::<srbf_expanded>();
        check(place).of(Argument::Storage)?;
        if !place.addr().is_multiple_of(SRBF_EXPANDED_ALIGNMENT) {
            return Err(SRBF_STATUS_MISALIGNED).of(Argument::Storage);
        }
        check_extent(place.addr(), storage_size, 1).of(Argument::StorageSize)?;
        let size = size_of_rows(material, rows).ok_or(SRBF_STATUS_SIZE)?;
        // A number of rows that has no meaning is named before a size that follows from it.
        Expanded::check(&material.material, rows)?;
        if storage_size < size {
            return Err(SRBF_STATUS_SIZE).of(Argument::StorageSize);
        }
        let written = place.addr()..place.addr() + size;
        for other in material.extents().into_iter().chain([out.extent()]) {
            check_apart(&written, &other)?;
        }
        for other in material.extents() {
            check_apart(&out.extent(), &other)?;
        }
        let numbers = place.wrapping_byte_add(HEAD).cast::<f32>();
        let count = material.material.expanded_len(rows);
        // SAFETY: within the storage, aligned as it is; writable by the header's contract, and nobody else's. Whatever its bits, it
        // holds numbers.
        let memory = unsafe {
            numbers.write_bytes(0, count);
            core::slice::from_raw_parts_mut(numbers, count)
        };
        let expanded = Expanded::new(&material.material, rows, memory)?;
        // SAFETY: not NULL, aligned and large enough; writable by the header's contract.
        unsafe { place.write(srbf_expanded { tag: TAG, expanded, size }) };
        out.set(place);
        Ok(())
    })
}

/// Makes the mixture of lobes for an outgoing direction, in a mixture that the caller has initialised; overwrites it.
///
/// As `srbf_material_prepare`, from the rows of an expanded material. Status as there.
/// Shapes: `wo` [3], unit vector towards the viewer, +z the surface normal.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_expanded_prepare(
    expanded: *const srbf_expanded,
    wo: *const f32,
    mixture: *mut srbf_mixture,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (object, wo, mixture) = unsafe {
            (
                object(expanded)?,
                direction(read_array(wo).of(Argument::Wo)?).of(Argument::Wo)?,
                mixture_mut(mixture)?,
            )
        };
        check_room(object.expanded.material().lobe_count(), mixture.capacity())?;
        object.expanded.prepare(wo, mixture)?;
        Ok(())
    })
}
