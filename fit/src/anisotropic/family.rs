//! A family of lobes on the grid of stored views: interpolation, roughness, bounds, and the lobes of a view.

use crate::anisotropic::coupled::Coupled;
use crate::anisotropic::grid::{CellPlace, Grid, Layout, Stored};
use crate::anisotropic::shape;
use crate::anisotropic::tuning::layout::{SHEAR, SQUEEZE, TILT};
use crate::anisotropic::tuning::objective::LONGEST_STEP;
use crate::family::layout::Views;
use crate::family::unit::{Unit, ViewSqueeze};

/// The number of the squeeze that a mirror changes.
const SHEARED: usize = 1;

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

    /// Where half a turn changes nothing, axes at the normal can only be the normal, which a turn leaves as it is. In the planes of
    /// mirrors lobes do not lean to one side, and the squeeze does not either; partners are images.
    fn fixed(layout: &Layout, stored: usize, index: usize) -> bool {
        let views = &layout.views;
        if stored == 0 {
            return views.turns > 1 && layout.angles().contains(&index)
                || views.is_mirrored() && index == SHEARED;
        }
        if !views.is_in_mirror(stored) {
            return false;
        }
        let pairs = views.first_pair..views.first_pair + 2 * views.pairs;
        let leans = |k: usize| index == layout.off_plane(k) && !pairs.contains(&k);
        let is_image = |k: usize| views.partner(k).is_some() && layout.unknowns(k).contains(&index);
        index == SHEARED || (0..layout.lobes).any(|k| leans(k) || is_image(k))
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
            let way = layout.views.stored(stored);
            if way != Stored::AsTheyAre {
                turned.copy_from_slice(from);
                match way {
                    Stored::Turned => layout.turn(&mut turned, place.azimuth),
                    _ => layout.show_images(&mut turned),
                }
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
            let at = |ring: usize, azimuth: usize, index: usize, factor: f64, out: &mut Vec<(usize, f64)>| {
                let stored = views.stored_view(ring, azimuth);
                match views.stored(stored) {
                    Stored::Turned => out.extend(turned[index].iter().map(|(j, share)| (*j, factor * share))),
                    Stored::Images => {
                        let mut unit = vec![0.0; p];
                        unit[index] = factor;
                        layout.show_images_transposed(&mut unit);
                        out.extend(
                            unit.into_iter()
                                .enumerate()
                                .filter(|t| t.1 != 0.0)
                                .map(|(j, f)| (stored * p + j, f)),
                        );
                    }
                    Stored::AsTheyAre => out.push((stored * p + index, factor)),
                }
            };
            let terms =
                |ring, index, factor, out: &mut Vec<(usize, f64)>| at(ring, azimuth, index, factor, out);
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
                    // Beyond a mirror no view is stored.
                    let is_inside = azimuth > 0 && azimuth + 1 < views.azimuths;
                    if views.azimuths > 2 && (is_inside || !views.is_mirrored()) {
                        let weight = weight * libm::sin(views.thetas[ring]);
                        at(ring, azimuth + views.azimuths - 1, index, weight, &mut row);
                        at(ring, azimuth, index, -2.0 * weight, &mut row);
                        at(ring, azimuth + 1, index, weight, &mut row);
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
