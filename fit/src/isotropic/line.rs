//! Where the stored views of an isotropic fit stand: at angles of the outgoing direction, along one line.
//!
//! A view sees the two stored views round it, and roughness three in a row. So the matrix is a band two stored views wide.

use crate::FitError;
use crate::family::factors::Factors;
use crate::family::layout::{Layout as Family, Views};
use crate::family::matrix::{Block, Matrix};
use crate::family::objective::{self, Emphasis};
use crate::family::tuning::layout::LN_AMPLITUDE;
use crate::family::unit::{Axis, Unit, ViewSqueeze};
use crate::isotropic::tuning::objective::{DEFENSIVE, DEFENSIVE_DIFFUSE, HOLD, WATCHED};
use crate::isotropic::tuning::parameters::{
    ANGLE, ANGLE_DEFENSIVE, LN_SHARPNESS_DEFENSIVE, LN_SQUEEZE, OFF_PLANE,
};
use crate::isotropic::tuning::solver::LONGEST_STEP;
use crate::isotropic::tuning::stored_views::NEAR_NORMAL;
use crate::numeric::banded::Banded;
use crate::numeric::special::sphere_integral;
use crate::table::{ALBEDO_LIMIT, Table, View, luminance};

/// The stored views.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Line {
    /// Angles of the stored views in radians, from 0 rising to at most pi / 2.
    pub angles: Vec<f64>,
    /// Whether the last lobe in the plane of incidence is kept wide, so that no direction has a small density.
    pub is_last_wide: bool,
}

/// The unknowns. Lobes with an angle out of the plane of incidence stand for two, one on either side of it.
pub(crate) type Layout = Family<Line>;
/// The sum of squares.
pub(crate) type Objective = objective::Objective<Line>;

/// The stored view before an angle of the outgoing direction, and how far towards the next one it lies, 0 to 1.
pub(crate) type LinePlace = (usize, f64);

impl Views for Line {
    type Place = LinePlace;
    type Matrix = Band;

    const SQUEEZE: &'static [(f64, f64)] = &[LN_SQUEEZE];
    const ANGLE: (f64, f64) = ANGLE;
    const OFF_PLANE: (f64, f64) = OFF_PLANE;
    const COPIES: f64 = 2.0;
    const LONGEST_STEP: f64 = LONGEST_STEP;

    fn count(&self) -> usize {
        self.angles.len()
    }

    fn theta(&self, (stored, blend): LinePlace) -> f64 {
        let after = self.angles[(stored + 1).min(self.angles.len() - 1)];
        self.angles[stored] + blend * (after - self.angles[stored])
    }

    /// At the normal every axis is the normal and nothing is squeezed.
    fn fixed(layout: &Layout, stored: usize, index: usize) -> bool {
        stored == 0 && index < layout.angles().end
    }

    /// The defensive lobe stays wide, and has a share of the albedo; without one, the diffuse term has it.
    fn narrow(layout: &Layout, table: &[(LinePlace, &View)], bounds: &mut [(f64, f64)]) {
        let brightest = table.iter().flat_map(|(_, v)| v.albedo).fold(0.0, f64::max);
        let albedo = |theta: f64| {
            let far = |v: &View| (v.theta - theta).abs();
            let nearest = table.iter().min_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)));
            nearest.map_or([0.0; 3], |(_, v)| v.albedo)
        };
        let integral = sphere_integral(LN_SHARPNESS_DEFENSIVE.1).0;
        for (bounds, &theta) in bounds.chunks_exact_mut(layout.stride()).zip(&layout.views.angles) {
            // A share of the largest albedo that a fit may have, because the table's own may be any number.
            let share = DEFENSIVE * luminance(albedo(theta)).max(1e-9 * brightest).min(ALBEDO_LIMIT);
            let least = libm::log(share / integral);
            let (unknown, least) = match layout.defensive() {
                Some(lobe) => {
                    let angle = &mut bounds[layout.angle(lobe)];
                    // The first stored view, where angles are given, has no angle to bound.
                    if *angle != (0.0, 0.0) {
                        *angle = ANGLE_DEFENSIVE;
                    }
                    bounds[layout.sharpness(lobe)] = LN_SHARPNESS_DEFENSIVE;
                    (layout.luminance(lobe), least)
                }
                None => (layout.diffuse(), least + libm::log(integral * DEFENSIVE_DIFFUSE / DEFENSIVE)),
            };
            bounds[unknown].0 = bounds[unknown].0.max(least);
        }
    }

    /// That of a diffuse surface.
    fn tail_floor(cos: f64) -> f64 {
        2.0 * cos
    }

    /// At the stored views and between them.
    fn watched(&self) -> Vec<LinePlace> {
        let last = self.angles.len() - 1;
        let between = |stored: usize| (0..WATCHED).map(move |i| (stored, i as f64 / WATCHED as f64));
        let mut watched: Vec<LinePlace> = (0..last).flat_map(between).collect();
        watched.push((last - usize::from(last > 0), if last > 0 { 1.0 } else { 0.0 }));
        watched
    }

    /// Linearly in the angle.
    fn interpolate(layout: &Layout, x: &[f64], (stored, blend): LinePlace, out: &mut [f64]) {
        let p = layout.stride();
        let before = &x[stored * p..(stored + 1) * p];
        if blend == 0.0 {
            out.copy_from_slice(before);
            return;
        }
        let after = &x[(stored + 1) * p..(stored + 2) * p];
        for (out, (a, b)) in out.iter_mut().zip(before.iter().zip(after)) {
            *out = a + blend * (b - a);
        }
    }

    /// Second differences, with the symmetry at the normal (angles are odd in theta, the rest even); and a weak pull towards no change
    /// in the last interval, which Cornell's data do not reach.
    fn differences(layout: &Layout, smoothness: f64, mut each: impl FnMut(&[(usize, f64)])) {
        let view_angles = &layout.views.angles;
        let (p, last) = (layout.stride(), view_angles.len() - 1);
        if last == 0 || smoothness == 0.0 {
            return;
        }
        let first = layout.first_smooth();
        let mean = view_angles[last] / last as f64;
        let per_interval: Vec<f64> = view_angles.windows(2).map(|w| mean / (w[1] - w[0])).collect();
        for index in 0..p {
            let weight = libm::sqrt(smoothness / ((last as f64) * p as f64)) / layout.unit(index);
            if !layout.angles().contains(&index) {
                let d = 2.0 * weight * per_interval[first];
                each(&[(first * p + index, -d), ((first + 1) * p + index, d)]);
            }
            for k in first + 1..last {
                let (a, b) = (weight * per_interval[k - 1], weight * per_interval[k]);
                each(&[((k - 1) * p + index, a), (k * p + index, -a - b), ((k + 1) * p + index, b)]);
            }
            let d = HOLD * weight * per_interval[last - 1];
            each(&[((last - 1) * p + index, -d), (last * p + index, d)]);
        }
    }

    /// By `1 / c` across the plane of incidence.
    fn squeeze(q: &[f64]) -> ViewSqueeze {
        let inverse = libm::exp(-q[0]);
        ViewSqueeze { matrix: [1.0, 0.0, inverse], determinant: inverse, growth: None }
    }

    fn stretch(q: &[f64]) -> [f64; 3] {
        [1.0, 0.0, libm::exp(q[0])]
    }

    /// The axes are `(sin a, 0, cos a)` and its mirror image in the horizon. A lobe that stands for two has the four axes
    /// `(sin a cos b, +-sin b, +-cos a cos b)`, and is not squeezed.
    fn unit(layout: &Layout, q: &[f64], k: usize, _: &ViewSqueeze) -> Unit {
        let off_plane = k.checked_sub(layout.first_aside()).map(|m| q[layout.off_plane(m)]);
        let (sin, cos) = libm::sincos(q[layout.angle(k)]);
        let (sin_b, cos_b) = libm::sincos(off_plane.unwrap_or(0.0));
        let axis = |side: f64, up: f64| Axis {
            at: [sin * cos_b, side * sin_b, up * cos * cos_b],
            by_angle: [cos * cos_b, 0.0, -up * sin * cos_b],
            by_off_plane: [-sin * sin_b, side * cos_b, -up * cos * sin_b],
            by_squeeze: [[0.0; 3]; 3],
        };
        let axes = [axis(1.0, 1.0), axis(1.0, -1.0), axis(-1.0, 1.0), axis(-1.0, -1.0)];
        let sharpness = libm::exp(q[layout.sharpness(k)]);
        Unit { sharpness, axes, count: if off_plane.is_some() { 4 } else { 2 } }
    }

    fn frame(layout: &Layout, q: &[f64], k: usize) -> [[f64; 3]; 3] {
        let (sin_a, cos_a) = libm::sincos(q[layout.angle(k)]);
        let off_plane = k.checked_sub(layout.first_aside());
        let (sin_b, cos_b) = libm::sincos(off_plane.map_or(0.0, |m| q[layout.off_plane(m)]));
        let axis = [sin_a * cos_b, sin_b, cos_a * cos_b];
        [axis, [cos_a, 0.0, -sin_a], [-sin_a * sin_b, cos_b, -cos_a * sin_b]]
    }
}

impl Layout {
    /// A layout of `lobes` lobes, of which `squeezed` are squeezed and `mirrored` stand for two. One is kept wide if two or more in
    /// the plane of incidence are round.
    pub fn new(lobes: usize, squeezed: usize, mirrored: usize, angles: Vec<f64>) -> Self {
        let is_last_wide = lobes - mirrored >= squeezed + 2;
        Self { lobes, squeezed, aside: mirrored, views: Line { angles, is_last_wide } }
    }

    /// The same lobes at other stored views.
    pub fn at(&self, angles: Vec<f64>) -> Self {
        Self { views: Line { angles, ..self.views }, ..*self }
    }

    /// The stored view from which on unknowns change slowly: not the normal itself, if the next is close to it.
    fn first_smooth(&self) -> usize {
        let angles = &self.views.angles;
        let is_close = angles.len() > 2 && angles[1] < 1.5 * NEAR_NORMAL.to_radians();
        usize::from(is_close)
    }

    /// The lobe that is kept wide.
    pub fn defensive(&self) -> Option<usize> {
        self.views.is_last_wide.then(|| self.first_aside() - 1)
    }

    /// The layout and unknowns with a squeezed lobe given up for a wide and weak one, unless there is one that is kept wide.
    pub fn widened(&self, x: &[f64], given_up: usize) -> Option<(Self, Vec<f64>)> {
        if self.views.is_last_wide || given_up >= self.squeezed {
            return None;
        }
        let views = Line { is_last_wide: true, ..self.views.clone() };
        let new = Self { squeezed: self.squeezed - 1, views, ..*self };
        let wide = new.first_aside() - 1;
        let mut moved = x.to_vec();
        for q in moved.chunks_exact_mut(self.stride()) {
            let rows =
                [self.angle(0), self.sharpness(0), self.luminance(0), self.color(0, 0), self.color(1, 0)];
            for first in rows {
                q[first + given_up..=first + wide].rotate_left(1);
            }
            q[self.angle(wide)] = 0.0;
            q[self.sharpness(wide)] = LN_SHARPNESS_DEFENSIVE.1;
            let [luminance, red, blue] = self.tint(wide);
            (q[luminance], q[red], q[blue]) = (LN_AMPLITUDE.0, 0.0, 0.0);
        }
        Some((new, moved))
    }

    /// Where an angle of the outgoing direction lies.
    pub fn place(&self, theta: f64) -> LinePlace {
        let angles = &self.views.angles;
        let last = angles.len() - 1;
        if last == 0 {
            return (0, 0.0);
        }
        let after = angles.partition_point(|&k| k <= theta).clamp(1, last);
        let (from, to) = (angles[after - 1], angles[after]);
        (after - 1, ((theta - from) / (to - from)).clamp(0.0, 1.0))
    }

    /// The unknowns at the stored views of another layout of the same lobes.
    pub fn resampled(&self, x: &[f64], other: &Self) -> Vec<f64> {
        let mut new = vec![0.0; other.len()];
        for (q, theta) in new.chunks_exact_mut(other.stride()).zip(&other.views.angles) {
            self.interpolate(x, self.place(*theta), q);
        }
        new
    }
}

impl Objective {
    /// The sum of squares over a table. `factors`: the table that multiplies the lobes.
    pub fn new(
        table: &Table,
        layout: Layout,
        emphasis: Emphasis,
        factors: Option<&Factors>,
    ) -> Result<Self, FitError> {
        let placed: Vec<_> = table.views.iter().map(|view| (layout.place(view.theta), view)).collect();
        Self::over(&placed, layout, emphasis, factors)
    }
}

/// The matrix of a step.
pub(crate) struct Band {
    matrix: Banded,
    /// Diagonal of the matrix without the albedo terms, to which damping is relative: those terms are stiff in one direction
    /// and must not hold up the others.
    scale: Vec<f64>,
    /// Room for the matrix with damping, from the first step on. Matrices of 64 lobes have 28 MB each, and an allocator that gets
    /// and gives them at every step keeps some times as much.
    damped: Option<Banded>,
}

impl Matrix<Layout, LinePlace> for Band {
    fn zeros(layout: &Layout) -> Self {
        let (unknowns, p) = (layout.len(), layout.stride());
        let matrix = Banded::zeros(unknowns, (2 * p).min(unknowns - 1));
        Self { matrix, scale: vec![0.0; unknowns], damped: None }
    }

    fn cleared(mut self, _: &Layout) -> Self {
        self.scale.fill(0.0);
        self.matrix.clear();
        self
    }

    fn add_view(&mut self, layout: &Layout, block: &Block<LinePlace>, gradient: &mut [f64]) {
        let p = layout.stride();
        let (stored, blend) = block.place;
        let ends = [(stored, 1.0 - blend), (stored + 1, blend)];
        for (a, (stored_a, share_a)) in ends.into_iter().enumerate().filter(|e| e.1.1 > 0.0) {
            for i in 0..p {
                gradient[stored_a * p + i] += share_a * block.gradient[i];
                self.scale[stored_a * p + i] += share_a * share_a * block.scale[i];
            }
            for (stored_b, share_b) in ends.into_iter().take(a + 1).filter(|e| e.1 > 0.0) {
                self.matrix.add_block(stored_a * p, stored_b * p, share_a * share_b, &block.matrix, p);
            }
        }
    }

    fn add_row(&mut self, terms: &[(usize, f64)]) {
        for (a, &(i, fi)) in terms.iter().enumerate() {
            self.scale[i] += fi * fi;
            for &(j, fj) in &terms[..=a] {
                self.matrix.add(i, j, fi * fj);
            }
        }
    }

    fn scale(&self) -> Vec<f64> {
        self.scale.clone()
    }

    /// By factoring the band.
    fn step(&mut self, added: &[f64], free: &[bool], mut step: Vec<f64>) -> Option<Vec<f64>> {
        let matrix = match &mut self.damped {
            Some(room) => {
                room.clone_from(&self.matrix);
                room
            }
            none => none.insert(self.matrix.clone()),
        };
        for i in 0..step.len() {
            if free[i] {
                matrix.add(i, i, added[i]);
            } else {
                matrix.isolate(i);
                step[i] = 0.0;
            }
        }
        matrix.factor().then(|| {
            matrix.solve(&mut step);
            step
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn places_are_between_their_stored_views() {
        let layout = Layout::new(1, 0, 0, vec![0.0, 0.5, FRAC_PI_2]);
        assert_eq!(layout.place(0.0), (0, 0.0));
        assert_eq!(layout.place(0.25), (0, 0.5));
        assert_eq!(layout.place(0.5), (1, 0.0));
        assert_eq!(layout.place(2.0), (1, 1.0));
    }

    #[test]
    fn a_squeezed_lobe_makes_room_for_a_wide_one() {
        let layout = |lobes, squeezed, mirrored| Layout::new(lobes, squeezed, mirrored, vec![0.0, 1.0]);
        let old = layout(5, 3, 1);
        let x: Vec<f64> = (0..old.len()).map(|i| i as f64).collect();
        let (new, moved) = old.widened(&x, 1).unwrap();
        assert!(old.defensive().is_none() && new == layout(5, 2, 1) && new.defensive() == Some(3));
        let p = old.stride();
        for (from, to) in [(0, 0), (2, 1), (3, 2), (4, 4)] {
            assert_eq!(moved[p + new.angle(to)], x[p + old.angle(from)]);
            assert_eq!(moved[p + new.sharpness(to)], x[p + old.sharpness(from)]);
            assert_eq!(moved[p + new.color(1, to)], x[p + old.color(1, from)]);
        }
        assert_eq!((moved[p + new.angle(3)], moved[p + new.sharpness(3)]), (0.0, 1.0));
        assert_eq!((moved[p], moved[p + new.off_plane(0)]), (x[p], x[p + old.off_plane(0)]));
        // None is left in the plane but the wide one.
        let lonely = layout(2, 1, 1);
        let (new, _) = lonely.widened(&vec![0.0; lonely.len()], 0).unwrap();
        assert!(lonely.defensive().is_none() && new.squeezed == 0 && new.defensive() == Some(0));
        assert!(layout(4, 1, 0).widened(&[], 0).is_none() && layout(4, 0, 4).widened(&[], 0).is_none());
    }

    #[test]
    fn at_other_views_the_unknowns_are_interpolated() {
        let layout = |view_angles| Layout::new(1, 0, 0, view_angles);
        let (old, new) = (layout(vec![0.0, 0.4, 1.0]), layout(vec![0.0, 0.2, 0.7, 1.0]));
        let x: Vec<f64> = (0..old.len()).map(|i| (i * i) as f64).collect();
        let at = |x: &[f64], stored: usize, index: usize| x[stored * old.stride() + index];
        let found = old.resampled(&x, &new);
        for i in 0..old.stride() {
            let between = |stored: usize| 0.5 * (at(&x, stored, i) + at(&x, stored + 1, i));
            let expected = [at(&x, 0, i), between(0), between(1), at(&x, 2, i)];
            for (stored, value) in expected.into_iter().enumerate() {
                assert!((at(&found, stored, i) - value).abs() < 1e-9, "{stored} {i}: {found:?}");
            }
        }
    }
}
