//! The stages of a fit: fewer candidates from one to the next, more steps, and less stiffness.
//!
//! The recipe, [`RECIPE`], is a table that can be read from top to bottom. [`stages`] puts in the numbers of the settings.

use crate::Settings;
use crate::isotropic::objective::{Emphasis, Weights};
use crate::numeric::levenberg::Limits;

/// Lobes with which as many candidates as a recipe names take part, and most times as many of fewer lobes: they have more minima of
/// their own, and take less time.
const USUAL_LOBES: usize = 12;
const MOST_TIMES: usize = 4;

/// Lobes from which on there are fewer starts, exchanges and candidates, in inverse proportion to them: a step takes the square of the
/// lobes, and many lobes have fewer minima that are bad.
const MANY_LOBES: usize = 20;

/// Candidates of many lobes that are moved side by side: each holds matrices of 25 MB with 64 lobes.
const SIDE_BY_SIDE: usize = 2;

/// Times that the table is made again, with directions that the lobes draw and at other views: a lobe that is sharp between the
/// directions and views of a table costs nothing there (steel at 42.5 degrees: 32 % in place of 4 %).
pub(crate) const LOOKS: usize = 3;

/// What the stiffness of the last stages is multiplied by when they follow exchanges: what is that far keeps its order.
const LOOSENED: f64 = 0.3;

/// For the least error first, and where that misses a goal, with at least that tail. On 22
/// materials the error halfway between the views is 3.10 % in the median with little tail and 3.55 % with ten times as much.
pub(crate) const LIGHT: Emphasis = Emphasis { tail: 0.003, seen: 0.0, energy: 10.0 };
pub(crate) const HEAVY_TAIL: f64 = 0.03;
pub(crate) const WIDE: Emphasis = Emphasis { tail: HEAVY_TAIL, ..LIGHT };
/// In the end, what is seen. Earlier it costs L2 for nothing: malachite ends at 13.7 % in place of 10.8, with no less error away from
/// the peak.
pub(crate) const LAST: Emphasis = Emphasis { seen: 1.0, ..LIGHT };

/// Damping of colours, over the cost: malachite ends at 11.1 % with it, and at 16.4 without.
pub(crate) const FAINT_COLOR: f64 = 1e-3;

/// How many candidates take part in a stage, the best of the one before.
#[derive(Clone, Copy, Debug)]
enum Keep {
    /// A share of the starts of the settings, as a fraction.
    Starts(usize, usize),
    /// As many as this for the usual number of lobes; more of fewer lobes, fewer of many.
    Best(usize),
    /// One, of any number of lobes.
    One,
}

/// Steps of the solver.
#[derive(Clone, Copy, Debug)]
enum Steps {
    /// So many.
    Fixed(usize),
    /// Those of the settings over a number.
    Over(usize),
}

/// A stage as a recipe has it.
#[derive(Clone, Copy, Debug)]
struct Line {
    keep: Keep,
    steps: Steps,
    /// Exchanges of lobes, as a share of those of the settings.
    exchanges: (usize, usize),
    /// What the smoothness is multiplied by.
    stiffness: f64,
    /// Relative decrease of the cost at which the solver ends.
    improvement: f64,
    /// What it sees of the table.
    sees: Sees,
    /// The number with which the table is made again after it.
    look: Option<usize>,
}

/// What a stage sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sees {
    /// A thinned table.
    Some,
    /// The whole table, with weights that follow the candidate as it is.
    All,
    /// That, and the albedo is held closely.
    AllAndAlbedo,
}

impl Sees {
    /// Whether the whole table is seen, with weights that follow the candidate as it is.
    pub fn whole_table(self) -> bool {
        self != Self::Some
    }

    /// Whether the albedo is held closely.
    pub fn albedo(self) -> bool {
        self == Self::AllAndAlbedo
    }
}

/// A line of a recipe from its numbers in order.
const fn line(
    keep: Keep,
    steps: Steps,
    exchanges: (usize, usize),
    stiffness: f64,
    improvement: f64,
    sees: Sees,
    look: Option<usize>,
) -> Line {
    Line { keep, steps, exchanges, stiffness, improvement, sees, look }
}

/// Shapes show late what they are good for: so three are kept until each has been moved to where
/// its lobes cannot hide. One with more knots may end a stage with a needle between directions that nothing had seen yet.
const RECIPE: [Line; 8] = {
    use Keep::{Best, Starts};
    use Steps::{Fixed, Over};
    //   candidates     steps      exchanges  stiffness  improvement  sees                look
    [
        line(Starts(1, 1), Fixed(25), (0, 1), 100.0, 1e-3, Sees::Some, None),
        line(Best(6), Over(4), (0, 1), 10.0, 1e-3, Sees::Some, None),
        line(Best(4), Over(6), (2, 3), 3.0, 1e-3, Sees::Some, None),
        line(Best(3), Over(6), (1, 1), 3.0, 1e-3, Sees::Some, None),
        line(Best(3), Over(1), (0, 1), 1.0, 5e-4, Sees::All, Some(0)),
        line(Best(3), Over(4), (0, 1), 1.0, 1e-3, Sees::AllAndAlbedo, Some(1)),
        line(Best(1), Over(4), (0, 1), 1.0, 1e-3, Sees::AllAndAlbedo, Some(2)),
        line(Keep::One, Over(4), (0, 1), 1.0, 1e-3, Sees::AllAndAlbedo, None),
    ]
};

/// One stage of a fit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stage {
    /// Candidates that take part, the best of the stage before.
    pub keep: usize,
    /// What it sees of the table.
    pub sees: Sees,
    /// Times that a candidate is moved downhill: after the first, a lobe is exchanged before each.
    pub runs: usize,
    pub limits: Limits,
    pub weights: Weights,
    /// The number with which the table is made again after it, if it can be.
    pub look: Option<usize>,
}

impl Stage {
    /// Steps of the solver that it may take.
    pub fn work(&self) -> usize {
        self.keep * self.runs * self.limits.steps
    }

    /// The same for so many that have been through it, near their minimum. Lobes are exchanged so often before the last stages, which
    /// are less stiff then.
    pub fn again(&self, keep: usize, exchanges: usize) -> Self {
        let mut new = Self { keep, ..*self };
        if !new.sees.albedo() {
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

/// The same share of a count as there are starts and exchanges with so many lobes; not none.
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
            Keep::Starts(part, whole) => times * (part * starts).div_ceil(whole),
            Keep::One => 1,
            Keep::Best(count) => times * fewer(count, settings.lobes),
        },
        sees: line.sees,
        runs: 1 + line.exchanges.0 * exchanges / line.exchanges.1,
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
            energy: if line.sees.albedo() { energy } else { 1.0 },
        },
        look: line.look,
    };
    RECIPE.iter().map(stage).collect()
}
