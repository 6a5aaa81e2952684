//! Results of calls: numbers that are never reused for another meaning, and their texts.
#![allow(unsafe_code)]

use core::ffi::{CStr, c_char};

/// The result of a call: 0 if it succeeded, otherwise the reason. The numbers never change their meaning.
pub type srbf_status = i32;

/// The call succeeded.
pub const SRBF_STATUS_OK: srbf_status = 0;
/// A pointer that must not be NULL is NULL.
pub const SRBF_STATUS_NULL: srbf_status = 1;
/// A pointer is not aligned for its type.
pub const SRBF_STATUS_MISALIGNED: srbf_status = 2;
/// An output overlaps an input or another output.
pub const SRBF_STATUS_OVERLAP: srbf_status = 3;
/// A buffer is too small, or a count is so large that the address space ends before the buffer.
pub const SRBF_STATUS_SIZE: srbf_status = 4;
/// A stride is not a multiple of the alignment, or smaller than one element: 0 too.
pub const SRBF_STATUS_STRIDE: srbf_status = 5;
/// The memory does not hold the object: it was not made by this library, or its size does not fit.
pub const SRBF_STATUS_OBJECT: srbf_status = 6;
/// An index is past the end.
pub const SRBF_STATUS_INDEX: srbf_status = 7;
/// An argument has none of the values that it may have.
pub const SRBF_STATUS_ARGUMENT: srbf_status = 8;
/// A direction is not a finite vector of length 1 within 1e-3.
pub const SRBF_STATUS_DIRECTION: srbf_status = 9;
/// A uniform number is NaN or outside [0, 1).
pub const SRBF_STATUS_UNIFORM: srbf_status = 10;
/// The axis of a lobe is not a finite vector of length 1 within 1e-3.
pub const SRBF_STATUS_AXIS: srbf_status = 11;
/// A sharpness is NaN or outside [0, 1e8].
pub const SRBF_STATUS_SHARPNESS: srbf_status = 12;
/// An amplitude is NaN or infinite, its luminance negative, or a channel beyond 32 times that; or an integral is infinite.
pub const SRBF_STATUS_AMPLITUDE: srbf_status = 13;
/// A squeeze is NaN or outside [0.01, 2].
pub const SRBF_STATUS_SQUEEZE: srbf_status = 14;
/// The mixture has room for fewer lobes than are needed.
pub const SRBF_STATUS_CAPACITY: srbf_status = 15;
/// A mixture holds squeezed lobes, a diffuse term or factors, which have no product in closed form.
pub const SRBF_STATUS_SQUEEZED: srbf_status = 16;
/// A weight, a tint or a coat of a blend is out of its range, or no weight is above 0.
pub const SRBF_STATUS_WEIGHT: srbf_status = 17;
/// The bytes do not start like a `.srbf` file.
pub const SRBF_STATUS_MAGIC: srbf_status = 20;
/// The `.srbf` version is one that this library does not read.
pub const SRBF_STATUS_FORMAT_VERSION: srbf_status = 21;
/// The `.srbf` bytes end early, or more follow than they announce.
pub const SRBF_STATUS_LENGTH: srbf_status = 22;
/// The checksum does not fit: the `.srbf` bytes are damaged.
pub const SRBF_STATUS_CHECKSUM: srbf_status = 23;
/// A field of the `.srbf` bytes is out of range.
pub const SRBF_STATUS_FIELD: srbf_status = 24;
/// A file could not be read or written.
pub const SRBF_STATUS_FILE: srbf_status = 30;
/// A text is not UTF-8.
pub const SRBF_STATUS_TEXT: srbf_status = 31;
/// A table is one that no material can be fitted to.
pub const SRBF_STATUS_TABLE: srbf_status = 32;
/// This processor, or this build of the library, does not have the SIMD level.
pub const SRBF_STATUS_SIMD_LEVEL: srbf_status = 40;
/// A function of the caller's light gave another status than 0.
pub const SRBF_STATUS_LIGHT: srbf_status = 41;
/// A panic was caught inside the library: a bug in it. Outputs are unspecified.
pub const SRBF_STATUS_PANIC: srbf_status = 50;
/// An error that this version of the C interface has no number for.
pub const SRBF_STATUS_OTHER: srbf_status = 51;

/// Returns a sentence for a status; never NULL, valid for ever.
///
/// Any number may be given; one that is no status has a text that says so.
#[unsafe(no_mangle)]
pub extern "C" fn srbf_status_text(status: srbf_status) -> *const c_char {
    text(status).as_ptr()
}

fn text(status: srbf_status) -> &'static CStr {
    match status {
        SRBF_STATUS_OK => c"success",
        SRBF_STATUS_NULL => c"a pointer that must not be NULL is NULL",
        SRBF_STATUS_MISALIGNED => c"a pointer is not aligned for its type",
        SRBF_STATUS_OVERLAP => c"an output overlaps an input or another output",
        SRBF_STATUS_SIZE => c"a buffer is too small, or a count too large for the address space",
        SRBF_STATUS_STRIDE => c"a stride is not a multiple of the alignment, or smaller than one element",
        SRBF_STATUS_OBJECT => c"the memory does not hold an object that this library made",
        SRBF_STATUS_INDEX => c"an index is past the end",
        SRBF_STATUS_ARGUMENT => c"an argument has none of the values that it may have",
        SRBF_STATUS_DIRECTION => c"a direction must be a finite unit vector",
        SRBF_STATUS_UNIFORM => c"a uniform number must be within [0, 1)",
        SRBF_STATUS_AXIS => c"the axis of a lobe must be a finite unit vector",
        SRBF_STATUS_SHARPNESS => c"the sharpness of a lobe must be within [0, 1e8]",
        SRBF_STATUS_AMPLITUDE => c"an amplitude and its integrals must be finite, its luminance not negative, and no channel beyond 32 times that",
        SRBF_STATUS_SQUEEZE => c"a squeeze must be within [0.01, 2]",
        SRBF_STATUS_CAPACITY => c"the mixture has room for fewer lobes than are needed",
        SRBF_STATUS_SQUEEZED => c"squeezed lobes, diffuse terms and factors have no product in closed form",
        SRBF_STATUS_WEIGHT => {
            c"weights and tints must be within [0, 1000], one weight above 0, the index of a coat within [1, 10]"
        }
        SRBF_STATUS_MAGIC => c"not a .srbf file",
        SRBF_STATUS_FORMAT_VERSION => c"a .srbf version that this library does not read",
        SRBF_STATUS_LENGTH => c"the .srbf bytes have another length than they announce",
        SRBF_STATUS_CHECKSUM => c"the checksum does not fit: the .srbf bytes are damaged",
        SRBF_STATUS_FIELD => c"a field of the .srbf bytes is out of range",
        SRBF_STATUS_FILE => c"a file could not be read or written",
        SRBF_STATUS_TEXT => c"a text is not UTF-8",
        SRBF_STATUS_TABLE => c"no material can be fitted to the table",
        SRBF_STATUS_SIMD_LEVEL => c"the SIMD level is not available here",
        SRBF_STATUS_LIGHT => c"a function of the light gave another status than 0",
        SRBF_STATUS_PANIC => c"a panic inside srbf, which is a bug in it",
        SRBF_STATUS_OTHER => c"an error without a number of its own",
        _ => c"not a status of srbf",
    }
}
