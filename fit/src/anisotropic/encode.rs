//! From the fitted unknowns of an anisotropic material to `.srbf` bytes.

use crate::FitError;
use crate::anisotropic::grid::{Layout, Stored};
use crate::anisotropic::tuning::encode::{FACTORED_LOOKS, LOOKS};
use crate::family::factors::{Factors, Size, albedo_difference};
use crate::family::layout::stored_log2;
use crate::family::tuning::encode::{MOST, MOST_DIFFERENCE};
use crate::family::tuning::factors::{AVERAGED, AVERAGED_TO_STORE};
use rayon::prelude::*;
use srbf_core::{Grid, GridView, TiltedLobe};

/// Logarithm of a luminance, and colour differences.
type Color = (f32, [f32; 2]);

/// Bytes of a layout with a table of factors, without provenance.
pub(super) fn len(layout: &Layout, factors: Size) -> usize {
    let Layout { views, lobes, .. } = layout;
    super::size(views.thetas.len(), views.azimuths, *lobes) + factors.bytes(layout.stored_views())
}

/// Encodes unknowns as a material, whose azimuths count from an axis, radians. Where the albedo exceeds `MOST`, at stored views or between, the stored views round it are lowered.
pub(super) fn encode(
    layout: &Layout,
    x: &[f64],
    factors: Option<&Factors>,
    axis: f64,
    provenance: &str,
) -> Result<Vec<u8>, FitError> {
    let p = layout.stride();
    let mut x = x.to_vec();
    keep_energy(layout, factors, &mut x);
    let albedo_differences = factors.map(|f| differences(layout, f, &x)).unwrap_or_default();

    for (stored, q) in x.chunks_exact_mut(p).enumerate() {
        if layout.views.stored(stored) == Stored::Images {
            layout.show_images(q);
        }
    }
    let stored: Vec<([f32; 3], Color, Vec<TiltedLobe>)> = x
        .chunks_exact(p)
        .map(|q| {
            let lobes = (0..layout.lobes).map(|k| {
                let (log2_luminance, color_differences) = layout.stored_tint(q, k);
                TiltedLobe {
                    tilt: [q[layout.angle(k)] as f32, q[layout.off_plane(k)] as f32],
                    log2_sharpness: stored_log2(q[layout.sharpness(k)]),
                    log2_luminance,
                    color_differences,
                }
            });
            ([0, 1, 2].map(|i| stored_log2(q[i])), layout.stored_tint(q, layout.lobes), lobes.collect())
        })
        .collect();
    let views: Vec<GridView<'_>> = stored
        .iter()
        .map(|(log2_squeeze, (log2_diffuse, differences), lobes)| GridView {
            log2_squeeze: *log2_squeeze,
            log2_diffuse: *log2_diffuse,
            diffuse_color_differences: *differences,
            lobes,
        })
        .collect();
    let thetas: Vec<f32> = layout.views.thetas.iter().map(|t| *t as f32).collect();
    let nodes = factors.map(Factors::nodes).unwrap_or_default();
    let grid = Grid {
        thetas: &thetas,
        azimuths: layout.views.azimuths,
        turns: layout.views.turns,
        axis: axis as f32,
        views: &views,
        squeezed: layout.squeezed,
        factors: factors.map(|f| f.table(&nodes, &albedo_differences)),
    };
    let mut bytes = vec![0; grid.encoded_len(provenance)];
    grid.encode(provenance, &mut bytes)?;
    Ok(bytes)
}

/// The changes of the albedos of stored views by the factors, relative to the luminance of the lobes.
fn differences(layout: &Layout, factors: &Factors, x: &[f64]) -> Vec<[f32; 3]> {
    let of = |stored: usize| {
        let (theta, phi) = layout.views.angles(stored);
        let mut q = vec![0.0; layout.stride()];
        layout.interpolate(x, layout.views.place(theta, phi), &mut q);
        let means = factors.means(layout, &q, theta, AVERAGED_TO_STORE);
        albedo_difference(layout.albedo(&q, None), layout.albedo(&q, Some(&means)))
            .map(|d| d.clamp(-MOST_DIFFERENCE, MOST_DIFFERENCE) as f32)
    };
    (0..layout.stored_views()).into_par_iter().map(of).collect()
}

fn keep_energy(layout: &Layout, factors: Option<&Factors>, x: &mut [f64]) {
    let p = layout.stride();
    let last = *layout.views.thetas.last().unwrap_or(&0.0);
    let rings = layout.views.thetas.len().max(2) - 1;
    let looks = if factors.is_some() { FACTORED_LOOKS } else { LOOKS };
    let mut q = vec![0.0; p];
    // A lowered stored view lowers its other sides too, so one pass is enough.
    for i in 0..=rings * looks {
        let (ring, look) = (i / looks, (i % looks) as f64 / looks as f64);
        let theta = if ring == rings {
            last
        } else {
            layout.views.thetas[ring]
                + look * (layout.views.thetas.get(ring + 1).unwrap_or(&last) - layout.views.thetas[ring])
        };
        for j in 0..=layout.views.cells() * looks {
            let phi = layout.views.step() * j as f64 / looks as f64;
            let place = layout.views.place(theta, phi);
            layout.interpolate(x, place, &mut q);
            let means = factors.map(|f| f.means(layout, &q, theta, AVERAGED));
            let most = layout.albedo(&q, means.as_deref()).into_iter().fold(0.0, f64::max);
            if most > MOST {
                let less = libm::log(most / MOST);
                for (k, _) in place.stored() {
                    layout.darken(&mut x[k * p..(k + 1) * p], less);
                }
            }
        }
    }
}
