//! The best candidate of a shape: its goals, its rank, and the table that is sampled again for it.

use crate::family::factors::{Asked, Factors, Size};
use crate::family::objective::Emphasis;
use crate::family::tuning::factors::{AVERAGED, SIZES, SMOOTH};
use crate::isotropic::balance;
use crate::isotropic::encode;
use crate::isotropic::line::{Layout, Objective};
use crate::isotropic::search::candidates::{Candidate, Task, Work, advance};
use crate::isotropic::search::schedule::{Resampling, Stage, WIDE, side_by_side};
use crate::isotropic::search::{DrawnBy, Source};
use crate::isotropic::tuning::finalist::{
    BENDS, BENT, DOUBLING, MISSED, NEAR_LARGEST, RAMP, STEEPEST, TOLERATED, WIDENED, WORTH_ERROR, WORTH_RANK,
    WORTH_SEEN,
};
use crate::judge::report::ViewReport;
use crate::judge::verdict::{MOST_ENERGY_ERROR, MOST_VARIANCE, MOST_WEIGHT};
use crate::table::Table;
use crate::{FitError, Settings};
use rayon::prelude::*;
use std::borrow::Cow;

/// The best of a shape, on a table of its own.
#[derive(Clone)]
pub(crate) struct Finalist<'a> {
    pub layout: Layout,
    pub table: Cow<'a, Table>,
    /// The table as it was last sampled again.
    resampled: Option<Table>,
    pub candidate: Candidate,
    /// The table that multiplies its lobes.
    pub factors: Option<Factors>,
    /// Bytes of the material with each size that was tried, and the share of the error away from the peak that it leaves.
    pub curve: Vec<(usize, f64)>,
    /// Mean error of values and of the albedo on that table. Beside it: the largest variance of a view; the largest weight, in the end
    /// on the table before too; and the largest error of the albedo at any view.
    error: f64,
    /// Mean error of luminance and colour away from the peak, at views that are asked for.
    seen: f64,
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
            resampled: None,
            candidate,
            factors: None,
            curve: Vec::new(),
            error: f64::INFINITY,
            seen: f64::INFINITY,
            variance: f64::INFINITY,
            largest_weight: f64::INFINITY,
            energy_error: f64::INFINITY,
        };
        // Few lobes, or lobes in pairs, are fewer bytes, which are spent on more views.
        let views = encode::views_of_equal_size(&new.layout, settings.lobes_of_size(), settings.bytes);
        if settings.view_angles.is_none() && views > new.layout.views.angles.len() {
            let denser = new.layout.at(source.view_angles(views));
            new.candidate.x = new.layout.resampled(&new.candidate.x, &denser);
            new.table = Cow::Owned(source.table(&denser.views.angles, None)?);
            new.layout = denser;
        }
        Ok(new)
    }

    /// Factor on the error for missed goals of weight, variance and energy; 1 if all are met.
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

    /// Whether weights at other views may be too large.
    pub fn is_near_largest_weight(&self) -> bool {
        self.largest_weight > NEAR_LARGEST * MOST_WEIGHT
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

    /// Error times penalty. The best finalist has the least.
    pub fn rank(&self) -> f64 {
        self.error * self.penalty()
    }

    /// Bytes of the material with a table of factors of that size.
    fn len(&self, size: Size) -> usize {
        encode::len(&self.layout, Some(size))
    }

    /// Whether the smallest table of factors has room in that number of bytes.
    pub fn has_room_for_factors(&self, bytes: usize) -> bool {
        self.len(SIZES[0]) <= bytes
    }

    /// Whether it is worth the bytes of factors that the other one lacks.
    pub fn is_worth_factors(&self, plain: &Self) -> bool {
        let is_nearer = self.error < WORTH_ERROR * plain.error || self.seen < WORTH_ERROR * plain.seen;
        // A large weight is noise in some pictures; patches and wrong colours are in all of them.
        let is_seen = self.seen < WORTH_SEEN * plain.seen && self.error < plain.error;
        self.rank() < WORTH_RANK * plain.rank()
            || is_nearer && self.rank() < TOLERATED * plain.rank()
            || is_seen
    }

    /// The rank before the end. Only the weight counts there, because it gets worse if nothing is done.
    pub fn early_rank(&self) -> f64 {
        if self.has_small_weights() { self.error } else { WIDENED * self.error }
    }

    /// Adds stored views where the stored albedo is farthest from the albedo, as long as they have room in that number of bytes.
    pub fn add_views_at_bends(&mut self, bytes: usize) {
        for _ in 0..BENDS {
            let Some(factors) = &self.factors else { return };
            let Some((error, theta)) = encode::bend(&self.layout, &self.candidate.x, factors) else { return };
            let mut denser = self.layout.clone();
            let after = denser.views.angles.partition_point(|angle| *angle < theta);
            denser.views.angles.insert(after, theta);
            if error < BENT || encode::len(&denser, Some(factors.size())) > bytes {
                return;
            }
            self.candidate.x = self.layout.resampled(&self.candidate.x, &denser);
            self.layout = denser;
        }
    }

    /// Adds a stored view next to the normal, of interpolated lobes, unless there is one.
    pub fn add_view(&mut self, theta: f64) {
        if self.layout.views.angles.len() < 3 || self.layout.views.angles[1] < 2.0 * theta {
            return;
        }
        let mut denser = self.layout.clone();
        denser.views.angles.insert(1, theta);
        self.candidate.x = self.layout.resampled(&self.candidate.x, &denser);
        self.layout = denser;
    }

    /// Gives up the least useful lobe for one that is kept wide; false if it has such a lobe, or none to give.
    pub fn widen(&mut self) -> bool {
        let table = self.resampled.as_ref().unwrap_or(&self.table);
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

    /// The candidate with its objective.
    fn task(&mut self, emphasis: Emphasis) -> Result<Task<'_>, FitError> {
        let table = self.resampled.as_ref().unwrap_or(&self.table);
        let objective = Objective::new(table, self.layout.clone(), emphasis, self.factors.as_ref())?;
        Ok(Task { table, objective: Cow::Owned(objective), candidate: &mut self.candidate })
    }

    /// Fits factors to the residual of the lobes: with a table as before, at first of the size that is asked for.
    pub fn fit_factors(&mut self, size: Asked, emphasis: Emphasis) -> Result<(), FitError> {
        let table = self.resampled.as_ref().unwrap_or(&self.table);
        let objective = Objective::new(table, self.layout.clone(), emphasis, self.factors.as_ref())?;
        let demands = objective.reweighed(&self.candidate.x).into_demands(&self.candidate.x);
        self.factors = match (&self.factors, size) {
            (Some(before), _) => Some(before.refitted(&demands)),
            (None, Asked::Given(size)) => Some(Factors::fit(size, SMOOTH, &demands)),
            (None, Asked::Within(bytes)) => {
                let found = Factors::worthwhile(&SIZES, |size| self.len(size) <= bytes, &demands);
                found.map(|(factors, curve)| {
                    self.curve = curve.into_iter().map(|(size, left)| (self.len(size), left)).collect();
                    factors
                })
            }
        };
        Ok(())
    }

    /// Resamples as before the last stage.
    pub fn resample_for_last_stage(&mut self, source: &dyn Source) -> Result<(), FitError> {
        self.largest_weight = 0.0;
        self.resample(source, Resampling::Last)
    }

    /// Samples the table again, in directions that the lobes draw, and judges the lobes on it.
    pub fn resample(&mut self, source: &dyn Source, resampling: Resampling) -> Result<(), FitError> {
        let mut x = self.candidate.x.clone();
        self.energy_error =
            balance::balance(&self.layout, &mut x, self.factors.as_ref(), source.albedo(), AVERAGED);
        let bytes = encode::encode(&self.layout, &x, self.factors.as_ref(), "")?;
        let mut resampled =
            source.table(&self.layout.views.angles, Some(DrawnBy { bytes: &bytes, resampling }))?;
        let reports = reports(&bytes, &resampled)?;
        self.error = mean_over_angle(&reports, |report| report.measure + report.energy_error());
        let asked_for = || reports.iter().filter(|view| view.theta < STEEPEST);
        self.variance = asked_for().map(|view| view.variance).fold(0.0, f64::max);
        let seen = |view: &ViewReport| view.regions.luminance + view.regions.chroma;
        let (sum, count) =
            asked_for().map(seen).filter(|v| v.is_finite()).fold((0.0, 0.0), |s, v| (s.0 + v, s.1 + 1.0));
        self.seen = sum / f64::max(count, 1.0);
        // A view where the density is too small may be in one table only. Weights before the last resampling are those of lobes that
        // have been moved far since.
        let largest = reports.iter().map(ViewReport::largest_weight_as_summed).fold(0.0, f64::max);
        self.largest_weight = match resampling {
            Resampling::First | Resampling::Second => largest,
            Resampling::Last | Resampling::Judging => self.largest_weight.max(largest),
        };
        // The last stage keeps the views of the table before: an error that no view shows comes back.
        let before = self.resampled.take().filter(|_| resampling == Resampling::Last);
        resampled.views.extend(before.into_iter().flat_map(|table| table.views));
        self.resampled = Some(resampled);
        Ok(())
    }
}

/// Takes all finalists through a stage, as many side by side as there is room for.
pub(crate) fn refine(
    source: &dyn Source,
    finalists: &mut [Finalist<'_>],
    emphasis: Emphasis,
    stage: &Stage,
    work: &mut Work<'_>,
) -> Result<(), FitError> {
    let lobes = finalists.first().map_or(0, |f| f.layout.lobes);
    let done = work.done;
    // Their objectives are made when it is their turn: with 64 lobes each has 40 MB.
    for some in finalists.chunks_mut(side_by_side(lobes).min(finalists.len()).max(1)) {
        let tasks = some.iter_mut().map(|f| f.task(emphasis)).collect::<Result<Vec<_>, FitError>>()?;
        let steps = tasks.len() * stage.steps_of_one();
        advance(stage, tasks, work);
        work.done += steps;
    }
    work.done = done;
    if let Some(resampling) = stage.resampling {
        finalists.par_iter_mut().try_for_each(|f| f.resample(source, resampling))?;
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
