//! How fast the core is just now: how long a cycle takes, and how many instructions a cycle it takes.
//!
//! Machines in a data centre share their cores: a neighbour's thread on the same core takes every other turn of its front end, and
//! everything here then takes up to twice as long. Seen from inside, that is a core that takes fewer instructions a cycle.
#![allow(unsafe_code)]

use core::arch::asm;
use std::time::Instant;

/// Additions of a probe, each of which waits for the one before, and instructions that wait for nothing.
const CHAIN: u32 = 32_768;
const FREE: u32 = 65_536;

/// The work of a core at some moment.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    /// Seconds that a cycle takes: a dependent addition takes one.
    pub cycle: f64,
    /// Instructions that it takes in a cycle.
    pub rate: f64,
}

impl Probe {
    /// Looks at the core for some ten microseconds.
    pub fn take() -> Self {
        let cycle = seconds(|| {
            let mut x = 0u64;
            // From a register: some cores add a small constant while they rename registers, in no time.
            let step = core::hint::black_box(1u64);
            for _ in 0..CHAIN / 8 {
                // SAFETY: adds to one register, which is given.
                unsafe {
                    asm!(
                        "add {0}, {1}", "add {0}, {1}", "add {0}, {1}", "add {0}, {1}",
                        "add {0}, {1}", "add {0}, {1}", "add {0}, {1}", "add {0}, {1}",
                        inout(reg) x, in(reg) step, options(nomem, nostack)
                    );
                }
            }
            core::hint::black_box(x);
        }) / f64::from(CHAIN);
        let free = seconds(|| {
            for _ in 0..FREE / 32 {
                // SAFETY: instructions that do nothing.
                unsafe {
                    asm!(
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        "nop",
                        options(nomem, nostack, preserves_flags)
                    );
                }
            }
        }) / f64::from(FREE);
        Self { cycle, rate: cycle / free }
    }
}

fn seconds(run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64()
}
