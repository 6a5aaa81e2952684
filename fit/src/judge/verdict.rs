//! A fit in a few numbers and in words: whether to use it, good criteria, criteria that are off, and advice.
//!
//! The numbers are of the held-out views, if there are any. The words are of all views: a
//! weight that is large at a view that was fitted is as bright a dot in a picture.

mod units;

use crate::judge::appearance::Appearance;
use crate::judge::reciprocity::Reciprocity;
use crate::judge::report::{Report, ViewReport};
use crate::judge::spectral::{Grade, SpectralReport};
use crate::look::Topic;
use crate::table::albedo_bounds::{LEAST, MOST, albedos};
use serde_json::{Value, json};

/// A number over several views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Its median.
    pub median: f64,
    /// The largest.
    pub worst: f64,
    /// Angle of the outgoing direction of the largest, radians.
    pub worst_at: f64,
}

impl Spread {
    /// Of the views that have such a number; `None` if there is none. The lower of two numbers in the middle is the median.
    fn of<'v>(views: impl Iterator<Item = &'v ViewReport>, number: fn(&ViewReport) -> f64) -> Option<Self> {
        let mut all: Vec<(f64, f64)> =
            views.map(|v| (number(v), v.theta)).filter(|(number, _)| !number.is_nan()).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let &(worst, worst_at) = all.last()?;
        Some(Self { median: all[(all.len() - 1) / 2].0, worst, worst_at })
    }

    fn to_json(self) -> Value {
        // JSON has no word for an infinite number.
        let number = |v: f64| if v.is_infinite() { json!("inf") } else { json!(v) };
        json!({
            "median": number(self.median),
            "worst": number(self.worst),
            "worst_at_degrees": self.worst_at.to_degrees(),
        })
    }
}

/// How a number is written.
#[derive(Clone, Copy)]
enum Unit {
    Percent,
    Plain(usize),
}

impl Unit {
    fn text(self, value: f64) -> String {
        match self {
            Self::Percent => format!("{:.1} %", 100.0 * value),
            Self::Plain(digits) => format!("{value:.digits$}"),
        }
    }
}

/// A criterion that every view has.
struct Criterion {
    name: &'static str,
    /// Its name in JSON.
    key: &'static str,
    unit: Unit,
    number: fn(&ViewReport) -> f64,
    /// Most that the median of a good fit is.
    good: f64,
    /// Most that any view of a good fit has.
    most: f64,
    /// Whether it is of visible errors, and so of views up to [`STEEPEST`] alone.
    is_visual: bool,
    /// Whether it is of directions away from the peak.
    is_off_peak: bool,
    /// The part of both that is noise of the table.
    noise: fn(&Report) -> f64,
}

/// Angle from which views are too steep to be visible on most objects: 80 degrees.
const STEEPEST: f64 = 80.0 * std::f64::consts::PI / 180.0;

/// Errors of luminance and of colour by noise of the table.
fn noise_of_luminance(report: &Report) -> f64 {
    report.appearance.as_ref().map_or(0.0, |found| found.noise().luminance)
}

fn noise_of_chroma(report: &Report) -> f64 {
    report.appearance.as_ref().map_or(0.0, |found| found.noise().chroma)
}

fn no_noise(_: &Report) -> f64 {
    0.0
}

/// Largest variance and largest weight over the mean that are no trouble in a picture, and largest error of the albedo: a
/// fit that breaks one is refitted.
pub(crate) const MOST_VARIANCE: f64 = 0.25;
pub(crate) const MOST_WEIGHT: f64 = 18.0;
pub(crate) const MOST_ENERGY_ERROR: f64 = 0.01;

const L2: Criterion = Criterion {
    name: "relative L2",
    key: "relative_l2",
    unit: Unit::Percent,
    number: |v| v.error,
    good: 0.052,
    most: 0.2,
    is_visual: true,
    is_off_peak: false,
    noise: no_noise,
};
const OFF_PEAK: Criterion = Criterion {
    name: "L2 off the peak",
    key: "relative_l2_off_peak",
    unit: Unit::Percent,
    number: |v| v.regions.off_peak,
    good: 0.1,
    most: 0.2,
    is_visual: true,
    is_off_peak: true,
    noise: noise_of_luminance,
};
const LUMINANCE: Criterion = Criterion {
    name: "luminance off the peak",
    key: "luminance_error_off_peak",
    unit: Unit::Percent,
    number: |v| v.regions.luminance,
    good: 0.06,
    most: 0.15,
    is_visual: true,
    is_off_peak: true,
    noise: noise_of_luminance,
};
const CHROMA: Criterion = Criterion {
    name: "colour off the peak",
    key: "chroma_error_off_peak",
    unit: Unit::Plain(3),
    number: |v| v.regions.chroma,
    good: 0.03,
    most: 0.1,
    is_visual: true,
    is_off_peak: true,
    noise: noise_of_chroma,
};
const VARIANCE: Criterion = Criterion {
    name: "variance of f cos / pdf",
    key: "relative_variance",
    unit: Unit::Plain(3),
    number: |v| v.variance,
    good: MOST_VARIANCE,
    most: MOST_VARIANCE,
    is_visual: false,
    is_off_peak: false,
    noise: no_noise,
};
const WEIGHT: Criterion = Criterion {
    name: "largest weight over the mean",
    key: "largest_weight_over_mean",
    unit: Unit::Plain(1),
    number: |v| v.largest_weight,
    good: MOST_WEIGHT,
    most: MOST_WEIGHT,
    is_visual: false,
    is_off_peak: false,
    noise: no_noise,
};
const ENERGY: Criterion = Criterion {
    name: "energy",
    key: "energy_error",
    unit: Unit::Percent,
    // Lobes were not asked for what no surface reflects.
    number: |v| if v.is_albedo_cut { f64::NAN } else { v.energy_error() },
    good: MOST_ENERGY_ERROR,
    most: MOST_ENERGY_ERROR,
    is_visual: false,
    is_off_peak: false,
    noise: no_noise,
};

/// What words are about.
const CRITERIA: [&Criterion; 7] = [&L2, &OFF_PEAK, &LUMINANCE, &CHROMA, &VARIANCE, &WEIGHT, &ENERGY];

/// Error at the peak, which is a number of the summary alone.
const PEAK: Criterion = Criterion {
    name: "L2 at the peak",
    key: "relative_l2_peak",
    number: |v| v.regions.peak,
    good: 0.1,
    most: f64::INFINITY,
    ..L2
};

/// Reciprocity error of a good fit in the median, and of one that is off.
const GOOD_RECIPROCITY: f64 = 0.1;
const MOST_RECIPROCITY: f64 = 0.3;

/// Asymmetry of the data at the normal that is worth a word: no isotropic fit has it.
const LEAST_FLOOR: f64 = 0.02;

/// A fit in a few numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Whether they are of held-out views.
    pub is_of_held_out: bool,
    /// Views that they are of.
    pub views: usize,
    /// Relative L2 error of `f cos`. Here and below: `None` where no view has such a number.
    pub error: Option<Spread>,
    /// The same within 15 degrees of the mirror direction.
    pub peak: Option<Spread>,
    /// The same beyond.
    pub off_peak: Option<Spread>,
    /// Median relative error of the luminance there.
    pub luminance: Option<Spread>,
    /// Median distance of the colours there.
    pub chroma: Option<Spread>,
    /// Relative variance of `f cos / pdf`.
    pub variance: Option<Spread>,
    /// Largest `f cos / pdf` over the mean.
    pub weight: Option<Spread>,
    /// Largest relative error of an albedo.
    pub energy: Option<Spread>,
}

/// The views that are judged: those that lobes can be compared with.
fn judged(views: &[ViewReport]) -> impl Iterator<Item = &ViewReport> {
    views.iter().filter(|v| !(v.is_black || v.is_contradicted || v.is_too_dark()))
}

impl Summary {
    /// Sums a report up.
    pub fn new(report: &Report) -> Self {
        // Samples are the data; their completion is not.
        let is_of_held_out = !report.held_out.is_empty() && report.completion.is_none();
        let views = if is_of_held_out { &report.held_out } else { &report.views };
        let spread = |criterion: &Criterion| Spread::of(judged(views), criterion.number);
        Self {
            is_of_held_out,
            views: judged(views).count(),
            error: spread(&L2),
            peak: spread(&PEAK),
            off_peak: spread(&OFF_PEAK),
            luminance: spread(&LUMINANCE),
            chroma: spread(&CHROMA),
            variance: spread(&VARIANCE),
            weight: spread(&WEIGHT),
            energy: spread(&ENERGY),
        }
    }

    pub(crate) fn to_json(&self) -> Value {
        let mut json = json!({
            "of": if self.is_of_held_out { "held-out views" } else { "fitted views" },
            "views": self.views,
        });
        let spreads = [
            (&L2, self.error),
            (&PEAK, self.peak),
            (&OFF_PEAK, self.off_peak),
            (&LUMINANCE, self.luminance),
            (&CHROMA, self.chroma),
            (&VARIANCE, self.variance),
            (&WEIGHT, self.weight),
            (&ENERGY, self.energy),
        ];
        for (criterion, spread) in spreads {
            json[criterion.key] = spread.map(Spread::to_json).into();
        }
        json
    }
}

/// Visible difference of the pictures up to which hardly anything shows side by side, and up to which a fit is of use. The least
/// visible difference of colours is 0.06, twice that is 0.09, eight times that is 0.25.
const UNSEEN: f64 = 0.09;
const OF_USE: f64 = 0.25;
/// Largest ripple of colour over that of the table, and an invisible ripple.
const MORE_RIPPLE: f64 = 1.3;
const UNSEEN_RIPPLE: f64 = 0.025;
/// Colour round the highlight, share of false negative channels there, and ghost that are visible.
const MOST_SKIRT: f64 = 0.06;
const MOST_NEGATIVE: f64 = 0.05;
const MOST_GHOST: f64 = 0.3;
/// Coarse grain of the fit over that of the table, and an invisible one; bite; and ring that are visible.
const MORE_GRAIN: f64 = 1.3;
const UNSEEN_GRAIN: f64 = 0.06;
const MOST_BITE: f64 = 1.6;
const MOST_RING: f64 = 1.15;
/// Noise of the luminance that is worth a word, and that is worth one in the sentence.
const LEAST_NOISE: f64 = 0.04;
const LOUD_NOISE: f64 = 0.08;
/// Share of all pairs of directions without a measurement that is worth a word, and with which no fit is of use as a whole.
const LEAST_GAPS: f64 = 0.1;
const MOST_GAPS: f64 = 0.4;

fn has_rings(found: &Appearance) -> bool {
    let [fit, table] = found.ripple;
    fit.chroma > (MORE_RIPPLE * table.chroma).max(UNSEEN_RIPPLE)
}

/// Whether a highlight has a ring where that of the table has none.
fn has_ring(found: &Appearance) -> bool {
    found.ring[0] > MOST_RING && found.ring[1] < 1.0 + 0.5 * (MOST_RING - 1.0)
}

fn has_creases(found: &Appearance) -> bool {
    let [fit, table] = found.grain;
    fit.coarse > (MORE_GRAIN * table.coarse).max(UNSEEN_GRAIN)
}

/// Whether to use a fit, and its visible errors. A doubt about the data comes first.
fn sentence(found: &Appearance, report: &Report) -> String {
    let fitted = sentence_of_fit(found, report);
    let Some(look) = &report.look else { return fitted };
    let is_off = |topic: Topic| look.findings.iter().any(|f| f.is_off && f.topic == topic);
    let is_saturated = look.findings.iter().any(|f| f.is_off && f.option == Some("--saturated leave-out"));
    let is_off_by_cosine =
        look.findings.iter().any(|f| f.is_off && f.topic == Topic::Reciprocity && f.option.is_some());
    let is_bright = look.units.as_ref().is_some_and(|units| units.most > MOST);
    let (advice, doubt) = match () {
        // Lobes are held to less light than such data reflect, so that errors say nothing.
        () if is_off(Topic::Units) && is_bright => {
            return "do not use it: the values seem to be in other units than 1/sr".into();
        }
        () if is_off_by_cosine => ("do not use it", "the values seem to be off by a cosine"),
        () if is_saturated => ("use it with care", "the highlight of the samples may be cut off"),
        () if is_off(Topic::Units) => ("use it with care", "the samples are as dark as hardly any surface"),
        () => return fitted,
    };
    let (found, rest) = fitted.split_once(": ").unwrap_or(("", &fitted));
    let advice = if found.starts_with("do not use it") && advice != "do not use it" { found } else { advice };
    format!("{advice}: {doubt}; beside the data as read, {rest}")
}

/// The same without a doubt about the data.
fn sentence_of_fit(found: &Appearance, report: &Report) -> String {
    let looks = if found.is_dark { sentence_by_highlight(report) } else { sentence_by_looks(found) };
    with_gaps(of_samples(looks, report), report)
}

/// The sentence of a fit of samples says how far samples are off that are left out of their completion.
fn of_samples(sentence: String, report: &Report) -> String {
    let Some(completion) = &report.completion else { return sentence };
    let views = completion.views_left_out.as_ref().map_or(0.0, |views| views.error);
    let error = completion.samples_left_out.error.max(views);
    let (advice, rest) = sentence.split_once(": ").unwrap_or(("", &sentence));
    let advice = if advice == "use it" && error > MOST_BETWEEN { "use it with care" } else { advice };
    let rest = rest.replace("from the table's", "from those of the completed samples");
    let percent = if error < 0.01 { "less than 1 %".into() } else { format!("{:.0} %", 100.0 * error) };
    format!("{advice}: samples that are left out are {percent} off; {rest}")
}

/// The sentence of a fit of something that was not measured everywhere says so first.
fn with_gaps(looks: String, report: &Report) -> String {
    let gaps = report.gaps.as_ref();
    let Some((gaps, share)) = gaps.map(|gaps| (gaps, gaps.mean())).filter(|gaps| gaps.1 >= LEAST_GAPS) else {
        return looks;
    };
    let (advice, rest) = looks.split_once(": ").unwrap_or(("", &looks));
    let advice = match advice {
        _ if share >= MOST_GAPS => "do not use it as a whole",
        "do not use it" => advice,
        _ => "use it with care",
    };
    // The sentence of samples has the words of its own that the gaps are filled.
    let filled = if report.completion.is_some() { "" } else { "beside the table with its gaps filled, " };
    format!("{advice}: {}; {filled}{rest}", gaps.words())
}

/// The same of a table that is black but for its highlight.
fn sentence_by_highlight(report: &Report) -> String {
    let views = if report.held_out.is_empty() { &report.views } else { &report.held_out };
    let error =
        Spread::of(judged(views).filter(|v| v.theta <= STEEPEST), L2.number).map_or(1.0, |s| s.median);
    let is_black =
        albedos(views.iter().map(|v| (v.theta, v.data_albedo))).iter().all(|albedo| *albedo < LEAST);
    let what = if is_black { "black" } else { "a highlight over black" };
    let highlight = format!("the table is {what}, and that is {:.1} % off", 100.0 * error);
    match error {
        error if error <= L2.good => format!("use it: {highlight}"),
        error if error <= L2.most => format!("use it with care: {highlight}"),
        _ => format!("do not use it: {highlight}"),
    }
}

/// The same by its pictures alone.
fn sentence_by_looks(found: &Appearance) -> String {
    let visible = found.visible();
    let (light, most) = found.pictures.iter().fold(("", 0.0), |most, p| if p.1 > most.1 { *p } else { most });
    let mut seen = Vec::new();
    if has_rings(found) {
        seen.push("rings of colour that move with the camera".to_owned());
    }
    if found.ghost.0 > MOST_GHOST {
        seen.push(format!(
            "light where the table is darker, viewed at {:.0} degrees",
            found.ghost.1.to_degrees()
        ));
    }
    if found.skirt.chroma > MOST_SKIRT || found.skirt.negative > MOST_NEGATIVE {
        seen.push("a coloured fringe round the highlight".to_owned());
    }
    if has_creases(found) {
        seen.push("lines and corners away from the highlight".to_owned());
    }
    if found.bite > MOST_BITE {
        seen.push("a highlight near the normal that lacks a side".to_owned());
    }
    if has_ring(found) {
        seen.push("a ring in the highlight".to_owned());
    }
    let balls = format!("balls differ by {visible:.3} from the table's, by {most:.3} under a {light}");
    let is_noisy = found.noise().luminance >= LOUD_NOISE;
    let noisy = format!("is noisy: {:.0} % off its own mean over 3 degrees", 100.0 * found.noise().luminance);
    if is_noisy && visible - found.of_noise <= UNSEEN && seen.is_empty() {
        return format!(
            "use it, and not the table, which {noisy}; {balls}, by {:.3} for that noise alone",
            found.of_noise
        );
    }
    let looks = match (visible, seen.is_empty()) {
        (v, true) if v <= UNSEEN => format!("use it: {balls}, which hardly shows"),
        (v, false) if v <= OF_USE => format!("use it with care: {balls}; the fit shows {}", seen.join(", ")),
        (v, _) if v <= OF_USE => format!("use it with care: {balls}, which shows"),
        _ => format!("do not use it: {balls}, as if of another material"),
    };
    if is_noisy { format!("{looks}; the table {noisy}") } else { looks }
}

/// Errors of left-out views up to which the fit between samples is good, and is not off.
const GOOD_BETWEEN: f64 = 0.08;
const MOST_BETWEEN: f64 = 0.2;

/// A fit in words, a sentence each.
///
/// # Examples
/// ```
/// use srbf_core::Material;
/// use srbf_fit::judge::reciprocity::reciprocity;
/// use srbf_fit::judge::verdict::Verdict;
/// use srbf_fit::{Settings, fit_content, read};
///
/// let settings = Settings { lobes: 1, starts: 1, steps: 2, exchanges: 0, views: Some(2), ..Settings::default() };
/// let fit = fit_content(&read::read("model:lambert:albedo=0.5".as_ref())?.content, &settings, |_| {})?;
/// let material = Material::from_bytes(fit.bytes.as_slice())?;
/// let verdict = Verdict::of_material(&fit.report, &reciprocity(&material)?);
/// assert!(verdict.lines().iter().any(|line| line.starts_with("good relative L2")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// Whether to use it, in one sentence, if its appearance was compared.
    pub sentence: Option<String>,
    /// Criteria that are as good as a fit should be.
    pub good: Vec<String>,
    /// Criteria that are neither good nor off.
    pub fair: Vec<String>,
    /// Criteria that are off.
    pub off: Vec<String>,
    /// Advice.
    pub advice: Vec<String>,
}

impl Verdict {
    /// Judges a material, with advice.
    pub fn of_material(report: &Report, reciprocity: &Reciprocity) -> Self {
        Self { advice: advice(report), ..Self::new(report, reciprocity) }
    }

    /// Judges a fit by any method. Advice is for materials only.
    pub fn new(report: &Report, reciprocity: &Reciprocity) -> Self {
        let sentence = report.appearance.as_ref().map(|found| sentence(found, report));
        let mut verdict = Self { sentence, ..Self::default() };
        let is_dark = report.appearance.as_ref().is_some_and(|found| found.is_dark);
        for criterion in CRITERIA.iter().filter(|criterion| !(is_dark && criterion.is_off_peak)) {
            verdict.say(criterion, report);
        }
        // Light through a sheet whose sides differ is reciprocal with the other transmission.
        if report.completion.as_ref().is_none_or(|completion| !completion.sides) {
            verdict.say_reciprocity(reciprocity);
        }
        verdict.say_floor(report);
        verdict.say_appearance(report);
        verdict.say_gaps(report);
        verdict.say_completion(report);
        verdict.say_spectra(report);
        // Of samples, the albedo of the completion tells: see `look`.
        if report.completion.is_none() {
            verdict.off.extend(units::fault(&report.views));
        }
        verdict
    }

    fn say(&mut self, criterion: &Criterion, report: &Report) {
        let end = if criterion.is_visual { STEEPEST } else { f64::INFINITY };
        let all = || judged(&report.views).chain(judged(&report.held_out)).filter(|v| v.theta <= end);
        let is_of_views = report.held_out.is_empty() || report.completion.is_some();
        let spread = if is_of_views { &report.views } else { &report.held_out };
        let (Some(spread), Some(most)) = (
            Spread::of(judged(spread).filter(|v| v.theta <= end), criterion.number),
            Spread::of(all(), criterion.number),
        ) else {
            return;
        };
        let Criterion { name, unit, number, .. } = criterion;
        let most_allowed = criterion.most + (criterion.noise)(report);
        let (median, worst, limit) =
            (unit.text(spread.median), unit.text(most.worst), unit.text(most_allowed));
        let angle = most.worst_at.to_degrees();
        let over = all().filter(|v| number(v) > most_allowed).count();
        if over > 0 {
            self.off.push(format!(
                "{name}: {worst} at {angle:.1} degrees, above {limit} at {over} of {} views; median {median}",
                all().count()
            ));
            return;
        }
        let text = format!("{name}: median {median}, at most {worst}, at {angle:.1} degrees");
        let good = criterion.good + (criterion.noise)(report);
        if spread.median <= good { &mut self.good } else { &mut self.fair }.push(text);
    }

    fn say_reciprocity(&mut self, found: &Reciprocity) {
        if found.pairs == 0 {
            return;
        }
        let text = format!(
            "reciprocity: |ln f(a, b) / f(b, a)| is {:.3} in the median, at most {:.3}",
            found.median, found.worst
        );
        let place = match found.median {
            error if error <= GOOD_RECIPROCITY => &mut self.good,
            error if error <= MOST_RECIPROCITY => &mut self.fair,
            _ => &mut self.off,
        };
        place.push(text);
    }

    fn say_floor(&mut self, report: &Report) {
        let at_normal = judged(&report.held_out).chain(judged(&report.views)).find(|v| v.floor > 0.0);
        let Some(view) = at_normal else { return };
        if view.floor >= LEAST_FLOOR {
            self.fair.push(format!(
                "asymmetric data: at {:.1} degrees they differ by {:.1} % of L2 from their mean over the azimuth",
                view.theta.to_degrees(),
                100.0 * view.floor
            ));
        }
    }

    /// Rings that stand still with the camera, surroundings of the highlight, and noise of the table.
    fn say_appearance(&mut self, report: &Report) {
        let Some(found) = &report.appearance else { return };
        if found.is_dark {
            let text = "dark: away from the highlight nothing is bright enough to be seen, and errors there are not judged";
            return self.fair.push(text.into());
        }
        let [fit, table] = found.ripple;
        let text = format!(
            "rings: along the view angle colour varies by {:.3} about its mean over 8 degrees, the table's by {:.3}",
            fit.chroma, table.chroma
        );
        if has_rings(found) { &mut self.off } else { &mut self.good }.push(text);
        let skirt = found.skirt;
        let text = format!(
            "1.5 to 15 degrees from the highlight: luminance {:.1} %, colour {:.3}, falsely negative {:.0} %",
            100.0 * skirt.luminance,
            skirt.chroma,
            100.0 * skirt.negative
        );
        let is_off = skirt.chroma > MOST_SKIRT || skirt.negative > MOST_NEGATIVE;
        if is_off { &mut self.off } else { &mut self.good }.push(text);
        let text = format!(
            "shapes: lines and corners {:.3}, the table's own {:.3}; bite near the normal {:.2}; ring {:.2}, {:.2}",
            found.grain[0].coarse, found.grain[1].coarse, found.bite, found.ring[0], found.ring[1]
        );
        let is_off = has_creases(found) || found.bite > MOST_BITE || has_ring(found);
        if is_off { &mut self.off } else { &mut self.good }.push(text);
        if found.noise().luminance >= LEAST_NOISE {
            self.fair.push(format!(
                "noisy data: off the peak {:.1} % in luminance, {:.3} in colour from their mean over 3 degrees",
                100.0 * found.noise().luminance,
                found.noise().chroma
            ));
        }
    }

    /// Where nothing was measured.
    fn say_gaps(&mut self, report: &Report) {
        let Some(gaps) = report.gaps.as_ref().filter(|gaps| gaps.mean() >= LEAST_GAPS) else { return };
        if gaps.mean() >= MOST_GAPS { &mut self.off } else { &mut self.fair }.push(gaps.text());
    }

    /// The fit between samples is as good as at left-out views.
    fn say_completion(&mut self, report: &Report) {
        let Some(completion) = &report.completion else { return };
        let Some(views) = &completion.views_left_out else {
            self.off.push("between the samples: fewer than three views cannot show the error".into());
            return;
        };
        let text =
            format!("between the samples: left-out views have an L2 error of {:.0} %", 100.0 * views.error);
        let place = if views.error <= GOOD_BETWEEN {
            &mut self.good
        } else if views.error <= MOST_BETWEEN {
            &mut self.fair
        } else {
            self.advice
                .push("more samples near the mirror directions, where a sharp highlight changes most".into());
            &mut self.off
        };
        place.push(text);
    }

    /// How far spectra are from those of the samples.
    fn say_spectra(&mut self, report: &Report) {
        let Some((grade, text)) = report.spectra.as_ref().map(SpectralReport::sentence) else { return };
        match grade {
            Grade::Good => &mut self.good,
            Grade::Fair => &mut self.fair,
            Grade::Off => &mut self.off,
        }
        .push(text);
    }

    /// The lines to print, each with its kind: good, fair, off, try.
    pub fn lines(&self) -> Vec<String> {
        let sentence = self.sentence.iter().cloned();
        let parts = [("good", &self.good), ("fair", &self.fair), ("off", &self.off), ("try", &self.advice)];
        let labelled = |(label, sentences): (&str, &Vec<String>)| {
            sentences.iter().map(|s| format!("{label:4} {s}")).collect::<Vec<_>>()
        };
        sentence.chain(parts.into_iter().flat_map(labelled)).collect()
    }

    pub(crate) fn to_json(&self) -> Value {
        json!({"sentence": self.sentence, "good": self.good, "fair": self.fair, "off": self.off, "try": self.advice})
    }
}

/// Whether any view has more than it should have.
fn is_off(criterion: &Criterion, report: &Report) -> bool {
    if criterion.is_off_peak && report.appearance.as_ref().is_some_and(|found| found.is_dark) {
        return false;
    }
    let most = criterion.most + (criterion.noise)(report);
    judged(&report.views).chain(judged(&report.held_out)).any(|v| (criterion.number)(v) > most)
}

/// Advice that holds for every fit.
fn advice(report: &Report) -> Vec<String> {
    let mut advice = Vec::new();
    if is_off(&WEIGHT, report) {
        let all = || judged(&report.views).chain(judged(&report.held_out));
        let worst = Spread::of(all(), WEIGHT.number).map_or(0.0, |s| s.worst);
        advice.push(format!(
            "`Defensive` sampling where the table stays the truth: it bounds the weight, {worst:.0} here"
        ));
    }
    advice
}

#[cfg(test)]
mod tests;
