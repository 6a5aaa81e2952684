//! The fit: one family of lobes, followed over all views at once.
//!
//! Stage by stage there are fewer candidates, more steps, and less stiffness: a stiff family cannot lose its order. Early stages
//! see a thinned table. In the last ones the albedo is held closely, and the weights of the tail follow the fit. The fit
//! then goes through the last of these stages again: with more weight on a goal that it misses, or, if it
//! misses none, with lobes exchanged.

mod candidates;
mod exchange;
mod finalist;
pub(crate) mod schedule;
mod start;

use crate::clock::Clock;
use crate::family::factors::{Asked, Size};
use crate::family::objective::Emphasis;
use crate::family::tuning::factors::{AVERAGED_TO_STORE, TURNS};
use crate::isotropic::balance;
use crate::isotropic::effort::Effort;
use crate::isotropic::encode;
use crate::isotropic::line::Layout;
use crate::isotropic::search::candidates::{Work, scout};
use crate::isotropic::search::finalist::{Finalist, refine, reports};
use crate::isotropic::tuning::schedule::HEAVY_TAIL;
use crate::isotropic::tuning::search::{MORE_ENERGY, MORE_TAIL, MOST_ENERGY};
use crate::judge::report::{Fit, Report};
use crate::settings::FactorNodes;
use crate::table::Table;
use crate::{FitError, Settings};
use rayon::prelude::*;
use schedule::{FACTORED, LAST, LIGHT, Resampling, Stage};
use std::sync::atomic::AtomicUsize;

/// The material whose lobes draw directions of a table, as bytes, and the resampling that it is for.
#[derive(Clone, Copy)]
pub(crate) struct DrawnBy<'a> {
    pub bytes: &'a [u8],
    pub resampling: Resampling,
}

/// A BRDF that is tabulated wherever the fit asks for it.
pub(crate) trait Source: Sync {
    /// How much work its fit is.
    fn effort(&self) -> &Effort;

    /// As many stored views, where the material changes.
    fn view_angles(&self, count: usize) -> Vec<f64>;

    /// The angle of one more stored view, where the mixture of the normal is not like that of views next to it.
    fn next_to_normal(&self) -> Option<f64> {
        None
    }

    /// Angles, radians, and the albedo there: more of them than views.
    fn albedo(&self) -> &[(f64, [f64; 3])];

    /// A table of views between stored views. With `drawn`, also in directions that the lobes of a material draw. Every resampling
    /// has other directions and other views.
    fn table(&self, view_angles: &[f64], drawn: Option<DrawnBy<'_>>) -> Result<Table, FitError>;
}

/// Fits as many lobes as the settings say; `asked`: the settings as the caller gave them, which the provenance tells. `progress` is called with the share of the work that is done, 0 to 1; it falls where a
/// goal is missed by what should have been the end.
pub(crate) fn run(
    source: &dyn Source,
    settings: &Settings,
    asked: &Settings,
    mut progress: impl FnMut(f64) + Send,
) -> Result<Fit, FitError> {
    let start = Clock::start();
    let settings = &settings.within_bytes()?;
    let view_angles =
        settings.view_angles.clone().unwrap_or_else(|| source.view_angles(settings.view_count()));
    let table = source.table(&view_angles, None)?;
    let problem = Problem { source, settings, table: &table, view_angles: &view_angles };
    let mut work = Work { done: 0, total: 0, progress: &mut progress, evaluations: AtomicUsize::new(0) };
    let finalists = problem.solve(LIGHT, &mut work)?;
    let best = problem.improve(finalists, &mut work)?;
    let mut best = problem.finish(best, &mut work)?;
    balance::balance(
        &best.layout,
        &mut best.candidate.x,
        best.factors.as_ref(),
        source.albedo(),
        AVERAGED_TO_STORE,
    );
    let Finalist { layout, table, candidate, factors, curve, .. } = best;

    let text = format!("{}{}", settings.provenance, described(asked, settings.lobes, &layout));
    let bytes = encode::encode(&layout, &candidate.x, factors.as_ref(), &text)?;
    let views = reports(&bytes, &table)?;
    let evaluations = work.evaluations.into_inner();
    progress(1.0);
    let (seconds, ending) = (start.seconds(), Some(candidate.ending));
    Ok(Fit {
        bytes,
        report: Report { views, seconds, evaluations, ending, factor_sizes: curve, ..Report::default() },
    })
}

/// The last line of the provenance: the result, and the options that it was asked for by.
fn described(asked: &Settings, lobes: usize, layout: &Layout) -> String {
    let usual = Settings::default();
    let mut text = format!(
        "srbf-fit {}: {lobes} lobes, {} squeezed, {} in mirrored pairs, smoothness {:e}, {} starts, {} steps, {} exchanges",
        env!("CARGO_PKG_VERSION"),
        layout.squeezed,
        2 * layout.aside,
        asked.smoothness,
        asked.starts,
        asked.steps,
        asked.exchanges
    );
    if asked.bytes != usual.bytes {
        text += &format!(", {} bytes at most", asked.bytes);
    }
    text + "\n"
}

/// The task of a fit.
struct Problem<'a> {
    source: &'a dyn Source,
    settings: &'a Settings,
    table: &'a Table,
    view_angles: &'a [f64],
}

impl<'a> Problem<'a> {
    fn stages(&self, emphasis: Emphasis) -> Vec<Stage> {
        schedule::stages(self.settings, emphasis.energy)
    }

    /// The stages for a number of finalists that have been through them: all stages after the scouting. The first of them reaches
    /// minima that the last ones, which are short, do not.
    fn stages_again(&self, emphasis: Emphasis, keep: usize, exchanges: usize) -> Vec<Stage> {
        let stages = self.stages(emphasis).into_iter().filter(|stage| stage.scope.is_whole());
        stages.map(|stage| stage.again(keep, exchanges)).collect()
    }

    /// The best of all starts, and the last that was given up.
    fn solve(&self, emphasis: Emphasis, work: &mut Work<'_>) -> Result<Vec<Finalist<'a>>, FitError> {
        let Self { source, settings, table, view_angles } = *self;
        let stages = self.stages(emphasis);
        work.total = schedule::work(&stages)
            + schedule::work(&self.stages_again(emphasis, 1, schedule::exchanges_again(settings)));
        let (scouting, refining) = stages.split_at(stages.partition_point(|stage| !stage.scope.is_whole()));
        let shapes = settings.shapes();
        let layouts = shapes.into_iter().map(|(squeezed, mirrored)| {
            Layout::new(settings.lobes - mirrored, squeezed, mirrored, view_angles.to_vec())
        });
        let count = refining.first().map_or(0, |stage| stage.keep);
        let scouted = scout(table, layouts.collect(), emphasis, (scouting, count), work)?;
        let (mut finalists, mut others) = (Vec::new(), Vec::new());
        for (layout, candidate) in scouted {
            finalists.push(Finalist::new(source, settings, table, layout, candidate)?);
        }
        for stage in refining {
            if stage.keep < finalists.len() {
                others = finalists.split_off(stage.keep);
            }
            refine(source, &mut finalists, emphasis, stage, work)?;
            work.done += stage.work();
            // After the last resampling a candidate counts as it is.
            let is_final = stage.resampling == Some(Resampling::Last);
            let rank = |f: &Finalist<'_>| if is_final { f.rank() } else { f.early_rank() };
            finalists.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
        }
        let Some(best) = finalists.first_mut() else {
            return Err(FitError::Setting { name: "starts", reason: "at least 1".into() });
        };
        best.resample(source, Resampling::Judging)?;
        finalists.extend(others.into_iter().take(1));
        Ok(finalists)
    }

    /// Goes on with finalists, from where they ended, and returns the best that there was. Those that miss a goal are moved with
    /// more and more weight on it. After the first round that ends where they cannot become better than the best. One that misses
    /// none, at first or after the first round, has lobes exchanged.
    fn improve(
        &self,
        mut finalists: Vec<Finalist<'a>>,
        work: &mut Work<'_>,
    ) -> Result<Finalist<'a>, FitError> {
        let (mut best, mut emphasis) = (finalists[0].clone(), LIGHT);
        if !best.misses() {
            finalists.truncate(1);
        }
        for round in 0..self.source.effort().rounds {
            // Then it is the only one.
            let meets_all = !finalists[0].misses();
            emphasis = emphasized(&mut finalists, emphasis);
            let exchanges = if meets_all { schedule::exchanges_again(self.settings) } else { 0 };
            self.again(&mut finalists, (emphasis, exchanges), work)?;
            for finalist in &finalists {
                if finalist.rank() < best.rank() {
                    best = finalist.clone();
                }
            }
            finalists.retain(|f| f.misses() && f.error() < best.rank());
            if finalists.is_empty() {
                if round > 0 || meets_all || best.misses() {
                    break;
                }
                finalists.push(best.clone());
            }
        }
        Ok(best)
    }

    /// Moves the best once more, by the measure: without factors, and with factors, where lobes and table take turns. The fit
    /// with factors has to be better by a margin.
    fn finish(&self, best: Finalist<'a>, work: &mut Work<'_>) -> Result<Finalist<'a>, FitError> {
        let mut moved = best.clone();
        if let (None, Some(theta)) = (&self.settings.view_angles, self.source.next_to_normal()) {
            moved.add_view(theta);
        }
        let size = match self.settings.factors {
            FactorNodes::Given(nodes) => Some(Asked::Given(Size::reciprocal(nodes))),
            FactorNodes::Signed(nodes) => Some(Asked::Given(Size::signed(nodes))),
            FactorNodes::Chosen => Some(Asked::Within(self.settings.bytes))
                .filter(|_| moved.has_room_for_factors(self.settings.bytes)),
            FactorNodes::None => None,
        };
        let rounds = self.source.effort().factor_rounds;
        let is_dense = self.source.effort().is_dense;
        let Some(stage) = self.stages(LAST).pop() else { return Ok(best) };
        let stage = Stage { keep: 1, resampling: None, ..stage };
        work.total = work.total.max(work.done + rounds * stage.work());
        let mut with: Option<Finalist<'a>> = None;
        // One round more for large weights.
        for round in 0..rounds + 1 {
            let Some(size) = size else { break };
            if round == rounds && with.as_ref().is_none_or(Finalist::has_small_weights) {
                break;
            }
            let emphasis =
                if moved.factors.is_some() && moved.is_near_largest_weight() { FACTORED } else { LAST };
            let emphasis = Emphasis { is_dense, ..emphasis };
            moved.resample_for_last_stage(self.source)?;
            self.take_turns(&mut moved, size, (emphasis, &stage), work)?;
            if round + 1 < rounds && self.settings.view_angles.is_none() && self.settings.views.is_none() {
                moved.add_views_at_bends(self.settings.bytes);
            }
            moved.resample(self.source, Resampling::Judging)?;
            if with.as_ref().is_none_or(|with| moved.rank() < with.rank()) {
                with = Some(moved.clone());
            }
        }
        if let Some(with) =
            with.filter(|with| matches!(size, Some(Asked::Given(_))) || with.is_worth_factors(&best))
        {
            return Ok(with);
        }
        let mut moved = best.clone();
        moved.resample_for_last_stage(self.source)?;
        self.move_by_what_is_seen(&mut moved, &stage, work)?;
        Ok(if moved.rank() < best.rank() { moved } else { best })
    }

    /// Factors and lobes are fitted in turn, on one table. The first turn of all chooses the size of the factors.
    fn take_turns(
        &self,
        finalist: &mut Finalist<'a>,
        size: Asked,
        (emphasis, stage): (Emphasis, &Stage),
        work: &mut Work<'_>,
    ) -> Result<(), FitError> {
        let part = stage.part(TURNS);
        for _ in 0..TURNS {
            finalist.fit_factors(size, emphasis)?;
            refine(self.source, std::slice::from_mut(finalist), emphasis, &part, work)?;
            work.done += part.work();
        }
        Ok(())
    }

    fn move_by_what_is_seen(
        &self,
        finalist: &mut Finalist<'a>,
        stage: &Stage,
        work: &mut Work<'_>,
    ) -> Result<(), FitError> {
        let emphasis = Emphasis { is_dense: self.source.effort().is_dense, ..LAST };
        refine(self.source, std::slice::from_mut(finalist), emphasis, stage, work)?;
        work.done += stage.work();
        finalist.resample(self.source, Resampling::Judging)
    }

    /// Takes finalists through a round.
    fn again(
        &self,
        finalists: &mut [Finalist<'a>],
        (emphasis, exchanges): (Emphasis, usize),
        work: &mut Work<'_>,
    ) -> Result<(), FitError> {
        let stages = self.stages_again(emphasis, finalists.len(), exchanges);
        work.total = work.total.max(work.done + schedule::work(&stages));
        for stage in &stages {
            refine(self.source, finalists, emphasis, stage, work)?;
            work.done += stage.work();
        }
        finalists.par_iter_mut().try_for_each(|finalist| finalist.resample(self.source, Resampling::Judging))
    }
}

/// What finalists are moved with next: more weight on the goals that they miss, and a lobe that is kept wide in those whose weights
/// stay large.
fn emphasized(finalists: &mut [Finalist<'_>], before: Emphasis) -> Emphasis {
    let mut emphasis = before;
    if finalists.iter().any(|f| !f.keeps_energy()) {
        emphasis.energy = (MORE_ENERGY * emphasis.energy).min(MOST_ENERGY);
    }
    let mut is_widened = false;
    for finalist in finalists.iter_mut().filter(|f| !f.has_small_weights()) {
        is_widened |= emphasis.tail >= HEAVY_TAIL && finalist.widen();
    }
    if !is_widened && finalists.iter().any(|f| !f.has_small_weights() || !f.has_small_variances()) {
        emphasis.tail = (MORE_TAIL * emphasis.tail).max(HEAVY_TAIL);
    }
    emphasis
}
