//! From fitted unknowns to `.srbf` bytes.

use crate::FitError;
use crate::parameters::Layout;
use srbf_core::{Line, PlaneLobe, View, color_differences, encoded_len};
use std::f64::consts::{FRAC_PI_2, LOG2_E};

/// Largest albedo of a material, at any view.
const MOST: f64 = 0.999;

/// Views between two knots at which the albedo is looked at.
const LOOKS: usize = 64;

/// As many views as take no more bytes than those of a layout would with so many lobes, none of which stands for two; at most twice as
/// many.
pub(crate) fn views_of_equal_size(layout: &Layout, lobes: usize) -> usize {
    let views = layout.knots.len();
    let size = encoded_len(views, lobes, 0, "");
    (views..=2 * views)
        .rev()
        .find(|&n| encoded_len(n, layout.lobes, layout.mirrored, "") <= size)
        .unwrap_or(views)
}

/// Encodes unknowns as a material.
///
/// Between knots a lobe's energy is interpolated nearly geometrically, which is never above the straight line, so the
/// albedo has its maximum at a knot but for wide lobes; it is looked at in between all the same. Where it exceeds `MOST` the
/// amplitudes of both knots are lowered.
pub(crate) fn encode(layout: &Layout, x: &[f64], provenance: &str) -> Result<Vec<u8>, FitError> {
    let p = layout.stride();
    let mut x = x.to_vec();
    let mut q = vec![0.0; p];
    let last = layout.knots.len() - 1;
    for knot in 0..last.max(1) {
        let most = (0..=if last == 0 { 0 } else { LOOKS }).fold(0.0, |most: f64, look| {
            layout.interpolate(&x, (knot, look as f64 / LOOKS as f64), &mut q);
            layout.albedo(&q).into_iter().fold(most, f64::max)
        });
        if most > MOST {
            for k in knot..=(knot + 1).min(last) {
                x[k * p + layout.amplitude(0, 0)..(k + 1) * p]
                    .iter_mut()
                    .for_each(|v| *v -= libm::log(most / MOST));
            }
        }
    }

    let stored: Vec<(f32, [f32; 4], Vec<PlaneLobe>)> = layout
        .knots
        .iter()
        .enumerate()
        .map(|(knot, theta)| {
            let q = &x[knot * p..(knot + 1) * p];
            let log2 = |v: f64| (v * LOG2_E) as f32;
            let color = |of: [usize; 3]| color_differences(of.map(|i| log2(q[i])));
            let lobes = (0..layout.lobes).map(|k| {
                let (log2_luminance, color_differences) = color([0, 1, 2].map(|c| layout.amplitude(c, k)));
                PlaneLobe {
                    angle: q[layout.angle(k)] as f32,
                    off_plane: k
                        .checked_sub(layout.first_mirrored())
                        .map_or(0.0, |m| q[layout.off_plane(m)] as f32),
                    log2_sharpness: log2(q[layout.sharpness(k)]),
                    log2_luminance,
                    color_differences,
                }
            });
            let theta = if *theta >= FRAC_PI_2 { std::f32::consts::FRAC_PI_2 } else { *theta as f32 };
            let (diffuse, differences) = color([0, 1, 2].map(|c| layout.diffuse(c)));
            (theta, [log2(q[0]), diffuse, differences[0], differences[1]], lobes.collect())
        })
        .collect();
    let views: Vec<View<'_>> = stored
        .iter()
        .map(|&(theta, [log2_squeeze, log2_diffuse, rho, beta], ref lobes)| View {
            theta,
            log2_squeeze,
            log2_diffuse,
            diffuse_color_differences: [rho, beta],
            lobes,
        })
        .collect();
    let line = Line { views: &views, squeezed: layout.squeezed, mirrored: layout.mirrored, factors: None };
    let mut bytes = vec![0; line.encoded_len(provenance)];
    line.encode(provenance, &mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_and_few_lobes_leave_room_for_more_views_and_no_more_than_that() {
        let layout = |lobes, mirrored| Layout::new(lobes, 2, mirrored, (0..14).map(f64::from).collect());
        assert_eq!(views_of_equal_size(&layout(12, 0), 12), 14);
        for (lobes, mirrored, expected) in [(8, 4, 18), (8, 0, 20), (6, 0, 26)] {
            let views = views_of_equal_size(&layout(lobes, mirrored), 12);
            let (size, most) = (|n| encoded_len(n, lobes, mirrored, ""), encoded_len(14, 12, 0, ""));
            assert!(views == expected && size(views) <= most && most < size(views + 1), "{views}");
        }
        assert_eq!(views_of_equal_size(&layout(2, 0), 12), 28);
    }
}
