//! From fitted unknowns to `.srbf` bytes.

use crate::FitError;
use crate::family::factors::{Factors, Size, albedo_difference};
use crate::family::layout::stored_log2;
use crate::family::tuning::encode::{MOST, MOST_DIFFERENCE};
use crate::family::tuning::factors::AVERAGED_TO_STORE;
use crate::isotropic::line::Layout;
use crate::isotropic::tuning::encode::{FACTORED_LOOKS, LOOKS};
use rayon::prelude::*;
use srbf_core::{Line, PlaneLobe, View, encoded_len};
use std::f64::consts::FRAC_PI_2;

/// Views that take no more bytes than those of a layout with `lobes` lobes, none of which stands for two, and than `most`; at most
/// twice as many.
pub(crate) fn views_of_equal_size(layout: &Layout, lobes: usize, most: usize) -> usize {
    let views = layout.views.angles.len();
    let size = encoded_len(views, lobes, 0, "").min(most);
    (views..=2 * views)
        .rev()
        .find(|&n| encoded_len(n, layout.lobes, layout.aside, "") <= size)
        .unwrap_or(views)
}

/// Bytes of a layout with a table of factors, without provenance.
pub(crate) fn len(layout: &Layout, factors: Option<Size>) -> usize {
    let table = factors.map_or(0, |size| size.bytes(layout.views.angles.len()));
    encoded_len(layout.views.angles.len(), layout.lobes, layout.aside, "") + table
}

/// Encodes unknowns as a material.
///
/// Between stored views a lobe's energy is interpolated nearly geometrically, which is never above the straight line. So the
/// albedo has its maximum at a stored view but for wide lobes; it is looked at in between all the same. Where it exceeds `MOST`
/// the amplitudes of both stored views are lowered.
pub(crate) fn encode(
    layout: &Layout,
    x: &[f64],
    factors: Option<&Factors>,
    provenance: &str,
) -> Result<Vec<u8>, FitError> {
    let p = layout.stride();
    let mut x = x.to_vec();
    let last = layout.views.angles.len() - 1;
    let all = |x: &[f64]| -> Vec<Vec<Albedo>> {
        (0..last.max(1)).into_par_iter().map(|stored| Albedo::around(layout, x, factors, stored)).collect()
    };
    let mut albedos = all(&x);
    let (mut is_lowered, mut is_before_lowered) = (false, false);
    for (stored, albedos) in albedos.iter_mut().enumerate() {
        if is_before_lowered {
            *albedos = Albedo::around(layout, &x, factors, stored);
        }
        let channels = albedos.iter().flat_map(|albedo| albedo.factored);
        let most = channels.fold(0.0, f64::max);
        is_before_lowered = most > MOST;
        if is_before_lowered {
            is_lowered = true;
            for k in stored..=(stored + 1).min(last) {
                layout.darken(&mut x[k * p..(k + 1) * p], libm::log(most / MOST));
            }
        }
    }
    if is_lowered && factors.is_some() {
        albedos = all(&x);
    }

    let stored_lobes = |q: &[f64]| -> Vec<PlaneLobe> {
        let lobes = (0..layout.lobes).map(|k| {
            let (log2_luminance, color_differences) = layout.stored_tint(q, k);
            let mirrored = k.checked_sub(layout.first_aside());
            PlaneLobe {
                angle: q[layout.angle(k)] as f32,
                off_plane: mirrored.map_or(0.0, |m| off_plane(q[layout.off_plane(m)])),
                log2_sharpness: stored_log2(q[layout.sharpness(k)]),
                log2_luminance,
                color_differences,
            }
        });
        lobes.collect()
    };
    let lobes: Vec<Vec<PlaneLobe>> = x.chunks_exact(p).map(stored_lobes).collect();
    let mut views: Vec<View<'_>> = Vec::with_capacity(lobes.len());
    for ((theta, q), lobes) in layout.views.angles.iter().zip(x.chunks_exact(p)).zip(&lobes) {
        let (log2_diffuse, diffuse_color_differences) = layout.stored_tint(q, layout.lobes);
        views.push(View {
            theta: if *theta >= FRAC_PI_2 { std::f32::consts::FRAC_PI_2 } else { *theta as f32 },
            log2_squeeze: stored_log2(q[0]),
            log2_diffuse,
            diffuse_color_differences,
            lobes,
        });
    }
    let albedo_differences = factors.map(|_| albedo_differences(&albedos)).unwrap_or_default();
    let nodes = factors.map(Factors::nodes).unwrap_or_default();
    let table = factors.map(|f| f.table(&nodes, &albedo_differences));
    let line = Line { views: &views, squeezed: layout.squeezed, mirrored: layout.aside, factors: table };
    let mut bytes = vec![0; line.encoded_len(provenance)];
    line.encode(provenance, &mut bytes)?;
    Ok(bytes)
}

/// Albedo at a place between two stored views.
struct Albedo {
    /// Of the lobes and the diffuse term alone.
    lobes: [f64; 3],
    factored: [f64; 3],
}

impl Albedo {
    /// Albedos at evenly spaced places from a stored view to the next, both included; at the stored view alone if there is no next.
    fn around(layout: &Layout, x: &[f64], factors: Option<&Factors>, stored: usize) -> Vec<Self> {
        let looks = if factors.is_some() { FACTORED_LOOKS } else { LOOKS };
        let mut q = vec![0.0; layout.stride()];
        let mut at = |look| {
            let place = (stored, look as f64 / looks as f64);
            layout.interpolate(x, place, &mut q);
            let lobes = layout.albedo(&q, None);
            let means = factors.map(|f| f.means(layout, &q, layout.theta(place), AVERAGED_TO_STORE));
            Self { lobes, factored: means.map_or(lobes, |means| layout.albedo(&q, Some(&means))) }
        };
        (0..=if layout.views.angles.len() == 1 { 0 } else { looks }).map(&mut at).collect()
    }

    fn difference(&self) -> [f64; 3] {
        albedo_difference(self.lobes, self.factored)
    }
}

/// The albedo differences of the stored views, between which the straight lines are nearest to those of the albedos, in the least
/// squares.
///
/// Those at the stored views themselves would leave larger errors half way, all to one side where the factors have an edge.
fn albedo_differences(albedos: &[Vec<Albedo>]) -> Vec<[f32; 3]> {
    let count = albedos.len() + usize::from(albedos[0].len() > 1);
    // Normal equations: diagonal, next diagonal, right side. A stored view depends on its neighbours alone.
    let (mut diagonal, mut beside) = (vec![0.0; count], vec![0.0; count]);
    let mut sums = vec![[0.0; 3]; count];
    for (stored, albedos) in albedos.iter().enumerate() {
        let looks = (albedos.len() - 1).max(1) as f64;
        for (look, albedo) in albedos.iter().enumerate() {
            let (onward, difference) = (look as f64 / looks, albedo.difference());
            for (k, share) in [(stored, 1.0 - onward), (stored + 1, onward)] {
                if share > 0.0 {
                    diagonal[k] += share * share;
                    (0..3).for_each(|c| sums[k][c] += share * difference[c]);
                }
            }
            beside[stored] += onward * (1.0 - onward);
        }
    }
    for k in 1..count {
        let share = beside[k - 1] / diagonal[k - 1];
        diagonal[k] -= share * beside[k - 1];
        let before = sums[k - 1];
        (0..3).for_each(|c| sums[k][c] -= share * before[c]);
    }
    let mut after = [0.0; 3];
    for k in (0..count).rev() {
        (0..3).for_each(|c| sums[k][c] = (sums[k][c] - beside[k] * after[c]) / diagonal[k]);
        after = sums[k];
    }
    sums.iter().map(|s| s.map(|d| d.clamp(-MOST_DIFFERENCE, MOST_DIFFERENCE) as f32)).collect()
}

/// The largest distance of the stored albedo from the albedo between two stored views, over the luminance of the lobes. Also the angle half way
/// between these views.
pub(crate) fn bend(layout: &Layout, x: &[f64], factors: &Factors) -> Option<(f64, f64)> {
    let albedos: Vec<Vec<Albedo>> = (0..layout.views.angles.len() - 1)
        .into_par_iter()
        .map(|stored| Albedo::around(layout, x, Some(factors), stored))
        .collect();
    let differences = albedos.first().map(|_| albedo_differences(&albedos))?;
    let of_interval = |(stored, albedos): (usize, &Vec<Albedo>)| {
        let looks = (albedos.len() - 1) as f64;
        let off = albedos.iter().enumerate().flat_map(|(look, albedo)| {
            let (onward, difference) = (look as f64 / looks, albedo.difference());
            let [before, after] = [differences[stored], differences[stored + 1]];
            (0..3).map(move |c| {
                let between = (1.0 - onward) * f64::from(before[c]) + onward * f64::from(after[c]);
                // At its ends an interval is as far off as the one next to it.
                if (0.25..=0.75).contains(&onward) { (between - difference[c]).abs() } else { 0.0 }
            })
        });
        (off.fold(0.0, f64::max), layout.theta((stored, 0.5)))
    };
    albedos.iter().enumerate().map(of_interval).max_by(|a, b| a.0.total_cmp(&b.0))
}

/// An angle out of the plane of incidence as it is stored: one that is nearly 0 is 0, as its square would be a subnormal, which
/// processors take long to multiply.
fn off_plane(angle: f64) -> f32 {
    if angle.abs() < 1e-9 { 0.0 } else { angle as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_and_few_lobes_leave_room_for_more_views_and_no_more_than_that() {
        let layout = |lobes, mirrored| Layout::new(lobes, 2, mirrored, (0..14).map(f64::from).collect());
        assert_eq!(views_of_equal_size(&layout(12, 0), 12, usize::MAX), 14);
        for (lobes, mirrored, expected) in [(8, 4, 18), (8, 0, 20), (6, 0, 26)] {
            let views = views_of_equal_size(&layout(lobes, mirrored), 12, usize::MAX);
            let (size, most) = (|n| encoded_len(n, lobes, mirrored, ""), encoded_len(14, 12, 0, ""));
            assert!(views == expected && size(views) <= most && most < size(views + 1), "{views}");
        }
        assert_eq!(views_of_equal_size(&layout(2, 0), 12, usize::MAX), 28);
        let most = encoded_len(20, 2, 0, "");
        assert_eq!(views_of_equal_size(&layout(2, 0), 12, most), 20);
    }
}
