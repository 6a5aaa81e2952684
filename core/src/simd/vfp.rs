//! The floating point unit of 32-bit ARM processors: an instruction that the language reaches only with `std`.
#![allow(unsafe_code)]

use core::arch::asm;

/// Square root, correctly rounded.
#[inline(always)]
pub(crate) fn sqrt(x: f32) -> f32 {
    let mut bits = x.to_bits();
    // Through a register of whole numbers: the compiler takes one of floats only where the unit has f64 too.
    // SAFETY: this file is compiled only where floats are passed in registers of the unit, which has the instructions.
    unsafe {
        asm!(
            "vmov s0, {bits}",
            "vsqrt.f32 s0, s0",
            "vmov {bits}, s0",
            bits = inout(reg) bits,
            out("s0") _,
            options(pure, nomem, nostack, preserves_flags)
        );
    }
    f32::from_bits(bits)
}
