//! A RISC-V under QEMU: start, text and end by semihosting, a clock.
#![allow(unsafe_code)]

use core::arch::{asm, global_asm};
use core::ptr::addr_of;

unsafe extern "C" {
    static stack_low: u32;
}

global_asm!(
    ".section .start, \"ax\"",
    ".globl reset",
    "reset:",
    "la sp, stack_high",
    "la t0, faulted",
    "csrw mtvec, t0",
    "la t0, data_start",
    "la t1, data_end",
    "la t2, data_from",
    "1: bgeu t0, t1, 2f",
    "lw t3, 0(t2)",
    "sw t3, 0(t0)",
    "addi t0, t0, 4",
    "addi t2, t2, 4",
    "j 1b",
    "2: la t0, bss_start",
    "la t1, bss_end",
    "3: bgeu t0, t1, 4f",
    "sw zero, 0(t0)",
    "addi t0, t0, 4",
    "j 3b",
    "4: call start",
    // Of one page, with these two around it, the emulator is asked.
    ".option push",
    ".option norvc",
    ".balign 16",
    ".globl semihosting_call",
    "semihosting_call:",
    "slli x0, x0, 0x1f",
    "ebreak",
    "srai x0, x0, 7",
    "ret",
    ".option pop",
    ".balign 4",
    ".globl faulted",
    "faulted:",
    "call fault",
);

#[unsafe(no_mangle)]
extern "C" fn start() -> ! {
    crate::run()
}

#[unsafe(no_mangle)]
extern "C" fn fault() -> ! {
    write(b"the processor reports a fault\n");
    end(1)
}

fn semihosting(operation: u32, argument: *const u32) {
    // SAFETY: the emulator reads no more than the operation is defined to read.
    unsafe { asm!("call semihosting_call", inout("a0") operation => _, in("a1") argument, out("ra") _) };
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

/// Instructions that the processor has run.
pub fn now() -> u32 {
    let count: u32;
    // SAFETY: it only reads the counter.
    unsafe { asm!("csrr {}, minstret", out(reg) count) };
    count
}

/// The memory below the stack of the caller, and its stack.
pub fn below_stack() -> (*mut u32, *mut u32) {
    let here: *mut u32;
    // SAFETY: it only reads the register.
    unsafe { asm!("mv {}, sp", out(reg) here) };
    (addr_of!(stack_low).cast_mut(), here)
}
