//! Materials that this library owns: copied from memory or read from a file.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::guard::{Failure, Named, Outcome, guard};
use crate::material::srbf_material;
use crate::material::{Bytes, material};
use crate::pointers::{Out, check, slice};
use crate::status::{SRBF_STATUS_FILE, SRBF_STATUS_OTHER, SRBF_STATUS_TEXT, srbf_status};
use core::ffi::{CStr, c_char};
use srbf_core::{FileError, FormatError, Material, read_file};
use std::boxed::Box;
use std::path::Path;
use std::vec::Vec;

/// Bytes that say how long a material is.
#[cfg(feature = "std")]
const HEAD: usize = 52;

/// Makes a material of `.srbf` bytes, which are copied. Release it with `srbf_material_free`.
///
/// Shapes: `bytes` [byte_count]; `material` one pointer, overwritten.
/// Status: `SRBF_STATUS_MAGIC` to `SRBF_STATUS_FIELD` if the bytes are not a material; `SRBF_STATUS_OTHER` if there is no memory
/// for the copy.
#[cfg(feature = "std")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_from_bytes(
    bytes: *const u8,
    byte_count: usize,
    material: *mut *mut srbf_material,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (bytes, out) = unsafe {
            (slice(bytes, byte_count).of(Argument::Bytes)?, Out::new(material).of(Argument::Material)?)
        };
        // Before a copy is made, which may have any number of bytes: a head alone is refused by the length that it announces.
        match Material::from_bytes(&bytes[..byte_count.min(HEAD)]) {
            Err(FormatError::Length { expected, .. }) if expected == byte_count => {}
            Err(FormatError::Length { expected, .. }) if byte_count > HEAD => {
                Err(FormatError::Length { expected, actual: byte_count })?;
            }
            head => drop(head?),
        }
        own(copy(bytes)?, &out)
    })
}

/// Reads a material from a `.srbf` file. Release it with `srbf_material_free`.
///
/// No more is read than the head of the file announces, and nothing behind a head that is no material's.
/// `path` is UTF-8 with a zero at the end, of a regular file. Status: `SRBF_STATUS_FILE` if it cannot be read, with the reason in
/// `srbf_last_message`; `SRBF_STATUS_MAGIC` to `SRBF_STATUS_FIELD` if it holds no material. Every message names the file.
#[cfg(feature = "std")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_load(
    path: *const c_char,
    material: *mut *mut srbf_material,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (path, out) =
            unsafe { (text(path).of(Argument::Path)?, Out::new(material).of(Argument::Material)?) };
        let read = || own(read_file(Path::new(path))?, &out);
        read().map_err(|failure: Failure| failure.about(path))
    })
}

fn copy(bytes: &[u8]) -> Result<Vec<u8>, Failure> {
    let mut copy = Vec::new();
    copy.try_reserve_exact(bytes.len()).map_err(|error| Failure::new(SRBF_STATUS_OTHER, error))?;
    copy.extend_from_slice(bytes);
    Ok(copy)
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        match error {
            FileError::Format(error) => error.into(),
            error => Self::new(SRBF_STATUS_FILE, error),
        }
    }
}

/// Borrows a text of the caller.
///
/// # Safety
/// The header's contract: a pointer that is not NULL points to bytes that end in a zero.
pub(crate) unsafe fn text<'a>(text: *const c_char) -> Result<&'a str, Failure> {
    check(text)?;
    // SAFETY: not NULL; the rest is the contract.
    unsafe { CStr::from_ptr(text) }.to_str().map_err(|error| Failure::new(SRBF_STATUS_TEXT, error))
}

/// Puts a material and its bytes on the heap.
pub(crate) fn own(bytes: Vec<u8>, out: &Out<*mut srbf_material>) -> Outcome {
    let made = srbf_material::new(Bytes::Owned(bytes.into_boxed_slice()))?;
    out.set(Box::into_raw(Box::new(made)));
    Ok(())
}

/// Releases a material; NULL is allowed and does nothing.
///
/// A material that `srbf_material_borrow` made is only marked as none. Nobody may use the material during or after the
/// call, nor, if it has factors, a mixture that it has made.
/// Status: `SRBF_STATUS_OBJECT` if it is not a material.
#[cfg(feature = "std")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_free(material: *mut srbf_material) -> srbf_status {
    guard(|| {
        if material.is_null() {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let is_owned = unsafe { self::material(material)? }.is_owned;
        // SAFETY: a material, by its tag, that nobody else uses by the contract.
        unsafe { (*material).forget() };
        if is_owned {
            // SAFETY: `own` made the box, and the tag was still there: it has not been released yet.
            drop(unsafe { Box::from_raw(material) });
        }
        Ok(())
    })
}
