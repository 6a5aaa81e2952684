//! Bytes of a mixture and of a material, and the deepest stack of each verb: the memory below the stack is painted, the verb called, and the paint that is left counted.

use crate::machine::below_stack;
use crate::print::{decimal, line, text};
use crate::road::Numbers;
use srbf_core::{Material, Mixture};

const PAINT: u32 = 0x5a5a_a5a5;

/// A call of its own, so that all it needs lies below the stack of who paints.
#[inline(never)]
fn call<F: FnOnce()>(verb: F) {
    verb();
}

/// Bytes of stack that a verb takes, the frame of the call included.
#[inline(never)]
#[allow(unsafe_code)]
fn depth<F: FnOnce()>(verb: F) -> u32 {
    let (low, here) = below_stack();
    let mut at = low;
    while at < here {
        // SAFETY: nothing lives between the end of the data and the stack.
        unsafe { at.write_volatile(PAINT) };
        at = at.wrapping_add(1);
    }
    call(verb);
    at = low;
    // SAFETY: as above.
    while at < here && unsafe { at.read_volatile() } == PAINT {
        at = at.wrapping_add(1);
    }
    here as u32 - at as u32
}

/// Prints the deepest stack of each verb over many directions.
pub fn print(bytes: &'static [u8]) -> Result<(), &'static str> {
    let show = |name: &str, depth: u32| {
        text("stack of ");
        text(name);
        text(" ");
        decimal(depth);
        line();
    };
    for (name, bytes) in [
        ("a mixture of 16 lobes", size_of::<Mixture<'_, 16>>()),
        ("a mixture of 32 lobes", size_of::<Mixture<'_, 32>>()),
        ("a mixture of 64 lobes", size_of::<Mixture<'_, 64>>()),
        ("a material that borrows", size_of::<Material<&[u8]>>()),
    ] {
        text("bytes of ");
        text(name);
        text(" ");
        decimal(bytes as u32);
        line();
    }
    let mut loaded = None;
    show("from_bytes", depth(|| loaded = Material::from_bytes(bytes).ok()));
    let material = loaded.ok_or("the preset is damaged")?;
    let mut mixture = Mixture::<16>::empty();
    let (mut most, mut numbers) = ([0; 5], Numbers(3));
    for _ in 0..64 {
        let (wo, wi, u) = (numbers.direction(), numbers.direction(), numbers.three());
        let (mut sum, mut pdf) = (0.0, 0.0);
        let depths = [
            depth(|| _ = material.prepare(wo, &mut mixture)),
            depth(|| sum = mixture.evaluate(wi).x),
            depth(|| pdf = mixture.pdf(wi)),
            depth(|| pdf += mixture.sample(u).map_or(0.0, |sample| sample.pdf)),
            depth(|| sum += material.sample_and_evaluate(wo, u, wi).1.1),
        ];
        core::hint::black_box((sum, pdf));
        for (most, depth) in most.iter_mut().zip(depths) {
            *most = depth.max(*most);
        }
    }
    for (name, depth) in ["prepare", "evaluate", "pdf", "sample", "sample_and_evaluate"].into_iter().zip(most)
    {
        show(name, depth);
    }
    Ok(())
}
