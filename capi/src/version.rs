//! The version of the library, to compare with the header's.
#![allow(unsafe_code)]

/// Version of this header: `major * 10000 + minor * 100 + patch`.
///
/// Compare with `srbf_version()` to see whether header and library belong together.
pub const SRBF_VERSION: u32 = 100;

/// Version of the `.srbf` bytes that are written. Every version from 1 to this one is read.
pub const SRBF_FORMAT_VERSION: u32 = 3;

/// Returns the version of the library: `major * 10000 + minor * 100 + patch`.
#[unsafe(no_mangle)]
pub extern "C" fn srbf_version() -> u32 {
    SRBF_VERSION
}
