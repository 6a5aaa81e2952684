//! The fit: one family of lobes, followed over all views at once.
//!
//! Stage by stage there are fewer candidates, more steps, and less stiffness: a stiff family cannot lose its order. Early stages
//! see a thinned table. In the last ones the albedo is held closely, and the weights of the tail follow the fit. A fit that then misses
//! a goal is mended.

use crate::balance;
use crate::candidates::{Work, scout};
use crate::choice;
use crate::finalist::{Finalist, refine, reports};
use crate::material;
use crate::parameters::Layout;
use crate::report::Report;
use crate::schedule::{Emphasis, HEAVY, LIGHT, LOOKS, MOST_TIMES, SAMPLES, Stage, stages};
use crate::table::Table;
use crate::{FitError, Settings};
use std::borrow::Cow;
use std::sync::atomic::AtomicUsize;
use std::time::Instant;

/// A fitted material.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The material, as `.srbf` bytes.
    pub bytes: Vec<u8>,
    /// How good it is.
    pub report: Report,
}

/// Least distance of two knots, radians.
const KNOT_DISTANCE: f64 = 0.035;

/// Times that a fit which misses a goal is moved again from where it ended, before it is made anew.
const REMEDIES: usize = 2;

/// Fits lobes to a table, as many as the settings say or as few as reach the error that they ask for. `progress` is called with
/// the share of the work that is done, 0 to 1; it falls where what misses a goal is fitted again.
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
    let problem = Problem { data, settings, table: &table, knots: &knots };
    let mut work = Work { done: 0, total: 0, progress: &mut progress, evaluations: AtomicUsize::new(0) };
    let best = match data {
        Data::Samples(_) => problem.solve((SAMPLES, 1), &mut work)?,
        Data::Source(source) => {
            let best = problem.solve((LIGHT, MOST_TIMES), &mut work)?;
            let mut best = problem.mend(source, best, &mut work)?;
            balance::balance(&best.layout, &mut best.candidate.x, source.albedo());
            best
        }
    };
    let Finalist { layout, table, candidate, .. } = best;

    let text = format!("{}{}", settings.provenance, settings.describe(&layout));
    let bytes = material::encode(&layout, &candidate.x, &text)?;
    let views = reports(&bytes, &table)?;
    let evaluations = work.evaluations.into_inner();
    progress(1.0);
    let (seconds, ending) = (start.elapsed().as_secs_f64(), Some(candidate.ending));
    Ok(Fit { bytes, report: Report { views, seconds, evaluations, ending, ..Report::default() } })
}

/// What is to be fitted.
struct Problem<'a> {
    data: Data<'a>,
    settings: &'a Settings,
    table: &'a Table,
    knots: &'a [f64],
}

impl<'a> Problem<'a> {
    fn stages(&self, (emphasis, most_times): (Emphasis, usize)) -> Vec<Stage> {
        let looks = if let Data::Source(_) = self.data { LOOKS } else { 0 };
        stages(self.settings, emphasis.energy, looks, most_times)
    }

    /// The best of all starts, of few lobes up to so many times as many of them.
    fn solve(
        &self,
        (emphasis, most_times): (Emphasis, usize),
        work: &mut Work<'_>,
    ) -> Result<Finalist<'a>, FitError> {
        let Self { data, settings, table, knots } = *self;
        let stages = self.stages((emphasis, most_times));
        work.total += stages.iter().map(Stage::work).sum::<usize>();
        let (scouting, refining) = stages.split_at(stages.partition_point(|stage| !stage.full));
        let shapes = settings.shapes(matches!(data, Data::Source(_)));
        let layouts = shapes.into_iter().map(|(squeezed, mirrored)| {
            Layout::new(settings.lobes - mirrored, squeezed, mirrored, knots.to_vec())
        });
        let count = refining.first().map_or(0, |stage| stage.keep);
        let scouted = scout(table, layouts.collect(), emphasis.tail, (scouting, count), work)?;
        let mut finalists = Vec::new();
        for (layout, candidate) in scouted {
            finalists.push(Finalist::new(data, settings, table, layout, candidate)?);
        }
        for stage in refining {
            finalists.truncate(stage.keep);
            refine(data, &mut finalists, emphasis.tail, stage, work)?;
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
        }
        Ok(best)
    }

    /// Fits again what misses a goal: from where it ended, with more weight on what it misses; then from all starts.
    fn mend(
        &self,
        source: &dyn Source,
        mut best: Finalist<'a>,
        work: &mut Work<'_>,
    ) -> Result<Finalist<'a>, FitError> {
        let (mut mended, mut emphasis) = (best.clone(), LIGHT);
        for _ in 0..REMEDIES {
            if best.missed() == 0 {
                return Ok(best);
            }
            if !mended.keeps_energy() {
                emphasis.energy *= 10.0;
            }
            let mut is_widened = false;
            if !mended.has_small_weights() && emphasis.tail == HEAVY.tail {
                is_widened = mended.widen();
            } else if !mended.has_small_weights() || !mended.has_small_variances() {
                emphasis.tail = HEAVY.tail;
            }
            self.again(source, &mut mended, (emphasis, is_widened), work)?;
            if mended.final_rank() < best.final_rank() {
                best = mended.clone();
            }
        }
        if best.missed() == 0 {
            return Ok(best);
        }
        let mut other = self.solve((HEAVY, MOST_TIMES / 2), work)?;
        if !other.has_small_weights() {
            let mut widened = other.clone();
            if widened.widen() {
                self.again(source, &mut widened, (HEAVY, true), work)?;
                // Of few lobes, none can be spared.
                if widened.final_rank() <= other.final_rank() {
                    other = widened;
                }
            }
        }
        Ok(if other.final_rank() < best.final_rank() { other } else { best })
    }

    /// Moves what has been fitted downhill again; through all that follows the scouting if a lobe was made another.
    fn again(
        &self,
        source: &dyn Source,
        best: &mut Finalist<'a>,
        (emphasis, is_widened): (Emphasis, bool),
        work: &mut Work<'_>,
    ) -> Result<(), FitError> {
        let mut stages: Vec<Stage> = self.stages((emphasis, 1)).iter().map(Stage::again).collect();
        stages.retain(|stage| if is_widened { stage.full } else { stage.last });
        work.total += stages.iter().map(Stage::work).sum::<usize>();
        best.forget();
        for stage in &stages {
            refine(self.data, std::slice::from_mut(best), emphasis.tail, stage, work)?;
            work.done += stage.work();
        }
        best.look(source, LOOKS)
    }
}
