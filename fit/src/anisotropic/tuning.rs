//! The numbers that the anisotropic fit was tuned by, step by step: the only table of them.
//!
//! Each has the trade-off that it decides. `bash lab/tuning.sh anisotropic::MODULE::NAME=VALUE [-- FILE...]` prints its gain: errors and
//! seconds of fits with the number, and with another value. `docs/tuning.md` has some of these gains.

/// Stored views, tables and starts.
pub(crate) mod views {
    use crate::table::Density;

    /// Angles of the rings of stored views, degrees: closer towards grazing, where a highlight changes fastest.
    pub const RINGS: [f64; 10] = [0.0, 13.0, 26.0, 38.0, 50.0, 60.0, 69.0, 76.0, 82.0, 87.0];
    /// Fewest and most rings for the bytes that a material may take.
    pub const FEWEST_RINGS: usize = 4;
    pub const MOST_RINGS: usize = 24;
    /// Stored views of a ring over half a turn.
    pub const AZIMUTHS: usize = 8;
    /// Pairs of lobes where there are mirrors, as a share of the squeezed lobes.
    pub const PAIRED: f64 = 0.5;
    /// Tabulated views inside each cell of stored views. Half of them, twice as dense, double the error in the middle.
    pub const PER_CELL: usize = 4;
    /// Directions of a stored view.
    pub const AT_STORED_VIEWS: Density = Density { hemisphere: 350, cap: 100 };
    /// Directions of a tabulated view between them.
    pub const BETWEEN: Density = Density { hemisphere: 160, cap: 50 };
    /// Most starts.
    pub const STARTS: usize = 4;
    /// Steps of each start.
    pub const SCOUTING: usize = 12;
    /// Samples for each one that a start is fitted to.
    pub const EVERY: usize = 3;
    /// Factor on the smoothness of the settings. Ward of (0.1, 0.4) has 6.3, 5.1 and 5.8 % with 0.2, 2 and 20.
    pub const ROUGHNESS: f64 = 6.0;
    /// Factor on the smoothness of starts.
    pub const STIFF: f64 = 10.0;
    /// Relative decrease of the cost over five steps below which the solver ends.
    pub const IMPROVEMENT: f64 = 1e-2;
    /// Times that views are weighed again by their error, and the improvement then.
    pub const REWEIGHED: usize = 3;
    pub const FINE: f64 = 3e-3;
}

/// Rounds on tables that the lobes draw, and factors.
pub(crate) mod rounds {
    /// Rounds without factors. On GGX of (0.1, 0.35) none leave 5.5 % between the stored views, 2 5.1 and 4 4.8 %.
    pub const PLAIN: usize = 3;
    /// Factor on the weight of the albedo. Without it the albedo of that GGX is .9 % off in the median and 1.4 % at most, with it .5 and 1.0.
    pub const MORE_ENERGY: f64 = 10.0;
    /// Rounds in which factors and lobes take turns.
    pub const FACTORED: usize = 2;
    /// Largest share of the error that factors may leave.
    pub const WORTH: f64 = 0.9;
}

/// The sum of squares.
pub(crate) mod objective {
    /// Weight of errors away from the peak, over that in the measure. Without it the luminance off the peak of GGX of (0.1, 0.35) is 11.7 %
    /// off in the median; with it 7.3 %, and the L2 error goes from 3.7 to 3.8 %.
    pub const MEASURE: f64 = 1.0;
    /// Weight of the relative variance over that of the squared relative L2 error.
    pub const TAIL: f64 = 0.03;
    /// Weight of the squared relative error of the albedo.
    pub const ENERGY: f64 = 1.0;
    /// Longest step.
    pub const LONGEST_STEP: f64 = 2.0;
    /// Relative residual of a step. A tenth of it changes the result less than another start, in three times the time.
    pub const TOLERANCE: f64 = 0.02;
    /// Most inner steps of a step.
    pub const INNER_STEPS: usize = 150;
}

/// Starts.
pub(crate) mod start {
    /// Least luminance of a start, for albedos of about 1.
    pub const LEAST: f64 = 1e-9;
    /// Distance of a lobe of a pair from the plane of incidence, in widths of the lobe.
    pub const APART: f64 = 0.7;
}

/// Bounds of the unknowns: within those of the format, and no wider than fits need.
pub(crate) mod layout {
    /// Diagonal of the logarithm of the squeeze.
    pub const SQUEEZE: (f64, f64) = (-2.0, 3.2);
    /// Its other element.
    pub const SHEAR: (f64, f64) = (-1.4, 1.4);
    /// Coordinates of the axes.
    pub const TILT: (f64, f64) = (-2.1, 2.1);
}

/// Caps of directions round the peak of a view.
pub(crate) mod table {
    use crate::table::Density;

    /// Directions by which the albedo of a view is found.
    pub const ALBEDO: Density = Density { hemisphere: 2000, cap: 500 };
    /// Directions that lobes draw for a view, and for its albedo.
    pub const DRAWN: usize = 130;
    pub const ALBEDO_DRAWN: usize = 1000;
    /// Sharpness of the widest cap.
    pub const WIDEST: f64 = 8.0;
    /// Factor from one cap to the next.
    pub const NARROWER: f64 = 5.0;
    /// Largest sharpness of a cap.
    pub const NARROWEST: f64 = 4e6;
}

/// The material that is written.
pub(crate) mod encode {
    /// Places between two stored views, each way, at which the albedo is held below that.
    pub const LOOKS: usize = 8;
    /// The same where factors have to be averaged for each.
    pub const FACTORED_LOOKS: usize = 2;
}

/// Amplitudes scaled to the albedo.
pub(crate) mod balance {
    /// Largest logarithm of a factor.
    pub const MOST: f64 = 0.3;
    /// Times that factors are found, each from the result of the last.
    pub const PASSES: usize = 3;
    /// Power of the error that is the weight of its square.
    pub const POWER: f64 = 2.0;
    /// Steps of one pass.
    pub const STEPS: usize = 6;
    /// Error below which none counts less.
    pub const UNCERTAIN: f64 = 1e-3;
    /// Weight of factors themselves.
    pub const STAY: f64 = 1e-4;
}
