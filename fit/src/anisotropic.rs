//! The fit of anisotropic materials: one family of lobes, followed over the hemisphere of outgoing directions.
//!
//! What an isotropic fit (`track.rs`) does along one angle is done here over a grid of angle and azimuth. Azimuths whose views
//! follow by half a turn are left out; a material that has mirrors, too, is fitted over half a turn all the same.

mod blocks;
mod encode;
mod layout;
mod model;
mod objective;
mod report;
mod solve;
mod start;
mod table;

use crate::report::Report;
use crate::table::evaluable::{Brdf, Density, Symmetry};
use crate::{Fit, FitError, Settings};
use layout::Layout;
use objective::Objective;
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::time::Instant;

/// Rings of knots, the normal counted, angle of the last one in degrees, and knots of a ring over half a turn.
const RINGS: usize = 9;
const LAST_RING: f64 = 87.0;
const AZIMUTHS: usize = 8;

/// Outgoing directions that are tabulated, beside those of the knots, for each cell between knots.
const PER_CELL: usize = 2;

/// How densely a view is tabulated.
const DENSITY: Density = Density { hemisphere: 350, cap: 100 };

/// Starts that are tried, steps that each takes, and share of the samples that it sees.
const STARTS: usize = 4;
const SCOUTING: usize = 12;
const EVERY: usize = 3;

/// Roughness weight over that of isotropic fits: a fit that sees every cell needs little to be told.
const SMOOTHNESS: f64 = 0.1;

/// Fits lobes to an anisotropic BRDF that can be evaluated. The report has held-out views in the middle of every cell.
///
/// # Errors
/// [`FitError::Table`] if it is black; [`FitError::Format`] never for finite numbers.
pub(crate) fn fit_brdf(
    brdf: &dyn Brdf,
    settings: &Settings,
    mut progress: impl FnMut(f64),
) -> Result<Fit, FitError> {
    let clock = Instant::now();
    let layout = layout(brdf.symmetry(), settings);
    let knots: Vec<(f64, f64)> = (0..layout.knots()).map(|k| layout.angles(k)).collect();
    let mut views = table::tabulate(brdf, &knots, DENSITY);
    let at_knots = views.clone();
    views.extend(table::tabulate(brdf, &between(&layout), DENSITY));

    let smoothness = SMOOTHNESS * settings.smoothness;
    let thin = Objective::new(&views, layout.clone(), 10.0 * smoothness, EVERY)?;
    let starts = settings.starts.min(STARTS);
    let total = (SCOUTING + settings.steps) as f64;
    progress(0.0);
    let mut candidates: Vec<(f64, usize, Vec<f64>)> = (0..starts)
        .into_par_iter()
        .map(|n| {
            let mut x = start::start(&at_knots, &layout, n);
            (solve::minimize(&thin, &mut x, SCOUTING, 1e-3, || {}), n, x)
        })
        .collect();
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let Some((_, _, mut x)) = candidates.into_iter().next() else {
        return Err(FitError::Setting { name: "starts", reason: "at least 1".into() });
    };
    let full = Objective::new(&views, layout.clone(), smoothness, 1)?;
    let mut done = SCOUTING;
    solve::minimize(&full, &mut x, settings.steps, 2e-3, || {
        done += 1;
        progress(done as f64 / total);
    });

    let text = format!("{}{}", settings.provenance, describe(settings, &layout));
    let bytes = encode::encode(&layout, &x, &text)?;
    let finer = Density { hemisphere: 1000, cap: 300 };
    let held_out = table::tabulate(brdf, &middles(&layout), finer);
    let judge = |views: &[table::View]| report::judge(&bytes, views);
    let report =
        Report { views: judge(&views)?, held_out: judge(&held_out)?, seconds: clock.elapsed().as_secs_f64() };
    progress(1.0);
    Ok(Fit { bytes, report })
}

fn layout(symmetry: Symmetry, settings: &Settings) -> Layout {
    let turns = if symmetry == Symmetry::None { 1 } else { 2 };
    let last = LAST_RING.to_radians();
    let even = || (0..RINGS).map(|n| last * n as f64 / (RINGS - 1) as f64).collect();
    Layout {
        lobes: settings.lobes,
        squeezed: settings.squeezed.unwrap_or((3 * settings.lobes).div_ceil(4)),
        thetas: settings.knots.clone().unwrap_or_else(even),
        azimuths: AZIMUTHS * 2 / turns,
        turns,
    }
}

/// Outgoing directions at irregular places of every cell: what a lobe does between knots is seen wherever it happens.
fn between(layout: &Layout) -> Vec<(f64, f64)> {
    let mut directions = Vec::new();
    for (n, rings) in layout.thetas.windows(2).enumerate() {
        for azimuth in 0..layout.azimuths {
            for i in 0..PER_CELL {
                // The generalised golden ratio of two dimensions (Roberts 2018) fills a square evenly.
                let index = ((n * layout.azimuths + azimuth) * PER_CELL + i) as f64;
                let (u, v) = ((0.754_877_666 * index).fract(), (0.569_840_291 * index).fract());
                let step = TAU / (layout.turns * layout.azimuths) as f64;
                directions.push((rings[0] + u * (rings[1] - rings[0]), (azimuth as f64 + v) * step));
            }
        }
    }
    directions
}

/// The middle of every cell.
fn middles(layout: &Layout) -> Vec<(f64, f64)> {
    let step = TAU / (layout.turns * layout.azimuths) as f64;
    let cells = layout.thetas.windows(2).flat_map(|w| {
        let theta = 0.5 * (w[0] + w[1]);
        (0..layout.azimuths).map(move |a| (theta, (a as f64 + 0.5) * step))
    });
    cells.collect()
}

fn describe(settings: &Settings, layout: &Layout) -> String {
    format!(
        "srbf-fit {}: anisotropic, {} lobes, {} squeezed, {} rings of {} views over 1/{} turn, smoothness {:e}, {} steps\n",
        env!("CARGO_PKG_VERSION"),
        layout.lobes,
        layout.squeezed,
        layout.thetas.len() - 1,
        layout.azimuths,
        layout.turns,
        settings.smoothness,
        settings.steps
    )
}
