//! The points of a Gaussian process: distances of the samples from a model, thinned where there are too many.

use super::measurement::{Measured, Measurement};
use super::microfacet::Microfacet;
use super::pair::COORDINATES;
use super::scale::Scale;
use crate::complete::tuning::points::{BANDS, FINEST, MOST, STEPS};
use std::collections::BTreeMap;

/// One sample, or the mean of close ones.
#[derive(Clone, Debug, Default)]
pub(super) struct Point {
    pub at: [f64; COORDINATES],
    /// The model on the scale.
    pub base: [f64; 3],
    /// How far the sample is above it.
    pub above: [f64; 3],
    /// Samples that it is the mean of.
    pub count: f64,
    /// How freely the channels may be apart there, 0 to 1: a coat has no hue.
    pub hue: f64,
    /// The smaller cosine of both directions: light falls, and is seen, more thinly towards grazing.
    pub cosine: f64,
    /// As of a sample.
    pub relative: f64,
    pub even: f64,
    pub band: usize,
}

/// The points of samples over a model; `width`: of the coordinates.
pub(super) fn points(measurement: &Measurement, model: &Microfacet, scale: Scale, width: f64) -> Vec<Point> {
    grouped(each(measurement, model, scale, width)).0
}

/// A point for each sample.
pub(super) fn each(measurement: &Measurement, model: &Microfacet, scale: Scale, width: f64) -> Vec<Point> {
    let wide = measurement.parts.div_ceil(BANDS);
    let point = |s: &Measured| {
        let base = model.value(&s.pair).map(|v| scale.to(v));
        let above = [0, 1, 2].map(|c| scale.to(s.value[c]) - base[c]);
        let (at, band) = (s.pair.coordinates(width), s.part / wide);
        Point {
            at,
            base,
            above,
            count: 1.0,
            hue: model.hue(&s.pair),
            cosine: s.pair.cosines[0].min(s.pair.cosines[1]),
            relative: s.relative,
            even: s.even,
            band,
        }
    };
    measurement.samples.iter().map(point).collect()
}

/// At most [`MOST`] points, and for each that there was the one that it is part of.
pub(super) fn grouped(all: Vec<Point>) -> (Vec<Point>, Vec<usize>) {
    if all.len() <= MOST {
        let own = (0..all.len()).collect();
        return (all, own);
    }
    let mut cell = FINEST;
    let mut found = merged(&all, cell);
    for _ in 0..STEPS {
        if found.0.len() <= MOST {
            break;
        }
        cell *= 1.19;
        found = merged(&all, cell);
    }
    found
}

/// Points of one band whose coordinates are in one cell, as their mean; and for each the number of its cell.
fn merged(all: &[Point], cell: f64) -> (Vec<Point>, Vec<usize>) {
    let mut cells: BTreeMap<(usize, [i64; COORDINATES]), usize> = BTreeMap::new();
    let mut sums: Vec<Point> = Vec::new();
    let mut of = Vec::with_capacity(all.len());
    for p in all {
        let key = (p.band, p.at.map(|v| (v / cell) as i64));
        let number = *cells.entry(key).or_insert_with(|| {
            sums.push(Point { band: p.band, ..Point::default() });
            sums.len() - 1
        });
        let sum = &mut sums[number];
        (0..COORDINATES).for_each(|k| sum.at[k] += p.at[k]);
        (0..3).for_each(|c| sum.base[c] += p.base[c]);
        (0..3).for_each(|c| sum.above[c] += p.above[c]);
        sum.count += p.count;
        sum.hue += p.hue;
        sum.cosine += p.cosine;
        sum.relative += p.relative;
        sum.even += p.even;
        of.push(number);
    }
    for sum in &mut sums {
        let count = sum.count;
        sum.at = sum.at.map(|v| v / count);
        sum.hue /= count;
        sum.cosine /= count;
        sum.base = sum.base.map(|v| v / count);
        sum.above = sum.above.map(|v| v / count);
    }
    (sums, of)
}
