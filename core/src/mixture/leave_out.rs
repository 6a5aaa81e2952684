//! The parts that a mixture may leave out for one outgoing direction.

use crate::error::Error;

/// What [`Material::prepare_with`](crate::Material::prepare_with) may leave out of a mixture.
///
/// The default is what [`Material::prepare`](crate::Material::prepare) does: every lobe stays, and a fold is
/// left out where it is below f32 rounding.
///
/// # Examples
/// ```
/// use srbf_core::LeaveOut;
///
/// // Lobes with up to a thousandth of the albedo; of the folds what rounding does not show.
/// let leave_out = LeaveOut::new(1e-3, 1e-7)?;
/// assert_ne!(leave_out, LeaveOut::default());
/// assert!(LeaveOut::new(2.0, 0.0).is_err());
/// # Ok::<(), srbf_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeaveOut {
    pub(crate) lobes: f32,
    /// A lobe is folded if `s (1 - t)` is below this: `-ln` of the share; see [`Mixture`](crate::Mixture),
    /// "Which lobes are folded".
    pub(crate) fold_exponent: f32,
}

impl Default for LeaveOut {
    fn default() -> Self {
        // -ln 1e-7
        Self { lobes: 0.0, fold_exponent: 16.118_095 }
    }
}

impl LeaveOut {
    /// The bounds below which lobes and folds are left out, both as shares in [0, 1].
    ///
    /// `lobes`: a lobe is dropped if its share of the luminance of the albedo is below this; the albedo of a
    /// mixture of K lobes loses at most K times it, and density and samples are those of the lobes that stay.
    /// `folds`: the second term of a folded lobe is left out if at most this share of the lobe lies below the
    /// horizon; the value and the density change by at most this share of the lobe's amplitude. Samples are still mirrored up, and
    /// albedo and power are those of the whole lobe: an estimate that divides by the density is too low by at most this share. The
    /// default is 0 and 1e-7.
    ///
    /// # Errors
    /// [`Error::Share`].
    pub fn new(lobes: f32, folds: f32) -> Result<Self, Error> {
        let is_share = |share| (0.0..=1.0).contains(&share);
        if !(is_share(lobes) && is_share(folds)) {
            return Err(Error::Share);
        }
        let fold_exponent = if folds > 0.0 { -crate::float::ln(folds) } else { f32::INFINITY };
        Ok(Self { lobes, fold_exponent })
    }
}
