//! Which back end runs: detected once with `core` alone, cached, overridable.

use crate::Error;
use core::sync::atomic::{AtomicU8, Ordering};

/// An instruction set that the kernels are compiled for.
///
/// # Examples
/// ```
/// use srbf_core::Level;
///
/// assert!(Level::current().is_available());
/// assert_eq!(Level::from_name("scalar"), Some(Level::Scalar));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Level {
    /// One f32 at a time: the reference for every other level, and all there is without the feature `simd`. With
    /// `--cfg srbf_vectors_only` among the flags of the compiler it is not there, and the code is smaller by a third.
    Scalar = 1,
    /// `wide`: SSE2, NEON, wasm simd128, or the instructions that the whole build targets.
    Portable = 2,
    /// x86-64 with AVX2 and FMA (and BMI1, BMI2 and POPCNT, which every such processor has).
    Avx2 = 3,
    /// x86-64 with AVX-512 F, VL, DQ and BW, and all of [`Avx2`](Self::Avx2).
    Avx512 = 4,
}

/// Whether [`Level::Scalar`] is compiled. A feature would be turned on for whoever needs it by another package that does not.
pub(super) const HAS_SCALAR: bool = !cfg!(all(feature = "simd", srbf_vectors_only));

/// The level that [`Level::set`] chose, or the best one; 0 until it is asked for.
static CURRENT: AtomicU8 = AtomicU8::new(0);

/// The best level; 0 until the first look at the processor. A virtual machine takes microseconds to tell.
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
static BEST: AtomicU8 = AtomicU8::new(0);

impl Level {
    /// Every level, slowest first.
    pub const ALL: [Self; 4] = [Self::Scalar, Self::Portable, Self::Avx2, Self::Avx512];

    /// The word for the level on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The level of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|level| level.name() == name)
    }

    /// Whether this processor and this build can run the level.
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => HAS_SCALAR,
            Self::Portable | Self::Avx2 | Self::Avx512 => self <= best(),
        }
    }

    /// The level that mixtures prepared from now on use: the best available one, unless [`set`](Self::set)
    /// chose.
    #[inline]
    pub fn current() -> Self {
        Self::of_code(CURRENT.load(Ordering::Relaxed)).unwrap_or_else(take_the_best)
    }

    /// The level of a code; `None` for 0.
    #[inline(always)]
    fn of_code(code: u8) -> Option<Self> {
        match code {
            1 => Some(Self::Scalar),
            2 => Some(Self::Portable),
            3 => Some(Self::Avx2),
            4 => Some(Self::Avx512),
            _ => None,
        }
    }

    /// Chooses the level of every mixture prepared from now on, in all threads.
    ///
    /// # Errors
    /// [`Error::Level`] if this processor or this build lacks it; nothing changes then.
    pub fn set(self) -> Result<(), Error> {
        if !self.is_available() {
            return Err(Error::Level);
        }
        CURRENT.store(self as u8, Ordering::Relaxed);
        Ok(())
    }
}

#[cold]
fn take_the_best() -> Level {
    let level = best();
    // Two threads that both detect store the same; one that has chosen meanwhile keeps its choice. Small
    // processors without this instruction have one level to detect.
    #[cfg(target_has_atomic = "8")]
    let _ = CURRENT.compare_exchange(0, level as u8, Ordering::Relaxed, Ordering::Relaxed);
    level
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
fn best() -> Level {
    Level::of_code(BEST.load(Ordering::Relaxed)).unwrap_or_else(|| {
        let level = detect().min(cap());
        BEST.store(level as u8, Ordering::Relaxed);
        level
    })
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[cold]
fn detect() -> Level {
    use super::processor::cpuid;
    let bit = |word: u32, n: u32| word >> n & 1 == 1;
    // Leaf 1: FMA, POPCNT, XSAVE enabled by the system, AVX, F16C. Leaf 7: BMI1, AVX2, BMI2 and AVX-512.
    let highest = cpuid(0).eax;
    if highest < 7 {
        return Level::Portable;
    }
    let ecx1 = cpuid(1).ecx;
    if ![12, 23, 27, 28, 29].into_iter().all(|n| bit(ecx1, n)) {
        return Level::Portable;
    }
    let saved = enabled_state();
    let ebx7 = cpuid(7).ebx;
    let avx2 = [3, 5, 8].into_iter().all(|n| bit(ebx7, n)) && saved & 0b110 == 0b110;
    let avx512 = [16, 17, 30, 31].into_iter().all(|n| bit(ebx7, n)) && saved & 0b1110_0110 == 0b1110_0110;
    match (avx2, avx512) {
        (true, true) => Level::Avx512,
        (true, false) => Level::Avx2,
        _ => Level::Portable,
    }
}

/// The register state that the operating system saves; call only where OSXSAVE is reported.
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[allow(unsafe_code)]
fn enabled_state() -> u64 {
    #[target_feature(enable = "xsave")]
    fn xgetbv() -> u64 {
        // SAFETY: register 0 always exists where XSAVE does.
        unsafe { core::arch::x86_64::_xgetbv(0) }
    }
    // SAFETY: the caller has seen OSXSAVE.
    unsafe { xgetbv() }
}

#[cfg(not(all(feature = "simd", target_arch = "x86_64")))]
fn best() -> Level {
    if cfg!(feature = "simd") { Level::Portable.min(cap()) } else { Level::Scalar }
}

/// The best level that may be found.
#[cfg(not(feature = "level-from-environment"))]
fn cap() -> Level {
    Level::Avx512
}

/// The best level that may be found, as on a machine that has no more: the variable `SRBF_LEVEL` names it.
#[cfg(feature = "level-from-environment")]
fn cap() -> Level {
    extern crate std;
    let Some(name) = std::env::var_os("SRBF_LEVEL") else { return Level::Avx512 };
    let level = name.to_str().and_then(Level::from_name);
    level.unwrap_or_else(|| panic!("SRBF_LEVEL is {name:?}; it may be scalar, portable, avx2 or avx512"))
}
