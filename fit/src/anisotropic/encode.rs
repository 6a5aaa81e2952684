//! From the fitted unknowns of an anisotropic material to `.srbf` bytes.

use super::layout::Layout;
use crate::FitError;
use crate::anisotropic::tuning::encode::{LOOKS, MOST};
use srbf_core::{Grid, GridView, TiltedLobe};
use std::f64::consts::{LOG2_E, TAU};

/// Logarithm of a luminance, and colour differences.
type Color = (f32, [f32; 2]);

/// Encodes unknowns as a material. Where the albedo exceeds `MOST`, at stored views or between, the stored views round it are lowered.
pub(super) fn encode(layout: &Layout, x: &[f64], provenance: &str) -> Result<Vec<u8>, FitError> {
    let p = layout.stride();
    let mut x = x.to_vec();
    keep_energy(layout, &mut x);

    let log2 = |v: f64| (v * LOG2_E) as f32;
    let stored: Vec<([f32; 3], Color, Vec<TiltedLobe>)> = x
        .chunks_exact(p)
        .map(|q| {
            let color = |k: usize| {
                let [luminance, red, blue] = layout.tint(k).map(|i| q[i]);
                // A lobe of amplitude 0 has no logarithm.
                (log2(luminance).max(-126.0), [red as f32, blue as f32])
            };
            let lobes = (0..layout.lobes).map(|k| {
                let (log2_luminance, color_differences) = color(k);
                TiltedLobe {
                    tilt: [q[layout.along(k)] as f32, q[layout.across(k)] as f32],
                    log2_sharpness: log2(q[layout.sharpness(k)]),
                    log2_luminance,
                    color_differences,
                }
            });
            ([0, 1, 2].map(|i| log2(q[i])), color(layout.lobes), lobes.collect())
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
    let thetas: Vec<f32> = layout.thetas.iter().map(|t| *t as f32).collect();
    let grid = Grid {
        thetas: &thetas,
        azimuths: layout.azimuths,
        turns: layout.turns,
        views: &views,
        squeezed: layout.squeezed,
        factors: None,
    };
    let mut bytes = vec![0; grid.encoded_len(provenance)];
    grid.encode(provenance, &mut bytes)?;
    Ok(bytes)
}

fn keep_energy(layout: &Layout, x: &mut [f64]) {
    let p = layout.stride();
    let last = *layout.thetas.last().unwrap_or(&0.0);
    let rings = layout.thetas.len().max(2) - 1;
    let mut q = vec![0.0; p];
    // A lowered stored view lowers its other sides too, so one pass is enough.
    for i in 0..=rings * LOOKS {
        let (ring, look) = (i / LOOKS, (i % LOOKS) as f64 / LOOKS as f64);
        let theta = if ring == rings {
            last
        } else {
            layout.thetas[ring] + look * (layout.thetas.get(ring + 1).unwrap_or(&last) - layout.thetas[ring])
        };
        for j in 0..layout.azimuths * LOOKS {
            let phi = TAU * j as f64 / (layout.turns * layout.azimuths * LOOKS) as f64;
            let place = layout.place(theta, phi);
            layout.interpolate(x, &place, &mut q);
            let most = layout.albedo(&q).into_iter().fold(0.0, f64::max);
            if most > MOST {
                let less = libm::log(most / MOST);
                let mut view_angles: Vec<usize> =
                    place.corners.iter().filter(|c| c.1 > 0.0).map(|c| c.0).collect();
                view_angles.sort_unstable();
                view_angles.dedup();
                for k in view_angles {
                    layout.darken(&mut x[k * p..(k + 1) * p], less);
                }
            }
        }
    }
}
