//! How much work a search is: measured tables need more than samples, which are completed to something smooth.

use crate::isotropic::tuning::stored_views::{PROBED, PROBED_GRAZING};
use crate::table::Density;

/// How much work a search is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Divisors of the starts and exchanges of the settings.
    pub starts: usize,
    pub exchanges: usize,
    /// Divisor of the steps of the settings.
    pub steps: usize,
    /// Times that fits are moved again, at most.
    pub rounds: usize,
    /// Times that factors and lobes are fitted in turn.
    pub factor_rounds: usize,
    /// How densely a table is made, and its views between two of the material's.
    pub density: Density,
    pub views_between: usize,
    /// How densely albedos at grazing views are integrated.
    pub grazing: Density,
    /// Whether values towards grazing light were measured.
    pub is_dense: bool,
}

/// For a BRDF.
pub(crate) const MEASURED: Effort = Effort {
    starts: 1,
    exchanges: 1,
    steps: 1,
    rounds: 3,
    factor_rounds: 2,
    density: Density { hemisphere: 350, cap: 100 },
    views_between: 3,
    grazing: PROBED_GRAZING,
    is_dense: true,
};

/// For the completion of samples.
pub(crate) const COMPLETED: Effort = Effort {
    starts: 4,
    exchanges: 4,
    steps: 2,
    rounds: 1,
    factor_rounds: 1,
    density: Density { hemisphere: 350, cap: 100 },
    views_between: 3,
    grazing: PROBED,
    is_dense: false,
};
