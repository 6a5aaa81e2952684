//! The fit: one family of lobes, followed over all views at once.

use crate::FitError;
use crate::initialize;
use crate::levenberg::{self, Limits};
use crate::material;
use crate::objective::Objective;
use crate::parameters::Layout;
use crate::report::{Report, ViewReport};
use crate::table::evaluable::Density;
use crate::table::{Content, Table};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// How a material is fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Lobes of every view, 1 to 64. More fit better and cost more at run time.
    pub lobes: usize,
    /// How many of them see the squeezed direction: those of the highlight. `None`: what turns out best.
    pub squeezed: Option<usize>,
    /// Weight of the roughness from view to view. Smaller fits the samples better, larger what lies between them: on garnet
    /// red 1e-5, 1e-4 and 1e-3 give 29, 13 and 12 % at samples left out, at the same 1.6 to 1.8 % at those fitted.
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
            squeezed: None,
            smoothness: 1e-4,
            starts: 9,
            steps: 120,
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

/// Knots of a BRDF that can be evaluated, angle of the last one in degrees, and views at which it is tabulated.
const KNOTS: usize = 16;
const LAST_KNOT: f64 = 87.0;
const TABULATED: usize = 40;

/// Fits lobes to a measurement: to its samples, or to a table of what can be evaluated.
///
/// In the second case the knots are 16, evenly spaced to 87 degrees (unless the settings name them), the views of the
/// table lie between and at them, and the report has held-out views in the middle of every interval.
///
/// # Errors
/// As [`fit`].
pub fn fit_content(
    content: &Content,
    settings: &Settings,
    progress: impl FnMut(f64),
) -> Result<Fit, FitError> {
    let brdf = match content {
        Content::Samples(table) => return fit(table, settings, progress),
        Content::Evaluable(brdf) => brdf.as_ref(),
    };
    let start = Instant::now();
    let last = LAST_KNOT.to_radians();
    let even = || (0..KNOTS).map(|n| last * n as f64 / (KNOTS - 1) as f64).collect();
    let knots: Vec<f64> = settings.knots.clone().unwrap_or_else(even);
    // Views at irregular places: what a lobe does between knots is seen wherever it happens.
    let end = knots[knots.len() - 1].min(last);
    let place = |i: usize| end * (i as f64 + (0.618_033_988_75 * i as f64).fract()) / TABULATED as f64;
    let thetas: Vec<f64> = [0.0, end].into_iter().chain((0..TABULATED).map(place)).collect();
    let table = Table::from_brdf(brdf, &thetas, Density::default())?;
    let middles: Vec<f64> = knots.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
    let finer = Density { hemisphere: 1000, cap: 300 };
    let held_out = Table::from_brdf(brdf, &middles, finer)?;

    let mut fit = fit(&table, &Settings { knots: Some(knots), ..settings.clone() }, progress)?;
    let reports = held_out.views.iter().map(|view| ViewReport::new(&fit.bytes, view));
    fit.report.held_out = reports.collect::<Result<_, _>>()?;
    fit.report.seconds = start.elapsed().as_secs_f64();
    Ok(fit)
}

/// Steps of each start before the best one is chosen.
const SCOUTING: usize = 25;

/// Samples of the table on which the first rounds run, if it has more.
const SCOUTED_SAMPLES: usize = 5000;

/// Candidates that are kept after the first round and after the second.
const SEMIFINAL: usize = 3;
const FINAL: usize = 2;

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
    let knots = match &settings.knots {
        Some(knots) => knots.clone(),
        None => Layout::knots_at(table.views.iter().map(|v| v.theta), KNOT_DISTANCE),
    };
    let counts = squeezed_counts(settings);
    let layout = |&squeezed: &usize| Layout { lobes: settings.lobes, squeezed, knots: knots.clone() };
    let objectives_on = |table: &Table| {
        counts.iter().map(|n| Objective::new(table, layout(n))).collect::<Result<Vec<_>, _>>()
    };
    let (thin, full) = (objectives_on(&table.thinned(SCOUTED_SAMPLES))?, objectives_on(table)?);

    // Ever fewer candidates, ever less stiff. Candidates run side by side; their order does not depend on threads.
    let mut candidates: Vec<Candidate> = (0..settings.starts)
        .map(|n| Candidate { objective: n % counts.len(), start: n, cost: f64::INFINITY, x: Vec::new() })
        .collect();
    let rounds = [
        (&thin, settings.starts, SCOUTING, STIFF, 1e-3),
        (&thin, SEMIFINAL, settings.steps / 4, 10.0, 1e-3),
        (&full, FINAL, settings.steps, 1.0, 1e-4),
    ];
    let total: usize = rounds.iter().map(|r| r.1.min(settings.starts) * r.2).sum();
    let (send, receive) = std::sync::mpsc::channel();
    let mut done = 0;
    let evaluations = &AtomicUsize::new(0);
    for (objectives, keep, steps, stiffness, improvement) in rounds {
        candidates.truncate(keep);
        let limits = Limits { steps, improvement, smoothness: stiffness * settings.smoothness };
        let ahead = done + candidates.len() * steps;
        std::thread::scope(|scope| {
            let sender = send.clone();
            let running = &mut candidates;
            let worker = scope.spawn(move || {
                running.par_iter_mut().for_each_with(sender, |sender, c| {
                    let objective = &objectives[c.objective];
                    if c.x.is_empty() {
                        c.x = initialize::start(table, &objective.layout, c.start);
                    }
                    // Nobody listens any more if the fit is being abandoned.
                    c.cost = levenberg::minimize(objective, &mut c.x, limits, || {
                        evaluations.fetch_add(1, Ordering::Relaxed);
                        let _ = sender.send(());
                    });
                });
            });
            while !worker.is_finished() {
                if receive.recv_timeout(std::time::Duration::from_millis(20)).is_ok() {
                    done += 1;
                    progress(done as f64 / total as f64);
                }
            }
        });
        done = ahead;
        candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.start.cmp(&b.start)));
    }
    let Some(best) = candidates.into_iter().next() else {
        return Err(FitError::Setting { name: "starts", reason: "at least 1".into() });
    };
    let (layout, x) = (&full[best.objective].layout, best.x);

    let text = format!("{}{}", settings.provenance, describe(settings, layout.squeezed));
    let bytes = material::encode(layout, &x, &text)?;
    let views = table.views.iter().map(|v| ViewReport::new(&bytes, v)).collect::<Result<Vec<_>, _>>()?;
    progress(1.0);
    let (seconds, evaluations) = (start.elapsed().as_secs_f64(), evaluations.load(Ordering::Relaxed));
    Ok(Fit { bytes, report: Report { views, held_out: Vec::new(), seconds, evaluations } })
}

/// One start on its way.
struct Candidate {
    objective: usize,
    start: usize,
    cost: f64,
    x: Vec<f64>,
}

/// Numbers of squeezed lobes that are tried: between a third and two thirds.
fn squeezed_counts(settings: &Settings) -> Vec<usize> {
    if let Some(squeezed) = settings.squeezed {
        return vec![squeezed];
    }
    let mut counts: Vec<usize> = [6, 8, 4].iter().map(|n| (n * settings.lobes).div_ceil(12)).collect();
    counts.dedup();
    counts
}

fn describe(settings: &Settings, squeezed: usize) -> String {
    format!(
        "srbf-fit {}: {} lobes, {} squeezed, smoothness {:e}, {} starts, {} steps\n",
        env!("CARGO_PKG_VERSION"),
        settings.lobes,
        squeezed,
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
    range("squeezed", settings.squeezed.is_none_or(|n| n <= settings.lobes), "at most the number of lobes")?;
    range("smoothness", (1e-12..=1e3).contains(&settings.smoothness), "from 1e-12 to 1000")?;
    if let Some(knots) = &settings.knots {
        let rising = knots.windows(2).all(|w| w[1] - w[0] > 1e-4);
        let inside = knots.len() <= 1024 && knots.first() == Some(&0.0) && knots.last() <= Some(&FRAC_PI_2);
        range("knots", rising && inside, "from 0 rising to at most pi / 2 radians, at most 1024")?;
    }
    range("starts", (1..=1000).contains(&settings.starts), "from 1 to 1000")?;
    range("steps", (1..=100_000).contains(&settings.steps), "from 1 to 100000")
}
