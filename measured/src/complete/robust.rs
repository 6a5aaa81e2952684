//! Samples that their neighbours and their reciprocal samples contradict.
//!
//! One model and one process predict each sample from the others. The worst sample goes, and the rest is predicted again. Samples near the
//! peak or the back direction have to be much farther off, because neighbours say least about a peak. Samples that are off together stay,
//! but for dead ones: the shadow of a lamp or a detector covers several.
//!
//! Where the neighbours of a sample are predicted badly too, the fault may be of the prediction. Such a sample is left out as well, as it
//! would bend the process, but it is not called wrong.

use super::measurement::{Measured, Measurement};
use super::microfacet::{Family, Microfacet};
use super::pair::COORDINATES;
use super::points::{Point, each, grouped};
use super::process::{LeftOut, Of, Process, SpokenAgainst};
use super::scale::Scale;
use super::tuning::choice::OF_MODEL;
use super::{noises, width};
use crate::complete::tuning::robust::{
    APART, APART_AT_PEAK, AROUND, BACK, BEYOND, DEAD, DEVIATIONS, KERNEL, KNOWN, LEAST, NEIGHBOURS, NOISE,
    OF_A_GROUP, OVER_NEIGHBOURS, PEAK, ROUNDS, SHARE, THIN, THIN_DARK,
};
use crate::numeric::median::median;
use std::collections::{BTreeMap, BTreeSet};

/// A sample that all others contradict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// Number of its view.
    pub view: usize,
    /// Which of the samples of that view it is.
    pub sample: usize,
    /// Luminance over the prediction by the others.
    pub ratio: f64,
    /// Whether the sample is wrong: its neighbours are predicted well, and none is close to it. Otherwise the prediction may be.
    pub is_wrong: bool,
}

/// Finds them, and leaves them out.
pub(super) fn without_outliers(mut measurement: Measurement) -> (Measurement, Vec<Outlier>) {
    let mut outliers = Vec::new();
    for _ in 0..ROUNDS {
        let found = look(&measurement);
        if found.is_empty() {
            break;
        }
        let gone: BTreeSet<(usize, usize)> = found.iter().map(|o| (o.view, o.sample)).collect();
        let rest = measurement.only(|s| !gone.contains(&(s.view, s.number)));
        // One bright sample among black ones is a mirror that was met once, not a fault.
        if rest.is_black() {
            break;
        }
        outliers.extend(found);
        measurement = rest;
    }
    outliers.sort_by_key(|o| (o.view, o.sample));
    (measurement, outliers)
}

fn look(measurement: &Measurement) -> Vec<Outlier> {
    let scale = Scale::of(measurement);
    let few = measurement.thinned(OF_MODEL);
    let Some((_, model)) = Microfacet::fits(&few, scale, Family::OneLobe).into_iter().next() else {
        return Vec::new();
    };
    let all = each(measurement, &model, scale, width(&model));
    let (points, of) = grouped(all.clone());
    let Some(process) = Process::new(&points, KERNEL, &noises(&points, NOISE), Of::Values) else {
        return Vec::new();
    };
    let mean = |above: [f64; 3]| above.iter().sum::<f64>() / 3.0;
    let is_apart = |p: &Point, off: f64| {
        let said = |c: usize| scale.back(p.base[c] + p.above[c] - off) - scale.back(p.base[c] + p.above[c]);
        let is_at_peak = p.at[0] < PEAK || p.at[1] < BACK;
        let thin = if off < 0.0 && !is_dead(off) { THIN_DARK } else { THIN };
        let share = (p.cosine / thin).min(1.0);
        off.abs() > if is_at_peak { APART_AT_PEAK } else { APART }
            && share * (said(0) + said(1) + said(2)).abs() / 3.0 > LEAST * measurement.level
    };
    let outlier = |s: &Measured, off: f64, is_wrong: bool| Outlier {
        view: s.view,
        sample: s.number,
        ratio: libm::exp(off),
        is_wrong,
    };

    // Points that others speak against, with all of their samples.
    let score = |i: usize, left: &LeftOut| {
        let off = mean(left.above);
        let deviations = off.abs() / (libm::sqrt(left.variance) * left.usual.max(1.0));
        let is_known = left.variance < KNOWN * KERNEL.joint;
        let is_out = is_known && deviations > DEVIATIONS && is_apart(&points[i], off);
        (is_out && points[i].count < OF_A_GROUP as f64).then_some(deviations)
    };
    let SpokenAgainst { gone, rest } = process.spoken_against(points.len().div_ceil(SHARE), score);
    let gone: BTreeMap<usize, (f64, bool)> = gone
        .into_iter()
        .map(|(i, above)| {
            let off = mean(above);
            (i, (off, off.abs() > OVER_NEIGHBOURS * usual_around(&points, &rest, i)))
        })
        .collect();
    let mut found = Vec::new();
    for (s, point) in measurement.samples.iter().zip(&of) {
        found.extend(gone.get(point).map(|&(off, is_wrong)| outlier(s, off, is_wrong)));
    }
    found.extend(
        in_groups(&all, &of, points.len(), is_apart)
            .into_iter()
            .map(|(i, off)| outlier(&measurement.samples[i], off, true)),
    );
    alone(measurement, scale, &all, found)
}

/// How far the points around one that is gone are from their predictions: the second largest of such distances.
fn usual_around(points: &[Point], rest: &[Option<f64>], of: usize) -> f64 {
    let own = &points[of];
    let around = points.iter().zip(rest).filter_map(|(p, off)| Some((apart(p, own), off.as_ref()?.abs())));
    let mut off = nearest(around, AROUND);
    off.sort_by(|a, b| b.total_cmp(a));
    off.get(1).copied().unwrap_or(0.0)
}

/// Squared distance of two points for the process.
fn apart(a: &Point, b: &Point) -> f64 {
    (0..COORDINATES).map(|k| ((a.at[k] - b.at[k]) / KERNEL.lengths[k]).powi(2)).sum()
}

/// The numbers of the nearest ones, of distances and numbers.
fn nearest(all: impl Iterator<Item = (f64, f64)>, most: usize) -> Vec<f64> {
    let mut near: Vec<(f64, f64)> = all.collect();
    if near.len() > most {
        near.select_nth_unstable_by(most, |a, b| a.0.total_cmp(&b.0));
    }
    near.into_iter().take(most).map(|n| n.1).collect()
}

/// Whether a sample is so much darker than others say that something stood before it.
fn is_dead(off: f64) -> bool {
    off < -DEAD
}

/// Those that stand out of their neighbours, and of which most neighbours of the same view are not off as well; and dead ones.
fn alone(measurement: &Measurement, scale: Scale, all: &[Point], found: Vec<Outlier>) -> Vec<Outlier> {
    let off: BTreeSet<(usize, usize)> = found.iter().map(|o| (o.view, o.sample)).collect();
    let samples = || measurement.samples.iter().zip(all);
    let alone = |mut o: Outlier| {
        let over = libm::log(o.ratio);
        if is_dead(over) {
            return Some(o);
        }
        let Some((s, own)) = samples().find(|(s, _)| (s.view, s.number) == (o.view, o.sample)) else {
            return Some(o);
        };
        let others = || samples().filter(|(other, _)| (other.view, other.number) != (o.view, o.sample));
        let same_view = others().filter(|(other, _)| other.view == o.view);
        let of_view = nearest(
            same_view.map(|(other, p)| {
                (apart(p, own), f64::from(u8::from(off.contains(&(other.view, other.number)))))
            }),
            NEIGHBOURS,
        );
        // A steep flank has brighter samples on one side and darker ones on the other.
        let mut levels = nearest(others().map(|(other, p)| (apart(p, own), level(other))), NEIGHBOURS);
        levels.sort_by(f64::total_cmp);
        if levels.len() > 2 {
            let (low, high) = (levels[1], levels[levels.len() - 2]);
            if low < level(s) && level(s) < high {
                return None;
            }
            // Neighbours that are nearly as bright, or nearly as dark, do not contradict it.
            let beyond = scale.to(level(s) / 3.0) - scale.to(if over > 0.0 { high } else { low } / 3.0);
            o.is_wrong &= beyond * over.signum() > BEYOND * over.abs();
        }
        (2.0 * of_view.iter().sum::<f64>() < NEIGHBOURS as f64).then_some(o)
    };
    found.into_iter().filter_map(alone).collect()
}

fn level(s: &Measured) -> f64 {
    s.value.iter().sum()
}

/// Samples that are off the median of those that they are taken together with.
fn in_groups(
    all: &[Point],
    of: &[usize],
    groups: usize,
    is_apart: impl Fn(&Point, f64) -> bool,
) -> Vec<(usize, f64)> {
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); groups];
    of.iter().enumerate().for_each(|(i, &group)| members[group].push(i));
    members.retain(|group| group.len() >= OF_A_GROUP);
    let mean = |i: usize| all[i].above.iter().sum::<f64>() / 3.0;
    let mut off = Vec::new();
    for group in &members {
        let Some(middle) = median(group.iter().map(|&i| mean(i)).collect()) else { continue };
        let Some(spread) = median(group.iter().map(|&i| (mean(i) - middle).abs()).collect()) else {
            continue;
        };
        off.extend(group.iter().map(|&i| (i, mean(i) - middle, 1.4826 * spread)));
    }
    let Some(spread) = median(off.iter().map(|o: &(usize, f64, f64)| o.1.abs()).collect()) else {
        return Vec::new();
    };
    let usual = 1.4826 * spread;
    let is_out = |&(i, off, own): &(usize, f64, f64)| {
        off.abs() > DEVIATIONS * usual.max(own).max(libm::sqrt(NOISE)) && is_apart(&all[i], off)
    };
    off.into_iter().filter(is_out).map(|(i, off, _)| (i, off)).collect()
}
