//! Values that are means over patches of the hemisphere, as the matrices of daylight simulation have them, and a function between them.
//!
//! A patch is not a point: a value read as one at the middle of its patch is wrong wherever the function changes within a patch. So the
//! function is made such that its means over the patches are the values.
//!
//! A tensor tree has cells that are finer than patches, and is a function by itself.
//!
//! May import: `complete`, `table`.

mod basis;
mod of_patches;
mod scatter;
mod tree;

pub use basis::{Basis, Ring};
pub use of_patches::OfPatches;
pub use scatter::{Chroma, ColorTree, Scatter};
pub use tree::Tree;

/// The values of one quarter of a sheet.
///
/// Directions lie above the horizon: of one behind the sheet the height changes its sign. A value is the mean of f over a patch of outgoing
/// directions, by their projected solid angle. It is for one incident direction, at the middle of another patch.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchMatrix {
    /// Patches of outgoing directions.
    pub outgoing: Basis,
    /// Patches of the directions in which light travels, along the sheet: the azimuth of an incident direction is 180 degrees from that of
    /// its patch. So straight through, and the mirror direction, are patches of equal places.
    pub incident: Basis,
    /// `[outgoing][incident]`, 1/sr.
    pub values: Vec<f64>,
}

impl PatchMatrix {
    /// The values of a function, f of `(wi, wo)`, both above the horizon.
    pub fn of(outgoing: &Basis, incident: &Basis, f: impl Fn([f64; 3], [f64; 3]) -> f64) -> Self {
        Self::with(outgoing, incident, |r, c| {
            let (points, wi) = (outgoing.points(r), incident.light(c));
            let count = points.len() as f64;
            points.into_iter().map(|wo| f(wi, wo)).sum::<f64>() / count
        })
    }

    /// The values of a function over the patches of Klems, as [`of`](Self::of), of points of `side` along each side of a patch.
    fn of_klems(side: usize, f: impl Fn([f64; 3], [f64; 3]) -> f64) -> Self {
        let basis = Basis::klems_full();
        let points: Vec<_> = (0..basis.len()).map(|r| basis.spread(r, side)).collect();
        Self::with(&basis, &basis, |r, c| {
            let wi = basis.light(c);
            points[r].iter().map(|wo| f(wi, *wo)).sum::<f64>() / points[r].len() as f64
        })
    }

    /// All values times a factor.
    fn scale(&mut self, factor: f64) {
        self.values.iter_mut().for_each(|v| *v *= factor);
    }

    /// The values of a function at the middles of the patches.
    fn at_middles(outgoing: &Basis, incident: &Basis, f: impl Fn([f64; 3], [f64; 3]) -> f64) -> Self {
        Self::with(outgoing, incident, |r, c| f(incident.light(c), outgoing.middle(r)))
    }

    /// Values by the places of an outgoing and an incident patch.
    fn with(outgoing: &Basis, incident: &Basis, value: impl Fn(usize, usize) -> f64) -> Self {
        let places = (0..outgoing.len()).flat_map(|r| (0..incident.len()).map(move |c| (r, c)));
        let values = places.map(|(r, c)| value(r, c)).collect();
        Self { outgoing: outgoing.clone(), incident: incident.clone(), values }
    }

    /// A value.
    pub fn at(&self, outgoing: usize, incident: usize) -> f64 {
        self.values[outgoing * self.incident.len() + incident]
    }

    /// Share of the light of an incident patch that leaves the sheet in this quarter.
    pub fn sum(&self, incident: usize) -> f64 {
        (0..self.outgoing.len()).map(|r| self.at(r, incident) * self.outgoing.projected(r)).sum()
    }

    /// The same as the light goes the other way, which is the same function of reciprocal sheets; `None` where patches are not in pairs
    /// of opposite azimuths.
    pub fn reversed(&self) -> Option<Self> {
        let opposite =
            |basis: &Basis| (0..basis.len()).map(|n| basis.opposite(n)).collect::<Option<Vec<_>>>();
        let (to, from) = (opposite(&self.incident)?, opposite(&self.outgoing)?);
        let values = to.iter().flat_map(|&c| from.iter().map(move |&r| self.at(r, c))).collect();
        Some(Self { outgoing: self.incident.clone(), incident: self.outgoing.clone(), values })
    }

    /// Relative L2 distance from other values of the same patches, by the projected solid angles of both.
    pub fn distance(&self, other: &Self) -> f64 {
        let (mut apart, mut all) = (0.0, 0.0);
        for r in 0..self.outgoing.len() {
            for c in 0..self.incident.len() {
                let weight = self.outgoing.projected(r) * self.incident.projected(c);
                apart += weight * (self.at(r, c) - other.at(r, c)).powi(2);
                all += weight * other.at(r, c).powi(2);
            }
        }
        if all > 0.0 { libm::sqrt(apart / all) } else { 0.0 }
    }

    /// The mean with other values of the same patches.
    #[must_use]
    pub fn mean_with(&self, other: &Self) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| 0.5 * (a + b)).collect();
        Self { values, ..self.clone() }
    }

    /// Share of the light at the normal that goes straight on: within the patch of the incident direction.
    pub fn straight(&self) -> f64 {
        let all = self.sum(0);
        if all > 0.0 { self.at(0, 0) * self.outgoing.projected(0) / all } else { 0.0 }
    }
}
