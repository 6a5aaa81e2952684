//! The numbers that both fits were tuned by, isotropic and anisotropic: the only table of them.
//!
//! Each has the trade-off that it decides. `bash lab/tuning.sh family::MODULE::NAME=VALUE [-- FILE...]` prints its gain: errors and
//! seconds of fits with the number, and with another value. `docs/tuning.md` has some of these gains.

/// Starts.
pub(crate) mod start {
    /// Amplitude of a lobe that the best amplitudes leave out, over that of the largest: enough for the solver to move it.
    pub const FAINT: f64 = 2e-3;
    /// Largest albedo of a start.
    pub const BRIGHTEST: f64 = 0.9;
    /// Sweeps of the coordinate descent for amplitudes.
    pub const SWEEPS: usize = 200;
}

/// The sum of squares.
pub(crate) mod objective {
    /// Share of the mean of a view below which the tail is noise and weighs less.
    pub const TAIL_FLOOR: f64 = 0.05;
    /// Factor by which lobes may fall short of the table before the tail weighs more: chrome has weights of 10, and 27 without.
    pub const SHORT: f64 = 3.0;
    /// Largest factor on the tail for that.
    pub const MOST_SHORT: f64 = 1000.0;
    /// Error of an albedo from which on it weighs more: the goal is for the largest.
    pub const ALBEDO_ERROR: f64 = 0.005;
    /// Largest factor on an error of the albedo for that.
    pub const MOST_ALBEDO: f64 = 10.0;
    /// Albedo from which on a view is pulled down.
    pub const CEILING: f64 = 0.96;
    /// Weight of an albedo above the ceiling.
    pub const CEILING_WEIGHT: f64 = 30.0;
    /// Factor on the weight of a channel that is below 0 where the table is not, in fits of tables with factors. With 30, 3 % of the directions round the
    /// highlight of chm_mint are so, and 9 % without.
    pub const FALSELY_NEGATIVE: f64 = 30.0;
    /// Share of the table from which on down to its negative that factor rises from 1.
    pub const NEAR_ZERO: f64 = 0.25;
    /// Largest factor on the weight of errors away from the peak for grazing light, in fits of tables.
    pub const MOST_GRAZING: f64 = 4.0;
    /// Largest factor on the weight of a view for its error.
    pub const MOST_FACTOR: f64 = 2.5;
}

/// Steps of the solver.
pub(crate) mod solver {
    /// Change of a colour difference that is as long as a change of 1 of a logarithm.
    pub const COLOR_STEP: f64 = 4.0;
    /// Damping of colours, over the cost. Malachite ends at 11.1 % with it, and at 16.4 % without.
    pub const FAINT_COLOR: f64 = 1e-3;
}

/// Bounds of the unknowns: within those of the format, and no wider than fits need.
pub(crate) mod layout {
    /// Logarithm of the sharpness.
    pub const LN_SHARPNESS: (f64, f64) = (-3.0, 14.0);
    /// Logarithm of the amplitude.
    pub const LN_AMPLITUDE: (f64, f64) = (-40.0, 30.0);
    /// Red and blue difference. sRGB has -1 to 3.7 and to 12.9; single lobes may lie outside. With -2 malachite is worse.
    pub const COLORS: [(f64, f64); 2] = [(-15.0, 15.0); 2];
}

/// Lobes at a panel of directions.
pub(crate) mod lobes {
    /// Exponent below which a lobe counts as 0 at a whole panel: 4e-18 of its peak.
    pub const NEGLIGIBLE: f64 = -40.0;
}

/// The material that is written.
pub(crate) mod encode {
    /// Largest albedo of a material, at any view.
    pub const MOST: f64 = 0.999;
    /// Largest difference of albedos that is stored.
    pub const MOST_DIFFERENCE: f64 = 16.0;
}

/// Factors on lobes.
pub(crate) mod factors {
    use crate::family::factors::size::Size;

    /// Nodes over half angle, difference angle and azimuth of the tables that are tried, smallest first.
    pub const SIZES: [Size; 11] = [
        Size::reciprocal([16, 6, 1]),
        Size::reciprocal([16, 6, 3]),
        Size::reciprocal([24, 6, 3]),
        Size::signed([16, 6, 5]),
        Size::signed([24, 6, 5]),
        Size::signed([22, 9, 5]),
        Size::signed([24, 9, 5]),
        Size::signed([24, 12, 5]),
        Size::signed([24, 16, 5]),
        Size::signed([24, 16, 7]),
        Size::signed([32, 16, 7]),
    ];
    /// Of this number of directions, one is left out where size and smoothness are chosen. With whole views left out, large tables lack data, and the
    /// choice ends too small: malachite at 24x9x5, with twice the error.
    pub const LEFT_OUT: usize = 3;
    /// Largest factor.
    pub const LARGEST: f64 = 8.0;
    /// Weight of squared second differences over that of squared errors: without data a factor continues its neighbours.
    pub const SMOOTH: f64 = 3e-8;
    /// Multiples of that weight that are tried: a table of measurements may have rings of its own.
    pub const SMOOTHER: [f64; 3] = [10.0, 100.0, 1000.0];
    /// Largest share of the cost that a smoother table may leave. A small gain is noise of the table, and the flake loses colour by it.
    pub const SMOOTHER_GAIN: f64 = 0.9;
    /// Weight of the squared distance from 1: far from data a factor ends at 1.
    pub const PULL: f64 = 3e-8;
    /// Weight of the albedo beside the squared errors. With ten times as much, weights of chm_mint are 40, not 10.
    pub const ENERGY: f64 = 1.0;
    /// Turns of factors and lobes on one table. The steps of the solver are shared out.
    pub const TURNS: usize = 4;
    /// Largest share of the error that a larger table may leave, for every `NODES` nodes that it adds.
    pub const MORE_NODES: f64 = 0.999;
    /// Nodes to which that share belongs.
    pub const NODES: f64 = 130.0;
    /// Most sweeps of the coordinate descent, and the step of a node below which it ends.
    pub const SWEEPS: usize = 400;
    pub const STILL: f64 = 1e-4;
    /// The same of a table that has too many bytes to be chosen: its error is stated, and nothing else of it is used.
    pub const NEARLY_STILL: f64 = 1e-2;
    /// Directions of a lobe over which factors are averaged in the search.
    pub const AVERAGED: usize = 400;
    /// The same for albedos that are stored, or balanced at the end.
    pub const AVERAGED_TO_STORE: usize = 2000;
}
