//! A look at samples before they are fitted: their kind, and their faults.
//!
//! Findings are said, not mended: where a file can be read in two ways, the finding names the option for the other way.
//!
//! May import: `complete`, `isotropy`, `numeric`, `read`, `reciprocity`, `row`, `table`.

mod highlight;
mod units;

use crate::complete::CompletionReport;
pub use crate::isotropy::Isotropy;
use crate::numeric::median::median;
use crate::read::{Intake, LeftOut, Values};
use crate::reciprocity::contradicted;
use crate::reciprocity::pairs::{Compared, Places};
pub use crate::reciprocity::{Contradicted, Reciprocity};
use crate::row::{Row, polar, thin};
pub use highlight::Highlight;
use serde_json::{Value, json};
pub use units::Units;

/// Samples that are compared at most.
const MOST_COMPARED: usize = 50_000;

/// Left differs from right by three limits: least number of pairs; least standard errors by which one side is brighter in more of
/// them; least median of the logarithm of their ratio.
const PAIRS: usize = 20;
const ERRORS: f64 = 8.0;
const TILTED: f64 = 0.05;

/// Samples that are named.
const NAMED: usize = 8;

/// Stated reflectances that are said; the share by which one may be off, where so little of the hemisphere is without samples, up to that
/// angle: towards grazing, instruments take unseen light for 0.
const STATED: usize = 32;
const STATED_OFF: f64 = 0.2;
const KNOWN: f64 = 0.3;
const STEEPEST: f64 = 72.0;

/// The subject of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// An assumption of the reader.
    Convention,
    /// Rows that are no samples.
    NotMeasured,
    /// Whether a turn of the sample matters.
    Isotropy,
    /// Whether values are f in 1/sr.
    Units,
    /// Whether swapped samples agree.
    Reciprocity,
    /// Whether left and right of the plane of incidence agree.
    Sides,
    /// Where the highlight is.
    Highlight,
    /// Directions that no sample is near to.
    Gaps,
    /// Samples that all others contradict.
    Outliers,
    /// Reflectance that the file states.
    Stated,
}

impl Topic {
    /// Its name, in words and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Convention => "convention",
            Self::NotMeasured => "not measured",
            Self::Isotropy => "isotropy",
            Self::Units => "units",
            Self::Reciprocity => "reciprocity",
            Self::Sides => "left and right",
            Self::Highlight => "highlight",
            Self::Gaps => "gaps",
            Self::Outliers => "outliers",
            Self::Stated => "stated",
        }
    }
}

/// One thing that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Its subject.
    pub topic: Topic,
    /// Whether something is wrong, or may be: false for plain facts.
    pub is_off: bool,
    /// A sentence.
    pub text: String,
    /// The option of the command line that changes it.
    pub option: Option<&'static str>,
    /// Lines of the file that it is about, the first of them.
    pub lines: Vec<usize>,
}

/// A sample that all others contradict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// The sample as it stands in the file.
    pub row: Row,
    /// Its luminance over that of the others there.
    pub ratio: f64,
    /// Whether the sample is wrong; otherwise its surroundings are predicted badly too.
    pub is_wrong: bool,
}

/// The findings about samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Name of the format.
    pub format: &'static str,
    /// Samples.
    pub samples: usize,
    /// Angles of the direction that was held, degrees, rising; whether it is the light.
    pub views: Vec<f64>,
    /// Whether the light was held, and the viewer moved.
    pub is_light_fixed: bool,
    /// The result of a turn of the sample; `None` where it was not turned.
    pub isotropy: Option<Isotropy>,
    /// What swapped samples say; `None` where there are none.
    pub reciprocity: Option<Reciprocity>,
    /// Angles at which samples contradict those with light and viewer exchanged, worst first.
    pub contradicted: Vec<Contradicted>,
    /// Median of the logarithm of left over right of the plane of incidence, and how many pairs there are.
    pub sides: Option<(f64, usize)>,
    /// The highlight in the samples.
    pub highlight: Highlight,
    /// The units by the albedo; `None` where samples cover the hemisphere nowhere, or were not completed.
    pub units: Option<Units>,
    /// Samples that all others contradict.
    pub outliers: Vec<Outlier>,
    /// Rows that are no samples.
    pub left_out: Vec<LeftOut>,
    /// All of it, in words.
    pub findings: Vec<Finding>,
}

impl Look {
    /// Looks at samples as they stand in a file, and at their completion.
    pub fn new(intake: &Intake, completion: Option<&CompletionReport>) -> Self {
        let few: Vec<Row> = thin(&intake.rows, MOST_COMPARED).into_iter().copied().collect();
        let is_turned = intake.isotropy.as_ref().is_some_and(Isotropy::is_anisotropic);
        let places = Places::of(&few, is_turned);
        let mut views: Vec<f64> = intake.views().iter().map(|view| view.0.to_degrees()).collect();
        views.sort_by(f64::total_cmp);
        // Light through a sheet whose sides differ: swapped directions are others.
        let is_swapped = completion.is_none_or(|completion| !completion.sides);
        let reciprocity = if is_swapped { Reciprocity::of(&places.swapped()) } else { None };
        // Where a cosine is left, all angles do.
        let is_of_cosine = reciprocity.is_some_and(|found| found.cosine.is_some());
        let contradicted = if is_of_cosine || !is_swapped {
            Vec::new()
        } else {
            contradicted(&few, intake.is_light_fixed, is_turned)
        };
        let mut look = Self {
            format: intake.format,
            samples: intake.rows.len(),
            views,
            is_light_fixed: intake.is_light_fixed,
            isotropy: intake.isotropy,
            reciprocity,
            contradicted,
            sides: sides(&places.sides()),
            highlight: Highlight::of(&intake.rows, intake.is_light_fixed, completion.map(|c| c.width)),
            // Noise about 0 tells no unit.
            units: completion.filter(|_| !intake.is_black).and_then(|completion| Units::of(&few, completion)),
            outliers: completion.map_or_else(Vec::new, |completion| outliers(intake, completion)),
            left_out: intake.left_out.clone(),
            findings: Vec::new(),
        };
        look.findings = look.said(intake, completion);
        look
    }

    /// One line: what there is.
    pub fn summary(&self) -> String {
        let held = if self.is_light_fixed { "light" } else { "viewer" };
        let angle =
            |n: usize| format!("{:.4}", self.views[n]).trim_end_matches('0').trim_end_matches('.').to_owned();
        let angles = match self.views.len() {
            0 => String::new(),
            n @ 1..=8 => format!(" ({} degrees)", (0..n).map(angle).collect::<Vec<_>>().join(", ")),
            n => format!(" ({} to {} degrees)", angle(0), angle(n - 1)),
        };
        let s = if self.views.len() == 1 { "" } else { "s" };
        format!(
            "{}: {} samples, {} angle{s} of the {held}{angles}",
            self.format,
            self.samples,
            self.views.len()
        )
    }

    fn said(&self, intake: &Intake, completion: Option<&CompletionReport>) -> Vec<Finding> {
        let plain =
            |topic, text: String| Finding { topic, is_off: false, text, option: None, lines: Vec::new() };
        let off = |topic, text: String| Finding { is_off: true, ..plain(topic, text) };
        let note = |note: &crate::read::Note| Finding {
            option: note.option,
            is_off: note.is_off,
            ..plain(Topic::Convention, note.text.clone())
        };
        let mut found: Vec<Finding> = intake.notes.iter().map(note).collect();
        if self.highlight.is_at_back() && intake.mirror.is_none() {
            let text = "the brightest samples are where the light comes from: a retro-reflector or the hot spot of a rough ground, or \
                        mirror directions at equal azimuths";
            found.push(Finding { option: Some("--mirror equal"), ..plain(Topic::Convention, text.into()) });
        }
        if self.highlight.is_back_alone {
            let text = "all samples are where the light comes from, as those of a lidar: all else, and the mirror side, is a guess";
            found.push(off(Topic::Highlight, text.into()));
        }
        if intake.left_out_count() > 0 {
            let lines = intake.left_out.iter().flat_map(|left| left.lines.iter().copied()).collect();
            let text = format!("left out: {}", intake.left_out_text());
            found.push(Finding { lines, ..plain(Topic::NotMeasured, text) });
        }
        match &self.isotropy {
            Some(isotropy) if isotropy.is_anisotropic() => {
                let axis = completion.and_then(|completion| completion.turn);
                let axis = axis.map_or_else(String::new, |turn| format!("; {}", turn.text()));
                let text = format!("an anisotropic surface: {}{axis}", isotropy.text());
                found.push(plain(Topic::Isotropy, text));
            }
            Some(isotropy) if isotropy.is_doubtful() => {
                let text = format!(
                    "{}, but no more than noise may; the surface is taken as isotropic",
                    isotropy.text()
                );
                found.push(off(Topic::Isotropy, text));
            }
            Some(_) => {
                found.push(plain(Topic::Isotropy, "the sample was turned, and a turn changes nothing".into()))
            }
            None => {}
        }
        if let Some(units) = self.units.as_ref().filter(|units| units.is_off()) {
            found.push(Finding { option: Some("--divide"), ..off(Topic::Units, units.text()) });
        }
        if let Some(reciprocity) = &self.reciprocity {
            found.push(reciprocity_said(reciprocity, intake.values));
        }
        if !self.contradicted.is_empty() {
            found.push(off(Topic::Reciprocity, self.contradicted_said()));
        }
        if let Some((middle, pairs)) = self.sides {
            let text = format!(
                "samples left and right of the plane of incidence differ by {:.0} % in the median of {pairs} pairs, as a tilted sample would",
                100.0 * libm::expm1(middle.abs())
            );
            found.push(off(Topic::Sides, text));
        }
        let Highlight { views, unseen, width_degrees, .. } = self.highlight;
        if unseen > 0 {
            found.push(off(
                Topic::Highlight,
                format!(
                    "at {unseen} of {views} angles no sample is within the highlight, {width_degrees:.1} degrees of the half vector: its height there is a guess"
                ),
            ));
        }
        if let Some(completion) = completion {
            found.push(plain(Topic::Gaps, completion.gaps.text()));
        }
        found.extend([true, false].into_iter().filter_map(|is_wrong| self.outliers_said(is_wrong)));
        found.extend(intake.stated.iter().take(STATED).map(|stated| stated_said(*stated, completion)));
        found
    }

    /// The samples that are wrong, or those that are left out though they may be right.
    fn outliers_said(&self, is_wrong: bool) -> Option<Finding> {
        let outliers: Vec<&Outlier> = self.outliers.iter().filter(|o| o.is_wrong == is_wrong).collect();
        if outliers.is_empty() {
            return None;
        }
        let one = |outlier: &&Outlier| {
            let Row { line, wi, wo, .. } = outlier.row;
            let angles = |d: [f64; 3]| {
                format!("{:.1}, {:.1}", polar(d).to_degrees(), libm::atan2(d[1], d[0]).to_degrees())
            };
            format!(
                "line {line} (theta_i, phi_i {}; theta_o, phi_o {}), {:.2} times that",
                angles(wi),
                angles(wo),
                outlier.ratio
            )
        };
        let named: Vec<String> = outliers.iter().take(NAMED).map(one).collect();
        let more = if outliers.len() > NAMED { "; ..." } else { "" };
        let count = outliers.len();
        let (samples, are) = if count == 1 { ("sample", "is") } else { ("samples", "are") };
        let why = if is_wrong {
            "that all others contradict"
        } else {
            "where values vary too fast to be predicted"
        };
        Some(Finding {
            topic: Topic::Outliers,
            is_off: is_wrong,
            text: format!("{count} {samples} {why} {are} left out: {}{more}", named.join("; ")),
            option: None,
            lines: outliers.iter().take(NAMED).map(|o| o.row.line).collect(),
        })
    }

    /// All of it as JSON.
    pub fn to_json(&self) -> Value {
        let left_out =
            |left: &LeftOut| json!({"reason": left.reason.text(), "count": left.count, "lines": left.lines});
        let finding = |f: &Finding| json!({"topic": f.topic.name(), "is_off": f.is_off, "text": f.text, "option": f.option, "lines": f.lines});
        let outlier = |o: &Outlier| json!({"line": o.row.line, "incident": o.row.wi, "outgoing": o.row.wo, "over_what_others_say": o.ratio, "is_wrong": o.is_wrong});
        let units = |u: &Units| {
            let candidates: Vec<Value> =
                u.candidates.iter().map(|c| json!({"divide": c.0, "albedo": c.1})).collect();
            json!({"largest_albedo": u.most, "albedo": u.albedo, "candidates": candidates})
        };
        let values = |values: Values| match values {
            Values::Brdf => "f",
            Values::CosineOutgoing => "f times the cosine of the outgoing direction",
            Values::CosineIncident => "f times the cosine of the incident direction",
        };
        json!({
            "format": self.format,
            "samples": self.samples,
            "views_degrees": self.views,
            "held": if self.is_light_fixed { "light" } else { "viewer" },
            "turned": self.isotropy.map(|i| json!({"log_likelihood_a_sample": i.gain, "times_apart": i.apart})),
            "swapped": self.reciprocity.map(|r| json!({
                "pairs": r.pairs, "median_log_ratio": r.apart, "values_are": r.cosine.map(values),
            })),
            "contradicted": self.contradicted.iter().map(|c| json!({
                "theta_degrees": c.theta.to_degrees(), "ratio": c.ratio, "pairs": c.pairs,
            })).collect::<Vec<_>>(),
            "left_over_right": self.sides.map(|s| json!({"median_log_ratio": s.0, "pairs": s.1})),
            "highlight": {
                "views": self.highlight.views,
                "views_without_a_sample_in_it": self.highlight.unseen,
                "is_where_the_light_comes_from": self.highlight.is_at_back(),
                "are_all_samples_there": self.highlight.is_back_alone,
            },
            "units": self.units.as_ref().map(units),
            "outliers": self.outliers.iter().map(outlier).collect::<Vec<_>>(),
            "left_out": self.left_out.iter().map(left_out).collect::<Vec<_>>(),
            "findings": self.findings.iter().map(finding).collect::<Vec<_>>(),
        })
    }
}

/// A reflectance that the file states, beside ours.
fn stated_said((degrees, stated): (f64, f64), completion: Option<&CompletionReport>) -> Finding {
    let theta = degrees.to_radians();
    let ours = completion.and_then(|completion| {
        let is_known = completion.gaps.share_at(theta) < KNOWN && degrees <= STEEPEST;
        albedo_at(completion, theta).map(|ours| (ours, is_known))
    });
    let is_off = ours
        .is_some_and(|(ours, is_known)| is_known && stated > 0.0 && (ours / stated - 1.0).abs() > STATED_OFF);
    let beside = match ours {
        Some((ours, _)) if is_off => {
            format!(
                "; the samples reflect {ours:.3}, {:.0} % off: one of both is wrong",
                100.0 * (ours / stated - 1.0).abs()
            )
        }
        Some((ours, _)) => format!("; ours is {ours:.3}"),
        None => String::new(),
    };
    let text = format!("the file states a reflectance of {stated:.3} at {degrees} degrees{beside}");
    Finding { topic: Topic::Stated, is_off, text, option: None, lines: Vec::new() }
}

impl Look {
    /// Angles whose samples contradict those with light and viewer exchanged.
    fn contradicted_said(&self) -> String {
        let list = |numbers: Vec<String>| numbers.join(", ");
        let held = if self.is_light_fixed { "light" } else { "viewer" };
        let angles = list(self.contradicted.iter().map(|c| format!("{:.0}", c.theta.to_degrees())).collect());
        let ratios = list(self.contradicted.iter().map(|c| format!("{:.2}", c.ratio)).collect());
        let pairs: usize = self.contradicted.iter().map(|c| c.pairs).sum();
        format!(
            "with the {held} at {angles} degrees samples are {ratios} times those with light and viewer exchanged, in the median of {pairs} \
             pairs: no surface is so, and no fit can have both"
        )
    }
}

/// What swapped samples say, of values that were taken for what `taken` says.
fn reciprocity_said(found: &Reciprocity, taken: Values) -> Finding {
    let Reciprocity { pairs, apart, cosine } = *found;
    let plain = |text: String| Finding {
        topic: Topic::Reciprocity,
        is_off: false,
        text,
        option: None,
        lines: Vec::new(),
    };
    let off = |text: String, option| Finding { is_off: true, option: Some(option), ..plain(text) };
    let multiplied = |which: &str| {
        format!(
            "values are multiplied by the cosine of the {which} direction: without it, {pairs} swapped pairs of samples agree"
        )
    };
    match (taken, cosine) {
        (Values::Brdf, Some(Values::CosineOutgoing)) => {
            off(multiplied("outgoing"), "--values cosine-outgoing")
        }
        (Values::Brdf, Some(Values::CosineIncident)) => {
            off(multiplied("incident"), "--values cosine-incident")
        }
        // Divided by one cosine, f itself looks as if it were multiplied by the other.
        (Values::CosineOutgoing, Some(Values::CosineIncident))
        | (Values::CosineIncident, Some(Values::CosineOutgoing)) => off(
            format!(
                "values are divided by a cosine: without dividing, {pairs} swapped pairs of samples agree"
            ),
            "--values brdf",
        ),
        _ => {
            let percent = 100.0 * libm::expm1(apart);
            plain(match pairs {
                1 => format!("one swapped pair of samples differs by {percent:.0} %"),
                _ => format!("{pairs} swapped pairs of samples differ by {percent:.0} % in the median"),
            })
        }
    }
}

/// Left against right, where they differ beyond chance.
fn sides(pairs: &[Compared]) -> Option<(f64, usize)> {
    let middle = median(pairs.iter().map(|p| p.log_ratio).collect())?;
    let more: f64 = pairs.iter().map(|p| if p.log_ratio > 0.0 { 1.0 } else { -1.0 }).sum();
    let is_off =
        pairs.len() >= PAIRS && middle.abs() > TILTED && more.abs() > ERRORS * libm::sqrt(pairs.len() as f64);
    is_off.then_some((middle, pairs.len()))
}

fn outliers(intake: &Intake, completion: &CompletionReport) -> Vec<Outlier> {
    let groups = intake.placed();
    let found = completion.outliers.iter().filter_map(|outlier| {
        // Samples of a surface that a turn changes, or of sides that differ, are numbered as they stand in the file.
        let row = if completion.turn.is_some() || completion.sides {
            outlier.sample
        } else {
            *groups.get(outlier.view)?.get(outlier.sample)?
        };
        let (ratio, is_wrong) = (outlier.ratio, outlier.is_wrong);
        Some(Outlier { row: *intake.rows.get(row)?, ratio, is_wrong })
    });
    found.collect()
}

/// Luminance of the albedo at an angle, radians.
fn albedo_at(completion: &CompletionReport, theta: f64) -> Option<f64> {
    let after = completion.albedo.partition_point(|a| a.0 < theta);
    let (a, b) = (completion.albedo.get(after.saturating_sub(1))?, completion.albedo.get(after)?);
    let part = if b.0 > a.0 { (theta - a.0) / (b.0 - a.0) } else { 0.0 };
    let of = |albedo: [f64; 3]| crate::table::luminance(albedo);
    Some(of(a.1) + part * (of(b.1) - of(a.1)))
}
