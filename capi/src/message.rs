//! The last message of each thread.
#![allow(unsafe_code)]

use crate::status::{srbf_status, srbf_status_text};
use core::ffi::{CStr, c_char};
use srbf_core::printable;
use std::cell::RefCell;
use std::ffi::CString;
use std::string::ToString;

std::thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

/// Keeps the argument, the text of the status and the reason, those that there are, for this thread. A reason that repeats the text
/// of the status stands alone.
pub(crate) fn set(status: srbf_status, argument: Option<&str>, reason: Option<&str>) {
    let text = srbf_status_text(status);
    // SAFETY: srbf_status_text returns a constant that ends in a zero byte.
    let text = unsafe { CStr::from_ptr(text) }.to_string_lossy();
    let line = match reason {
        Some(reason) if reason.contains(&*text) => reason.into(),
        Some(reason) => std::format!("{text}: {reason}"),
        None => text.into_owned(),
    };
    let line = match argument {
        Some(argument) => std::format!("{argument}: {line}"),
        None => line,
    };
    let line = printable(&line).to_string();
    // At the end of a thread its message may be gone already: then there is none to keep.
    let _ = LAST.try_with(|last| {
        if let (Ok(mut last), Ok(line)) = (last.try_borrow_mut(), CString::new(line)) {
            *last = line;
        }
    });
}

/// Returns the message of the last call that failed on this thread, "" if none did.
///
/// UTF-8, one line of visible characters (a control character, in the name of a file for example, is spelled out as `\u{1b}`),
/// never NULL. Valid until the next call that fails on this thread, or its end.
#[cfg(feature = "std")]
#[unsafe(no_mangle)]
pub extern "C" fn srbf_last_message() -> *const c_char {
    LAST.try_with(|last| last.try_borrow().map_or(c"".as_ptr(), |last| last.as_ptr())).unwrap_or(c"".as_ptr())
}
