//! Samples of a surface that was turned: whether a turn changes it, along which axis, and its symmetries.
//!
//! The axis and the stretch of the highlight are those whose model has the least sum of squares. Symmetries are kept unless a process
//! without them predicts left-out samples better. In the end an isotropic model, with a process over it, is held against it: both
//! predict samples, and turns, that they did not see. So noise and a tilted sample make no surface anisotropic.

use super::changes::Changes;
use super::family::{models, unseen};
use super::gaps::{gaps_of_sides, gaps_of_turned};
use super::held_out::HeldOut;
use super::measurement::{Measurement, Placed};
use super::microfacet::{Family, Microfacet};
use super::points::points;
use super::process::{Of, Process};
use super::scale::Scale;
use super::turn::{Kept, Turn};
use super::{Completion, FEWEST, Model, completed, noises, width};
use crate::FitError;
use crate::complete::tuning::choice::OF_MODEL;
use crate::complete::tuning::family::COMPARED_BESIDE;
use crate::complete::tuning::points::MOST as POINTS;
use crate::complete::tuning::turned::{
    AS_GOOD, AXES, BROKEN, COMPARED, MOST, SAMPLES, SECOND, SIDED, STEPS, STRETCHES, TURNS, VIEWS, WORTHWHILE,
};
use crate::row::{NORMAL, Row, polar};
use crate::table::{Brdf, DARKEST, luminance};
use std::f64::consts::{FRAC_PI_2, PI};

/// Samples of which the instrument held the same direction.
#[derive(Clone, Copy)]
pub(crate) struct Way<'a> {
    pub rows: &'a [Row],
    /// Whether that is the incident one.
    pub is_light_fixed: bool,
    /// Whether the light went the other way through a sheet: both directions change places.
    pub is_back: bool,
}

/// Samples, and how many views and parts they have.
struct Turned {
    placed: Vec<Placed>,
    count: [usize; 2],
}

/// The outcome for samples of a turned surface.
pub(crate) enum Found {
    /// A turn changes values.
    Anisotropic(Box<Completion>),
    /// An isotropic completion predicts samples and turns as well.
    Isotropic,
}

/// Completes samples of a turned surface, if a turn changes it. `is_steady`: their values from turn to turn tell that beyond noise.
///
/// # Errors
/// [`FitError::Table`] for fewer than five samples, and for some that are black, or darker than lobes can be.
pub(crate) fn complete_turned(ways: &[Way<'_>], is_sheet: bool, is_steady: bool) -> Result<Found, FitError> {
    let turned = Turned::new(ways);
    if turned.is_little() {
        return Ok(Found::Isotropic);
    }
    let even = turned.measurement(&Changes::default());
    let turn = turned.turn(&even);
    let changes = turn.into();
    let measurement = turned.measurement(&changes);
    if !is_better(&even, &measurement, (if is_steady { AS_GOOD } else { WORTHWHILE }, 0.0)) {
        return Ok(Found::Isotropic);
    }
    let sided = if is_sheet { turned.sided(&changes, &measurement)? } else { None };
    let mut completion = sided.map_or_else(|| completed(measurement, changes), Ok)?;
    completion.report.gaps = gaps_of_turned(&rows_of(ways), turn.kept != Kept::Nothing);
    Ok(Found::Anisotropic(Box::new(completion)))
}

/// Completes samples of light through an isotropic sheet, if its sides differ.
///
/// # Errors
/// As [`complete_turned`].
pub(crate) fn complete_sides(ways: &[Way<'_>]) -> Result<Option<Completion>, FitError> {
    let turned = Turned::new(ways).by_views();
    if turned.is_little() {
        return Ok(None);
    }
    let changes = Changes::default();
    let Some(mut completion) = turned.sided(&changes, &turned.measurement(&changes))? else {
        return Ok(None);
    };
    completion.report.gaps = gaps_of_sides(&rows_of(ways));
    Ok(Some(completion))
}

/// The samples of both ways, as if the viewer were on one side.
fn rows_of(ways: &[Way<'_>]) -> Vec<Row> {
    ways.iter().flat_map(Way::rows).collect()
}

impl Way<'_> {
    /// The samples as if the viewer were in front.
    pub fn rows(&self) -> impl Iterator<Item = Row> + '_ {
        self.rows.iter().map(|row| if self.is_back { row.exchanged() } else { *row })
    }
}

impl Model {
    /// Fits it to samples of a turned surface, with the axis that is found from them.
    ///
    /// # Errors
    /// [`FitError::Table`] for fewer than five samples.
    pub fn fit_turned(rows: &[Row], is_light_fixed: bool) -> Result<Self, FitError> {
        if rows.len() < FEWEST {
            return Err(FitError::Table(format!("{} samples; {FEWEST} are needed", rows.len())));
        }
        let turned = Turned::new(&[Way { rows, is_light_fixed, is_back: false }]);
        let even = turned.measurement(&Changes::default());
        let changes = turned.turn(&even).into();
        let few = turned.measurement(&changes).thinned(OF_MODEL);
        Ok(Self(Microfacet::fits(&few, Scale::of(&even), Family::OneLobe)[0].1, changes))
    }
}

/// Places of values among those that are apart by more than `close`, by number; `None` for more than `most`.
fn places(values: &[f64], close: f64, most: usize) -> Option<(Vec<usize>, usize)> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let (mut found, mut count, mut last) = (vec![0; values.len()], 0, f64::NEG_INFINITY);
    for n in order {
        if values[n] - last > close {
            count += 1;
            last = values[n];
        }
        found[n] = count - 1;
    }
    (count <= most).then_some((found, count))
}

impl Turned {
    fn new(ways: &[Way<'_>]) -> Self {
        let (mut placed, mut azimuths, mut view_count) = (Vec::new(), Vec::new(), 0);
        for way in ways {
            let held_and_moved =
                |row: &Row| if way.is_light_fixed { (row.wi, row.wo) } else { (row.wo, row.wi) };
            let thetas: Vec<f64> = way.rows.iter().map(|row| polar(held_and_moved(row).0)).collect();
            let (views, count) = places(&thetas, 2e-3, VIEWS).unwrap_or_else(|| {
                let place = |theta: &f64| ((theta / FRAC_PI_2 * TURNS as f64) as usize).min(TURNS - 1);
                (thetas.iter().map(place).collect(), TURNS)
            });
            for (row, view) in way.rows.iter().zip(views) {
                let (held, moved) = held_and_moved(row);
                // At the normal a direction has no azimuth: then that of the other says it.
                let d = if polar(held) < NORMAL { moved } else { held };
                azimuths.push(libm::fmod(libm::atan2(d[1], d[0]) + 2.0 * PI + 0.01, 2.0 * PI));
                let Row { wi, wo, rgb, .. } = if way.is_back { row.exchanged() } else { *row };
                let (view, number) = (view_count + view, placed.len());
                placed.push(Placed { wi, wo, rgb, moved: moved[2], view, part: 0, number });
            }
            view_count += count;
        }
        let (parts, part_count) = places(&azimuths, 0.03, TURNS).unwrap_or_else(|| {
            let place = |a: &f64| ((a / (2.0 * PI) * TURNS as f64) as usize).min(TURNS - 1);
            (azimuths.iter().map(place).collect(), TURNS)
        });
        // The first and the last part are never left out: they are empty here.
        placed.iter_mut().zip(parts).for_each(|(sample, part)| sample.part = part + 1);
        Self { placed, count: [view_count, part_count + 2] }
    }

    /// With views as parts.
    fn by_views(self) -> Self {
        let part = |sample: Placed| Placed { part: sample.view, ..sample };
        Self { placed: self.placed.into_iter().map(part).collect(), count: [self.count[0]; 2] }
    }

    /// Whether there are too few samples, or none that is bright enough.
    fn is_little(&self) -> bool {
        self.placed.len() < FEWEST || !self.placed.iter().any(|s| luminance(s.rgb) >= DARKEST)
    }

    fn measurement(&self, changes: &Changes) -> Measurement {
        Measurement::of_placed(&self.placed, self.count, changes)
    }

    /// Completed with the sides told apart, if that predicts samples and parts that were left out better.
    fn sided(&self, changes: &Changes, even: &Measurement) -> Result<Option<Completion>, FitError> {
        let apart = Changes { sides: true, ..*changes };
        let sided = self.measurement(&apart);
        if !is_better(even, &sided, SIDED) {
            return Ok(None);
        }
        let sided = completed(sided, apart)?;
        if self.placed.len() <= POINTS {
            return Ok(Some(sided));
        }
        // Of many samples close ones are taken together, closer where fewer coordinates tell them apart.
        let even = completed(self.measurement(changes), *changes)?;
        Ok((self.error(&sided) < self.error(&even)).then_some(sided))
    }

    /// The relative L2 error of `f cos` at samples, with the cosine of the direction that the instrument moved.
    fn error(&self, completion: &Completion) -> f64 {
        let (mut squares, mut all) = (0.0, 0.0);
        for s in &self.thinned(OF_MODEL).placed {
            let said = completion.evaluate(s.wi, s.wo);
            for (said, value) in said.into_iter().zip(s.rgb) {
                squares += s.moved * s.moved * (said - value) * (said - value);
                all += s.moved * s.moved * value * value;
            }
        }
        libm::sqrt(squares / f64::max(all, f64::MIN_POSITIVE))
    }

    /// About that number of the samples, spread over all of them.
    fn thinned(&self, most: usize) -> Self {
        let golden = 0.618_033_988_749_894_9_f64;
        let share = most as f64 / self.placed.len() as f64;
        let is_kept = |n: usize| (golden * n as f64).fract() < share;
        let placed = self.placed.iter().enumerate().filter(|(n, _)| is_kept(*n)).map(|(_, s)| *s).collect();
        Self { placed, count: self.count }
    }

    /// The axis and the symmetry.
    fn turn(&self, even: &Measurement) -> Turn {
        let scale = Scale::of(even);
        let few = self.thinned(SAMPLES[0]);
        let mut best: Option<(f64, Turn, Microfacet)> = None;
        for along in STRETCHES {
            for n in 0..AXES {
                let turn = Turn::new(PI * n as f64 / AXES as f64, along, 1.0, Kept::default());
                let (cost, model) =
                    Microfacet::fits(&few.measurement(&turn.into()), scale, Family::OneLobe)[0];
                if best.as_ref().is_none_or(|best| cost < best.0) {
                    best = Some((cost, turn, model));
                }
            }
        }
        let more = self.thinned(SAMPLES[1]);
        let Some((_, turn, model)) = best else { return Turn::new(0.0, 1.0, 1.0, Kept::default()) };
        let (one, turn) = more.refined(scale, turn, &model, Second::Even);
        let mut found = (SECOND * one, turn);
        for second in [Second::Even, Second::Same, Second::Across] {
            let start = second.of(turn);
            let (_, model) = Microfacet::fits(&more.measurement(&start.into()), scale, Family::Coat)[0];
            let (cost, turn) = more.refined(scale, start, &model, second);
            if cost < found.0 {
                found = (cost, turn);
            }
        }
        self.kept(scale, found.1.upright())
    }

    /// The axis and stretches near some, and the sum of squares.
    fn refined(&self, scale: Scale, start: Turn, model: &Microfacet, second: Second) -> (f64, Turn) {
        let mut model = *model;
        let mut best = start;
        let (mut least, fitted) = model.moved_to(&self.measurement(&best.into()), scale);
        model = fitted;
        let mut steps = STEPS;
        while steps[0] > 0.01 * STEPS[0] {
            let mut is_better = false;
            for (by_axis, by_stretch) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
                let along = best.along * libm::exp(by_stretch * steps[1]);
                if !(1.0 / MOST..=MOST).contains(&along) {
                    continue;
                }
                let turn = second.of(Turn::new(best.axis + by_axis * steps[0], along, 1.0, best.kept));
                let (cost, fitted) = model.moved_to(&self.measurement(&turn.into()), scale);
                if cost < least * (1.0 - 1e-9) {
                    (least, best, model, is_better) = (cost, turn, fitted, true);
                }
            }
            if !is_better {
                steps = steps.map(|step| 0.4 * step);
            }
        }
        (least, best)
    }

    /// With the symmetry that left-out samples leave.
    fn kept(&self, scale: Scale, turn: Turn) -> Turn {
        let few = self.thinned(COMPARED);
        let (kernel, noise) = COMPARED_BESIDE;
        let rank = |turn: Turn| {
            let measurement = few.measurement(&turn.into());
            let (_, model) = Microfacet::fits(&measurement, scale, Family::OneLobe)[0];
            let points = points(&measurement, &model, scale, width(&model));
            let process = Process::new(&points, kernel, &noises(&points, noise), Of::Values)?;
            Some(HeldOut::alone(&process, &points, scale).rank())
        };
        let with = |kept: Kept| Turn::new(turn.axis, turn.along, turn.second, kept);
        let mut best = (f64::INFINITY, with(Kept::default()));
        for kept in Kept::ALL {
            let Some(rank) = rank(with(kept)) else { continue };
            if rank < BROKEN * best.0 {
                best = (rank, with(kept));
            }
        }
        best.1
    }
}

/// The stretch of a second lobe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Second {
    /// None: a coat.
    Even,
    /// As of the first one.
    Same,
    /// Across it: the other thread of a cloth.
    Across,
}

impl Second {
    fn of(self, turn: Turn) -> Turn {
        let second = match self {
            Self::Even => 1.0,
            Self::Same => turn.along,
            Self::Across => 1.0 / turn.along,
        };
        Turn::new(turn.axis, turn.along, second, turn.kept)
    }
}

/// Whether samples, and parts, that were left out are predicted with a share of the error, less a number, where more is told apart.
fn is_better(even: &Measurement, turned: &Measurement, (share, less): (f64, f64)) -> bool {
    let rank = |measurement: &Measurement| {
        let few = measurement.thinned(COMPARED);
        let scale = Scale::of(&few);
        let model = models(&few, scale).alone;
        let [samples, turns] = unseen(&few, scale, &model, Some(COMPARED_BESIDE))?;
        Some(samples.rank() + turns.rank())
    };
    match (rank(even), rank(turned)) {
        (Some(even), Some(turned)) => turned < share * even - less,
        (None, Some(_)) => true,
        (_, None) => false,
    }
}
