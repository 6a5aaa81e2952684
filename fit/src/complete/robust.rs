//! Samples that their neighbours and their reciprocal samples contradict.
//!
//! One model and one process predict each sample from the others. The worst sample goes, and the rest is predicted again. Bright samples
//! near the peak have to be much brighter than their prediction, because neighbours say least about a peak.

use super::measurement::{Measured, Measurement};
use super::microfacet::{Family, Microfacet};
use super::points::{Point, each, grouped};
use super::process::{LeftOut, Of, Process};
use super::scale::Scale;
use super::tuning::choice::OF_MODEL;
use super::{noises, width};
use crate::complete::tuning::robust::{
    APART, APART_AT_PEAK, DEVIATIONS, KERNEL, KNOWN, LEAST, NEIGHBOURS, NOISE, OF_A_GROUP, PEAK, ROUNDS,
    SHARE,
};
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
        let is_at_peak = p.at[0] < PEAK && off > 0.0;
        off.abs() > if is_at_peak { APART_AT_PEAK } else { APART }
            && p.cosine * (said(0) + said(1) + said(2)).abs() / 3.0 > LEAST * measurement.level
    };
    let outlier = |s: &Measured, off: f64| Outlier { view: s.view, sample: s.number, ratio: libm::exp(off) };

    // Points that others speak against, with all of their samples.
    let score = |i: usize, left: &LeftOut| {
        let off = mean(left.above);
        let deviations = off.abs() / (libm::sqrt(left.variance) * left.usual.max(1.0));
        let is_known = left.variance < KNOWN * KERNEL.joint;
        let is_out = is_known && deviations > DEVIATIONS && is_apart(&points[i], off);
        (is_out && points[i].count < OF_A_GROUP as f64).then_some(deviations)
    };
    let gone: BTreeMap<usize, [f64; 3]> =
        process.spoken_against(points.len().div_ceil(SHARE), score).into_iter().collect();
    let mut found = Vec::new();
    for (s, point) in measurement.samples.iter().zip(&of) {
        found.extend(gone.get(point).map(|&above| outlier(s, mean(above))));
    }
    found.extend(
        in_groups(&all, &of, points.len(), is_apart)
            .into_iter()
            .map(|(i, off)| outlier(&measurement.samples[i], off)),
    );
    alone(measurement, &all, found)
}

/// Those of which most neighbours of the same view are not off as well.
fn alone(measurement: &Measurement, all: &[Point], found: Vec<Outlier>) -> Vec<Outlier> {
    let off: BTreeSet<(usize, usize)> = found.iter().map(|o| (o.view, o.sample)).collect();
    let is_alone = |o: &Outlier| {
        let of_view = || measurement.samples.iter().zip(all).filter(|(s, _)| s.view == o.view);
        let Some((_, own)) = of_view().find(|(s, _)| s.number == o.sample) else { return true };
        let mut near: Vec<(f64, bool)> = of_view()
            .filter(|(s, _)| s.number != o.sample)
            .map(|(s, p)| {
                let apart: f64 = p.at.iter().zip(own.at).map(|(a, b)| (a - b) * (a - b)).sum();
                (apart, off.contains(&(s.view, s.number)))
            })
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        2 * near.iter().take(NEIGHBOURS).filter(|n| n.1).count() < NEIGHBOURS
    };
    found.into_iter().filter(is_alone).collect()
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
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let mut off = Vec::new();
    for group in &members {
        let middle = median(group.iter().map(|&i| mean(i)).collect());
        off.extend(group.iter().map(|&i| (i, mean(i) - middle)));
    }
    if off.is_empty() {
        return off;
    }
    let usual = 1.4826 * median(off.iter().map(|o| o.1.abs()).collect());
    off.retain(|&(i, off)| off.abs() > DEVIATIONS * usual.max(libm::sqrt(NOISE)) && is_apart(&all[i], off));
    off
}
