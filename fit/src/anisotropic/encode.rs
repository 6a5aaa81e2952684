//! From the fitted unknowns of an anisotropic material to `.srbf` bytes.

use crate::FitError;
use crate::anisotropic::grid::{Layout, Stored};
use crate::anisotropic::tuning::encode::LOOKS;
use crate::family::layout::stored_log2;
use crate::family::tuning::encode::MOST;
use srbf_core::{Grid, GridView, TiltedLobe};

/// Logarithm of a luminance, and colour differences.
type Color = (f32, [f32; 2]);

/// Encodes unknowns as a material, whose azimuths count from an axis, radians. Where the albedo exceeds `MOST`, at stored views or between, the stored views round it are lowered.
pub(super) fn encode(layout: &Layout, x: &[f64], axis: f64, provenance: &str) -> Result<Vec<u8>, FitError> {
    let p = layout.stride();
    let mut x = x.to_vec();
    keep_energy(layout, &mut x);

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
    let grid = Grid {
        thetas: &thetas,
        azimuths: layout.views.azimuths,
        turns: layout.views.turns,
        axis: axis as f32,
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
    let last = *layout.views.thetas.last().unwrap_or(&0.0);
    let rings = layout.views.thetas.len().max(2) - 1;
    let mut q = vec![0.0; p];
    // A lowered stored view lowers its other sides too, so one pass is enough.
    for i in 0..=rings * LOOKS {
        let (ring, look) = (i / LOOKS, (i % LOOKS) as f64 / LOOKS as f64);
        let theta = if ring == rings {
            last
        } else {
            layout.views.thetas[ring]
                + look * (layout.views.thetas.get(ring + 1).unwrap_or(&last) - layout.views.thetas[ring])
        };
        for j in 0..=layout.views.cells() * LOOKS {
            let phi = layout.views.step() * j as f64 / LOOKS as f64;
            let place = layout.views.place(theta, phi);
            layout.interpolate(x, place, &mut q);
            let most = layout.albedo(&q, None).into_iter().fold(0.0, f64::max);
            if most > MOST {
                let less = libm::log(most / MOST);
                for (k, _) in place.stored() {
                    layout.darken(&mut x[k * p..(k + 1) * p], less);
                }
            }
        }
    }
}
