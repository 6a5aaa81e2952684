//! The panic mechanics: a panic becomes a status and never crosses into C.

use crate::arguments::Argument;
use crate::status::{SRBF_STATUS_OK, srbf_status};

/// What went wrong, before it becomes a number.
pub(crate) type Outcome = Result<(), Failure>;

/// A status and the argument that it is about, with, where there is room for text, a sentence that says more.
pub(crate) struct Failure {
    /// The status in the lower half, the argument above it: one constant, so that a check costs no more for the name.
    code: i32,
    #[cfg(feature = "std")]
    message: Option<std::string::String>,
}

/// Digits of a status.
const DIGITS: u32 = 16;

impl From<srbf_status> for Failure {
    fn from(status: srbf_status) -> Self {
        Self {
            code: status,
            #[cfg(feature = "std")]
            message: None,
        }
    }
}

impl Failure {
    /// A status with the reason as text; a freestanding build keeps only the status.
    #[cfg_attr(not(feature = "std"), allow(unused_variables))]
    pub fn new(status: srbf_status, reason: impl core::fmt::Display) -> Self {
        Self {
            code: status,
            #[cfg(feature = "std")]
            message: Some(std::string::ToString::to_string(&reason)),
        }
    }

    /// The same with the name of its subject.
    #[cfg(feature = "std")]
    pub fn about(self, name: &str) -> Self {
        let message = match self.message {
            Some(reason) => std::format!("{name}: {reason}"),
            None => name.into(),
        };
        Self { message: Some(message), ..self }
    }

    #[inline(always)]
    fn status(&self) -> srbf_status {
        // A freestanding build has no names to take off.
        if cfg!(feature = "std") { self.code & ((1 << DIGITS) - 1) } else { self.code }
    }
}

/// A result that knows the argument it is about.
pub(crate) trait Named<T> {
    /// Names the argument of a failure. The last name stands. A freestanding build, without messages, keeps none.
    fn of(self, argument: Argument) -> Result<T, Failure>;
}

impl<T, E: Into<Failure>> Named<T> for Result<T, E> {
    #[inline(always)]
    fn of(self, argument: Argument) -> Result<T, Failure> {
        self.map_err(|error| {
            let failure: Failure = error.into();
            #[cfg(feature = "std")]
            return Failure { code: failure.status() | argument.number() << DIGITS, ..failure };
            #[cfg(not(feature = "std"))]
            {
                let _ = argument;
                failure
            }
        })
    }
}

/// Runs the body of an exported function; a failure and a panic become a status and the message of this thread.
#[cfg(feature = "std")]
#[inline(always)]
pub(crate) fn guard(body: impl FnOnce() -> Outcome) -> srbf_status {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    // A panic may leave only the caller's output half written, which the header calls unspecified then.
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => SRBF_STATUS_OK,
        Ok(Err(failure)) => report(failure),
        Err(payload) => report_panic(payload),
    }
}

#[cfg(feature = "std")]
#[cold]
fn report(failure: Failure) -> srbf_status {
    let status = failure.status();
    crate::message::set(status, Argument::name(failure.code >> DIGITS), failure.message.as_deref());
    status
}

#[cfg(feature = "std")]
#[cold]
fn report_panic(payload: std::boxed::Box<dyn core::any::Any + Send>) -> srbf_status {
    use crate::status::SRBF_STATUS_PANIC;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    let text = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<std::string::String>().map(std::string::String::as_str));
    crate::message::set(SRBF_STATUS_PANIC, None, text);
    // A payload may panic when it is dropped; the second one is leaked.
    if let Err(second) = catch_unwind(AssertUnwindSafe(move || drop(payload))) {
        core::mem::forget(second);
    }
    SRBF_STATUS_PANIC
}

/// Runs the body of an exported function. A panic does not return: see the handler below.
#[cfg(not(feature = "std"))]
#[inline(always)]
pub(crate) fn guard(body: impl FnOnce() -> Outcome) -> srbf_status {
    body().map_or_else(|failure| failure.status(), |()| SRBF_STATUS_OK)
}

/// Without an operating system there is nowhere to return to from a panic: the thread stops here for ever. WebAssembly traps.
#[cfg(not(any(feature = "std", test)))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    #[cfg(target_family = "wasm")]
    core::arch::wasm32::unreachable();
    #[cfg(not(target_family = "wasm"))]
    loop {
        core::hint::spin_loop();
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::status::SRBF_STATUS_PANIC;

    #[test]
    fn a_panic_becomes_a_status() {
        assert_eq!(guard(|| panic!("planted {}", 1)), SRBF_STATUS_PANIC);
        assert_eq!(guard(|| Ok(())), SRBF_STATUS_OK);
        assert_eq!(guard(|| Err(7.into())), 7);
    }

    #[test]
    fn a_payload_that_panics_when_dropped_does_not_escape() {
        struct Bomb;
        impl Drop for Bomb {
            fn drop(&mut self) {
                panic!("again");
            }
        }
        assert_eq!(guard(|| std::panic::panic_any(Bomb)), SRBF_STATUS_PANIC);
    }
}
