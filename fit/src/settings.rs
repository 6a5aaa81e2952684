//! What can be chosen of a fit.

use crate::FitError;
use crate::isotropic::model::parameters::Layout;
use std::f64::consts::FRAC_PI_2;
use std::ops::RangeInclusive;

/// How a material is fitted.
///
/// # Examples
/// ```
/// use srbf_fit::Settings;
///
/// let few = Settings { lobes: 6, ..Settings::default() };
/// few.check()?;
/// assert!(Settings { lobes: 65, ..few }.check().is_err());
/// # Ok::<(), srbf_fit::FitError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Lobes of every view, 1 to 64. More fit better and cost more at run time.
    pub lobes: usize,
    /// Mean relative L2 error that is asked for: as few lobes as reach it are used, at most [`lobes`](Self::lobes).
    pub error: Option<f64>,
    /// How many lobes see the squeezed direction: those of the highlight. `None`: what turns out best.
    pub squeezed: Option<usize>,
    /// How many pairs of the lobes are mirrored in the plane of incidence: those of what lies beside it. `None`: what turns out best.
    pub mirrored: Option<usize>,
    /// Weight of the roughness from view to view. Smaller fits the samples better, larger what lies between them. What can be
    /// evaluated anywhere is fitted with two fifths of it, and with an eighth once the best has had lobes exchanged.
    pub smoothness: f64,
    /// Starting points tried; the best are refined. Of samples, two thirds as many, as fewer shapes are tried; of what can be
    /// evaluated anywhere, twice as many for 5 to 8 lobes, three times for 4, four times for fewer.
    pub starts: usize,
    /// Most steps of the refinement.
    pub steps: usize,
    /// Most times that the lobe that is missed least is put where it is missed most; it ends after six in a row that lower the
    /// cost by less than a thousandth. Of samples, from each of the three best starting points; of what can be evaluated anywhere,
    /// two thirds of it from four, one of each shape, then all of it from three (more for fewer lobes, as of the starts), and again all
    /// of it from the best, if that misses no goal.
    pub exchanges: usize,
    /// Views of the material, placed where it changes; only for what can be evaluated anywhere. `None`: 15, 4.1 kB with 12 lobes, and
    /// with 6 to 11 lobes as many more as take those bytes. Lobes in mirrored pairs are fewer bytes: an isotropic material that has some
    /// gets as many more views as those take. At most twice as many in all.
    pub views: Option<usize>,
    /// Angles of the views in radians, from 0 rising. `None`: for what can be evaluated anywhere, as many as
    /// [`views`](Self::views) says; for samples, their own views, the normal and the horizon.
    pub knots: Option<Vec<f64>>,
    /// The table of factors that the lobes are multiplied by; only for what can be evaluated anywhere, and isotropic.
    pub factors: FactorNodes,
    /// Name of the source, hash and the like: the first lines of the material's provenance.
    pub provenance: String,
}

/// Whether lobes are multiplied by factors over half angle, difference angle and azimuth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactorNodes {
    /// They are not.
    None,
    /// By the smallest table that is worth its bytes, if any is.
    Chosen,
    /// By a table of so many nodes over half angle, difference angle and azimuth.
    Given([usize; 3]),
}

/// Views of a material that can be evaluated anywhere.
const USUAL_VIEWS: usize = 15;

/// So many lobes may take the bytes of the last of these, with more views, and are better halfway between them and keep the energy. Four
/// with 30 views are 6.0 % off there in place of 6.5, but weights are above 20 on five of 22 materials in place of two.
const PAID_IN_VIEWS: RangeInclusive<usize> = 6..=12;

/// Of twelve lobes, the shapes that are tried: how many are squeezed, and how many pairs mirrored. Each of the four is by far the best of some materials; of six or more, each would get too few starts. Of few lobes
/// several come to the same, and shapes with half of the lobes squeezed, or one less and a pair, fill up.
const SHAPES: [(usize, usize); 4] = [(7, 2), (8, 0), (5, 3), (4, 4)];

/// So few lobes, of what can be evaluated anywhere, are tried in two more shapes: all squeezed, and all but one. They are often the
/// best (steel with four: 6.0 % halfway between the views, and 8.4 % without them); with twelve, one more with ten squeezed takes
/// starts from the others and is worse by 4 %.
const FEW_LOBES: usize = 8;

/// Refuses a setting that is not inside its range.
pub(crate) fn range(name: &'static str, inside: bool, reason: &str) -> Result<(), FitError> {
    if inside { Ok(()) } else { Err(FitError::Setting { name, reason: reason.to_owned() }) }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            lobes: 12,
            error: None,
            squeezed: None,
            mirrored: None,
            smoothness: 5e-5,
            starts: 12,
            steps: 120,
            exchanges: 15,
            views: None,
            knots: None,
            factors: FactorNodes::Chosen,
            provenance: String::new(),
        }
    }
}

impl Settings {
    /// Checks every setting against its range.
    ///
    /// # Errors
    /// [`FitError::Setting`], with the name and the range.
    pub fn check(&self) -> Result<(), FitError> {
        range("lobes", (1..=srbf_core::MAX_LOBES).contains(&self.lobes), "from 1 to 64")?;
        let error = self.error.is_none_or(|e| e.is_finite() && e > 0.0);
        range("error", error, "a number above 0")?;
        range("squeezed", self.squeezed.is_none_or(|n| n <= self.lobes), "at most the number of lobes")?;
        let pairs = self.mirrored.is_none_or(|n| n <= (self.lobes - self.squeezed.unwrap_or(0)) / 2);
        range("mirrored", pairs, "at most half of the lobes that are not squeezed")?;
        range("smoothness", (1e-12..=1e3).contains(&self.smoothness), "from 1e-12 to 1000")?;
        if let Some(knots) = &self.knots {
            let rising = knots.windows(2).all(|w| w[1] - w[0] > 1e-4);
            let inside =
                knots.len() <= 1024 && knots.first() == Some(&0.0) && knots.last() <= Some(&FRAC_PI_2);
            range("knots", rising && inside, "from 0 rising to at most pi / 2 radians, at most 1024")?;
        }
        range("starts", (1..=1000).contains(&self.starts), "from 1 to 1000")?;
        range("steps", (1..=100_000).contains(&self.steps), "from 1 to 100000")?;
        range("exchanges", self.exchanges <= 1000, "at most 1000")?;
        if let FactorNodes::Given(nodes) = self.factors {
            let [half, difference, azimuth] = nodes;
            let is_there = [half, difference].iter().all(|n| (2..=32).contains(n)) && (1..=8).contains(&azimuth);
            range("factors", is_there, "from 2 to 32 nodes along either angle, and 1 to 8 along the azimuth")?;
        }
        range("views", self.views.is_none_or(|n| (2..=256).contains(&n)), "from 2 to 256")
    }

    /// Views of a material that can be evaluated anywhere, of which few lobes, or pairs of them, get more.
    pub fn view_count(&self) -> usize {
        self.views.unwrap_or(USUAL_VIEWS)
    }

    /// Lobes of which as many views are the bytes that a material may take.
    pub(crate) fn lobes_of_size(&self) -> usize {
        let is_paid = self.views.is_none() && PAID_IN_VIEWS.contains(&self.lobes);
        if is_paid { *PAID_IN_VIEWS.end() } else { self.lobes }
    }

    /// The same with another number of lobes, of which no more are squeezed or mirrored than there are.
    #[must_use]
    pub fn with_lobes(&self, lobes: usize) -> Self {
        let squeezed = self.squeezed.map(|s| s.min(lobes));
        let mirrored = self.mirrored.map(|m| m.min((lobes - squeezed.unwrap_or(0)) / 2));
        Self { lobes, squeezed, mirrored, ..self.clone() }
    }

    /// Numbers of squeezed lobes and of mirrored pairs that are tried.
    pub(crate) fn shapes(&self) -> Vec<(usize, usize)> {
        let scaled = SHAPES
            .iter()
            .map(|&(squeezed, mirrored)| ((squeezed * self.lobes).div_ceil(12), mirrored * self.lobes / 12));
        let streaks: &[(usize, usize)] =
            if self.lobes <= FEW_LOBES { &[(self.lobes, 0), (self.lobes - 1, 0)] } else { &[] };
        let half = self.lobes / 2;
        let more = [(half, 0), (half.saturating_sub(1), usize::from(half > 0))];
        let most = SHAPES.len() + streaks.len();
        let mut shapes = Vec::new();
        for (squeezed, mirrored) in streaks.iter().copied().chain(scaled).chain(more) {
            let round = 2 * self.mirrored.unwrap_or(0);
            let squeezed = self.squeezed.unwrap_or(squeezed.min(self.lobes - round));
            let tried = self.mirrored.unwrap_or(mirrored);
            let shape = (squeezed, tried.min((self.lobes - squeezed) / 2));
            if !shapes.contains(&shape) && shapes.len() < most {
                shapes.push(shape);
            }
        }
        shapes
    }

    /// The settings as they were given, the knots in degrees.
    pub(crate) fn to_json(&self) -> serde_json::Value {
        let degrees = |knots: &Vec<f64>| knots.iter().map(|k| k.to_degrees()).collect::<Vec<_>>();
        serde_json::json!({
            "lobes": self.lobes,
            "error": self.error,
            "squeezed": self.squeezed,
            "mirrored_pairs": self.mirrored,
            "smoothness": self.smoothness,
            "starts": self.starts,
            "steps": self.steps,
            "exchanges": self.exchanges,
            "views": self.views,
            "factors": match self.factors {
                FactorNodes::None => serde_json::json!("none"),
                FactorNodes::Chosen => serde_json::json!("chosen"),
                FactorNodes::Given(size) => serde_json::json!(size),
            },
            "knots_degrees": self.knots.as_ref().map(degrees),
        })
    }

    /// The last line of the provenance.
    pub(crate) fn describe(&self, layout: &Layout) -> String {
        format!(
            "srbf-fit {}: {} lobes, {} squeezed, {} in mirrored pairs, smoothness {:.2e}, {} starts, {} steps, {} exchanges\n",
            env!("CARGO_PKG_VERSION"),
            self.lobes,
            layout.squeezed,
            2 * layout.mirrored,
            self.smoothness,
            self.starts,
            self.steps,
            self.exchanges
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_six_lobes_on_the_bytes_of_twelve_are_for_views() {
        let size = |lobes, views| Settings { lobes, views, ..Settings::default() }.lobes_of_size();
        assert_eq!([4, 6, 11, 12, 13].map(|lobes| size(lobes, None)), [4, 12, 12, 12, 13]);
        assert_eq!(size(6, Some(15)), 6);
    }

    #[test]
    fn shapes_are_what_was_asked_for_and_differ() {
        let shapes = |lobes, squeezed, mirrored| {
            Settings { lobes, squeezed, mirrored, ..Settings::default() }.shapes()
        };
        assert_eq!(shapes(12, None, None), SHAPES);
        assert_eq!(shapes(8, None, None), [(8, 0), (7, 0), (5, 1), (6, 0), (4, 2), (3, 2)]);
        assert_eq!(shapes(4, None, None), [(4, 0), (3, 0), (2, 1), (2, 0), (1, 1)]);
        assert_eq!(shapes(1, None, None), [(1, 0), (0, 0)]);
        assert_eq!(shapes(12, Some(3), Some(2)), [(3, 2)]);
        for lobes in 1..=64 {
            for mirrored in 0..=lobes / 2 {
                let shapes = shapes(lobes, None, Some(mirrored));
                assert!(
                    !shapes.is_empty() && shapes.iter().all(|s| s.1 == mirrored && s.0 + 2 * s.1 <= lobes)
                );
            }
        }
    }
}
