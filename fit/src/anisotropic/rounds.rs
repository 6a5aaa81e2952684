//! The last rounds of a fit: on tables in directions that its lobes draw, at other views each time, and with factors.

use crate::FitError;
use crate::Settings;
use crate::anisotropic::balance;
use crate::anisotropic::encode;
use crate::anisotropic::grid::{CellPlace, Layout, Objective};
use crate::anisotropic::table::{self, TurnedView};
use crate::anisotropic::tuning::rounds::{FACTORED, PLAIN, WORTH};
use crate::anisotropic::tuning::views::{AT_STORED_VIEWS, BETWEEN, FINE};
use crate::anisotropic::{between, report};
use crate::family::factors::{Asked, Factors, Size};
use crate::family::objective::{Emphasis, Weighted, Weights};
use crate::family::tuning::factors::{SIZES, SMOOTH};
use crate::numeric::levenberg::{Ending, Limits, minimize};
use crate::settings::FactorNodes;
use crate::table::Brdf;

/// The task, the same in all rounds.
pub(super) struct Rounds<'a> {
    pub brdf: &'a dyn Brdf,
    pub layout: &'a Layout,
    pub emphasis: Emphasis,
    pub weights: Weights,
    pub settings: &'a Settings,
}

/// The unknowns on their way, with the table that they were moved on last.
#[derive(Clone)]
pub(super) struct Solution {
    pub x: Vec<f64>,
    pub factors: Option<Factors>,
    pub ending: Ending,
}

impl Rounds<'_> {
    /// How many there may be.
    pub fn count(settings: &Settings) -> usize {
        PLAIN + if settings.factors == FactorNodes::None { 0 } else { FACTORED }
    }

    /// Moves unknowns through all rounds, `tick` at each step.
    pub fn run(&self, mut solution: Solution, mut tick: impl FnMut()) -> Result<Solution, FitError> {
        for round in 1..=PLAIN {
            let views = self.views(&self.bytes(&solution)?, round)?;
            self.move_on(&mut solution, &views, &mut tick)?;
        }
        let asked = match self.settings.factors {
            FactorNodes::Given(nodes) => Asked::Given(Size::reciprocal(nodes)),
            FactorNodes::Signed(nodes) => Asked::Given(Size::signed(nodes)),
            FactorNodes::Chosen => Asked::Within(self.settings.bytes),
            FactorNodes::None => return Ok(solution),
        };
        let mut with = solution.clone();
        for round in 1..=FACTORED {
            let views = self.views(&self.bytes(&with)?, PLAIN + round)?;
            if !self.fit_factors(&mut with, &views, asked)? {
                return Ok(solution);
            }
            self.move_on(&mut with, &views, &mut tick)?;
        }
        if matches!(asked, Asked::Given(_)) {
            return Ok(with);
        }
        let error = |solution: &Solution| self.error(solution, PLAIN + FACTORED + 1);
        Ok(if error(&with)? < WORTH * error(&solution)? { with } else { solution })
    }

    fn bytes(&self, solution: &Solution) -> Result<Vec<u8>, FitError> {
        encode::encode(self.layout, &solution.x, solution.factors.as_ref(), 0.0, "")
    }

    /// Views with directions that the lobes of a material draw, at the stored ones and between them; others in every round.
    fn views(&self, bytes: &[u8], round: usize) -> Result<Vec<TurnedView>, FitError> {
        let grid = &self.layout.views;
        let stored: Vec<(f64, f64)> = (0..self.layout.stored_views()).map(|k| grid.angles(k)).collect();
        let mut views = table::resample(self.brdf, &stored, AT_STORED_VIEWS, (bytes, round))?;
        views.extend(table::resample(self.brdf, &between(grid, round), BETWEEN, (bytes, round))?);
        Ok(views)
    }

    fn place(&self, turned: &TurnedView) -> CellPlace {
        self.layout.views.place(turned.view.theta, turned.phi)
    }

    fn objective(&self, solution: &Solution, views: &[TurnedView]) -> Result<Objective, FitError> {
        let placed: Vec<_> = views.iter().map(|turned| (self.place(turned), &turned.view)).collect();
        let factors = solution.factors.as_ref();
        Ok(Objective::over(&placed, self.layout.clone(), self.emphasis, factors)?.reweighed(&solution.x))
    }

    fn move_on(
        &self,
        solution: &mut Solution,
        views: &[TurnedView],
        tick: &mut impl FnMut(),
    ) -> Result<(), FitError> {
        let objective = self.objective(solution, views)?;
        let limits = Limits { steps: self.settings.steps / 2, improvement: FINE };
        let task = Weighted { objective: &objective, weights: self.weights };
        solution.ending = minimize(&task, &mut solution.x, limits, tick).1;
        self.balance(solution, views);
        Ok(())
    }

    /// Fits factors to the residual of the lobes, as large as before; whether there is room for any.
    fn fit_factors(
        &self,
        solution: &mut Solution,
        views: &[TurnedView],
        asked: Asked,
    ) -> Result<bool, FitError> {
        let demands = self.objective(solution, views)?.into_demands(&solution.x);
        solution.factors = match (&solution.factors, asked) {
            (Some(before), _) => Some(before.refitted(&demands)),
            (None, Asked::Given(size)) => Some(Factors::fit(size, SMOOTH, &demands)),
            (None, Asked::Within(bytes)) => {
                let has_room = |size| encode::len(self.layout, size) <= bytes;
                Factors::worthwhile(&SIZES, has_room, &demands).map(|found| found.0)
            }
        };
        Ok(solution.factors.is_some())
    }

    fn balance(&self, solution: &mut Solution, views: &[TurnedView]) {
        let albedo: Vec<_> = views.iter().map(|turned| (self.place(turned), turned.view.albedo)).collect();
        balance::balance(self.layout, &mut solution.x, solution.factors.as_ref(), &albedo);
    }

    /// Mean measure and error of the albedo at views that were not seen before.
    fn error(&self, solution: &Solution, round: usize) -> Result<f64, FitError> {
        let bytes = self.bytes(solution)?;
        let reports = report::judge(&bytes, &self.views(&bytes, round)?, 0.0)?;
        let errors = reports.iter().map(|view| view.measure + view.energy_error());
        Ok(errors.sum::<f64>() / reports.len() as f64)
    }
}
