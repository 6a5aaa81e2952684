//! The fit of anisotropic materials: one family of lobes, followed over the hemisphere of outgoing directions.
//!
//! What an isotropic fit (`isotropic`) does along one angle is done here over a grid of angle and azimuth. Azimuths whose views
//! follow by half a turn are left out; a material that has mirrors, too, is fitted over half a turn all the same.
//!
//! May import: `clock`, `family`, `judge`, `numeric`, `settings`.

mod balance;
mod coupled;
mod encode;
mod family;
mod grid;
mod report;
mod rounds;
mod samples;
mod shape;
mod start;
mod table;
mod tuning;

use crate::anisotropic::grid::{Grid, Layout, MIRRORS, Objective};
pub(crate) use crate::anisotropic::report::judge as judge_turned;
use crate::anisotropic::rounds::{Rounds, Solution};
pub(crate) use crate::anisotropic::table::TurnedView;
use crate::anisotropic::tuning::objective::{ENERGY, MEASURE, TAIL};
use crate::anisotropic::tuning::rounds::MORE_ENERGY;
use crate::anisotropic::tuning::views::{
    AT_STORED_VIEWS, AZIMUTHS, BETWEEN, EVERY, FEWEST_RINGS, FINE, IMPROVEMENT, MOST_RINGS, PAIRED, PER_CELL,
    REWEIGHED, RINGS, ROUGHNESS, SCOUTING, STARTS, STIFF,
};
use crate::clock::Clock;
use crate::family::objective::{Emphasis, Weighted, Weights};
use crate::family::tuning::solver::FAINT_COLOR;
use crate::judge::report::{Report, ViewReport};
use crate::numeric::levenberg::{Limits, minimize};
use crate::read::Row;
use crate::table::{Brdf, Density, Symmetry};
use crate::{Fit, FitError, Settings};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Most rings that settings may ask for: 64 x 16 stored views are 80 000 unknowns, minutes a step.
const MAX_RINGS: usize = 64;

/// Directions of views that are judged.
const JUDGED: Density = Density { hemisphere: 1000, cap: 300 };

/// Judges a material beside a BRDF at outgoing directions, angles from the normal and azimuths in radians; anisotropic ones too.
///
/// # Errors
/// [`FitError`] for bytes that are no material, and for an angle outside [0, pi / 2).
pub fn judge_at(
    bytes: &[u8],
    brdf: &dyn Brdf,
    directions: &[(f64, f64)],
) -> Result<Vec<ViewReport>, FitError> {
    if let Some((theta, _)) = directions.iter().find(|(theta, _)| !(0.0..FRAC_PI_2).contains(theta)) {
        return Err(FitError::Table(format!("view at {} degrees", theta.to_degrees())));
    }
    report::judge(bytes, &judged_at(brdf, directions), 0.0)
}

/// A BRDF at outgoing directions, angles from the normal and azimuths in radians, as materials are judged by it.
pub(crate) fn judged_at(brdf: &dyn Brdf, directions: &[(f64, f64)]) -> Vec<TurnedView> {
    table::tabulate(brdf, directions, JUDGED)
}

/// Fits lobes to samples of an anisotropic surface, which a BRDF completes. The report has the samples' own views.
///
/// # Errors
/// As [`fit_brdf`].
pub(crate) fn fit_samples(
    brdf: &dyn Brdf,
    rows: &[Row],
    is_light_fixed: bool,
    settings: &Settings,
    progress: &mut (dyn FnMut(f64) + Send),
) -> Result<Fit, FitError> {
    let mut fit = fit_brdf(brdf, settings, progress)?;
    if let Some(views) = samples::views(brdf, rows, is_light_fixed) {
        fit.report.views = report::judge(&fit.bytes, &views, 0.0)?;
    }
    Ok(fit)
}

/// Fits lobes to an anisotropic BRDF that can be evaluated. The report has held-out views in the middle of every cell.
///
/// # Errors
/// [`FitError::Setting`] for more than 64 stored views; [`FitError::Table`] if it is black; [`FitError::Format`] never for finite numbers.
pub(crate) fn fit_brdf(
    brdf: &dyn Brdf,
    settings: &Settings,
    progress: &mut (dyn FnMut(f64) + Send),
) -> Result<Fit, FitError> {
    let clock = Clock::start();
    if settings.view_angles.as_ref().is_some_and(|k| k.len() > MAX_RINGS) {
        return Err(FitError::Setting { name: "view_angles", reason: format!("at most {MAX_RINGS} rings") });
    }
    let layout = layout(brdf.symmetry(), settings);
    // As it is stored.
    let axis = libm::round(brdf.axis().rem_euclid(PI) / AXIS_UNIT) % (PI / AXIS_UNIT) * AXIS_UNIT;
    let brdf: &dyn Brdf = &Along { brdf, azimuth: libm::sincos(axis) };
    let view_angles: Vec<(f64, f64)> = (0..layout.stored_views()).map(|k| layout.views.angles(k)).collect();
    let mut views = table::tabulate(brdf, &view_angles, AT_STORED_VIEWS);
    let at_stored = views.clone();
    views.extend(table::tabulate(brdf, &between(&layout.views, 0), BETWEEN));

    let placed: Vec<_> =
        views.iter().map(|TurnedView { phi, view }| (layout.views.place(view.theta, *phi), view)).collect();
    let emphasis = Emphasis { tail: TAIL, measure: MEASURE, energy: ENERGY, is_dense: false };
    let objective = Objective::over(&placed, layout.clone(), emphasis, None)?;
    let smoothness = ROUGHNESS * settings.smoothness;
    let weights = Weights { smoothness, energy: emphasis.energy, faint_color: FAINT_COLOR };
    let stiff = Weights { smoothness: STIFF * smoothness, ..weights };
    let thin = objective.clone().thinned(EVERY);
    let starts = settings.starts.min(STARTS);
    let rounds = REWEIGHED + Rounds::count(settings);
    let total = (SCOUTING + settings.steps + rounds * (settings.steps / 2)) as f64;
    progress(0.0);
    let evaluations = AtomicUsize::new(0);
    let mut candidates: Vec<(f64, usize, Vec<f64>)> = (0..starts)
        .into_par_iter()
        .map(|n| {
            let mut x = start::start(&at_stored, &layout, n);
            let count = || {
                evaluations.fetch_add(1, Ordering::Relaxed);
            };
            let limits = Limits { steps: SCOUTING, improvement: 1e-3 };
            (minimize(&Weighted { objective: &thin, weights: stiff }, &mut x, limits, count).0, n, x)
        })
        .collect();
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let Some((_, _, mut x)) = candidates.into_iter().next() else {
        return Err(FitError::Setting { name: "starts", reason: "at least 1".into() });
    };
    drop(thin);
    let mut done = SCOUTING;
    let limits = Limits { steps: settings.steps, improvement: IMPROVEMENT };
    let mut tick = || {
        done += 1;
        progress((done as f64 / total).min(1.0));
    };
    let (_, mut ending) = minimize(&Weighted { objective: &objective, weights }, &mut x, limits, &mut tick);
    // Views count by their error then.
    for _ in 0..REWEIGHED {
        let objective = objective.clone().reweighed(&x);
        let limits = Limits { steps: settings.steps / 2, improvement: FINE };
        ending = minimize(&Weighted { objective: &objective, weights }, &mut x, limits, &mut tick).1;
    }

    let emphasis = Emphasis { energy: MORE_ENERGY * emphasis.energy, ..emphasis };
    let weights = Weights { energy: emphasis.energy, ..weights };
    let rounds = Rounds { brdf, layout: &layout, emphasis, weights, settings };
    let Solution { x, factors, ending } = rounds.run(Solution { x, factors: None, ending }, tick)?;
    let text = format!("{}{}", settings.provenance, describe(settings, &layout));
    let bytes = encode::encode(&layout, &x, factors.as_ref(), axis, &text)?;
    let held_out = table::tabulate(brdf, &middles(&layout.views), JUDGED);
    let judge = |views: &[TurnedView]| report::judge(&bytes, views, axis);
    let report = Report {
        views: judge(&views)?,
        held_out: judge(&held_out)?,
        seconds: clock.seconds(),
        evaluations: evaluations.into_inner() + done - SCOUTING,
        ending: Some(ending),
        ..Report::default()
    };
    progress(1.0);
    Ok(Fit { bytes, report })
}

/// The unit of the axis of a material, radians.
const AXIS_UNIT: f64 = PI / 65_536.0;

/// A BRDF in a frame whose x lies along its axis; `azimuth`: sine and cosine of that of the axis.
struct Along<'a> {
    brdf: &'a dyn Brdf,
    azimuth: (f64, f64),
}

impl Brdf for Along<'_> {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let (s, c) = self.azimuth;
        let turned = |[x, y, z]: [f64; 3]| [c * x - s * y, c * y + s * x, z];
        self.brdf.evaluate(turned(wi), turned(wo))
    }

    fn symmetry(&self) -> Symmetry {
        self.brdf.symmetry()
    }
}

fn layout(symmetry: Symmetry, settings: &Settings) -> Layout {
    let (turns, azimuths) = match symmetry {
        Symmetry::None => (1, 2 * AZIMUTHS),
        Symmetry::HalfTurn | Symmetry::Isotropic => (2, AZIMUTHS),
        Symmetry::Quadrant => (MIRRORS, AZIMUTHS / 2 + 1),
    };
    let squeezed = settings.squeezed.unwrap_or((3 * settings.lobes).div_ceil(4));
    let pairs = if turns == MIRRORS { (PAIRED * squeezed as f64) as usize } else { 0 };
    let bytes = (settings.bytes != Settings::default().bytes).then_some(settings.bytes);
    let rings = settings.views.map_or(RINGS.len(), |views| 1 + (views - 1).div_ceil(azimuths));
    let rings = match bytes {
        Some(bytes) if settings.views.is_none() => {
            let fits = |rings: &usize| size(*rings, azimuths, settings.lobes) <= bytes;
            (FEWEST_RINGS..=MOST_RINGS).rev().find(fits).unwrap_or(FEWEST_RINGS)
        }
        _ => rings,
    };
    let thetas = settings.view_angles.clone().unwrap_or_else(|| ring_angles(rings));
    Layout {
        lobes: settings.lobes,
        squeezed,
        aside: settings.lobes,
        views: Grid { thetas, azimuths, turns, first_pair: squeezed - 2 * pairs, pairs },
    }
}

/// Bytes of a material without its provenance.
fn size(rings: usize, azimuths: usize, lobes: usize) -> usize {
    let views = 1 + (rings - 1) * azimuths;
    HEAD + 4 * (rings + NUMBERS * views * (1 + lobes))
}

/// Bytes of a material beside its views, and numbers of the head of a view and of a lobe.
const HEAD: usize = 52;
const NUMBERS: usize = 6;

/// As many angles of rings as are asked for, spread as the usual ones are.
fn ring_angles(count: usize) -> Vec<f64> {
    let last = RINGS.len() - 1;
    let angle = |n: usize| {
        let place = (n * last) as f64 / (count.max(2) - 1) as f64;
        let before = (place as usize).min(last - 1);
        let onward = place - before as f64;
        (RINGS[before] + onward * (RINGS[before + 1] - RINGS[before])).to_radians()
    };
    (0..count).map(angle).collect()
}

/// Outgoing directions at irregular places of every cell, others in every round, so that errors between stored views are met wherever they
/// are.
fn between(grid: &Grid, round: usize) -> Vec<(f64, f64)> {
    let mut directions = Vec::new();
    let first = round * (grid.thetas.len() - 1) * grid.cells();
    for (n, rings) in grid.thetas.windows(2).enumerate() {
        for cell in 0..grid.cells() {
            for i in 0..PER_CELL {
                // The generalised golden ratio of two dimensions (Roberts 2018) fills a square evenly.
                let index = ((first + n * grid.cells() + cell) * PER_CELL + i) as f64;
                let (u, v) = ((0.754_877_666 * index).fract(), (0.569_840_291 * index).fract());
                directions.push((rings[0] + u * (rings[1] - rings[0]), (cell as f64 + v) * grid.step()));
            }
        }
    }
    directions
}

/// The middle of every cell.
fn middles(grid: &Grid) -> Vec<(f64, f64)> {
    let cells = grid.thetas.windows(2).flat_map(|w| {
        let theta = 0.5 * (w[0] + w[1]);
        (0..grid.cells()).map(move |cell| (theta, (cell as f64 + 0.5) * grid.step()))
    });
    cells.collect()
}

fn describe(settings: &Settings, layout: &Layout) -> String {
    format!(
        "srbf-fit {}: anisotropic, {} lobes, {} squeezed, {} rings of {} views over 1/{} turn, smoothness {:e}, {} steps\n",
        env!("CARGO_PKG_VERSION"),
        layout.lobes,
        layout.squeezed,
        layout.views.thetas.len() - 1,
        layout.views.azimuths,
        layout.views.turns,
        settings.smoothness,
        settings.steps
    )
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::FactorNodes;
    use crate::analytic::lambert::Lambert;
    use crate::analytic::ward::Ward;
    use crate::judge::fitted_material::TrackedView;
    use crate::judge::report::mean_error;
    use std::f64::consts::TAU;

    pub(crate) use crate::anisotropic::grid::Grid;

    /// Three lobes, two of them squeezed, at two rings of some azimuths.
    pub(crate) fn grid_layout(azimuths: usize, turns: usize) -> Layout {
        // The squeezed lobes are a pair where there are mirrors.
        let pairs = usize::from(turns == MIRRORS);
        let views = Grid { thetas: vec![0.0, 0.6, 1.2], azimuths, turns, first_pair: 0, pairs };
        Layout { lobes: 3, squeezed: 2, aside: 3, views }
    }

    fn small() -> Settings {
        let view_angles = Some(vec![0.0, 0.35, 0.7, 1.0]);
        let factors = FactorNodes::None;
        Settings { lobes: 4, steps: 8, starts: 1, view_angles, factors, ..Settings::default() }
    }

    /// A black surface under another symmetry, a surface with holes: functions that callers may pass.
    struct Odd(fn([f64; 3]) -> f64);
    impl Brdf for Odd {
        fn evaluate(&self, wi: [f64; 3], _: [f64; 3]) -> [f64; 3] {
            [self.0(wi); 3]
        }
        fn symmetry(&self) -> Symmetry {
            Symmetry::None
        }
    }

    #[test]
    fn a_brushed_metal_is_met_between_the_stored_views_and_the_same_on_any_number_of_threads() {
        let ward = Ward { diffuse: [0.2, 0.1, 0.05], specular: [0.3; 3], alpha: [0.2, 0.5] };
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| fit_brdf(&ward, &small(), &mut |_| {})).unwrap()
        };
        let (one, three) = (on(1), on(3));
        assert_eq!(one.bytes, three.bytes);
        let report = &one.report;
        let (seen, unseen) = (report.mean_error(), mean_error(&report.held_out));
        println!("{seen} {unseen}");
        assert!(seen < 0.08 && unseen < 0.1, "{seen} {unseen}");
        for view in &report.held_out {
            assert!(view.variance < 0.1, "{view:?}");
            for c in 0..3 {
                assert!((view.albedo[c] / view.data_albedo[c] - 1.0).abs() < 0.05, "{view:?}");
            }
        }
        // The same lobes for the material turned by a quarter say something else.
        let turned = Ward { alpha: [0.5, 0.2], ..ward };
        let views = table::tabulate(&turned, &[(0.8, 0.1)], AT_STORED_VIEWS);
        assert!(report::judge(&one.bytes, &views, 0.0).unwrap()[0].error > 0.2);
    }

    /// A sheen that depends on the half angle, on a brushed metal: no lobe makes it, a table does.
    struct Ringed(Ward);
    impl Brdf for Ringed {
        fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
            let h = [0, 1, 2].map(|k| wi[k] + wo[k]);
            let cos = h[2] / libm::sqrt(h.iter().map(|v| v * v).sum());
            let ring = 1.0 + 0.6 * libm::cos(12.0 * libm::acos(cos.min(1.0)));
            self.0.evaluate(wi, wo).map(|v| v * ring)
        }
        fn symmetry(&self) -> Symmetry {
            self.0.symmetry()
        }
    }

    #[test]
    fn factors_have_what_lobes_cannot_and_the_albedo_is_theirs() {
        let ringed = Ringed(Ward { diffuse: [0.4, 0.3, 0.2], specular: [0.2; 3], alpha: [0.2, 0.5] });
        let fit = |factors| {
            let settings = Settings { factors, ..small() };
            fit_brdf(&ringed, &settings, &mut |_| {}).unwrap()
        };
        let (with, without) = (fit(FactorNodes::Given([16, 6, 1])), fit(FactorNodes::None));
        let measure = |fit: &Fit| fit.report.held_out.iter().map(|v| v.measure).sum::<f64>();
        println!("{} {}", measure(&with), measure(&without));
        assert!(measure(&with) < 0.7 * measure(&without));
        let material = srbf_core::Material::from_bytes(with.bytes.as_slice()).unwrap();
        assert_eq!(material.factor_nodes(), Some([16, 6, 1]));
        for view in &with.report.held_out {
            // That of the judge is a mean over directions, which the stored one is held against.
            let tracked = TrackedView::new(&material, view.theta, view.azimuth + PI).unwrap();
            let stored = tracked.mixture.albedo().to_array();
            for c in 0..3 {
                assert!((view.albedo[c] / view.data_albedo[c] - 1.0).abs() < 0.05, "{view:?}");
                assert!((f64::from(stored[c]) / view.albedo[c] - 1.0).abs() < 0.03, "{stored:?} {view:?}");
            }
        }
    }

    /// A brushed metal with a colour outside the gamut: where one channel is bright, another is negative.
    struct OutOfGamut(Ward);
    impl Brdf for OutOfGamut {
        fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
            let [red, green, blue] = self.0.evaluate(wi, wo);
            [red - 0.1 * green, green, blue]
        }
        fn symmetry(&self) -> Symmetry {
            self.0.symmetry()
        }
    }

    #[test]
    fn a_channel_below_0_is_met_as_well_as_one_above() {
        let ward = Ward { diffuse: [0.0, 0.2, 0.1], specular: [0.0, 0.3, 0.2], alpha: [0.2, 0.5] };
        let fit = fit_brdf(&OutOfGamut(ward), &small(), &mut |_| {}).unwrap();
        let error = mean_error(&fit.report.held_out);
        println!("{error}");
        assert!(error < 0.1, "{error}");
        for view in &fit.report.held_out {
            let ([red, ..], [data_red, data_green, _]) = (view.albedo, view.data_albedo);
            assert!((data_red + 0.1 * data_green).abs() < 1e-9 && red < 0.0, "{view:?}");
            assert!((red / data_red - 1.0).abs() < 0.1, "{view:?}");
        }
    }

    /// From the bytes of a file to a material that agrees with the model that the file was made from.
    #[test]
    fn an_anisotropic_rgl_file_becomes_a_material() {
        use crate::analytic::ggx::{Facets, Ggx};
        use crate::read::Content;
        use crate::read::rgl::{self, synthetic};
        let model = Ggx { diffuse: [0.2; 3], alpha: [0.3, 0.6], facets: Facets::Schlick([0.8, 0.6, 0.3]) };
        let settings = synthetic::Written { phis: 5, range: TAU / 4.0, ..synthetic::Written::default() };
        let file = rgl::parse(&synthetic::write(&model, &settings)).unwrap();
        let fit = crate::fit_content(&Content::Evaluable(Box::new(file)), &small(), |_| {}).unwrap();
        let material = srbf_core::Material::from_bytes(&fit.bytes).unwrap();
        assert!(!material.is_isotropic());
        let views = table::tabulate(&model, &middles(&layout(Symmetry::Quadrant, &small()).views), BETWEEN);
        let error = mean_error(&report::judge(&fit.bytes, &views, 0.0).unwrap());
        println!("{error}");
        assert!(error < 0.1, "{error}");
    }

    #[test]
    fn odd_surfaces_end_in_a_material_or_an_error() {
        let settings = Settings { lobes: 2, steps: 3, view_angles: Some(vec![0.0, 0.8]), ..small() };
        assert!(matches!(fit_brdf(&Odd(|_| 0.0), &settings, &mut |_| {}), Err(FitError::Table(_))));
        assert!(matches!(fit_brdf(&Odd(|_| f64::NAN), &settings, &mut |_| {}), Err(FitError::Table(_))));
        for odd in [
            (|_| 1e6) as fn([f64; 3]) -> f64,
            |d| if d[0] > 0.3 { f64::NAN } else { 0.2 },
            |d| if d[0] > 0.3 { -1.0 } else { 1e-6 },
            |d| if d[0] > 0.299 && d[0] < 0.3 { 1e6 } else { 0.0 },
        ] {
            let fit = fit_brdf(&Odd(odd), &settings, &mut |_| {}).unwrap();
            for view in fit.report.views.iter().chain(&fit.report.held_out) {
                assert!(view.albedo.iter().all(|a| (0.0..=1.0).contains(a)), "{view:?}");
            }
        }
        let many = Settings { view_angles: Some((0..65).map(|i| 0.02 * f64::from(i)).collect()), ..small() };
        let lambert = Lambert { albedo: [0.5; 3] };
        assert!(matches!(fit_brdf(&lambert, &many, &mut |_| {}), Err(FitError::Setting { .. })));
    }

    #[test]
    fn every_symmetry_has_its_own_share_of_the_turn() {
        for (symmetry, azimuths, turns) in
            [(Symmetry::None, 16, 1), (Symmetry::HalfTurn, 8, 2), (Symmetry::Quadrant, 5, 4)]
        {
            let layout = layout(symmetry, &Settings::default());
            assert_eq!((layout.views.azimuths, layout.views.turns), (azimuths, turns));
            for (theta, phi) in between(&layout.views, 1) {
                assert!((0.0..1.52).contains(&theta) && (0.0..TAU / turns as f64).contains(&phi));
            }
        }
    }
}
