//! A Cortex-M under QEMU: start, text and end by semihosting, a clock.
#![allow(unsafe_code)]

use core::arch::{asm, global_asm};
use core::ptr::{addr_of, read_volatile, write_volatile};

unsafe extern "C" {
    static stack_low: u32;
}

// Vectors: the stack, the start; every fault ends the program.
global_asm!(
    ".section .vectors, \"a\"",
    ".word stack_high, reset",
    ".rept 14",
    ".word fault",
    ".endr",
    ".text",
    ".thumb_func",
    "reset:",
    "ldr r0, =data_start",
    "ldr r1, =data_end",
    "ldr r2, =data_from",
    "1: cmp r0, r1",
    "bhs 2f",
    "ldr r3, [r2]",
    "str r3, [r0]",
    "adds r0, #4",
    "adds r2, #4",
    "b 1b",
    "2: ldr r0, =bss_start",
    "ldr r1, =bss_end",
    "movs r3, #0",
    "3: cmp r0, r1",
    "bhs 4f",
    "str r3, [r0]",
    "adds r0, #4",
    "b 3b",
    "4: bl start",
    ".thumb_func",
    "fault:",
    "bl faulted",
);

#[unsafe(no_mangle)]
extern "C" fn start() -> ! {
    #[cfg(target_abi = "eabihf")]
    enable_floats();
    clock::start();
    crate::run()
}

#[unsafe(no_mangle)]
extern "C" fn faulted() -> ! {
    write(b"the processor reports a fault\n");
    end(1)
}

/// The coprocessors of floating point.
#[cfg(target_abi = "eabihf")]
fn enable_floats() {
    const ACCESS: *mut u32 = 0xe000_ed88 as *mut u32;
    // SAFETY: the register of this address is there in every processor with floating point.
    unsafe { write_volatile(ACCESS, read_volatile(ACCESS) | 0xf << 20) };
    // SAFETY: barriers.
    unsafe { asm!("dsb", "isb") };
}

/// Asks the emulator.
fn semihosting(operation: u32, argument: *const u32) {
    // SAFETY: the emulator reads no more than the operation is defined to read.
    unsafe { asm!("bkpt 0xab", inout("r0") operation => _, in("r1") argument) };
}

/// Writes bytes on the terminal.
pub fn write(bytes: &[u8]) {
    for byte in bytes {
        semihosting(3, core::ptr::from_ref(byte).cast());
    }
}

/// Ends the program, with a status.
pub fn end(status: u32) -> ! {
    loop {
        semihosting(0x20, [0x2_0026, status].as_ptr());
    }
}

/// Nanoseconds of the emulator, one an instruction; coarse.
pub use clock::now;

/// The memory below the stack of the caller, and its stack.
pub fn below_stack() -> (*mut u32, *mut u32) {
    let here: *mut u32;
    // SAFETY: it only reads the register.
    unsafe { asm!("mov {}, sp", out(reg) here) };
    (addr_of!(stack_low).cast_mut(), here)
}

/// SysTick, at 25 MHz on the boards MPS2.
#[cfg(not(feature = "microbit"))]
mod clock {
    use super::*;
    const CONTROL: *mut u32 = 0xe000_e010 as *mut u32;
    const RELOAD: *mut u32 = 0xe000_e014 as *mut u32;
    const CURRENT: *mut u32 = 0xe000_e018 as *mut u32;

    pub fn start() {
        // SAFETY: the timer of every such board; the processor's own clock.
        unsafe {
            write_volatile(RELOAD, 0xff_ffff);
            write_volatile(CURRENT, 0);
            write_volatile(CONTROL, 5);
        }
    }

    pub fn now() -> u32 {
        // SAFETY: as above. It counts down.
        let ticks = 0xff_ffff - unsafe { read_volatile(CURRENT) };
        ticks * 40
    }
}

/// The timer 0 of the nRF51, at 16 MHz.
#[cfg(feature = "microbit")]
mod clock {
    use super::*;
    const TIMER: usize = 0x4000_8000;

    fn register(offset: usize) -> *mut u32 {
        (TIMER + offset) as *mut u32
    }

    pub fn start() {
        // SAFETY: the registers of the timer: 32 bits, no division, start.
        unsafe {
            write_volatile(register(0x508), 3);
            write_volatile(register(0x510), 0);
            write_volatile(register(0x000), 1);
        }
    }

    pub fn now() -> u32 {
        // SAFETY: captures the count, and reads it.
        let ticks = unsafe {
            write_volatile(register(0x040), 1);
            read_volatile(register(0x540))
        };
        (ticks as u64 * 125 / 2) as u32
    }
}
