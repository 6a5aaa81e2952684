//! The table of factors as it is given to a writer, and the codes by which it is stored.
//!
//! A factor is stored as `q` in 0..=1023, as `(q / 360)^2`.

use super::format_error::FormatError;
use super::layout::NODES;

/// A code over this, squared, is the factor.
pub(crate) const UNIT: f32 = 360.0;

/// Largest code of a channel.
pub(crate) const MOST_CODE: u32 = 1023;

/// Table sizes that there are, along either variable.
pub(crate) const SIZES: core::ops::RangeInclusive<usize> = 2..=32;

/// The factor of a channel of a node; `place` counts the channels.
pub(crate) fn decoded(node: u32, place: usize) -> f32 {
    let root = f64::from(node >> (10 * place) & MOST_CODE) / f64::from(UNIT);
    (root * root) as f32
}

/// Factors over the half angle and the difference angle, for all views of a material; see
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
/// let factors = FactorTable { half: 2, difference: 2, factors: &[[2.0; 3]; 4], albedo_differences: &[[1.0; 3]] };
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
    /// Factors, linear sRGB, [half * difference], those of one half angle together; [0, 8.07]. Their roots
    /// are rounded to 1/360.
    pub factors: &'a [[f32; 3]],
    /// What the factors change of the albedo, `(B - A) / Y`: B is the albedo with factors, A that of lobes and
    /// diffuse term without, Y the luminance of A; linear sRGB, one a view, in the order of the views; [-16, 16].
    pub albedo_differences: &'a [[f32; 3]],
}

impl FactorTable<'_> {
    /// Its sizes as the header has them.
    pub(crate) fn shape(table: Option<&Self>) -> [u8; 2] {
        // What is too large stays too large.
        table.map_or([0; 2], |t| [t.half, t.difference].map(|n| n.min(255) as u8))
    }

    /// Refuses what has no place in a file.
    pub(crate) fn check(&self, views: usize) -> Result<(), FormatError> {
        let field = |name| Err(FormatError::Field { name, offset: NODES });
        if ![self.half, self.difference].iter().all(|n| SIZES.contains(n)) {
            return field("size of the table of factors");
        }
        if self.factors.len() != self.half * self.difference {
            return field("number of factors");
        }
        if self.albedo_differences.len() != views {
            return field("number of albedo differences");
        }
        let most = (MOST_CODE as f32 + 0.5) / UNIT;
        // False for NaN too.
        if !self.factors.iter().flatten().all(|f| (0.0..most * most).contains(f)) {
            return field("factor");
        }
        Ok(())
    }

    /// A node's three codes.
    pub(crate) fn node(factor: &[f32; 3]) -> u32 {
        let code = |f: &f32| (f64::from(UNIT) * libm::sqrt(f64::from(*f)) + 0.5) as u32;
        let [red, green, blue] = [code(&factor[0]), code(&factor[1]), code(&factor[2])];
        red.min(MOST_CODE) | green.min(MOST_CODE) << 10 | blue.min(MOST_CODE) << 20
    }
}

/// The largest factor of a node.
pub(crate) fn largest(node: u32) -> f32 {
    (0..3).map(|place| decoded(node, place)).fold(0.0, f32::max)
}
