//! What processor this is, for reports of times: by the processor's own word, so that two machines which a system names
//! alike are told apart.

use core::fmt;

/// A processor by its maker, family and model; of other architectures than x86-64, whose programs cannot ask, by
/// the name of that.
///
/// ```
/// # use srbf_core::Processor;
/// println!("times are of: {}", Processor::this()); // "AuthenticAMD, family 26, model 2"
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Processor {
    maker: [u8; 12],
    family: u32,
    model: u32,
}

impl Processor {
    /// The one that this runs on.
    pub fn this() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let (name, signature) = (cpuid(0), cpuid(1).eax);
            let mut maker = [0; 12];
            for (to, word) in maker.chunks_exact_mut(4).zip([name.ebx, name.edx, name.ecx]) {
                to.copy_from_slice(&word.to_le_bytes());
            }
            let base = signature >> 8 & 15;
            let family = if base == 15 { base + (signature >> 20 & 255) } else { base };
            let extended = if base == 6 || base == 15 { (signature >> 16 & 15) << 4 } else { 0 };
            Self { maker, family, model: extended | signature >> 4 & 15 }
        }
        #[cfg(not(target_arch = "x86_64"))]
        Self { maker: [0; 12], family: 0, model: 0 }
    }
}

/// A leaf of numbers by which the processor describes itself.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, unused_unsafe, reason = "newer compilers than the oldest that works call it safe")]
pub(crate) fn cpuid(leaf: u32) -> core::arch::x86_64::CpuidResult {
    // SAFETY: every processor of x86-64 has the instruction, and answers for a leaf that it does not know too.
    unsafe { core::arch::x86_64::__cpuid_count(leaf, 0) }
}

impl fmt::Display for Processor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.maker == [0; 12] {
            return f.write_str(if cfg!(target_arch = "aarch64") { "aarch64" } else { "not an x86-64" });
        }
        let maker = core::str::from_utf8(&self.maker).unwrap_or("unknown");
        write!(f, "{maker}, family {}, model {}", self.family, self.model)
    }
}
