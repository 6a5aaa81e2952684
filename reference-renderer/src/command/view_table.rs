//! How good a fit is, as text: a line a view, the numbers of all views, and the verdict.

use srbf_core::Material;
use srbf_fit::complete::held_out::HeldOut;
use srbf_fit::complete::{CompletionReport, Outlier};
use srbf_fit::judge::reciprocity::Reciprocity;
use srbf_fit::judge::report::{Report, ViewReport, factor_bytes, factor_words};
use srbf_fit::judge::verdict::{Spread, Summary, Verdict};

const COLUMNS: [(&str, usize, usize); 7] = [
    ("L2 %", 7, 2),
    ("peak", 6, 1),
    ("off", 6, 1),
    ("lumin.", 6, 1),
    ("chroma", 6, 3),
    ("var.", 7, 3),
    ("weight", 7, 1),
];

/// Parts of L2 below are printed as 0, and are not.
const LEAST_SHARE: f64 = 5e-5;

/// The legend of the columns.
pub const LEGEND: &str = "L2 %: relative L2 error of f cos; peak, off: the same within 15 degrees of the mirror direction, and beyond; \
    lumin., chroma: median error beyond, of the luminance in % and of the colour; var., weight: relative variance and \
    largest over mean of f cos / pdf; albedo: of the fit, and in brackets of the data";

/// Most outliers that are printed.
const OUTLIERS: usize = 5;

/// Prints the report of the completion of samples.
pub fn print_completion(completion: &CompletionReport) {
    let error = |held_out: &HeldOut| {
        let logarithm = 100.0 * held_out.logarithm.exp_m1();
        format!("relative L2 {:.1} %, by logarithms {logarithm:.0} %", 100.0 * held_out.error)
    };
    let CompletionReport { samples, points, outliers, .. } = completion;
    let thinned =
        if points < samples { format!(", close ones taken together to {points}") } else { String::new() };
    println!("between the samples, {samples}{thinned}, by {}:", completion.family.description());
    println!("  samples left out: {}", error(&completion.samples_left_out));
    match &completion.views_left_out {
        Some(views) => println!("  views left out:   {}", error(views)),
        None => println!("  views left out:   none can be, with fewer than three"),
    }
    println!("  a microfacet model alone: {}", error(&completion.model_alone));
    if !outliers.is_empty() {
        let times =
            |o: &Outlier| format!("sample {} of view {}, {:.2} times", o.sample + 1, o.view + 1, o.ratio);
        let wrong = outliers.iter().filter(|o| o.is_wrong).count();
        let shown: Vec<String> = outliers.iter().take(OUTLIERS).map(times).collect();
        let more = if outliers.len() > OUTLIERS { ", ..." } else { "" };
        println!(
            "  left out: {wrong} that all others contradict, {} where values vary too fast: {}{more}",
            outliers.len() - wrong,
            shown.join("; ")
        );
    }
}

/// Prints the views of a report under a heading, with their azimuths if any has one.
pub fn print_views(views: &[ViewReport], isotropic: bool) {
    let azimuth = if isotropic { "" } else { " azim." };
    let names = COLUMNS.map(|(name, width, _)| format!("{name:>width$}"));
    println!("  view{azimuth} |{}", names.join(" "));
    views.iter().for_each(|view| println!("{}{}", place(view, isotropic), numbers(errors(view))));
    println!("  view{azimuth} | albedo r g b, fit (data)");
    for view in views {
        let [fit, data] = [view.albedo, view.data_albedo].map(albedo);
        println!("{} {fit} ({data})", place(view, isotropic));
    }
}

/// The beginning of the line of a view.
fn place(v: &ViewReport, isotropic: bool) -> String {
    let azimuth = if isotropic { String::new() } else { format!(" {:5.1}", v.azimuth.to_degrees()) };
    format!("{:6.1}{azimuth} |", v.theta.to_degrees())
}

fn albedo(rgb: [f64; 3]) -> String {
    rgb.map(|a| format!("{a:.3}")).join(" ")
}

/// The numbers of a view; a black one has no relative error.
fn errors(v: &ViewReport) -> [f64; 7] {
    let error = if v.is_black { f64::NAN } else { v.error };
    let regions = v.regions;
    [error, regions.peak, regions.off_peak, regions.luminance, regions.chroma, v.variance, v.largest_weight]
}

/// The numbers of the columns, the first four in per cent; `-` for numbers that a method lacks, such as the variance if it does not sample.
fn numbers(values: [f64; 7]) -> String {
    fields(values).join(" ")
}

fn fields(values: [f64; 7]) -> [String; 7] {
    let field = |(n, value): (usize, f64)| {
        let (_, width, digits) = COLUMNS[n];
        let value = if n < 4 { 100.0 * value } else { value };
        if value.is_nan() { format!("{:>width$}", "-") } else { format!("{value:width$.digits$}") }
    };
    std::array::from_fn(|n| field((n, values[n])))
}

/// Prints the median and the worst of each column, and where the worst is.
fn print_summary(summary: &Summary, isotropic: bool) {
    let spreads = [
        summary.error,
        summary.peak,
        summary.off_peak,
        summary.luminance,
        summary.chroma,
        summary.variance,
        summary.weight,
    ];
    let row = |of: fn(Spread) -> f64| spreads.map(|spread| spread.map_or(f64::NAN, of));
    let gap = if isotropic { "" } else { "      " };
    println!("median{gap} |{}", numbers(row(|s| s.median)));
    println!(" worst{gap} |{}", numbers(row(|s| s.worst)));
    let angles = row(|s| s.worst_at.to_degrees()).into_iter().zip(COLUMNS);
    let angle = |(angle, (_, width, _)): (f64, (&str, usize, usize))| {
        if angle.is_nan() { format!("{:>width$}", "-") } else { format!("{angle:width$.1}") }
    };
    println!("at deg{gap} |{}", angles.map(angle).collect::<Vec<_>>().join(" "));
}

/// Prints the numbers of the whole: the table behind it, the material, energy and reciprocity.
///
/// `material`: the material, if the fit is one.
pub fn print_whole(report: &Report, reciprocity: &Reciprocity, material: Option<&Material<&[u8]>>) {
    let isotropic = is_isotropic(report);
    let summary = Summary::new(report);
    println!("{} {} views:", summary.views, if summary.is_of_held_out { "held-out" } else { "fitted" });
    print_summary(&summary, isotropic);
    if let Some(energy) = summary.energy {
        println!(
            "energy: largest error of an albedo, median {:.2} %, worst {:.2} % at {:.1} degrees",
            100.0 * energy.median,
            100.0 * energy.worst,
            energy.worst_at.to_degrees()
        );
    }
    println!(
        "reciprocity error |ln f(a, b) / f(b, a)|: median {:.3}, worst {:.3}, {} pairs",
        reciprocity.median, reciprocity.worst, reciprocity.pairs
    );
    print_data(report);
    if let Some(material) = material {
        print_factors(material);
    }
    if !report.factor_sizes.is_empty() {
        let sizes = report.factor_sizes.iter().map(|(bytes, left)| format!("{bytes}: {left:.2}"));
        println!(
            "bytes with each table of factors, and the share of the error off the peak that it leaves in directions left out: {}",
            sizes.collect::<Vec<_>>().join(", ")
        );
    }
}

/// A fit in words: notes, then the verdict.
pub fn words(report: &Report, verdict: &Verdict) -> Vec<String> {
    let notes = report.notes().into_iter().map(|note| format!("note {note}"));
    notes.chain(verdict.lines()).collect()
}

/// Whether no view of a report is turned.
pub fn is_isotropic(report: &Report) -> bool {
    report.views.iter().chain(&report.held_out).all(|v| v.azimuth == 0.0)
}

/// What no fit has of the data: asymmetry at the normal, and negative samples.
fn print_data(report: &Report) {
    let all = || report.held_out.iter().chain(&report.views);
    if let Some(view) = all().find(|v| v.floor > LEAST_SHARE) {
        println!(
            "floor at {:.1} degrees: the data differ by {:.2} % of L2 from their mean over the azimuth, the base of errors",
            view.theta.to_degrees(),
            100.0 * view.floor
        );
    }
    if let Some(view) =
        all().max_by(|a, b| a.negatives.1.total_cmp(&b.negatives.1)).filter(|v| v.negatives.1 > LEAST_SHARE)
    {
        println!(
            "negative data: at most {:.2} % of L2, at {:.1} degrees, where {:.1} % of the hemisphere has some",
            100.0 * view.negatives.1,
            view.theta.to_degrees(),
            100.0 * view.negatives.0
        );
    }
}

/// Prints the table of factors, if there is one.
pub fn print_factors(material: &Material<impl AsRef<[u8]>>) {
    if let Some(nodes) = factor_words(material) {
        println!(
            "factors: {nodes}, largest {:.2}, {} of {} bytes",
            material.largest_factor(),
            factor_bytes(material),
            material.bytes().len()
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_fit::judge::measure::RegionErrors;

    /// A view with numbers as long as they get.
    fn long() -> ViewReport {
        ViewReport {
            theta: 1.5,
            azimuth: 3.1,
            error: 1.2345,
            measure: 1.0,
            is_black: false,
            is_contradicted: false,
            albedo: [0.123; 3],
            data_albedo: [0.123; 3],
            is_albedo_cut: false,
            density: 1.0,
            variance: 123.4,
            largest_weight: 1234.5,
            regions: RegionErrors { peak: 1.0, off_peak: 12.0, luminance: 12.0, chroma: 1.2 },
            floor: 0.0,
            negatives: (0.0, 0.0),
        }
    }

    #[test]
    fn lines_are_not_too_wide_and_say_what_is_not_known() {
        let line = |view: &ViewReport, isotropic| place(view, isotropic) + &numbers(errors(view));
        assert!(line(&long(), false).len() <= 80, "{}", line(&long(), false));
        assert_eq!(line(&long(), false).len(), line(&ViewReport { error: 0.01, ..long() }, false).len());
        let unknown =
            ViewReport { is_black: true, variance: f64::NAN, largest_weight: f64::INFINITY, ..long() };
        let text = line(&unknown, true);
        assert_eq!(text.len() + 6, line(&long(), false).len());
        assert!(text.contains("      -  100.0") && text.ends_with("      -     inf"), "{text}");
    }
}
