//! A table: samples of a BRDF, whatever the file format, in the frame of each view.
//!
//! Frame: +z the normal, outgoing direction `(-sin theta, 0, cos theta)`, mirror direction `(sin theta, 0, cos theta)`.
//! The materials are isotropic, so every sample is mirrored to y >= 0: a sample and its mirror image are one.
//!
//! May import: `error`, `numeric`.

#[doc(hidden)]
pub mod albedo_bounds;
#[doc(hidden)]
pub mod albedo_log;
mod brdf;
pub mod evaluation_views;
#[doc(hidden)]
pub mod interpolant;
pub(crate) mod interpolate;
mod tabulate;

use crate::FitError;
use std::f64::consts::FRAC_PI_2;

#[doc(hidden)]
pub use brdf::or_black;
pub use brdf::{Brdf, Draws, Known, Symmetry};
#[doc(hidden)]
pub use interpolate::owners;
pub use tabulate::Density;
#[doc(hidden)]
pub use tabulate::{Drawn, Tabulation};

/// Largest albedo that is believed: no surface reflects more than it receives.
#[doc(hidden)]
pub const ALBEDO_LIMIT: f64 = 0.95;

/// Brightest f of a table that lobes can be fitted to, 1/sr: the least amplitude that is stored is a thousandth of it in all lobes.
#[doc(hidden)]
pub const DARKEST: f64 = 1e-15;

/// The f of a surface of which nothing was measured to be brighter than 0, 1/sr: below the noise of any instrument.
#[doc(hidden)]
pub const BLACK: f64 = 1e-9;

/// Largest f of a table that can be fitted, 1/sr, and least of negative ones: far beyond any surface, and its square is a number.
const LARGEST: f64 = 1e30;

/// Most views that a table may have.
pub const MAX_VIEWS: usize = 1024;

/// One value of the BRDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Incident direction, unit vector in the frame of the view, y >= 0, z > 0.
    pub direction: [f64; 3],
    /// The BRDF f, linear sRGB; 1/sr. Channels of colours outside the gamut, and noise, are negative.
    pub rgb: [f64; 3],
    /// Quadrature weight over the hemisphere, such that the sum of `weight f cos` is an albedo; sr.
    pub weight: f64,
}

/// The samples for one outgoing direction.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Angle of the outgoing direction from the normal, radians, [0, pi / 2).
    pub theta: f64,
    /// The samples.
    pub samples: Vec<Sample>,
    /// Directional albedo, linear sRGB, which the lobes keep to.
    pub albedo: [f64; 3],
    /// The same as the samples have it, which may be more than the 0.95 that lobes are held to.
    pub uncut_albedo: [f64; 3],
    /// Least relative L2 error that a fit can have: at the normal an isotropic material is the same at every azimuth, but measured
    /// tables are not, and the samples are their mean over it. 0 elsewhere.
    pub floor: f64,
}

/// Samples of an isotropic BRDF for a number of outgoing directions.
///
/// # Examples
/// ```
/// use srbf_measured::table::Table;
///
/// // Samples towards one outgoing direction, 30 degrees from the normal: incident direction, and f.
/// let grey = [0.2; 3];
/// let samples = vec![([0.0, 0.0, 1.0], grey), ([0.6, 0.0, 0.8], grey), ([0.0, 0.6, 0.8], grey)];
/// let table = Table::from_scattered(vec![(30f64.to_radians(), samples)])?;
/// assert_eq!(table.views[0].samples.len(), 3);
/// # Ok::<(), srbf_measured::FitError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The views, theta rising.
    pub views: Vec<View>,
}

/// Refuses a black table.
#[doc(hidden)]
pub fn check_bright(is_bright: bool) -> Result<(), FitError> {
    if is_bright { Ok(()) } else { Err(FitError::Table("no sample has any brightness".into())) }
}

/// Refuses samples that are black, or brighter than lobes can be.
#[doc(hidden)]
pub fn check_storable<'a>(samples: impl Iterator<Item = &'a Sample>) -> Result<(), FitError> {
    let ends = |(least, most): (f64, f64), v: f64| (least.min(v), most.max(v));
    let (least, brightest) = samples.flat_map(|s| s.rgb).fold((0.0, 0.0), ends);
    check_bright(brightest > 0.0)?;
    let fail = |text: String| Err(FitError::Table(text));
    if brightest < DARKEST {
        return fail(format!(
            "the largest f is {brightest:e} / sr; lobes can be stored from {DARKEST:e} / sr on"
        ));
    }
    if brightest.max(-least) > LARGEST {
        let found = if brightest > LARGEST { brightest } else { least };
        return fail(format!("an f is {found:e} / sr; at most {LARGEST:e} / sr can be fitted"));
    }
    Ok(())
}

/// Samples of one view before they have weights: incident direction and f.
pub type Scattered = Vec<([f64; 3], [f64; 3])>;

impl Table {
    /// Makes a table of scattered samples: mirrors them, weighs them, and integrates the albedo of each view.
    ///
    /// Where no value is above 0 the surface is black, and has f of 1e-9 / sr: lobes need some brightness.
    ///
    /// The weights integrate linearly between samples, the albedo its logarithm, and is held to at most 0.95: see the source of
    /// `interpolate`.
    ///
    /// # Errors
    /// [`FitError::Table`] for no view, too many, angles outside [0, pi / 2), views without a sample above the
    /// horizon, and numbers that are not finite.
    pub fn from_scattered(views: Vec<(f64, Scattered)>) -> Result<Self, FitError> {
        let fail = |text: String| Err(FitError::Table(text));
        if views.is_empty() || views.len() > MAX_VIEWS {
            return fail(format!("{} views; from 1 to {MAX_VIEWS} are possible", views.len()));
        }
        let is_black = views.iter().flat_map(|view| &view.1).all(|(_, rgb)| rgb.iter().all(|v| *v <= 0.0));
        let mut made: Vec<View> = Vec::with_capacity(views.len());
        for (theta, scattered) in views {
            let degrees = theta.to_degrees();
            if !(0.0..FRAC_PI_2).contains(&theta) {
                return fail(format!("view at {degrees} degrees; at least 0 and less than 90 are possible"));
            }
            let mut samples = Vec::with_capacity(scattered.len());
            for (n, (d, rgb)) in scattered.into_iter().enumerate() {
                let length = libm::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
                if !(length.is_finite() && length > 0.5 && rgb.iter().all(|v| v.is_finite())) {
                    return fail(format!(
                        "view at {degrees:.2} degrees, sample {n}: {d:?} -> {rgb:?} is not finite"
                    ));
                }
                // A sample at the horizon says nothing of f cos.
                if d[2] > 1e-6 * length {
                    let direction = [d[0] / length, (d[1] / length).abs(), d[2] / length];
                    let rgb = if is_black { [BLACK; 3] } else { rgb };
                    samples.push(Sample { direction, rgb, weight: 0.0 });
                }
            }
            if samples.is_empty() {
                return fail(format!("view at {degrees:.2} degrees: no sample above the horizon"));
            }
            let uncut_albedo = interpolate::weigh(&mut samples);
            let albedo = uncut_albedo.map(|a| a.min(ALBEDO_LIMIT));
            made.push(View { theta, samples, albedo, uncut_albedo, floor: 0.0 });
        }
        made.sort_by(|a, b| a.theta.total_cmp(&b.theta));
        Ok(Self { views: made })
    }
}

impl Table {
    /// Every n-th sample of each view, such that about `count` are left; all, if there are no more.
    #[doc(hidden)]
    pub fn thinned(&self, count: usize) -> Self {
        let total: usize = self.views.iter().map(|v| v.samples.len()).sum();
        let every = total.div_ceil(count.max(1)).max(1);
        let thin = |view: &View| {
            let mut samples: Vec<Sample> = view.samples.iter().step_by(every).copied().collect();
            let sum = |s: &[Sample]| s.iter().map(|s| s.weight).sum::<f64>();
            let share = sum(&view.samples) / sum(&samples);
            samples.iter_mut().for_each(|s| s.weight *= share);
            View { samples, ..*view }
        };
        Self { views: self.views.iter().map(thin).collect() }
    }
}

/// Luminance of a linear sRGB colour (Rec. 709).
#[doc(hidden)]
pub fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

/// Unit vector at an angle from the normal and an azimuth from the mirror direction's.
#[doc(hidden)]
pub fn direction(theta: f64, azimuth: f64) -> [f64; 3] {
    let (st, ct) = libm::sincos(theta);
    let (sp, cp) = libm::sincos(azimuth);
    [st * cp, st * sp, ct]
}
