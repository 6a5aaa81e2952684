//! A quarter of a sheet in the form of its file, matrices or tensor trees, with its means over patches.

use super::{OfPatches, PatchMatrix, Tree};
use crate::complete::color;
use crate::table::{Brdf, Symmetry, luminance};
use std::f64::consts::FRAC_PI_4;
use std::sync::Arc;

/// Turns over which values of an isotropic tree of four dimensions are averaged, within a quarter of a turn.
const TURNS: usize = 4;

/// The colours beside the luminance.
#[derive(Clone, Debug)]
pub enum Chroma<T> {
    /// None: the sheet is grey.
    Grey,
    /// X and Z over those of white, by CIE 1931.
    Xz([T; 2]),
    /// u' and v' by CIE 1976, of white at equal energy.
    Uv([T; 2]),
}

impl<T> Chroma<T> {
    /// The same of other values; grey where there are none.
    pub fn map<U>(self, other: impl Fn(T) -> Option<U>) -> Chroma<U> {
        match self {
            Self::Grey => Chroma::Grey,
            Self::Xz([x, z]) => other(x).zip(other(z)).map_or(Chroma::Grey, |(x, z)| Chroma::Xz([x, z])),
            Self::Uv([u, v]) => other(u).zip(other(v)).map_or(Chroma::Grey, |(u, v)| Chroma::Uv([u, v])),
        }
    }
}

/// X and Z over those of white, of a luminance, u' and v'; grey where v' is nothing.
fn xz(y: f64, u: f64, v: f64) -> [f64; 2] {
    if v <= 0.0 {
        return [y; 2];
    }
    [9.0 * u, 12.0 - 3.0 * u - 20.0 * v].map(|part| (y * part / (4.0 * v)).max(0.0))
}

/// A tree with its colours.
#[derive(Clone, Debug)]
pub struct ColorTree {
    /// The luminance.
    pub luminance: Tree,
    /// What tells the colour.
    pub chroma: Chroma<Tree>,
}

impl ColorTree {
    /// X, Y, Z over those of white, of two directions above the horizon.
    fn xyz(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let y = self.luminance.between(wi, wo);
        let [x, z] = match &self.chroma {
            Chroma::Grey => [y; 2],
            Chroma::Xz(both) => both.each_ref().map(|tree| tree.between(wi, wo)),
            Chroma::Uv([u, v]) => xz(y, u.at(wi, wo), v.at(wi, wo)),
        };
        [x, y, z]
    }
}

/// A tree, whether its directions are exchanged, and its factor.
type Part = (Arc<ColorTree>, bool, f64);

#[derive(Clone, Debug)]
enum Form {
    /// X and Z beside the luminance.
    Patches(Option<Box<[PatchMatrix; 2]>>),
    /// The function is the sum.
    Trees(Vec<Part>),
}

/// One quarter of a sheet, as its file has it.
#[derive(Clone, Debug)]
pub struct Scatter {
    /// The luminance: of a file of matrices its values, of trees their means over the patches of Klems.
    pub matrix: PatchMatrix,
    form: Form,
}

impl Scatter {
    /// Of matrices; `None` where those of the colours have other patches.
    pub fn of_matrices(matrix: PatchMatrix, chroma: Chroma<PatchMatrix>) -> Option<Self> {
        let fits = |m: &PatchMatrix| m.outgoing == matrix.outgoing && m.incident == matrix.incident;
        let colors = match chroma {
            Chroma::Grey => None,
            Chroma::Xz(both) | Chroma::Uv(both) if !both.iter().all(fits) => return None,
            Chroma::Xz(both) => Some(both),
            Chroma::Uv([mut u, mut v]) => {
                let both = u.values.iter_mut().zip(&mut v.values);
                both.zip(&matrix.values).for_each(|((u, v), y)| [*u, *v] = xz(*y, *u, *v));
                Some([u, v])
            }
        };
        Some(Self { matrix, form: Form::Patches(colors.map(Box::new)) })
    }

    /// Of a tree.
    pub fn of_tree(tree: ColorTree) -> Self {
        Self::of_parts(vec![(Arc::new(tree), false, 1.0)])
    }

    fn of_parts(parts: Vec<Part>) -> Self {
        let depth = parts.iter().map(|(tree, ..)| tree.luminance.depth()).max().unwrap_or(0);
        let matrix = PatchMatrix::of_klems(1 << depth.saturating_sub(3).clamp(1, 3), |wi, wo| {
            let value = |(tree, is_turned, by): &Part| {
                let tree = &tree.luminance;
                by * if *is_turned { tree.between(wo, wi) } else { tree.between(wi, wo) }
            };
            parts.iter().map(value).sum()
        });
        Self { matrix, form: Form::Trees(parts) }
    }

    /// X, luminance or Z, over that of white, by its number; of trees always the luminance.
    pub fn band(&self, band: usize) -> &PatchMatrix {
        match (&self.form, band) {
            (Form::Patches(Some(both)), 0) => &both[0],
            (Form::Patches(Some(both)), 2) => &both[1],
            _ => &self.matrix,
        }
    }

    /// Whether any value is above 0.
    pub fn is_bright(&self) -> bool {
        self.matrix.values.iter().any(|v| *v > 0.0)
    }

    /// The same as the light goes the other way; see [`PatchMatrix::reversed`].
    pub fn reversed(&self) -> Option<Self> {
        let form = match &self.form {
            Form::Patches(None) => Form::Patches(None),
            Form::Patches(Some(both)) => {
                Form::Patches(Some(Box::new([both[0].reversed()?, both[1].reversed()?])))
            }
            Form::Trees(parts) => {
                let turned = |(tree, is_turned, by): &Part| (tree.clone(), !is_turned, *by);
                return Some(Self::of_parts(parts.iter().map(turned).collect()));
            }
        };
        Some(Self { matrix: self.matrix.reversed()?, form })
    }

    /// The mean with another of the same patches.
    #[must_use]
    pub fn mean_with(&self, other: &Self) -> Self {
        let form = match (&self.form, &other.form) {
            (Form::Patches(None), Form::Patches(None)) => Form::Patches(None),
            (Form::Trees(own), Form::Trees(others)) => {
                let half = |(tree, is_turned, by): &Part| (tree.clone(), *is_turned, 0.5 * by);
                Form::Trees(own.iter().chain(others).map(half).collect())
            }
            _ => Form::Patches(Some(Box::new([0, 2].map(|n| self.band(n).mean_with(other.band(n)))))),
        };
        Self { matrix: self.matrix.mean_with(&other.matrix), form }
    }

    /// All values times a factor.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        match &mut self.form {
            Form::Patches(both) => {
                both.iter_mut().flat_map(|both| both.iter_mut()).for_each(|m| m.scale(factor));
            }
            Form::Trees(parts) => parts.iter_mut().for_each(|(_, _, by)| *by *= factor),
        }
        self.matrix.scale(factor);
        self
    }

    /// Share of the light at the normal that goes straight on: within a patch, or within the cells of a tree there.
    pub fn straight(&self) -> f64 {
        match &self.form {
            Form::Patches(_) => self.matrix.straight(),
            Form::Trees(parts) => {
                parts.iter().map(|(tree, ..)| tree.luminance.straight()).fold(0.0, f64::max)
            }
        }
    }

    /// The function.
    pub fn brdf(&self) -> Box<dyn Brdf + Send> {
        match &self.form {
            Form::Patches(None) => Box::new(OfPatches::new(&self.matrix)),
            Form::Patches(Some(both)) => {
                Box::new(OfColors([&both[0], &self.matrix, &both[1]].map(OfPatches::new)))
            }
            Form::Trees(parts) => {
                let is_round = parts.iter().all(|(tree, ..)| tree.luminance.rank() == 3);
                let symmetry =
                    if is_round { Symmetry::Isotropic } else { OfPatches::new(&self.matrix).symmetry() };
                let turns = match symmetry {
                    Symmetry::Isotropic if !is_round => TURNS,
                    _ => 1,
                };
                Box::new(OfTrees { parts: parts.clone(), symmetry, turns })
            }
        }
    }
}

/// Functions of X, Y and Z over those of white.
struct OfColors([OfPatches; 3]);

impl Brdf for OfColors {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        color::rgb(self.0.each_ref().map(|band| luminance(band.evaluate(wi, wo))))
    }

    fn symmetry(&self) -> Symmetry {
        // That of the luminance, of which the others differ by colours alone.
        self.0[1].symmetry()
    }
}

/// A sum of trees; of an isotropic sheet its mean over turns and mirrors.
struct OfTrees {
    parts: Vec<Part>,
    symmetry: Symmetry,
    turns: usize,
}

impl OfTrees {
    fn xyz(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (tree, is_turned, by) in &self.parts {
            let xyz = if *is_turned { tree.xyz(wo, wi) } else { tree.xyz(wi, wo) };
            (0..3).for_each(|n| sum[n] += by * xyz[n]);
        }
        sum
    }
}

impl Brdf for OfTrees {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        if self.symmetry != Symmetry::Isotropic {
            return color::rgb(self.xyz(wi, wo));
        }
        let mut sum = [0.0; 3];
        for n in 0..self.turns {
            let (sin, cos) = libm::sincos(2.0 * FRAC_PI_4 * (n as f64 + 0.5) / self.turns as f64);
            for side in [1.0, -1.0] {
                let turned = |[x, y, z]: [f64; 3]| {
                    let y = side * y;
                    [cos * x - sin * y, sin * x + cos * y, z]
                };
                let xyz = self.xyz(turned(wi), turned(wo));
                (0..3).for_each(|n| sum[n] += xyz[n]);
            }
        }
        color::rgb(sum.map(|v| v / (2 * self.turns) as f64))
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }
}
