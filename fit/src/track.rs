//! The fit: one family of lobes, followed over all views at once.
//!
//! Stage by stage there are fewer candidates, more steps, and less stiffness: a stiff family cannot lose its order. Early stages
//! see a thinned table. In the last one the albedo is held closely, and the weights of the tail follow the fit.

use crate::choice;
use crate::exchange;
use crate::initialize;
use crate::levenberg::{self, Limits};
use crate::material;
use crate::objective::{Objective, Weights};
use crate::parameters::Layout;
use crate::report::{Report, ViewReport};
use crate::table::Table;
use crate::{FitError, Settings};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// A fitted material.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The material, as `.srbf` bytes.
    pub bytes: Vec<u8>,
    /// How good it is.
    pub report: Report,
}

/// Samples of the table on which the first stages run, if it has more.
const SCOUTED_SAMPLES: usize = 5000;

/// Least distance of two knots, radians.
const KNOT_DISTANCE: f64 = 0.035;

/// Weight of the albedo in the last stage where the table has it from a fine quadrature.
pub(crate) const ENERGY_OF_A_QUADRATURE: f64 = 100.0;

/// The same for scattered samples, whose albedo depends by 1 % on how one interpolates between them.
const ENERGY_OF_SAMPLES: f64 = 1.0;

/// Cost of an ordinary fit, an error of 2 to 3 %.
const USUAL_COST: f64 = 1e-3;

/// Times that the table is made again, with directions that the lobes draw and at other views: a lobe that is sharp between the
/// directions and views of a table costs nothing there (steel at 42.5 degrees: 32 % in place of 4 %).
const LOOKS: usize = 3;

/// Most that smoothness and albedo weigh more beside a large error: without a limit, mirror-like materials are held so stiffly
/// that ilm_solo_m_68 ends at 15 % in place of 12 %.
const MOST_SCALE: f64 = 3.0;

/// One stage of a fit.
#[derive(Clone, Copy, Debug)]
struct Stage {
    /// Candidates that take part, the best of the stage before.
    keep: usize,
    /// Whether it sees the whole table, with weights that follow the candidate as it is.
    full: bool,
    /// Times that a candidate is moved downhill: after the first, a lobe is exchanged before each.
    runs: usize,
    limits: Limits,
    /// Whether the albedo is held closely.
    last: bool,
    /// The round of the table made again that it sees, if it can be.
    look: Option<usize>,
}

fn stages(settings: &Settings, energy: f64, looks: usize) -> Vec<Stage> {
    let stage = |keep, full, steps, runs, stiffness: f64, energy, improvement, last| {
        let weights = Weights { smoothness: stiffness * settings.smoothness, energy };
        Stage { keep, full, runs, limits: Limits { steps, improvement, weights }, last, look: None }
    };
    let last =
        |look| Stage { look, ..stage(1, true, settings.steps.div_ceil(4), 1, 1.0, energy, 1e-3, true) };
    let mut stages = vec![
        stage(settings.starts, false, 25, 1, 100.0, 1.0, 1e-3, false),
        stage(4, false, settings.steps / 4, 1, 10.0, 1.0, 1e-3, false),
        stage(2, false, settings.steps.div_ceil(6), 1 + settings.exchanges, 3.0, 1.0, 1e-3, false),
        stage(1, true, settings.steps, 1, 1.0, 1.0, 1e-4, false),
    ];
    if looks == 0 {
        stages.push(last(None));
    }
    stages.extend((0..looks).map(|round| last(Some(round))));
    stages
}

/// One start on its way.
struct Candidate {
    /// Index of its numbers of squeezed and of mirrored lobes.
    shape: usize,
    start: usize,
    /// Whether there is a better one of its shape.
    is_second: bool,
    cost: f64,
    x: Vec<f64>,
}

/// Fits lobes to a table, as many as the settings say or as few as reach the error that they ask for. `progress` is called with the share of the work that is done, 0 to 1.
///
/// # Errors
/// [`FitError::Setting`], [`FitError::Table`]; [`FitError::Format`] never for a table with finite numbers.
pub fn fit(table: &Table, settings: &Settings, progress: impl FnMut(f64)) -> Result<Fit, FitError> {
    settings.check()?;
    if let Some(error) = settings.error {
        let fit = |settings: &Settings| run(Data::samples(table), settings, |_| {});
        return choice::fewest_lobes(settings, error, progress, fit);
    }
    run(Data::samples(table), settings, progress)
}

/// Makes the table again with directions that lobes draw: bytes of a material, and a number of the round.
pub(crate) type LookAgain<'a> = dyn Fn(&[u8], usize) -> Result<Table, FitError> + Sync + 'a;

/// What is fitted.
#[derive(Clone, Copy)]
pub(crate) struct Data<'a> {
    pub table: &'a Table,
    /// Weight of the albedo in the last stage.
    pub energy: f64,
    /// For what can be evaluated anywhere.
    pub look_again: Option<&'a LookAgain<'a>>,
}

impl<'a> Data<'a> {
    fn samples(table: &'a Table) -> Self {
        Self { table, energy: ENERGY_OF_SAMPLES, look_again: None }
    }
}

/// [`fit`], of any data.
pub(crate) fn run(
    data: Data<'_>,
    settings: &Settings,
    mut progress: impl FnMut(f64),
) -> Result<Fit, FitError> {
    let start = Instant::now();
    let Data { table, energy, look_again } = data;
    let knots = match &settings.knots {
        Some(knots) => knots.clone(),
        None => Layout::knots_at(table.views.iter().map(|v| v.theta), KNOT_DISTANCE),
    };
    let shapes = settings.shapes(look_again.is_some());
    let layout = |&(squeezed, mirrored): &(usize, usize)| Layout {
        lobes: settings.lobes - mirrored,
        squeezed,
        mirrored,
        knots: knots.clone(),
    };
    let objectives_on = |table: &Table| {
        shapes.iter().map(|n| Objective::new(table, layout(n))).collect::<Result<Vec<_>, _>>()
    };
    let (thin, full) = (objectives_on(&table.thinned(SCOUTED_SAMPLES))?, objectives_on(table)?);

    let mut candidates: Vec<Candidate> = (0..settings.starts)
        .map(|n| Candidate {
            shape: n % shapes.len(),
            start: n,
            is_second: false,
            cost: f64::INFINITY,
            x: Vec::new(),
        })
        .collect();
    let stages = stages(settings, energy, if look_again.is_some() { LOOKS } else { 0 });
    let work = |s: &Stage| s.keep.min(settings.starts) * s.runs * s.limits.steps;
    let total: usize = stages.iter().map(work).sum();
    let evaluations = AtomicUsize::new(0);
    let mut done = 0;
    for stage in &stages {
        candidates.truncate(stage.keep);
        let seen;
        let objectives = match (stage.look, look_again, candidates.first()) {
            (Some(round), Some(look_again), Some(c)) => {
                let bytes = material::encode(&full[c.shape].layout, &c.x, "")?;
                seen = objectives_on(&look_again(&bytes, round)?)?;
                &seen
            }
            _ if stage.full => &full,
            _ => &thin,
        };
        let mut ticks = 0;
        advance(table, objectives, stage, &mut candidates, &evaluations, || {
            ticks += 1;
            progress((done + ticks).min(total) as f64 / total as f64);
        });
        done += work(stage);
        rank(&mut candidates);
    }
    let Some(best) = candidates.into_iter().next() else {
        return Err(FitError::Setting { name: "starts", reason: "at least 1".into() });
    };
    let (layout, x) = (&full[best.shape].layout, best.x);

    let text = format!("{}{}", settings.provenance, settings.describe(layout));
    let bytes = material::encode(layout, &x, &text)?;
    let views = table.views.iter().map(|v| ViewReport::new(&bytes, v)).collect::<Result<Vec<_>, _>>()?;
    progress(1.0);
    let seconds = start.elapsed().as_secs_f64();
    let evaluations = evaluations.into_inner();
    Ok(Fit { bytes, report: Report { views, seconds, evaluations, ..Report::default() } })
}

/// Sorts by cost, the best of every shape before the second of any: a shape shows what it is good for late.
fn rank(candidates: &mut [Candidate]) {
    candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.start.cmp(&b.start)));
    let seconds: Vec<bool> = (0..candidates.len())
        .map(|i| candidates[..i].iter().any(|c| c.shape == candidates[i].shape))
        .collect();
    candidates.iter_mut().zip(seconds).for_each(|(candidate, is_second)| candidate.is_second = is_second);
    candidates.sort_by_key(|c| c.is_second);
}

/// Takes all candidates through a stage, side by side; what becomes of each does not depend on the others, nor on threads.
fn advance(
    table: &Table,
    objectives: &[Objective],
    stage: &Stage,
    candidates: &mut [Candidate],
    evaluations: &AtomicUsize,
    mut tick: impl FnMut(),
) {
    let (send, receive) = std::sync::mpsc::channel();
    std::thread::scope(|scope| {
        let worker = scope.spawn(move || {
            candidates.par_iter_mut().for_each_with(send, |send, candidate| {
                // Nobody listens any more if the fit is being abandoned.
                advance_one(table, &objectives[candidate.shape], stage, candidate, || {
                    evaluations.fetch_add(1, Ordering::Relaxed);
                    let _ = send.send(());
                });
            });
        });
        while !worker.is_finished() {
            if receive.recv_timeout(Duration::from_millis(20)).is_ok() {
                tick();
            }
        }
    });
}

fn advance_one(
    table: &Table,
    objective: &Objective,
    stage: &Stage,
    candidate: &mut Candidate,
    mut tick: impl FnMut(),
) {
    let Candidate { x, cost, .. } = candidate;
    if x.is_empty() {
        *x = initialize::start(table, &objective.layout, candidate.start);
    }
    let mut limits = stage.limits;
    let reweighed = stage.full.then(|| objective.reweighed(x));
    if stage.full {
        // Beside a large error that cannot be helped, smoothness and albedo have to weigh more to count as much.
        let scale = (*cost / USUAL_COST).clamp(1.0, MOST_SCALE);
        limits.weights.smoothness *= scale;
        limits.weights.energy *= if stage.last { scale } else { 1.0 };
    }
    let objective = reweighed.as_ref().unwrap_or(objective);
    *cost = levenberg::minimize(objective, x, limits, &mut tick);
    *cost = exchange::exchange(objective, x, *cost, (stage.runs - 1, limits), &mut tick);
}
