//! Patches of the hemisphere: rings, each of equal patches.

use crate::table::direction;
use std::f64::consts::{PI, TAU};

/// Points of a patch along each side, of equal projected solid angle.
const SIDE: usize = 8;

/// A ring of patches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Angle of the middle from the normal, radians.
    pub theta: f64,
    /// Ends of the ring, radians.
    pub ends: [f64; 2],
    /// Patches; the middle of the first is at the azimuth 0.
    pub count: usize,
}

/// The patches of a hemisphere, ring by ring from the normal.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    rings: Vec<Ring>,
    /// The first patch of each ring, and the number of all.
    first: Vec<usize>,
}

impl Basis {
    /// Most patches of a hemisphere.
    pub const MOST: usize = 2048;

    /// Makes it of rings, from the normal on; `None` where they overlap, leave a gap, or do not go from the normal to the horizon.
    pub fn new(rings: Vec<Ring>) -> Option<Self> {
        let touches = |a: f64, b: f64| (a - b).abs() < 1e-3;
        let is_ring =
            |r: &Ring| r.count > 0 && r.ends[0] < r.ends[1] && (r.ends[0]..=r.ends[1]).contains(&r.theta);
        let ends = [rings.first()?.ends[0], rings.last()?.ends[1]];
        let is_whole = touches(ends[0], 0.0) && touches(ends[1], 0.5 * PI);
        let is_tight = rings.windows(2).all(|pair| touches(pair[0].ends[1], pair[1].ends[0]));
        let mut first = vec![0usize];
        for ring in &rings {
            let next = first.last()?.checked_add(ring.count).filter(|n| *n <= Self::MOST)?;
            first.push(next);
        }
        (is_whole && is_tight && rings.iter().all(is_ring)).then_some(Self { rings, first })
    }

    /// The 145 patches of Klems (1994), LBNL/Klems Full.
    pub fn klems_full() -> Self {
        const RINGS: [(f64, f64, f64, usize); 9] = [
            (0.0, 0.0, 5.0, 1),
            (10.0, 5.0, 15.0, 8),
            (20.0, 15.0, 25.0, 16),
            (30.0, 25.0, 35.0, 20),
            (40.0, 35.0, 45.0, 24),
            (50.0, 45.0, 55.0, 24),
            (60.0, 55.0, 65.0, 24),
            (70.0, 65.0, 75.0, 16),
            (82.5, 75.0, 90.0, 12),
        ];
        let ring = |(theta, low, high, count): (f64, f64, f64, usize)| Ring {
            theta: theta.to_radians(),
            ends: [low.to_radians(), high.to_radians()],
            count,
        };
        let rings: Vec<Ring> = RINGS.into_iter().map(ring).collect();
        let first = rings.iter().scan(0, |sum, r| {
            *sum += r.count;
            Some(*sum)
        });
        Self { first: std::iter::once(0).chain(first).collect(), rings }
    }

    /// The rings.
    pub fn rings(&self) -> &[Ring] {
        &self.rings
    }

    /// The first patch of a ring, and how many it has.
    pub fn ring(&self, ring: usize) -> (usize, usize) {
        (self.first[ring], self.rings[ring].count)
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.first[self.rings.len()]
    }

    /// Whether there is no patch; never.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The ring of a patch, and its place there.
    fn place(&self, patch: usize) -> (usize, usize) {
        let ring = self.first.partition_point(|&first| first <= patch) - 1;
        (ring, patch - self.first[ring])
    }

    /// Azimuth of the middle of a patch, radians.
    fn azimuth(&self, patch: usize) -> f64 {
        let (ring, n) = self.place(patch);
        TAU * n as f64 / self.rings[ring].count as f64
    }

    /// The direction at the middle of a patch.
    pub fn middle(&self, patch: usize) -> [f64; 3] {
        direction(self.rings[self.place(patch).0].theta, self.azimuth(patch))
    }

    /// The incident direction of a patch of directions in which light travels.
    pub fn light(&self, patch: usize) -> [f64; 3] {
        let [x, y, z] = self.middle(patch);
        [-x, -y, z]
    }

    /// Projected solid angle of a patch, sr; pi in all.
    pub fn projected(&self, patch: usize) -> f64 {
        let ring = self.rings[self.place(patch).0];
        let [low, high] = ring.ends.map(|end| libm::sin(end).powi(2));
        PI * (high - low) / ring.count as f64
    }

    /// Directions within a patch, each of which stands for the same projected solid angle.
    pub fn points(&self, patch: usize) -> Vec<[f64; 3]> {
        self.spread(patch, SIDE)
    }

    /// The same, of `side` points along each side.
    pub(super) fn spread(&self, patch: usize, side: usize) -> Vec<[f64; 3]> {
        let ring = self.rings[self.place(patch).0];
        let [low, high] = ring.ends.map(|end| libm::sin(end).powi(2));
        let width = TAU / ring.count as f64;
        let middle = |n: usize| (n as f64 + 0.5) / side as f64;
        // A patch all round the normal has as many azimuths as its border needs.
        let around = if ring.count == 1 { 4 * side } else { side };
        let point = |i: usize, j: usize| {
            let theta = libm::asin(libm::sqrt(low + (high - low) * middle(i)).min(1.0));
            let turn = (j as f64 + 0.5) / around as f64 - 0.5;
            direction(theta, self.azimuth(patch) + width * turn)
        };
        (0..side).flat_map(|i| (0..around).map(move |j| (i, j))).map(|(i, j)| point(i, j)).collect()
    }

    /// The patch that holds a direction above the horizon.
    pub fn patch_of(&self, [x, y, z]: [f64; 3]) -> usize {
        let theta = libm::acos(z.clamp(-1.0, 1.0));
        let ring = self.rings.iter().position(|r| theta < r.ends[1]).unwrap_or(self.rings.len() - 1);
        let count = self.rings[ring].count;
        let turn = libm::atan2(y, x).rem_euclid(TAU) / TAU * count as f64;
        self.first[ring] + (libm::round(turn) as usize) % count
    }

    /// The patch at the opposite azimuth; `None` where there is none.
    pub fn opposite(&self, patch: usize) -> Option<usize> {
        let (ring, n) = self.place(patch);
        let count = self.rings[ring].count;
        (count == 1 || count.is_multiple_of(2)).then(|| self.first[ring] + (n + count / 2) % count)
    }

    /// Patches beside one, along and across its ring.
    pub fn beside(&self, patch: usize) -> Vec<usize> {
        let (ring, n) = self.place(patch);
        let count = self.rings[ring].count;
        let mut all = Vec::new();
        if count > 1 {
            all.extend([1, count - 1].map(|step| self.first[ring] + (n + step) % count));
        }
        for other in [ring.wrapping_sub(1), ring + 1] {
            let Some(r) = self.rings.get(other) else { continue };
            let overlaps = |m: &usize| {
                let turn = TAU * *m as f64 / r.count as f64 - self.azimuth(patch);
                let apart = (turn + PI).rem_euclid(TAU) - PI;
                apart.abs() < PI / r.count as f64 + PI / count as f64 - 1e-9
            };
            all.extend((0..r.count).filter(overlaps).map(|m| self.first[other] + m));
        }
        all
    }

    /// Rings on both sides of a direction, and their shares of a value there: linear in the angle, constant beyond the last ring.
    pub(super) fn rings_beside(&self, d: [f64; 3]) -> [(usize, f64); 2] {
        let theta = libm::acos(d[2].clamp(-1.0, 1.0));
        let after = self.rings.iter().position(|r| r.theta > theta).unwrap_or(self.rings.len() - 1);
        let before = after.saturating_sub(1);
        let [low, high] = [before, after].map(|n| self.rings[n].theta);
        let share = if high > low { ((theta - low) / (high - low)).clamp(0.0, 1.0) } else { 1.0 };
        [(before, 1.0 - share), (after, share)]
    }

    /// Middles of patches round a direction, and their shares of a value there: linear in both angles.
    pub fn nodes(&self, d: [f64; 3]) -> [(usize, f64); 4] {
        let azimuth = libm::atan2(d[1], d[0]).rem_euclid(TAU) / TAU;
        let on_ring = |(ring, share): (usize, f64)| {
            let count = self.rings[ring].count;
            let turn = azimuth * count as f64;
            let n = turn as usize % count;
            let between = turn - libm::floor(turn);
            let at = |n: usize| self.first[ring] + n % count;
            [(at(n), share * (1.0 - between)), (at(n + 1), share * between)]
        };
        let [[a, b], [c, d]] = self.rings_beside(d).map(on_ring);
        [a, b, c, d]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_tile_the_hemisphere() {
        let basis = Basis::klems_full();
        assert_eq!(basis.len(), 145);
        assert_eq!(Basis::new(basis.rings().to_vec()), Some(basis.clone()));
        let sum: f64 = (0..145).map(|n| basis.projected(n)).sum();
        assert!((sum - PI).abs() < 1e-12, "{sum}");
        for n in 0..145 {
            assert_eq!(basis.patch_of(basis.middle(n)), n);
            assert!(basis.points(n).iter().all(|p| basis.patch_of(*p) == n), "{n}");
            let opposite = basis.opposite(n).unwrap();
            assert_eq!(basis.opposite(opposite), Some(n));
            let [[a, b, c], [x, y, z]] = [basis.light(n), basis.middle(opposite)];
            assert!((a - x).abs() + (b - y).abs() + (c - z).abs() < 1e-12);
            assert!(basis.beside(n).iter().all(|m| basis.beside(*m).contains(&n)), "{n}");
        }
    }

    #[test]
    fn nodes_interpolate() {
        let basis = Basis::klems_full();
        for n in 0..145 {
            let own: f64 =
                basis.nodes(basis.middle(n)).iter().filter(|node| node.0 == n).map(|node| node.1).sum();
            assert!((own - 1.0).abs() < 1e-9, "{n}: {own}");
        }
        for d in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, -0.8, 0.6], [-1.0, 0.0, 0.0]] {
            let sum: f64 = basis.nodes(d).iter().map(|node| node.1).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{d:?}: {sum}");
        }
    }

    #[test]
    fn rings_that_do_not_tile_are_refused() {
        let rings = Basis::klems_full().rings().to_vec();
        for change in [
            (|rings| rings[3].count = 0) as fn(&mut Vec<Ring>),
            |rings| rings[3].ends[1] = 1.5,
            |rings| rings[3].theta = f64::NAN,
            |rings| rings[3].count = usize::MAX,
            |rings| rings[2].count = 5000,
            |rings| rings.truncate(4),
            |rings| rings.swap(3, 4),
            Vec::clear,
        ] {
            let mut other = rings.clone();
            change(&mut other);
            assert_eq!(Basis::new(other), None);
        }
    }
}
