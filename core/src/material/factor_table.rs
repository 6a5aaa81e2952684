//! The table of factors as it is given to a writer, and the codes by which it is stored.

use super::format_error::FormatError;
use super::layout::{Header, u32_at};

/// Code of the largest factor: a code over this, squared, times the largest, is a factor.
pub(crate) const MOST_CODE: f32 = 255.0;

/// In version 2 a code over this, squared, is the factor.
pub(crate) const UNIT_2: f32 = 360.0;

/// Largest factor that there is: that of the largest code of version 2, and what rounds to it.
pub(crate) const MOST_FACTOR: f32 = (1023.5 / 360.0) * (1023.5 / 360.0);

/// Least of a largest factor that is not 0: the kernels multiply it by down to 2^-48, and digits of a subnormal would be lost.
pub(crate) const LEAST_LARGEST: f32 = 1e-20;

/// Table sizes that there are, along half angle and difference angle, and along the azimuth.
pub(crate) const SIZES: core::ops::RangeInclusive<usize> = 2..=32;
pub(crate) const AZIMUTHS: core::ops::RangeInclusive<usize> = 1..=8;

/// Factor on the square of a code, for a table with a number of bits a channel and a largest factor.
#[inline(always)]
pub(crate) fn scale(bits: u8, largest: f32) -> f32 {
    if bits == 8 { largest * (1.0 / (MOST_CODE * MOST_CODE)) } else { 1.0 / (UNIT_2 * UNIT_2) }
}

/// A node's three codes, one behind the other as the lowest bits; `offset` is the node's, behind which the checksum
/// stands at least.
pub(crate) fn node_at(bytes: &[u8], header: &Header, offset: usize) -> u32 {
    let four = u32_at(bytes, offset);
    if header.node_len() == 3 { four & 0xff_ffff } else { four }
}

/// The factor of a channel of a node; `place` counts the channels.
pub(crate) fn decoded(node: u32, place: usize, bits: u8, largest: f32) -> f32 {
    let code = node >> (usize::from(bits) * place) & ((1 << bits) - 1);
    let (unit, scale) = if bits == 8 { (MOST_CODE, largest) } else { (UNIT_2, 1.0) };
    let root = f64::from(code) / f64::from(unit);
    (root * root * f64::from(scale)) as f32
}

/// The largest factor of a node of version 2.
pub(crate) fn largest_2(node: u32) -> f32 {
    let largest = (0..3).map(|place| node >> (10 * place) & 0x3ff).fold(0, u32::max);
    // Whole numbers that f32 has: rounded once.
    (largest * largest) as f32 / (UNIT_2 * UNIT_2)
}

/// Factors over half angle, difference angle and azimuth, for all views of a material; see
/// [`Material::factor`](crate::Material::factor).
///
/// ```
/// use srbf_core::{FactorTable, Line, Material, PlaneLobe, View};
///
/// let lobes = [PlaneLobe {
///     angle: 0.0,
///     off_plane: 0.0,
///     log2_sharpness: 3.0,
///     log2_luminance: -2.0,
///     color_differences: [0.0; 2],
/// }];
/// let none = [0.0; 2];
/// let view = View { theta: 0.0, log2_squeeze: 0.0, log2_diffuse: -126.0, diffuse_color_differences: none, lobes: &lobes };
/// // Twice as bright everywhere: the albedo differs by as much as there was.
/// let factors = FactorTable { half: 2, difference: 2, azimuth: 1, is_signed: false, factors: &[[2.0; 3]; 4], albedo_differences: &[[1.0; 3]] };
/// let line = Line { views: &[view], squeezed: 0, mirrored: 0, factors: Some(factors) };
/// let mut bytes = vec![0; line.encoded_len("")];
/// line.encode("", &mut bytes)?;
/// let material = Material::from_bytes(bytes)?;
/// let factor = material.factor([0.0, 0.0, 1.0], [0.6, 0.0, 0.8]);
/// assert!((factor.x - 2.0).abs() < 0.01, "{factor}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct FactorTable<'a> {
    /// Nodes along the half angle, in `(1 - h.z)^(1/4)`; 2 to 32.
    pub half: usize,
    /// Nodes along the difference angle, in `(1 - h.wo)^(1/2)`; 2 to 32.
    pub difference: usize,
    /// Nodes along the azimuth, in `cos^2 phi`; 1 to 8, 1 where the factors do not depend on it.
    pub azimuth: usize,
    /// Whether they are in `cos phi |cos phi|`, from -1 to 1: the factors of two directions that change places are two then. The
    /// cosine is positive where the incident direction is the higher one.
    pub is_signed: bool,
    /// Factors, linear sRGB, [azimuth * half * difference], those of one azimuth together, and in them those of one
    /// half angle; [0, 8.08]. Their roots are rounded to 1/255 of the largest one; if that is below 1e-20, all are 0. Where a half angle or a difference
    /// angle is 0 there is no azimuth: there the factors of all have to be the same.
    pub factors: &'a [[f32; 3]],
    /// The change of the albedo by the factors, `(B - A) / Y`: B is the albedo with factors, A that of lobes and
    /// diffuse term without, Y the luminance of A; linear sRGB, one a view, in the order of the views; [-16, 16].
    pub albedo_differences: &'a [[f32; 3]],
}

impl FactorTable<'_> {
    /// Its sizes as a file has them.
    pub(crate) fn shape(table: Option<&Self>) -> [u8; 3] {
        // A number that is too large stays too large.
        table.map_or([0; 3], |t| [t.half, t.difference, t.azimuth].map(|n| n.min(255) as u8))
    }

    /// Refuses factors that have no place in a file; `offset` is that of the block.
    pub(crate) fn check(&self, views: usize, offset: usize) -> Result<(), FormatError> {
        let Self { half, difference, azimuth, is_signed, factors, albedo_differences } = *self;
        let field = |name| Err(FormatError::Field { name, offset });
        if ![half, difference].iter().all(|n| SIZES.contains(n)) || !AZIMUTHS.contains(&azimuth) {
            return field("size of the table of factors");
        }
        if is_signed && azimuth == 1 {
            return field("sign of one azimuth");
        }
        if factors.len() != azimuth * half * difference {
            return field("number of factors");
        }
        if albedo_differences.len() != views {
            return field("number of albedo differences");
        }
        // False for NaN too.
        if !factors.iter().flatten().all(|f| (0.0..=MOST_FACTOR).contains(f)) {
            return field("factor");
        }
        let plane = half * difference;
        let has_no_azimuth = |n: usize| n < difference || n.is_multiple_of(difference);
        if (plane..factors.len()).any(|n| has_no_azimuth(n % plane) && factors[n] != factors[n % plane]) {
            return field("factor where there is no azimuth");
        }
        Ok(())
    }

    /// The largest factor as it is written: too small a one is 0.
    pub(crate) fn largest(&self) -> f32 {
        let largest = self.factors.iter().flatten().fold(0.0f32, |most, f| most.max(*f));
        if largest < LEAST_LARGEST { 0.0 } else { largest }
    }

    /// A node's three codes, given the largest factor of all.
    pub(crate) fn node(factor: &[f32; 3], largest: f32) -> [u8; 3] {
        let scale = if largest > 0.0 { 1.0 / f64::from(largest) } else { 0.0 };
        factor.map(|f| (f64::from(MOST_CODE) * libm::sqrt(f64::from(f) * scale) + 0.5) as u8)
    }
}
