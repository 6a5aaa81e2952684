//! Tables with directions that the lobes of a material draw: there the error of a lobe shows that the data do not have.

use crate::FitError;
use crate::judge::fitted_material::TrackedView;
use crate::table::{Drawn, Table, Tabulation};
use srbf_core::Material;

/// A table with directions drawn from the lobes of a material beside the others, other ones in every `round`.
///
/// # Errors
/// As [`Table::from_brdf`]; [`FitError::Format`] and [`FitError::Core`] for bytes that are no material.
pub(super) fn resampled(
    tabulation: &Tabulation<'_>,
    thetas: &[f64],
    bytes: &[u8],
    round: usize,
) -> Result<Table, FitError> {
    let material = Material::from_bytes(bytes)?;
    tabulation.table(thetas, &|theta| {
        let view = TrackedView::new(&material, theta, 0.0)?;
        Drawn::new(&view.mixture, tabulation.density(), round).map(Some)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judge::report::ViewReport;
    use crate::table::{Brdf, Density};
    use srbf_core::{Line, PlaneLobe};
    use std::f64::consts::PI;

    /// A material of one view that is right but for a needle between the directions of a table.
    fn needle() -> Vec<u8> {
        let lobe = |log2_sharpness, log2_luminance| PlaneLobe {
            angle: 0.0,
            off_plane: 0.0,
            log2_sharpness,
            log2_luminance,
            color_differences: [0.0; 2],
        };
        let lobes = [lobe(17.0, 6.0), lobe(0.0, -126.0)];
        let view = srbf_core::View {
            theta: 0.0,
            log2_squeeze: 0.0,
            log2_diffuse: -1.0,
            diffuse_color_differences: [0.0; 2],
            lobes: &lobes,
        };
        let line = Line { views: &[view], squeezed: 0, mirrored: 0, factors: None };
        let mut bytes = vec![0; line.encoded_len("")];
        let len = line.encode("", &mut bytes).unwrap();
        bytes.truncate(len);
        bytes
    }

    #[test]
    fn a_needle_between_the_directions_is_met_by_those_that_it_draws() {
        struct Diffuse;
        impl Brdf for Diffuse {
            fn evaluate(&self, _: [f64; 3], _: [f64; 3]) -> [f64; 3] {
                [0.5 / PI; 3]
            }
        }
        let (bytes, density) = (needle(), Density::default());
        let error = |table: Table| ViewReport::new(&bytes, &table.views[0]).unwrap().error;
        let hidden = error(Table::from_brdf(&Diffuse, &[0.7], density).unwrap());
        let truth = 64.0 * libm::sqrt(PI / 131_072.0 / (0.25 / PI / PI * 2.0 * PI / 3.0));
        for round in 0..3 {
            let table = resampled(&Tabulation::new(&Diffuse, density), &[0.7], &bytes, round).unwrap();
            let sum: f64 = table.views[0].samples.iter().map(|s| s.weight).sum();
            assert!((sum / (2.0 * PI) - 1.0).abs() < 0.01, "{round}: {sum}");
            let seen = error(table);
            assert!(hidden < 1e-3 && (seen / truth - 1.0).abs() < 0.1, "{round}: {hidden} {seen} {truth}");
        }
    }
}
