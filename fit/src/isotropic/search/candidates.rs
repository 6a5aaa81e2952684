//! Starts on their way to a fit: moved downhill side by side, the best of them further.

use crate::FitError;
use crate::family::objective::{Emphasis, Weighted};
use crate::isotropic::line::{Layout, Objective};
use crate::isotropic::search::exchange::exchange;
use crate::isotropic::search::schedule::{Stage, side_by_side};
use crate::isotropic::search::start;
use crate::isotropic::tuning::candidates::{MOST_SCALE, SCOUTED_SAMPLES, USUAL_COST};
use crate::judge::report::Ending;
use crate::numeric::levenberg::minimize;
use crate::table::Table;
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// One start on its way.
#[derive(Clone)]
pub(crate) struct Candidate {
    /// Index of its numbers of squeezed and of mirrored lobes.
    shape: usize,
    start: usize,
    /// Whether there is a better one of its shape.
    is_second: bool,
    cost: f64,
    /// Why the solver ended that moved it last, exchanges aside.
    pub ending: Ending,
    pub x: Vec<f64>,
}

/// How far a fit has come.
pub(crate) struct Work<'a> {
    pub done: usize,
    pub total: usize,
    pub progress: &'a mut (dyn FnMut(f64) + Send),
    /// Evaluations of the objective.
    pub evaluations: AtomicUsize,
}

/// Takes all starts through the first stages, on a thinned table, and returns at most `count` of them: the best of each shape, and
/// others only if there are fewer shapes than that.
pub(crate) fn scout(
    table: &Table,
    layouts: Vec<Layout>,
    emphasis: Emphasis,
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
    let objectives: Vec<Objective> = layouts
        .into_iter()
        .map(|layout| Objective::new(&thin, layout, emphasis, None))
        .collect::<Result<_, _>>()?;
    for stage in stages {
        candidates.truncate(stage.keep);
        let tasks = candidates.iter_mut();
        let tasks =
            tasks.map(|c| Task { table, objective: Cow::Borrowed(&objectives[c.shape]), candidate: c });
        advance(stage, tasks.collect(), work);
        work.done += stage.work();
        rank(&mut candidates);
    }
    let with_layout = |c: Candidate| (objectives[c.shape].layout.clone(), Candidate { shape: 0, ..c });
    let finalists = candidates.into_iter().filter(|c| with_seconds || !c.is_second).take(count);
    Ok(finalists.map(with_layout).collect())
}

/// Sorts by cost, the best of every shape before the second of any: the quality of a shape shows late.
fn rank(candidates: &mut [Candidate]) {
    candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.start.cmp(&b.start)));
    let seconds: Vec<bool> = (0..candidates.len())
        .map(|i| candidates[..i].iter().any(|c| c.shape == candidates[i].shape))
        .collect();
    candidates.iter_mut().zip(seconds).for_each(|(candidate, is_second)| candidate.is_second = is_second);
    candidates.sort_by_key(|c| c.is_second);
}

/// A candidate and its objective.
pub(crate) struct Task<'a> {
    pub table: &'a Table,
    pub objective: Cow<'a, Objective>,
    pub candidate: &'a mut Candidate,
}

/// Takes candidates through a stage, side by side. The result of each depends neither on the others nor on threads.
pub(crate) fn advance(stage: &Stage, mut tasks: Vec<Task<'_>>, work: &mut Work<'_>) {
    let Work { done, total, progress, evaluations } = work;
    let lobes = tasks.first().map_or(0, |task| task.objective.layout.lobes);
    // Told by whoever makes a step, on the threads that the caller's are among: others would be those of the process, which a
    // caller may have good reason not to use.
    let told = Mutex::new((*done, progress));
    let tick = || {
        evaluations.fetch_add(1, Ordering::Relaxed);
        // Where a caller's function has panicked, the fit is being abandoned.
        if let Ok(mut told) = told.lock() {
            let (ticks, progress) = &mut *told;
            *ticks += 1;
            progress((*ticks).min(*total) as f64 / *total as f64);
        }
    };
    while !tasks.is_empty() {
        let others = tasks.split_off(tasks.len().min(side_by_side(lobes)));
        std::mem::replace(&mut tasks, others).into_par_iter().for_each(|task| advance_one(stage, task, tick));
    }
}

fn advance_one(stage: &Stage, task: Task<'_>, mut tick: impl FnMut()) {
    let Task { table, objective, candidate } = task;
    let Candidate { x, cost, start, ending, .. } = candidate;
    if x.is_empty() {
        *x = start::start(table, &objective.layout, *start);
    }
    let mut weights = stage.weights;
    let objective =
        if stage.scope.is_whole() { Cow::Owned(objective.into_owned().reweighed(x)) } else { objective };
    if stage.scope.is_whole() {
        // Beside a large error that cannot be helped, smoothness and albedo have to weigh more to count as much.
        let scale = (*cost / USUAL_COST).clamp(1.0, MOST_SCALE);
        weights.smoothness *= scale;
        weights.energy *= if stage.scope.holds_albedo() { scale } else { 1.0 };
    }
    let objective = objective.as_ref();
    (*cost, *ending) = minimize(&Weighted { objective, weights }, x, stage.limits, &mut tick);
    // Other families in every stage.
    let seed = (256 * *start + stage.runs) as u64;
    *cost = exchange(objective, x, *cost, (stage.runs - 1, stage.limits, weights), seed, &mut tick);
}
