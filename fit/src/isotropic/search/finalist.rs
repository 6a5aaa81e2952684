//! The best of a shape, as it looks to itself: goals, ranks, and the table that it is made to see.

use crate::isotropic::balance;
use crate::isotropic::encode;
use crate::isotropic::factors::{Factors, SIZES};
use crate::isotropic::model::parameters::Layout;
use crate::isotropic::objective::{Emphasis, Objective};
use crate::isotropic::search::Source;
use crate::isotropic::search::candidates::{Candidate, Task, Work, advance};
use crate::isotropic::search::schedule::{LOOKS, Stage, WIDE};
use crate::judge::report::ViewReport;
use crate::judge::verdict::{MOST_ENERGY_ERROR, MOST_VARIANCE, MOST_WEIGHT};
use crate::table::Table;
use crate::{FitError, Settings};
use rayon::prelude::*;
use std::borrow::Cow;

/// What a weight that is too large adds to the error while it may be mended.
const WIDENED: f64 = 1.1;
/// Angle in radians up to which the variance is a goal: 80 degrees.
const STEEPEST: f64 = 1.4;
/// What the error is multiplied by where a goal is missed by more than [`RAMP`] doublings, rising from 1 where it is just met; and the
/// share of the error that every doubling beyond costs. A goal missed by a hair costs a hair.
const MISSED: f64 = 1.25;
const RAMP: f64 = 0.5;
const DOUBLING: f64 = 0.07;
/// What the error may be multiplied by before it is worth the time to mend what is missed.
const TOLERATED: f64 = 1.04;

/// Shares that factors may leave of the rank, or of the error away from the peak, to be worth their bytes.
const WORTH_RANK: f64 = 0.93;
const WORTH_AWAY: f64 = 0.8;

/// The best of a shape, on a table of its own.
#[derive(Clone)]
pub(crate) struct Finalist<'a> {
    pub layout: Layout,
    pub table: Cow<'a, Table>,
    /// The table as its lobes last saw it.
    seen: Option<Table>,
    pub candidate: Candidate,
    /// What its lobes are multiplied by.
    pub factors: Option<Factors>,
    /// Mean error on that, of values and of the albedo, the largest variance of a view, the largest weight on that and, at the end, on
    /// what they saw before; and the largest error of the albedo at any view.
    error: f64,
    /// Mean error away from the peak alone, see `crate::judge::seen`.
    away: f64,
    variance: f64,
    largest_weight: f64,
    energy_error: f64,
}

impl<'a> Finalist<'a> {
    pub fn new(
        source: &dyn Source,
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
            factors: None,
            error: f64::INFINITY,
            away: f64::INFINITY,
            variance: f64::INFINITY,
            largest_weight: f64::INFINITY,
            energy_error: f64::INFINITY,
        };
        // Few lobes, or lobes in pairs, are fewer bytes, which are spent on more views.
        let views = encode::views_of_equal_size(&new.layout, settings.lobes_of_size());
        if settings.knots.is_none() && views > new.layout.knots.len() {
            let denser = Layout { knots: source.knots(views), ..new.layout.clone() };
            new.candidate.x = new.layout.resampled(&new.candidate.x, &denser);
            new.table = Cow::Owned(source.table(&denser.knots, None)?);
            new.layout = denser;
        }
        Ok(new)
    }

    /// What the error is multiplied by for the goals that are missed, weight, variance and energy; 1 if none is.
    fn penalty(&self) -> f64 {
        let missed = |value: f64, most: f64| {
            let doublings = libm::log2((value / most).max(1.0));
            (1.0 + (MISSED - 1.0) * (doublings / RAMP).min(1.0)) * (1.0 + DOUBLING * doublings)
        };
        missed(self.largest_weight, MOST_WEIGHT)
            * missed(self.variance, MOST_VARIANCE)
            * missed(self.energy_error, MOST_ENERGY_ERROR)
    }

    /// Whether a goal is missed by more than a hair.
    pub fn misses(&self) -> bool {
        self.penalty() > TOLERATED
    }

    pub fn has_small_weights(&self) -> bool {
        self.largest_weight <= MOST_WEIGHT
    }

    pub fn has_small_variances(&self) -> bool {
        self.variance <= MOST_VARIANCE
    }

    pub fn keeps_energy(&self) -> bool {
        self.energy_error <= MOST_ENERGY_ERROR
    }

    /// Mean error of values and of the albedo.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// What the best has least of, where all goals count.
    pub fn rank(&self) -> f64 {
        self.error * self.penalty()
    }

    /// How many of the sizes of tables of factors leave it within so many bytes.
    pub fn sizes_within(&self, bytes: usize) -> usize {
        SIZES.iter().take_while(|size| encode::len(&self.layout, Some(**size)) <= bytes).count()
    }

    /// Whether it is worth the bytes of factors that the other one lacks: less of the measure, or, where a grazing peak rules that, much
    /// less away from the peak.
    pub fn is_worth_factors(&self, plain: &Self) -> bool {
        let (rank, away) = (self.rank() / plain.rank(), self.away / plain.away);
        rank < WORTH_RANK || (rank < 1.0 && away < WORTH_AWAY)
    }

    /// The same before the end, where only the weight counts, which gets worse when it is not mended.
    pub fn early_rank(&self) -> f64 {
        if self.has_small_weights() { self.error } else { WIDENED * self.error }
    }

    /// Gives up the least useful lobe for one that is kept wide; false if it has such a lobe, or none to give.
    pub fn widen(&mut self) -> bool {
        let table = self.seen.as_ref().unwrap_or(&self.table);
        let given_up = Objective::new(table, self.layout.clone(), WIDE, self.factors.as_ref())
            .ok()
            .and_then(|objective| objective.least_missed(&self.candidate.x));
        let widened = given_up.and_then(|lobe| self.layout.widened(&self.candidate.x, lobe));
        let is_widened = widened.is_some();
        if let Some(widened) = widened {
            (self.layout, self.candidate.x) = widened;
        }
        is_widened
    }

    /// Fits factors to what the lobes leave, with a table of one of these sizes.
    pub fn fit_factors(&mut self, sizes: &[[usize; 3]], emphasis: Emphasis) -> Result<(), FitError> {
        let table = self.seen.as_ref().unwrap_or(&self.table);
        let objective = Objective::new(table, self.layout.clone(), emphasis, self.factors.as_ref())?;
        let demands = objective.reweighed(&self.candidate.x).demands(&self.candidate.x);
        self.factors = Factors::worthwhile(sizes, &demands);
        Ok(())
    }

    /// Looks at the lobes as before the last stage, views at the knots among what they see.
    pub fn look_again(&mut self, source: &dyn Source) -> Result<(), FitError> {
        self.largest_weight = 0.0;
        self.look(source, LOOKS - 1)
    }

    /// Looks at the lobes on a table that they see.
    pub fn look(&mut self, source: &dyn Source, round: usize) -> Result<(), FitError> {
        let mut x = self.candidate.x.clone();
        self.energy_error = balance::balance(&self.layout, &mut x, self.factors.as_ref(), source.albedo());
        let bytes = encode::encode(&self.layout, &x, self.factors.as_ref(), "")?;
        let mut seen = source.table(&self.layout.knots, Some((&bytes, round)))?;
        let reports = reports(&bytes, &seen)?;
        self.error = mean_over_angle(&reports, |report| report.measure + report.energy_error());
        self.away = mean_over_angle(&reports, ViewReport::away);
        let asked_for = reports.iter().filter(|view| view.theta < STEEPEST);
        self.variance = asked_for.map(|view| view.variance).fold(0.0, f64::max);
        // A view where the density is too small may be seen once only; but what was seen before has been moved far since.
        let largest = reports.iter().map(ViewReport::largest_weight_as_summed).fold(0.0, f64::max);
        self.largest_weight = if round < LOOKS - 1 { largest } else { self.largest_weight.max(largest) };
        // The last stage sees the views of the one before too: what is seen no more is done again.
        let before = self.seen.take().filter(|_| round + 1 == LOOKS);
        seen.views.extend(before.into_iter().flat_map(|table| table.views));
        self.seen = Some(seen);
        Ok(())
    }
}

/// Takes all finalists through a stage, side by side.
pub(crate) fn refine(
    source: &dyn Source,
    finalists: &mut [Finalist<'_>],
    emphasis: Emphasis,
    stage: &Stage,
    work: &mut Work<'_>,
) -> Result<(), FitError> {
    let objectives = finalists
        .iter()
        .map(|f| {
            Objective::new(
                f.seen.as_ref().unwrap_or(&f.table),
                f.layout.clone(),
                emphasis,
                f.factors.as_ref(),
            )
        })
        .collect::<Result<Vec<_>, _>>()?;
    let tasks = finalists.iter_mut().zip(&objectives).map(|(f, objective)| Task {
        table: f.seen.as_ref().unwrap_or(&f.table),
        objective,
        candidate: &mut f.candidate,
    });
    advance(stage, tasks.collect(), work);
    if let Some(round) = stage.look {
        finalists.par_iter_mut().try_for_each(|f| f.look(source, round))?;
    }
    Ok(())
}

/// The material against every view of a table.
pub(crate) fn reports(bytes: &[u8], table: &Table) -> Result<Vec<ViewReport>, FitError> {
    table.views.iter().map(|view| ViewReport::new(bytes, view)).collect()
}

/// An error, the mean over the angle of views from the normal on: in one layout more of them may be at
/// grazing angles, where errors are larger, than in another.
fn mean_over_angle(reports: &[ViewReport], error: impl Fn(&ViewReport) -> f64) -> f64 {
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
        sum += width * error(report);
        total += width;
    }
    sum / total
}
