//! Checks AVX-512, and writes the outcome to port 0xe9, which Bochs prints.
#![no_std]

extern crate alloc;

use core::alloc::{GlobalAlloc, Layout};
use core::arch::asm;
use core::fmt::{self, Write};
use core::sync::atomic::{AtomicUsize, Ordering};
use srbf_core::Level;

/// The port whose bytes Bochs prints; a serial port would have to be set up first.
struct Console;

impl Write for Console {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            // SAFETY: nothing but the port is touched.
            unsafe { asm!("out 0xe9, al", in("al") byte, options(nomem, nostack)) };
        }
        Ok(())
    }
}

/// Hands out the memory after the image, and never takes it back. One processor, no interrupts.
struct Bump(AtomicUsize);

/// The memory that the page tables of start.S map.
const END: usize = 1 << 30;

// SAFETY: every block is handed out once, within the mapped memory after the image.
unsafe impl GlobalAlloc for Bump {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let start = self.0.load(Ordering::Relaxed).next_multiple_of(layout.align());
        if start + layout.size() > END {
            return core::ptr::null_mut();
        }
        self.0.store(start + layout.size(), Ordering::Relaxed);
        start as *mut u8
    }
    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // The last block may be taken back: most are short-lived.
        if place as usize + layout.size() == self.0.load(Ordering::Relaxed) {
            self.0.store(place as usize, Ordering::Relaxed);
        }
    }
}

#[global_allocator]
static MEMORY: Bump = Bump(AtomicUsize::new(64 << 20));

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    let _ = writeln!(Console, "{info}\nlevels ended with 2");
    halt()
}

fn halt() -> ! {
    loop {
        // SAFETY: interrupts are off, so the processor stops for good.
        unsafe { asm!("cli", "hlt") };
    }
}

/// The entry, called by start.S in 64-bit mode.
#[unsafe(no_mangle)]
pub extern "C" fn srbf_bare_metal() -> ! {
    let mut failed = 0;
    for level in [Level::Avx512] {
        let Ok(found) = srbf_levels::check(level) else {
            let _ = writeln!(Console, "level {} NOT RUN: this machine lacks it", level.name());
            continue;
        };
        let failures = found.failures();
        let count: usize = found.worst.iter().map(|w| w.count).sum();
        let verdict = if failures.is_empty() { "passes" } else { "FAILS" };
        let _ = writeln!(Console, "level {} {verdict}: {count} numbers compared with f64", level.name());
        for worst in &found.worst {
            let _ = writeln!(Console, "  {}: {:.2e}", worst.name, worst.error);
        }
        for failure in &failures {
            let _ = writeln!(Console, "  {failure}");
        }
        failed += usize::from(!failures.is_empty());
    }
    let _ = writeln!(Console, "levels ended with {failed}");
    halt()
}
