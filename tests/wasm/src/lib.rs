//! Checks every level that WebAssembly has; `run.mjs` loads the module and prints its findings.
#![no_std]

extern crate alloc;

use alloc::string::String;
use core::alloc::{GlobalAlloc, Layout};
use core::arch::wasm32;
use core::fmt::Write;
use core::sync::atomic::{AtomicUsize, Ordering};
use srbf_core::Level;

/// Hands out fresh pages of linear memory, and takes only the last block back. One thread.
struct Bump {
    next: AtomicUsize,
}

const PAGE: usize = 65536;

// SAFETY: every block is handed out once, within memory that has been grown for it.
unsafe impl GlobalAlloc for Bump {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let next = match self.next.load(Ordering::Relaxed) {
            0 => wasm32::memory_size(0) * PAGE,
            next => next,
        };
        let start = next.next_multiple_of(layout.align());
        let end = start + layout.size();
        let have = wasm32::memory_size(0) * PAGE;
        if end > have && wasm32::memory_grow(0, (end - have).div_ceil(PAGE)) == usize::MAX {
            return core::ptr::null_mut();
        }
        self.next.store(end, Ordering::Relaxed);
        start as *mut u8
    }
    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        if place as usize + layout.size() == self.next.load(Ordering::Relaxed) {
            self.next.store(place as usize, Ordering::Relaxed);
        }
    }
}

#[global_allocator]
static MEMORY: Bump = Bump { next: AtomicUsize::new(0) };

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    wasm32::unreachable()
}

/// Checks every level, and gives the place of the outcome: two u32, failures and length, then the text.
#[unsafe(no_mangle)]
pub extern "C" fn check() -> *const u8 {
    let mut text = String::new();
    let mut failed = 0u32;
    for level in Level::ALL {
        let Ok(found) = srbf_levels::check(level) else { continue };
        let failures = found.failures();
        let count: usize = found.worst.iter().map(|w| w.count).sum();
        let verdict = if failures.is_empty() { "passes" } else { "FAILS" };
        let _ = writeln!(text, "level {} {verdict}: {count} numbers compared with f64", level.name());
        for worst in &found.worst {
            let _ = writeln!(text, "  {}: {:.2e}", worst.name, worst.error);
        }
        for failure in &failures {
            let _ = writeln!(text, "  {failure}");
        }
        failed += u32::from(!failures.is_empty());
    }
    let mut outcome = alloc::vec::Vec::new();
    outcome.extend_from_slice(&failed.to_le_bytes());
    outcome.extend_from_slice(&(text.len() as u32).to_le_bytes());
    outcome.extend_from_slice(text.as_bytes());
    outcome.leak().as_ptr()
}
