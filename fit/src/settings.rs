//! The options of a fit.

use crate::FitError;
use srbf_core::encoded_len;
use std::f64::consts::FRAC_PI_2;
use std::ops::RangeInclusive;
use std::str::FromStr;

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
    /// Lobes of every view, 1 to 64. More fit better and cost more at run time. Default: 12.
    pub lobes: usize,
    /// Mean relative L2 error that is asked for, above 0: the fewest lobes that reach it are used, at most [`lobes`](Self::lobes).
    /// Default: `None`, all of them are used.
    pub error: Option<f64>,
    /// Number of lobes that see the squeezed direction: those of the highlight. Default: `None`, the number that fits best.
    pub squeezed: Option<usize>,
    /// Number of pairs of lobes that are mirrored in the plane of incidence: those of light that is scattered out of that plane.
    /// Isotropic surfaces only. Default: `None`, the number that fits best.
    pub mirrored: Option<usize>,
    /// Weight of the roughness from view to view, 1e-12 to 1000. Smaller fits the table better; larger fits better between its views.
    /// Default: 5e-5. Isotropic fits use 0.4 of it, and 0.12 of it in the last stages after lobes were exchanged; anisotropic fits
    /// use 6 times as much.
    pub smoothness: f64,
    /// Starting points that are tried, 1 to 1000; the best are refined. Default: 12.
    ///
    /// Fits of samples try a quarter as many. With 5 to 8 lobes twice as many are tried, with 4 three times, with fewer four times;
    /// with more than 20 lobes fewer, in inverse proportion. Anisotropic fits try at most 4.
    pub starts: usize,
    /// Most steps of the solver in the refinement, 1 to 100000. Default: 120. Fits of samples take half of it.
    pub steps: usize,
    /// Most exchanges of lobes in a stage, 0 to 1000: the lobe that is missed least is moved to where the residual is largest. A stage
    /// ends early after six exchanges in a row that lower the cost by less than a thousandth. Isotropic surfaces only. Default: 15.
    ///
    /// Exchanges take place in two stages of the search, and before the last stages if the fit meets all its goals. Fits of samples
    /// exchange a quarter as often, fits of more than 20 lobes less often, in inverse proportion.
    pub exchanges: usize,
    /// Views of the material, 2 to 256, placed where it changes. Isotropic surfaces only. Default: `None`, which stands for 15.
    ///
    /// With the default, materials of 6 to 11 lobes, and those with mirrored pairs, get more views: as many as take the bytes of
    /// 15 views of 12 lobes, at most twice as many. A fit of a table with factors may have up to four more: next to the normal, and where the
    /// stored albedo bends.
    pub views: Option<usize>,
    /// Angles of the views in radians, rising from 0 to at most pi / 2; at most 1024, of an anisotropic surface 64. Default: `None`,
    /// they are placed; those of anisotropic surfaces follow from their number.
    pub view_angles: Option<Vec<f64>>,
    /// The table of factors that the lobes are multiplied by. Isotropic surfaces only. Default: [`FactorNodes::Chosen`].
    pub factors: FactorNodes,
    /// Most bytes of the material, without its provenance and its spectra, from 200 to 1 000 000. Isotropic surfaces only. Default: 8000.
    ///
    /// Twelve lobes at fifteen views take 4.3 kB. The rest is for factors, as far as they are worth it; a table of 15 kB is the largest.
    /// Where the lobes alone take more, fewer are used.
    pub bytes: usize,
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
    /// By a table with these numbers of nodes over half angle, difference angle and azimuth.
    Given([usize; 3]),
    /// By such a table whose nodes over the azimuth know which direction is the higher one. It has the part that is not reciprocal.
    Signed([usize; 3]),
}

impl FromStr for FactorNodes {
    type Err = String;

    /// Reads `none`, `chosen`, or two or three numbers of nodes such as `24x6x3`, with `s` behind them for [`Signed`](Self::Signed).
    fn from_str(text: &str) -> Result<Self, String> {
        let given = || {
            let (nodes, is_signed) = text.strip_suffix('s').map_or((text, false), |nodes| (nodes, true));
            let numbers = nodes.split('x').map(|n| n.parse().ok()).collect::<Option<Vec<usize>>>()?;
            match numbers[..] {
                [half, difference, azimuth] if is_signed => Some(Self::Signed([half, difference, azimuth])),
                [half, difference] if !is_signed => Some(Self::Given([half, difference, 1])),
                [half, difference, azimuth] => Some(Self::Given([half, difference, azimuth])),
                _ => None,
            }
        };
        match text {
            "none" => Ok(Self::None),
            "chosen" => Ok(Self::Chosen),
            _ => given().ok_or_else(|| {
                "expected `none`, `chosen`, or numbers of nodes as in 24x6x3 or 24x6x5s".into()
            }),
        }
    }
}

/// Views of an isotropic material.
const USUAL_VIEWS: usize = 15;

/// Numbers of lobes that may take the bytes of the largest of them, with more views: errors halfway between the views are smaller, and
/// the energy is kept better. Four lobes with 30 views have an error of 6.0 % there, against 6.5 % with 15; but weights above 20 occur
/// on five of 22 materials, against two.
const PAID_IN_VIEWS: RangeInclusive<usize> = 6..=12;

/// Of twelve lobes, the shapes that are tried: how many are squeezed, and how many pairs mirrored. Each of the four is by far the best of some materials; of six or more, each would get too few starts. Of few lobes
/// several come to the same, and shapes with half of the lobes squeezed, or one less and a pair, fill up.
const SHAPES: [(usize, usize); 4] = [(7, 2), (8, 0), (5, 3), (4, 4)];

/// Up to this number of lobes, two more shapes are tried: all squeezed, and all but one. They are often the
/// best (steel with four: 6.0 % halfway between the views, and 8.4 % without them); with twelve, one more with ten squeezed takes
/// starts from the others and is worse by 4 %.
const FEW_LOBES: usize = 8;

/// Refuses a setting that is not inside its range.
pub fn range(name: &'static str, inside: bool, reason: &str) -> Result<(), FitError> {
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
            view_angles: None,
            factors: FactorNodes::Chosen,
            bytes: 8000,
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
        if let Some(view_angles) = &self.view_angles {
            let rising = view_angles.windows(2).all(|w| w[1] - w[0] > 1e-4);
            let inside = view_angles.len() <= 1024
                && view_angles.first() == Some(&0.0)
                && view_angles.last() <= Some(&FRAC_PI_2);
            range("view_angles", rising && inside, "from 0 rising to at most pi / 2 radians, at most 1024")?;
        }
        range("starts", (1..=1000).contains(&self.starts), "from 1 to 1000")?;
        range("steps", (1..=100_000).contains(&self.steps), "from 1 to 100000")?;
        range("exchanges", self.exchanges <= 1000, "at most 1000")?;
        if let FactorNodes::Given(nodes) | FactorNodes::Signed(nodes) = self.factors {
            let [half, difference, azimuth] = nodes;
            let least = if matches!(self.factors, FactorNodes::Signed(_)) { 2 } else { 1 };
            let is_there =
                [half, difference].iter().all(|n| (2..=32).contains(n)) && (least..=8).contains(&azimuth);
            range(
                "factors",
                is_there,
                "from 2 to 32 nodes along either angle, and 1 to 8 along the azimuth, 2 to 8 if it is signed",
            )?;
        }
        range("bytes", (200..=1_000_000).contains(&self.bytes), "from 200 to 1000000")?;
        range("views", self.views.is_none_or(|n| (2..=256).contains(&n)), "from 2 to 256")
    }

    /// Refuses settings that the fit of an anisotropic surface would ignore.
    ///
    /// # Errors
    /// [`FitError::Setting`], with the name.
    pub(crate) fn check_anisotropic(&self) -> Result<(), FitError> {
        let reason = "for isotropic surfaces only, and this one is anisotropic";
        range("mirrored", self.mirrored.is_none(), reason)?;
        range("exchanges", self.exchanges == Self::default().exchanges, reason)
    }

    /// Views of an isotropic material before few lobes, or mirrored pairs of them, get more.
    pub fn view_count(&self) -> usize {
        self.views.unwrap_or(USUAL_VIEWS)
    }

    /// Lobes of which as many views are the bytes that a material may take.
    pub(crate) fn lobes_of_size(&self) -> usize {
        let is_paid = self.views.is_none() && PAID_IN_VIEWS.contains(&self.lobes);
        if is_paid { *PAID_IN_VIEWS.end() } else { self.lobes }
    }

    /// The same with no more lobes than the bytes have room for at their views.
    ///
    /// # Errors
    /// [`FitError::Setting`] if there is no room for one.
    pub(crate) fn within_bytes(&self) -> Result<Self, FitError> {
        let views = self.view_angles.as_ref().map_or(self.view_count(), Vec::len);
        let lobes = (1..=self.lobes).rev().find(|&lobes| encoded_len(views, lobes, 0, "") <= self.bytes);
        let least = || format!("{views} views of one lobe take {}", encoded_len(views, 1, 0, ""));
        let lobes = lobes.ok_or_else(|| FitError::Setting { name: "bytes", reason: least() })?;
        Ok(self.with_lobes(lobes))
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

    /// The settings as they were given, the stored views in degrees.
    pub(crate) fn to_json(&self) -> serde_json::Value {
        let degrees = |view_angles: &Vec<f64>| view_angles.iter().map(|k| k.to_degrees()).collect::<Vec<_>>();
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
            "bytes": self.bytes,
            "factors": match self.factors {
                FactorNodes::None => serde_json::json!("none"),
                FactorNodes::Chosen => serde_json::json!("chosen"),
                FactorNodes::Given(size) => serde_json::json!(size),
                FactorNodes::Signed(size) => serde_json::json!({ "signed": size }),
            },
            "view_angles_degrees": self.view_angles.as_ref().map(degrees),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The documentation of a field, on one line.
    fn documented(field: &str) -> String {
        let text = include_str!("settings.rs");
        let (before, _) = text.split_once(&format!("    pub {field}: ")).expect("a field");
        let lines = before.lines().rev().map(str::trim).map_while(|line| line.strip_prefix("///"));
        let mut lines: Vec<&str> = lines.map(str::trim).collect();
        lines.reverse();
        lines.join(" ")
    }

    #[test]
    fn the_documentation_states_the_defaults() {
        let settings = Settings::default();
        let none = [settings.error.is_none(), settings.squeezed.is_none(), settings.mirrored.is_none()];
        assert!(none == [true; 3] && settings.views.is_none() && settings.view_angles.is_none());
        for (field, says) in [
            ("lobes", format!("Default: {}.", settings.lobes)),
            ("error", "Default: `None`".into()),
            ("squeezed", "Default: `None`".into()),
            ("mirrored", "Default: `None`".into()),
            ("smoothness", format!("Default: {:e}.", settings.smoothness)),
            ("starts", format!("Default: {}.", settings.starts)),
            ("steps", format!("Default: {}.", settings.steps)),
            ("exchanges", format!("Default: {}.", settings.exchanges)),
            ("views", format!("Default: `None`, which stands for {}.", settings.view_count())),
            ("view_angles", "Default: `None`".into()),
            ("bytes", format!("Default: {}.", settings.bytes)),
            ("factors", format!("Default: [`FactorNodes::{:?}`].", settings.factors)),
        ] {
            assert!(documented(field).contains(&says), "{field}: {says} is not in: {}", documented(field));
        }
    }

    #[test]
    fn what_an_anisotropic_fit_would_ignore_is_refused() {
        let default = Settings::default;
        assert!(default().check_anisotropic().is_ok());
        for (name, settings) in [
            ("mirrored", Settings { mirrored: Some(0), ..default() }),
            ("exchanges", Settings { exchanges: 3, ..default() }),
        ] {
            let error = settings.check_anisotropic().unwrap_err().to_string();
            assert!(error.contains(name) && error.contains("anisotropic"), "{error}");
        }
    }

    #[test]
    fn from_six_lobes_on_the_bytes_of_twelve_are_for_views() {
        let size = |lobes, views| Settings { lobes, views, ..Settings::default() }.lobes_of_size();
        assert_eq!([4, 6, 11, 12, 13].map(|lobes| size(lobes, None)), [4, 12, 12, 12, 13]);
        assert_eq!(size(6, Some(15)), 6);
    }

    #[test]
    fn lobes_that_have_no_room_are_left_out() {
        let within = |bytes| Settings { bytes, ..Settings::default() }.within_bytes().map(|s| s.lobes);
        assert_eq!(within(8000).ok(), Some(12));
        let few = within(2000).unwrap_or_default();
        assert!(encoded_len(15, few, 0, "") <= 2000 && encoded_len(15, few + 1, 0, "") > 2000, "{few}");
        let error = within(200).map_err(|error| error.to_string());
        assert!(
            error.as_ref().is_err_and(|text| text.contains("bytes") && text.contains("take")),
            "{error:?}"
        );
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
