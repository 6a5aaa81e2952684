//! The baselines: C compiled by the build script, and plain Rust with `libm`.
#![allow(unsafe_code)]

use srbf_core::{AnyMixture, Lobe, Vec3};

type Loop = unsafe extern "C" fn(
    *const f32,
    usize,
    *const f32,
    *const f32,
    *const f32,
    *mut f32,
    *mut f32,
    *mut f32,
    usize,
);

unsafe extern "C" {
    fn srbf_baseline_dot_careful(
        l: *const f32,
        c: usize,
        x: *const f32,
        y: *const f32,
        z: *const f32,
        r: *mut f32,
        g: *mut f32,
        b: *mut f32,
        n: usize,
    );
    fn srbf_baseline_dot_fast(
        l: *const f32,
        c: usize,
        x: *const f32,
        y: *const f32,
        z: *const f32,
        r: *mut f32,
        g: *mut f32,
        b: *mut f32,
        n: usize,
    );
    fn srbf_baseline_chord_fast(
        l: *const f32,
        c: usize,
        x: *const f32,
        y: *const f32,
        z: *const f32,
        r: *mut f32,
        g: *mut f32,
        b: *mut f32,
        n: usize,
    );
    fn srbf_baseline_dot_lobes_fast(
        l: *const f32,
        c: usize,
        x: *const f32,
        y: *const f32,
        z: *const f32,
        r: *mut f32,
        g: *mut f32,
        b: *mut f32,
        n: usize,
    );
}

/// A loop in C, with the compiler flags it was built with.
#[derive(Clone, Copy, Debug)]
pub enum C {
    /// `exp(s (cos - 1))` by `expf`, -O3 -march=native.
    Dot,
    /// The same with -ffast-math.
    DotFast,
    /// The same, lobes outermost, with -ffast-math.
    DotLobesFast,
    /// Chordal form, lobes outermost, with -ffast-math.
    ChordFast,
}

impl C {
    /// Every loop.
    pub const ALL: [Self; 4] = [Self::Dot, Self::DotFast, Self::DotLobesFast, Self::ChordFast];

    /// The name in the names of benches.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dot => "c-expf",
            Self::DotFast => "c-fast-dot",
            Self::DotLobesFast => "c-fast-dot-lobes",
            Self::ChordFast => "c-fast-chord",
        }
    }

    /// Evaluates packed lobes towards directions.
    ///
    /// # Panics
    /// If the slices are not all of one length.
    pub fn evaluate(self, lobes: &PackedLobes, directions: [&[f32]; 3], value: [&mut [f32]; 3]) {
        let n = directions[0].len();
        assert!(directions.iter().all(|s| s.len() == n) && value.iter().all(|s| s.len() == n));
        let [x, y, z] = directions.map(<[f32]>::as_ptr);
        let [r, g, b] = value.map(<[f32]>::as_mut_ptr);
        let function: Loop = match self {
            Self::Dot => srbf_baseline_dot_careful,
            Self::DotFast => srbf_baseline_dot_fast,
            Self::DotLobesFast => srbf_baseline_dot_lobes_fast,
            Self::ChordFast => srbf_baseline_chord_fast,
        };
        // SAFETY: seven arrays of `count` lobes and six of n numbers, as the C function reads and writes them; the
        // outputs are exclusive borrows, so they overlap nothing.
        unsafe { function(lobes.0.as_ptr(), lobes.0.len() / 7, x, y, z, r, g, b, n) }
    }
}

/// Lobes as the C loops take them: seven arrays one after the other.
#[derive(Debug)]
pub struct PackedLobes(Vec<f32>);

impl PackedLobes {
    /// Packs lobes.
    pub fn new(lobes: &[Lobe]) -> Self {
        let mut packed = Vec::new();
        for i in 0..3 {
            packed.extend(lobes.iter().map(|l| l.gaussian.axis[i]));
        }
        packed.extend(lobes.iter().map(|l| l.gaussian.sharpness));
        for i in 0..3 {
            packed.extend(lobes.iter().map(|l| l.amplitude[i]));
        }
        Self(packed)
    }
}

/// One direction at a time, chordal, `libm::expf`: the formulas of the library, without its kernels.
pub fn evaluate_libm(lobes: &[Lobe], direction: Vec3) -> Vec3 {
    lobes.iter().fold(Vec3::ZERO, |sum, lobe| {
        let chord = direction - lobe.gaussian.axis;
        sum + lobe.amplitude * libm::expf(-0.5 * lobe.gaussian.sharpness * chord.length_squared())
    })
}

/// One sample at a time with `libm`: lobe by a scan of the distribution, inversion, density and weight by
/// [`evaluate_libm`].
pub fn sample_libm(lobes: &[Lobe], mixture: &AnyMixture<'_>, u: Vec3) -> (Vec3, f32, Vec3) {
    let mut target = u.x * mixture.power();
    let mut chosen = lobes.len() - 1;
    for (k, lobe) in lobes.iter().enumerate() {
        let power = srbf_core::luminance(lobe.amplitude) * integral(lobe.gaussian.sharpness);
        if target < power {
            chosen = k;
            break;
        }
        target -= power;
    }
    let gaussian = lobes[chosen].gaussian;
    let s = gaussian.sharpness;
    let w = (-libm::log1pf(u.y * libm::expm1f(-2.0 * s)) / s).clamp(0.0, 2.0);
    let across = libm::sqrtf(w * (2.0 - w));
    let (sin, cos) = libm::sincosf(core::f32::consts::TAU * u.z);
    let (tangent, bitangent) = gaussian.axis.any_orthonormal_pair();
    let direction = gaussian.axis * (1.0 - w) + tangent * (across * cos) + bitangent * (across * sin);
    let value = evaluate_libm(lobes, direction);
    let pdf = srbf_core::luminance(value) / mixture.power();
    (direction, pdf, value / pdf)
}

fn integral(s: f32) -> f32 {
    -core::f32::consts::TAU * libm::expm1f(-2.0 * s) / s
}
