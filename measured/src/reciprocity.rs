//! Whether samples of swapped directions agree, as those of a BRDF do, and whether values are a BRDF times a cosine.
//!
//! May import: `numeric`, `row`.

pub(crate) mod pairs;

use crate::numeric::median::median;
use crate::row::Values;
use pairs::Compared;

/// Least number of pairs that tell of a cosine, and the least difference of the logarithms of their cosines.
const ENOUGH: usize = 10;
const APART: f64 = 0.1;

/// The logarithm of the ratio of swapped values over that of the cosines is 1 or -1 where there is one, within this.
const SLOPE: f64 = 0.15;

/// Largest share of their difference that swapped values keep without the cosine, and least difference before.
const LEFT: f64 = 0.3;
const SEEN: f64 = 0.05;

/// What swapped samples say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reciprocity {
    /// Pairs of samples whose directions are swapped, within half a degree.
    pub pairs: usize,
    /// Median of the size of the logarithm of their ratio.
    pub apart: f64,
    /// What values are, if not the BRDF itself.
    pub cosine: Option<Values>,
}

impl Reciprocity {
    pub(crate) fn of(pairs: &[Compared]) -> Option<Self> {
        let apart = median(pairs.iter().map(|p| p.log_ratio.abs()).collect())?;
        Some(Self { pairs: pairs.len(), apart, cosine: cosine(pairs) })
    }
}

fn cosine(pairs: &[Compared]) -> Option<Values> {
    let ratio = |p: &Compared| libm::log(p.cosines[1] / p.cosines[0]);
    let telling: Vec<&Compared> = pairs.iter().filter(|p| ratio(p).abs() > APART).collect();
    if telling.len() < ENOUGH {
        return None;
    }
    let slope = median(telling.iter().map(|p| p.log_ratio / ratio(p)).collect())?;
    let size = |slope: f64| median(telling.iter().map(|p| (p.log_ratio - slope * ratio(p)).abs()).collect());
    let (before, sign) = (size(0.0)?, slope.signum());
    let is_cosine = (slope - sign).abs() < SLOPE && before > SEEN && size(sign)? < LEFT * before;
    is_cosine.then_some(if sign > 0.0 { Values::CosineOutgoing } else { Values::CosineIncident })
}
