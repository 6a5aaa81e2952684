//! The stages of a fit: fewer candidates from one to the next, more steps, and less stiffness.
//!
//! The recipe, [`RECIPE`], is a table that can be read from top to bottom. [`stages`] puts in the numbers of the settings.

use crate::Settings;
use crate::family::objective::{Emphasis, Weights};
use crate::family::tuning::solver::FAINT_COLOR;
use crate::isotropic::tuning::schedule::{
    FACTORED_TAIL, FIRST_ENERGY, HEAVY_TAIL, LAST_MEASURE, LIGHT_TAIL, LOOSENED, MANY_LOBES, MOST_TIMES,
    SIDE_BY_SIDE, USUAL_LOBES,
};
use crate::numeric::levenberg::Limits;

/// The emphasis of the first round: the least error.
pub(crate) const LIGHT: Emphasis =
    Emphasis { tail: LIGHT_TAIL, measure: 0.0, energy: FIRST_ENERGY, is_dense: false };
/// The emphasis that widens a lobe.
pub(crate) const WIDE: Emphasis = Emphasis { tail: HEAVY_TAIL, ..LIGHT };
/// The emphasis of the end: visible errors away from the peak.
pub(crate) const LAST: Emphasis = Emphasis { measure: LAST_MEASURE, ..LIGHT };
/// The same where weights are large: factors multiply the value and not the density.
pub(crate) const FACTORED: Emphasis = Emphasis { tail: FACTORED_TAIL, ..LAST };

/// How many candidates take part in a stage, the best of the one before.
#[derive(Clone, Copy, Debug)]
enum Keep {
    /// All starts of the settings.
    Starts,
    /// As many as this for the usual number of lobes; more of fewer lobes, fewer of many.
    Best(usize),
    /// One, of any number of lobes.
    One,
}

/// Steps of the solver.
#[derive(Clone, Copy, Debug)]
enum Steps {
    /// A number that no setting changes.
    Fixed(usize),
    /// The steps of the settings over a number.
    Over(usize),
}

/// Exchanges of lobes, as a share of those of the settings.
#[derive(Clone, Copy, Debug)]
enum Exchanges {
    None,
    TwoThirds,
    All,
}

/// A stage as a recipe has it.
#[derive(Clone, Copy, Debug)]
struct Line {
    keep: Keep,
    steps: Steps,
    exchanges: Exchanges,
    /// Factor on the smoothness.
    stiffness: f64,
    /// Relative decrease of the cost at which the solver ends.
    improvement: f64,
    scope: Scope,
    /// The resampling of the table after the stage, if any.
    resampling: Option<Resampling>,
}

/// The data that a stage fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scope {
    /// A thinned table.
    Thinned,
    /// The whole table. Its weights follow the candidate.
    Whole,
    /// The whole table, and the albedo, which is held closely.
    WholeAndAlbedo,
}

impl Scope {
    /// Whether a stage fits the whole table, with weights that follow the candidate.
    pub fn is_whole(self) -> bool {
        self != Self::Thinned
    }

    /// Whether the albedo is held closely.
    pub fn holds_albedo(self) -> bool {
        self == Self::WholeAndAlbedo
    }
}

/// A time at which the table is sampled again, in directions that the lobes draw and at other views.
///
/// A lobe that is sharp between the directions and views of a table costs nothing there: steel at 42.5 degrees ends at 32 % without
/// resampling, and at 4 % with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Resampling {
    /// After the first stage on the whole table.
    First,
    Second,
    /// Before the last stage. Stored views are among the views, because a lobe of a single stored view is highest there.
    Last,
    /// After the last stage, for the judgement alone.
    Judging,
}

impl Resampling {
    /// Its number, from 0.
    pub fn number(self) -> usize {
        self as usize
    }
}

/// The quality of a shape shows late, so three are kept until the table has been sampled again for each. A shape with more stored
/// views may end a stage with a needle between the directions of its table.
const RECIPE: [Line; 8] = {
    use Keep::Best;
    use Resampling::{First, Last, Second};
    use Steps::Over;
    let scouting = Line {
        keep: Keep::Starts,
        steps: Steps::Fixed(25),
        exchanges: Exchanges::None,
        stiffness: 100.0,
        improvement: 1e-3,
        scope: Scope::Thinned,
        resampling: None,
    };
    let exchanging = Line { steps: Over(6), stiffness: 3.0, ..scouting };
    let refining = Line { steps: Over(4), stiffness: 1.0, scope: Scope::WholeAndAlbedo, ..scouting };
    [
        scouting,
        Line { keep: Best(6), steps: Over(4), stiffness: 10.0, ..scouting },
        Line { keep: Best(4), exchanges: Exchanges::TwoThirds, ..exchanging },
        Line { keep: Best(3), exchanges: Exchanges::All, ..exchanging },
        Line {
            keep: Best(3),
            steps: Over(1),
            improvement: 5e-4,
            scope: Scope::Whole,
            resampling: Some(First),
            ..refining
        },
        Line { keep: Best(3), resampling: Some(Second), ..refining },
        Line { keep: Best(1), resampling: Some(Last), ..refining },
        Line { keep: Keep::One, ..refining },
    ]
};

/// One stage of a fit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stage {
    /// Candidates that take part, the best of the stage before.
    pub keep: usize,
    pub scope: Scope,
    /// Times that a candidate is moved downhill: after the first, a lobe is exchanged before each.
    pub runs: usize,
    pub limits: Limits,
    pub weights: Weights,
    /// The resampling of the table after the stage, if any.
    pub resampling: Option<Resampling>,
}

impl Stage {
    /// Steps of the solver that it may take.
    pub fn work(&self) -> usize {
        self.keep * self.steps_of_one()
    }

    /// The same for one candidate.
    pub fn steps_of_one(&self) -> usize {
        self.runs * self.limits.steps
    }

    /// One of several equal parts of the stage.
    pub fn part(&self, parts: usize) -> Self {
        let limits = Limits { steps: self.limits.steps.div_ceil(parts), ..self.limits };
        Self { limits, ..*self }
    }

    /// The stage for `keep` finalists that have been through it and are near their minimum. Lobes are exchanged `exchanges` times before
    /// the last stages, which are less stiff then.
    pub fn again(&self, keep: usize, exchanges: usize) -> Self {
        let mut new = Self { keep, ..*self };
        if !new.scope.holds_albedo() {
            new.limits.steps = new.limits.steps.div_ceil(3);
            new.runs = 1 + exchanges;
        } else if exchanges > 0 {
            new.weights.smoothness *= LOOSENED;
        }
        new
    }
}

/// Steps of the solver that stages may take.
pub(crate) fn work(stages: &[Stage]) -> usize {
    stages.iter().map(Stage::work).sum()
}

/// A count, reduced for many lobes as starts and exchanges are; at least 1.
fn fewer(count: usize, lobes: usize) -> usize {
    (count * MANY_LOBES).div_ceil(lobes.max(MANY_LOBES))
}

/// Exchanges of lobes before the last stages are gone through again: on the whole table they gain most, and are not made as few. With
/// 64 lobes golden yellow ends at 1.87 % in place of 1.64 with as few.
pub(crate) fn exchanges_again(settings: &Settings) -> usize {
    settings.exchanges.min(2 * fewer(settings.exchanges, settings.lobes))
}

/// Candidates that may be moved side by side.
pub(crate) fn side_by_side(lobes: usize) -> usize {
    if lobes > MANY_LOBES { SIDE_BY_SIDE } else { usize::MAX }
}

/// The stages. `energy`: weight of the albedo in the last ones.
pub(crate) fn stages(settings: &Settings, energy: f64) -> Vec<Stage> {
    let times = ((USUAL_LOBES + settings.lobes / 2) / settings.lobes).clamp(1, MOST_TIMES);
    let (starts, exchanges) =
        (fewer(settings.starts, settings.lobes), fewer(settings.exchanges, settings.lobes));
    let stage = |line: &Line| Stage {
        keep: match line.keep {
            Keep::Starts => times * starts,
            Keep::One => 1,
            Keep::Best(count) => times * fewer(count, settings.lobes),
        },
        scope: line.scope,
        runs: match line.exchanges {
            Exchanges::None => 1,
            Exchanges::TwoThirds => 1 + 2 * exchanges / 3,
            Exchanges::All => 1 + exchanges,
        },
        limits: Limits {
            steps: match line.steps {
                Steps::Fixed(steps) => steps,
                Steps::Over(part) => settings.steps.div_ceil(part),
            },
            improvement: line.improvement,
        },
        weights: Weights {
            smoothness: line.stiffness * settings.smoothness,
            faint_color: FAINT_COLOR,
            energy: if line.scope.holds_albedo() { energy } else { 1.0 },
        },
        resampling: line.resampling,
    };
    RECIPE.iter().map(stage).collect()
}
