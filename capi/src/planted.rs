//! A planted bug, for tests of the status that a panic becomes.
#![allow(unsafe_code)]

use crate::guard::guard;
use crate::status::srbf_status;

/// Panics inside, and returns `SRBF_STATUS_PANIC`. Only in a build for tests.
#[cfg(feature = "planted-panic")]
#[unsafe(no_mangle)]
pub extern "C" fn srbf_status_panic() -> srbf_status {
    guard(|| panic!("planted"))
}
