//! Cuts lobes, views and factors off a material.

use super::forms::PackedForm;
use crate::FitError;
use crate::settings::range;
use srbf_core::{FactorTable, Grid, GridView, Line, Material, PlaneLobe, TiltedLobe, View};

/// Weights of squared differences at a view that is left out, of a lobe that has all the power: of its angle in widths, of the
/// logarithms of its sharpness and luminance, of its colour.
const OF_ANGLE: f64 = 1.0;
const OF_SHARPNESS: f64 = 0.1;
const OF_LUMINANCE: f64 = 0.5;
const OF_COLOR: f64 = 0.1;

/// A view with all it has. Of an isotropic material a tilt is the angle in the plane of incidence and that out of it. The squeeze is the
/// first number then.
#[derive(Clone)]
struct Stored {
    theta: f32,
    log2_squeeze: [f32; 3],
    log2_diffuse: f32,
    diffuse_color_differences: [f32; 2],
    lobes: Vec<TiltedLobe>,
    albedo_difference: [f32; 3],
}

/// The views at one angle: one of an isotropic material, and of the normal.
type Ring = Vec<Stored>;

/// The rest of a material in a form.
///
/// The lobes with the least power go; views go where those beside tell them best; factors are taken between their nodes.
///
/// # Errors
/// [`FitError::Setting`] for a form with more of anything than the material has.
pub(super) fn cut(material: &Material<Vec<u8>>, form: &PackedForm) -> Result<Material<Vec<u8>>, FitError> {
    let whole = PackedForm::of(material, form.pack);
    let count = |name, wanted: usize, there: usize, least: usize| {
        range(
            name,
            (least..=there).contains(&wanted),
            &format!("from {least} to {there}, which the material has"),
        )
    };
    count("lobes", form.lobes, whole.lobes, 1)?;
    count("views", form.views, whole.views, 2.min(whole.views))?;
    if let Some(nodes) = form.factors {
        let there = whole.factors.unwrap_or([0; 3]);
        let fits = nodes.iter().zip(there).all(|(wanted, there)| *wanted <= there);
        range("factors", fits, &format!("at most {there:?}, which the material has"))?;
        range("factors", nodes[0] >= 2 && nodes[1] >= 2 && nodes[2] >= 1, "at least 2 x 2 x 1")?;
    }
    let mut rings: Vec<Ring> = Vec::new();
    for view in (0..whole.views).map(|view| stored(material, view)) {
        match rings.last_mut().filter(|ring| ring[0].theta == view.theta) {
            Some(ring) => ring.push(view),
            None => rings.push(vec![view]),
        }
    }
    let (mut squeezed, mut mirrored) = (material.squeezed_count(), material.mirrored_count());
    drop_lobes(&mut rings, form.lobes, &mut squeezed, &mut mirrored);
    let azimuths = rings.last().map_or(1, Vec::len);
    let tilts = if material.is_isotropic() { 1 } else { 2 };
    let kept = kept_rings(&rings, 1 + form.views.saturating_sub(1) / azimuths, tilts);
    let views: Vec<Stored> = kept.into_iter().flat_map(|ring| rings[ring].clone()).collect();
    let factors = form.factors.map(|nodes| resampled(material, nodes)).unwrap_or_default();
    let albedo_differences: Vec<[f32; 3]> = views.iter().map(|view| view.albedo_difference).collect();
    let table = form.factors.map(|[half, difference, azimuth]| FactorTable {
        half,
        difference,
        azimuth,
        is_signed: material.has_signed_factors() && azimuth > 1,
        factors: &factors,
        albedo_differences: &albedo_differences,
    });
    let bytes = if material.is_isotropic() {
        line(&views, [squeezed, mirrored], table)?
    } else {
        grid(material, &views, azimuths, squeezed, table)?
    };
    Ok(Material::from_bytes(bytes)?)
}

fn line(
    views: &[Stored],
    [squeezed, mirrored]: [usize; 2],
    factors: Option<FactorTable<'_>>,
) -> Result<Vec<u8>, FitError> {
    let plane = |lobe: &TiltedLobe| PlaneLobe {
        angle: lobe.tilt[0],
        off_plane: lobe.tilt[1],
        log2_sharpness: lobe.log2_sharpness,
        log2_luminance: lobe.log2_luminance,
        color_differences: lobe.color_differences,
    };
    let lobes: Vec<Vec<PlaneLobe>> =
        views.iter().map(|view| view.lobes.iter().map(plane).collect()).collect();
    let borrowed: Vec<View<'_>> = views
        .iter()
        .zip(&lobes)
        .map(|(view, lobes)| View {
            theta: view.theta,
            log2_squeeze: view.log2_squeeze[0],
            log2_diffuse: view.log2_diffuse,
            diffuse_color_differences: view.diffuse_color_differences,
            lobes,
        })
        .collect();
    let line = Line { views: &borrowed, squeezed, mirrored, factors };
    let mut bytes = vec![0; line.encoded_len("")];
    line.encode("", &mut bytes)?;
    Ok(bytes)
}

fn grid(
    material: &Material<Vec<u8>>,
    views: &[Stored],
    azimuths: usize,
    squeezed: usize,
    factors: Option<FactorTable<'_>>,
) -> Result<Vec<u8>, FitError> {
    let mut thetas: Vec<f32> = views.iter().map(|view| view.theta).collect();
    thetas.dedup();
    let borrowed: Vec<GridView<'_>> = views
        .iter()
        .map(|view| GridView {
            log2_squeeze: view.log2_squeeze,
            log2_diffuse: view.log2_diffuse,
            diffuse_color_differences: view.diffuse_color_differences,
            lobes: &view.lobes,
        })
        .collect();
    let (turns, axis) = material.grid_turns().unwrap_or((1, 0.0));
    let grid = Grid { thetas: &thetas, azimuths, turns, axis, views: &borrowed, squeezed, factors };
    let mut bytes = vec![0; grid.encoded_len("")];
    grid.encode("", &mut bytes)?;
    Ok(bytes)
}

fn stored(material: &Material<Vec<u8>>, view: usize) -> Stored {
    let plane = |lobe: PlaneLobe| TiltedLobe {
        tilt: [lobe.angle, lobe.off_plane],
        log2_sharpness: lobe.log2_sharpness,
        log2_luminance: lobe.log2_luminance,
        color_differences: lobe.color_differences,
    };
    let lobe = |k| material.view_tilted_lobe(view, k).or_else(|| material.view_lobe(view, k).map(plane));
    let lobes = (0..material.view_lobe_count()).filter_map(lobe).collect();
    let one_number = || [material.view_log2_squeeze(view).unwrap_or_default(), 0.0, 0.0];
    Stored {
        theta: material.view_theta(view).unwrap_or_default(),
        log2_squeeze: material.view_log2_squeeze_matrix(view).unwrap_or_else(one_number),
        log2_diffuse: material.view_log2_diffuse(view).unwrap_or(-126.0),
        diffuse_color_differences: material.view_diffuse_color_differences(view).unwrap_or_default(),
        lobes,
        albedo_difference: material.view_albedo_difference(view).unwrap_or_default(),
    }
}

/// Power of a lobe, with its part below the horizon.
fn power(lobe: &TiltedLobe) -> f64 {
    let sharpness = lobe.log2_sharpness.exp2();
    f64::from(lobe.log2_luminance.exp2() * srbf_core::special::sphere_integral(sharpness))
}

/// Drops the lobe with the least power until a mixture has at most a number. Where another lobe is its image in a mirror, both go.
fn drop_lobes(rings: &mut [Ring], most: usize, squeezed: &mut usize, mirrored: &mut usize) {
    loop {
        let stored = rings[0][0].lobes.len();
        if stored + *mirrored <= most || stored == 1 {
            return;
        }
        let twice = |k: usize| if k + *mirrored >= stored { 2.0 } else { 1.0 };
        let power =
            |k: usize| twice(k) * rings.iter().flatten().map(|view| power(&view.lobes[k])).sum::<f64>();
        let least = (0..stored).min_by(|a, b| power(*a).total_cmp(&power(*b))).unwrap_or(0);
        // The ends of a ring lie in the mirrors, if there are some: one more than the ring of another material has.
        let ends = &rings[rings.len() - 1];
        let image = (0..stored).find(|k| {
            ends.len() > 1
                && *k != least
                && [&ends[0], &ends[ends.len() - 1]].iter().all(|view| is_image(view, *k, least))
        });
        let mut gone = vec![least];
        gone.extend(image);
        gone.sort_unstable();
        for k in gone.into_iter().rev() {
            rings.iter_mut().flatten().for_each(|view| {
                view.lobes.remove(k);
            });
            *squeezed -= usize::from(k < *squeezed);
            *mirrored -= usize::from(k + *mirrored >= stored);
        }
    }
}

/// Whether a lobe of a view is the image of another in the plane of incidence, and not itself in it.
fn is_image(view: &Stored, k: usize, of: usize) -> bool {
    let [a, b] = [k, of].map(|k| view.lobes[k]);
    let image = TiltedLobe { tilt: [b.tilt[0], -b.tilt[1]], ..b };
    a == image && a.tilt[1] != 0.0
}

/// Which rings are kept: the first, the last, and those in between that leave the least to be told by their neighbours
/// (Bellman and Roth 1969, Curve fitting by segmented straight lines).
fn kept_rings(rings: &[Ring], count: usize, tilts: usize) -> Vec<usize> {
    let last = rings.len() - 1;
    if count > last {
        return (0..=last).collect();
    }
    let cost = |from: usize, to: usize| {
        (from + 1..to).map(|ring| missed(rings, [from, ring, to], tilts)).sum::<f64>()
    };
    let mut least: Vec<f64> = (0..=last).map(|to| if to == 0 { 0.0 } else { f64::INFINITY }).collect();
    let mut begins = Vec::new();
    for _ in 1..count {
        let best = |to: usize| {
            let begins = (0..to).map(|from| (least[from] + cost(from, to), from));
            begins.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, 0))
        };
        let (costs, begin): (Vec<f64>, Vec<usize>) = (0..=last).map(best).unzip();
        least = costs;
        begins.push(begin);
    }
    let mut kept = vec![last];
    for begin in begins.iter().rev() {
        kept.push(begin[kept[kept.len() - 1]]);
    }
    kept.reverse();
    kept
}

/// How much the views of a ring are missed between two others.
fn missed(rings: &[Ring], [from, ring, to]: [usize; 3], tilts: usize) -> f64 {
    let at = |ring: usize, n: usize| &rings[ring][n % rings[ring].len()];
    (0..rings[ring].len()).map(|n| missed_between(at(from, n), at(ring, n), at(to, n), tilts)).sum()
}

/// How much a view is missed between two others, in squared differences of the numbers of its lobes.
/// `tilts`: how many numbers of an axis count.
fn missed_between(a: &Stored, here: &Stored, b: &Stored, tilts: usize) -> f64 {
    let onward = f64::from((here.theta - a.theta) / (b.theta - a.theta));
    let off = |a: f32, here: f32, b: f32| {
        let between = f64::from(a) + onward * f64::from(b - a);
        (between - f64::from(here)).powi(2)
    };
    let whole: f64 = here.lobes.iter().map(power).sum::<f64>().max(1e-30);
    let lobes = a.lobes.iter().zip(&here.lobes).zip(&b.lobes);
    lobes
        .map(|((a, here), b)| {
            let sharpness = f64::from(here.log2_sharpness.exp2());
            let colors: f64 = (0..2)
                .map(|i| off(a.color_differences[i], here.color_differences[i], b.color_differences[i]))
                .sum();
            let tilts: f64 = (0..tilts).map(|i| off(a.tilt[i], here.tilt[i], b.tilt[i])).sum();
            let squares = OF_ANGLE * sharpness.min(1e6) * tilts
                + OF_SHARPNESS * off(a.log2_sharpness, here.log2_sharpness, b.log2_sharpness)
                + OF_LUMINANCE * off(a.log2_luminance, here.log2_luminance, b.log2_luminance)
                + OF_COLOR * colors;
            power(here) / whole * squares
        })
        .sum()
}

/// Factors between the nodes of a material, at the nodes of a smaller table.
fn resampled(material: &Material<Vec<u8>>, nodes: [usize; 3]) -> Vec<[f32; 3]> {
    let from = material.factor_nodes().unwrap_or([1; 3]);
    let place = |axis: usize, node: usize| {
        // A signed azimuth has its middle where the other begins.
        let begin = if axis == 2 && nodes[2] == 1 && material.has_signed_factors() { 0.5 } else { 0.0 };
        let place = (begin + node as f32 / (nodes[axis] - 1).max(1) as f32) * (from[axis] - 1) as f32;
        let before = (place as usize).min(from[axis].saturating_sub(2));
        (before, place - before as f32)
    };
    let mut factors = Vec::with_capacity(nodes.iter().product());
    for k in 0..nodes[2] {
        for i in 0..nodes[0] {
            for j in 0..nodes[1] {
                if k > 0 && (i == 0 || j == 0) {
                    // There is no azimuth there.
                    factors.push(factors[i * nodes[1] + j]);
                    continue;
                }
                let places = [place(0, i), place(1, j), place(2, k)];
                let mut sum = [0f32; 3];
                for corner in 0..8usize {
                    let at = |axis: usize| {
                        let (before, onward) = places[axis];
                        if corner >> axis & 1 == 1 { (before + 1, onward) } else { (before, 1.0 - onward) }
                    };
                    let [a, b, c] = [at(0), at(1), at(2)];
                    let factor = material.factor_node(a.0, b.0, c.0).unwrap_or_default();
                    (0..3).for_each(|i| sum[i] += a.1 * b.1 * c.1 * factor[i]);
                }
                factors.push(sum);
            }
        }
    }
    factors
}
