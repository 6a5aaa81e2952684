//! A family of lobes on the grid of stored views: interpolation, roughness, bounds, and the lobes of a view.

use crate::anisotropic::coupled::Coupled;
use crate::anisotropic::grid::{CellPlace, Grid, Layout};
use crate::anisotropic::shape;
use crate::anisotropic::tuning::layout::{SHEAR, SQUEEZE, TILT};
use crate::anisotropic::tuning::objective::LONGEST_STEP;
use crate::family::layout::Views;
use crate::family::unit::{Unit, ViewSqueeze};

impl Views for Grid {
    type Place = CellPlace;
    type Matrix = Coupled;

    const SQUEEZE: &'static [(f64, f64)] = &[SQUEEZE, SHEAR, SQUEEZE];
    const ANGLE: (f64, f64) = TILT;
    const OFF_PLANE: (f64, f64) = TILT;
    const COPIES: f64 = 1.0;
    const LONGEST_STEP: f64 = LONGEST_STEP;

    fn count(&self) -> usize {
        1 + (self.thetas.len() - 1) * self.azimuths
    }

    fn theta(&self, place: CellPlace) -> f64 {
        place.corners.iter().map(|&(stored, share)| share * self.angles(stored).0).sum()
    }

    /// Where half a turn changes nothing, axes at the normal can only be the normal, which a turn leaves as it is.
    fn fixed(layout: &Layout, stored: usize, index: usize) -> bool {
        stored == 0 && layout.views.turns == 2 && layout.angles().contains(&index)
    }

    /// The same at all directions.
    fn tail_floor(_: f64) -> f64 {
        1.0
    }

    /// None: albedos are held where the material is encoded.
    fn watched(&self) -> Vec<CellPlace> {
        Vec::new()
    }

    /// In the frame of the view.
    fn interpolate(layout: &Layout, x: &[f64], place: CellPlace, out: &mut [f64]) {
        let p = layout.stride();
        out.fill(0.0);
        let mut turned = vec![0.0; p];
        for &(stored, share) in place.corners.iter().filter(|c| c.1 > 0.0) {
            let mut from = &x[stored * p..(stored + 1) * p];
            if stored == 0 {
                turned.copy_from_slice(from);
                layout.turn(&mut turned, place.azimuth);
                from = &turned;
            }
            out.iter_mut().zip(from).for_each(|(o, v)| *o += share * v);
        }
    }

    /// Second differences outward from the normal and, times the sine of the angle, along each ring.
    fn differences(layout: &Layout, smoothness: f64, mut each: impl FnMut(&[(usize, f64)])) {
        let (views, p) = (&layout.views, layout.stride());
        let last = views.thetas.len() - 1;
        let scale = libm::sqrt(smoothness / layout.len() as f64);
        // The normal turned into the frame of an azimuth, as a combination of its unknowns.
        let mut turned = vec![vec![]; p];
        for azimuth in 0..views.azimuths {
            let (_, phi) = views.angles(views.stored_view(1.min(last), azimuth));
            let (sin, cos) = libm::sincos(phi + std::f64::consts::PI);
            for (i, row) in turned.iter_mut().enumerate() {
                let mut unit = vec![0.0; p];
                unit[i] = 1.0;
                layout.turn_transposed(&mut unit, [cos, sin]);
                *row = unit.iter().copied().enumerate().filter(|t| t.1 != 0.0).collect();
            }
            let terms = |ring: usize, index: usize, factor: f64, out: &mut Vec<(usize, f64)>| {
                if ring == 0 {
                    out.extend(turned[index].iter().map(|(j, share)| (*j, factor * share)));
                } else {
                    out.push((views.stored_view(ring, azimuth) * p + index, factor));
                }
            };
            for index in 0..p {
                let weight = scale / layout.unit(index);
                for ring in 1..=last {
                    let mut row = Vec::new();
                    if ring < last {
                        terms(ring - 1, index, weight, &mut row);
                        terms(ring, index, -2.0 * weight, &mut row);
                        terms(ring + 1, index, weight, &mut row);
                        each(&row);
                        row.clear();
                    }
                    if views.azimuths > 2 {
                        let weight = weight * libm::sin(views.thetas[ring]);
                        let others =
                            [(azimuth + views.azimuths - 1, 1.0), (azimuth, -2.0), (azimuth + 1, 1.0)];
                        row.extend(others.map(|(a, f)| (views.stored_view(ring, a) * p + index, f * weight)));
                        each(&row);
                    }
                }
            }
        }
    }

    fn squeeze(q: &[f64]) -> ViewSqueeze {
        shape::squeeze([q[0], q[1], q[2]])
    }

    fn stretch(q: &[f64]) -> [f64; 3] {
        shape::exponential([-q[0], -q[1], -q[2]]).0
    }

    fn unit(layout: &Layout, q: &[f64], k: usize, squeeze: &ViewSqueeze) -> Unit {
        let tilt = [q[layout.angle(k)], q[layout.off_plane(k)]];
        let sharpness = libm::exp(q[layout.sharpness(k)]);
        shape::unit(tilt, sharpness, (k < layout.squeezed).then_some(squeeze))
    }

    fn frame(layout: &Layout, q: &[f64], k: usize) -> [[f64; 3]; 3] {
        shape::frame(Self::unit(layout, q, k, &Self::squeeze(q)).axes[0].at)
    }
}
