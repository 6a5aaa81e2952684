//! The stages of a fit: fewer candidates from one to the next, more steps, and less stiffness.

use crate::Settings;
use crate::isotropic::levenberg::Limits;
use crate::isotropic::objective::{Emphasis, Weights};

/// Lobes with which as many candidates as are named below take part, and most times as many of fewer lobes: they have more minima of
/// their own, and take less time.
const USUAL_LOBES: usize = 12;
const MOST_TIMES: usize = 4;

/// Times that the table is made again, with directions that the lobes draw and at other views: a lobe that is sharp between the
/// directions and views of a table costs nothing there (steel at 42.5 degrees: 32 % in place of 4 %).
pub(crate) const LOOKS: usize = 3;

/// What the stiffness of the last stages is multiplied by when they follow exchanges: what is that far keeps its order.
const LOOSENED: f64 = 0.3;

/// Of what can be evaluated anywhere: for the least error first, and where that misses a goal, with at least that tail. On 22
/// materials the error halfway between the views is 3.10 % in the median with little tail and 3.55 % with ten times as much.
pub(crate) const LIGHT: Emphasis = Emphasis { tail: 0.003, seen: 0.0, energy: 10.0 };
pub(crate) const HEAVY_TAIL: f64 = 0.03;
pub(crate) const WIDE: Emphasis = Emphasis { tail: HEAVY_TAIL, ..LIGHT };
/// In the end, what is seen. Earlier it costs L2 for nothing: malachite ends at 13.7 % in place of 10.8, with no less error away from
/// the peak.
pub(crate) const LAST: Emphasis = Emphasis { seen: 1.0, ..LIGHT };

/// Of scattered samples, whose albedo depends by 1 % on how one interpolates between them; and whose tail is all that
/// holds lobes between them (garnet red has 22 % over samples left out with a tenth of it, in place of 12).
pub(crate) const SAMPLES: Emphasis = Emphasis { tail: HEAVY_TAIL, seen: 0.0, energy: 1.0 };

/// One stage of a fit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stage {
    /// Candidates that take part, the best of the stage before.
    pub keep: usize,
    /// Whether it sees the whole table, with weights that follow the candidate as it is.
    pub full: bool,
    /// Times that a candidate is moved downhill: after the first, a lobe is exchanged before each.
    pub runs: usize,
    pub limits: Limits,
    /// Whether the albedo is held closely.
    pub last: bool,
    /// Whether albedos count the more, the worse they are: those of a quadrature are known well enough.
    pub evenly: bool,
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
        if !new.last {
            new.limits.steps = new.limits.steps.div_ceil(3);
            new.runs = 1 + exchanges;
        } else if exchanges > 0 {
            new.limits.weights.smoothness *= LOOSENED;
        }
        new
    }
}

/// Steps of the solver that stages may take.
pub(crate) fn work(stages: &[Stage]) -> usize {
    stages.iter().map(Stage::work).sum()
}

/// The stages. `energy`: weight of the albedo in the last ones. `looks`: times that the table is made again, 0 if it cannot be.
pub(crate) fn stages(settings: &Settings, energy: f64, looks: usize) -> Vec<Stage> {
    let stage = |keep, full, steps, runs, stiffness: f64, energy, improvement, last| {
        let weights = Weights { smoothness: stiffness * settings.smoothness, energy };
        Stage {
            keep,
            full,
            runs,
            limits: Limits { steps, improvement, weights },
            last,
            evenly: looks > 0,
            look: None,
        }
    };
    let exchange =
        |keep, count| stage(keep, false, settings.steps.div_ceil(6), 1 + count, 3.0, 1.0, 1e-3, false);
    let scout = |keep| stage(keep, false, settings.steps / 4, 1, 10.0, 1.0, 1e-3, false);
    let full = |keep, improvement| stage(keep, true, settings.steps, 1, 1.0, 1.0, improvement, false);
    let ratio = (USUAL_LOBES + settings.lobes / 2) / settings.lobes;
    let many = if looks == 0 { 1 } else { ratio.clamp(1, MOST_TIMES) };
    let starts = if looks == 0 { (2 * settings.starts).div_ceil(3) } else { settings.starts };
    let mut stages = vec![stage(many * starts, false, 25, 1, 100.0, 1.0, 1e-3, false)];
    if looks == 0 {
        stages.extend([scout(4), exchange(3, settings.exchanges), full(1, 1e-4)]);
    } else {
        // Shapes show late what they are good for, and what may hide between directions is judged when it has been seen once.
        let exchanges =
            [exchange(4 * many, 2 * settings.exchanges / 3), exchange(3 * many, settings.exchanges)];
        stages.extend([
            scout(6 * many),
            exchanges[0],
            exchanges[1],
            Stage { look: Some(0), ..full(3 * many, 5e-4) },
        ]);
    }
    stages.extend((0..looks.max(1)).map(|round| {
        // A shape with more knots may end the stage before with a needle between directions that nothing had seen yet.
        let keep = match round {
            0 if looks > 0 => 3 * many,
            1 => many,
            _ => 1,
        };
        let last = stage(keep, true, settings.steps.div_ceil(4), 1, 1.0, energy, 1e-3, true);
        Stage { look: (round + 1 < looks).then_some(round + 1), ..last }
    }));
    stages
}
