//! Cuts lobes, views and factors off a material.

use super::forms::PackedForm;
use crate::FitError;
use crate::settings::range;
use srbf_core::{FactorTable, Line, Material, PlaneLobe, View};

/// Weights of squared differences at a view that is left out, of a lobe that has all the power: of its angle in widths, of the
/// logarithms of its sharpness and luminance, of its colour.
const OF_ANGLE: f64 = 1.0;
const OF_SHARPNESS: f64 = 0.1;
const OF_LUMINANCE: f64 = 0.5;
const OF_COLOR: f64 = 0.1;

/// A view with all it has.
#[derive(Clone)]
struct Stored {
    theta: f32,
    log2_squeeze: f32,
    log2_diffuse: f32,
    diffuse_color_differences: [f32; 2],
    lobes: Vec<PlaneLobe>,
    albedo_difference: [f32; 3],
}

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
    let mut views: Vec<Stored> = (0..whole.views).map(|view| stored(material, view)).collect();
    let (mut squeezed, mut mirrored) = (material.squeezed_count(), material.mirrored_count());
    drop_lobes(&mut views, form.lobes, &mut squeezed, &mut mirrored);
    let views: Vec<Stored> =
        kept_views(&views, form.views).into_iter().map(|view| views[view].clone()).collect();
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
    let borrowed: Vec<View<'_>> = views
        .iter()
        .map(|view| View {
            theta: view.theta,
            log2_squeeze: view.log2_squeeze,
            log2_diffuse: view.log2_diffuse,
            diffuse_color_differences: view.diffuse_color_differences,
            lobes: &view.lobes,
        })
        .collect();
    let line = Line { views: &borrowed, squeezed, mirrored, factors: table };
    let mut bytes = vec![0; line.encoded_len("")];
    line.encode("", &mut bytes)?;
    Ok(Material::from_bytes(bytes)?)
}

fn stored(material: &Material<Vec<u8>>, view: usize) -> Stored {
    let lobes = (0..material.view_lobe_count()).filter_map(|k| material.view_lobe(view, k)).collect();
    Stored {
        theta: material.view_theta(view).unwrap_or_default(),
        log2_squeeze: material.view_log2_squeeze(view).unwrap_or_default(),
        log2_diffuse: material.view_log2_diffuse(view).unwrap_or(-126.0),
        diffuse_color_differences: material.view_diffuse_color_differences(view).unwrap_or_default(),
        lobes,
        albedo_difference: material.view_albedo_difference(view).unwrap_or_default(),
    }
}

/// Power of a lobe, with its part below the horizon.
fn power(lobe: &PlaneLobe) -> f64 {
    let sharpness = lobe.log2_sharpness.exp2();
    f64::from(lobe.log2_luminance.exp2() * srbf_core::special::sphere_integral(sharpness))
}

/// Drops the lobe with the least power until a mixture has at most a number.
fn drop_lobes(views: &mut [Stored], most: usize, squeezed: &mut usize, mirrored: &mut usize) {
    loop {
        let stored = views[0].lobes.len();
        if stored + *mirrored <= most || stored == 1 {
            return;
        }
        let twice = |k: usize| if k + *mirrored >= stored { 2.0 } else { 1.0 };
        let power = |k: usize| twice(k) * views.iter().map(|view| power(&view.lobes[k])).sum::<f64>();
        let least = (0..stored).min_by(|a, b| power(*a).total_cmp(&power(*b))).unwrap_or(0);
        for view in views.iter_mut() {
            view.lobes.remove(least);
        }
        if least < *squeezed {
            *squeezed -= 1;
        }
        if least + *mirrored >= stored {
            *mirrored -= 1;
        }
    }
}

/// Which views are kept: the first, the last, and those in between that leave the least to be told by their neighbours
/// (Bellman and Roth 1969, Curve fitting by segmented straight lines).
fn kept_views(views: &[Stored], count: usize) -> Vec<usize> {
    let last = views.len() - 1;
    if count > last {
        return (0..=last).collect();
    }
    let cost = |from: usize, to: usize| (from + 1..to).map(|view| missed(views, from, view, to)).sum::<f64>();
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

/// How much a view is missed between two others, in squared differences of the numbers of its lobes.
fn missed(views: &[Stored], from: usize, view: usize, to: usize) -> f64 {
    let (a, here, b) = (&views[from], &views[view], &views[to]);
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
            let squares = OF_ANGLE * sharpness.min(1e6) * off(a.angle, here.angle, b.angle)
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
