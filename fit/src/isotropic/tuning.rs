//! The numbers that the isotropic fit was tuned by, step by step: the only table of them.
//!
//! Each has the trade-off that it decides. `bash lab/tuning.sh isotropic::MODULE::NAME=VALUE [-- FILE...]` prints its gain: errors and
//! seconds of fits with the number, and with another value. `docs/tuning.md` has some of these gains.

/// Tables and samples that are fitted.
pub(crate) mod source {
    use crate::table::Density;

    /// Angle of the last stored view, degrees. Measurements beyond it are noise.
    pub const LAST_VIEW: f64 = 87.0;
    /// Factor on the smoothness of the settings. Views between stored views need less of it: alum-bronze 3.9 %, and 4.4 % with 1.
    pub const DENSE: f64 = 0.4;
    /// Share of the samples in the weight of a view that has samples; the completion has the rest.
    pub const SHARE: f64 = 0.8;
    /// Most views of samples that are fitted. More take time.
    pub const SAMPLED: usize = 16;
    /// Shift of the views between stored views from one resampling to the next, in intervals.
    pub const SHIFT: f64 = 0.381_966;
    /// Directions of a held-out view. Fewer make its error uncertain.
    pub const HELD_OUT: Density = Density { hemisphere: 1000, cap: 300 };
}

/// Places of the stored views.
pub(crate) mod stored_views {
    use crate::table::Density;

    /// Intervals between probes, or a divisor of their number: half degrees up to 87 degrees.
    pub const PROBED_INTERVALS: usize = 174;
    /// Least number of probes for each stored view.
    pub const FINER: usize = 4;
    /// Directions of a probe.
    pub const PROBED: Density = Density { hemisphere: 150, cap: 50 };
    /// Angle from which on the albedo of a probe of a table is integrated with more directions, degrees, and how many: highlights at the
    /// horizon are narrow. With those of all probes the albedos of aurora_white and of the flake at 86 degrees are 2 % too small.
    pub const GRAZING: f64 = 78.0;
    pub const PROBED_GRAZING: Density = Density { hemisphere: 1000, cap: 300 };
    /// Share of the stored views that follow `1 / sqrt(cos)`, because highlights stretch towards grazing; the others follow the data.
    pub const BY_ANGLE: f64 = 0.5;
    /// Half degrees on each side of a second difference. Shorter spans follow noise.
    pub const SPAN: usize = 3;
    /// Half the number of probes over which the density of stored views is smoothed.
    pub const SMOOTHED: usize = 6;
    /// Least number of probes from one stored view to the next.
    pub const APART: usize = 2;
    /// Largest distance of two stored views, degrees. Wider intervals would follow from noise. 15 views that keep to it are too few near
    /// grazing: the stored albedo of malachite is then 4.3 % off, and 2.9 % with one more view, for 1.6 %.
    pub const WIDEST: f64 = 8.0;
    /// The same, over the mean distance, where that is larger.
    pub const WIDEST_MEAN: f64 = 1.5;
    /// Asymmetry at the normal, relative L2, from which on one more stored view lies next to it; its angle, degrees.
    pub const SKEWED: f64 = 0.02;
    pub const NEAR_NORMAL: f64 = 0.5;
    /// Bend of an albedo that weighs as much as an equal share of the density. Smaller bends hardly count.
    pub const CROOKED: f64 = 0.007;
    /// Weight of an albedo above the straight line over that of one below.
    pub const BULGE: f64 = 1.5;
}

/// Candidates on their way.
pub(crate) mod candidates {
    /// Samples of the thinned table. More take time in stages that keep most candidates.
    pub const SCOUTED_SAMPLES: usize = 5000;
    /// Cost of an ordinary fit, an error of 2 to 3 %: smoothness and albedo weigh more above it.
    pub const USUAL_COST: f64 = 1e-3;
    /// Largest factor of that kind. Without a limit ilm_solo_m_68 is too stiff and ends at 15 %, not 12 %.
    pub const MOST_SCALE: f64 = 3.0;
}

/// Exchanges of lobes.
pub(crate) mod exchange {
    /// Families of lobes that are tried at an exchange, half of them beside a lobe of the fit.
    pub const FAMILIES: usize = 60;
    /// Families that are tried along a peak that no lobe has, and the logarithms of the sharpness of the widest and the narrowest.
    pub const STRAY: usize = 10;
    pub const STRAY_LN_SHARPNESS: (f64, f64) = (4.0, 14.0);
    /// Exchanges in vain, one after the other, that end a stage.
    pub const PATIENCE: usize = 6;
    /// Relative decrease of the cost from which on an exchange is kept.
    pub const IMPROVEMENT: f64 = 1e-3;
    /// Share of the best amplitude with which a new lobe starts.
    pub const CAUTION: f64 = 0.7;
}

/// Ranks of finalists.
pub(crate) mod finalist {
    /// Factor on the error for a weight that is too large, while it may be mended.
    pub const WIDENED: f64 = 1.1;
    /// Share of the largest weight from which on weights at other views may be too large.
    pub const NEAR_LARGEST: f64 = 0.6;
    /// Angle up to which the variance is a goal, radians: 80 degrees.
    pub const STEEPEST: f64 = 1.4;
    /// Factor on the error where a goal is missed by `RAMP` doublings or more. A goal missed by a hair costs a hair.
    pub const MISSED: f64 = 1.25;
    /// Doublings over which that factor rises from 1.
    pub const RAMP: f64 = 0.5;
    /// Share of the error that every doubling costs.
    pub const DOUBLING: f64 = 0.07;
    /// Factor on the error up to which missed goals are left alone.
    pub const TOLERATED: f64 = 1.04;
    /// Largest share of the rank with which factors are worth their bytes.
    pub const WORTH_RANK: f64 = 0.93;
    /// Largest share of the error, or of that away from the peak, with which they are where the rank is not worse.
    pub const WORTH_ERROR: f64 = 0.85;
    /// Largest share of the error away from the peak with which they are whatever goals they miss, if the whole error is not larger.
    pub const WORTH_SEEN: f64 = 0.7;
    /// Distance of the stored albedo from the albedo between two stored views from which on one more is put there, over the luminance; and
    /// how many at most.
    pub const BENT: f64 = 0.008;
    pub const BENDS: usize = 3;
}

/// Rounds after the first.
pub(crate) mod search {
    /// Factor on the weight of the albedo after it missed its goal.
    pub const MORE_ENERGY: f64 = 10.0;
    /// Largest weight of the albedo: with more, nothing else counts.
    pub const MOST_ENERGY: f64 = 1000.0;
    /// Factor on the weight of the tail after weights or variances missed their goals.
    pub const MORE_TAIL: f64 = 3.0;
}

/// The last touch: albedos.
pub(crate) mod balance {
    /// Power of the norm: with this one only the largest errors count.
    pub const POWER: i32 = 16;
    /// Error of an albedo that is within the uncertainty of quadrature.
    pub const UNCERTAIN: f64 = 1e-3;
    /// Weight of the squared factors over that of the squared errors.
    pub const STAY: f64 = 1e-4;
    /// Largest logarithm of a factor.
    pub const MOST: f64 = 0.3;
    /// Times that the factors are fitted, because albedos between stored views do not follow them exactly.
    pub const PASSES: usize = 2;
    /// Steps of the reweighted least squares.
    pub const STEPS: usize = 150;
}

/// Stages of the search, beside its recipe in `search/schedule.rs`.
pub(crate) mod schedule {
    /// Lobes for which the recipe states numbers of candidates. Fewer lobes have more minima and cost less, so more take part.
    pub const USUAL_LOBES: usize = 12;
    /// Largest factor on the candidates of fewer lobes.
    pub const MOST_TIMES: usize = 4;
    /// Lobes from which on starts, exchanges and candidates fall in proportion: a step costs the square of the lobes.
    pub const MANY_LOBES: usize = 20;
    /// Candidates of many lobes that are moved at a time: with 64 lobes each holds 25 MB.
    pub const SIDE_BY_SIDE: usize = 2;
    /// Factor on the stiffness of the last stages after exchanges. Lobes keep their order by then.
    pub const LOOSENED: f64 = 0.3;
    /// Weight of the tail in the first round. Over 22 materials the median error is 3.10 %, and 3.55 % with ten times as much.
    pub const LIGHT_TAIL: f64 = 0.003;
    /// The same in the last round with factors, if weights are near their limit. The largest weight of the flake is 15 with it, and 23
    /// with the light one; ripples of other tables are larger.
    pub const FACTORED_TAIL: f64 = 0.012;
    /// Least weight of the tail after a goal was missed.
    pub const HEAVY_TAIL: f64 = 0.03;
    /// Weight of the albedo in the first round.
    pub const FIRST_ENERGY: f64 = 10.0;
    /// Weight of the error away from the peak in the last stage. In earlier stages it costs L2: malachite 13.7 %, not 10.8.
    pub const LAST_MEASURE: f64 = 1.0;
}

/// Starts.
pub(crate) mod start {
    /// Least squeeze of a start: the cosine of a view is 0 at the horizon.
    pub const LEAST_SQUEEZE: f64 = 0.08;
    /// Sharpness of the widest and the narrowest mirrored lobe, over that of the narrowest lobe.
    pub const MIRRORED: (f64, f64) = (0.03, 0.5);
    /// Angle of mirrored lobes out of the plane of incidence, in widths of the lobe.
    pub const WIDTHS: f64 = 1.2;
}

/// The sum of squares: numbers of isotropic fits alone.
pub(crate) mod objective {
    /// Least share of the albedo in the defensive lobe. It bounds weights: a density of at least 2.5e-5 / sr everywhere.
    pub const DEFENSIVE: f64 = 0.002;
    /// The same share in the diffuse term, where no lobe is defensive.
    pub const DEFENSIVE_DIFFUSE: f64 = 0.01;
    /// Views between two stored views at which the ceiling holds.
    pub const WATCHED: usize = 4;
    /// Weight of the change in the last interval over that of second differences.
    pub const HOLD: f64 = 0.1;
}

/// Steps of the solver.
pub(crate) mod solver {
    /// Longest step. Half of it finds better minima of mirror-like materials, with twice the steps to leave a bad start.
    pub const LONGEST_STEP: f64 = 3.0;
}

/// Bounds of the unknowns: within those of the format, and no wider than fits need.
pub(crate) mod parameters {
    /// Angles of the axes, radians.
    pub const ANGLE: (f64, f64) = (-1.8, 2.2);
    /// Angles of the axes out of the plane of incidence, radians.
    pub const OFF_PLANE: (f64, f64) = (0.0, 1.55);
    /// Logarithm of the squeeze.
    pub const LN_SQUEEZE: (f64, f64) = (-4.5, 0.69);
    /// Angle of the defensive lobe, radians: nowhere on the hemisphere is it below a fiftieth of its peak.
    pub const ANGLE_DEFENSIVE: (f64, f64) = (-0.6, 0.6);
    /// Logarithm of its sharpness. At most 0 would bound weights better, and fits garnet red to 1.7 %, not 1.6.
    pub const LN_SHARPNESS_DEFENSIVE: (f64, f64) = (-3.0, 1.0);
}

/// The material that is written.
pub(crate) mod encode {
    /// Views between two stored views at which the albedo is held below that.
    pub const LOOKS: usize = 64;
    /// The same with factors, whose means take long.
    pub const FACTORED_LOOKS: usize = 16;
}
