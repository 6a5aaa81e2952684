//! The one table of allowed errors.
//!
//! An entry must hold, and must not be stale: one that is more than [`SLACK`] times looser than the worst error seen
//! fails as well. The unit of an error is part of the entry: with `t` the exponent of the value, errors of values are
//! divided by `2 + |t|`, as rounding `t` alone costs that much.

use alloc::format;
use alloc::string::String;
use srbf_core::Level;

/// How much looser than the worst error seen an entry may be.
pub const SLACK: f64 = 4.0;

/// One allowed error.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The measured error.
    pub name: &'static str,
    /// The divisor of the error before it is compared.
    pub unit: &'static str,
    /// Largest error that passes.
    pub allowed: f64,
}

const fn entry(name: &'static str, unit: &'static str, allowed: f64) -> Entry {
    Entry { name, unit, allowed }
}

/// Every allowed error against the 50-digit tables.
pub const TABLE: &[Entry] = &[
    entry("special::sphere_integral", "relative", 2e-7),
    entry("special::cap_integral", "relative", 2e-7),
    entry("special::share_within", "relative", 2e-7),
    entry("special::one_minus_cos", "relative", 2e-7),
    entry("special::mean_cosine", "relative", 2e-7),
    entry("special::bessel_i0_scaled", "relative", 2e-7),
    entry("Gaussian::value", "relative / (2 + |t|)", 3e-7),
    entry("Gaussian::pdf", "relative / (2 + |t|)", 3e-7),
    entry("Gaussian::hemisphere_integral", "relative / (2 + |t|)", 3e-7),
    entry("GaussianProduct::exponent", "absolute / (2 + e)", 3e-7),
    entry("GaussianProduct::sharpness", "relative", 2e-7),
    entry("GaussianProduct::value", "relative / (2 + |t|)", 3e-7),
    entry("GaussianProduct::integral", "relative / (2 + e)", 3e-7),
    entry("Lobe::product", "relative / (2 + e)", 3e-7),
    entry("Folded::value", "relative / (2 + |t|)", 3e-7),
    entry("Folded::pdf", "relative / (2 + |t|)", 3e-7),
    entry("Mixture::evaluate scalar", "relative / (2 + |t|)", 3e-7),
    entry("Mixture::evaluate portable", "relative / (2 + |t|)", 3e-7),
    entry("Mixture::evaluate avx2", "relative / (2 + |t|)", 3e-7),
    entry("Mixture::evaluate avx512", "relative / (2 + |t|)", 3e-7),
    entry("Mixture::pdf scalar", "relative / (2 + |t|)", 3e-7),
    entry("Mixture::pdf portable", "relative / (2 + |t|)", 3e-7),
    entry("Mixture::pdf avx2", "relative / (2 + |t|)", 3e-7),
    entry("Mixture::pdf avx512", "relative / (2 + |t|)", 3e-7),
    entry("AbelPoisson::value", "relative", 3e-7),
    entry("AbelPoisson::share_within", "relative", 3e-7),
    entry("AbelPoisson::one_minus_cos", "relative", 4e-7),
    entry("AbelPoisson::inner_product", "relative", 5e-7),
    entry("gaussian_coefficients_into", "relative / (l + 5)", 6e-8),
    entry("abel_poisson_coefficients_into", "relative / (l + 2)", 5e-8),
];

/// As of any lobe; see [`squeezed_unit`].
const SQUEEZED: f64 = 3e-7;

/// Every allowed error of the levels against f64, at every count: tests/levels.
pub const LEVELS: &[Entry] = &[
    entry("batch value", "relative / (2 + |t|)", 3e-7),
    entry("batch pdf", "relative / (2 + |t|)", 3e-7),
    entry("one value", "relative / (2 + |t|)", 3e-7),
    entry("one pdf", "relative / (2 + |t|)", 3e-7),
    entry("sampled pdf", "relative / (2 + |t|)", 3e-7),
    entry("sampled weight", "relative", 3e-7),
    entry("squeezed pdf", "relative / squeezed_unit", SQUEEZED),
    entry(
        "expanded value",
        "absolute / (largest amplitude x (4 + root of the largest sharpness) / squeeze)",
        1e-7,
    ),
    entry("expanded pdf", "absolute / (as the value)", 1e-7),
    entry("factored value", "absolute / (value of the lobes x largest factor)", 6e-6),
];

/// Every allowed error of environments against f64: tests/tests/environment.rs. What f32 leaves of the digits of a direction moves it
/// by a part of a pixel that grows with the map.
pub const ENVIRONMENT: &[Entry] = &[
    entry("Environment::radiance", "absolute / (largest pixel around x (128 + width + height))", 3e-7),
    entry("Environment::pdf of a sample", "absolute / (largest pdf around x (128 + width + height))", 3e-7),
    entry("Environment::power", "relative", 4e-5),
    entry("integral of Environment::pdf", "relative / (128 + width + height)", 1e-8),
    entry("Mixture::sample_product direction", "absolute", 1e-6),
    entry("Mixture::sample_product weight", "relative / (2^-23 + what directions 1e-6 off change)", 2.0),
];

/// Largest relative error of the length r of a squeezed direction, which f32 holds. It is the root of `x x + (y y + z z)` in fused
/// operations, of x and y without what f32 rounds away of them: three roundings of at most 2^-24, and two for the parts left out of
/// the squares. Half of them count in the root, which is rounded itself.
const LENGTH: f64 = 3.5 / 16_777_216.0;

/// The divisor of the relative error of a squeezed lobe, of sharpness `s` and an axis of such a squared length, at the exponent
/// `t`.
///
/// A lobe of axis a sees a direction d, squeezed to M d of length r, as `|M d - r a|^2 / r^2`. With r rounded to `r (1 + e)` and
/// `u = M d / r` that is `|u - a - e a|^2 = |u - a|^2 (1 + e) + e (|a|^2 - 1) + e^2`, as `2 a (u - a) = 1 - |a|^2 - |u - a|^2`. The
/// exponent is `s / 2` times it. So relative errors count in `|t|`, as every rounding of the exponent does; the rest is there
/// even where the exponent is 0: for an axis of length 1 2.2e-6 of the value at the largest sharpness, 1e8.
pub fn squeezed_unit(s: f64, axis_squared: f64, t: f64) -> f64 {
    2.0 + t.abs() + 0.5 * s * LENGTH * (LENGTH + (axis_squared - 1.0).abs()) / SQUEEZED
}

/// Worst error seen of one entry, and where.
#[derive(Clone, Debug)]
pub struct Worst {
    /// Which entry.
    pub name: String,
    /// Largest error, in the entry's unit.
    pub error: f64,
    /// The input at which it was seen.
    pub place: String,
    /// How many comparisons were made.
    pub count: usize,
}

impl Worst {
    /// Nothing seen yet.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), error: 0.0, place: String::new(), count: 0 }
    }

    /// Takes one error into account; a NaN counts as infinite.
    pub fn see(&mut self, error: f64, place: impl FnOnce() -> String) {
        self.count += 1;
        let error = if error.is_nan() { f64::INFINITY } else { error };
        if error > self.error {
            (self.error, self.place) = (error, place());
        }
    }

    fn entry(&self) -> Option<&'static Entry> {
        TABLE.iter().chain(LEVELS).chain(ENVIRONMENT).find(|e| e.name == self.name)
    }

    /// Why this fails its entry, if it does. Only a machine that has every level tells that an entry is stale: one of the others may
    /// need it.
    pub fn failure(&self) -> Option<String> {
        let stale = || {
            let (entry, Self { name, error, .. }) = (self.entry()?, self);
            (Level::Avx512.is_available() && entry.allowed > SLACK * error).then(|| {
                format!("{name}: {:.1e} is stale, no error above {error:.3e} {}", entry.allowed, entry.unit)
            })
        };
        self.excess().or_else(stale)
    }

    /// Why this fails its entry, but for an entry that others of its name need as loose as it is.
    pub fn excess(&self) -> Option<String> {
        let Self { name, error, place, count } = self;
        let Some(entry) = self.entry() else {
            return Some(format!("{name} has no entry in the table of tolerances"));
        };
        if *count == 0 {
            Some(format!("{name}: nothing was compared"))
        } else if *error > entry.allowed {
            Some(format!("{name}: {error:.3e} {} exceeds {:.1e}, at {place}", entry.unit, entry.allowed))
        } else {
            None
        }
    }
}
