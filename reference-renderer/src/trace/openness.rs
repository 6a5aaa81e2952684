//! Where surfaces see the light: a coarse grid over the scene, filled by a survey.

use glam::Vec3;

/// Cells along each side of the finest grid; coarser ones have half as many, down to one.
const SIDE: usize = 16;

/// Paths that a cell needs to be judged by itself; with fewer, it is as the coarser cell that it lies in.
const ENOUGH: f32 = 12.0;

/// Share of the light that both rays find, over the light that one of them finds: from there on sums are worth their time.
const LEAST_SHARE: f32 = 0.7;

/// The same on matte surfaces, where one even sample of the light alone has little error.
const LEAST_SHARE_OF_MATTE: f32 = 0.85;

/// The findings of one path of the survey.
pub struct SurveyedPath {
    pub point: Vec3,
    /// Luminance of the light that would be reflected without shadows.
    pub light: f32,
    /// The path's ray escapes, and the shadow ray does, or there is none.
    pub clear: [bool; 2],
}

/// Where both rays escape.
pub struct Openness {
    corner: Vec3,
    /// Cells over the length.
    scale: Vec3,
    /// Share of the light that both rays find, for each cell.
    shares: Vec<f32>,
}

/// Sums over the paths of a cell.
#[derive(Clone, Copy, Default)]
struct Tally {
    paths: f32,
    any: f32,
    both: f32,
}

impl Openness {
    /// The whole scene is open.
    pub fn everywhere() -> Self {
        Self { corner: Vec3::ZERO, scale: Vec3::ZERO, shares: vec![1.0; SIDE * SIDE * SIDE] }
    }

    /// Judges the cells; one that no path has met is closed.
    pub fn of(seen: &[SurveyedPath]) -> Self {
        let mut open = Self::everywhere();
        let Some(first) = seen.first() else {
            open.shares.fill(0.0);
            return open;
        };
        let (low, high) =
            seen.iter().fold((first.point, first.point), |(a, b), s| (a.min(s.point), b.max(s.point)));
        let extent = (high - low).max(Vec3::splat(1e-6));
        (open.corner, open.scale) = (low, SIDE as f32 / extent);
        // From coarse to fine: the verdict of a cell with too few paths stays that of the coarser one.
        let mut side = 1;
        while side <= SIDE {
            let mut cells = vec![Tally::default(); side * side * side];
            let coarse = |index: usize| {
                let [x, y, z] = [index % SIDE, index / SIDE % SIDE, index / (SIDE * SIDE)];
                let step = SIDE / side;
                (z / step * side + y / step) * side + x / step
            };
            for s in seen {
                let cell = &mut cells[coarse(open.index(s.point))];
                cell.paths += 1.0;
                cell.any += if s.clear[0] || s.clear[1] { s.light } else { 0.0 };
                cell.both += if s.clear[0] && s.clear[1] { s.light } else { 0.0 };
            }
            for index in 0..open.shares.len() {
                let cell = cells[coarse(index)];
                if cell.paths >= ENOUGH || side == 1 {
                    open.shares[index] = if cell.any > 0.0 { cell.both / cell.any } else { 0.0 };
                }
            }
            side *= 2;
        }
        open
    }

    /// The cell of a point; one outside is in the nearest.
    #[inline]
    fn index(&self, point: Vec3) -> usize {
        let [x, y, z] = ((point - self.corner) * self.scale).to_array().map(|v| (v as usize).min(SIDE - 1));
        (z * SIDE + y) * SIDE + x
    }

    /// Whether sums are worth their time anywhere.
    pub fn is_anywhere(&self) -> bool {
        self.shares.iter().any(|&share| share > LEAST_SHARE)
    }

    /// Whether sums are worth their time at a point, on a surface that is not matte.
    #[inline]
    pub fn is_at(&self, point: Vec3) -> bool {
        self.shares[self.index(point)] > LEAST_SHARE
    }

    /// The same on a matte surface.
    #[inline]
    pub fn is_at_matte(&self, point: Vec3) -> bool {
        self.shares[self.index(point)] > LEAST_SHARE_OF_MATTE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_judged_by_their_own_paths_and_by_coarser_ones_where_they_have_few() {
        let seen = |x: f32, clear: bool| SurveyedPath {
            point: Vec3::new(x, 0.0, 0.0),
            light: 1.0,
            clear: [clear, true],
        };
        // Open on the right, and in the mean; one path alone says nothing.
        let mut paths: Vec<SurveyedPath> = (0..30).map(|i| seen(i as f32 / 30.0, false)).collect();
        paths.extend((0..100).map(|i| seen(9.0 + i as f32 / 100.0, true)));
        paths.push(seen(7.0, false));
        let open = Openness::of(&paths);
        let at = |x: f32| open.is_at(Vec3::new(x, 0.0, 0.0));
        assert!(open.is_at_matte(Vec3::new(9.5, 0.0, 0.0)));
        assert!(!at(0.3) && !at(-100.0) && at(9.5) && at(7.0) && at(1e9));
        assert!(open.is_anywhere() && !Openness::of(&[]).is_anywhere());
        // 0.77 of the light: enough but for matte surfaces.
        let half = Openness::of(&(0..130).map(|i| seen(0.0, i >= 30)).collect::<Vec<_>>());
        assert!(half.is_at(Vec3::ZERO) && !half.is_at_matte(Vec3::ZERO));
        let hidden: Vec<SurveyedPath> = (0..100).map(|i| seen(i as f32, false)).collect();
        assert!(!Openness::of(&hidden).is_anywhere());
        // Light that neither ray finds does not speak for the sums.
        assert!(
            !Openness::of(&[SurveyedPath { clear: [false, false], ..seen(0.0, false) }]).is_at(Vec3::ZERO)
        );
    }
}
