//! The fit: one family of lobes, followed over all views at once.
//!
//! Stage by stage there are fewer candidates, more steps, and less stiffness: a stiff family cannot lose its order. Early stages
//! see a thinned table. In the last one the albedo is held closely, and the weights of the tail follow the fit.

use crate::balance;
use crate::choice;
use crate::exchange;
use crate::initialize;
use crate::levenberg;
use crate::material;
use crate::objective::Objective;
use crate::parameters::Layout;
use crate::report::{Ending, Report, ViewReport};
use crate::schedule::{Stage, stages};
use crate::table::Table;
use crate::{FitError, Settings};
use rayon::prelude::*;
use std::borrow::Cow;
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
pub(crate) const ENERGY_OF_A_QUADRATURE: f64 = 30.0;

/// The same for scattered samples, whose albedo depends by 1 % on how one interpolates between them.
const ENERGY_OF_SAMPLES: f64 = 1.0;

/// Cost of an ordinary fit, an error of 2 to 3 %.
const USUAL_COST: f64 = 1e-3;

/// Times that the table is made again, with directions that the lobes draw and at other views: a lobe that is sharp between the
/// directions and views of a table costs nothing there (steel at 42.5 degrees: 32 % in place of 4 %).
pub(crate) const LOOKS: usize = 3;

/// Most that smoothness and albedo weigh more beside a large error: without a limit, mirror-like materials are held so stiffly
/// that ilm_solo_m_68 ends at 15 % in place of 12 %.
const MOST_SCALE: f64 = 3.0;

/// Largest `f cos / pdf`, over the mean, that a fit may have, in directions that the lobes draw and at the horizon too: one with
/// more is fitted again with a lobe that is kept wide; and what that adds to its error.
const MOST_WEIGHT: f64 = 18.0;
const WIDENED: f64 = 1.1;
/// Largest relative variance that a view should have, and the share of the error for which every doubling of either is avoided.
const MOST_VARIANCE: f64 = 0.25;
const DOUBLING: f64 = 0.07;

/// One start on its way.
struct Candidate {
    /// Index of its numbers of squeezed and of mirrored lobes.
    shape: usize,
    start: usize,
    /// Whether there is a better one of its shape.
    is_second: bool,
    cost: f64,
    /// Why the solver ended that moved it last, exchanges aside.
    ending: Ending,
    x: Vec<f64>,
}

/// Fits lobes to a table, as many as the settings say or as few as reach the error that they ask for. `progress` is called with
/// the share of the work that is done, 0 to 1.
///
/// # Errors
/// [`FitError::Setting`], [`FitError::Table`]; [`FitError::Format`] never for a table with finite numbers.
pub fn fit(table: &Table, settings: &Settings, progress: impl FnMut(f64)) -> Result<Fit, FitError> {
    settings.check()?;
    if let Some(error) = settings.error {
        let fit = |settings: &Settings| run(Data::Samples(table), settings, |_| {});
        return choice::fewest_lobes(settings, error, progress, fit);
    }
    run(Data::Samples(table), settings, progress)
}

/// What can be tabulated wherever the fit asks for it.
pub(crate) trait Source: Sync {
    /// As many knots, where the material changes.
    fn knots(&self, count: usize) -> Vec<f64>;

    /// Angles, radians, and the albedo there: more of them than views.
    fn albedo(&self) -> &[(f64, [f64; 3])];

    /// A table of views between knots. With `seen`, bytes of a material and a number: also in directions that its lobes draw,
    /// others and at other views for every number.
    fn table(&self, knots: &[f64], seen: Option<(&[u8], usize)>) -> Result<Table, FitError>;
}

/// What is fitted.
#[derive(Clone, Copy)]
pub(crate) enum Data<'a> {
    Samples(&'a Table),
    Source(&'a dyn Source),
}

/// How far a fit has come.
struct Work<'a> {
    done: usize,
    total: usize,
    progress: &'a mut dyn FnMut(f64),
    /// Evaluations of what is made small.
    evaluations: AtomicUsize,
}

/// [`fit`], of any data.
pub(crate) fn run(
    data: Data<'_>,
    settings: &Settings,
    mut progress: impl FnMut(f64),
) -> Result<Fit, FitError> {
    let start = Instant::now();
    let knots = match (&settings.knots, data) {
        (Some(knots), _) => knots.clone(),
        (None, Data::Samples(table)) => Layout::knots_at(table.views.iter().map(|v| v.theta), KNOT_DISTANCE),
        (None, Data::Source(source)) => source.knots(settings.views),
    };
    let table = match data {
        Data::Samples(table) => Cow::Borrowed(table),
        Data::Source(source) => Cow::Owned(source.table(&knots, None)?),
    };
    let (energy, looks) = match data {
        Data::Samples(_) => (ENERGY_OF_SAMPLES, 0),
        Data::Source(_) => (ENERGY_OF_A_QUADRATURE, LOOKS),
    };
    let stages = stages(settings, energy, looks);
    let total = stages.iter().map(|stage| stage.work()).sum();
    let mut work = Work { done: 0, total, progress: &mut progress, evaluations: AtomicUsize::new(0) };

    let (scouting, refining) = stages.split_at(stages.partition_point(|stage| !stage.full));
    let shapes = settings.shapes(matches!(data, Data::Source(_)));
    let layouts = shapes.into_iter().map(|(squeezed, mirrored)| {
        Layout::new(settings.lobes - mirrored, squeezed, mirrored, knots.clone())
    });
    let count = refining.first().map_or(0, |stage| stage.keep);
    let scouted = scout(&table, layouts.collect(), (scouting, count), &mut work)?;
    let mut finalists = Vec::new();
    for (layout, candidate) in scouted {
        finalists.push(Finalist::new(data, settings, &table, layout, candidate)?);
    }
    for stage in refining {
        finalists.truncate(stage.keep);
        refine(data, &mut finalists, stage, &mut work)?;
        work.done += stage.work();
        // What has been seen for the last time is judged as what it is.
        let is_final = stage.look == Some(LOOKS - 1);
        let rank = |f: &Finalist<'_>| if is_final { f.final_rank() } else { f.rank() };
        finalists.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
    }
    let Some(mut best) = finalists.into_iter().next() else {
        return Err(FitError::Setting { name: "starts", reason: "at least 1".into() });
    };
    if let Data::Source(source) = data {
        best.look(source, LOOKS)?;
        if !best.samples_well() {
            let (rank, layout, x) = (best.final_rank(), best.layout.clone(), best.candidate.x.clone());
            if best.widen() {
                for stage in refining {
                    refine(data, std::slice::from_mut(&mut best), &stage.again(), &mut work)?;
                }
                best.look(source, LOOKS)?;
                // Of few lobes, none can be spared.
                if rank < best.final_rank() {
                    (best.layout, best.candidate.x) = (layout, x);
                }
            }
        }
        balance::balance(&best.layout, &mut best.candidate.x, source.albedo());
    }
    let Finalist { layout, table, candidate, .. } = best;

    let text = format!("{}{}", settings.provenance, settings.describe(&layout));
    let bytes = material::encode(&layout, &candidate.x, &text)?;
    let views = reports(&bytes, &table)?;
    let evaluations = work.evaluations.into_inner();
    progress(1.0);
    let (seconds, ending) = (start.elapsed().as_secs_f64(), Some(candidate.ending));
    Ok(Fit { bytes, report: Report { views, seconds, evaluations, ending, ..Report::default() } })
}

/// Takes all starts through the first stages, on a thinned table, and returns at most `count` of them: the best of each shape, and
/// others only if there are fewer shapes than that.
fn scout(
    table: &Table,
    layouts: Vec<Layout>,
    (stages, count): (&[Stage], usize),
    work: &mut Work<'_>,
) -> Result<Vec<(Layout, Candidate)>, FitError> {
    let with_seconds = layouts.len() < count;
    let starts = stages.first().map_or(0, |stage| stage.keep);
    let mut candidates: Vec<Candidate> = (0..starts)
        .map(|start| Candidate {
            shape: start % layouts.len(),
            start,
            is_second: false,
            cost: f64::INFINITY,
            ending: Ending::Steps,
            x: Vec::new(),
        })
        .collect();
    let thin = table.thinned(SCOUTED_SAMPLES);
    let objectives: Vec<Objective> =
        layouts.into_iter().map(|layout| Objective::new(&thin, layout)).collect::<Result<_, _>>()?;
    for stage in stages {
        candidates.truncate(stage.keep);
        let tasks = candidates.iter_mut();
        let tasks = tasks.map(|c| Task { table, objective: &objectives[c.shape], candidate: c });
        advance(stage, tasks.collect(), work);
        work.done += stage.work();
        rank(&mut candidates);
    }
    let with_layout = |c: Candidate| (objectives[c.shape].layout.clone(), Candidate { shape: 0, ..c });
    let finalists = candidates.into_iter().filter(|c| with_seconds || !c.is_second).take(count);
    Ok(finalists.map(with_layout).collect())
}

/// The best of a shape, on a table of its own.
struct Finalist<'a> {
    layout: Layout,
    table: Cow<'a, Table>,
    /// The table as its lobes last saw it.
    seen: Option<Table>,
    candidate: Candidate,
    /// Mean error on that, of values and of the albedo, the largest variance of a view, and the largest weight on all that they saw
    /// since the first look.
    error: f64,
    variance: f64,
    largest_weight: f64,
}

impl<'a> Finalist<'a> {
    fn new(
        data: Data<'_>,
        settings: &Settings,
        table: &'a Table,
        layout: Layout,
        candidate: Candidate,
    ) -> Result<Self, FitError> {
        let mut new = Self {
            layout,
            table: Cow::Borrowed(table),
            seen: None,
            candidate,
            error: f64::INFINITY,
            variance: f64::INFINITY,
            largest_weight: f64::INFINITY,
        };
        // Lobes in pairs are fewer bytes, which are spent on more views.
        let views = material::views_of_equal_size(&new.layout);
        if let (Data::Source(source), None, true) = (data, &settings.knots, views > new.layout.knots.len()) {
            let denser = Layout { knots: source.knots(views), ..new.layout.clone() };
            new.candidate.x = new.layout.resampled(&new.candidate.x, &denser);
            new.table = Cow::Owned(source.table(&denser.knots, None)?);
            new.layout = denser;
        }
        Ok(new)
    }

    fn samples_well(&self) -> bool {
        self.largest_weight <= MOST_WEIGHT
    }

    /// What the best has least of.
    fn rank(&self) -> f64 {
        if self.samples_well() { self.error } else { WIDENED * self.error }
    }

    /// The same of what is not fitted again.
    fn final_rank(&self) -> f64 {
        let doublings = |value: f64, most: f64| libm::log2((value / most).max(1.0));
        let weight = doublings(self.largest_weight, MOST_WEIGHT);
        self.error * (1.0 + DOUBLING * (weight + doublings(self.variance, MOST_VARIANCE)))
    }

    /// Gives up a lobe for one that is kept wide; false if that cannot be done.
    fn widen(&mut self) -> bool {
        let table = self.seen.as_ref().unwrap_or(&self.table);
        let given_up = Objective::new(table, self.layout.clone())
            .ok()
            .and_then(|objective| objective.least_missed(&self.candidate.x));
        let widened = given_up.and_then(|lobe| self.layout.widened(&self.candidate.x, lobe));
        let is_widened = widened.is_some();
        if let Some(widened) = widened {
            (self.layout, self.candidate.x) = widened;
        }
        is_widened
    }

    /// Looks at the lobes on a table that they see.
    fn look(&mut self, source: &dyn Source, round: usize) -> Result<(), FitError> {
        let mut x = self.candidate.x.clone();
        balance::balance(&self.layout, &mut x, source.albedo());
        let bytes = material::encode(&self.layout, &x, "")?;
        let mut seen = source.table(&self.layout.knots, Some((&bytes, round)))?;
        let reports = reports(&bytes, &seen)?;
        self.error = mean_over_angle(&reports);
        self.variance = reports.iter().map(|view| view.variance).fold(0.0, f64::max);
        // A view where the density is too small may be seen once only.
        let largest = reports.iter().map(ViewReport::largest_weight_as_summed).fold(0.0, f64::max);
        self.largest_weight = if round == 0 { largest } else { self.largest_weight.max(largest) };
        // The last stage sees the views of the one before too: what is seen no more is done again.
        let before = self.seen.take().filter(|_| round + 1 == LOOKS);
        seen.views.extend(before.into_iter().flat_map(|table| table.views));
        self.seen = Some(seen);
        Ok(())
    }
}

/// Takes all finalists through a stage, side by side.
fn refine(
    data: Data<'_>,
    finalists: &mut [Finalist<'_>],
    stage: &Stage,
    work: &mut Work<'_>,
) -> Result<(), FitError> {
    let objectives = finalists
        .iter()
        .map(|f| Objective::new(f.seen.as_ref().unwrap_or(&f.table), f.layout.clone()))
        .collect::<Result<Vec<_>, _>>()?;
    let tasks = finalists.iter_mut().zip(&objectives).map(|(f, objective)| Task {
        table: f.seen.as_ref().unwrap_or(&f.table),
        objective,
        candidate: &mut f.candidate,
    });
    advance(stage, tasks.collect(), work);
    if let (Some(round), Data::Source(source)) = (stage.look, data) {
        finalists.par_iter_mut().try_for_each(|f| f.look(source, round))?;
    }
    Ok(())
}

/// The material against every view of a table.
fn reports(bytes: &[u8], table: &Table) -> Result<Vec<ViewReport>, FitError> {
    table.views.iter().map(|view| ViewReport::new(bytes, view)).collect()
}

/// Error of values and of the albedo, the mean over the angle of views from the normal on: in one layout more of them may be at
/// grazing angles, where errors are larger, than in another.
fn mean_over_angle(reports: &[ViewReport]) -> f64 {
    let last = reports.len() - 1;
    let halfway = |i: usize| 0.5 * (reports[i].theta + reports[i + 1].theta);
    let width = |i: usize| {
        let begin = if i == 0 { 0.0 } else { halfway(i - 1) };
        if i == last { reports[last].theta - begin } else { halfway(i) - begin }
    };
    // A single view at the normal is as wide as nothing.
    let (mut sum, mut total) = (0.0, 0.0);
    for (i, report) in reports.iter().enumerate() {
        let width = width(i) + f64::EPSILON;
        sum += width * (report.error + report.energy_error());
        total += width;
    }
    sum / total
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

/// A candidate, and what it is to make small.
struct Task<'a> {
    table: &'a Table,
    objective: &'a Objective,
    candidate: &'a mut Candidate,
}

/// Takes candidates through a stage, side by side; what becomes of each does not depend on the others, nor on threads.
fn advance(stage: &Stage, tasks: Vec<Task<'_>>, work: &mut Work<'_>) {
    let Work { done, total, progress, evaluations } = work;
    let (send, receive) = std::sync::mpsc::channel();
    std::thread::scope(|scope| {
        let worker = scope.spawn(|| {
            tasks.into_par_iter().for_each_with(send, |send, task| {
                // Nobody listens any more if the fit is being abandoned.
                advance_one(stage, task, || {
                    evaluations.fetch_add(1, Ordering::Relaxed);
                    let _ = send.send(());
                });
            });
        });
        let mut ticks = 0;
        while !worker.is_finished() {
            if receive.recv_timeout(Duration::from_millis(20)).is_ok() {
                ticks += 1;
                progress((*done + ticks).min(*total) as f64 / *total as f64);
            }
        }
    });
}

fn advance_one(stage: &Stage, task: Task<'_>, mut tick: impl FnMut()) {
    let Task { table, objective, candidate } = task;
    let Candidate { x, cost, start, ending, .. } = candidate;
    if x.is_empty() {
        *x = initialize::start(table, &objective.layout, *start);
    }
    let mut limits = stage.limits;
    let reweighed = stage.full.then(|| objective.reweighed(x, stage.evenly));
    if stage.full {
        // Beside a large error that cannot be helped, smoothness and albedo have to weigh more to count as much.
        let scale = (*cost / USUAL_COST).clamp(1.0, MOST_SCALE);
        limits.weights.smoothness *= scale;
        limits.weights.energy *= if stage.last { scale } else { 1.0 };
    }
    let objective = reweighed.as_ref().unwrap_or(objective);
    (*cost, *ending) = levenberg::minimize(objective, x, limits, &mut tick);
    // Other families in every stage.
    let seed = (256 * *start + stage.runs) as u64;
    *cost = exchange::exchange(objective, x, *cost, (stage.runs - 1, limits), seed, &mut tick);
}
