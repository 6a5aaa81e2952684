//! The numbers that the completion of samples was tuned by, step by step: the only table of them.
//!
//! Each has the trade-off that it decides. `bash lab/tuning.sh complete::MODULE::NAME=VALUE [-- FILE...]` prints its gain: errors and
//! seconds of fits with the number, and with another value. `docs/tuning.md` has some of these gains.

/// The choice of a model and a process.
pub(crate) mod choice {
    use crate::complete::kernel::Kernel;

    /// Largest distance of a value from the model, on the scale.
    pub const FARTHEST: f64 = 12.0;
    /// Largest distance above the brightest sample, on the scale.
    pub const BRIGHTER: f64 = 3.0;
    /// Least width of the coordinates.
    pub const LEAST_WIDTH: f64 = 0.01;
    /// Samples that the model is fitted to. More take time.
    pub const OF_MODEL: usize = 4000;
    /// A kernel without terms of one coordinate alone.
    pub const TOGETHER: [(f64, f64); 3] = [(0.0, 1.0); 3];
    /// Lengths of the four coordinates that a turn of the sample adds: twice the azimuth of the half vector, and of the way between
    /// both directions.
    pub const OF_TURN: [f64; 4] = [1.0, 1.0, 1.5, 1.5];
    /// Length of the coordinate that tells the sides of a sheet apart.
    pub const OF_SIDES: f64 = 0.375;
    /// Those of a kernel that are not the turn's, nor of the sides.
    const fn lengths([a, b, c, d]: [f64; 4]) -> [f64; 9] {
        [a, b, c, d, OF_SIDES, OF_TURN[0], OF_TURN[1], OF_TURN[2], OF_TURN[3]]
    }
    /// Kernels that are tried, from short to long; the third has terms of one coordinate alone.
    pub const KERNELS: [Kernel; 4] = [
        Kernel { alone: TOGETHER, joint: 1.0, lengths: lengths([1.0, 0.8, 0.8, 2.0]) },
        Kernel { alone: TOGETHER, joint: 3.0, lengths: lengths([2.0, 1.2, 1.2, 3.0]) },
        Kernel {
            alone: [(0.3, 0.5), (0.1, 0.4), (0.1, 0.3)],
            joint: 3.0,
            lengths: lengths([2.0, 1.2, 1.2, 3.0]),
        },
        Kernel { alone: TOGETHER, joint: 3.0, lengths: lengths([2.0, 2.0, 2.0, 3.0]) },
    ];
    /// Variances of the noise of a sample that are tried, on the scale.
    pub const NOISES: [f64; 2] = [1e-2, 1e-3];
    /// Share of the error at left-out views below which the model goes without a process.
    pub const ALONE: f64 = 0.9;
}

/// The bound of the albedo.
pub(crate) mod energy {
    use crate::table::Density;

    /// Largest albedo.
    pub const MOST: f64 = 0.98;
    /// Intervals of angles at which it holds.
    pub const INTERVALS: usize = 24;
    /// Directions of each.
    pub const DENSITY: Density = Density { hemisphere: 150, cap: 60 };
}

/// The choice of a family of models.
pub(crate) mod family {
    use super::choice::KERNELS;
    use crate::complete::kernel::Kernel;

    /// Relative distance of widths and exponents up to which two models are one.
    pub const SAME: f64 = 0.1;
    /// Most models that go on.
    pub const MODELS: usize = 2;
    /// Samples by which families are compared.
    pub const COMPARED: usize = 1500;
    /// Parts in which samples are left out.
    pub const FOLDS: usize = 5;
    /// Factor on the least error up to which families are compared with a process too.
    pub const CLOSE: f64 = 1.4;
    /// The kernel and the noise of that process.
    pub const COMPARED_BESIDE: (Kernel, f64) = (KERNELS[1], 1e-2);
    /// Samples of that comparison: its time grows with the cube.
    pub const COMPARED_WITH_PROCESS: usize = 750;
    /// Share of the error of the simplest family that a coat has to be below. Coats are common.
    pub const WORTHWHILE: f64 = 0.97;
    /// The same for a lobe about the back direction, which is rare.
    pub const WITHOUT_DOUBT: f64 = 0.8;
    /// The kernel and the noise beside which a model is refitted.
    pub const BESIDE: (Kernel, f64) = (KERNELS[3], 3e-3);
    /// Samples of that fit.
    pub const OF_BESIDE: usize = 1500;
    /// Times that model and process are fitted in turn.
    pub const REFINEMENTS: usize = 2;
}

/// Directions without a sample near.
pub(crate) mod gaps {
    use std::f64::consts::PI;

    /// Largest distance of a sample that says something, radians.
    pub const NEAR: f64 = 20.0 * PI / 180.0;
    /// Degrees between the views that are tested.
    pub const STEP: usize = 5;
    /// Incident directions of each.
    pub const DIRECTIONS: usize = 150;
    /// Samples that they are compared with.
    pub const MOST: usize = 3000;
}

/// The grid on which a process is tabulated.
pub(crate) mod grid {
    /// Nodes over the spread angle of the half vector, the angle from it to a direction, and the sideways share.
    pub const NODES: [usize; 3] = [64, 32, 6];
    /// The same where the sides of a sheet differ: the last is the cosine of the azimuth about the half vector.
    pub const OF_SIDES: [usize; 3] = [64, 32, 13];
    /// The same where a turn changes values: the last two are azimuths, of the way between both directions and of the half vector.
    pub const TURNED: [usize; 4] = [40, 20, 12, 16];
}

/// Heights beyond the samples.
pub(crate) mod heights {
    /// Spread angle of the half vector up to which samples are near the peak.
    pub const PEAK: f64 = 2.0;
    /// Least number of samples there.
    pub const FEWEST: usize = 3;
    /// Largest rise above the samples on the scale: at the peak, and for each unit of the spread angle.
    pub const BEYOND: [f64; 2] = [0.3, 1.0];
}

/// The samples.
pub(crate) mod measurement {
    /// Share of the samples, the darkest, from which a diffuse term starts.
    pub const DARK: f64 = 0.2;
    /// Least mean radiance over the brightest sample. Samples of noise around 0 have any mean.
    pub const LEAST_LEVEL: f64 = 1e-4;
    /// Views into which pairs are grouped, by the angle of `wo`.
    pub const VIEWS_OF_PAIRS: usize = 12;
}

/// The microfacet model.
pub(crate) mod microfacet {
    use crate::numeric::levenberg::Limits;

    /// Least logarithm of a reflectance and of diffuse radiance.
    pub const LEAST: f64 = -25.0;
    /// Largest logarithm of diffuse radiance.
    pub const MOST_DIFFUSE: f64 = 2.0;
    /// Rise of the reflectance of a dielectric coat from the normal to grazing angles.
    pub const COAT_RISE: f64 = 25.0;
    /// Freedom of the channels of a coat.
    pub const LEAST_HUE: f64 = 0.05;
    /// Least value and largest logarithm from which a second lobe starts.
    pub const SECOND_START: (f64, f64) = (1e-3, 2.0);
    /// Steps of the fit.
    pub const LIMITS: Limits = Limits { steps: 60, improvement: 1e-4 };
    /// Steps of later fits.
    pub const REFINED: Limits = Limits { steps: 25, improvement: 1e-4 };
}

/// Bounds and likelihoods of the microfacet model.
pub(crate) mod microfacet_fit {
    /// Widths.
    pub const WIDTHS: (f64, f64) = (0.002, 1.2);
    /// Exponents less 1.
    pub const EXPONENTS: (f64, f64) = (0.05, 6.0);
    /// Widths of a second lobe.
    pub const SECOND_WIDTHS: (f64, f64) = (0.001, 0.6);
    /// Exponents less 1 of a lobe about the back direction.
    pub const RETRO_EXPONENTS: (f64, f64) = (0.05, 40.0);
    /// Largest logarithm of a reflectance.
    pub const MOST: f64 = 3.0;
    /// Largest logarithm of the factor on a coat.
    pub const MOST_COAT: f64 = 14.0;
    /// Largest height of a lobe about the back direction over the brightest sample: a narrow one could have any height.
    pub const OVER_BRIGHTEST: f64 = 1.5;
    /// Weight of squared differences of logarithms over that of relative ones.
    pub const BY_LOGARITHM: f64 = 0.09;
    /// Likely rise of a reflectance from the normal to grazing angles: dielectrics have 25, metals 1 to 2.
    pub const RISE: f64 = 12.0;
    /// Deviation of its logarithm.
    pub const DEVIATION: f64 = 0.5;
    /// The same of a coat, which is a dielectric.
    pub const COAT_DEVIATION: f64 = 0.2;
    /// Deviation of the logarithms of channels from each other.
    pub const OF_CHANNELS: f64 = 0.4;
    /// Weight of these likelihoods over the squares of the first fit.
    pub const LIKELY: f64 = 1e-3;
}

/// The points of a process.
pub(crate) mod points {
    /// Most points: time grows with their cube, memory with their square.
    pub const MOST: usize = 1500;
    /// Most groups of neighbouring views when whole views are left out.
    pub const BANDS: usize = 12;
    /// Steps of a doubling of the cells that thin samples.
    pub const STEPS: usize = 40;
    /// Least size of such a cell.
    pub const FINEST: f64 = 0.01;
}

/// Outliers.
pub(crate) mod robust {
    use super::choice::KERNELS;
    use crate::complete::kernel::Kernel;

    /// Kernel of the process that tells outliers.
    pub const KERNEL: Kernel = KERNELS[1];
    /// Its noise.
    pub const NOISE: f64 = 1e-2;
    /// Rounds, each with a model of the samples that are left.
    pub const ROUNDS: usize = 2;
    /// One in how many points may go in a round.
    pub const SHARE: usize = 8;
    /// Deviations of an outlier.
    pub const DEVIATIONS: f64 = 6.0;
    /// Its least distance on the scale.
    pub const APART: f64 = 0.7;
    /// Widths round the peak in which samples need more distance.
    pub const PEAK: f64 = 1.5;
    /// The same about the back direction: half of the angle between the directions, radians.
    pub const BACK: f64 = 0.2;
    /// That distance.
    pub const APART_AT_PEAK: f64 = 2.0;
    /// The same, below, of a sample that something stood before: below a seventh.
    pub const DEAD: f64 = 1.9;
    /// Share of the variance up to which neighbours say the value of a place.
    pub const KNOWN: f64 = 0.3;
    /// Least difference over the mean radiance. Dark values are noisy, and many were clamped to 0.
    pub const LEAST: f64 = 0.1;
    /// The smaller cosine of both directions below which the difference falls with it, as an instrument's noise is one of its signal: of
    /// brighter samples and dead ones, and of darker ones.
    pub const THIN: f64 = 0.1;
    pub const THIN_DARK: f64 = 0.5;
    /// Nearest samples. Most of those of the same view must not be off alike: then the surface or the instrument is so. Of all views, at
    /// most one may be brighter, or at most one darker.
    pub const NEIGHBOURS: usize = 6;
    /// Share of its distance from the prediction by which a wrong sample is beyond these.
    pub const BEYOND: f64 = 0.5;
    /// Nearest points whose own distances from their predictions are looked at.
    pub const AROUND: usize = 12;
    /// Times that a wrong sample is as far off as the second worst of these. A smaller factor names good samples of rough surfaces.
    pub const OVER_NEIGHBOURS: f64 = 4.0;
    /// Samples of one point from which on they are compared with each other.
    pub const OF_A_GROUP: usize = 5;
}

/// The scale of values.
pub(crate) mod scale {
    /// Share of the mean radiance up to which the scale is linear.
    pub const FLOOR: f64 = 0.02;
}

/// The axis of a surface that a turn changes.
pub(crate) mod turned {
    /// Samples of the first search, and of later ones.
    pub const SAMPLES: [usize; 2] = [500, 1500];
    /// Axes of the first search over half a turn.
    pub const AXES: usize = 12;
    /// Stretches along them of the first search.
    pub const STRETCHES: [f64; 2] = [1.25, 2.0];
    /// Greatest stretch: highlights 25 times as long as wide.
    pub const MOST: f64 = 5.0;
    /// First steps of later searches: axis, radians, and logarithm of the stretch. The last ones are a hundredth of them.
    pub const STEPS: [f64; 2] = [0.12, 0.2];
    /// Share of the sum of squares below which a second lobe tells the axis too.
    pub const SECOND: f64 = 0.9;
    /// Samples by which symmetries, and a turn against none, are compared.
    pub const COMPARED: usize = 900;
    /// Share of the error at left-out samples below which a symmetry is broken.
    pub const BROKEN: f64 = 0.93;
    /// Share of the error at left-out samples and turns below which a turn changes something.
    pub const WORTHWHILE: f64 = 0.9;
    /// The same of light through a sheet, below which its sides differ, and by how much more: errors of nothing but rounding have any ratio.
    pub const SIDED: (f64, f64) = (0.95, 0.002);
    /// The same where steps from turn to turn tell that by themselves: highlights narrower than the samples are predicted by nothing.
    pub const AS_GOOD: f64 = 1.1;
    /// Most views by the angle of the outgoing direction, and most turns.
    pub const VIEWS: usize = 64;
    pub const TURNS: usize = 12;
}
