//! The fit: one family of lobes, followed over all views at once.

use crate::FitError;
use crate::initialize;
use crate::levenberg::{self, Limits};
use crate::material;
use crate::objective::Objective;
use crate::parameters::Layout;
use crate::report::{Report, ViewReport};
use crate::table::Table;
use std::f64::consts::FRAC_PI_2;
use std::time::Instant;

/// How a material is fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Lobes of every view, 1 to 64. More fit better and cost more at run time.
    pub lobes: usize,
    /// How many of them see the squeezed direction: those of the highlight.
    pub squeezed: usize,
    /// Weight of the roughness from view to view. Smaller fits the samples better, larger what lies between them.
    pub smoothness: f64,
    /// Starting points tried; the best is refined.
    pub starts: usize,
    /// Most steps of the refinement.
    pub steps: usize,
    /// Angles of the knots in radians, from 0 rising; `None`: the views of the table, the normal and the horizon.
    pub knots: Option<Vec<f64>>,
    /// Name of the source, hash and the like: the first lines of the material's provenance.
    pub provenance: String,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            lobes: 12,
            squeezed: 7,
            smoothness: 1e-5,
            starts: 6,
            steps: 150,
            knots: None,
            provenance: String::new(),
        }
    }
}

/// A fitted material.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The material, as `.srbf` bytes.
    pub bytes: Vec<u8>,
    /// How good it is.
    pub report: Report,
}

/// Steps of each start before the best one is chosen.
const SCOUTING: usize = 25;

/// Roughness weight at which starts are compared, over the final one: a stiff family cannot lose its order.
const STIFF: f64 = 100.0;

/// Least distance of two knots, radians.
const KNOT_DISTANCE: f64 = 0.035;

/// Fits lobes to a table. `progress` is called with the share of the work that is done, 0 to 1.
///
/// # Errors
/// [`FitError::Setting`], [`FitError::Table`]; [`FitError::Format`] never for a table with finite numbers.
pub fn fit(table: &Table, settings: &Settings, mut progress: impl FnMut(f64)) -> Result<Fit, FitError> {
    let start = Instant::now();
    check(settings)?;
    let layout = Layout {
        lobes: settings.lobes,
        squeezed: settings.squeezed,
        knots: match &settings.knots {
            Some(knots) => knots.clone(),
            None => Layout::knots_at(table.views.iter().map(|v| v.theta), KNOT_DISTANCE),
        },
    };
    let objective = Objective::new(table, layout.clone())?;

    let total = (settings.starts * SCOUTING + settings.steps) as f64;
    let mut done = 0;
    let mut tick = || {
        done += 1;
        progress((f64::from(done) / total).min(1.0));
    };

    // Scout: a few stiff steps from every start.
    let mut best = (f64::INFINITY, Vec::new());
    for n in 0..settings.starts {
        let mut x = initialize::start(table, &layout, n);
        let limits = Limits { steps: SCOUTING, improvement: 1e-3, smoothness: STIFF * settings.smoothness };
        let cost = levenberg::minimize(&objective, &mut x, limits, &mut tick);
        if cost < best.0 || best.1.is_empty() {
            best = (cost, x);
        }
    }

    // Refine the best, ever less stiff.
    let (_, mut x) = best;
    for (share, stiffness) in [(0.25, 10.0), (0.75, 1.0)] {
        let steps = (share * settings.steps as f64).ceil() as usize;
        let limits = Limits { steps, improvement: 1e-4, smoothness: stiffness * settings.smoothness };
        levenberg::minimize(&objective, &mut x, limits, &mut tick);
    }

    let text = format!("{}{}", settings.provenance, describe(settings));
    let bytes = material::encode(&layout, &x, &text)?;
    let views = table.views.iter().map(|v| ViewReport::new(&bytes, v)).collect::<Result<Vec<_>, _>>()?;
    progress(1.0);
    Ok(Fit { bytes, report: Report { views, seconds: start.elapsed().as_secs_f64() } })
}

fn describe(settings: &Settings) -> String {
    format!(
        "srbf-fit {}: {} lobes, {} squeezed, smoothness {:e}, {} starts, {} steps\n",
        env!("CARGO_PKG_VERSION"),
        settings.lobes,
        settings.squeezed,
        settings.smoothness,
        settings.starts,
        settings.steps
    )
}

fn check(settings: &Settings) -> Result<(), FitError> {
    let range = |name, inside: bool, reason: &str| {
        if inside { Ok(()) } else { Err(FitError::Setting { name, reason: reason.to_owned() }) }
    };
    range("lobes", (1..=srbf_core::MAX_LOBES).contains(&settings.lobes), "from 1 to 64")?;
    range("squeezed", settings.squeezed <= settings.lobes, "at most the number of lobes")?;
    range("smoothness", (1e-12..=1e3).contains(&settings.smoothness), "from 1e-12 to 1000")?;
    if let Some(knots) = &settings.knots {
        let rising = knots.windows(2).all(|w| w[1] - w[0] > 1e-4);
        let inside = knots.len() <= 1024 && knots.first() == Some(&0.0) && knots.last() <= Some(&FRAC_PI_2);
        range("knots", rising && inside, "from 0 rising to at most pi / 2 radians, at most 1024")?;
    }
    range("starts", (1..=1000).contains(&settings.starts), "from 1 to 1000")?;
    range("steps", (1..=100_000).contains(&settings.steps), "from 1 to 100000")
}
