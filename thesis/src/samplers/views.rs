//! The values of a reflection that samplers are fitted to, view by view.

use super::Reflection;
use super::probe::{Direction, THETAS, directions, outgoing, theta};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Azimuths of anisotropic materials.
const AZIMUTHS: usize = 4;

/// Incident directions of each roughness.
const DRAWN: usize = 160;

/// The values of a reflection at one angle.
pub struct Look {
    /// The incident directions for each azimuth of the outgoing one.
    pub azimuths: Vec<(DVec3, Vec<Direction>)>,
}

/// Looks at a reflection from all angles.
pub fn look(reflection: &dyn Reflection) -> Vec<Look> {
    let azimuths = if reflection.is_isotropic() { 1 } else { AZIMUTHS };
    (0..THETAS)
        .into_par_iter()
        .map(|n| {
            let at = |azimuth: usize| {
                let wo = outgoing(theta(n, THETAS), PI + TAU * azimuth as f64 / azimuths as f64);
                (wo, directions(wo, DRAWN, &|wi| reflection.f_cos(wi, wo)))
            };
            Look { azimuths: (0..azimuths).map(at).collect() }
        })
        .collect()
}
