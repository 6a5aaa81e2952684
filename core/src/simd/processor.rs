//! What processor this is, for reports of times: by the processor's own word, so that two machines which a system names
//! alike are told apart.

use core::fmt;

/// A processor of x86-64, by its maker, family and model.
///
/// ```
/// # use srbf_core::Processor;
/// if let Some(processor) = Processor::this() {
///     println!("times are of an {processor}"); // "AuthenticAMD, family 26, model 2"
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Processor {
    maker: [u8; 12],
    family: u32,
    model: u32,
}

impl Processor {
    /// The one that this runs on; `None` where programs cannot ask.
    pub fn this() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        {
            use core::arch::x86_64::__cpuid;
            let (name, signature) = (__cpuid(0), __cpuid(1).eax);
            let mut maker = [0; 12];
            for (to, word) in maker.chunks_exact_mut(4).zip([name.ebx, name.edx, name.ecx]) {
                to.copy_from_slice(&word.to_le_bytes());
            }
            let base = signature >> 8 & 15;
            let family = if base == 15 { base + (signature >> 20 & 255) } else { base };
            let extended = if base == 6 || base == 15 { (signature >> 16 & 15) << 4 } else { 0 };
            Some(Self { maker, family, model: extended | signature >> 4 & 15 })
        }
        #[cfg(not(target_arch = "x86_64"))]
        None
    }
}

impl fmt::Display for Processor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let maker = core::str::from_utf8(&self.maker).unwrap_or("unknown");
        write!(f, "{maker}, family {}, model {}", self.family, self.model)
    }
}
