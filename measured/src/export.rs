//! Writers of the formats that the readers read, from a BRDF or from samples.
//!
//! A grid holds a BRDF at its nodes; its reader interpolates between them. The tests of each format state how far a smooth
//! model is off after a round trip.
//!
//! May import: `error`, `patches`, `read`, `row`, `table`.

mod bsdf;
mod lobes;
mod merl;
mod samples;
mod window;

use crate::FitError;
use crate::row::{Row, turned_over};
use crate::table::{Brdf, Density, Symmetry, Table, View, direction, evaluation_views};
use srbf_core::Quarter;
use std::f64::consts::{PI, TAU};

pub use bsdf::rgl;
pub use lobes::Lobes;
pub use merl::{MERL_MARK, merl};
pub use samples::{astm, csv, csv_of_rows, csv_of_spectra};
pub use window::window;

/// Outgoing directions of samples that are made of a BRDF, and incident ones of each.
const VIEWS: usize = 16;

/// Angles and azimuths of outgoing directions of a surface that a turn changes, and incident directions of each over the hemisphere.
const TURNED_VIEWS: usize = 9;
const TURNS: usize = 12;
const TURNED_DIRECTIONS: usize = 200;
const DIRECTIONS: Density = Density { hemisphere: 1000, cap: 300 };

/// Samples of an isotropic BRDF: at 16 outgoing directions from the normal to 87 degrees, some 1300 incident ones each, which lie closer
/// round the mirror direction.
///
/// # Errors
/// [`FitError::Table`] for an anisotropic BRDF and one without brightness.
pub fn sampled(brdf: &dyn Brdf) -> Result<Table, FitError> {
    check_isotropic(brdf)?;
    Table::from_brdf(brdf, &evaluation_views::even_views(VIEWS), DIRECTIONS)
}

/// Samples of a BRDF that a turn changes, as our own CSV: 9 angles by 12 azimuths of the outgoing direction, and some 300 incident ones
/// each, a third of them round the mirror direction. Those that were not measured are left out. Gives their number too.
pub fn csv_of_turned(brdf: &dyn Brdf) -> (String, usize) {
    let rows = rows_of_turned(brdf);
    (csv_of_rows(&rows), rows.len())
}

/// Samples of all quarters of a sheet, in the order of [`Quarter::ALL`], as our own CSV: of each those that its surface alone would have.
/// Directions behind the sheet have a height below 0. Gives their number too.
///
/// # Errors
/// As [`measured`].
pub fn csv_of_sheet(quarters: [Option<&dyn Brdf>; 4]) -> Result<(String, usize), FitError> {
    let mut all = Vec::new();
    for (quarter, brdf) in Quarter::ALL.into_iter().zip(quarters) {
        let Some(brdf) = brdf else { continue };
        let rows = match brdf.symmetry() {
            Symmetry::Isotropic => rows_of_table(&measured(brdf)?.0),
            _ => rows_of_turned(brdf),
        };
        all.extend(rows.into_iter().map(|row| {
            let [wi, wo] = turned_over(quarter, [row.wi, row.wo]);
            Row { wi, wo, ..row }
        }));
    }
    Ok((csv_of_rows(&all), all.len()))
}

fn rows_of_table(table: &Table) -> Vec<Row> {
    let of_view = |view: &View| {
        let wo = direction(view.theta, PI);
        view.samples.iter().map(move |s| Row { line: 0, wi: s.direction, wo, rgb: s.rgb }).collect::<Vec<_>>()
    };
    table.views.iter().flat_map(of_view).collect()
}

fn rows_of_turned(brdf: &dyn Brdf) -> Vec<Row> {
    let mut rows = Vec::new();
    for (n, theta) in (0..TURNED_VIEWS).map(|n| (n, 0.02 + 1.4 * n as f64 / (TURNED_VIEWS - 1) as f64)) {
        for turn in 0..TURNS {
            // Every ring begins elsewhere.
            let phi = TAU * (turn as f64 + 0.5 * (n % 2) as f64) / TURNS as f64;
            let (wo, mirror) = (direction(theta, phi), direction(theta, phi + PI));
            let incident = evaluation_views::spread(TURNED_DIRECTIONS)
                .chain(evaluation_views::about(mirror, TURNED_DIRECTIONS / 2));
            for wi in incident.filter(|wi| wi[2] > 0.05 && brdf.measured(*wi, wo) >= 0.5) {
                rows.push(Row { line: rows.len() + 1, wi, wo, rgb: finite(brdf.evaluate(wi, wo)) });
            }
        }
    }
    rows
}

/// [`sampled`] without samples most of whose value was not measured, and the share of those.
///
/// # Errors
/// As `sampled`; [`FitError::Table`] where nothing was measured.
pub fn measured(brdf: &dyn Brdf) -> Result<(Table, f64), FitError> {
    let mut table = sampled(brdf)?;
    let count = |table: &Table| table.views.iter().map(|view| view.samples.len()).sum::<usize>();
    let all = count(&table);
    for view in &mut table.views {
        let wo = [-libm::sin(view.theta), 0.0, libm::cos(view.theta)];
        view.samples.retain(|sample| brdf.measured(sample.direction, wo) >= 0.5);
    }
    table.views.retain(|view| !view.samples.is_empty());
    if table.views.is_empty() {
        return Err(FitError::Table("nothing of it was measured".into()));
    }
    let left_out = 1.0 - count(&table) as f64 / all as f64;
    Ok((table, left_out))
}

/// Refuses what no format here holds.
fn check_isotropic(brdf: &dyn Brdf) -> Result<(), FitError> {
    if brdf.symmetry() == Symmetry::Isotropic {
        return Ok(());
    }
    Err(FitError::Table("anisotropic; only isotropic surfaces can be converted".into()))
}

/// The value of a BRDF, 0 where it is no number.
fn finite(rgb: [f64; 3]) -> [f64; 3] {
    rgb.map(|v| if v.is_finite() { v } else { 0.0 })
}

/// How far a BRDF is from another at four outgoing directions: angle in degrees, relative L2 error of `f cos` over the hemisphere.
///
/// # Errors
/// As [`Table::from_brdf`].
pub fn difference(of: &dyn Brdf, from: &dyn Brdf) -> Result<[(f64, f64); 4], FitError> {
    let mut found = [(0.0, 0.0); 4];
    if from.symmetry() != Symmetry::Isotropic {
        for (found, theta) in found.iter_mut().zip(evaluation_views::seen_views()) {
            *found = (theta.to_degrees(), evaluation_views::difference_over_turns(of, from, theta));
        }
        return Ok(found);
    }
    let table = evaluation_views::judging_table(from, &evaluation_views::seen_views())?;
    for (found, view) in found.iter_mut().zip(&table.views) {
        let wo = [-libm::sin(view.theta), 0.0, libm::cos(view.theta)];
        let (mut apart, mut all) = (0.0, 0.0);
        for sample in &view.samples {
            let rgb = finite(of.evaluate(sample.direction, wo));
            let weight = sample.weight * sample.direction[2] * sample.direction[2];
            for (a, b) in rgb.iter().zip(sample.rgb) {
                apart += weight * (a - b) * (a - b);
                all += weight * b * b;
            }
        }
        *found = (view.theta.to_degrees(), libm::sqrt(apart / all));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read;
    use crate::read::Content;

    pub(super) fn model(text: &str) -> Box<dyn Brdf + Send> {
        let Content::Evaluable(brdf) = read::read(format!("model:{text}").as_ref()).unwrap().content else {
            panic!()
        };
        brdf
    }

    /// Worst of the four errors of a model after a round trip.
    fn round_trip(text: &str, through: impl Fn(&dyn Brdf) -> Box<dyn Brdf>) -> f64 {
        let model = model(text);
        let errors = difference(through(model.as_ref()).as_ref(), model.as_ref()).unwrap();
        println!("{text}: {errors:?}");
        errors.iter().map(|e| e.1).fold(0.0, f64::max)
    }

    /// The bounds that `srbf convert --help` states.
    #[test]
    fn models_come_back_through_grids_within_bounds() {
        let through_merl = |brdf: &dyn Brdf| -> Box<dyn Brdf> {
            Box::new(read::merl::parse(&merl(brdf).unwrap().bytes).unwrap())
        };
        let through_rgl = |brdf: &dyn Brdf| -> Box<dyn Brdf> {
            Box::new(read::rgl::parse(&rgl(brdf, None).unwrap()).unwrap())
        };
        for (text, merl, rgl) in [
            ("lambert:albedo=0.6/0.2/0.1", 1e-7, 0.003),
            ("ggx:alpha=0.3,f0=0.6,diffuse=0.2", 0.002, 0.005),
            ("ggx:alpha=0.1,f0=0.9/0.5/0.1,diffuse=0.1", 0.005, 0.005),
        ] {
            let found = [round_trip(text, through_merl), round_trip(text, through_rgl)];
            assert!(found[0] < merl && found[1] < rgl, "{text}: {found:?}");
        }
    }

    #[test]
    fn samples_come_back_as_they_were() {
        let table = sampled(model("ggx:alpha=0.2,f0=0.6/0.4/0.2").as_ref()).unwrap();
        let conventions = read::Conventions::default();
        let parse_csv = read::csv::parse(csv(&table, None).as_bytes(), &conventions).unwrap();
        let parse_astm = read::astm::parse(astm(&table).as_bytes(), &conventions).unwrap();
        for (intake, tolerance) in [(parse_csv, 1e-9), (parse_astm, 1e-9)] {
            let back = Table::from_scattered(intake.views()).unwrap();
            assert_eq!(back.views.len(), table.views.len());
            for (found, view) in back.views.iter().zip(&table.views) {
                assert!((found.theta - view.theta).abs() < tolerance);
                assert_eq!(found.samples.len(), view.samples.len());
                for (a, b) in found.samples.iter().zip(&view.samples) {
                    let apart = |k: usize| (a.direction[k] - b.direction[k]).abs();
                    assert!((0..3).all(|k| apart(k) < tolerance), "{a:?} {b:?}");
                    assert_eq!(a.rgb, b.rgb);
                }
            }
        }
    }

    #[test]
    fn what_no_format_holds_is_refused() {
        let brushed = model("ward:alpha_x=0.1,alpha_y=0.4");
        assert!(merl(brushed.as_ref()).is_err() && sampled(brushed.as_ref()).is_err());
    }

    #[test]
    fn surfaces_that_a_turn_changes_come_back() {
        let brushed = model("ward:alpha_x=0.1,alpha_y=0.4");
        let back = read::rgl::parse(&rgl(brushed.as_ref(), None).unwrap()).unwrap();
        for (angle, error) in difference(&back, brushed.as_ref()).unwrap() {
            assert!(error < 0.04, "at {angle} degrees {error}");
        }
        let (text, count) = csv_of_turned(brushed.as_ref());
        let intake = read::csv::parse(text.as_bytes(), &read::Conventions::default()).unwrap();
        assert_eq!(intake.rows.len(), count);
        for row in intake.rows.iter().step_by(97) {
            let expected = brushed.evaluate(row.wi, row.wo);
            assert!(
                (0..3).all(|c| (row.rgb[c] - expected[c]).abs() < 1e-6 * expected[c]),
                "{row:?} {expected:?}"
            );
        }
    }

    #[test]
    #[ignore = "needs SRBF_DATA_DIR"]
    fn measured_tables_come_back() {
        let data = std::env::var("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the folder of the data");
        for name in ["cc_green_malachite", "aurora_white", "chm_light_blue"] {
            let path = format!("{data}/rgl/{name}_rgb.bsdf");
            let Content::Evaluable(brdf) = read::read(path.as_ref()).unwrap().content else { panic!() };
            let worst = |back: &dyn Brdf| {
                let errors = difference(back, brdf.as_ref()).unwrap();
                println!("{name}: {errors:?}");
                errors.iter().map(|e| e.1).fold(0.0, f64::max)
            };
            let back = read::rgl::parse(&rgl(brdf.as_ref(), None).unwrap()).unwrap();
            assert!(worst(&back) < 0.1);
            // MERL is reciprocal, and the measurement is not.
            let back = read::merl::parse(&merl(brdf.as_ref()).unwrap().bytes).unwrap();
            assert!(worst(&back) < 0.35);
        }
    }
}
